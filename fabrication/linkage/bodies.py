"""What the parts of a linkage are for collisions: eyes, pins and rings as cylinders, bars as hulls.

The convex pieces hold the solids: bores and engraved labels only take away, and a bar outside its
eyes lies in the hull of the corners in which its edges meet them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ddgfab.mesh import Floats
from fabrication.linkspecs import CouponShape, LinkShape, PinShape, RingShape
from fabrication.motion.convex import Body, ConvexPiece, cylinder, hull
from fabrication.solids.linkframe import Eye, bar_corners, eyes_of, label_corners
from fabrication.specs import Fitting, Link, Pin

if TYPE_CHECKING:
    from fabrication.linkage.links import Linkage


def bodies(linkage: Linkage) -> tuple[Body, ...]:
    """All parts of a linkage that move with it, in the order of its pieces.

    Raises
    ------
    DetailError
        A link is impossible: its bar does not meet its eyes.
    """
    items = {item.mark: item for stack in linkage.stacks for item in stack}
    found = []
    for piece in linkage.pieces:
        if isinstance(piece, Link):
            found.append(link_body(piece.mark, piece.bar, piece.hinges, piece.shape))
        elif isinstance(piece, Pin | Fitting) and piece.hinge is not None:
            at, shape = items[piece.mark], piece.shape
            assert not isinstance(shape, CouponShape)
            found.append(fitting_body(piece.mark, piece.hinge, shape, at.low, at.high))
    return tuple(found)


def link_body(mark: str, bar: int, hinges: tuple[int, int], shape: LinkShape) -> Body:
    """A link in its bar's frame: two eyes, the bar, and a raised label if there is one.

    Raises
    ------
    DetailError
        The link is impossible: its bar does not meet its eyes.
    """
    pieces = [_eye_piece(eye, hinge) for eye, hinge in zip(eyes_of(shape), hinges, strict=True)]
    pieces.append(hull(bar_corners(shape)))
    if shape.label is not None and shape.label.depth < 0.0:
        pieces.append(hull(label_corners(shape)))
    return Body(mark, tuple(pieces), bar=bar)


def _eye_piece(eye: Eye, hinge: int) -> ConvexPiece:
    middle, axis = np.array(eye.middle), np.array(eye.axis)
    return cylinder(middle - eye.half * axis, middle + eye.half * axis, eye.radius, eye=hinge)


def fitting_body(
    mark: str, hinge: int, shape: PinShape | RingShape, low: float, high: float
) -> Body:
    """A pin, cap or spacer in its hinge's frame, from `low` to `high` [mm] along the axis."""
    pieces = [_round(low, high, shape.diameter)]
    if isinstance(shape, PinShape) and shape.head_height > 0.0:
        pieces.append(_round(low - shape.head_height, low, shape.head_diameter))
    return Body(mark, tuple(pieces), hinge=hinge)


def _round(low: float, high: float, diameter: float) -> ConvexPiece:
    ends: Floats = np.array([[0.0, 0.0, low], [0.0, 0.0, high]])
    return cylinder(ends[0], ends[1], diameter / 2.0)

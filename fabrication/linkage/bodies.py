"""What the parts of a linkage are for collisions: eyes, pins and rings as cylinders, bars as hulls.

The convex pieces hold the solids: bores and engraved labels only take away, and a bar outside its
eyes lies in the hull of the corners in which its edges meet them.
"""

from __future__ import annotations

import numpy as np

from ddgfab.mesh import Floats
from fabrication.linkage.links import Linkage
from fabrication.linkage.pieces import Pin
from fabrication.motion.convex import Body, ConvexPiece, cylinder, hull
from fabrication.parts.link import LinkShape
from fabrication.parts.link.frame import Eye, bar_corners, eyes_of, label_corners


def bodies(linkage: Linkage) -> tuple[Body, ...]:
    """All parts of a linkage that move with it, in the order of its pieces.

    Raises
    ------
    DetailError
        A link is impossible: its bar does not meet its eyes.
    """
    items = {item.mark: item for stack in linkage.stacks for item in stack}
    links = [link_body(link.mark, link.bar, link.hinges, link.shape) for link in linkage.links]
    pins = [pin_body(pin, items[pin.mark].low, items[pin.mark].high) for pin in linkage.pins]
    others = []
    for fitting in linkage.fittings:
        at = items[fitting.mark]
        ring = _round(at.low, at.high, fitting.shape.diameter)
        others.append(Body(fitting.mark, (ring,), hinge=fitting.hinge))
    return (*links, *pins, *others)


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


def pin_body(pin: Pin, low: float, high: float) -> Body:
    """A pin in its hinge's frame, from `low` to `high` [mm] along the axis; its head is below."""
    shape = pin.shape
    pieces = [_round(low, high, shape.diameter)]
    if shape.head_height > 0.0:
        pieces.append(_round(low - shape.head_height, low, shape.head_diameter))
    return Body(pin.mark, tuple(pieces), hinge=pin.hinge)


def _round(low: float, high: float, diameter: float) -> ConvexPiece:
    ends: Floats = np.array([[0.0, 0.0, low], [0.0, 0.0, high]])
    return cylinder(ends[0], ends[1], diameter / 2.0)

"""Round parts: pins with or without a head, rings and caps -> exact boundary."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ddgfab.errors import DetailError
from fabrication.linkspecs import PinShape, RingShape
from fabrication.solids.boundary import Boundary
from fabrication.solids.builder import (
    BoundaryBuilder,
    Coedges,
    Vec,
    add,
    cross,
    normalised,
    scale,
)

X: Vec = (1.0, 0.0, 0.0)
UP: Vec = (0.0, 0.0, 1.0)
DOWN: Vec = (0.0, 0.0, -1.0)


def drum(
    builder: BoundaryBuilder,
    low: Vec,
    high: Vec,
    xdir: Vec,
    radius: float,
    front: Sequence[Coedges] = (),
) -> tuple[Coedges, Coedges]:
    """The round surface of a cylinder: two halves, the one towards xdir with `front` as holes.

    xdir is perpendicular to the axis from `low` to `high`. Returns the circles as outer loops of
    the end faces, whose normals point away from the cylinder.
    """
    axis = normalised(add(high, low, -1.0))
    side = cross(axis, xdir)
    a, b = scale(xdir, radius), scale(side, radius)
    rims = []
    for centre in (low, high):
        left, right = builder.point(add(centre, b)), builder.point(add(centre, b, -1.0))
        fore = builder.arc((right, left), centre, a, b, -0.5 * math.pi, 0.5 * math.pi)
        back = builder.arc((left, right), centre, a, b, 0.5 * math.pi, 1.5 * math.pi)
        rims.append((left, right, fore, back))
    (left0, right0, fore0, back0), (left1, right1, fore1, back1) = rims
    left, right = builder.line(left0, left1), builder.line(right0, right1)
    builder.cylinder(low, axis, xdir, radius, 1.0, [[fore0, left, ~fore1, ~right], *front])
    builder.cylinder(low, axis, scale(xdir, -1.0), radius, 1.0, [[back0, right, ~back1, ~left]])
    return [~back0, ~fore0], [fore1, back1]


def pin_boundary(shape: PinShape) -> Boundary:
    """Exact boundary of a pin.

    Raises
    ------
    DetailError
        A size that is not positive, or a head that is no wider than the pin.
    """
    if shape.diameter <= 0.0 or shape.length <= 0.0:
        raise DetailError(
            f"a pin of {shape.diameter:.6g} mm and length {shape.length:.6g} mm is no solid"
        )
    headed = shape.head_height > 0.0
    if headed and shape.head_diameter <= shape.diameter:
        raise DetailError(
            f"the pin's head of {shape.head_diameter:.6g} mm is no wider than its shaft of "
            f"{shape.diameter:.6g} mm"
        )
    builder = BoundaryBuilder()
    foot, tip = drum(builder, (0.0, 0.0, 0.0), (0.0, 0.0, shape.length), X, shape.diameter / 2.0)
    if headed:
        under = (0.0, 0.0, -shape.head_height)
        low, high = drum(builder, under, (0.0, 0.0, 0.0), X, shape.head_diameter / 2.0)
        builder.plane(DOWN, [low])
        builder.plane(UP, [high, foot])
    else:
        builder.plane(DOWN, [foot])
    builder.plane(UP, [tip])
    return builder.build()


def pin_volume(shape: PinShape) -> float:
    """Volume [mm3] of a pin, from its numbers."""
    shaft = shape.diameter**2 * shape.length
    return 0.25 * math.pi * (shaft + shape.head_diameter**2 * shape.head_height)


def ring_boundary(shape: RingShape) -> Boundary:
    """Exact boundary of a ring or cap.

    Raises
    ------
    DetailError
        A bore that leaves no wall, or a floor that leaves no bore.
    """
    if not 0.0 < shape.bore < shape.diameter:
        raise DetailError(
            f"a ring of {shape.diameter:.6g} mm leaves no wall around a bore of {shape.bore:.6g} mm"
        )
    if not 0.0 <= shape.floor < shape.height:
        raise DetailError(
            f"a ring {shape.height:.6g} mm high leaves no bore under a floor of "
            f"{shape.floor:.6g} mm"
        )
    builder = BoundaryBuilder()
    bottom: Vec = (0.0, 0.0, 0.0)
    top: Vec = (0.0, 0.0, shape.height)
    low, high = drum(builder, bottom, top, X, shape.diameter / 2.0)
    if shape.floor > 0.0:
        end = (0.0, 0.0, shape.height - shape.floor)
        builder.plane(DOWN, [low, builder.blind_hole(bottom, end, X, shape.bore / 2.0)])
        builder.plane(UP, [high])
    else:
        near, far = builder.round_hole(bottom, top, X, shape.bore / 2.0)
        builder.plane(DOWN, [low, near])
        builder.plane(UP, [high, far])
    return builder.build()


def ring_volume(shape: RingShape) -> float:
    """Volume [mm3] of a ring or cap, from its numbers."""
    bored = shape.bore**2 * (shape.height - shape.floor)
    return 0.25 * math.pi * (shape.diameter**2 * shape.height - bored)

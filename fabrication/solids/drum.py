"""Drum: the round surface of a cylinder that other parts of a boundary meet."""

from __future__ import annotations

import math
from collections.abc import Sequence

from fabrication.boundary import Vec
from fabrication.solids.builder import BoundaryBuilder, Coedges, add, cross, normalized, scale


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
    axis = normalized(add(high, low, -1.0))
    side = cross(axis, xdir)
    a, b = scale(xdir, radius), scale(side, radius)
    rims = []
    for center in (low, high):
        left, right = builder.point(add(center, b)), builder.point(add(center, b, -1.0))
        fore = builder.arc((right, left), center, a, b, -0.5 * math.pi, 0.5 * math.pi)
        back = builder.arc((left, right), center, a, b, 0.5 * math.pi, 1.5 * math.pi)
        rims.append((left, right, fore, back))
    (left0, right0, fore0, back0), (left1, right1, fore1, back1) = rims
    left, right = builder.line(left0, left1), builder.line(right0, right1)
    builder.cylinder(low, axis, xdir, radius, 1.0, [[fore0, left, ~fore1, ~right], *front])
    builder.cylinder(low, axis, scale(xdir, -1.0), radius, 1.0, [[back0, right, ~back1, ~left]])
    return [~back0, ~fore0], [fore1, back1]

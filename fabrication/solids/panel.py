"""Panels: a pane between two polygons with parallel sides, corners rounded -> exact boundary."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ddgfab.errors import DetailError
from fabrication.solids.boundary import Boundary
from fabrication.solids.builder import (
    BoundaryBuilder,
    Vec,
    add,
    cross,
    dot,
    normalised,
    principal_axes,
    scale,
)
from fabrication.specs import PanelShape

SIDE_PLANE = 1e-7
"""How far [mm] a corner may be off the plane of its side; the kernel refuses 1e-6."""

SHARP = 1e-3
"""A corner whose rounding would be an arc shorter than this [mm] stays as it is: sides in line."""


@dataclass(frozen=True)
class Corner:
    """A rounded corner: its cylinder, and where it touches the sides before and after.

    origin, axis : of the cylinder; radius; sign +1 convex, -1 reflex
    middle : unit vector from the axis to the middle of the face
    centres, touch : for both levels, the ellipse's centre, and the touching points
    a, b : conjugate half-diameters of the ellipse; turn: its angle, 0..pi
    """

    origin: Vec
    axis: Vec
    radius: float
    sign: float
    middle: Vec
    centres: tuple[Vec, Vec]
    touch: tuple[tuple[Vec, Vec], tuple[Vec, Vec]]
    a: Vec
    b: Vec
    turn: float


def _sides(shape: PanelShape, low: list[Vec], high: list[Vec]) -> list[Vec]:
    """Unit outward normals of the side planes; raises `DetailError` where one is skew."""
    normals = []
    for k, (p, q) in enumerate(zip(low, low[1:] + low[:1], strict=True)):
        up = add(high[k], p, -1.0)
        along = add(q, p, -1.0)
        if dot(along, along) == 0.0:
            raise DetailError(f"side {k} of the panel has no length: two corners coincide")
        normal = normalised(cross(along, up))
        off = abs(dot(add(high[(k + 1) % len(low)], p, -1.0), normal))
        if off > SIDE_PLANE:
            raise DetailError(
                f"side {k} of the panel is not plane: a corner is {off:.2g} mm off; "
                f"limit {SIDE_PLANE:.0e} mm"
            )
        normals.append(normal)
    return normals


def _corner(shape: PanelShape, p: Vec, q: Vec, before: Vec, after: Vec) -> Corner | None:
    """The rounding of the corner line p q between side planes; None where it stays sharp."""
    r = shape.corner_radius
    axis = normalised(add(q, p, -1.0))
    sine, cosine = dot(cross(before, after), axis), dot(before, after)
    turn = math.atan2(abs(sine), cosine)
    if r * turn < SHARP:
        return None
    sign = 1.0 if sine > 0.0 else -1.0
    bisector = add(before, after)
    origin = add(p, bisector, -sign * r / (1.0 + cosine))

    def level(vector: Vec) -> Vec:
        """A vector moved along the cylinder into the plane z = 0."""
        return add(vector, axis, -vector[2] / axis[2])

    low = level(origin)
    high = add(low, axis, shape.thickness / axis[2])
    radial = scale(before, sign * r)
    a, to_after = level(radial), level(scale(after, sign * r))
    b = level(scale(cross(axis, radial), sign))
    return Corner(
        origin,
        axis,
        r,
        sign,
        scale(normalised(bisector), sign),
        (low, high),
        ((add(low, a), add(low, to_after)), (add(high, a), add(high, to_after))),
        a,
        b,
        turn,
    )


def _check_room(corners: list[Corner | None], low: list[Vec], high: list[Vec]) -> None:
    """Raise `DetailError` where a side is shorter than what its roundings take."""
    n = len(low)
    for level, sharp in enumerate((low, high)):
        for k in range(n):
            here, there = corners[k], corners[(k + 1) % n]
            p = sharp[k] if here is None else here.touch[level][1]
            q = sharp[(k + 1) % n] if there is None else there.touch[level][0]
            along = add(sharp[(k + 1) % n], sharp[k], -1.0)
            left = dot(add(q, p, -1.0), along) / math.sqrt(dot(along, along))
            if left <= 0.0:
                raise DetailError(
                    f"side {k} of the panel is {math.sqrt(dot(along, along)):.6g} mm long, "
                    f"{-left:.6g} mm too short for its rounded corners; use a smaller radius"
                )


def panel_boundary(shape: PanelShape) -> Boundary:
    """Exact boundary of a panel.

    Raises
    ------
    DetailError
        A side is not plane or too short for its corners, or the polygons run clockwise.
    """
    low: list[Vec] = [(x, y, 0.0) for x, y in shape.inner.tolist()]
    high: list[Vec] = [(x, y, shape.thickness) for x, y in shape.outer.tolist()]
    n = len(low)
    if n < 3 or len(high) != n or shape.thickness <= 0.0:
        raise DetailError(
            f"a panel of {n} and {len(high)} corners and thickness {shape.thickness:.6g} mm is no "
            f"solid"
        )
    for name, polygon in (("inner", low), ("outer", high)):
        twice = sum(cross(p, q)[2] for p, q in zip(polygon, polygon[1:] + polygon[:1], strict=True))
        if twice <= 0.0:
            raise DetailError(
                f"the {name} polygon of the panel has area {twice / 2:.6g} mm2: the gap is wider "
                f"than the panel, or it runs clockwise"
            )
    normals = _sides(shape, low, high)
    corners: list[Corner | None] = [None] * n
    if shape.corner_radius > 0.0:
        corners = [_corner(shape, low[k], high[k], normals[k - 1], normals[k]) for k in range(n)]
    _check_room(corners, low, high)
    builder = BoundaryBuilder()
    # Per corner and level: the point before, the point after, and the arc between, if any.
    bottom: list[tuple[int, int]] = []
    top: list[tuple[int, int]] = []
    arcs: list[tuple[int, int] | None] = []
    for k, corner in enumerate(corners):
        if corner is None:
            i, j = builder.point(low[k]), builder.point(high[k])
            bottom.append((i, i))
            top.append((j, j))
            arcs.append(None)
            continue
        ends = [(builder.point(p), builder.point(q)) for p, q in corner.touch]
        bottom.append(ends[0])
        top.append(ends[1])
        a, b, phi = principal_axes(corner.a, corner.b)
        one, two = (
            builder.arc(ends[level], corner.centres[level], a, b, -phi, corner.turn - phi)
            for level in (0, 1)
        )
        arcs.append((one, two))
    lower_loop: list[int] = []
    upper_loop: list[int] = []
    for k, corner in enumerate(corners):
        edge = arcs[k]
        if corner is not None and edge is not None:
            first = builder.line(bottom[k][0], top[k][0])
            last = builder.line(bottom[k][1], top[k][1])
            builder.cylinder(
                corner.origin,
                corner.axis,
                corner.middle,
                corner.radius,
                corner.sign,
                [[edge[0], last, ~edge[1], ~first]],
            )
            lower_loop.append(edge[0])
            upper_loop.append(edge[1])
        after = (k + 1) % n
        below = builder.line(bottom[k][1], bottom[after][0])
        above = builder.line(top[k][1], top[after][0])
        here = builder.line(bottom[k][1], top[k][1])
        there = builder.line(bottom[after][0], top[after][0])
        builder.plane(normals[k], [[below, there, ~above, ~here]])
        lower_loop.append(below)
        upper_loop.append(above)
    builder.plane((0.0, 0.0, -1.0), [[~coedge for coedge in reversed(lower_loop)]])
    builder.plane((0.0, 0.0, 1.0), [upper_loop])
    return builder.build()

"""Panels: a pane between two polygons with parallel sides, corners rounded."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Self

import numpy as np

from ddgfab.errors import DetailError
from ddgfab.mesh import Floats
from fabrication.boundary import Boundary, Vec
from fabrication.solids.builder import (
    BoundaryBuilder,
    add,
    cross,
    dot,
    normalized,
    principal_axes,
    scale,
)
from fabrication.solids.polygon import area, least_rectangle, side_vectors, turns
from fabrication.specs import Kind
from fabrication.variants import Variants, key_of

if TYPE_CHECKING:
    from fabrication.drawings.views import Drawing

PANEL: Final = Kind(
    role="panel",
    mark="P",
    prefix="PP",
    title="Panels",
    color=(0.45, 0.72, 0.74),
    finish="glass",
    shown=(0.36, 0.72, 0.76),
    form="sheet",
    ifc="IfcPlate",
)

M2_PER_MM2: Final = 1e-6

ROUND: Final = 1e-3
"""Below this part of a polygon's size its first Fourier coefficient gives no direction."""

SIDE_PLANE: Final = 1e-7
"""How far [mm] a corner may be off the plane of its side; the kernel refuses 1e-6."""

SHARP: Final = 1e-3
"""A corner whose rounding would be an arc shorter than this [mm] stays as it is: sides in line."""


@dataclass(frozen=True, eq=False)
class PanelShape:
    """A pane between z = 0 (inner, polygon `inner`) and z = thickness (outer, polygon `outer`).

    inner, outer : (n, 2) corners before rounding, counterclockwise; equal for square sides; for
        mitred sides corresponding sides are parallel, so every side face is plane.
    corner_radius : radius [mm] of the cylinders that round the corners; 0 for sharp ones.
    """

    thickness: float
    inner: Floats
    outer: Floats
    corner_radius: float = 0.0

    def key(self) -> Hashable:
        """Number of sides, whether they are square, thickness and rounding."""
        square = np.array_equal(self.inner, self.outer)
        return (len(self.inner), square, key_of(self.thickness), key_of(self.corner_radius))

    @classmethod
    def variants(cls, shapes: Sequence[Self]) -> Variants:
        """Beginning at each of their corners."""
        return panel_variants(shapes)

    def geometry(self) -> Boundary:
        """Always exact."""
        return panel_boundary(self)

    def second_volume(self) -> float:
        """Prismatoid less what rounding its corners takes."""
        return panel_volume(self)

    def dimensions(self) -> dict[str, Any]:
        """Area of the outer surface, least rectangle round the pane, outer sides and angles."""
        small, large = least_rectangle(np.concatenate([self.inner, self.outer])).tolist()
        found = {
            "area_m2": float(area(self.outer, self.corner_radius)) * M2_PER_MM2,
            "thickness_mm": self.thickness,
            "width_mm": small,
            "height_mm": large,
        }
        lengths = np.linalg.norm(side_vectors(self.outer), axis=1).tolist()
        angles = np.degrees(np.pi - turns(self.outer)).tolist()
        for k, (length, angle) in enumerate(zip(lengths, angles, strict=True), 1):
            found[f"edge_{k}_mm"], found[f"angle_{k}_deg"] = length, angle
        return found

    def drawing(self, about: Mapping[str, Any]) -> Drawing:
        """Seen from outside, side 1 at the bottom."""
        from fabrication.parts.panel_drawing import panel_drawing

        return panel_drawing(self)


def panel_variants(shapes: Sequence[PanelShape]) -> Variants:
    """Panels of one key, beginning at each of their corners.

    The frame's direction is that of the first Fourier coefficient of the corners, which depends on
    all corners alike and turns with the polygon.
    """
    inner = np.array([shape.inner for shape in shapes]) @ [1.0, 1j]
    outer = np.array([shape.outer for shape in shapes]) @ [1.0, 1j]
    count = inner.shape[1]
    center = inner.mean(axis=1)
    inner, outer = inner - center[:, None], outer - center[:, None]
    wave = np.exp(-2j * np.pi * np.arange(count) / count)
    first = inner @ wave
    doubtful = bool((np.abs(first) < ROUND * np.abs(inner).sum(axis=1)).any())
    square = np.array_equal(shapes[0].inner, shapes[0].outer)
    points, turns = [], []
    for k in range(count):
        own = np.roll(inner, -k, axis=1)
        turned = own[:, 1] - own[:, 0] if doubtful else first * wave[k].conj()
        turned = turned / np.abs(turned)
        corners = own if square else np.hstack([own, np.roll(outer, -k, axis=1)])
        corners = corners * turned.conj()[:, None]
        points.append(np.stack([corners.real, corners.imag], axis=-1))
        turns.append(np.angle(turned))
    shift = np.zeros((len(shapes), count, 3))
    shift[:, :, 0], shift[:, :, 1] = center.real[:, None], center.imag[:, None]
    return Variants.about_z(np.stack(points, axis=1), np.stack(turns, axis=1), shift)


@dataclass(frozen=True)
class Corner:
    """A rounded corner: its cylinder, and where it touches the sides before and after.

    origin, axis : of the cylinder; radius; sign +1 convex, -1 reflex
    middle : unit vector from the axis to the middle of the face
    centers, touch : for both levels, the ellipse's center, and the touching points
    a, b : conjugate half-diameters of the ellipse; turn: its angle, 0..pi
    """

    origin: Vec
    axis: Vec
    radius: float
    sign: float
    middle: Vec
    centers: tuple[Vec, Vec]
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
        normal = normalized(cross(along, up))
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
    axis = normalized(add(q, p, -1.0))
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
        scale(normalized(bisector), sign),
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
            f"a panel of {n} and {len(high)} corners and thickness {shape.thickness:.6g} mm is not "
            f"a solid"
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
            builder.arc(ends[level], corner.centers[level], a, b, -phi, corner.turn - phi)
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


def panel_volume(shape: PanelShape) -> float:
    """Volume [mm3] of a panel: prismatoid (Simpson is exact), less what rounding its corners takes.

    Each rounding takes r^2 (tan(turn / 2) - turn / 2) across the corner line, all along it.
    """
    middle = 0.5 * (shape.inner + shape.outer)
    areas = [float(area(polygon)) for polygon in (shape.inner, middle, shape.outer)]
    total = shape.thickness / 6.0 * (areas[0] + 4.0 * areas[1] + areas[2])
    if shape.corner_radius > 0.0:
        along = np.roll(shape.inner, -1, axis=0) - shape.inner
        sides = np.column_stack([along, np.zeros(len(along))])
        lines = np.column_stack([shape.outer - shape.inner, np.full(len(along), shape.thickness)])
        normals = np.cross(sides, lines)
        before = np.roll(normals, 1, axis=0)
        length = np.linalg.norm(lines, axis=1)
        sine = np.sum(np.cross(before, normals) * lines, axis=1) / length
        turn = np.arctan2(sine, np.sum(before * normals, axis=1))
        taken = np.tan(turn / 2.0) - turn / 2.0
        total -= shape.corner_radius**2 * float(np.sum(taken * length))
    return total

"""Combed ends of flat bars: slots from side to side, parallel to each other, and bolts across them.

The slots hold the discs of a node: they are square to its axis, open at the cut and at both sides.
Bolts run along the axis; head and nut stand in round recesses with flat floors.
"""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from ddgfab.errors import DetailError
from fabrication.boundary import Vec
from fabrication.parts.beam.slot import bar_sides
from fabrication.parts.beam.stud import along
from fabrication.solids.builder import BoundaryBuilder, Coedges, add, dot, scale
from fabrication.solids.section import segments
from fabrication.solids.sweep import End, walls
from fabrication.specs import Loop
from fabrication.variants import key_of

if TYPE_CHECKING:
    from fabrication.parts.beam.shape import BeamShape, EndCut

SLOTS: Final = 2
"""Slots of an end."""


@dataclass(frozen=True)
class CombEnd:
    """Two slots and a row of bolts along the axis of the node, from a flat cut [mm].

    z : height at which the row's reference point lies in the cut, y = 0
    offset : of the middle between the slots above that point, along the cut
    spacing : from the middle of one slot to that of the other
    width, depth : of the slots, their depth square to the cut
    steps : from the cut to the bolts, square to it
    diameter : of their holes
    recess, grip : diameter of the recesses, and from floor to floor
    """

    z: float
    offset: float
    spacing: float
    width: float
    depth: float
    steps: tuple[float, ...]
    diameter: float
    recess: float
    grip: float

    def key(self) -> Hashable:
        """What must agree exactly for two ends to be equal; the offset need not."""
        sizes = (self.z, self.spacing, self.width, self.depth, self.diameter, self.recess)
        return (*map(key_of, sizes), key_of(self.grip), tuple(map(key_of, self.steps)))

    @property
    def slots(self) -> tuple[tuple[float, float], ...]:
        """From where to where along the cut each slot reaches, upwards."""
        middles = (self.offset - 0.5 * self.spacing, self.offset + 0.5 * self.spacing)
        return tuple((w - 0.5 * self.width, w + 0.5 * self.width) for w in middles)

    def details(self, up: float, name: str) -> dict[str, Any]:
        """Columns of a schedule; up: from the bottom of the bar to the reference point."""
        return {
            f"slots_{name}_up_mm": up,
            f"slots_{name}_middle_mm": self.offset,
            f"slots_{name}_apart_mm": self.spacing,
            f"slots_{name}_width_mm": self.width,
            f"slots_{name}_depth_mm": self.depth,
            **{
                f"bolts_{name}_{order}_mm": step
                for order, step in zip(("first", "second"), self.steps, strict=False)
            },
            f"bolts_{name}_hole_mm": self.diameter,
            f"bolts_{name}_recess_mm": self.recess,
            f"bolts_{name}_grip_mm": self.grip,
        }

    @property
    def floors(self) -> tuple[float, float]:
        """The floors of the lower and the upper recesses along the cut."""
        return self.offset - 0.5 * self.grip, self.offset + 0.5 * self.grip


@dataclass(frozen=True)
class _Placed:
    """An end in the beam's (x, z): its reference point, and both directions of its axes."""

    cut: EndCut
    comb: CombEnd
    outward: float

    def at(self, depth: float, w: float) -> tuple[float, float]:
        """(x, z) of a point at a depth from the cut and a height along it."""
        (ix, iz), (ux, uz) = along(self.cut, self.outward)
        x = self.cut.x + self.cut.slope * self.comb.z
        return x + depth * ix + w * ux, self.comb.z + depth * iz + w * uz

    def level(self, depth: float, z: float) -> float:
        """Height along the cut, at a depth from it, of the face at z of the bar."""
        n = math.hypot(1.0, self.cut.slope)
        return n * (z - self.comb.z) - depth * self.outward * self.cut.slope

    def outline(self, low: float, high: float) -> list[tuple[float, float]]:
        """(x, z) of the corners of the end, upwards."""
        cut, depth = self.cut, self.comb.depth
        corners = [(cut.x + cut.slope * low, low)]
        for first, last in self.comb.slots:
            corners += [
                self.at(0.0, first), self.at(depth, first), self.at(depth, last),
                self.at(0.0, last),
            ]  # fmt: skip
        return [*corners, (cut.x + cut.slope * high, high)]


def _ends(shape: BeamShape) -> list[_Placed | None]:
    return [
        None if cut.comb is None else _Placed(cut, cut.comb, outward)
        for cut, outward in ((shape.start, -1.0), (shape.end, 1.0))
    ]


def combed_faces(builder: BoundaryBuilder, shape: BeamShape) -> None:
    """All faces of a flat bar with combs at one or both ends.

    Raises
    ------
    DetailError
        Slots that leave the end, recesses that do not lie in the bar, combs that meet.
    """
    half, low, high = bar_sides(shape.profile)
    check_combs(shape, half, low, high)
    ends = _ends(shape)
    sides = [
        [(cut.x + cut.slope * z, z) for z in (low, high)] if end is None else end.outline(low, high)
        for end, cut in zip(ends, (shape.start, shape.end), strict=True)
    ]
    count = [len(side) for side in sides]
    ring = [(z, x) for x, z in [*sides[0], *reversed(sides[1])]]
    top, bottom = count[0] - 1, sum(count) - 1
    holes: dict[int, list[Coedges]] = {}
    for which, end in enumerate(ends):
        if end is None:
            continue

        def line(corner: int, beyond: int, which: int = which) -> int:
            """Which line of the outline runs between two neighbouring corners of an end."""
            return corner if which == 0 else sum(count) - 1 - beyond

        faces = {
            "top": holes.setdefault(top, []),
            "bottom": holes.setdefault(bottom, []),
        }
        for k in range(SLOTS):
            faces[f"under {k}"] = holes.setdefault(line(1 + 4 * k, 2 + 4 * k), [])
            faces[f"over {k}"] = holes.setdefault(line(3 + 4 * k, 4 + 4 * k), [])
        for step in end.comb.steps:
            _bolt(builder, end, step, (low, high), faces)
    loop = segments(Loop(np.array(ring), np.zeros(len(ring))))
    right, left = End(-half, 0.0, None, -1.0), End(half, 0.0, None, 1.0)
    first, last = walls(builder, _frame, loop, right, left, holes)
    right.face(builder, _frame, [first])
    left.face(builder, _frame, [last])


def _bolt(
    builder: BoundaryBuilder,
    end: _Placed,
    step: float,
    faces_at: tuple[float, float],
    faces: dict[str, list[Coedges]],
) -> None:
    """Walls and floors of the hole and the recesses of one bolt."""
    comb = end.comb
    (ix, iz), (ux, uz) = along(end.cut, end.outward)
    origin: Vec = (*(end.at(step, 0.0)[:1]), 0.0, end.at(step, 0.0)[1])
    up, inwards = (ux, 0.0, uz), (ix, 0.0, iz)
    lower, upper = comb.floors

    def point(w: float) -> Vec:
        return add(origin, up, w)

    def along_axis(u: float, v: float, w: float) -> Vec:
        """Across the axis u is inwards and v along y, or the other way: a right hand with it."""
        one, two = (u, v) if end.outward < 0.0 else (v, u)
        return add(add(scale(up, w), inwards, one), (0.0, 1.0, 0.0), two)

    def tilted(z: float, outward: float) -> End:
        """A face of the bar across the axis of the bolt."""
        slope = -end.outward * end.cut.slope
        ways = (0.0, slope) if end.outward < 0.0 else (slope, 0.0)
        return End(height + end.level(step, z) - slope * away, ways[0], None, outward, ways[1])

    r, away, height = 0.5 * comb.recess, dot(origin, inwards), dot(origin, up)
    u, v = (away, 0.0) if end.outward < 0.0 else (0.0, away)
    circle = segments(Loop(np.array([(u + r, v), (u - r, v)]), np.array([-1.0, -1.0])))
    floor = [End(height + w, 0.0, None, side) for w, side in ((lower, 1.0), (upper, -1.0))]
    mouth, low_floor = walls(builder, along_axis, circle, tilted(faces_at[0], -1.0), floor[0], {})
    faces["bottom"].append(mouth)
    high_floor, mouth = walls(builder, along_axis, circle, floor[1], tilted(faces_at[1], 1.0), {})
    faces["top"].append(mouth)
    slots = comb.slots
    pieces = [
        (lower, slots[0][0], None, "under 0"),
        (slots[0][1], slots[1][0], "over 0", "under 1"),
        (slots[1][1], upper, "over 1", None),
    ]
    for begin, stop, near_face, far_face in pieces:
        near, far = builder.round_hole(
            point(begin), point(stop), (0.0, 1.0, 0.0), 0.5 * comb.diameter
        )
        if near_face is None:
            builder.plane((-up[0], 0.0, -up[2]), [low_floor, near])
        else:
            faces[near_face].append(near)
        if far_face is None:
            builder.plane(up, [high_floor, far])
        else:
            faces[far_face].append(far)


def _frame(u: float, v: float, w: float) -> Vec:
    return (v, w, u)


def comb_volume(shape: BeamShape) -> float:
    """Volume [mm3] that combs take: slots, what is left of the holes, recesses at their axes."""
    half, low, high = bar_sides(shape.profile)
    total = 0.0
    for end in _ends(shape):
        if end is None:
            continue
        comb = end.comb
        total += SLOTS * comb.width * comb.depth * 2.0 * half
        for step in comb.steps:
            lower, upper = comb.floors
            over = end.level(step, high) - upper + lower - end.level(step, low)
            total += 0.25 * math.pi * comb.recess**2 * over
            total += 0.25 * math.pi * comb.diameter**2 * (comb.grip - SLOTS * comb.width)
    return total


def check_combs(shape: BeamShape, half: float, low: float, high: float) -> None:
    """Raise `DetailError` where a comb does not fit its bar."""
    reach = []
    for name, cut, end in zip(
        ("start", "end"), (shape.start, shape.end), _ends(shape), strict=True
    ):
        lean = abs(cut.slope) * (high - low)
        if end is None:
            reach.append(lean)
            continue
        comb, n = end.comb, math.hypot(1.0, cut.slope)
        others = cut.radius is not None or cut.skew != 0.0 or cut.stud or cut.slot or cut.plate
        if others or shape.holes:
            raise DetailError(f"the {name} has slots for discs, but its cut is coped or skew")
        (first, second), radius = comb.slots, 0.5 * comb.recess
        order = [comb.floors[0], *first, *second, comb.floors[1]]
        if any(b <= a for a, b in pairwise(order)):
            raise DetailError(
                f"slots and floors of recesses at the {name} are out of order: {order}"
            )
        for depth in (0.0, comb.depth):
            room = min(first[0] - end.level(depth, low), end.level(depth, high) - second[1])
            if room <= 0.0:
                raise DetailError(
                    f"a slot leaves the {name} of {shape.profile.name} by {-room:.6g} mm, "
                    f"{depth:.6g} mm from the cut"
                )
        for k, step in enumerate(comb.steps):
            tilt = radius * abs(cut.slope)
            room = min(
                end.level(step, high) - tilt - comb.floors[1],
                comb.floors[0] - end.level(step, low) - tilt,
            )
            edge = min(step, half)
            if room <= 0.0 or edge <= radius or comb.diameter >= comb.recess:
                raise DetailError(
                    f"the recess of bolt {k} at the {name} is {room:.6g} mm deep at its lowest "
                    f"rim, and its axis {edge:.6g} mm from the nearest face"
                )
            if step + 0.5 * comb.diameter >= comb.depth:
                raise DetailError(f"the hole of bolt {k} at the {name} leaves its slots")
        for one, two in pairwise(comb.steps):
            if two - one <= comb.recess:
                raise DetailError(f"recesses at the {name} overlap: {two - one:.6g} mm apart")
        reach.append(max(comb.depth, comb.steps[-1] + radius) * n + lean)
    middle = 0.5 * (low + high)
    length = shape.end.x - shape.start.x + (shape.end.slope - shape.start.slope) * middle
    if sum(reach) >= length:
        raise DetailError(
            f"slots and bolts take {sum(reach):.6g} mm of {length:.6g} mm between the cuts"
        )

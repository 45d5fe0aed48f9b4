"""Star nodes: plates that meet at the node axis, one in the plane of each beam, with cross holes.

A prism about z: all plates have one thickness, length and height. They are welded of plate, or
milled from one piece.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final, NamedTuple, Self

import numpy as np

from ddgfab.errors import DetailError
from ddgfab.mesh import Floats
from fabrication.boundary import Boundary, Vec
from fabrication.parts.node import NODE, ReferenceMark
from fabrication.parts.node.shape import ends_of, turn_between
from fabrication.solids.builder import BoundaryBuilder, Coedges
from fabrication.solids.plate import Blank
from fabrication.solids.section import segments
from fabrication.solids.sweep import End, sweep
from fabrication.specs import Kind, Loop
from fabrication.variants import Variants, key_of

if TYPE_CHECKING:
    from fabrication.drawings.views import Drawing

STAR: Final = Kind(
    role=NODE.role,
    mark=NODE.mark,
    prefix="SP",
    title=NODE.title,
    color=NODE.color,
    finish=NODE.finish,
)

STRAIGHT: Final = 1e-6
"""Plates count as opposite when their azimuths differ by a half turn up to this [rad]."""


@dataclass(frozen=True)
class TongueHole:
    """A round hole through the plate of an arm, at a distance from the axis and a height [mm]."""

    arm: int
    distance: float
    z: float


@dataclass(frozen=True, eq=False)
class StarShape:
    """Plates from z0 to z1 about z, the vertex at the origin [mm].

    azimuths : of the plates [rad], counterclockwise, the first at the x axis
    length : of the plates from the axis
    holes : all of one diameter
    """

    thickness: float
    length: float
    z0: float
    z1: float
    azimuths: tuple[float, ...]
    diameter: float
    holes: tuple[TongueHole, ...] = ()
    mark: ReferenceMark | None = None

    def key(self) -> Hashable:
        """Sizes of plates, holes and mark."""
        mark = self.mark and tuple(map(key_of, (self.mark.x, self.mark.diameter, self.mark.depth)))
        sizes = (self.thickness, self.length, self.diameter)
        return (*map(key_of, sizes), len(self.azimuths), len(self.holes), mark)

    @classmethod
    def variants(cls, shapes: Sequence[Self]) -> Variants:
        """Beginning at each of their plates; the height from the bottom counts."""
        first, n = shapes[0], len(shapes)
        count = len(first.azimuths)
        each = len(first.holes) // count
        azimuths = np.array([shape.azimuths for shape in shapes])
        height = np.array([[shape.z1 - shape.z0] for shape in shapes])
        far = np.array([[hole.distance for hole in s.holes] for s in shapes]).reshape(
            n, count, each
        )
        level = np.array([[hole.z - s.z0 for hole in s.holes] for s in shapes])
        level = level.reshape(n, count, each)
        points, turns = [], []
        for k in range(count):
            start = azimuths[:, k]
            around = np.roll(azimuths, -k, axis=1) - start[:, None]
            at = np.repeat(around, each, axis=1)
            rolled = (np.roll(far, -k, axis=1).reshape(n, -1), np.roll(level, -k, axis=1))
            parts = [
                _ring(first.length, around, 0.0 * around),
                _ring(first.length, around, height + 0.0 * around),
                _ring(rolled[0], at, rolled[1].reshape(n, -1)),
            ]
            points.append(np.concatenate(parts, axis=1))
            turns.append(start)
        shift = np.zeros((n, count, 3))
        shift[:, :, 2] = np.array([[shape.z0] for shape in shapes])
        return Variants.about_z(np.stack(points, axis=1), np.stack(turns, axis=1), shift)

    def geometry(self) -> Boundary:
        """Exact boundary.

        Raises
        ------
        DetailError
            Plates that run into each other, holes that leave them.
        """
        return star_boundary(self)

    def second_volume(self) -> float:
        """Area across the axis, less holes and mark."""
        volume = self.area() * (self.z1 - self.z0)
        volume -= len(self.holes) * 0.25 * math.pi * self.diameter**2 * self.thickness
        if self.mark is not None:
            volume -= 0.25 * math.pi * self.mark.diameter**2 * self.mark.depth
        return volume

    def area(self) -> float:
        """Half plates beside each gap, by their trapezoids [mm2]."""
        half = 0.5 * self.thickness
        area = 0.0
        for gap in gaps(self.azimuths):
            area += 2.0 * self.length * half
            if gap < math.pi:
                area -= half**2 / math.tan(gap / 2.0)
            else:
                area += 0.5 * half**2 * math.sin(gap - math.pi)
        return area

    def roots(self) -> list[float]:
        """From the axis to where each plate and the next one, counterclockwise, part [mm]."""
        half = 0.5 * self.thickness
        return [half / math.tan(g / 2.0) if g < math.pi else 0.0 for g in gaps(self.azimuths)]

    def section(self) -> Section:
        """The section across the axis."""
        return star_section(self)

    def circles(self) -> list[tuple[str, float, float]]:
        """Name, radius and an azimuth [rad] between two plates of its round surfaces."""
        return []

    def drawing(self, about: Mapping[str, Any]) -> Drawing:
        """What its sheet shows."""
        from fabrication.parts.plate_nodes_drawing import star_drawing

        return star_drawing(self, about)

    def dimensions(self) -> dict[str, Any]:
        """Diameter over the plates, height, thickness."""
        return {
            "diameter_mm": 2.0 * math.hypot(self.length, 0.5 * self.thickness),
            "height_mm": self.z1 - self.z0,
            "plate_mm": self.thickness,
            "plate_length_mm": self.length,
            "plate_hole_mm": self.diameter,
        }

    def details(self) -> dict[str, Any]:
        """Where its ends and the mark are."""
        return ends_of(self)

    def blanks(self) -> list[Blank]:
        """A plate for each arm, from the axis outwards."""
        small, large = sorted((self.z1 - self.z0, self.length))
        return [Blank("plate of a star", self.thickness, small, large)] * len(self.azimuths)

    def arm(self, azimuth: float | None) -> dict[str, Any]:
        """Holes of the plate in a direction [rad], from the axis outwards; None where none is."""
        own: list[TongueHole] = []
        if azimuth is not None:
            away = [abs(turn_between(of, azimuth)) for of in self.azimuths]
            own = [hole for hole in self.holes if hole.arm == away.index(min(away))]
        found: dict[str, Any] = {}
        for n, name in enumerate(("first", "second")):
            found[f"plate_{{k}}_{name}_mm"] = own[n].distance if own else None
            found[f"plate_{{k}}_{name}_up_mm"] = own[n].z - self.z0 if own else None
        return found


def _ring(radius: float | Floats, azimuth: Floats, z: Floats) -> Floats:
    """(N, k, 3) points in cylinder coordinates."""
    return np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], axis=-1)


def gaps(azimuths: Sequence[float]) -> list[float]:
    """Azimuth difference [rad] from each plate to the next; a full turn in all."""
    closed = [*azimuths, azimuths[0] + 2.0 * math.pi]
    return [b - a for a, b in pairwise(closed)]


def at(azimuth: float, along: float, across: float) -> tuple[float, float]:
    """Point at distances along an azimuth [rad] from the axis, and across, counterclockwise."""
    c, s = math.cos(azimuth), math.sin(azimuth)
    return (along * c - across * s, along * s + across * c)


class Section(NamedTuple):
    """Loops across the axis, and which sides of the first are right and left sides of plates."""

    loops: tuple[Loop, ...]
    right: list[int]
    left: list[int]


def star_section(shape: StarShape) -> Section:
    """The section of plates that meet at the axis."""
    half, length = 0.5 * shape.thickness, shape.length
    points: list[tuple[float, float]] = []
    right, left = [], []
    for azimuth, gap in zip(shape.azimuths, gaps(shape.azimuths), strict=True):
        right.append(len(points) - 1)
        points.append(at(azimuth, length, -half))
        left.append(len(points) + 0)
        points.append(at(azimuth, length, half))
        if gap < math.pi - STRAIGHT:
            points.append(at(azimuth, half / math.tan(gap / 2.0), half))
        elif gap > math.pi + STRAIGHT:
            points += [at(azimuth, 0.0, half), at(azimuth + gap, 0.0, -half)]
        else:  # one line, but two sides: a hole is in that of its plate
            points.append(at(azimuth, 0.0, half))
    right[0] = len(points) - 1
    return Section((Loop(np.array(points), np.zeros(len(points))),), right, left)


def star_boundary(shape: StarShape) -> Boundary:
    """Exact boundary of a star; see `StarShape.geometry`."""
    half, radius = 0.5 * shape.thickness, 0.5 * shape.diameter
    between = gaps(shape.azimuths)
    if len(shape.azimuths) < 2 or not shape.z1 > shape.z0 or min(between) <= 0.0:
        raise DetailError(
            f"a star of {len(shape.azimuths)} plates from z = {shape.z0:.6g} to {shape.z1:.6g} mm "
            "is not a solid"
        )
    inner = shape.roots()
    worst = max(range(len(inner)), key=lambda k: inner[k])
    if inner[worst] >= shape.length:
        raise DetailError(
            f"plates {worst} and {(worst + 1) % len(inner)} at "
            f"{math.degrees(between[worst]):.4g} deg are one up to {inner[worst]:.6g} mm; they are "
            f"{shape.length:.6g} mm long"
        )
    loops, right, left = shape.section()
    builder = BoundaryBuilder()
    side_holes: dict[tuple[int, int], list[Coedges]] = {}
    for k, hole in enumerate(shape.holes):
        root = max(inner[hole.arm], inner[hole.arm - 1])
        room = min(
            hole.distance - root,
            shape.length - hole.distance,
            shape.z1 - hole.z,
            hole.z - shape.z0,
        )
        if room <= radius:
            raise DetailError(
                f"hole {k} of {shape.diameter:.6g} mm is {room:.6g} mm from the edge of its plate: "
                "needs more than its radius"
            )
        for other in shape.holes[:k]:
            apart = math.hypot(hole.distance - other.distance, hole.z - other.z)
            if other.arm == hole.arm and apart <= shape.diameter:
                raise DetailError(f"holes of plate {hole.arm} overlap: {apart:.6g} mm apart")
        azimuth = shape.azimuths[hole.arm]
        near, far = ((*at(azimuth, hole.distance, side), hole.z) for side in (-half, half))
        up: Vec = (0.0, 0.0, 1.0)
        first, last = builder.round_hole(near, far, up, radius)
        side_holes.setdefault((0, right[hole.arm]), []).append(first)
        side_holes.setdefault((0, left[hole.arm]), []).append(last)
    top: list[Coedges] = []
    if shape.mark is not None:
        mark = shape.mark
        if mark.diameter >= shape.thickness or mark.depth >= shape.z1 - shape.z0:
            raise DetailError(f"the mark of {mark.diameter:.6g} mm leaves the plate")
        for hole in shape.holes:
            if hole.arm == 0 and (
                abs(hole.distance - mark.x) <= radius + 0.5 * mark.diameter
                and hole.z + radius >= shape.z1 - mark.depth
            ):
                raise DetailError("the reference mark runs into a hole of plate 0")
        top.append(
            builder.blind_hole(
                (mark.x, 0.0, shape.z1),
                (mark.x, 0.0, shape.z1 - mark.depth),
                (1.0, 0.0, 0.0),
                0.5 * mark.diameter,
            )
        )
    start, end = End(shape.z0, 0.0, None, -1.0), End(shape.z1, 0.0, None, 1.0)
    sweep(builder, _frame, [segments(loop) for loop in loops], start, end, side_holes, top)
    return builder.build()


def _frame(u: float, v: float, w: float) -> Vec:
    return (u, v, w)

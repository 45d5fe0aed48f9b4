"""Nodes of two discs: one above the other on a core, with holes along the axis through both.

Turned from round bar, or discs that are welded to a tube or bar.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import Any, Final, Self

import numpy as np

from ddgfab.errors import DetailError
from fabrication.boundary import Boundary, Vec
from fabrication.parts.node import NODE, ReferenceMark
from fabrication.parts.node.shape import ends_of, turn_between
from fabrication.solids.builder import BoundaryBuilder, Coedges
from fabrication.solids.section import Segment, segments
from fabrication.solids.sweep import End, walls
from fabrication.specs import Kind, Loop
from fabrication.variants import Variants, key_of

SPOOL: Final = Kind(
    role=NODE.role,
    mark=NODE.mark,
    prefix="DP",
    title=NODE.title,
    color=NODE.color,
    finish=NODE.finish,
    form=NODE.form,
)


@dataclass(frozen=True, eq=False)
class SpoolShape:
    """Two discs about z from z0 to z1, the vertex at the origin [mm].

    radius, thickness : of both discs
    core : radius of what is between them
    azimuths : of the arms [rad], counterclockwise, the first at the x axis
    steps : from the axis to the holes of every arm, on the line at its azimuth
    diameter : of the holes
    """

    radius: float
    thickness: float
    core: float
    z0: float
    z1: float
    azimuths: tuple[float, ...]
    steps: tuple[float, ...]
    diameter: float
    mark: ReferenceMark | None = None

    def key(self) -> Hashable:
        """All sizes, and how many arms there are."""
        mark = self.mark and tuple(map(key_of, (self.mark.x, self.mark.diameter, self.mark.depth)))
        sizes = (self.radius, self.thickness, self.core, self.z1 - self.z0, self.diameter)
        return (*map(key_of, sizes), tuple(map(key_of, self.steps)), len(self.azimuths), mark)

    @classmethod
    def variants(cls, shapes: Sequence[Self]) -> Variants:
        """Beginning at each of their arms."""
        n, first = len(shapes), shapes[0]
        azimuths = np.array([shape.azimuths for shape in shapes])
        points, turns = [], []
        for k in range(len(first.azimuths)):
            around = np.roll(azimuths, -k, axis=1) - azimuths[:, k : k + 1]
            far = max(first.steps)
            points.append(
                np.stack([far * np.cos(around), far * np.sin(around), 0.0 * around], axis=-1)
            )
            turns.append(azimuths[:, k])
        shift = np.zeros((n, len(turns), 3))
        shift[:, :, 2] = np.array([[shape.z0] for shape in shapes])
        return Variants.about_z(np.stack(points, axis=1), np.stack(turns, axis=1), shift)

    def geometry(self) -> Boundary:
        """Exact boundary.

        Raises
        ------
        DetailError
            Discs that are no discs, holes that leave them or run into core, mark or each other.
        """
        return spool_boundary(self)

    def second_volume(self) -> float:
        """Discs and core less holes and mark."""
        between = self.z1 - self.z0 - 2.0 * self.thickness
        holes = 2.0 * len(self.azimuths) * len(self.steps) * (0.5 * self.diameter) ** 2
        volume = math.pi * (2.0 * self.radius**2 - holes) * self.thickness
        volume += math.pi * self.core**2 * between
        if self.mark is not None:
            volume -= 0.25 * math.pi * self.mark.diameter**2 * self.mark.depth
        return volume

    def dimensions(self) -> dict[str, Any]:
        """Diameters, height, thickness of the discs."""
        return {
            "diameter_mm": 2.0 * self.radius,
            "height_mm": self.z1 - self.z0,
            "disc_mm": self.thickness,
            "core_diameter_mm": 2.0 * self.core,
            "disc_hole_mm": self.diameter,
        }

    def details(self) -> dict[str, Any]:
        """Where its ends and the mark are."""
        return ends_of(self)

    def arm(self, azimuth: float | None) -> dict[str, Any]:
        """From the axis to the holes of the arm in a direction [rad]; None where none is."""
        is_there = azimuth is not None and (
            min(abs(turn_between(of, azimuth)) for of in self.azimuths) < math.pi
        )
        text = " ".join(f"{step:g}" for step in self.steps)
        return {"disc_holes_{k}_mm": text if is_there else None}


def _frame(u: float, v: float, w: float) -> Vec:
    return (u, v, w)


def _circle(radius: float) -> list[Segment]:
    return segments(Loop(np.array([(radius, 0.0), (-radius, 0.0)]), np.array([1.0, 1.0])))


def spool_boundary(shape: SpoolShape) -> Boundary:
    """Exact boundary of two discs on a core; see `SpoolShape.geometry`."""
    t, inner = shape.thickness, (shape.z0 + shape.thickness, shape.z1 - shape.thickness)
    if not (0.0 < shape.core < shape.radius and t > 0.0 and inner[0] < inner[1]):
        raise DetailError(
            f"discs of radius {shape.radius:.6g} mm, {t:.6g} mm thick, from z = {shape.z0:.6g} to "
            f"{shape.z1:.6g} mm on a core of radius {shape.core:.6g} mm are no node"
        )
    places = [
        (step * math.cos(azimuth), step * math.sin(azimuth))
        for azimuth in shape.azimuths
        for step in shape.steps
    ]
    radius = 0.5 * shape.diameter
    for k, place in enumerate(places):
        far = math.hypot(*place)
        room = min(shape.radius - far, far - shape.core)
        if room <= radius:
            raise DetailError(
                f"hole {k} of {shape.diameter:.6g} mm is {room:.6g} mm from the edge of its disc "
                "or the core: needs more than its radius"
            )
        for other in places[:k]:
            if math.dist(place, other) <= shape.diameter:
                raise DetailError(
                    f"holes of the discs overlap: {math.dist(place, other):.6g} mm apart"
                )
    builder = BoundaryBuilder()
    levels = ((shape.z0, inner[0]), (inner[1], shape.z1))
    core, rims = _circle(shape.core), []
    foot, head = walls(
        builder, _frame, core, End(inner[0], 0.0, None, -1.0), End(inner[1], 0.0, None, 1.0), {}
    )
    through: list[tuple[list[Coedges], list[Coedges]]] = []
    for low, high in levels:
        start, end = End(low, 0.0, None, -1.0), End(high, 0.0, None, 1.0)
        rims.append(walls(builder, _frame, _circle(shape.radius), start, end, {}))
        pairs = [
            builder.round_hole((x, y, low), (x, y, high), (1.0, 0.0, 0.0), radius)
            for x, y in places
        ]
        through.append(([near for near, _ in pairs], [far for _, far in pairs]))
    top = [rims[1][1], *through[1][1]]
    if (mark := shape.mark) is not None:
        if mark.x + 0.5 * mark.diameter >= shape.core or mark.depth >= t:
            raise DetailError(
                f"the reference mark of {mark.diameter:.6g} mm at x = {mark.x:.6g} mm leaves the "
                f"core, or is deeper than the disc, {t:.6g} mm"
            )
        mouth, floor = (mark.x, 0.0, shape.z1), (mark.x, 0.0, shape.z1 - mark.depth)
        top.append(builder.blind_hole(mouth, floor, (1.0, 0.0, 0.0), 0.5 * mark.diameter))
    down, up = (0.0, 0.0, -1.0), (0.0, 0.0, 1.0)
    builder.plane(down, [rims[0][0], *through[0][0]])
    builder.plane(up, [rims[0][1], foot, *through[0][1]])
    builder.plane(down, [rims[1][0], head, *through[1][0]])
    builder.plane(up, top)
    return builder.build()

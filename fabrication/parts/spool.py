"""Nodes of two discs: one above the other on a core, with holes along the axis through both.

The discs are cut from plate and welded to a round bar. They reach into the arms only: a strip along
each, so that nothing stands out between and beside them.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Self

import numpy as np

from ddgfab.errors import DetailError
from fabrication.boundary import Boundary, Vec
from fabrication.parts.node import NODE, ReferenceMark
from fabrication.parts.node.shape import ends_of, turn_between
from fabrication.parts.star import at, gaps
from fabrication.solids.builder import BoundaryBuilder, Coedges
from fabrication.solids.plate import Blank, Plate
from fabrication.solids.polygon import least_rectangle
from fabrication.solids.section import Segment, segments
from fabrication.solids.sweep import End, walls
from fabrication.specs import Kind, Loop
from fabrication.variants import Variants, key_of

if TYPE_CHECKING:
    from fabrication.drawings.views import Drawing

SPOOL: Final = Kind(
    role=NODE.role,
    mark=NODE.mark,
    prefix="DP",
    title=NODE.title,
    color=NODE.color,
    finish=NODE.finish,
    form=NODE.form,
)


SQUARE: Final = 1.5 * math.pi
"""Gap [rad] between two arms at a right angle, round the outside: a corner of the structure."""


@dataclass(frozen=True, eq=False)
class SpoolShape:
    """Two discs about z from z0 to z1, the vertex at the origin [mm].

    length : of the strip of an arm, from the axis
    width : of the strips, half of it on either side of the arm's line
    thickness : of both discs
    core : radius of what is between them
    azimuths : of the arms [rad], counterclockwise, the first at the x axis
    steps : from the axis to the holes of every arm, on the line at its azimuth
    diameter : of the holes
    """

    length: float
    width: float
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
        sizes = (
            self.length, self.width, self.thickness, self.core, self.z1 - self.z0, self.diameter,
        )  # fmt: skip
        return (*map(key_of, sizes), tuple(map(key_of, self.steps)), len(self.azimuths), mark)

    @classmethod
    def variants(cls, shapes: Sequence[Self]) -> Variants:
        """Beginning at each of their arms."""
        n, first = len(shapes), shapes[0]
        azimuths = np.array([shape.azimuths for shape in shapes])
        points, turns = [], []
        for k in range(len(first.azimuths)):
            around = np.roll(azimuths, -k, axis=1) - azimuths[:, k : k + 1]
            far = first.length
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
        """Half strips beside each gap, by triangles from the axis; core, less holes and mark."""
        half, area = 0.5 * self.width, 0.0
        for gap in gaps(self.azimuths):
            area += 2.0 * self.length * half
            if gap <= SQUARE:
                area -= half**2 / math.tan(0.5 * gap)
            else:
                area += half**2 * (1.0 + math.sin(gap - SQUARE))
        holes = len(self.azimuths) * len(self.steps) * 0.25 * math.pi * self.diameter**2
        return 2.0 * (area - holes) * self.thickness + self._beside_discs()

    def _beside_discs(self) -> float:
        """Volume [mm3] of the core between the discs less that of the mark."""
        volume = math.pi * self.core**2 * (self.z1 - self.z0 - 2.0 * self.thickness)
        if self.mark is not None:
            volume -= 0.25 * math.pi * self.mark.diameter**2 * self.mark.depth
        return volume

    def plate(self) -> Plate:
        """A disc, from above: what is cut from plate, twice."""
        radius, turns = 0.5 * self.diameter, np.array([-1.0, -1.0])
        holes = [
            Loop(np.array([(x + radius, y), (x - radius, y)]), turns) for x, y in self._places()
        ]
        return Plate(self.thickness, (_outline(self), *holes), count=2, rest=self._beside_discs())

    def blanks(self) -> list[Blank]:
        """Both discs."""
        small, large = least_rectangle(_outline(self).points).tolist()
        return [Blank("disc of a node", self.thickness, small, large)] * 2

    def _places(self) -> list[tuple[float, float]]:
        """The middles of all holes."""
        return [
            (step * math.cos(azimuth), step * math.sin(azimuth))
            for azimuth in self.azimuths
            for step in self.steps
        ]

    def drawing(self, about: Mapping[str, Any]) -> Drawing:
        """What its sheet shows."""
        from fabrication.parts.plate_nodes_drawing import spool_drawing

        return spool_drawing(self, about)

    def dimensions(self) -> dict[str, Any]:
        """Diameters, height, sizes of the discs."""
        return {
            "diameter_mm": 2.0 * math.hypot(self.length, 0.5 * self.width),
            "height_mm": self.z1 - self.z0,
            "disc_mm": self.thickness,
            "disc_length_mm": self.length,
            "disc_width_mm": self.width,
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
        return {
            f"disc_{{k}}_{name}_mm": step if is_there else None
            for name, step in zip(("first", "second"), self.steps, strict=False)
        }


def _frame(u: float, v: float, w: float) -> Vec:
    return (u, v, w)


def _circle(radius: float) -> list[Segment]:
    return segments(Loop(np.array([(radius, 0.0), (-radius, 0.0)]), np.array([1.0, 1.0])))


def _outline(shape: SpoolShape) -> Loop:
    """Strips along the arms, counterclockwise; neighbours meet where their sides do.

    Beyond a gap of three quarters of a turn the strips end half a width behind the axis.
    """
    half = 0.5 * shape.width
    points = []
    for azimuth, gap in zip(shape.azimuths, gaps(shape.azimuths), strict=True):
        points += [at(azimuth, shape.length, -half), at(azimuth, shape.length, half)]
        if gap <= SQUARE:
            points.append(at(azimuth, half / math.tan(0.5 * gap), half))
        else:
            points += [at(azimuth, -half, half), at(azimuth + gap, -half, -half)]
    return Loop(np.array(points), np.zeros(len(points)))


def spool_boundary(shape: SpoolShape) -> Boundary:
    """Exact boundary of two discs on a core; see `SpoolShape.geometry`."""
    t, inner = shape.thickness, (shape.z0 + shape.thickness, shape.z1 - shape.thickness)
    half = 0.5 * shape.width
    if not (0.0 < shape.core < half < shape.length and t > 0.0 and inner[0] < inner[1]):
        raise DetailError(
            f"discs of strips {shape.length:.6g} mm long and {shape.width:.6g} mm wide, {t:.6g} mm "
            f"thick, from z = {shape.z0:.6g} to {shape.z1:.6g} mm on a core of radius "
            f"{shape.core:.6g} mm are no node"
        )
    narrow = min(gaps(shape.azimuths))
    if half >= shape.length * math.tan(0.5 * narrow):
        raise DetailError(
            f"the strips of two arms at {math.degrees(narrow):.1f} deg, {shape.width:.6g} mm wide, "
            f"are one up to their ends at {shape.length:.6g} mm"
        )
    places = shape._places()
    radius = 0.5 * shape.diameter
    for k, place in enumerate(places):
        far = math.hypot(*place)
        room = min(shape.length - far, far - shape.core, half)
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
    core, outline, rims = _circle(shape.core), segments(_outline(shape)), []
    foot, head = walls(
        builder, _frame, core, End(inner[0], 0.0, None, -1.0), End(inner[1], 0.0, None, 1.0), {}
    )
    through: list[tuple[list[Coedges], list[Coedges]]] = []
    for low, high in levels:
        start, end = End(low, 0.0, None, -1.0), End(high, 0.0, None, 1.0)
        rims.append(walls(builder, _frame, outline, start, end, {}))
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

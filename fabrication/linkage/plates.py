"""Print plates: parts as they lie on the bed, packed so that none overlaps another."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from ddgfab.errors import InputError
from ddgfab.mesh import Floats
from fabrication.specs import Placement, TriangleMesh

BED_MM: Final = (220.0, 220.0)
"""Width and depth [mm] of the most common beds."""

MARGIN_MM: Final = 10.0
"""Land [mm] that stays free along the edge of the bed: brim, and the skirt, which slicers draw 6 mm
off."""

GAP_MM: Final = 5.0
"""Land [mm] between parts: two brims, or the nozzle's way."""

GRID: Final = 100
"""The packer counts in hundredths of a millimetre: whole numbers never overlap by rounding."""

TURNS: Final = 180
"""How many directions are tried for a part that fits a bed only at an angle."""


@dataclass(frozen=True)
class Bed:
    """A printer's bed: width and depth, margin along its edge, gap between parts [mm]."""

    width: float = BED_MM[0]
    depth: float = BED_MM[1]
    margin: float = MARGIN_MM
    gap: float = GAP_MM

    @property
    def land(self) -> tuple[float, float]:
        """What parts may cover [mm]."""
        return self.width - 2 * self.margin, self.depth - 2 * self.margin

    @property
    def room(self) -> tuple[int, int]:
        """The same for the packer, in its units, where every part has a gap beyond its far sides.

        The gap of the last one may lie on the margin.
        """
        width, depth = (math.floor(GRID * (land + self.gap)) for land in self.land)
        return width, depth

    def __str__(self) -> str:
        return f"{self.width:g} x {self.depth:g} mm"


@dataclass(frozen=True, eq=False)
class Printed:
    """A part number to be printed: its mesh, how it lies, and the pieces that are made.

    lying : (4, 4) motion from the part's frame to one in which it is printed, z up; where it
        stands, and how high, does not matter
    """

    number: str
    mesh: TriangleMesh
    lying: Placement
    marks: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Standing:
    """A piece on a plate: its part (position in the list), its mark, (4, 4) placement."""

    part: int
    mark: str
    placement: Placement


Plate = tuple[Standing, ...]


def plates(parts: Sequence[Printed], bed: Bed | None = None) -> tuple[Plate, ...]:
    """Every piece once, on as few plates as the packer finds; the origin is the bed's corner.

    Raises
    ------
    InputError
        A part is larger than the bed, however it is turned; names the part, its size, the bed.
    """
    from rectpack import MaxRectsBssf, PackingBin, PackingMode, newPacker

    bed = bed or Bed()
    feet = [_foot(part, bed) for part in parts]
    packer = newPacker(
        mode=PackingMode.Offline, bin_algo=PackingBin.BFF, pack_algo=MaxRectsBssf, rotation=True
    )
    pieces = [(at, mark) for at, part in enumerate(parts) for mark in part.marks]
    for key, (at, _) in enumerate(pieces):
        packer.add_rect(*(_units(size + bed.gap) for size in feet[at].size), rid=key)
    packer.add_bin(*bed.room, count=math.inf)
    packer.pack()
    filled: list[list[Standing]] = [[] for _ in range(len(packer))]
    for plate, x, y, width, _, key in sorted(packer.rect_list(), key=lambda rect: rect[5]):
        at, mark = pieces[key]
        foot = feet[at]
        turned = width != _units(foot.size[0] + bed.gap)
        corner = np.array([bed.margin + x / GRID, bed.margin + y / GRID, 0.0])
        filled[plate].append(Standing(at, mark, foot.placed(corner, turned)))
    return tuple(tuple(plate) for plate in filled)


@dataclass(frozen=True, eq=False)
class _Foot:
    """How a part stands: motion to its footprint's corner, size of the footprint [mm]."""

    motion: Placement
    size: tuple[float, float]

    def placed(self, corner: Floats, turned: bool) -> Placement:
        """Where the part goes when its footprint's corner is there, as it is or turned."""
        move = np.eye(4)
        if turned:  # a quarter turn brings the footprint to x < 0, from where it is shifted back
            move[:2, :2] = [[0.0, -1.0], [1.0, 0.0]]
            move[0, 3] = self.size[1]
        move[:3, 3] += corner
        return move @ self.motion


def _foot(part: Printed, bed: Bed) -> _Foot:
    """The footprint as the part lies, or turned about the vertical where only that fits."""
    points = part.mesh.vertices @ part.lying[:3, :3].T
    for angle in np.arange(TURNS) * (np.pi / TURNS):  # as it lies comes first
        turn = np.eye(4)
        turn[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        turned = points @ turn[:3, :3].T
        low, size = turned.min(axis=0), np.ptp(turned, axis=0)
        need = sorted(_units(side + bed.gap) for side in size[:2].tolist())
        if all(side <= room for side, room in zip(need, sorted(bed.room), strict=True)):
            motion = turn @ part.lying
            motion[:3, 3] = -low
            return _Foot(motion, (float(size[0]), float(size[1])))
    long, wide = _extent(points)
    land = " x ".join(f"{max(size, 0.0):g}" for size in bed.land)
    raise InputError(
        f"{part.number} ({part.marks[0]}) lies on {long:.1f} x {wide:.1f} mm; a bed of {bed} with "
        f"a margin of {bed.margin:g} mm has room for {land} mm\n"
        "Make the linkage smaller, or state a larger bed (--bed 300x300)."
    )


def _extent(points: Floats) -> tuple[float, float]:
    """Length and width [mm] of points in plan."""
    size = np.ptp(points[:, :2], axis=0)
    return float(size.max()), float(size.min())


def _units(size: float) -> int:
    return math.ceil(GRID * size)

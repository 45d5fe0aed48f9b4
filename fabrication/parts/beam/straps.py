"""Doubled ends of flat bars: two straps welded to the sides of the bar, a tongue between them.

The straps reach beyond the end of the bar and lap over it; bolts go across them.
"""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ddgfab.errors import DetailError
from fabrication.boundary import Vec
from fabrication.parts.beam.slot import bar_sides
from fabrication.solids.builder import BoundaryBuilder, Coedges, normalized
from fabrication.variants import key_of

if TYPE_CHECKING:
    from fabrication.parts.beam.shape import BeamShape, CrossHole, EndCut

SIDES = (-1.0, 1.0)
"""Right and left side of a bar."""


@dataclass(frozen=True)
class StrapEnd:
    """Two straps at an end of a flat bar; the cut is that of the straps [mm].

    thickness, height : of each strap; they lie about the middle of the bar's depth
    reach, lap : beyond the end of the bar, and on its sides, square to the cut
    """

    thickness: float
    height: float
    reach: float
    lap: float

    def key(self) -> Hashable:
        """All sizes."""
        return tuple(map(key_of, (self.thickness, self.height, self.reach, self.lap)))

    def details(self, cut: EndCut, holes: list[CrossHole], name: str) -> dict[str, Any]:
        """Columns of a schedule; holes: across these straps, name: "start" or "end"."""
        stretch = math.hypot(1.0, cut.slope)
        own = sorted(abs(h.x - cut.x - cut.slope * h.z) / stretch for h in holes)
        found: dict[str, Any] = {
            f"straps_{name}_mm": self.thickness,
            f"straps_{name}_height_mm": self.height,
            f"straps_{name}_length_mm": self.reach + self.lap,
            f"straps_{name}_lap_mm": self.lap,
        }
        for step, column in zip(own, ("first", "second"), strict=False):
            found[f"straps_{name}_{column}_mm"] = step
        return found | {f"straps_{name}_hole_mm": hole.diameter for hole in holes[:1]}


@dataclass(frozen=True)
class _Side:
    """An end: x at z = 0 of the straps' cut, of the end of the bar, and of where they end on it."""

    cut: float
    bar: float
    lap: float
    slope: float
    outward: float
    straps: StrapEnd | None
    levels: tuple[float, ...]

    @property
    def ends(self) -> tuple[float, float]:
        """z of the lower and upper sides of the straps."""
        return self.levels[1], self.levels[2]


def bar_end(cut: EndCut, outward: float) -> float:
    """Where the bar between the straps ends on the x axis [mm]."""
    reach = 0.0 if cut.straps is None else cut.straps.reach
    return cut.x - outward * reach * math.hypot(1.0, cut.slope)


def strap_holes(shape: BeamShape, cut: EndCut, outward: float) -> list[CrossHole]:
    """The cross holes that are in the straps of an end."""
    end = bar_end(cut, outward)
    return [hole for hole in shape.holes if outward * (hole.x - end - cut.slope * hole.z) > 0.0]


def straps_volume(shape: BeamShape) -> float:
    """Volume [mm3] of all straps, less their holes."""
    total = 0.0
    for cut, outward in ((shape.start, -1.0), (shape.end, 1.0)):
        if (straps := cut.straps) is None:
            continue
        holes = strap_holes(shape, cut, outward)
        area = straps.height * (straps.reach + straps.lap) * math.hypot(1.0, cut.slope)
        area -= sum(0.25 * math.pi * hole.diameter**2 for hole in holes)
        total += 2.0 * straps.thickness * area
    return total


def _side(shape: BeamShape, cut: EndCut, outward: float) -> _Side:
    _, low, high = bar_sides(shape.profile)
    straps, stretch = cut.straps, math.hypot(1.0, cut.slope)
    bar = bar_end(cut, outward)
    if straps is None:
        return _Side(cut.x, bar, bar, cut.slope, outward, None, (low, high))
    middle = 0.5 * (low + high)
    levels = (low, middle - 0.5 * straps.height, middle + 0.5 * straps.height, high)
    lap = bar - outward * straps.lap * stretch
    return _Side(cut.x, bar, lap, cut.slope, outward, straps, levels)


class _Faces:
    """Draws a bar with straps; points are named by their coordinates, and drawn once."""

    def __init__(self, builder: BoundaryBuilder) -> None:
        self.builder = builder
        self._points: dict[Vec, int] = {}

    def ring(self, corners: list[Vec], *, backwards: bool = False) -> Coedges:
        """Lines from corner to corner."""
        for corner in corners:
            if corner not in self._points:
                self._points[corner] = self.builder.point(corner)
        ids = [self._points[corner] for corner in corners]
        if backwards:
            ids.reverse()
        return [self.builder.line(a, b) for a, b in zip(ids, [*ids[1:], ids[0]], strict=True)]


def strapped_faces(builder: BoundaryBuilder, shape: BeamShape) -> None:
    """All faces of a flat bar with straps at one or both ends.

    Raises
    ------
    DetailError
        Straps that do not fit the bar, holes that leave the straps.
    """
    check_straps(shape)
    half, low, high = bar_sides(shape.profile)
    faces = _Faces(builder)
    start, end = _side(shape, shape.start, -1.0), _side(shape, shape.end, 1.0)

    def at(side: _Side, x: float, y: float, z: float) -> Vec:
        return (x + side.slope * z, y, z)

    for side in (start, end):
        right = [at(side, side.bar, -half, z) for z in side.levels]
        left = [at(side, side.bar, half, z) for z in side.levels]
        loop = [right[0], *left, *right[:0:-1]]
        builder.plane(_across(side), [faces.ring(loop, backwards=side.outward < 0.0)])
        if side.straps is not None:
            for sign in SIDES:
                _strap(faces, shape, side, sign)
    around = ((start, -half), (end, -half), (end, half), (start, half))
    for z, up in ((low, -1.0), (high, 1.0)):
        corners = [at(side, side.bar, y, z) for side, y in around]
        builder.plane((0.0, 0.0, up), [faces.ring(corners, backwards=up < 0.0)])
    for sign in SIDES:
        y = sign * half
        loop = [*_border(start, y)[::-1], *_border(end, y)]
        builder.plane((0.0, sign, 0.0), [faces.ring(loop, backwards=sign > 0.0)])


def _across(side: _Side) -> Vec:
    """Normal of the cuts at an end."""
    return normalized((side.outward, 0.0, -side.outward * side.slope))


def _border(side: _Side, y: float) -> list[Vec]:
    """The end of a side of the bar from its bottom to its top, round the strap on it."""

    def at(x: float, z: float) -> Vec:
        return (x + side.slope * z, y, z)

    first, last = at(side.bar, side.levels[0]), at(side.bar, side.levels[-1])
    if side.straps is None:
        return [first, last]
    low, high = side.ends
    return [
        first,
        at(side.bar, low),
        at(side.lap, low),
        at(side.lap, high),
        at(side.bar, high),
        last,
    ]


def _strap(faces: _Faces, shape: BeamShape, side: _Side, sign: float) -> None:
    """Faces of a strap on one side of the bar, but for what lies on it."""
    assert side.straps is not None
    half, _, _ = bar_sides(shape.profile)
    inner, outer = sign * half, sign * (half + side.straps.thickness)
    low, high = side.ends
    builder, ahead = faces.builder, side.outward > 0.0

    def at(x: float, y: float, z: float) -> Vec:
        return (x + side.slope * z, y, z)

    def upright(x0: float, x1: float, y: float) -> list[Vec]:
        """A rectangle across y, counterclockwise seen from the right; x0 lies behind x1."""
        return [at(x0, y, low), at(x1, y, low), at(x1, y, high), at(x0, y, high)]

    mouths: tuple[list[Coedges], list[Coedges]] = ([], [])
    for hole in strap_holes(shape, shape.end if ahead else shape.start, side.outward):
        ys = sorted((inner, outer))
        near, far = builder.round_hole(
            (hole.x, ys[0], hole.z), (hole.x, ys[1], hole.z), (1.0, 0.0, 0.0), 0.5 * hole.diameter
        )
        mouths[sign > 0.0].append(near)  # on the inner face of the left strap
        mouths[sign < 0.0].append(far)
    out = upright(*((side.lap, side.cut) if ahead else (side.cut, side.lap)), outer)
    free = upright(*((side.bar, side.cut) if ahead else (side.cut, side.bar)), inner)
    outward, inward = (mouths[0], mouths[1])
    builder.plane((0.0, sign, 0.0), [faces.ring(out, backwards=sign > 0.0), *outward])
    builder.plane((0.0, -sign, 0.0), [faces.ring(free, backwards=sign < 0.0), *inward])
    ends = [side.lap, side.bar, side.cut] if ahead else [side.cut, side.bar, side.lap]
    for z, up in ((low, -1.0), (high, 1.0)):
        inside = [at(x, inner, z) for x in ends]
        outside = [at(x, outer, z) for x in (ends[0], ends[-1])]
        loop = [*inside, *outside[::-1]] if sign > 0.0 else [*outside, *inside[::-1]]
        builder.plane((0.0, 0.0, up), [faces.ring(loop, backwards=up < 0.0)])
    y0, y1 = sorted((inner, outer))
    normal = _across(side)
    back: Vec = (-normal[0], 0.0, -normal[2])
    for x, way, turned in ((side.cut, normal, not ahead), (side.lap, back, ahead)):
        loop = [at(x, y0, low), at(x, y1, low), at(x, y1, high), at(x, y0, high)]
        builder.plane(way, [faces.ring(loop, backwards=turned)])


def check_straps(shape: BeamShape) -> None:
    """Raise `DetailError` where straps or holes do not fit; see `strapped_faces`."""
    _, low, high = bar_sides(shape.profile)
    sides = _side(shape, shape.start, -1.0), _side(shape, shape.end, 1.0)
    least = min(
        sides[1].lap - sides[0].lap + z * (sides[1].slope - sides[0].slope) for z in (low, high)
    )
    for name, side, cut in zip(("start", "end"), sides, (shape.start, shape.end), strict=True):
        straps = side.straps
        if cut.radius is not None or cut.skew != 0.0 or cut.stud or cut.slot or cut.plate:
            raise DetailError(f"the {name} of a bar with straps is coped, skew or has a hole")
        if straps is None:
            continue
        if not 0.0 < straps.height < high - low or min(straps.thickness, straps.lap) <= 0.0:
            raise DetailError(
                f"the {name} has straps {straps.height:.6g} mm high on a bar of "
                f"{high - low:.6g} mm, {straps.lap:.6g} mm on its side: they need less height than "
                "the bar, and a length on it"
            )
    if least <= 0.0:
        raise DetailError(f"the straps of both ends meet: {least:.6g} mm are left between them")
    for hole in shape.holes:
        radius = 0.5 * hole.diameter
        room = -math.inf
        for side in sides:
            if side.straps is None:
                continue
            stretch = math.hypot(1.0, side.slope)
            x = hole.x - side.slope * hole.z
            ahead = side.outward * (x - side.bar) / stretch
            behind = side.outward * (side.cut - x) / stretch
            tall = min(hole.z - side.ends[0], side.ends[1] - hole.z)
            room = max(room, min(ahead, behind, tall))
        if room <= radius:
            raise DetailError(
                f"the hole of {hole.diameter:.6g} mm at x = {hole.x:.6g}, z = {hole.z:.6g} mm is "
                f"{room:.6g} mm from the edge of its straps: needs more than its radius"
            )

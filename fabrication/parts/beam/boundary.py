"""Beams: a profile swept between two cuts, with round holes across -> exact boundary."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import combinations
from typing import TYPE_CHECKING, Final

import numpy as np

from ddgfab.errors import DetailError
from fabrication.boundary import Boundary, Cut, Tool, Vec
from fabrication.parts.beam.comb import combed_faces
from fabrication.parts.beam.end_plate import check_plates, plate_faces
from fabrication.parts.beam.end_plate import inner_end as bar_end
from fabrication.parts.beam.slot import slotted_faces
from fabrication.parts.beam.straps import strapped_faces
from fabrication.parts.beam.stud import (
    HAND_HOLE_WELD,
    StudHole,
    hollow_opening,
    inner_end,
    solid_opening,
    stud_hole,
    window,
)
from fabrication.solids.builder import BoundaryBuilder, Coedges, add
from fabrication.solids.section import Segment, distance_to, segments
from fabrication.solids.sweep import End, sweep, walls

if TYPE_CHECKING:
    from fabrication.parts.beam.shape import BeamShape, CrossHole, EndCut

OVERLAP: Final = 1.0
"""How far [mm] the cylinder that copes an end reaches beyond the blank."""

SIDEWAYS: Final = 1e-9
"""An arc turns back sideways when it reaches farther than its ends by more than this part."""

VERTICAL: Final = 1e-12
"""A side face counts as perpendicular to y when its line departs by less than this part."""

Wall = tuple[tuple[int, int], float]  # (loop, segment) of a side face, and its y


def frame(u: float, v: float, w: float) -> Vec:
    """The profile's (y, z) and the sweep's x as a point of the beam's frame."""
    return (w, u, v)


def ends_of(shape: BeamShape) -> tuple[End, End]:
    """Both cuts as ends of a sweep."""

    def end(cut: EndCut, outward: float) -> End:
        return End(cut.x, cut.slope, cut.radius, outward, cut.skew)

    return end(shape.start, -1.0), end(shape.end, 1.0)


def beam_is_exact(shape: BeamShape) -> bool:
    """Whether its boundary is exact: no coped end on an arc that turns back sideways."""
    if shape.start.radius is None and shape.end.radius is None:
        return True
    arcs = (s for loop in shape.profile.loops for s in segments(loop) if s.turn)
    return not any(_turns_back(arc) for arc in arcs)


def _turns_back(arc: Segment) -> bool:
    """Whether an arc reaches farther to a side than its ends do."""
    left, right, _, _ = arc.bounds()
    slack = SIDEWAYS * arc.radius
    return left < min(arc.u0, arc.u1) - slack or right > max(arc.u0, arc.u1) + slack


def check_ends(shape: BeamShape, loops: list[list[Segment]]) -> None:
    """Raise `DetailError` where the cuts meet, or a coping cylinder is too thin or skew."""
    bounds = [s.bounds() for loop in loops for s in loop]
    wide = max(max(-left, right) for left, right, _, _ in bounds)
    for name, cut in (("start", shape.start), ("end", shape.end)):
        if cut.radius is not None and cut.skew != 0.0:
            raise DetailError(
                f"the {name} is coped but skew by {cut.skew:.3g}: only a flat cut may be; take "
                '[beam] end = "flat"'
            )
        if cut.radius is not None and wide >= cut.radius:
            raise DetailError(
                f"the {name} is coped by a cylinder of radius {cut.radius:.6g} mm, but profile "
                f"{shape.profile.name} reaches {wide:.6g} mm from the middle: widen the node"
            )
    length, slope = shape.end.x - shape.start.x, shape.end.slope - shape.start.slope
    skew = shape.end.skew - shape.start.skew
    least = min(
        length + slope * v + skew * u
        for left, right, low, high in bounds
        for v in (low, high)
        for u in (left, right)
    )
    if least <= 0.0:
        raise DetailError(
            f"the two cuts cross: the shortest fibre of profile {shape.profile.name} has length "
            f"{least:.6g} mm; lengthen the edge or make the nodes smaller"
        )


def hole_walls(shape: BeamShape, hole: CrossHole, loops: list[list[Segment]]) -> list[Wall]:
    """The flat faces that a cross hole meets, in order of y: in and out of each wall.

    Raises
    ------
    DetailError
        The hole leaves the flat faces perpendicular to y, misses the beam, or meets an end.
    """
    low, high = hole.z - hole.diameter / 2.0, hole.z + hole.diameter / 2.0
    name = f"the hole of {hole.diameter:.6g} mm at x = {hole.x:.6g}, z = {hole.z:.6g} mm"
    walls: list[Wall] = []
    for i, loop in enumerate(loops):
        for k, s in enumerate(loop):
            _, _, bottom, top = s.bounds()
            if top <= low or bottom >= high:
                continue
            upright = not s.turn and abs(s.u1 - s.u0) <= VERTICAL * (top - bottom)
            if not upright or bottom >= low or top <= high:
                raise DetailError(
                    f"{name} leaves the flat faces of profile {shape.profile.name}: "
                    f"move it or make it smaller"
                )
            walls.append(((i, k), s.u0))
    if not walls:
        raise DetailError(f"{name} misses profile {shape.profile.name}")
    walls.sort(key=lambda wall: wall[1])
    start, end = ends_of(shape)
    for cut, (_, y) in ((cut, wall) for cut in (start, end) for wall in [*walls, ((0, 0), 0.0)]):
        if y == 0.0 and not any(a[1] <= 0.0 <= b[1] for a, b in _pairs(walls)):
            continue
        room = cut.outward * (cut.height(y, hole.z) - hole.x) / cut.stretch
        if room <= hole.diameter / 2.0:
            raise DetailError(
                f"{name} is {room:.6g} mm from the cut at the "
                f"{'end' if cut.outward > 0 else 'start'}: needs more than its radius"
            )
    return walls


def _pairs(walls: list[Wall]) -> list[tuple[Wall, Wall]]:
    return list(zip(walls[::2], walls[1::2], strict=True))


def check_hole_pairs(holes: tuple[CrossHole, ...]) -> None:
    """Raise `DetailError` where two cross holes run into each other."""
    for one, two in combinations(holes, 2):
        apart = math.hypot(one.x - two.x, one.z - two.z)
        if apart <= (one.diameter + two.diameter) / 2.0:
            raise DetailError(
                f"the holes at x = {one.x:.6g} and {two.x:.6g} mm are {apart:.6g} mm apart: they "
                f"overlap; move them more than {(one.diameter + two.diameter) / 2:.6g} mm apart"
            )


def beam_geometry(shape: BeamShape) -> Boundary | Cut:
    """Exact boundary of a beam, or the cut that copes its ends.

    Raises
    ------
    DetailError
        Cuts that cross, a coping cylinder that is too thin or skew, holes that do not fit.
    """
    return beam_boundary(shape) if beam_is_exact(shape) else beam_cut(shape)


def beam_cut(shape: BeamShape) -> Cut:
    """A beam whose coped ends reach, flat, to the coping axes, and the cylinders that cope them."""
    loops = [segments(loop) for loop in shape.profile.loops]
    check_ends(shape, loops)
    for hole in shape.holes:
        hole_walls(shape, hole, loops)

    def flat(cut: EndCut, outward: float) -> EndCut:
        if cut.radius is None:
            return cut
        beyond = outward * cut.radius * math.hypot(1.0, cut.slope)
        return replace(cut, x=cut.x + beyond, radius=None)

    blank = beam_boundary(replace(shape, start=flat(shape.start, -1.0), end=flat(shape.end, 1.0)))
    tools = []
    for end in ends_of(shape):
        if end.radius is None:
            continue
        n = end.stretch
        away: Vec = (end.outward / n, 0.0, -end.outward * end.slope / n)
        axis: Vec = (end.slope / n, 0.0, 1.0 / n)
        origin = add((end.at, 0.0, 0.0), away, end.radius)
        reach = (blank.points - np.array(origin)) @ np.array(axis)
        low, high = float(reach.min()) - OVERLAP, float(reach.max()) + OVERLAP
        tools.append(Tool(add(origin, axis, low), axis, away, end.radius, high - low))
    return Cut(blank, tuple(tools), blank.genus)  # a cope changes no handle


def beam_boundary(shape: BeamShape) -> Boundary:
    """Exact boundary of a beam that `beam_is_exact`; raises `DetailError` where it cannot be."""
    loops = [segments(loop) for loop in shape.profile.loops]
    check_ends(shape, loops)
    check_hole_pairs(shape.holes)
    builder = BoundaryBuilder()
    if shape.start.comb is not None or shape.end.comb is not None:
        combed_faces(builder, shape)
        return builder.build()
    if shape.start.straps is not None or shape.end.straps is not None:
        strapped_faces(builder, shape)
        return builder.build()
    if shape.start.slot is not None or shape.end.slot is not None:
        slotted_faces(builder, shape)
        return builder.build()
    side_holes: dict[tuple[int, int], list[Coedges]] = {}
    for hole in shape.holes:
        for (face_in, y_in), (face_out, y_out) in _pairs(hole_walls(shape, hole, loops)):
            loop_in, loop_out = builder.round_hole(
                (hole.x, y_in, hole.z),
                (hole.x, y_out, hole.z),
                (1.0, 0.0, 0.0),
                hole.diameter / 2.0,
            )
            side_holes.setdefault(face_in, []).append(loop_in)
            side_holes.setdefault(face_out, []).append(loop_out)
    start, end = ends_of(shape)
    if any(cut.plate or cut.stud for cut in (shape.start, shape.end)):
        _ended(builder, shape, loops, side_holes)
    else:
        sweep(builder, frame, loops, start, end, side_holes)
    return builder.build()


def _ended(
    builder: BoundaryBuilder,
    shape: BeamShape,
    loops: list[list[Segment]],
    side_holes: dict[tuple[int, int], list[Coedges]],
) -> None:
    """Faces of a beam with studs or plates at its ends.

    A bar ends at the inner face of its plate; a hollow section is closed there, and at its studs.
    """
    check_studs(shape, loops)
    check_plates(shape, loops)
    hollow = len(loops) > 1
    outer, inner = list(ends_of(shape)), list(ends_of(shape))
    holes: list[StudHole | None] = [None, None]
    for k, (cut, outward) in enumerate(((shape.start, -1.0), (shape.end, 1.0))):
        if cut.plate is not None:
            outer[k] = inner[k] = bar_end(cut, outward)
        if cut.stud is None:
            continue
        hole = holes[k] = stud_hole(builder, cut, outward)
        if hollow:
            hollow_opening(builder, cut, outward, loops, shape.profile.name, side_holes)
            inner[k] = inner_end(cut, outward)
        else:
            right, left = opening_sides(shape, cut, outward, loops)
            solid_opening(builder, cut, outward, hole, (right, left), side_holes)
    faces: list[list[Coedges]] = [[], []]
    for i, loop in enumerate(loops):
        own = {k: inside for (j, k), inside in side_holes.items() if j == i}
        ends = inner if i else outer
        for k, ring in enumerate(walls(builder, frame, loop, ends[0], ends[1], own)):
            hole_here = holes[k]
            if i and hole_here is not None:
                ends[k].face(builder, frame, [ring, hole_here.inner], cavity=True)
            else:
                faces[k].append(ring)
    for k, (cut, outward) in enumerate(((shape.start, -1.0), (shape.end, 1.0))):
        hole_here = holes[k]
        if cut.plate is not None:
            plate_faces(builder, frame, cut, outward, outer[k], faces[k])
        else:
            mouths = [] if hole_here is None else [hole_here.mouth]
            outer[k].face(builder, frame, [*faces[k], *mouths])


def opening_sides(
    shape: BeamShape, cut: EndCut, outward: float, loops: list[list[Segment]]
) -> tuple[Wall, Wall]:
    """The two upright faces that the opening of a solid bar goes through, right and left.

    Raises
    ------
    DetailError
        The profile has other faces there.
    """
    points = window(cut, outward).points
    low, high = float(points[:, 0].min()), float(points[:, 0].max())
    found: list[Wall] = []
    for k, s in enumerate(loops[0]):
        _, _, bottom, top = s.bounds()
        if top <= low or bottom >= high:
            continue
        upright = not s.turn and abs(s.u1 - s.u0) <= VERTICAL * (top - bottom)
        if not upright or bottom >= low or top <= high:
            found = []
            break
        found.append(((0, k), s.u0))
    if len(found) != 2:
        raise DetailError(
            f"the opening for a stud, from z = {low:.6g} to {high:.6g} mm, leaves the flat sides "
            f"of profile {shape.profile.name}: take a deeper profile or a smaller bolt"
        )
    found.sort(key=lambda wall: wall[1])
    return found[0], found[1]


def check_studs(shape: BeamShape, loops: list[list[Segment]]) -> None:
    """Raise `DetailError` where a stud's hole or opening does not fit the profile or the length."""
    depths = []
    for name, cut in (("start", shape.start), ("end", shape.end)):
        stud = cut.stud
        if stud is None:
            depths.append(0.0)
            continue
        if cut.radius is not None or cut.skew != 0.0:
            raise DetailError(f"the {name} has a stud, but its cut is coped or skew")
        if len(loops) > 2 or 2.0 * stud.corner >= min(stud.length, stud.height):
            raise DetailError(f"the {name} has an opening that is not a rounded rectangle")
        away = distance_to(loops[0], 0.0, stud.z)
        if away <= stud.diameter / 2.0:
            raise DetailError(
                f"the {name} has a hole of {stud.diameter:.6g} mm, {away:.6g} mm from the outline "
                f"of profile {shape.profile.name}: needs more than its radius"
            )
        depths.append(
            (stud.plate + stud.length + HAND_HOLE_WELD) * math.hypot(1.0, cut.slope)
            + stud.height * abs(cut.slope)
        )
    low = min(s.bounds()[2] for loop in loops for s in loop)
    high = max(s.bounds()[3] for loop in loops for s in loop)
    least = min(
        shape.end.x - shape.start.x + (shape.end.slope - shape.start.slope) * z for z in (low, high)
    )
    if sum(depths) >= least:
        raise DetailError(
            f"the openings for studs take {sum(depths):.6g} mm of {least:.6g} mm between the cuts"
        )

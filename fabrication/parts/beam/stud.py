"""Stud ends of beams: a hole perpendicular to the cut, and the opening to tighten the stud.

A solid bar has an opening from side to side; what is left of it before the cut is the plate that
the hole goes through. A hollow section is closed by a plate, and has a hand hole in its lower wall.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from ddgfab.errors import DetailError
from fabrication.boundary import Vec
from fabrication.solids.builder import BoundaryBuilder, Coedges
from fabrication.solids.section import Segment, segments
from fabrication.solids.sweep import End, walls
from fabrication.specs import Loop

if TYPE_CHECKING:
    from fabrication.parts.beam.shape import EndCut

Point = tuple[float, float]
SideHoles = dict[tuple[int, int], list[Coedges]]

HAND_HOLE_WELD: Final = 2.0
"""From the plate to the hand hole [mm]: room for the weld."""

WASHER: Final = 0.95
"""Half a washer, in diameters of the hole: 0.83 to 0.92 (ISO 7089)."""

LEVEL: Final = 1e-9
"""A side of a profile is level when its ends differ by less [mm]."""


class StudHole(NamedTuple):
    """Loops of the hole through the plate: in the cut, and in the plate's inner face."""

    mouth: Coedges
    inner: Coedges


def rounded(corners: list[tuple[float, float]], radius: float) -> Loop:
    """The outline of a convex polygon with rounded corners, clockwise.

    corners : counterclockwise
    """
    points: list[tuple[float, float]] = []
    bulges: list[float] = []
    ring = corners[::-1]
    for k, here in enumerate(ring):
        before, after = ring[k - 1], ring[(k + 1) % len(ring)]
        turn = _turn(before, here, after)
        reach = radius * math.tan(turn / 2.0)
        for other in (before, after):
            part = reach / math.dist(here, other)
            points.append(
                (here[0] + part * (other[0] - here[0]), here[1] + part * (other[1] - here[1]))
            )
        bulges += [-math.tan(turn / 4.0), 0.0]
    return Loop(np.array(points), np.array(bulges))


def _turn(
    before: tuple[float, float], here: tuple[float, float], after: tuple[float, float]
) -> float:
    """Angle [rad] by which a polygon turns at a corner."""
    (a, b), (c, d) = (
        (here[0] - before[0], here[1] - before[1]),
        (after[0] - here[0], after[1] - here[1]),
    )
    return abs(math.atan2(a * d - b * c, a * c + b * d))


def opening_area(cut: EndCut, *, hollow: bool) -> float:
    """Area [mm2] of the opening: a rectangle in a hollow section, else a parallelogram."""
    stud = cut.stud
    assert stud is not None
    lean = 0.0 if hollow else math.atan(abs(cut.slope))
    area = stud.length * stud.height * math.cos(lean)
    for turn in (0.5 * math.pi - lean, 0.5 * math.pi + lean):
        area -= 2.0 * stud.corner**2 * (math.tan(turn / 2.0) - turn / 2.0)
    return area


def inner_end(cut: EndCut, outward: float) -> End:
    """The inner face of the end plate as an end of the cavity."""
    assert cut.stud is not None
    inwards = -outward * cut.stud.plate * math.hypot(1.0, cut.slope)
    return End(cut.x + inwards, cut.slope, None, outward)


def along(cut: EndCut, outward: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """(x, z) unit vectors inwards along the stud, and upwards in the cut."""
    n = math.hypot(1.0, cut.slope)
    return (-outward / n, outward * cut.slope / n), (cut.slope / n, 1.0 / n)


def mouth(cut: EndCut) -> tuple[float, float]:
    """(x, z) of the middle of the stud's hole in the cut."""
    assert cut.stud is not None
    return cut.x + cut.slope * cut.stud.z, cut.stud.z


def stud_hole(builder: BoundaryBuilder, cut: EndCut, outward: float) -> StudHole:
    """The wall of the hole through the plate."""
    assert cut.stud is not None
    (x, z), (inwards, _) = mouth(cut), along(cut, outward)
    plate = cut.stud.plate
    near: Vec = (x, 0.0, z)
    far: Vec = (x + plate * inwards[0], 0.0, z + plate * inwards[1])
    return StudHole(*builder.round_hole(near, far, (0.0, 1.0, 0.0), cut.stud.diameter / 2.0))


def window(cut: EndCut, outward: float) -> Loop:
    """Outline of the opening of a solid bar as (z, x), clockwise.

    Two sides are parallel to the cut, the first of them the plate's inner face, and two to the
    beam. A quarter of its height behind the plate the stud's axis is in its middle, but for what
    the washer needs of the plate.
    """
    stud = cut.stud
    assert stud is not None
    (x, z), (inwards, up) = mouth(cut), along(cut, outward)
    half = 0.5 * stud.height
    # From where the axis leaves the plate, along the cut to the level of the axis at half a height.
    slide = 0.5 * half * inwards[1] / up[1]
    seat = max(half - stud.corner - WASHER * stud.diameter, 0.0)
    slide = min(max(slide, -seat), seat)
    x += stud.plate * inwards[0] + slide * up[0]
    z += stud.plate * inwards[1] + slide * up[1]

    def at(step: float, level: float) -> tuple[float, float]:
        return (z + level * up[1], x - outward * step + level * up[0])

    corners = [at(0.0, half), at(stud.length, half), at(stud.length, -half), at(0.0, -half)]
    if outward > 0.0:
        corners = corners[::-1]
    return rounded(corners, stud.corner)


def stud_details(cut: EndCut, outward: float, loops: Sequence[Loop], name: str) -> dict[str, Any]:
    """Columns of a schedule; outward: -1 at the start, +1 at the end, which is `name`."""
    stud = cut.stud
    assert stud is not None
    walls_at = sorted(float(loop.points[:, 1].min()) for loop in loops[:2])
    low, hollow = walls_at[0], len(walls_at) > 1
    outline = (hand_hole(cut, outward, *walls_at) if hollow else window(cut, outward)).points
    found: dict[str, Any] = {
        f"hole_{name}_up_mm": stud.z - low,
        f"hole_{name}_diameter_mm": stud.diameter,
        f"plate_{name}_mm": stud.plate,
        f"opening_{name}_mm": stud.length,
        f"opening_{name}_height_mm": stud.height,
        f"opening_{name}_corner_mm": stud.corner,
    }
    if hollow:
        at_bottom = cut.x + cut.slope * low
        found[f"opening_{name}_from_mm"] = float(np.abs(outline[:, 0] - at_bottom).min())
    else:
        middle = 0.5 * (outline[:, 0].min() + outline[:, 0].max())
        found[f"opening_{name}_up_mm"] = float(middle) - low
    return found


def plate_side(loop: list[Segment], cut: EndCut, outward: float) -> int:
    """Which line of the outline is the inner face of the plate."""
    (x, z), (inwards, _) = mouth(cut), along(cut, outward)

    def depth(s: Segment) -> float:
        u, v = 0.5 * (s.u0 + s.u1), 0.5 * (s.v0 + s.v1)
        return (v - x) * inwards[0] + (u - z) * inwards[1]

    return min((k for k, s in enumerate(loop) if not s.turn), key=lambda k: depth(loop[k]))


def solid_opening(
    builder: BoundaryBuilder,
    cut: EndCut,
    outward: float,
    hole: StudHole,
    sides: tuple[tuple[tuple[int, int], float], tuple[tuple[int, int], float]],
    side_holes: SideHoles,
) -> None:
    """Faces of the opening of a solid bar between its sides, each a face and its y."""
    loop = segments(window(cut, outward))

    def frame(u: float, v: float, w: float) -> Vec:
        return (v, w, u)

    (right, y0), (left, y1) = sides
    near = plate_side(loop, cut, outward)
    first, last = walls(
        builder,
        frame,
        loop,
        End(y0, 0.0, None, -1.0),
        End(y1, 0.0, None, 1.0),
        {near: [hole.inner]},
    )
    side_holes.setdefault(right, []).append(first)
    side_holes.setdefault(left, []).append(last)


def hand_hole(cut: EndCut, outward: float, lower: float, upper: float) -> Loop:
    """Outline of the hand hole in the lower wall as (x, y), clockwise."""
    stud = cut.stud
    assert stud is not None
    end = inner_end(cut, outward)
    inwards = -outward
    begin = max(inwards * end.height(0.0, z) for z in (lower, upper)) + HAND_HOLE_WELD
    xs = sorted((inwards * begin, inwards * (begin + stud.length)))
    half = 0.5 * stud.height
    corners = [(xs[0], -half), (xs[1], -half), (xs[1], half), (xs[0], half)]
    return rounded(corners, stud.corner)


def lower_wall(loops: list[list[Segment]], name: str) -> tuple[int, int]:
    """The level sides at the bottom of a hollow section: of the outside, and of the inside.

    Raises
    ------
    DetailError
        The profile has none.
    """
    found = []
    for loop in loops[:2]:
        level = [k for k, s in enumerate(loop) if not s.turn and abs(s.v1 - s.v0) <= LEVEL]
        if not level:
            raise DetailError(f"profile {name} has no level lower wall for a hand hole")
        found.append(min(level, key=lambda k: loop[k].v0))
    return found[0], found[1]


def hollow_opening(
    builder: BoundaryBuilder,
    cut: EndCut,
    outward: float,
    loops: list[list[Segment]],
    name: str,
    side_holes: SideHoles,
) -> None:
    """Faces of the hand hole in the lower wall of a hollow section.

    Raises
    ------
    DetailError
        The lower wall is narrower than the hand hole.
    """
    stud = cut.stud
    assert stud is not None
    outer, inner = lower_wall(loops, name)
    bottom, top = loops[0][outer], loops[1][inner]
    room = min(abs(s.u1 - s.u0) for s in (bottom, top))
    if stud.height >= room:
        raise DetailError(
            f"a hand hole {stud.height:.6g} mm wide leaves the lower wall of {name}, which is flat "
            f"over {room:.6g} mm"
        )

    def frame(u: float, v: float, w: float) -> Vec:
        return (u, v, w)

    first, last = walls(
        builder,
        frame,
        segments(hand_hole(cut, outward, bottom.v0, top.v0)),
        End(bottom.v0, 0.0, None, -1.0),
        End(top.v0, 0.0, None, 1.0),
        {},
    )
    side_holes.setdefault((0, outer), []).append(first)
    side_holes.setdefault((1, inner), []).append(last)

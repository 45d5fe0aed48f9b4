"""Slotted beams: flat bars with a slot from an end, open at top and bottom, for a tongue."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from ddgfab.errors import DetailError
from fabrication.boundary import Vec
from fabrication.solids.builder import BoundaryBuilder, Coedges, normalized
from fabrication.specs import Profile

if TYPE_CHECKING:
    from fabrication.parts.beam.shape import BeamShape, CrossHole, EndCut

CORNERS: Final = 4

Strip = tuple[float, float]  # from y to y


def bar_sides(profile: Profile) -> tuple[float, float, float]:
    """Half the width, lowest and highest z [mm] of a flat bar.

    Raises
    ------
    DetailError
        The profile is none.
    """
    loop = profile.loops[0]
    points = loop.points
    y, low, high = float(points[:, 0].max()), float(points[:, 1].min()), float(points[:, 1].max())
    corners = {(round(float(p), 6), round(float(q), 6)) for p, q in points}
    bar = {(round(side, 6), round(level, 6)) for side in (-y, y) for level in (low, high)}
    if len(profile.loops) > 1 or len(points) != CORNERS or loop.bulges.any() or corners != bar:
        raise DetailError(
            f"profile {profile.name} cannot be slotted: only flat bars can, such as FL 80x40"
        )
    return y, low, high


def slotted_faces(builder: BoundaryBuilder, shape: BeamShape) -> None:
    """All faces of a flat bar with a slot at one or both ends, and its cross holes.

    Raises
    ------
    DetailError
        A slot as wide as the bar or deeper than half of it; holes that leave the bar or a cheek.
    """
    half, low, high = bar_sides(shape.profile)
    check_slots(shape, half, low, high)
    outline: list[tuple[float, float, float]] = []  # y, x and slope of every corner

    def corners(cut: EndCut, outward: float) -> list[tuple[float, float, float]]:
        """Corners of an end, with y rising."""
        ends = [(-half, cut.x, cut.slope), (half, cut.x, cut.slope)]
        if cut.slot is None:
            return ends
        side = 0.5 * cut.slot.width
        bottom = cut.x - outward * cut.slot.depth * math.hypot(1.0, cut.slope)
        return [
            ends[0],
            (-side, cut.x, cut.slope),
            (-side, bottom, cut.slope),
            (side, bottom, cut.slope),
            (side, cut.x, cut.slope),
            ends[1],
        ]

    # counterclockwise seen from above: along x on the right side, back on the left
    outline = [*corners(shape.end, 1.0), *reversed(corners(shape.start, -1.0))]
    lower = [builder.point((x + slope * low, y, low)) for y, x, slope in outline]
    upper = [builder.point((x + slope * high, y, high)) for y, x, slope in outline]
    holes = [(hole, strips(shape, hole)) for hole in shape.holes]
    walls: dict[tuple[float, bool, float], list[Coedges]] = {}
    for hole, through in holes:
        for y0, y1 in through:
            first, last = builder.round_hole(
                (hole.x, y0, hole.z), (hole.x, y1, hole.z), (1.0, 0.0, 0.0), hole.diameter / 2.0
            )
            walls.setdefault((y0, False, hole.x), []).append(first)
            walls.setdefault((y1, True, hole.x), []).append(last)
    count = len(outline)
    for k, (y, x, slope) in enumerate(outline):
        j = (k + 1) % count
        y_next, x_next, _ = outline[j]
        around = [
            builder.line(lower[k], lower[j]),
            builder.line(lower[j], upper[j]),
            builder.line(upper[j], upper[k]),
            builder.line(upper[k], lower[k]),
        ]
        if y == y_next:  # a side of the bar or of a slot
            leftwards = x_next < x
            inside = [
                loop
                for (level, left, at), loops in walls.items()
                if level == y and left == leftwards and min(x, x_next) < at < max(x, x_next)
                for loop in loops
            ]
            builder.plane((0.0, 1.0 if leftwards else -1.0, 0.0), [around, *inside])
        else:
            sign = 1.0 if y_next > y else -1.0
            normal: Vec = normalized((sign, 0.0, -sign * slope))
            builder.plane(normal, [around])
    builder.plane(
        (0.0, 0.0, 1.0), [[builder.line(upper[k], upper[k - count + 1]) for k in range(count)]]
    )
    bottom_ring = [builder.line(lower[-k], lower[-k - 1]) for k in range(count)]
    builder.plane((0.0, 0.0, -1.0), [bottom_ring])


def strips(shape: BeamShape, hole: CrossHole) -> list[Strip]:
    """What a cross hole goes through, from y to y: the bar, or the cheeks beside a slot."""
    half, _, _ = bar_sides(shape.profile)
    for cut, outward in ((shape.start, -1.0), (shape.end, 1.0)):
        if cut.slot is None:
            continue
        bottom = cut.x - outward * cut.slot.depth * math.hypot(1.0, cut.slope)
        if outward * (hole.x - (bottom + cut.slope * hole.z)) > 0.0:
            side = 0.5 * cut.slot.width
            return [(-half, -side), (side, half)]
    return [(-half, half)]


def slot_volume(shape: BeamShape) -> float:
    """Volume [mm3] that the slots take."""
    _, low, high = bar_sides(shape.profile)
    return sum(
        cut.slot.width * cut.slot.depth * math.hypot(1.0, cut.slope) * (high - low)
        for cut in (shape.start, shape.end)
        if cut.slot is not None
    )


def check_slots(shape: BeamShape, half: float, low: float, high: float) -> None:
    """Raise `DetailError` where slots or holes do not fit; see `slotted_faces`."""
    middle = 0.5 * (shape.start.x + shape.end.x)
    for name, cut, outward in (("start", shape.start, -1.0), ("end", shape.end, 1.0)):
        stretch = math.hypot(1.0, cut.slope)
        if cut.slot is not None:
            if cut.radius is not None or cut.skew != 0.0 or cut.stud is not None:
                raise DetailError(f"the {name} has a slot, but its cut is coped or skew")
            if not 0.0 < cut.slot.width < 2.0 * half:
                raise DetailError(
                    f"the {name} has a slot {cut.slot.width:.6g} mm wide in a bar of "
                    f"{2.0 * half:.6g} mm"
                )
            reach = cut.slot.depth * stretch + abs(cut.slope) * max(abs(low), abs(high))
            if reach >= outward * (cut.x - middle):
                raise DetailError(
                    f"the {name} has a slot {cut.slot.depth:.6g} mm deep, but the beam is "
                    f"{2.0 * outward * (cut.x - middle):.6g} mm long"
                )
        for hole in shape.holes:
            radius = 0.5 * hole.diameter
            if not low < hole.z - radius < hole.z + radius < high:
                raise DetailError(f"the hole at x = {hole.x:.6g} mm leaves the bar")
            depths = [0.0] if cut.slot is None else [0.0, cut.slot.depth]
            for depth in depths:
                at = cut.x + cut.slope * hole.z - outward * depth * stretch
                room = abs(hole.x - at) / stretch
                beyond = depth == 0.0 and outward * (hole.x - at) > 0.0
                if room <= radius or beyond:
                    raise DetailError(
                        f"the hole of {hole.diameter:.6g} mm at x = {hole.x:.6g} mm is "
                        f"{-room if beyond else room:.6g} mm from the cut or the slot's bottom at "
                        f"the {name}: needs more than its radius"
                    )

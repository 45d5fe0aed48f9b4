"""Radial holes of nodes: where they begin and end, and the faces of the bore between them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from fabrication.solids.section import Segment
from fabrication.specs import Loop

if TYPE_CHECKING:
    from fabrication.parts.node.shape import NodeShape, RadialHole

SAME_AZIMUTH: Final = 1e-9
"""Azimuths [rad] nearer than this are one: a hole there stands on its seat."""

MAX_ARC: Final = math.pi
"""Greatest angle [rad] of one cylinder face: larger ones are split, so no edge is a circle."""


LAND: Final = 1e-3
"""Angle [rad] that is left between the mouth of a hole and the end of a face of the bore."""


@dataclass(frozen=True)
class Drill:
    """A radial hole with what it starts from and where it ends.

    seat : index of its seat, or None on the round surface; bottom: distance [mm] of its flat
    bottom from the axis, None when it opens into the bore.
    """

    hole: RadialHole
    seat: int | None
    bottom: float | None

    @property
    def exact(self) -> bool:
        """Whether it is drawn as it is: it stands on a seat, not in the round surface."""
        return self.seat is not None


def angle_apart(one: float, two: float) -> float:
    """Angle [rad] between two azimuths, 0..pi."""
    return abs((one - two + math.pi) % (2.0 * math.pi) - math.pi)


def drills(shape: NodeShape) -> list[Drill]:
    """The radial holes, each with its seat and bottom."""
    out = []
    for hole in shape.holes:
        seat = next(
            (
                k
                for k, s in enumerate(shape.seats)
                if angle_apart(s.azimuth, hole.azimuth) <= SAME_AZIMUTH
            ),
            None,
        )
        face = shape.radius if seat is None else shape.seats[seat].distance
        out.append(Drill(hole, seat, None if hole.depth is None else face - hole.depth))
    return out


def bore_loop(shape: NodeShape) -> Loop:
    """The bore, clockwise, split between its holes."""
    r, splits = shape.bore, bore_splits(shape)[::-1]
    points = [(r * math.cos(angle), r * math.sin(angle)) for angle in splits]
    turns = [(angle - splits[(k + 1) % len(splits)]) % (2.0 * math.pi) or math.pi
             for k, angle in enumerate(splits)]  # fmt: skip
    return Loop(np.array(points), np.array([-math.tan(turn / 4.0) for turn in turns]))


def bore_splits(shape: NodeShape) -> list[float]:
    """Angles 0..2 pi, ascending, where the faces of the bore end: never in the mouth of a hole.

    Empty where the mouths leave no room for them.
    """
    mouths = []
    for drill in drills(shape):
        if drill.bottom is None and drill.exact and shape.bore > 0.0:
            low, high = (
                math.asin(max(-1.0, min(1.0, (drill.hole.across + side) / shape.bore)))
                for side in (-0.5 * drill.hole.diameter, 0.5 * drill.hole.diameter)
            )
            mouths.append((drill.hole.azimuth + low - LAND, high - low + 2.0 * LAND))
    if not mouths:
        return [0.0, math.pi]
    full = 2.0 * math.pi
    origin = min(start % full for start, _ in mouths)
    taken: list[list[float]] = []  # mouths that overlap as one, start and end, from the first
    for start, size in sorted(((start - origin) % full, size) for start, size in mouths):
        if taken and start <= taken[-1][1]:
            taken[-1][1] = max(taken[-1][1], start + size)
        else:
            taken.append([start, start + size])
    widest = max(end - start for start, end in taken)
    if taken[-1][1] >= full or widest >= MAX_ARC:
        return []
    found = []
    for k, (_, end) in enumerate(taken):
        room = (taken[k + 1][0] if k + 1 < len(taken) else full) - end
        parts = max(2, math.ceil(2.0 * room / (MAX_ARC - widest)))
        found += [(origin + end + room * n / parts) % full for n in range(1, parts)]
    return sorted(found)


def bore_face(bore: list[Segment], hole: RadialHole) -> int:
    """The face of the bore that a hole comes out of."""
    middle = hole.azimuth + math.asin(hole.across / bore[0].radius)
    return min(range(len(bore)), key=lambda k: angle_apart(bore[k].middle, middle)
               - 0.5 * abs(bore[k].turn))  # fmt: skip

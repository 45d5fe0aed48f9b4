"""Stud connections: a radial thread in the node, a plate at the end of the beam on the same axis.

A stud with a nut, or a bolt, goes through the plate into the node. It is put in and tightened
through an opening behind the plate: from side to side of a solid bar, in the lower wall of a hollow
section. Distances: EN 1993-1-8:2005, table 3.3.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar, Final, Self

import numpy as np

from ddgfab.errors import DetailError
from fabrication.gridshell.detailing.connections.base import (
    BOLTED,
    Connection,
    Drilling,
    Joined,
    usual_plate,
)
from fabrication.gridshell.detailing.connections.threads import (
    FastenerChoice,
    check_square,
    drilling,
    least_flat,
    tapped,
    threaded,
)
from fabrication.gridshell.detailing.frames import beam_mark, listed, node_mark
from fabrication.parts.beam import StudEnd
from fabrication.parts.beam.boundary import VERTICAL
from fabrication.solids.section import distance_to, segments
from fabrication.specs import Profile
from fabrication.standards.fasteners import (
    Fastener,
    fasteners,
    wrench_swing,
)
from fabrication.standards.profiles import z_range

if TYPE_CHECKING:
    from fabrication.gridshell.detailing.nodes.base import Joints, NodeSize
    from fabrication.gridshell.project import Project

OPENING_STEP: Final = 5.0
"""Openings [mm] are as long as the fastener, and this or more."""

CORNER: Final = 5.0
"""Radius [mm] of an opening's corners."""

SIDES: Final = 2
"""Sides of a solid bar that its opening goes through."""

HANDLE: Final = 0.5
"""Thickness of a spanner's handle, in widths across flats."""


@dataclass(frozen=True)
class Stud(Connection):
    """A stud with a nut, or a bolt, along the radius through the middle of the end face.

    plates : thicknesses of the plate [mm], the first that a fastener fits is taken
    clearance : from the seat to the plate [mm]
    thread : length of thread in engagement [mm] that the project asks for; None: the usual one
    """

    size: Fastener
    fastener: FastenerChoice
    plates: tuple[float, ...]
    clearance: float
    thread: float | None = None

    keys: ClassVar[tuple[str, ...]] = (*BOLTED, "fastener", "thread_mm")
    summary: ClassVar[str] = (
        "a stud or bolt through the end of the beam into a thread in the node, tightened through "
        "the opening behind it"
    )

    @classmethod
    def of(cls, project: Project) -> Self:
        """The one of a project."""
        size, choice, plates, thread = tapped(project)
        return cls(size, choice, plates, project.beam.clearance_mm, thread)

    def of_size(self, size: Fastener) -> Self:
        """The same with fasteners of another size."""
        return replace(self, size=size)

    def drilling(self, profile: Profile) -> Drilling:
        """Tapped holes, a run-out deeper than their thread."""
        return drilling(self.size, self.thread)

    def check(self, joints: Joints) -> None:
        """Look at profile and end cuts.

        Raises
        ------
        DetailError
            See `Connection.check`.
        """
        check_square(joints, "stud", "a stud")
        slope = float(np.abs(joints.frames.slope[joints.own]).max())
        found = _misfit(self.size, joints.profile)
        if found:
            near = sorted(fasteners(), key=lambda m: abs(m.diameter - self.size.diameter))
            fits = [s.size for s in near if not _misfit(s, joints.profile, slope)]
            advice = (
                f'[connection] bolt = "{fits[0]}"' if fits else '[connection] kind = "welded" alone'
            )
            wide, deep = _least_bar(self.size, slope)
            arms = joints.arms
            raise DetailError(
                f"node {node_mark(arms.node[0])}, beam {beam_mark(arms.edge[0])} (and all others): "
                f"{found}\ntake {advice}, or [beam] profile = "
                f'"{least_flat(deep, wide)}"'
            )

    def fit(self, joints: Joints, size: NodeSize) -> Joined:
        """Depth of thread, length of the fastener, and the opening that takes it.

        Raises
        ------
        DetailError
            See `Connection.fit`.
        """
        bolt_size = self.size
        holes = self.drilling(joints.profile)
        found = threaded(joints, size, bolt_size, holes, self.clearance, self.plates, self.fastener)
        opening = found.length
        opening = OPENING_STEP * math.ceil((opening + 0.5 * OPENING_STEP) / OPENING_STEP)
        low, high = z_range(joints.profile)
        end = StudEnd(
            0.5 * (low + high), bolt_size.hole, found.plate, opening, bolt_size.wrench, CORNER
        )
        self._check_strips(joints, end)
        stretch = np.hypot(1.0, joints.frames.slope[joints.own]).max()
        lean = bolt_size.wrench * (stretch**2 - 1.0) ** 0.5
        taken = (found.plate + opening + CORNER) * stretch + lean
        return Joined(
            "stud",
            end,
            bolt_size.drill,
            found.depth,
            found.mounted,
            bolt_size.hole,
            found.thread,
            found.grip,
            end_length=float(taken),
            weld=joints.project.connection.weld_mm if len(joints.profile.loops) > 1 else None,
        )

    def _check_strips(self, joints: Joints, end: StudEnd) -> None:
        """Raise where too little of a solid bar is left above or below its opening."""
        if len(joints.profile.loops) > 1:
            return
        slope = joints.frames.slope
        n = np.hypot(1.0, slope)
        shift = (end.plate + 0.25 * end.height) * np.abs(slope) / n
        low, high = z_range(joints.profile)
        strip = 0.5 * (high - low) - 0.5 * end.height / n - shift
        limit = self.size.diameter
        bad = np.argwhere((strip < limit) & joints.own)
        if len(bad):
            edges = joints.ends(bad[:, 0], bad[:, 1])
            needed = high - low + 2.0 * (limit - float(strip[joints.own].min()))
            raise listed(
                [
                    f"node {node_mark(node)}, beam {beam_mark(edge)}: its opening leaves "
                    f"{strip[edge, e]:.1f} mm of {joints.profile.name}"
                    for node, (edge, e) in zip(edges, bad.tolist(), strict=True)
                ],
                f"at least {limit:g} mm are needed above and below: take a profile {needed:.0f} mm "
                f"deep or a smaller [connection] bolt",
            )


def _least_bar(size: Fastener, slope: float) -> tuple[float, float]:
    """Width and depth [mm] of a flat bar that takes a size at both ends of all beams."""
    wide = 2.0 * max(size.edge, 0.5 * size.washer[1])
    shift = (usual_plate(size) + 0.25 * size.wrench) * slope / math.hypot(1.0, slope)
    return wide, size.wrench + 2.0 * (size.diameter + shift)


def _misfit(size: Fastener, profile: Profile, slope: float = 0.0) -> str:
    """Why a size does not fit a profile, or an empty text; slope: the greatest of its cuts."""
    low, high = z_range(profile)
    loops = [segments(loop) for loop in profile.loops]
    middle = 0.5 * (low + high)
    hollow = len(loops) > 1
    away = distance_to(loops[0], 0.0, middle)
    if away < size.edge:
        return (
            f"the hole for {size.size} is {away:.1f} mm from the edge of the end of "
            f"{profile.name}; at least {size.edge:.1f} mm, 1.2 hole diameters (EN 1993-1-8, "
            "table 3.3)"
        )
    inside = distance_to(loops[1], 0.0, middle) if hollow else away
    if inside < 0.5 * max(size.washer[1], size.wrench if hollow else 0.0):
        return (
            f"washer and spanner of {size.size} need {0.5 * max(size.washer[1], size.wrench):.1f} "
            f"mm about the axis; {profile.name} has {inside:.1f} mm"
        )
    if hollow:
        wall = [s for s in loops[0] if not s.turn and abs(s.v1 - s.v0) < 1e-9 and s.v0 == low]
        flat = max((abs(s.u1 - s.u0) for s in wall), default=0.0)
        if flat <= size.wrench:
            return (
                f"the hand hole for {size.size} is {size.wrench:.1f} mm wide; the lower wall of "
                f"{profile.name} is flat over {flat:.1f} mm"
            )
        return ""
    if high - low < _least_bar(size, slope)[1]:
        return (
            f"the opening for a spanner of {size.size} is {size.wrench:.1f} mm high, with "
            f"{size.diameter:g} mm left above and below; {profile.name} is {high - low:.6g} mm deep"
        )
    reach = 0.5 * _least_bar(size, slope)[1] - size.diameter
    upright = [
        s for s in loops[0]
        if not s.turn
        and abs(s.u1 - s.u0) <= VERTICAL * abs(s.v1 - s.v0)
        and min(s.v0, s.v1) < middle - reach
        and max(s.v0, s.v1) > middle + reach
    ]  # fmt: skip
    if len(upright) != SIDES:
        return (
            f"the opening for a spanner of {size.size} goes through upright sides, {2 * reach:.1f} "
            f"mm high about the middle; {profile.name} has {len(upright)} of them, not {SIDES}"
        )
    swing = 2.0 * math.atan2(0.5 * (size.wrench - HANDLE * size.flats), away)
    if swing < wrench_swing():
        return (
            f"a spanner for {size.size} turns by {math.degrees(swing):.0f} deg in the opening of "
            f"{profile.name}; at least {math.degrees(wrench_swing()):.0f} deg"
        )
    return ""

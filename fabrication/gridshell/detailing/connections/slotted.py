"""Slotted connections: discs of the node in slots across the beam's end, bolts along its axis.

As it is done in timber: the bar has two slots from side to side, square to the node axis, and bolts
through bar and discs, with head and nut in recesses, on extra large washers. Distances along and
across the grain, and washers: EN 1995-1-1:2004, table 8.4 (bolts), for a force along the bar, and
10.4.3; to the edge of a disc EN 1993-1-8, table 3.3.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar, Final, Self

import numpy as np

from ddgfab.errors import DetailError
from ddgfab.mesh import Floats
from fabrication.gridshell.detailing.connections.base import (
    BOLTED,
    Connection,
    Discs,
    Joined,
    Mounted,
)
from fabrication.gridshell.detailing.connections.threads import check_flat, check_square
from fabrication.gridshell.detailing.frames import beam_mark, node_mark
from fabrication.parts.beam import CombEnd
from fabrication.parts.beam.slot import bar_sides
from fabrication.parts.fastener import bolt, nut, washer
from fabrication.specs import Profile
from fabrication.standards import plates
from fabrication.standards.fasteners import Fastener, fastener, fasteners, shortest_bolt

if TYPE_CHECKING:
    from fabrication.gridshell.detailing.nodes.base import Joints, NodeSize
    from fabrication.gridshell.project import Project

STEP: Final = 5.0
"""Distances of bolts and sizes of discs [mm] are multiples of this."""

SHEET: Final = 0.75
"""Least thickness of a disc, in bolt diameters."""

LEAST_SHEET: Final = 6.0
"""Least thickness of a disc [mm]."""

STRIP: Final = 1.5
"""Least thickness of the bar between recess and slot, in bolt diameters."""

SOCKET: Final = 1.6
"""Diameter of a recess, in widths across flats: a socket wrench goes in."""

SHALLOW: Final = 1.0
"""Least depth of the recess of a nut [mm]; that of a head takes head and washer."""

HIDDEN: Final = 5.0
"""The discs end so far [mm] behind the sides of the bars."""

SLOT_GAP: Final = 2.0
"""From the rim of a disc to the bottom of its slot [mm], or the clearance where that is more."""


@dataclass(frozen=True)
class Slotted(Connection):
    """Two bolts an arm through the bar and both discs.

    plate : thickness of the discs [mm]
    clearance : from a disc to either side of its slot [mm]
    """

    size: Fastener
    plate: float
    clearance: float

    keys: ClassVar[tuple[str, ...]] = BOLTED
    nodes: ClassVar[tuple[str, ...]] = ("plates",)
    summary: ClassVar[str] = (
        "the discs of the node in slots across the beam, bolts along the node axis through both"
    )

    @classmethod
    def of(cls, project: Project) -> Self:
        """The one of a project."""
        size, given = fastener(project.connection.bolt), project.connection.plate_mm
        usual = next(t for t in plates() if t >= max(SHEET * size.diameter, LEAST_SHEET))
        return cls(size, usual if given == "auto" else given, project.beam.clearance_mm)

    @property
    def recess(self) -> float:
        """Diameter [mm] of the recesses for head and nut."""
        return float(math.ceil(max(self.size.wide[1] + 1.0, SOCKET * self.size.flats)))

    @property
    def steps(self) -> tuple[float, float]:
        """From the cut to the bolts [mm]: a3,t, and a1 or two recesses beyond it."""
        needs = self.size.in_timber
        pitch = max(needs.spacing, self.recess + self.size.diameter)
        first = STEP * math.ceil(needs.end / STEP)
        return first, first + STEP * math.ceil(pitch / STEP)

    def discs(self, profile: Profile) -> Discs:
        """The discs that nodes must have."""
        rim = self.steps[-1] + max(self.size.edge, 1.25 * self.size.end)
        width = max(profile.width - 2.0 * HIDDEN, 2.0 * self.size.edge)
        return Discs(self.plate, width, STEP * math.ceil(rim / STEP), self.steps, self.size.hole)

    def check(self, joints: Joints) -> None:
        """Look at profile and end cuts.

        Raises
        ------
        DetailError
            See `Connection.check`.
        """
        check_square(joints, "slotted", "a slot for discs")
        check_flat(joints)
        half, _, _ = bar_sides(joints.profile)
        self._check_washer()
        needed = self._beside()
        if half < needed:
            fits = [
                m.size
                for m in fasteners()
                if not _thin(m) and half >= replace(self, size=m)._beside()
            ]
            arms = joints.arms
            raise DetailError(
                f"node {node_mark(arms.node[0])}, beam {beam_mark(arms.edge[0])} (and all others): "
                f"bolts {self.size.size} are {half:.1f} mm from the side of {joints.profile.name}; "
                f"at least {needed:.1f} mm, 3 diameters (EN 1995-1-1, table 8.4) or a recess with "
                "a diameter beside it\ntake "
                + (f'[connection] bolt = "{fits[-1]}" or ' if fits else "")
                + f"a [beam] profile {math.ceil(2.0 * needed)} mm wide"
            )

    def _beside(self) -> float:
        """From the bolts to the side of the bar [mm]."""
        return max(self.size.in_timber.edge, 0.5 * self.recess + self.size.diameter)

    def _check_washer(self) -> None:
        """Raise where the washer of the size is too small for timber."""
        if (why := _thin(self.size)) == "":
            return
        near = sorted(fasteners(), key=lambda m: abs(m.diameter - self.size.diameter))
        fits = next(m.size for m in near if not _thin(m))
        raise DetailError(f'{why}\ntake [connection] bolt = "{fits}"')

    def fit(self, joints: Joints, size: NodeSize) -> Joined:
        """Where slots and recesses are, alike at all arms about the discs of their node.

        Raises
        ------
        DetailError
            See `Connection.fit`.
        """
        m, arms, frames, profile = self.size, joints.arms, joints.frames, joints.profile
        _, low, high = bar_sides(profile)
        discs = self.discs(profile)
        middle = 0.5 * (low + high)
        slope, level = arm_slopes(joints), axis_levels(joints, size.cut, discs.length)
        at_cut = slope * size.cut + (middle + joints.project.beam.eccentricity_mm) * np.hypot(
            1.0, slope
        )
        offset = level[arms.node] - at_cut
        half_depth = 0.5 * (high - low) * np.hypot(1.0, slope)
        # From the level of the discs to the lowest rim of a recess at the top, and at the bottom.
        rim = 0.5 * self.recess * np.abs(slope)
        steps = np.array(self.steps)[:, None]
        above = (half_depth + slope * steps - offset - rim).min(axis=0) - m.head - m.wide[2]
        below = (half_depth - slope * steps + offset - rim).min(axis=0) - SHALLOW
        room = np.minimum(above, below)
        worst = int(room.argmin())
        needed = self.plate + 2.0 * self.clearance + 2.0 * STRIP * m.diameter
        ends = 2.0 * m.wide[2] + m.nut + m.pitch
        longest = max(m.full[1], m.shank[1]) - ends  # recesses go deeper for short bolts
        grip = 2.0 * math.floor(min(float(room[worst]), 0.5 * longest))
        if grip < 2.0 * needed:
            more = max(high - low + 2.0 * (needed - float(room[worst])), high - low)
            advice = f"a [beam] profile {math.ceil(more)} mm deep, or a smaller [connection] bolt"
            if 0.5 * longest < needed:
                advice = "a thinner [connection] plate_mm, or a bolt of another size"
            raise DetailError(
                f"node {node_mark(arms.node[worst])}, beam {beam_mark(arms.edge[worst])}: between "
                f"the recesses of its bolts are {grip:.0f} mm of {profile.name} (bolts to "
                f"{longest + ends:g} mm); two slots of "
                f"{self.plate + 2 * self.clearance:g} mm and four strips of "
                f"{STRIP * m.diameter:g} mm (1.5 bolt diameters) need {2.0 * needed:.0f} mm\ntake "
                f"{advice}"
            )
        found = shortest_bolt(m, grip + ends)
        assert found is not None
        length, shank = found
        offsets = np.zeros((len(frames.length), 2))
        offsets[arms.edge, arms.end] = offset
        depth = discs.length + max(SLOT_GAP, self.clearance)
        hole = m.in_timber.hole
        end = CombEnd(
            middle,
            0.0,
            0.5 * grip,
            self.plate + 2.0 * self.clearance,
            depth,
            self.steps,
            hole,
            self.recess,
            grip,
        )
        stretch = float(np.hypot(1.0, slope).max())
        thick, top = m.wide[2], 0.5 * grip
        return Joined(
            "slotted",
            comb=end,
            offsets=offsets,
            mounted=(
                Mounted(bolt(m, length, shank=shank), top + thick, -1),
                Mounted(washer(m, wide=True), top, 1),
                Mounted(washer(m, wide=True), -top, -1),
                Mounted(nut(m), -top - thick, -1),
            ),
            beam_hole=hole,
            hole=m.hole,
            grip=grip,
            end_length=depth * stretch + float(np.abs(slope).max()) * (high - low),
            levels=level,
        )


def _thin(size: Fastener) -> str:
    """Why the extra large washer of a size is too small for timber, or an empty text."""
    _, width, thickness = size.wide
    least = size.in_timber.washer
    if width >= least[0] and thickness >= least[1]:
        return ""
    return (
        f"washers in timber for {size.size} are {least[0]:g} mm wide and {least[1]:.1f} mm thick "
        f"or more (EN 1995-1-1, 10.4.3); the largest, ISO 7094, has {width:g} and {thickness:g} mm"
    )


def arm_slopes(joints: Joints) -> Floats:
    """Slope (A,) of each arm away from its node."""
    arms = joints.arms
    return np.asarray(joints.frames.slope[arms.edge, arms.end] * (1 - 2 * arms.end))


def axis_levels(joints: Joints, cut: float, length: float) -> Floats:
    """(V,) height [mm] along each node axis of the middle between its discs.

    Half way between the highest and the lowest arm, where the middle of the discs' rims is.
    """
    arms, slope = joints.arms, arm_slopes(joints)
    _, low, high = bar_sides(joints.profile)
    middle = 0.5 * (low + high) + joints.project.beam.eccentricity_mm
    height = slope * (cut + 0.5 * length) + middle * np.hypot(1.0, slope)
    used = np.flatnonzero(np.diff(arms.start))
    first = arms.start[used]
    level = np.zeros(len(arms.start) - 1)
    level[used] = 0.5 * (np.minimum.reduceat(height, first) + np.maximum.reduceat(height, first))
    return level

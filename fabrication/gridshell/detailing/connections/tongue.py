"""Tongue connections: plates of the node in slots of the beams' ends, bolts in double shear.

The plates stand in the planes of the beams (nodes of kind "star"); the slots are open at top and
bottom. Distances: EN 1993-1-8:2005, table 3.3.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Final

import numpy as np

from ddgfab.errors import DetailError
from fabrication.gridshell.detailing.connections.base import (
    BOLTED,
    Connection,
    Joined,
    Mounted,
    Tongue,
    usual_plate,
)
from fabrication.gridshell.detailing.connections.threads import check_flat, least_flat
from fabrication.gridshell.detailing.frames import beam_mark, node_mark
from fabrication.parts.beam import StrapEnd
from fabrication.parts.beam.slot import bar_sides
from fabrication.parts.fastener import bolt, nut, washer
from fabrication.specs import Profile
from fabrication.standards.fasteners import (
    Fastener,
    fastener,
    fasteners,
    shortest_bolt,
)

if TYPE_CHECKING:
    from fabrication.gridshell.detailing.connections.doubled import DoubledTongue
    from fabrication.gridshell.detailing.nodes.base import Joints, NodeSize
    from fabrication.gridshell.project import Project

STEP: Final = 5.0
"""Plates and distances of holes [mm] are multiples of this."""

END_GAP: Final = 2.0
"""From the end of a tongue to the bottom of its slot [mm], or the clearance where that is more."""

END_FACTOR: Final = 1.25
"""Distances from holes to ends, in the least ones of table 3.3: 1.5 hole diameters."""

BOLTS: Final = 2
"""Bolts of an arm, in a row along the beam."""


@dataclass(frozen=True)
class BoltedTongue(Connection):
    """Two bolts through both cheeks of the beam and the tongue between them.

    plate : thickness of the tongue [mm]
    clearance : from the tongue to each cheek [mm]
    """

    size: Fastener
    plate: float
    clearance: float

    keys: ClassVar[tuple[str, ...]] = (*BOLTED, "ends")
    nodes: ClassVar[tuple[str, ...]] = ("star", "cylinder", "tube")
    summary: ClassVar[str] = (
        "the plates of the node in slots of the beams, bolts across both in double shear"
    )

    @classmethod
    def of(cls, project: Project) -> BoltedTongue:
        """The one of a project."""
        settings, clearance = project.connection, project.beam.clearance_mm
        size = fastener(settings.bolt)
        plate = None if settings.plate_mm == "auto" else settings.plate_mm
        if settings.ends == "doubled":
            return _doubled(size, plate, clearance, settings.weld_mm)
        return cls(size, usual_plate(size) if plate is None else plate, clearance)

    def thickness(self, profile: Profile) -> float:
        """Of the tongue [mm]."""
        return self.plate

    def half(self, profile: Profile) -> float:
        """From the middle of the bar to the outer side of a cheek [mm]."""
        return 0.5 * profile.width

    def gap(self, profile: Profile) -> float:
        """From cheek to cheek [mm]."""
        return self.plate + 2.0 * self.clearance

    def cheeks(self, profile: Profile, reach: float) -> StrapEnd | None:
        """Straps that reach so far beyond the bar [mm]; None: a slot leaves the cheeks."""
        return None

    def _least(self, profile: Profile) -> float:
        """Length [mm] of a bolt through cheeks and washers that passes its nut by a pitch."""
        size = self.size
        return 2.0 * self.half(profile) + 2.0 * size.washer[2] + size.nut + size.pitch

    def tongue(self, profile: Profile) -> Tongue:
        """The plates that nodes must have."""
        size, half = self.size, self.half(profile)
        end = STEP * math.ceil(END_FACTOR * size.end / STEP)
        pitch = max(size.spacing, 0.5 * (size.wrench + size.corners))
        pitch = STEP * math.ceil(pitch / STEP)
        steps = tuple(end + pitch * k for k in range(BOLTS))
        length = steps[-1] + end
        found = shortest_bolt(size, self._least(profile))
        length_of_bolt = self._least(profile) if found is None else found[0]
        sideways = length_of_bolt - half - size.washer[2]
        depth = length + max(END_GAP, self.clearance)
        return Tongue(
            self.thickness(profile),
            self.gap(profile),
            length,
            depth,
            steps,
            size.hole,
            size.edge,
            (0.5 * max(size.corners, size.washer[1]), sideways),
            self.cheeks(profile, depth),
        )

    def check(self, joints: Joints) -> None:
        """Look at profile and end cuts.

        Raises
        ------
        DetailError
            See `Connection.check`.
        """
        project, frames = joints.project, joints.frames
        if project.beam.end != "flat":
            raise DetailError(
                '[connection] kind = "bolted_tongue" needs flat ends, not [beam] end = "cope"\n'
                'take [beam] end = "flat"'
            )
        if np.abs(frames.roll[joints.own]).any():
            worst = int(np.where(joints.own.any(axis=1), frames.torsion, -1.0).argmax())
            raise DetailError(
                f"beam {beam_mark(worst)} has torsion {np.degrees(frames.torsion[worst]):.2f} deg: "
                "a tongue needs both node axes in the plane of the beam, 0\n"
                'take [connection] kind = "welded", or a net without torsion ([optimize] goal = '
                '"torsion-free")'
            )
        check_flat(joints)
        self.check_profile(joints)

    def check_profile(self, joints: Joints) -> None:
        """Raise where the bar is too thin or too low for slot and holes."""
        found = _misfit(self.size, self.plate, self.clearance, joints.profile)
        if found:
            fits = [
                size.size
                for size in fasteners()
                if size.diameter < self.size.diameter
                and not _misfit(size, usual_plate(size), self.clearance, joints.profile)
            ]
            advice = f'[connection] bolt = "{fits[-1]}"' if fits else "another profile"
            weld = joints.project.connection.weld_mm
            if _doubled(self.size, None, self.clearance, weld).suits(joints.profile):
                advice = f'[connection] ends = "doubled", {advice}'
            wide = 2.0 * (self.plate + self.clearance)
            arms = joints.arms
            raise DetailError(
                f"node {node_mark(arms.node[0])}, beam {beam_mark(arms.edge[0])} (and all others): "
                f"{found}\ntake {advice}, or a flat bar [beam] profile = "
                f'"{least_flat(2.0 * self.size.edge, wide)}" or larger'
            )

    def fit(self, joints: Joints, size: NodeSize) -> Joined:
        """The bolts that clamp the beam's cheeks.

        Raises
        ------
        DetailError
            See `Connection.fit`.
        """
        m, half = self.size, self.half(joints.profile)
        thick = m.washer[2]
        grip = 2.0 * (half + thick)
        least = self._least(joints.profile)
        found = shortest_bolt(m, least)
        if found is None:
            arms = joints.arms
            raise DetailError(
                f"node {node_mark(arms.node[0])}, beam {beam_mark(arms.edge[0])} (and all others): "
                f"a bolt {m.size} of {least:.1f} mm or more is needed, and the "
                f"series has none\ntake a narrower [beam] profile, or another [connection] bolt"
            )
        length, shank = found
        tongue = self.tongue(joints.profile)
        stretch = float(np.hypot(1.0, joints.frames.slope[joints.own]).max())
        lap = 0.0 if tongue.straps is None else tongue.straps.lap
        lean = (stretch**2 - 1.0) ** 0.5 * joints.profile.depth
        return Joined(
            "bolted_tongue",
            mounted=(
                Mounted(bolt(m, length, shank=shank), -half - thick, 1),
                Mounted(washer(m), -half - thick, 1),
                Mounted(washer(m), half, 1),
                Mounted(nut(m), half + thick, 1),
            ),
            beam_hole=m.hole,
            grip=grip,
            end_length=(tongue.depth + lap) * stretch + lean,
            tongue=tongue,
            weld=None if tongue.straps is None else joints.project.connection.weld_mm,
        )


def _doubled(size: Fastener, plate: float | None, clearance: float, weld: float) -> DoubledTongue:
    """A tongue between straps."""
    from fabrication.gridshell.detailing.connections.doubled import DoubledTongue

    return DoubledTongue(size, 0.0 if plate is None else plate, clearance, plate, weld)


def _misfit(size: Fastener, plate: float, clearance: float, profile: Profile) -> str:
    """Why a size does not fit a profile, or an empty text."""
    half, low, high = bar_sides(profile)
    cheek = half - 0.5 * plate - clearance
    if cheek < 0.5 * plate:
        return (
            f"the slot for a tongue of {plate:g} mm leaves cheeks of {max(cheek, 0.0):.1f} mm of "
            f"{profile.name}; at least {0.5 * plate:g} mm each, half of the tongue"
        )
    away = 0.5 * (high - low)
    if away < size.edge:
        return (
            f"the holes for {size.size} are {away:.1f} mm from the edge of {profile.name}; at "
            f"least {size.edge:.1f} mm, 1.2 hole diameters (EN 1993-1-8, table 3.3)"
        )
    return ""

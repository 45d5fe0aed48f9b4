"""End plate connections: a plate across the end of the beam, bolts beside the bar into the seat.

The plate is welded to the bar and lies on the flat seat of the node; bolts or studs stand in rows
of two, one on either side of the bar, where a spanner reaches them. Distances: EN 1993-1-8:2005,
table 3.3 (e1, e2 of the edges, p1, p2 between holes). Leg of a fillet weld: throat times sqrt(2).
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
)
from fabrication.gridshell.detailing.connections.threads import (
    FastenerChoice,
    check_square,
    drilling,
    tapped,
    threaded,
)
from fabrication.gridshell.detailing.frames import beam_mark, node_mark
from fabrication.parts.beam import PlateEnd
from fabrication.parts.beam.end_plate import vent_of
from fabrication.solids.section import segments
from fabrication.specs import Profile
from fabrication.standards.fasteners import Fastener, fasteners
from fabrication.standards.profiles import z_range

if TYPE_CHECKING:
    from fabrication.gridshell.detailing.nodes.base import Joints, NodeSize
    from fabrication.gridshell.project import Project

STEP: Final = 5.0
"""Sizes of plates and distances of rows [mm] are multiples of this."""

COLUMN_STEP: Final = 0.5
"""Distances of holes from the middle of the plate [mm] are multiples of this."""

EDGES: Final = 2
"""Holes stand at both sides of the bar."""


@dataclass(frozen=True)
class EndPlate(Connection):
    """Bolts or studs through a plate that is welded to the end of the beam.

    bolts : of an arm, in rows of two
    plates : thicknesses of the plate [mm], the first that a fastener fits is taken
    clearance : from the seat to it [mm]
    weld : throat thickness of the weld between bar and plate [mm]
    thread : length of thread in engagement [mm] that the project asks for; None: the usual one
    """

    size: Fastener
    fastener: FastenerChoice
    bolts: int
    plates: tuple[float, ...]
    clearance: float
    weld: float
    thread: float | None = None

    keys: ClassVar[tuple[str, ...]] = (*BOLTED, "fastener", "thread_mm", "bolts")
    summary: ClassVar[str] = (
        "plates welded across the ends of the beams, bolts or studs beside the bar into threads in "
        "the node"
    )

    @classmethod
    def of(cls, project: Project) -> Self:
        """The one of a project."""
        size, choice, plates, thread = tapped(project)
        bolts, weld = project.connection.bolts, project.connection.weld_mm
        return cls(size, choice, bolts, plates, project.beam.clearance_mm, weld, thread)

    @property
    def leg(self) -> float:
        """How far [mm] the weld reaches from the bar on the plate."""
        return self.weld * math.sqrt(2.0)

    @property
    def edge(self) -> float:
        """From a hole to the side of the plate [mm]: e2, and half a spanner.

        With this no spanner reaches over the plate of a neighbour.
        """
        return max(self.size.edge, 0.5 * self.size.wrench)

    def column(self, profile: Profile) -> float:
        """From the middle of the plate to its columns of holes [mm].

        The spanner keeps off the bar, the washer off the weld; p2 of table 3.3.
        """
        size, half = self.size, 0.5 * profile.width
        off = max(0.5 * size.wrench, self.leg + 0.5 * size.washer[1])
        across = 0.5 * size.spacing_across
        return COLUMN_STEP * math.ceil(max(half + off, across) / COLUMN_STEP)

    def arm_width(self, profile: Profile) -> float:
        """Width [mm] of the plate and its seat."""
        return 2.0 * (self.column(profile) + self.edge)

    def pitch(self) -> float:
        """Least distance of two rows [mm]: p1, and a spanner beside the next head."""
        return max(self.size.spacing, 0.5 * (self.size.wrench + self.size.corners))

    def height(self, profile: Profile, slope: float, plate: float) -> float:
        """Height [mm] of plates that cover the bar and its weld at cuts of a slope."""
        low, high = z_range(profile)
        cover = (high - low) * math.hypot(1.0, slope) + 2.0 * (plate * slope + self.leg)
        return STEP * math.ceil(cover / STEP)

    def of_size(self, size: Fastener) -> Self:
        """The same with fasteners of another size."""
        return replace(self, size=size)

    def drilling(self, profile: Profile) -> Drilling:
        """Tapped holes beside the radius."""
        return drilling(self.size, self.thread, self.column(profile))

    def check(self, joints: Joints) -> None:
        """Look at profile and end cuts.

        Raises
        ------
        DetailError
            See `Connection.check`.
        """
        check_square(joints, "end_plate", "an end plate")
        slope = float(np.abs(joints.frames.slope[joints.own]).max())
        found = self._misfit(joints.profile, slope)
        if not found:
            return
        arms = joints.arms
        raise DetailError(
            f"node {node_mark(arms.node[0])}, beam {beam_mark(arms.edge[0])} (and all others): "
            f"{found}\ntake {self._advice(joints.profile, slope)}"
        )

    def fit(self, joints: Joints, size: NodeSize) -> Joined:
        """Plate, rows of holes, depth of thread and length of the fasteners.

        Raises
        ------
        DetailError
            See `Connection.fit`.
        """
        profile, m = joints.profile, self.size
        slope = float(np.abs(joints.frames.slope[joints.own]).max())
        holes = self.drilling(profile)
        found = threaded(joints, size, m, holes, self.clearance, self.plates, self.fastener)
        plate = found.plate
        column, height = self.column(profile), self.height(profile, slope, plate)
        rows = self._rows(height)
        places = tuple((y, w) for w in rows for y in (-column, column))
        low, high = z_range(profile)
        hollow = len(profile.loops) > 1
        end = PlateEnd(
            0.5 * (low + high),
            self.arm_width(profile),
            height,
            plate,
            places,
            m.hole,
            vent_of([segments(loop) for loop in profile.loops]) if hollow else 0.0,
        )
        # Behind the plate a bolt is put in, and its nut or head is turned.
        taken = plate + max(found.length, 0.5 * m.wrench)
        return Joined(
            "end_plate",
            plate=end,
            hole=m.drill,
            depth=found.depth,
            mounted=found.mounted,
            beam_hole=m.hole,
            thread=found.thread,
            grip=found.grip,
            end_length=taken * math.hypot(1.0, slope) + 0.5 * height * slope,
            weld=self.weld,
            places=places,
            cover=height,
        )

    def _rows(self, height: float) -> list[float]:
        """Heights [mm] of the rows from the middle of the plate, as far apart as its ends allow."""
        count = self.bolts // EDGES
        if count == 1:
            return [0.0]
        pitch = (height - 2.0 * self.size.end) / (count - 1)
        for step in (STEP, COLUMN_STEP):  # whole steps where there is room
            whole = step * math.floor(pitch / step)
            if whole >= self.pitch():
                pitch = whole
                break
        return [pitch * (k - 0.5 * (count - 1)) for k in range(count)]

    def _misfit(self, profile: Profile, slope: float) -> str:
        """Why the rows do not fit, or an empty text."""
        count = self.bolts // EDGES
        height = self.height(profile, slope, self.plates[0])
        needed = 2.0 * self.size.end + (count - 1) * self.pitch()
        if needed > height:
            return (
                f"{count} row{'s' * (count > 1)} of {self.size.size} need a plate {needed:.1f} mm "
                f"high: {self.size.end:.1f} mm from hole to end, 1.2 hole diameters"
                + f", and {self.pitch():.1f} mm between rows, 2.2 hole diameters or room for a "
                "spanner"
                * (count > 1)
                + f" (EN 1993-1-8, table 3.3); that of {profile.name} is {height:g} mm high"
            )
        if len(profile.loops) > 1 and not vent_of([segments(loop) for loop in profile.loops]):
            return f"{profile.name} is too narrow inside for a hole that opens it"
        return ""

    def _advice(self, profile: Profile, slope: float) -> str:
        """The nearest choice that fits: fewer bolts, smaller ones, or a deeper profile."""
        fits = []
        if self.bolts > EDGES and not replace(self, bolts=EDGES)._misfit(profile, slope):
            most = max(
                b
                for b in range(EDGES, self.bolts, EDGES)
                if not replace(self, bolts=b)._misfit(profile, slope)
            )
            fits.append(f"[connection] bolts = {most}")
        smaller = [s for s in fasteners() if s.diameter < self.size.diameter]
        passed = [s.size for s in smaller if not replace(self, size=s)._misfit(profile, slope)]
        if passed:
            fits.append(f'bolt = "{passed[-1]}"')
        return " or ".join([*fits, "a deeper [beam] profile"])

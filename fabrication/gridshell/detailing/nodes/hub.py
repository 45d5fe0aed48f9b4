"""Hubs: round bars or tubes with tongues on them, in the planes of the beams.

What nodes of kind "cylinder" and "tube" are where the connection has tongues.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from ddgfab.errors import DetailError
from fabrication.gridshell.detailing.arm_room import least_radii
from fabrication.gridshell.detailing.frames import beam_mark, node_mark
from fabrication.gridshell.detailing.nodes.base import MARK, SLACK, Joints
from fabrication.gridshell.detailing.nodes.star import Star, farthest
from fabrication.parts.hub import HUB, HubShape
from fabrication.parts.node import ReferenceMark
from fabrication.parts.star import StarShape
from fabrication.specs import Kind
from fabrication.standards import node_diameters

LEAST_WALL = 2.0
"""What a post overlaps of the wall of a tube [mm]."""


@dataclass(frozen=True)
class Hub(Star):
    """Plates on a round bar, so far apart that their welds do not meet.

    hub, bore : outside and inside radius [mm]
    weld : throat thickness of the welds of the plates [mm]
    """

    hub: float = 0.0
    bore: float = 0.0
    weld: float = 0.0

    keys: ClassVar[tuple[str, ...]] = ()
    kind: ClassVar[Kind] = HUB
    series: ClassVar[str] = "cylinder"
    summary: ClassVar[str] = "round bar, EN 10060, with a plate, EN 10029, welded on for each arm"

    @classmethod
    def fit(cls, joints: Joints) -> Self:
        """The diameter of the project or the least of the series, and how far the beams stay.

        Raises
        ------
        DetailError
            The given diameter, or every one of the series, is too small; names node and beams.
        """
        arms, settings = joints.arms, joints.project.node
        tongue = joints.connection.tongue(joints.profile)
        assert tongue is not None
        weld = joints.project.connection.weld_mm
        leg = weld * math.sqrt(2.0)
        needs = least_radii(arms, tongue.thickness + 2.0 * leg, settings.arm_clearance_mm)
        k = int(needs.argmax())
        least = max(2.0 * float(needs[k]), 2.0 * cls._wall(joints) + 1.0)
        series = sorted(settings.series_mm) or list(node_diameters(cls.series))
        if settings.diameter_mm == "auto":
            wanted = max(least, settings.min_diameter_mm)
            found = next((d for d in series if d >= wanted - SLACK), None)
        else:
            found = settings.diameter_mm if settings.diameter_mm >= least - SLACK else None
        if found is None:
            other = int(arms.following()[k])
            fits = next((d for d in series if d >= least - SLACK), math.ceil(least))
            given = f"series ends at {series[-1]:g} mm"
            if settings.diameter_mm != "auto":
                given = f"[node] diameter_mm is {settings.diameter_mm:g}"
            raise DetailError(
                f"node {node_mark(arms.node[k])}, beams {beam_mark(arms.edge[k])} and "
                f"{beam_mark(arms.edge[other])} at {math.degrees(arms.gap[k]):.1f} deg: tongues "
                f"{tongue.thickness:g} mm thick with welds of {weld:g} mm need a {settings.kind} "
                f"of {least:.1f} mm; the {given}\ntake [node] diameter_mm = {fits:g}, or a thinner "
                "[connection] plate_mm"
            )
        radius = 0.5 * found
        cut, worst = farthest(joints, tongue, radius + leg)
        length = cut + tongue.length
        return cls(
            math.hypot(length, 0.5 * tongue.thickness), cut, cut, joints.width,
            float(needs[k]), worst, tongue, length, radius, cls._bore(radius, joints), weld,
        )  # fmt: skip

    @staticmethod
    def _wall(joints: Joints) -> float:
        """Thickness of the wall [mm]; 0: solid."""
        return 0.0

    @classmethod
    def _bore(cls, radius: float, joints: Joints) -> float:
        wall = cls._wall(joints)
        return radius - wall if wall else 0.0

    def post(self, clearance: float) -> tuple[float, float]:
        """On the end of a tube it overlaps the wall."""
        least, most = super().post(clearance)
        return (self.bore + LEAST_WALL if self.bore else least), most

    def mark(self) -> ReferenceMark:
        """In the middle between axis or bore and the round surface."""
        land = self.hub - self.bore
        wide = min(MARK[0], 0.4 * min(land, self.tongue.thickness))
        return ReferenceMark(self.bore + 0.5 * land, wide, MARK[1])

    def made(self, **sizes: Any) -> StarShape:
        """The shape of a node."""
        return HubShape(**sizes, hub=self.hub, bore=self.bore, weld=self.weld)


@dataclass(frozen=True)
class TubeHub(Hub):
    """Plates on a tube."""

    series: ClassVar[str] = "tube"
    summary: ClassVar[str] = (
        "circular hollow section, EN 10210-2, with a plate, EN 10029, welded on for each arm"
    )

    @staticmethod
    def _wall(joints: Joints) -> float:
        """Thickness of the wall [mm]."""
        return joints.project.node.wall_mm

"""Round nodes: cylinders and tubes with seats, holes and a mark. docs/parts.md, Node element."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Final, Self

import numpy as np

from ddgfab.errors import DetailError
from ddgfab.mesh import Floats
from fabrication.gridshell.detailing.arm_room import least_radii
from fabrication.gridshell.detailing.connections.base import Connection, Drilling, Joined
from fabrication.gridshell.detailing.frames import beam_mark, listed, node_mark
from fabrication.gridshell.detailing.nodes.advice import forced, middle, rolled, smaller
from fabrication.gridshell.detailing.nodes.base import Joints, NodeSize
from fabrication.gridshell.detailing.nodes.hub import Hub, TubeHub
from fabrication.parts.node import NodeShape, RadialHole, ReferenceMark, Seat
from fabrication.specs import Profile
from fabrication.standards import node_diameters

LEAST_WALL: Final = 2.0
"""Steel [mm] that a seat must leave between itself and the bore, or the axis."""

RADIUS_SLACK: Final = 1e-6
"""A radius [mm] may fall short of the need by this, so that noise forces no larger node."""

HOLE_WALL: Final = 3.0
"""Steel [mm] left between the tips of neighbouring blind holes."""

EDGE_OF_BORE: Final = 2.0
"""From the side of a hole into the bore to the widest place of the bore [mm]."""

PAST_STEP: Final = 5.0
"""Diameters that messages name beyond a series are multiples of this [mm]."""

MOST: Final = 1000.0
"""How far beyond a series [mm] messages look for a diameter that does."""

MARK: Final = (3.0, 1.0)
"""Diameter and depth [mm] of the reference mark where there is room."""

MARK_PART: Final = 0.4
"""Greatest part of the land between bore and seat that the mark may take."""


@dataclass(frozen=True)
class Cylinder(NodeSize):
    """A solid cylinder about the node axis, with a milled seat for each arm with a flat end."""

    summary: ClassVar[str] = "round bar, EN 10060, with a flat milled for each arm"
    series: ClassVar[str] = "cylinder"
    body: ClassVar[str] = "a cylinder"

    @classmethod
    def joined_by(cls, connection: Connection, profile: Profile) -> type[NodeSize]:
        """A hub where beams are joined by tongues."""
        return cls if connection.tongue(profile) is None else Hub

    @property
    def bore(self) -> float:
        """Inside radius [mm]; 0: solid."""
        return 0.0

    @classmethod
    def fit(cls, joints: Joints) -> Self:
        """The given diameter, or the least of the series that fits everywhere.

        Raises
        ------
        DetailError
            The given diameter, or every one of the series, is too small; names node, arms, angle.
        """
        arms, width, project = joints.arms, joints.width, joints.project
        settings = project.node
        needs = least_radii(arms, width, settings.arm_clearance_mm)
        worst = int(needs.argmax())
        needed = float(needs[worst])
        if settings.diameter_mm == "auto":
            series = sorted(settings.series_mm) or node_diameters(cls.series)
            for diameter in series:
                size = cls._of(diameter, needed, int(arms.node[worst]), joints)
                if diameter >= settings.min_diameter_mm and not size.misfit(joints):
                    return size
            why = size.misfit(joints) if size.radius >= needed - RADIUS_SLACK else ""
            bolt = smaller(cls, joints)
            raise DetailError(
                f"{forced(arms, worst)}, which needs a diameter of {2 * needed:.1f} mm; the "
                f"series ends at {series[-1]:g} mm{f', where {why}' * bool(why)}\n"
                f"take {size.beyond(joints)}, a narrower [beam] profile{middle(joints)}"
                f"{f' or {bolt}' * bool(bolt)}"
            )
        size = cls._of(settings.diameter_mm, needed, int(arms.node[worst]), joints)
        if size.radius < needed - RADIUS_SLACK:
            bad = np.flatnonzero(needs > size.radius + RADIUS_SLACK)
            bad = bad[np.argsort(-needs[bad], kind="stable")]
            raise listed(
                [f"{forced(arms, k)}, which needs {2 * needs[k]:.1f} mm" for k in bad.tolist()],
                f"[node] diameter_mm = {settings.diameter_mm:g} is too small for beams "
                f'{width:g} mm wide{rolled(joints)}: at least {2 * needed:.1f} mm, or "auto"',
            )
        if misfit := size.misfit():
            raise DetailError(f"{forced(arms, worst)}: {misfit}\ntake {size.remedy(joints)}")
        return size

    @classmethod
    def _of(cls, diameter: float, needed: float, forced_by: int, joints: Joints) -> Self:
        radius, width, project = 0.5 * diameter, joints.width, joints.project
        flat = project.beam.end == "flat"
        seat = max(radius**2 - 0.25 * width**2, 0.0) ** 0.5 if flat else radius
        cut = seat + project.beam.clearance_mm
        return cls(radius, seat, cut, width, needed, forced_by)

    def post(self, clearance: float) -> tuple[float, float]:
        """On the end of a tube it overlaps the wall."""
        least, most = super().post(clearance)
        return (self.bore + LEAST_WALL if self.bore else least), most

    def misfit(self, joints: Joints | None = None) -> str:
        """Why a size does not do, or an empty string; with `joints` also for holes of its arms."""
        if self.radius < self.needed - RADIUS_SLACK:
            return f"diameter {2 * self.radius:g} mm is less than {2 * self.needed:.1f} mm"
        if self.seat - self.bore < LEAST_WALL:
            return (
                f"a seat at {self.seat:.2f} mm from the axis leaves {self.seat - self.bore:.2f} mm "
                f"of {self.body} of diameter {2 * self.radius:g} mm; at least "
                f"{LEAST_WALL:g} mm"
            )
        drilling = None if joints is None else joints.connection.drilling(joints.profile)
        if joints is not None and drilling is not None:
            room, least = float(self._room(joints, drilling).min()), self._least(drilling)
            if room < least - RADIUS_SLACK:
                return f"{room:.1f} mm of {least:.1f} mm for the holes of {drilling.size}"
        return ""

    def remedy(self, joints: Joints) -> str:
        """What makes a given diameter do."""
        return f"a narrower [beam] profile or {self._enough(joints)}"

    @staticmethod
    def _least(drilling: Drilling) -> float:
        """Room [mm] that a hole needs."""
        return drilling.least

    def hole_room(self, joints: Joints, drilling: Drilling) -> tuple[Floats, bool]:
        """Room (A,) [mm] for the hole of each arm.

        Holes that reach d from the radius, at azimuth difference phi, meet at d / tan(phi/2) along
        it.

        Raises
        ------
        DetailError
            Too little room for the thread; names nodes and beams, and the diameter that has it.
        """
        room = self._room(joints, drilling)
        shallow = np.flatnonzero(room < drilling.least - RADIUS_SLACK)
        if len(shallow):
            arms = joints.arms
            raise listed(
                [
                    f"node {node_mark(arms.node[k])}: the hole for beam {beam_mark(arms.edge[k])} "
                    f"can be {room[k]:.1f} mm deep"
                    for k in shallow.tolist()
                ],
                f"{drilling.size} needs {drilling.least:g} mm: take {self._enough(joints)}",
            )
        return room, False

    def _enough(self, joints: Joints) -> str:
        """What gives the seats and holes of all arms enough room."""
        settings = joints.project.node
        series = sorted(settings.series_mm) or node_diameters(self.series)
        bolt = smaller(type(self), joints)
        bolt = f" or {bolt}" if bolt else ""
        for diameter in series:
            size = self._of(diameter, self.needed, self.forced_by, joints)
            if diameter > 2.0 * self.radius and not size.misfit(joints):
                return f"[node] diameter_mm = {diameter:g}{bolt}"
        return f"{self.beyond(joints)}{bolt}"

    def beyond(self, joints: Joints) -> str:
        """Settings of nodes that are not of the series and have room for all arms."""
        for diameter in self._past(joints):
            if not self._of(diameter, self.needed, self.forced_by, joints).misfit(joints):
                return f"[node] diameter_mm = {diameter:g}"
        return "arms farther apart"

    def _past(self, joints: Joints) -> Iterator[float]:
        """Diameters [mm] beyond the series, in steps."""
        series = sorted(joints.project.node.series_mm) or node_diameters(self.series)
        first = math.ceil(max(series[-1], 2.0 * self.radius, 2.0 * self.needed) / PAST_STEP)
        return (PAST_STEP * k for k in range(first, math.ceil(first + MOST / PAST_STEP)))

    def _room(self, joints: Joints, drilling: Drilling) -> Floats:
        """(A,) room [mm] for the hole of each arm, before those of its neighbours."""
        arms = joints.arms
        before = np.empty_like(arms.gap)
        before[arms.following()] = arms.gap
        half_angle = 0.5 * np.minimum(np.minimum(arms.gap, before), np.pi)
        return np.asarray(
            self.seat - HOLE_WALL - drilling.reach / np.tan(half_angle), dtype=np.float64
        )

    def shapes(
        self,
        joints: Joints,
        joined: Sequence[Joined],
        bottom: Floats,
        top: Floats,
        middle: Floats,
    ) -> list[NodeShape]:
        """Cylinders or tubes with seats, holes and a mark."""
        arms, project = joints.arms, joints.project
        flat = project.beam.end == "flat"
        mark, bore = self._mark(), self.bore
        low, high = bottom.tolist(), top.tolist()
        azimuths, heights, starts = arms.azimuth.tolist(), middle.tolist(), arms.start.tolist()
        shapes = []
        for v in np.flatnonzero(np.diff(arms.start)).tolist():
            own = range(starts[v], starts[v + 1])
            seats = tuple(Seat(azimuths[k], self.seat, self.width) for k in own) if flat else ()
            holes = tuple(
                RadialHole(azimuths[k], heights[k] + up, hole, joined[k].depth, across)
                for k in own
                if (hole := joined[k].hole) is not None
                for across, up in joined[k].places
            )
            shapes.append(NodeShape(self.radius, bore, low[v], high[v], seats, holes, mark))
        return shapes

    def _mark(self) -> ReferenceMark:
        land = self.seat - self.bore
        diameter = min(MARK[0], MARK_PART * land)
        return ReferenceMark(self.bore + 0.5 * land, diameter, MARK[1])


@dataclass(frozen=True)
class Tube(Cylinder):
    """A tube; bolts go through its wall.

    wall : thickness of its wall [mm]
    """

    wall: float = 0.0

    keys: ClassVar[tuple[str, ...]] = ("wall_mm",)
    summary: ClassVar[str] = "circular hollow section, EN 10210-2"
    series: ClassVar[str] = "tube"
    body: ClassVar[str] = "the wall of a tube"

    @classmethod
    def joined_by(cls, connection: Connection, profile: Profile) -> type[NodeSize]:
        """A hub where beams are joined by tongues."""
        return cls if connection.tongue(profile) is None else TubeHub

    @property
    def bore(self) -> float:
        """Inside radius [mm]."""
        return max(self.radius - self.wall, 0.0)

    def hole_room(self, joints: Joints, drilling: Drilling) -> tuple[Floats, bool]:
        """The wall behind the seats: all of it is thread.

        Raises
        ------
        DetailError
            The wall is too thin for the thread.
        """
        room, least = self._room(joints, drilling), self._least(drilling)
        arms = joints.arms
        if self.bore < drilling.reach + EDGE_OF_BORE:
            raise DetailError(
                f"node {node_mark(arms.node[0])}: the holes for beam {beam_mark(arms.edge[0])} "
                f"reach {drilling.reach:.1f} mm from its middle; the bore has a radius of "
                f"{self.bore:.1f} mm, at least {drilling.reach + EDGE_OF_BORE:.1f} mm are needed\n"
                f"take a smaller [node] wall_mm, {self._enough(joints)}"
            )
        if room[0] < least - RADIUS_SLACK:
            more = self.wall + least - float(room[0])
            raise DetailError(
                f"node {node_mark(arms.node[0])}: the thread for beam {beam_mark(arms.edge[0])} "
                f"has {room[0]:.1f} mm of wall behind the seat; {drilling.size} needs {least:g} mm"
                f"\ntake [node] wall_mm = {np.ceil(more):g}, or a smaller [connection] bolt"
            )
        return room, True

    def _room(self, joints: Joints, drilling: Drilling) -> Floats:
        """(A,) wall [mm] behind the seats."""
        return np.full(len(joints.arms.node), self.seat - self.bore)

    @staticmethod
    def _least(drilling: Drilling) -> float:
        """Thread [mm] in the wall."""
        return drilling.thread

    @classmethod
    def _of(cls, diameter: float, needed: float, forced_by: int, joints: Joints) -> Self:
        size = Cylinder._of(diameter, needed, forced_by, joints)
        return cls(
            size.radius, size.seat, size.cut, size.width, needed, forced_by,
            wall=joints.project.node.wall_mm,
        )  # fmt: skip

    def remedy(self, joints: Joints) -> str:
        """Another wall, or what does for a cylinder."""
        if self.bore <= 0:
            return f"[node] wall_mm = {math.floor(self.seat - LEAST_WALL)}, or a solid cylinder"
        return f"[node] wall_mm = {self._enough_wall(joints)}, or {self._enough(joints)}"

    def beyond(self, joints: Joints) -> str:
        """The thinnest wall with which a diameter of the series does, or one beyond it."""
        settings = joints.project.node
        found: list[tuple[int, str]] = []
        series = sorted(settings.series_mm) or node_diameters(self.series)
        own = [d for d in series if d >= settings.min_diameter_mm]
        if settings.diameter_mm != "auto":
            own = [settings.diameter_mm]
        for diameter in (*own, *self._past(joints)):
            past = "" if diameter in own else f"diameter_mm = {diameter:g} with "
            if past and found:
                break
            size = self._of(diameter, self.needed, self.forced_by, joints)
            wall = size._enough_wall(joints)
            if not replace(size, wall=wall).misfit(joints):
                found.append((wall, f"[node] {past}wall_mm = {wall}"))
        return min(found, default=(0, "arms farther apart"))[1]

    def _enough_wall(self, joints: Joints) -> int:
        """Wall [mm] that seats and threads need."""
        drilling = joints.connection.drilling(joints.profile)
        behind = LEAST_WALL if drilling is None else max(LEAST_WALL, drilling.thread)
        return math.ceil(self.radius - self.seat + behind)

    def misfit(self, joints: Joints | None = None) -> str:
        """Also where no bore is left."""
        if self.radius >= self.needed - RADIUS_SLACK and self.bore <= 0:
            return (
                f"a tube of diameter {2 * self.radius:g} mm has no bore left with [node] wall_mm = "
                f"{self.wall:g}"
            )
        drilling = None if joints is None else joints.connection.drilling(joints.profile)
        if drilling is not None and self.bore < drilling.reach + EDGE_OF_BORE:
            return f"a bore of {2 * self.bore:.1f} mm is too narrow for the holes of an arm"
        return super().misfit(joints)

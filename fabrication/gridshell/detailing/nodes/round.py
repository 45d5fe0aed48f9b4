"""Round nodes: cylinders and tubes with seats, holes and a mark. docs/parts.md, Node element."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Final, Self

import numpy as np

from ddgfab.errors import DetailError
from ddgfab.mesh import Floats
from fabrication.gridshell.detailing.arm_room import least_radii
from fabrication.gridshell.detailing.frames import Arms, beam_mark, listed, node_mark
from fabrication.gridshell.detailing.nodes.base import Joints, NodeSize
from fabrication.gridshell.project import Project, bolt_diameters
from fabrication.parts.node import NodeShape, RadialHole, ReferenceMark, Seat
from fabrication.specs import Profile
from fabrication.standards import node_diameters
from fabrication.standards.profiles import z_range

LEAST_WALL: Final = 2.0
"""Steel [mm] that a seat must leave between itself and the bore, or the axis."""

RADIUS_SLACK: Final = 1e-6
"""A radius [mm] may fall short of the need by this, so that noise forces no larger node."""

THREAD: Final = 1.5
"""Depth of a blind bolt hole, in bolt diameters; at least one must be left."""

HOLE_WALL: Final = 3.0
"""Steel [mm] left between the tips of neighbouring blind holes."""

MARK: Final = (3.0, 1.0)
"""Diameter and depth [mm] of the reference mark where there is room."""

MARK_PART: Final = 0.4
"""Greatest part of the land between bore and seat that the mark may take."""


@dataclass(frozen=True)
class Cylinder(NodeSize):
    """A solid cylinder about the node axis, with a milled seat for each arm with a flat end."""

    series: ClassVar[str] = "cylinder"
    body: ClassVar[str] = "a cylinder"
    remedy: ClassVar[str] = "a narrower [beam] profile"

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
                if diameter >= settings.min_diameter_mm and not size.misfit():
                    return size
            raise DetailError(
                f"{_forced(arms, worst)}, which needs a diameter of {2 * needed:.1f} mm; the "
                f"series ends at {series[-1]:g} mm\ntake a narrower [beam] profile"
                f"{_middle(joints)} or a larger [node] series_mm"
            )
        size = cls._of(settings.diameter_mm, needed, int(arms.node[worst]), joints)
        if size.radius < needed - RADIUS_SLACK:
            bad = np.flatnonzero(needs > size.radius + RADIUS_SLACK)
            bad = bad[np.argsort(-needs[bad], kind="stable")]
            raise listed(
                [f"{_forced(arms, k)}, which needs {2 * needs[k]:.1f} mm" for k in bad.tolist()],
                f"[node] diameter_mm = {settings.diameter_mm:g} is too small for beams "
                f'{width:g} mm wide{_rolled(joints)}: at least {2 * needed:.1f} mm, or "auto"',
            )
        if misfit := size.misfit():
            raise DetailError(misfit)
        return size

    @classmethod
    def _of(cls, diameter: float, needed: float, forced_by: int, joints: Joints) -> Self:
        radius, width, project = 0.5 * diameter, joints.width, joints.project
        flat = project.beam.end == "flat"
        seat = max(radius**2 - 0.25 * width**2, 0.0) ** 0.5 if flat else radius
        cut = seat + project.beam.clearance_mm
        return cls(radius, seat, cut, width, needed, forced_by)

    def misfit(self) -> str:
        """Why a size does not do, or an empty string."""
        if self.radius < self.needed - RADIUS_SLACK:
            return f"diameter {2 * self.radius:g} mm is less than {2 * self.needed:.1f} mm"
        if self.seat - self.bore < LEAST_WALL:
            return (
                f"a seat at {self.seat:.2f} mm from the axis leaves {self.seat - self.bore:.2f} mm "
                f"of {self.body} of diameter {2 * self.radius:g} mm; at least "
                f"{LEAST_WALL:g} mm: take {self.remedy} or a larger diameter"
            )
        return ""

    def shapes(
        self, joints: Joints, bottom: Floats, top: Floats, middle: Floats
    ) -> list[NodeShape]:
        """Cylinders or tubes with seats, holes and a mark.

        Raises
        ------
        DetailError
            Bolts wider than the seat, or so near each other that their holes meet.
        """
        arms, project = joints.arms, joints.project
        depths = self._hole_depths(joints)
        bolt = bolt_diameters(project.node.bolt)
        flat = project.beam.end == "flat"
        mark = self._mark()
        low, high = bottom.tolist(), top.tolist()
        azimuths, heights, starts = arms.azimuth.tolist(), middle.tolist(), arms.start.tolist()
        shapes = []
        for v in np.flatnonzero(np.diff(arms.start)).tolist():
            own = range(starts[v], starts[v + 1])
            seats = tuple(Seat(azimuths[k], self.seat, self.width) for k in own) if flat else ()
            holes = (
                tuple(RadialHole(azimuths[k], heights[k], bolt[1], depths[k]) for k in own)
                if bolt
                else ()
            )
            shapes.append(NodeShape(self.radius, self.bore, low[v], high[v], seats, holes, mark))
        return shapes

    def _mark(self) -> ReferenceMark:
        land = self.seat - self.bore
        diameter = min(MARK[0], MARK_PART * land)
        return ReferenceMark(self.bore + 0.5 * land, diameter, MARK[1])

    def _hole_depths(self, joints: Joints) -> list[float | None]:
        """Depth (A,) of each arm's radial hole; None through a tube's wall.

        Holes of diameter d at azimuth difference phi meet at (d/2) / tan(phi/2) along their axes.
        """
        arms, profile, project = joints.arms, joints.profile, joints.project
        bolt = bolt_diameters(project.node.bolt)
        if bolt and project.beam.end == "flat" and bolt[1] >= profile.width:
            raise _too_wide(bolt[1], profile, project)
        if bolt is None or self.bore > 0:
            return [None] * len(arms.node)
        nominal, diameter = bolt
        before = np.empty_like(arms.gap)
        before[arms.following()] = arms.gap
        half_angle = 0.5 * np.minimum(np.minimum(arms.gap, before), np.pi)
        room = self.seat - HOLE_WALL - 0.5 * diameter / np.tan(half_angle)
        shallow = np.flatnonzero(room < nominal)
        if len(shallow):
            raise listed(
                [
                    f"node {node_mark(arms.node[k])}: the hole for beam {beam_mark(arms.edge[k])} "
                    f"can be {room[k]:.1f} mm deep"
                    for k in shallow.tolist()
                ],
                f"{project.node.bolt} needs {nominal:g} mm: take a larger [node] diameter_mm, a "
                f'smaller bolt, or kind = "tube"',
            )
        return [float(depth) for depth in np.minimum(room, THREAD * nominal)]


@dataclass(frozen=True)
class Tube(Cylinder):
    """A tube; bolts go through its wall.

    wall : thickness of its wall [mm]
    """

    wall: float = 0.0

    keys: ClassVar[tuple[str, ...]] = ("wall_mm",)
    series: ClassVar[str] = "tube"
    body: ClassVar[str] = "the wall of a tube"
    remedy: ClassVar[str] = "a thicker [node] wall_mm"

    @property
    def bore(self) -> float:
        """Inside radius [mm]."""
        return max(self.radius - self.wall, 0.0)

    @classmethod
    def _of(cls, diameter: float, needed: float, forced_by: int, joints: Joints) -> Self:
        size = Cylinder._of(diameter, needed, forced_by, joints)
        return cls(
            size.radius, size.seat, size.cut, size.width, needed, forced_by,
            wall=joints.project.node.wall_mm,
        )  # fmt: skip

    def misfit(self) -> str:
        """Also where no bore is left."""
        if self.radius >= self.needed - RADIUS_SLACK and self.bore <= 0:
            return (
                f"a tube of diameter {2 * self.radius:g} mm has no bore left with [node] wall_mm = "
                f"{self.wall:g}: take a thinner wall or a solid cylinder"
            )
        return super().misfit()


def _middle(joints: Joints) -> str:
    """What helps beside a narrower profile where torsion rolls it about an edge off its middle."""
    centered = -0.5 * sum(z_range(joints.profile))
    if joints.width == joints.profile.width:
        return ""
    if joints.project.beam.eccentricity_mm == centered:
        return ""
    return f", [beam] eccentricity_mm = {centered:g}"


def _rolled(joints: Joints) -> str:
    if joints.width == joints.profile.width:
        return ""
    return f" at their ends ({joints.profile.name} rolled by torsion)"


def _forced(arms: Arms, k: int) -> str:
    other = int(arms.following()[k])
    return (
        f"node {node_mark(arms.node[k])} has beams {beam_mark(arms.edge[k])} and "
        f"{beam_mark(arms.edge[other])} at {np.degrees(arms.gap[k]):.1f} deg"
    )


def _too_wide(diameter: float, profile: Profile, project: Project) -> DetailError:
    return DetailError(
        f"the hole of {diameter:g} mm for [node] bolt {project.node.bolt} is wider than the seats "
        f"({profile.width:g} mm, the width of {profile.name}): take a smaller bolt or a wider "
        f"profile"
    )

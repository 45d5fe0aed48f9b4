"""The node's radius: arms must not touch. docs/parts.md, Node element; mathematics.md 11a."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from ddgfab.errors import DetailError
from ddgfab.mesh import Floats
from fabrication.gridshell.detailing.frames import (
    NAMED,
    Arms,
    EdgeFrames,
    beam_mark,
    listed,
    node_mark,
)
from fabrication.gridshell.project import Project
from fabrication.specs import Profile
from fabrication.standards import node_diameters
from fabrication.standards.profiles import z_range

LEAST_WALL: Final = 2.0
"""Wall [mm] that a seat must leave of a tube."""


RADIUS_SLACK: Final = 1e-6
"""A radius [mm] may fall short of the need by this, so that noise forces no larger node."""


@dataclass(frozen=True)
class NodeSize:
    """Dimensions that all nodes share [mm].

    radius, bore : outside and inside radius; bore 0 for a solid cylinder
    seat : distance of the seats from the axis; the radius where there are none
    cut : distance of the beams' cuts from the axis
    width : of the seats, and of the strip beside the line to the axis that an arm needs
    needed : least radius that the arms allow
    forced_by : vertex of the node that needs it
    """

    radius: float
    bore: float
    seat: float
    cut: float
    width: float
    needed: float
    forced_by: int


def least_radii(arms: Arms, width: float, clearance: float) -> Floats:
    """(A,) least radius [mm] that keeps each arm from the next: (b/2) / sin(phi/2) + clearance.

    Arms of width b at azimuth difference phi meet at that distance from the axis; beyond a
    straight angle only the arm's own width counts.
    """
    half_angle = 0.5 * np.minimum(arms.gap, np.pi)
    return 0.5 * width / np.sin(half_angle) + clearance


def close_arms(arms: Arms, limit_deg: float) -> str | None:
    """Which neighbouring arms are nearer in azimuth than the limit [deg], closest first; or None.

    The nodes themselves carry the check; this names the arms.
    """
    gap = np.degrees(arms.gap)
    after = arms.following()
    close = np.flatnonzero(gap < limit_deg)
    if not len(close):
        return None
    close = close[np.argsort(gap[close], kind="stable")]
    pairs = [
        f"{beam_mark(arms.edge[k])} and {beam_mark(arms.edge[after[k]])} at "
        f"{node_mark(arms.node[k])} ({gap[k]:.1f} deg)"
        for k in close[:NAMED].tolist()
    ]
    more = f" and {len(close) - NAMED} more" if len(close) > NAMED else ""
    return f"arms are less than {limit_deg:g} deg apart: {', '.join(pairs)}{more}"


def arm_width(frames: EdgeFrames, profile: Profile, project: Project) -> float:
    """Width [mm] of the strip about the line to the node axis that holds the end of every arm.

    The width of the profile without torsion; a beam that is rolled against the axis by rho needs
    room for its corners at y cos(rho) - z sin(rho).
    """
    if not frames.twisted:
        return profile.width
    cos, sin = np.cos(frames.roll), np.abs(np.sin(frames.roll))
    reach = max(abs(z + project.beam.eccentricity_mm) for z in z_range(profile))
    return float((profile.width * cos + 2.0 * reach * sin).max())


def node_size(arms: Arms, width: float, profile: Profile, project: Project) -> NodeSize:
    """Size of the nodes: the given diameter, or the least of the series that fits everywhere.

    Parameters
    ----------
    width : room that an arm needs, from `arm_width`

    Raises
    ------
    DetailError
        The given diameter, or every one of the series, is too small; names node, arms and angle.
    """
    settings = project.node
    needs = least_radii(arms, width, settings.arm_clearance_mm)
    worst = int(needs.argmax())
    needed = float(needs[worst])
    if settings.diameter_mm == "auto":
        series = sorted(settings.series_mm) or node_diameters(settings.kind)
        for diameter in series:
            size = _size(diameter, needed, int(arms.node[worst]), width, project)
            if diameter >= settings.min_diameter_mm and not _misfit(size, project):
                return size
        raise DetailError(
            f"{_forced(arms, worst)}, which needs a diameter of {2 * needed:.1f} mm; the series "
            f"ends at {series[-1]:g} mm\ntake a narrower [beam] profile"
            f"{_middle(width, profile, project)} or a larger [node] series_mm"
        )
    size = _size(settings.diameter_mm, needed, int(arms.node[worst]), width, project)
    if size.radius < needed - RADIUS_SLACK:
        bad = np.flatnonzero(needs > size.radius + RADIUS_SLACK)
        bad = bad[np.argsort(-needs[bad], kind="stable")]
        raise listed(
            [f"{_forced(arms, k)}, which needs {2 * needs[k]:.1f} mm" for k in bad.tolist()],
            f"[node] diameter_mm = {settings.diameter_mm:g} is too small for beams "
            f'{width:g} mm wide{_rolled(width, profile)}: at least {2 * needed:.1f} mm, or "auto"',
        )
    misfit = _misfit(size, project)
    if misfit:
        raise DetailError(misfit)
    return size


def _size(
    diameter: float, needed: float, forced_by: int, width: float, project: Project
) -> NodeSize:
    radius = 0.5 * diameter
    bore = max(radius - project.node.wall_mm, 0.0) if project.node.kind == "tube" else 0.0
    flat = project.beam.end == "flat"
    seat = max(radius**2 - 0.25 * width**2, 0.0) ** 0.5 if flat else radius
    cut = seat + project.beam.clearance_mm
    return NodeSize(radius, bore, seat, cut, width, needed, forced_by)


def _middle(width: float, profile: Profile, project: Project) -> str:
    """What helps beside a narrower profile where torsion rolls it about an edge off its middle."""
    centered = -0.5 * sum(z_range(profile))
    if width == profile.width or project.beam.eccentricity_mm == centered:
        return ""
    return f", [beam] eccentricity_mm = {centered:g}"


def _rolled(width: float, profile: Profile) -> str:
    return "" if width == profile.width else f" at their ends ({profile.name} rolled by torsion)"


def _misfit(size: NodeSize, project: Project) -> str:
    """Why a size does not do, or an empty string."""
    if size.radius < size.needed - RADIUS_SLACK:
        return f"diameter {2 * size.radius:g} mm is less than {2 * size.needed:.1f} mm"
    if project.node.kind == "tube" and size.bore <= 0:
        return (
            f"a tube of diameter {2 * size.radius:g} mm has no bore left with [node] wall_mm = "
            f"{project.node.wall_mm:g}: take a thinner wall or a solid cylinder"
        )
    if size.seat - size.bore < LEAST_WALL:
        return (
            f"a seat at {size.seat:.2f} mm from the axis leaves {size.seat - size.bore:.2f} mm of "
            f"the wall of a tube of diameter {2 * size.radius:g} mm; at least {LEAST_WALL:g} mm: "
            f"take a thicker [node] wall_mm or a larger diameter"
        )
    return ""


def _forced(arms: Arms, k: int) -> str:
    other = int(arms.following()[k])
    return (
        f"node {node_mark(arms.node[k])} has beams {beam_mark(arms.edge[k])} and "
        f"{beam_mark(arms.edge[other])} at {np.degrees(arms.gap[k]):.1f} deg"
    )

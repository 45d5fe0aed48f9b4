"""The room that arms need about a node's axis, so that they do not touch.

Source: docs/parts.md, Node element; mathematics.md 11a.
"""

from __future__ import annotations

import numpy as np

from ddgfab.mesh import Floats
from fabrication.gridshell.detailing.frames import (
    NAMED,
    Arms,
    EdgeFrames,
    beam_mark,
    node_mark,
)
from fabrication.gridshell.project import Project
from fabrication.specs import Profile
from fabrication.standards.profiles import z_range


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

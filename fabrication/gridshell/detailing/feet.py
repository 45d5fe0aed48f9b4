"""Sizes of base plates: the post below a node, the plate and its holes, how high it may lie.

Distances of the anchor holes: EN 1993-1-8:2005, table 3.3 (edges, spacing); holes of ISO 273,
medium, which are within EN 1992-4:2018, table 6.1. Rules of our own: the room of a spanner, and
length and thickness of a post.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from ddgfab.errors import DetailError
from ddgfab.mesh import Floats, Ints
from fabrication.gridshell.detailing.connections.base import usual_plate
from fabrication.gridshell.detailing.frames import Arms, EdgeFrames, node_mark
from fabrication.gridshell.detailing.joining import Fitted, Place
from fabrication.gridshell.detailing.sections import Sections
from fabrication.gridshell.project import Project
from fabrication.standards import node_diameters
from fabrication.standards.fasteners import Fastener, fastener

THINNEST: Final = 20.0
"""Least diameter [mm] of a post."""

SHORTEST: Final = 40.0
"""Least length [mm] of a post on its short side: room to weld both ends."""

STAND: Final = 5.0
"""Room [mm] between the end of an anchor and the beams."""

SLACK: Final = 1e-6
"""A length [mm] may be off by this: rounding of sums."""

STEP: Final = 5.0
"""Sizes of plates, distances below the vertices, and long anchors [mm] are multiples of this."""


@dataclass(frozen=True)
class Foot:
    """What the base plates of one place have in common [mm].

    size : of the anchors
    radius : of the posts
    width, thickness, spread : of the plates, and of their holes from the middle
    off : what the holes keep from the post
    above : how far anchors stand out of the plate
    """

    size: Fastener
    radius: float
    width: float
    thickness: float
    spread: float
    off: float
    above: float


def foot_of(place: Place, axes: Floats, fitted: Fitted, own: Ints, project: Project) -> Foot:
    """Post and plate of the supports of one place."""
    settings, size = project.ground, fastener(project.ground.anchor)
    radius = _post(place, axes, fitted, own, project)
    leg = project.connection.weld_mm * math.sqrt(2.0)
    off = max(0.5 * size.wrench, leg + 0.5 * size.washer[1])
    edge = STEP * math.ceil(max(size.edge, 0.5 * size.washer[1]) / STEP)
    spread = max((radius + off) / math.sqrt(2.0), 0.5 * size.spacing_across, radius + leg - edge)
    spread = STEP * math.ceil(spread / STEP)
    plate = usual_plate(size) if settings.plate_mm == "auto" else settings.plate_mm
    above = size.washer[2] + size.nut + size.pitch
    return Foot(size, radius, 2.0 * (spread + edge), plate, spread, off, above)


def _post(place: Place, axes: Floats, fitted: Fitted, own: Ints, project: Project) -> float:
    """Radius [mm] of the posts: what is asked for, or the largest bar within the cuts.

    Below a node that is shorter than the beams' ends the post leaves the axis before it is below
    them: by sin(lean) for each mm.
    """
    given, kind = project.ground.post_mm, place.joints.project.node.kind
    inner, outer = place.size.post(project.beam.clearance_mm)
    up = axes[own, 2]
    beside = np.maximum(fitted.bottoms[own] - fitted.lows[own], 0.0)
    room = 2.0 * (outer * up - beside * np.sqrt(1.0 - np.minimum(up, 1.0) ** 2))
    worst = int(room.argmin())
    least, most = max(2.0 * inner, THINNEST), float(room[worst]) + SLACK
    if given == "auto":
        bars = [d for d in node_diameters("cylinder") if least <= d <= most]
        found = bars[-1] if bars else float(math.floor(most))  # turned down
    else:
        found = given
    if least <= found <= most:
        return 0.5 * found
    node, lean = node_mark(own[worst]), math.degrees(math.acos(min(float(up[worst]), 1.0)))
    if most < least:
        advice = f'leave {node} out of [ground] where, or take [ground] kind = "none"'
        if not beside[worst]:
            wider = STEP * math.ceil(2.0 * place.size.radius * least / most / STEP)
            advice = f'take [[node]] where = "supports" with diameter_mm = {wider:g} or more'
        raise DetailError(
            f"node {node}: a post needs a diameter of {least:.1f} mm or more; below the {kind}, "
            f"whose axis leans by {lean:.1f} deg, the beams leave {max(most, 0.0):.1f} mm\n{advice}"
        )
    nearest = math.floor(most) if found > most else math.ceil(least)
    raise DetailError(
        f"node {node}: [ground] post_mm = {given:g} does not meet its bottom: the {kind}, whose "
        f"axis leans by {lean:.1f} deg, takes {least:.1f} to {most:.1f} mm\ntake [ground] post_mm "
        f'= {nearest} or "auto"'
    )


def highest_top(
    v: int,
    foot: Foot,
    axes: Floats,
    frames: EdgeFrames,
    arms: Arms,
    sections: Sections,
    fitted: Fitted,
    project: Project,
) -> float:
    """Highest top [mm] of a base plate, from the vertex: below it the post and the beams."""
    axis = axes[v]
    up, flat = float(axis[2]), float(math.hypot(axis[0], axis[1]))
    bottom = float(fitted.bottoms[v])
    gap = project.beam.clearance_mm / up
    top = up * bottom - gap - foot.radius * flat / up - SHORTEST
    own = np.arange(arms.start[v], arms.start[v + 1])
    edge, end = arms.edge[own], arms.end[own]
    side = np.cross(axis, arms.x_axis[v])
    radial = (
        np.cos(arms.azimuth[own])[:, None] * arms.x_axis[v]
        + np.sin(arms.azimuth[own])[:, None] * side
    )
    slope = frames.slope[edge, end] * (1 - 2 * end)
    stretch = np.hypot(1.0, slope)
    low = sections.low[edge] + project.beam.eccentricity_mm
    width = 0.5 * sections.width[edge]
    low = low - width * np.sin(np.abs(frames.roll[edge, end]))
    # z of the lower edge of each beam at a distance rho from the axis: first + rate rho
    first = up * low * stretch - width * np.abs(np.cross(axis, radial)[:, 2])
    way = radial + slope[:, None] * axis
    rate, plan = way[:, 2], np.hypot(way[:, 0], way[:, 1])
    cut = float(fitted.cuts[v])
    reach = foot.width / math.sqrt(2.0) + abs(bottom) * flat  # of the plate, from the vertex
    far = np.clip(reach / np.maximum(plan, SLACK), cut, np.maximum(frames.length[edge], cut))
    beams = first + np.minimum(rate * cut, rate * far)
    return min(top, float(beams.min()) - foot.above - STAND)

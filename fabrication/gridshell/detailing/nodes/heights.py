"""How far nodes reach along their axes: from the end faces of their arms."""

from __future__ import annotations

from typing import Final

import numpy as np

from ddgfab.errors import DetailError
from ddgfab.mesh import Floats, Mesh
from fabrication.gridshell.detailing.frames import Arms, EdgeFrames
from fabrication.gridshell.detailing.nodes.base import NodeSize
from fabrication.gridshell.detailing.sections import Sections
from fabrication.gridshell.project import Project
from fabrication.standards.profiles import z_range

STEP_SLACK: Final = 1e-6
"""Part of a height step by which rounding outwards may fall short, so that noise adds no step."""

OFF_MIDDLE: Final = 1e-6
"""A profile is centered on its edge when its two halves differ by less [mm]."""


def end_heights(
    frames: EdgeFrames, arms: Arms, size: NodeSize, sections: Sections, project: Project
) -> tuple[Floats, Floats, Floats]:
    """Lowest, middle and highest point (A,) [mm] of each arm's end face along its node axis.

    A point of the beam at distance rho from the axis and z above the vertex lies at
    s rho + z sqrt(1 + s^2) along it, s the slope seen away from the node. Where torsion rolls the
    beam against the axis, its sides count too.

    Raises
    ------
    DetailError
        Bolts in the nodes, but rolled beams that are not centered on their edges.
    """
    if frames.twisted:
        return _rolled_heights(frames, arms, size, sections, project)
    slope = frames.slope[arms.edge, arms.end] * (1 - 2 * arms.end)
    stretch = np.hypot(1.0, slope)
    low, high = _levels(arms, sections, project)
    near: float | Floats = size.cut
    if project.beam.end == "cope":  # the corners of a coped end lie nearer to the axis plane
        near = np.sqrt(size.cut**2 - 0.25 * sections.width[arms.edge] ** 2)
    reach = np.stack([slope * near, slope * size.cut])
    return (
        reach.min(axis=0) + low * stretch,
        slope * size.cut + 0.5 * (low + high) * stretch,
        reach.max(axis=0) + high * stretch,
    )


def _rolled_heights(
    frames: EdgeFrames, arms: Arms, size: NodeSize, sections: Sections, project: Project
) -> tuple[Floats, Floats, Floats]:
    """As `end_heights`, for node axes along (lean, sin(roll), cos(roll)) in the beam's frame.

    Their cuts have slope = lean cos(roll) and skew = lean sin(roll).
    """
    at = arms.edge, arms.end
    slope, skew, roll = frames.slope[at], frames.skew[at], frames.roll[at]
    lean = slope * np.cos(roll) + skew * np.sin(roll)
    unit = 1.0 / np.hypot(1.0, lean)
    away = (1 - 2 * arms.end) * lean * size.cut
    by_z = (lean * slope + np.cos(roll)) * unit
    by_y = np.abs(lean * skew + np.sin(roll)) * unit
    low, high = _levels(arms, sections, project)
    off, profile = float(np.abs(low + high).max()), sections.profiles[0]
    if project.connection.kind != "welded" and off > OFF_MIDDLE:
        raise DetailError(
            f"beams are rolled by torsion about the mesh edges, {0.5 * off:.6g} mm "
            f"from the middle of {profile.name}: bolts there miss the node axes\n"
            f"set [beam] eccentricity_mm = {-0.5 * sum(z_range(profile)):g}"
        )
    both = np.stack([low * by_z, high * by_z])
    half = 0.5 * sections.width[arms.edge] * by_y
    return away + both.min(axis=0) - half, away + both.mean(axis=0), away + both.max(axis=0) + half


def _levels(arms: Arms, sections: Sections, project: Project) -> tuple[Floats, Floats]:
    """Lowest and highest z (A,) [mm] of each arm's beam above its edge."""
    shift = project.beam.eccentricity_mm
    return sections.low[arms.edge] + shift, sections.high[arms.edge] + shift


def node_ends(
    mesh: Mesh, arms: Arms, low: Floats, high: Floats, project: Project
) -> tuple[Floats, Floats]:
    """Bottom and top (V,) [mm] of the nodes along their axes; zero for unused vertices."""
    step = project.node.height_step_mm
    bottom, top = np.zeros(mesh.n_vertices), np.zeros(mesh.n_vertices)
    used = np.flatnonzero(np.diff(arms.start))
    lowest = np.minimum.reduceat(low, arms.start[used]) - project.node.margin_mm
    highest = np.maximum.reduceat(high, arms.start[used]) + project.node.top_margin_mm
    bottom[used] = step * np.floor(lowest / step + STEP_SLACK)
    top[used] = step * np.ceil(highest / step - STEP_SLACK)
    return bottom, top

"""How high panes must lie to pass over beams and nodes."""

from __future__ import annotations

from typing import Final

import numpy as np

from ddgfab.mesh import Floats, Mesh
from fabrication.gridshell.detailing.frames import EdgeFrames, panel_mark
from fabrication.gridshell.detailing.panels import Planes, outward_normals
from fabrication.gridshell.detailing.sections import Sections
from fabrication.gridshell.project import Project

PANEL_CLEARANCE: Final = 3.0
"""Room [mm] between a pane's inner surface and the steel below: a strip of sealant or silicone."""

OFFSET_STEP: Final = 5.0
"""Offsets [mm] are multiples of this."""

OFFSET_LIMIT: Final = 60.0
"""Greatest automatic offset [mm]; where more is needed, that is an error."""

STEP_SLACK: Final = 1e-6
"""Part of a step by which rounding up may fall short, so that noise adds no step."""


def steel_heights(
    mesh: Mesh,
    axes: Floats,
    planes: Planes,
    frames: EdgeFrames,
    tops: Floats,
    radii: Floats,
    sections: Sections,
    project: Project,
) -> Floats:
    """(F,) upper bound [mm] of the height of beams and nodes above each face's plane.

    Beams count with the top of their bounding box on the face's side of pi(e), nodes with the
    highest point of their top rim (V,) `tops` above the vertices, of (V,) `radii`.
    """
    face, edge = mesh.corner_face, mesh.corner_edge
    z = planes.z[face]
    here = mesh.vertices[mesh.corners] - planes.origin[face]
    corner = np.einsum("ci,ci->c", here, z)
    both = np.maximum(corner, corner[mesh.corner_next])
    up = project.beam.eccentricity_mm + sections.high[edge]
    flank = -0.5 * sections.width[edge] * np.einsum("ci,ci->c", outward_normals(mesh, frames), z)
    beams = both + up * np.einsum("ci,ci->c", frames.z[edge], z) + np.maximum(flank, 0.0)
    upright = np.einsum("ci,ci->c", axes[mesh.corners], z)
    tilt = np.sqrt(np.maximum(1.0 - upright**2, 0.0))
    nodes = corner + tops[mesh.corners] * upright + radii[mesh.corners] * tilt
    highest: Floats = np.maximum.reduceat(np.maximum(beams, nodes), mesh.face_start[:-1])
    return highest


def panel_offset(heights: Floats, project: Project) -> tuple[float, str | None]:
    """The panes' offset [mm], and what is wrong with it or None."""
    given = project.panel.offset_mm
    worst = int(heights.argmax())
    needed = float(heights[worst]) + PANEL_CLEARANCE
    if given != "auto":
        return given, None
    offset = max(OFFSET_STEP * float(np.ceil(needed / OFFSET_STEP - STEP_SLACK)), 0.0)
    if offset <= OFFSET_LIMIT:
        return offset, None
    return OFFSET_LIMIT, (
        f"panel {panel_mark(worst)} would need an offset of {needed:.1f} mm to pass over the "
        f"steel; {OFFSET_LIMIT:g} mm is taken: parts may touch there ([panel] offset_mm)"
    )

"""[net] kind = "surface" of a project, carried out: a net traced on its surface."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from ddgfab.errors import InputError
from ddgfab.mesh import Mesh
from ddgfab.surfaces.nearest import nearest_points
from ddgfab.surfaces.spline import SplineSurface
from ddgfab.trace import Traced, trace
from fabrication.gridshell.project import Project
from fabrication.surfaces_in.find import MESH_SUFFIXES, find_surface


def traced_net(project: Project) -> tuple[SplineSurface, Traced]:
    """The surface of a project, and the net [mm] traced on it.

    Raises
    ------
    InputError
        The surface cannot be found or read; the unit or scale of a surface that is in millimetres
        by itself; a spacing that does not suit it.
    DegenerateError
        Lines that make no cells; names the place.
    """
    net, size = project.net, project.project
    source: str | Path = net.surface if project.mesh_path is None else project.mesh_path
    if size.median_edge_mm is not None:
        raise InputError("[project] median_edge_mm is for meshes; [net] spacing_mm says the edges")
    scaled = size.units is not None or size.scale != 1.0
    if scaled and Path(source).suffix.lower() not in MESH_SUFFIXES:
        raise InputError(
            "[project] units and scale are for meshes: STEP and IGES files state their unit, and "
            "surfaces by name are in millimetres"
        )
    surface = find_surface(source, net.parameters, net.face, units=size.units, scale=size.scale)
    return surface, trace(
        surface,
        (net.spacing_mm, net.spacing_across_mm or net.spacing_mm),
        along=net.along,
        turn=None if net.turn_deg is None else math.radians(net.turn_deg),
    )


def distance_note(surface: SplineSurface, mesh: Mesh) -> str:
    """How far the vertices of a net [mm] lie from the surface itself, a sentence."""
    far = np.where(mesh.valences > 0, nearest_points(surface, mesh.vertices).distance, 0.0)
    worst = int(far.argmax())
    return (
        f"vertices lie {far[mesh.valences > 0].mean():.2g} mm from {surface.name} on average, at "
        f"most {far[worst]:.3g} mm (vertex {worst})"
    )

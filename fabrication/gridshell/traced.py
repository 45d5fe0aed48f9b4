"""[net] kind = "surface" of a project, carried out: a net traced on its surface."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np
from scipy.spatial import cKDTree

from ddgfab.errors import InputError, OptimizeError, SupportError
from ddgfab.mesh import Floats, Mesh
from ddgfab.optimize import OptimizeResult
from ddgfab.support import support_structure
from ddgfab.surfaces.nearest import nearest_points
from ddgfab.surfaces.spline import SplineSurface
from ddgfab.trace.patches import Patches, trace_patches
from ddgfab.trace.samples import Samples
from fabrication.gridshell.load import TRACED_GOAL
from fabrication.gridshell.net_settings import OptimizeSettings
from fabrication.gridshell.optimized import optimized_mesh
from fabrication.gridshell.project import Project
from fabrication.progress import Progress
from fabrication.surfaces_in.curves import read_curves
from fabrication.surfaces_in.find import MESH_SUFFIXES, find_surfaces

_ANY_LEAN: Final = 89.0
"""Node axes that lean by less [deg] are measured before they are judged."""

_CLOSE: Final = 1e-3
"""Trimming curves are sampled at this part of an edge."""


def traced_net(project: Project) -> Patches:
    """The net [mm] traced on the surfaces of a project.

    Raises
    ------
    InputError
        The surface cannot be found or read; the unit or scale of a surface that is in millimetres
        by itself; a spacing that does not suit it; curves that do not lie on it.
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
    surfaces = find_surfaces(source, net.parameters, net.face, units=size.units, scale=size.scale)
    drawn = None
    if net.curves is not None:
        folder = Path() if project.file is None else project.file.parent
        drawn = read_curves(folder / net.curves)
    return trace_patches(
        surfaces,
        (net.spacing_mm, net.spacing_across_mm or net.spacing_mm),
        along=net.along,
        turn=None if net.turn_deg is None else math.radians(net.turn_deg),
        drawn=drawn,
        through=None if not net.through else np.array(net.through),
    )


def distance_note(surfaces: Sequence[SplineSurface], mesh: Mesh) -> str:
    """How far the vertices of a net [mm] lie from the surfaces themselves, a sentence."""
    each = [nearest_points(surface, mesh.vertices).distance for surface in surfaces]
    far = np.where(mesh.valences > 0, np.min(each, axis=0), 0.0)
    worst = int(far.argmax())
    name = surfaces[0].name if len(surfaces) == 1 else f"the {len(surfaces)} surfaces"
    rim = np.flatnonzero(mesh.boundary_vertex)
    off = rim_distance(surfaces, mesh)
    return (
        f"vertices lie {far[mesh.valences > 0].mean():.3g} mm from {name} on average, at "
        f"most {far[worst]:.3g} mm (vertex {worst}); those of the rim {off.mean():.3g} mm from its "
        f"trimming curves, at most {off.max():.3g} mm (vertex {rim[off.argmax()]})"
    )


def rim_distance(surfaces: Sequence[SplineSurface], mesh: Mesh) -> Floats:
    """(n,) how far the vertices of the rim [mm], in their order, lie from the trimming curves."""
    step = _CLOSE * float(np.median(mesh.edge_lengths))
    curves = [Samples.of(surface).rim(step) for surface in surfaces]
    rim = mesh.vertices[mesh.boundary_vertex]
    return np.asarray(cKDTree(np.concatenate(curves)).query(rim)[0])


def traced_optimum(
    net: Mesh, reference: Mesh, project: Project, progress: Progress
) -> tuple[OptimizeResult, tuple[str, ...]]:
    """The traced net [mm] optimised, and what to know of it.

    Where the project asks for nothing else, planar faces; around umbilics and on steep rims these
    may leave axes that lean too far, and then axes are made upright with the faces: with the rim
    on the trimming curves where that is possible.

    Raises
    ------
    OptimizeError
        The goal is missed; carries the best mesh as `result`.
    """
    settings = project.optimize
    first = optimized_mesh(net, settings, progress, surface=reference, rim=reference)
    if settings != OptimizeSettings.model_validate(TRACED_GOAL):
        return first, ()
    limit = project.support.lean_limit_deg
    lean = _lean_deg(first.mesh, project)
    if lean <= limit:
        return first, ()
    upright = settings.model_copy(update={"goal": "torsion-free"})
    note = (
        f"planar faces alone leave node axes that lean by {lean:.0f} deg (limit {limit:g}): the "
        "net was made torsion-free with upright axes instead, as [optimize] goal = "
        '"torsion-free" does, with the rim '
    )
    on_curve = upright.model_copy(update={"boundary": "glide"})
    try:
        second = optimized_mesh(net, on_curve, progress, surface=reference, rim=reference)
    except OptimizeError as error:
        why = f"there is no such net with the rim on them: {str(error).splitlines()[0]}"
    else:
        lean = _lean_deg(second.mesh, project)
        if lean <= limit:
            return second, (f"{note}on the trimming curves",)
        why = f"with the rim on them axes lean by {lean:.0f} deg"
    third = optimized_mesh(net, upright, progress, surface=reference, rim=reference)
    return third, (f"{note}free to leave the trimming curves, because {why}",)


def _lean_deg(mesh: Mesh, project: Project) -> float:
    """Greatest lean [deg] of the node axes that the project's support would give a mesh."""
    try:
        return support_structure(
            mesh,
            project.support.kind,
            lean_limit_deg=_ANY_LEAN,
            torsion_limit_deg=project.checks.torsion_deg,
        ).lean_deg_max
    except SupportError:
        return np.inf

"""Gauss images of meshes with planar faces, and the curvatures that they give.

A Gauss image is a parallel mesh near the unit sphere: its vertices lie on the sphere (circular
nets), its faces touch it (conical nets) or its edges do (meshes parallel to a Koebe net).
"""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np

from ddgfab.arguments import checked
from ddgfab.curvature import Curvatures, steiner_curvatures
from ddgfab.errors import DegenerateError, InputError, MeshError
from ddgfab.measures import circular_defect, conical_defect, planarity_percent
from ddgfab.measures.edge_offset import koebe_field
from ddgfab.mesh import Floats, Mesh
from ddgfab.offsets import Element, classify_offset
from ddgfab.support.exact import cone_field, smoothest_normals
from ddgfab.support.parallel import parallel_field
from ddgfab.tolerances import NET_ANGLE_DEG, NET_PLANAR_PERCENT

GaussKind = Literal["auto", "vertex", "face", "edge", "nearest"]

GAUSS_RELATIVE = 1e-6
"""Default spread of the distance from the sphere, and sine between edges, of a Gauss image."""


@checked
def gauss_image(mesh: Mesh, kind: GaussKind = "auto", tolerance: float = GAUSS_RELATIVE) -> Floats:
    """(V, 3) vertices of a mesh parallel to this one, which plays the unit normals.

    Parameters
    ----------
    kind : "vertex" (circular nets: vertices on the unit sphere), "face" (conical nets: faces touch
        it), "edge" (meshes parallel to a Koebe net: edges touch it), "nearest" (planar faces: the
        parallel mesh nearest to the vertex normals), "auto": the first of these that is exact
    tolerance : on the distances from the sphere and the sine between edges; six digits in a file
        need about 1e-4

    Raises
    ------
    MeshError
        Faces that are not planar; names the worst.
    DegenerateError
        A kind that the mesh does not have; says by how much.
    InputError
        An unknown kind.

    Source: Pottmann, Liu, Wallner, Bobenko, Wang 2007, sections 3, 4; mathematics.md 8.2, 10.6.
    """
    if kind not in get_args(GaussKind):
        raise InputError(f"unknown kind of Gauss image {kind!r}: {', '.join(get_args(GaussKind))}")
    flat = planarity_percent(mesh)
    if flat.max() > NET_PLANAR_PERCENT:
        worst = int(flat.argmax())
        raise MeshError(
            f"face {worst} is {flat[worst]:.2g} % from planar (limit {NET_PLANAR_PERCENT:g} %): "
            "no mesh is parallel to it; planarize first (ddgfab.optimize.optimize)"
        )
    if kind == "nearest":
        return parallel_field(mesh, mesh.vertex_normals)
    wanted: tuple[Element, ...] = ("vertex", "face", "edge")
    if kind != "auto":
        return _exact(mesh, kind, tolerance)
    for element in wanted:
        try:
            return _exact(mesh, element, tolerance)
        except DegenerateError:
            continue
    return parallel_field(mesh, mesh.vertex_normals)


@checked
def mesh_curvatures(
    mesh: Mesh, kind: GaussKind = "auto", tolerance: float = GAUSS_RELATIVE
) -> Curvatures:
    """Mean and Gauss curvature of each face, from the Gauss image of the mesh itself.

    Parameters
    ----------
    kind, tolerance : as in `gauss_image`

    Raises
    ------
    MeshError, DegenerateError, InputError
        As `gauss_image` and `ddgfab.curvature.steiner_curvatures`.

    Source: mathematics.md 8.2.
    """
    return steiner_curvatures(mesh, gauss_image(mesh, kind, tolerance), tolerance)


def _exact(mesh: Mesh, element: Element, tolerance: float) -> Floats:
    """Gauss image whose vertices, faces or edges touch the unit sphere."""
    if element == "edge":
        return koebe_field(mesh, tolerance)
    defect = circular_defect(mesh) if element == "vertex" else conical_defect(mesh)
    odd = element == "vertex" and (mesh.face_sizes % 2).any()
    none = element == "face" and mesh.boundary_vertex[mesh.valences > 0].all()
    worst = float(np.degrees(defect.max()))
    if odd or none or worst > NET_ANGLE_DEG:
        name = "circular with even faces" if element == "vertex" else "conical with cones inside"
        raise DegenerateError(
            f"the mesh is not {name}: greatest defect {worst:.2g} deg (limit {NET_ANGLE_DEG:g})"
        )
    field = smoothest_normals(mesh) if element == "vertex" else cone_field(mesh)
    report = classify_offset(mesh, mesh.vertices + field, max(tolerance, GAUSS_RELATIVE))
    if element not in report.constant or not report.is_parallel:
        raise DegenerateError(f"no Gauss image at a constant distance of its {element}: {report}")
    return field

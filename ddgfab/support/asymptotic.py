"""Does a net follow asymptotic lines? Then upright torsion-free axes do not exist, but normals."""

from __future__ import annotations

import numpy as np

from ddgfab.arguments import checked
from ddgfab.errors import SupportError
from ddgfab.measures import star_defect
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.tolerances import NET_STAR_DEG, RELATIVE_DEGENERATE

ASYMPTOTIC_BEND = 0.25
"""A net whose edges bend by less than this part of their normals' turn is called asymptotic."""


@checked
def edge_bend(mesh: Mesh) -> float:
    """How much edges bend in normal direction, as part of the turn of the normals along them.

    For an edge between interior vertices, |<e, n_i>| + |<e, n_j>| is its length times the normal
    curvature, and the angle between n_i and n_j is the whole turn of the normal. The ratio of
    their sums is 1 along principal lines, 0 along asymptotic lines (where all of the turn is
    torsion); 1 as well for a flat mesh, and where no edge lies in the interior.
    """
    start, end = mesh.edges.T
    inner = ~mesh.boundary_vertex[start] & ~mesh.boundary_vertex[end]
    along = unit(mesh.edge_vectors[inner])
    first, second = mesh.vertex_normals[start[inner]], mesh.vertex_normals[end[inner]]
    bend = np.abs(np.einsum("ex,ex->e", along, first)) + np.abs(
        np.einsum("ex,ex->e", along, second)
    )
    turn = np.arctan2(
        np.linalg.norm(np.cross(first, second), axis=1), np.einsum("ex,ex->e", first, second)
    )
    total = float(turn.sum())
    return float(bend.sum()) / total if total > 0 else 1.0


def surface_normals(mesh: Mesh) -> Floats:
    """(V, 3) unit normals: of the tangent planes of an A-net, elsewhere the vertex normals.

    Where all edges at every vertex lie in one plane within `NET_STAR_DEG` (an A-net, for instance
    a K-net), axes across these planes are perpendicular to every edge, at boundaries and corners
    too; the torsion of an edge is the angle by which the net twists along it. Zero at vertices
    that no face uses.

    Raises
    ------
    SupportError
        A vertex of an A-net whose edges all lie in one line, which has no tangent plane.

    Source: mathematics.md 3.1, 3.5.
    """
    if np.degrees(star_defect(mesh).max()) > NET_STAR_DEG:
        return mesh.vertex_normals
    normals = np.zeros_like(mesh.vertices)
    for valence in np.unique(mesh.valences[mesh.valences > 0]).tolist():
        ids = np.flatnonzero(mesh.valences == valence)
        edges = mesh.star_edges[mesh.star_start[ids, None] + np.arange(valence)]
        ways = unit(mesh.edge_vectors[edges])
        values, rows = np.linalg.svd(ways, full_matrices=True)[1:]
        flat = np.flatnonzero(values[:, 1] <= RELATIVE_DEGENERATE)
        if len(flat):
            raise SupportError(
                f"the {valence} edges at vertex {ids[flat[0]]} lie in one line: no tangent plane"
            )
        normals[ids] = rows[:, -1]
    side = np.einsum("vx,vx->v", normals, mesh.vertex_normals)
    return np.asarray(normals * np.copysign(1.0, side)[:, None])

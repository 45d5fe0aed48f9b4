"""Does a net follow asymptotic lines? Then upright torsion-free axes do not exist."""

from __future__ import annotations

import numpy as np

from ddgfab.mesh import Mesh, unit

ASYMPTOTIC_BEND = 0.25
"""A net whose edges bend by less than this part of their normals' turn is called asymptotic."""


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

"""Coarser meshes to begin with: every other polyline of quads is left out.

Far from planar faces vertices move over many edges; on a mesh of a quarter of the faces a step
costs a quarter and goes twice as far. The movement found there, taken over to the fine mesh, leaves
few steps to be done.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.terms.shape import polyline_triples

_QUAD: Final = 4


@dataclass(frozen=True, eq=False)
class Coarse:
    """A mesh without every other polyline.

    Attributes
    ----------
    mesh : the coarse mesh
    kept : (n,) its vertices in the fine one
    middles : (m, 3) the vertices between two that are kept, in the middle of the three
    centers : (c,) those inside the coarse faces, in the order of these
    """

    mesh: Mesh
    kept: Ints
    middles: Ints
    centers: Ints

    def prolonged(self, values: Floats, count: int) -> Floats:
        """(count, 3) values at the fine vertices from (n, 3) at the coarse ones."""
        fine = np.zeros((count, 3))
        fine[self.kept] = values
        fine[self.middles[:, 1]] = 0.5 * (fine[self.middles[:, 0]] + fine[self.middles[:, 2]])
        corners = values[self.mesh.corners.reshape(-1, _QUAD)]
        fine[self.centers] = corners.mean(axis=1)
        return fine


def coarsened(mesh: Mesh) -> Coarse | None:
    """A mesh of quads without every other polyline; None where these do not fit.

    They fit where all vertices of irregular valence, and all corners of the boundary, lie an even
    number of edges apart.
    """
    if (mesh.face_sizes != _QUAD).any():
        return None
    regular = np.where(mesh.boundary_vertex, mesh.valences == 3, mesh.valences == _QUAD)
    triples = polyline_triples(mesh)
    triples = triples[regular[triples[:, 1]]]
    kept = _kept(mesh, triples, ~regular & (mesh.valences > 0))
    if kept is None:
        return None
    both = kept[triples[:, 0]] & kept[triples[:, 2]]
    middles = triples[both]
    kind = np.zeros(mesh.n_vertices, dtype=np.int64)  # 0: center, 1: middle, 2: kept
    kind[middles[:, 1]] = 1
    kind[kept] = 2
    corners = mesh.corners.reshape(-1, _QUAD)
    counts = np.stack([(kind[corners] == k).sum(axis=1) for k in range(3)], axis=1)
    if (counts != [1, 2, 1]).any() or len(np.unique(middles[:, 1])) != len(middles):
        return None
    centers = np.flatnonzero((kind == 0) & (mesh.valences > 0))
    if mesh.boundary_vertex[centers].any() or (mesh.valences[centers] != _QUAD).any():
        return None
    star = mesh.star_faces[mesh.star_start[centers, None] + np.arange(_QUAD)]
    opposite = np.full(mesh.n_faces, -1)
    face, at = np.nonzero(kind[corners] == 2)
    opposite[face] = corners[face, at]
    ids = np.flatnonzero(kept)
    number = np.full(mesh.n_vertices, -1)
    number[ids] = np.arange(len(ids))
    coarse = Mesh.build(mesh.vertices[ids], number[opposite[star]])
    return Coarse(coarse, ids, middles, centers)


def _kept(mesh: Mesh, triples: Ints, irregular: NDArray[np.bool_]) -> NDArray[np.bool_] | None:
    """(V,) vertices an even number of edges along polylines from the irregular ones."""
    size = (mesh.n_vertices, mesh.n_vertices)
    graph = coo_array((np.ones(len(triples)), (triples[:, 0], triples[:, 2])), shape=size)
    label = connected_components(graph, directed=False)[1]
    piece = np.full(mesh.n_vertices, -1)
    piece[mesh.corners] = mesh.components[mesh.corner_face]
    chosen = []
    for k in range(int(piece.max()) + 1):
        mine = np.flatnonzero(piece == k)
        for group in (irregular, mesh.boundary_vertex, piece == k):
            begin = mine[group[mine]]
            if len(begin):
                chosen.append(label[begin[0]])
                break
    kept: NDArray[np.bool_] = np.isin(label, chosen) & (piece >= 0)
    return kept if kept[irregular].all() else None

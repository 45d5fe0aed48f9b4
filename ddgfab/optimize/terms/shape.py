"""Wishes about shape: closeness to given positions, fairness of polylines, Laplacian fairness."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array, csr_array, diags_array, eye_array, kron

from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.problem import mean_edge
from ddgfab.optimize.terms.base import LinearTerm


def closeness(
    mesh: Mesh, target: Floats | None = None, weights: Floats | float = 1.0, *, weight: float = 1.0
) -> LinearTerm:
    """Vertices near (V, 3) positions, by default where they are; weights (V,) if they differ.

    Residuals are distances in mean edges.
    """
    unit = mean_edge(mesh)
    aim = mesh.vertices if target is None else target
    part = np.broadcast_to(np.sqrt(weights), mesh.n_vertices) / unit
    matrix = diags_array(np.repeat(part, 3)).tocsr()
    return LinearTerm(
        name="closeness", matrix=matrix, target=(part[:, None] * aim).ravel(), weight=weight
    )


def polyline_triples(mesh: Mesh) -> Ints:
    """(m, 3) consecutive vertices of the polylines of a mesh, the middle one second.

    Polylines run straight through inner vertices of even valence (edge k to edge k + n/2), and
    along the boundary through its vertices. At a boundary vertex of valence 2 m they end.
    """
    triples = []
    inner = ~mesh.boundary_vertex & (mesh.valences > 0) & (mesh.valences % 2 == 0)
    for valence in np.unique(mesh.valences[inner]).tolist():
        ids = np.flatnonzero(inner & (mesh.valences == valence))
        around = _neighbours(mesh, ids, valence)
        half = valence // 2
        for k in range(half):
            triples.append(np.stack([around[:, k], ids, around[:, k + half]], axis=1))
    rim = np.flatnonzero(mesh.boundary_vertex & (mesh.valences > 2))
    if len(rim):
        first = _other_end(mesh, mesh.star_edges[mesh.star_start[rim]], rim)
        last = _other_end(mesh, mesh.star_edges[mesh.star_start[rim + 1] - 1], rim)
        triples.append(np.stack([first, rim, last], axis=1))
    return np.concatenate(triples) if triples else np.zeros((0, 3), dtype=np.int64)


def _other_end(mesh: Mesh, edges: Ints, vertices: Ints) -> Ints:
    ends = mesh.edges[edges]
    other: Ints = np.where(ends[..., 0] == vertices, ends[..., 1], ends[..., 0])
    return other


def _neighbours(mesh: Mesh, vertices: Ints, valence: int) -> Ints:
    """(n, valence) neighbours of vertices of one valence, counterclockwise."""
    edges = mesh.star_edges[mesh.star_start[vertices, None] + np.arange(valence)]
    return _other_end(mesh, edges, vertices[:, None])


def second_differences(mesh: Mesh, triples: Ints) -> csr_array:
    """(m, V) rows x_0 - 2 x_1 + x_2."""
    rows = np.repeat(np.arange(len(triples)), 3)
    data = np.tile([1.0, -2.0, 1.0], len(triples))
    return csr_array((data, (rows, triples.ravel())), shape=(len(triples), mesh.n_vertices))


def laplacian(mesh: Mesh) -> csr_array:
    """(V, V) vertex minus mean of its neighbours; zero rows at the boundary."""
    a, b = mesh.edges.T
    size = (mesh.n_vertices, mesh.n_vertices)
    graph = coo_array((np.ones(2 * len(a)), (np.r_[a, b], np.r_[b, a])), shape=size).tocsr()
    inner = (~mesh.boundary_vertex & (mesh.valences > 0)).astype(np.float64)
    return csr_array(diags_array(inner) - diags_array(inner / np.maximum(mesh.valences, 1)) @ graph)


def fairness(
    mesh: Mesh, *, weight: float = 1.0, of_change: bool = False, skip: Ints | None = None
) -> LinearTerm:
    """Second differences along polylines; of the movement alone with `of_change`.

    Parameters
    ----------
    skip : ids of vertices that polylines may turn at: features

    Residuals are in mean edges. Source: Liu, Pottmann, Wallner, Yang, Wang 2006, section 3.
    """
    triples = polyline_triples(mesh)
    if skip is not None:
        triples = triples[~np.isin(triples[:, 1], skip)]
    return _vector_term(mesh, second_differences(mesh, triples), "fairness", weight, of_change)


def laplacian_fairness(mesh: Mesh, *, weight: float = 1.0, of_change: bool = False) -> LinearTerm:
    """Inner vertices near the mean of their neighbours; residuals in mean edges."""
    return _vector_term(mesh, laplacian(mesh), "laplacian", weight, of_change)


def _vector_term(
    mesh: Mesh, scalar: csr_array, name: str, weight: float, of_change: bool
) -> LinearTerm:
    unit = mean_edge(mesh)
    matrix = csr_array(kron(scalar, eye_array(3), format="csr") / unit)
    rest = matrix @ mesh.vertices.ravel() if of_change else np.zeros(matrix.shape[0])
    return LinearTerm(name=name, matrix=matrix, target=rest, weight=weight)

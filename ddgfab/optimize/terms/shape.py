"""Soft terms about shape: closeness to positions, fairness of polylines, Laplacian, strain."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array, diags_array, vstack

from ddgfab.arguments import checked
from ddgfab.mesh import Floats, Ints, Mesh, unit
from ddgfab.optimize.problem import mean_edge
from ddgfab.optimize.terms.base import LinearTerm, VectorTerm


@checked
def closeness(
    mesh: Mesh, target: Floats | None = None, weights: Floats | float = 1.0, *, weight: float = 1.0
) -> VectorTerm:
    """Vertices near (V, 3) positions, by default where they are; weights (V,) if they differ.

    Residuals are distances in mean edges.
    """
    aim = mesh.vertices if target is None else target
    part = np.broadcast_to(np.sqrt(weights), mesh.n_vertices) / mean_edge(mesh)
    return VectorTerm(
        name="closeness",
        scalar=csr_array(diags_array(part)),
        target=part[:, None] * aim,
        weight=weight,
    )


def polyline_triples(mesh: Mesh) -> Ints:
    """(m, 3) consecutive vertices of the polylines of a mesh, the middle one second.

    Polylines run straight through inner vertices of even valence (edge k to edge k + n/2) and
    along the boundary through its vertices, but not round the boundary's corners (valence 2).
    """
    triples = [np.zeros((0, 3), dtype=np.int64)]
    inner = ~mesh.boundary_vertex & (mesh.valences > 0) & (mesh.valences % 2 == 0)
    for valence in np.unique(mesh.valences[inner]).tolist():
        ids = np.flatnonzero(inner & (mesh.valences == valence))
        edges = mesh.star_edges[mesh.star_start[ids, None] + np.arange(valence)]
        around = _other_end(mesh, edges, ids[:, None])
        half = valence // 2
        triples += [np.stack([around[:, k], ids, around[:, k + half]], axis=1) for k in range(half)]
    rim = np.flatnonzero(mesh.boundary_vertex & (mesh.valences > 2))
    first = _other_end(mesh, mesh.star_edges[mesh.star_start[rim]], rim)
    last = _other_end(mesh, mesh.star_edges[mesh.star_start[rim + 1] - 1], rim)
    triples.append(np.stack([first, rim, last], axis=1))
    return np.concatenate(triples)


def _other_end(mesh: Mesh, edges: Ints, vertices: Ints) -> Ints:
    ends = mesh.edges[edges]
    other: Ints = np.where(ends[..., 0] == vertices, ends[..., 1], ends[..., 0])
    return other


def second_differences(mesh: Mesh, features: Ints | None = None) -> csr_array:
    """(m, V) rows x_0 - 2 x_1 + x_2 for the triples of all polylines.

    Parameters
    ----------
    features : ids of edges; polylines may turn where they meet one, not where they run along it
    """
    return _differences(_triples(mesh, features), mesh.n_vertices)


def _triples(mesh: Mesh, features: Ints | None) -> Ints:
    triples = polyline_triples(mesh)
    if features is not None and len(features):
        triples = triples[_smooth_triples(mesh, triples, features)]
    return triples


def _differences(triples: Ints, columns: int) -> csr_array:
    rows = np.repeat(np.arange(len(triples)), 3)
    data = np.tile([1.0, -2.0, 1.0], len(triples))
    return csr_array((data, (rows, triples.ravel())), shape=(len(triples), columns))


def _smooth_triples(mesh: Mesh, triples: Ints, features: Ints) -> NDArray[np.bool_]:
    """(m,) triples that meet no feature at their middle, or run along one."""
    ends = np.sort(mesh.edges[np.asarray(features, dtype=np.int64)], axis=1)
    keys = ends[:, 0] * mesh.n_vertices + ends[:, 1]
    on = np.zeros(mesh.n_vertices, dtype=bool)
    on[ends.ravel()] = True

    def feature(a: Ints, b: Ints) -> NDArray[np.bool_]:
        return np.isin(np.minimum(a, b) * mesh.n_vertices + np.maximum(a, b), keys)

    along = feature(triples[:, 0], triples[:, 1]) & feature(triples[:, 1], triples[:, 2])
    smooth: NDArray[np.bool_] = along | ~on[triples[:, 1]]
    return smooth


def laplacian(mesh: Mesh) -> csr_array:
    """(V, V) vertex minus mean of its neighbours; zero rows at the boundary."""
    a, b = mesh.edges.T
    size = (mesh.n_vertices, mesh.n_vertices)
    graph = coo_array((np.ones(2 * len(a)), (np.r_[a, b], np.r_[b, a])), shape=size).tocsr()
    inner = (~mesh.boundary_vertex & (mesh.valences > 0)).astype(np.float64)
    return csr_array(diags_array(inner) - diags_array(inner / np.maximum(mesh.valences, 1)) @ graph)


@checked
def fairness(
    mesh: Mesh, *, weight: float = 1.0, smoothing: float = 1.0, features: Ints | None = None
) -> VectorTerm:
    """Polylines without bends: second differences, in mean edges.

    Inner vertices of odd valence, where polylines end, are drawn to the mean of their neighbours:
    so hexagonal meshes are fair as well.

    Parameters
    ----------
    smoothing : 1 aims at straight polylines, 0 at bends as they are (so that the movement is
        smooth, not the mesh), values between at bends that are smaller by this part
    features : ids of edges across which polylines may turn

    Source: Liu, Pottmann, Wallner, Yang, Wang 2006, section 3.
    """
    return _fair(mesh, _bends(mesh, features)[0], "fairness", weight, smoothing)


def _bends(mesh: Mesh, features: Ints | None) -> tuple[csr_array, Ints]:
    """Rows of `fairness`, and (m,) the vertices in their middle."""
    triples = _triples(mesh, features)
    odd = ~mesh.boundary_vertex & (mesh.valences % 2 == 1)
    if features is not None:
        odd[mesh.edges[np.asarray(features, dtype=np.int64)].ravel()] = False
    ends = np.flatnonzero(odd)
    lines = _differences(triples, mesh.n_vertices)
    rows = csr_array(vstack([lines, laplacian(mesh)[ends]], format="csr")) if len(ends) else lines
    return rows, np.concatenate([triples[:, 1], ends])


@checked
def fair_movement(
    mesh: Mesh, across: float, along: float, *, features: Ints | None = None
) -> tuple[VectorTerm | LinearTerm, ...]:
    """The movement without bends: the rows of `fairness` with smoothing 0, split at the surface.

    Parameters
    ----------
    across : weight of bends of the movement along the vertex normals, which bend the surface
    along : weight of its bends along the surface, which only turn edges in it; not above `across`
    features : as in `fairness`
    """
    rows, middle = _bends(mesh, features)
    along = min(along, across)
    terms: list[VectorTerm | LinearTerm] = [_fair(mesh, rows, "fairness", along, 0.0)]
    if across > along:
        cells = coo_array(rows)
        normals = mesh.vertex_normals[middle]
        data = cells.data[:, None] * normals[cells.row] / mean_edge(mesh)
        columns = 3 * cells.col[:, None] + np.arange(3)
        matrix = csr_array(
            (data.ravel(), (np.repeat(cells.row, 3), columns.ravel())),
            shape=(rows.shape[0], 3 * mesh.n_vertices),
        )
        terms.append(
            LinearTerm(
                name="fairness across",
                matrix=matrix,
                target=np.asarray(matrix @ mesh.vertices.ravel()),
                weight=across - along,
            )
        )
    return tuple(terms)


@checked
def fair_rim(mesh: Mesh, weight: float, *, features: Ints | None = None) -> LinearTerm:
    """The boundary moved without bends across itself: three rows for each of its vertices.

    Second differences of the movement of boundary polylines, without their part along the
    boundary, along which vertices may glide. In mean edges; 0 at corners of the boundary.

    Parameters
    ----------
    features : as in `fairness`
    """
    triples = _triples(mesh, features)
    triples = triples[mesh.boundary_vertex[triples[:, 1]]]
    along = unit(mesh.vertices[triples[:, 2]] - mesh.vertices[triples[:, 0]])
    across = np.eye(3) - along[:, :, None] * along[:, None, :]
    second = np.array([1.0, -2.0, 1.0]) / mean_edge(mesh)
    data = second[:, None] * across[:, :, None]
    columns = np.broadcast_to(3 * triples[:, None, :, None] + np.arange(3), data.shape)
    count = 3 * len(triples)
    matrix = csr_array(
        (data.ravel(), columns.ravel(), np.arange(0, data.size + 1, 9)),
        shape=(count, 3 * mesh.n_vertices),
    )
    return LinearTerm(
        name="fair boundary",
        matrix=matrix,
        target=np.asarray(matrix @ mesh.vertices.ravel()),
        weight=weight,
    )


@checked
def laplacian_fairness(mesh: Mesh, *, weight: float = 1.0, smoothing: float = 1.0) -> VectorTerm:
    """Inner vertices at the mean of their neighbours, in mean edges; `smoothing` as in `fairness`.

    Also fair where polylines end: at vertices of odd valence, on hexagons and triangles.
    """
    return _fair(mesh, laplacian(mesh), "Laplacian fairness", weight, smoothing)


def edge_differences(mesh: Mesh) -> csr_array:
    """(E, V) rows x_end - x_start of the edges."""
    rows = np.repeat(np.arange(mesh.n_edges), 2)
    data = np.tile([-1.0, 1.0], mesh.n_edges)
    return csr_array((data, (rows, mesh.edges.ravel())), shape=(mesh.n_edges, mesh.n_vertices))


@checked
def strain(mesh: Mesh, *, weight: float = 1.0) -> VectorTerm:
    """Edge vectors as they are: keeps lengths and angles, allows shifts. In mean edges."""
    return _fair(mesh, edge_differences(mesh), "strain", weight, 0.0)


def _fair(mesh: Mesh, scalar: csr_array, name: str, weight: float, smoothing: float) -> VectorTerm:
    matrix = csr_array(scalar / mean_edge(mesh))
    return VectorTerm(
        name=name,
        scalar=matrix,
        target=(1.0 - smoothing) * np.asarray(matrix @ mesh.vertices),
        weight=weight,
    )

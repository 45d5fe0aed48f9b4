"""Exact axes of circular nets (reflected normals) and of conical nets (cones at vertices)."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

from ddgfab.arguments import checked
from ddgfab.mesh import Floats, Ints, Mesh, unit
from ddgfab.support.parallel import parallel_field
from ddgfab.tolerances import RELATIVE_DEGENERATE

BOUNDARY_WEIGHT = 1e-4
"""Weight of boundary vertices, which have no full cone, against the cones' axes."""

FLAT_STAR = 1e-6
"""Relative singular value below which the face normals of a star count as one."""


@checked
def reflected_axes(mesh: Mesh) -> Floats:
    """(V, 3) unit axes of a circular net: each edge's bisector plane reflects one end to the other.

    The first axis of each component is free on the sphere (two parameters); the one is taken
    whose axes are nearest to the vertex normals, in closed form. Independent of the path where
    all faces have circumcircles and an even number of sides and the mesh has no handles or holes
    with holonomy; elsewhere the edges off the spanning tree keep torsion (measure it).

    Source: vertex offsets, Pottmann, Liu, Wallner, Bobenko, Wang 2007, section 3; mathematics.md
    2.7.
    """
    axes = np.zeros((mesh.n_vertices, 3))
    moves, parts = reflections(mesh)
    for order in parts:
        first = unit(np.einsum("vij,vi->j", moves[order], mesh.vertex_normals[order]))
        axes[order] = moves[order] @ first
    return axes


def smoothest_normals(mesh: Mesh) -> Floats:
    """(V, 3) unit normals by reflection (`reflected_axes`) whose curvatures vary least.

    Normals by reflection have n_j - n_i = c e along every edge e, with a curvature c. Of their
    two-parameter family the member is taken whose c differ least between edges that follow each
    other on a line of the net: others alternate from vertex to vertex about it. On nets in a
    sphere, a cylinder of revolution or a plane it is the normal of that surface, exactly.
    """
    normals = np.zeros((mesh.n_vertices, 3))
    moves, parts = reflections(mesh)
    e = mesh.edge_vectors / (mesh.edge_lengths**2)[:, None]
    curvature = -2.0 * np.einsum("ei,eij->ej", e, moves[mesh.edges[:, 0]])
    before, after, at = _successive_edges(mesh)
    change = curvature[before] - curvature[after]
    for order in parts:
        own = change[np.isin(at, order)]
        values, columns = np.linalg.eigh(own.T @ own)
        first = columns[:, 0]
        if not values[1] > RELATIVE_DEGENERATE * values[2]:  # too few edges to decide
            first = unit(np.einsum("vij,vi->j", moves[order], mesh.vertex_normals[order]))
        normals[order] = moves[order] @ first
        if np.einsum("vi,vi->", normals[order], mesh.vertex_normals[order]) < 0:
            normals[order] *= -1.0
    return normals


def _successive_edges(mesh: Mesh) -> tuple[Ints, Ints, Ints]:
    """Pairs of edges across vertices with four edges, three at the boundary, and the vertices."""
    found = []
    for valence, inside, pairs in ((4, True, ((0, 2), (1, 3))), (3, False, ((0, 2),))):
        ids = np.flatnonzero((mesh.valences == valence) & (mesh.boundary_vertex != inside))
        for i, j in pairs:
            star = mesh.star_start[ids]
            found.append((mesh.star_edges[star + i], mesh.star_edges[star + j], ids))
    before, after, at = (np.concatenate(part) for part in zip(*found, strict=True))
    return before, after, at


def reflections(mesh: Mesh) -> tuple[Floats, list[Ints]]:
    """(V, 3, 3) matrices that carry the axis of a component's first vertex to the others.

    They reflect along a spanning tree. With them come the vertices of each component.
    """
    count = mesh.n_vertices
    start, end = mesh.edges.T
    graph = coo_array((np.ones(mesh.n_edges), (start, end)), shape=(count, count)).tocsr()
    labels = connected_components(graph, directed=False)[1]
    moves = np.zeros((count, 3, 3))
    parts = []
    for root in np.unique(labels, return_index=True)[1]:
        if mesh.valences[root] == 0:
            continue
        order, before = breadth_first_order(graph, root, directed=False)
        moves[root] = np.eye(3)
        for vertex in order[1:]:
            parent = before[vertex]
            e = unit(mesh.vertices[vertex] - mesh.vertices[parent])
            moves[vertex] = moves[parent] - 2.0 * np.outer(e, e @ moves[parent])
        parts.append(order)
    return moves, parts


@checked
def cone_axes(mesh: Mesh) -> Floats:
    """(V, 3) unit axes of a conical net: those of the cones that the faces at a vertex touch.

    Source: Liu, Pottmann, Wallner, Yang, Wang 2006, section 4; mathematics.md 2.9, 10.6.
    """
    return unit(cone_field(mesh))


def cone_field(mesh: Mesh) -> Floats:
    """(V, 3) how the vertices of a conical net move when every face moves by 1 (see `cone_axes`).

    Moving every face by one distance gives the parallel mesh v' = v + d_v with <d_v, N_f> = 1 at
    all faces f of an interior vertex (face offset). Boundary vertices touch too few faces: there
    d is the nearest to the normals among the parallel meshes that continue the interior.
    """
    weights = np.where(mesh.boundary_vertex, BOUNDARY_WEIGHT, 1.0)
    field = parallel_field(mesh, _to_faces(mesh, np.zeros_like(mesh.vertices)), weights)
    # The terms of the boundary cost the interior a little; that is undone here.
    return field + parallel_field(mesh, _to_faces(mesh, field), weights)


def _to_faces(mesh: Mesh, field: Floats) -> Floats:
    """(V, 3) least change of a field after which <d_v, N_f> = 1 at all faces f of every vertex."""
    change = np.zeros_like(mesh.vertices)
    for valence in np.unique(mesh.valences[mesh.valences > 0]).tolist():
        ids = np.flatnonzero(mesh.valences == valence)
        faces = mesh.star_faces[mesh.star_start[ids, None] + np.arange(valence)]
        normals = np.where(faces[..., None] >= 0, mesh.face_normals[faces], 0.0)
        missing = np.where(faces >= 0, 1.0 - np.einsum("vkx,vx->vk", normals, field[ids]), 0.0)
        inverse = np.linalg.pinv(normals, rcond=FLAT_STAR)
        change[ids] = np.einsum("vxk,vk->vx", inverse, missing)
    return change

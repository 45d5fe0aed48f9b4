"""Measures on vertices: conical defect and planarity of stars."""

from __future__ import annotations

import numpy as np

from ddgfab.arguments import checked
from ddgfab.mesh import Floats, Ints, Mesh, unit

_QUAD = 4


def _star_corners(mesh: Mesh, vertices: Ints, valence: int) -> Ints:
    """(n, valence) corners round interior vertices of one valence, counterclockwise."""
    faces = mesh.star_faces[mesh.star_start[vertices, None] + np.arange(valence)]
    key = mesh.corners * mesh.n_faces + mesh.corner_face
    order = np.argsort(key)
    wanted = vertices[:, None] * mesh.n_faces + faces
    corners: Ints = order[np.searchsorted(key, wanted, sorter=order)]
    return corners


@checked
def conical_defect(mesh: Mesh) -> Floats:
    """How far the faces round each interior vertex are from touching a cone of revolution.

    Valence 4: |w0 + w2 - w1 - w3| of the face angles at the vertex. Valence 5 and more: greatest
    angle by which a unit face normal leaves the plane of least squares through all of them (they
    lie on a circle when the faces touch a cone). Three faces always touch one: 0. Boundary
    vertices: 0. Planar faces are assumed; check `planarity`.

    Returns
    -------
    (V,) [rad]

    Source: Liu, Pottmann, Wallner, Yang, Wang 2006, section 4; Wang, Wallner, Liu 2007, theorem
    on angle sums; mathematics.md 2.9.
    """
    result = np.zeros(mesh.n_vertices)
    inner = np.where(mesh.boundary_vertex, 0, mesh.valences)
    for valence in np.unique(inner[inner >= _QUAD]).tolist():
        ids = np.flatnonzero(inner == valence)
        corners = _star_corners(mesh, ids, valence)
        if valence == _QUAD:
            angle = mesh.corner_angles[corners]
            result[ids] = np.abs(angle[:, 0] + angle[:, 2] - angle[:, 1] - angle[:, 3])
        else:
            normals = mesh.face_normals[mesh.corner_face[corners]]
            centered = normals - normals.mean(axis=1, keepdims=True)
            axis = np.linalg.svd(centered, full_matrices=False)[2][:, -1]
            height = np.abs(np.einsum("nkj,nj->nk", centered, axis)).max(axis=1)
            result[ids] = np.arcsin(np.minimum(height, 1.0))
    return result


@checked
def star_defect(mesh: Mesh) -> Floats:
    """How far each vertex and its neighbours are from lying in one plane.

    Greatest angle between an edge and the plane through the vertex that fits the unit edges best
    (least squares); 0 for valence 2. All zero: an A-net, whose edges follow asymptotic lines.

    Returns
    -------
    (V,) [rad]

    Source: mathematics.md 3.1; Bobenko, Suris, Discrete Differential Geometry, 2.4.
    """
    result = np.zeros(mesh.n_vertices)
    for valence in np.unique(mesh.valences[mesh.valences > 2]).tolist():
        ids = np.flatnonzero(mesh.valences == valence)
        edges = mesh.edges[mesh.star_edges[mesh.star_start[ids, None] + np.arange(valence)]]
        other = np.where(edges[..., 0] == ids[:, None], edges[..., 1], edges[..., 0])
        ways = unit(mesh.vertices[other] - mesh.vertices[ids, None])
        normal = np.linalg.svd(ways, full_matrices=False)[2][:, -1]
        sine = np.abs(np.einsum("nkj,nj->nk", ways, normal)).max(axis=1)
        result[ids] = np.arcsin(np.minimum(sine, 1.0))
    return result


@checked
def isothermic_defect(mesh: Mesh) -> Floats:
    """How far the cross-ratios round each interior vertex are from labels of a grid's lines.

    |log(q_0 q_1 q_2 q_3)| with q_k = (|e_k| |opposite|) / (|e_(k+1)| |opposite|) of the quads
    between successive edges e_k of a vertex with four of them. On a circular net |q| is the
    absolute cross-ratio, and all zero means |q| = |alpha_i / beta_j| in each grid: an isothermic
    net. 0 at other vertices, and where a face at the vertex is not a quad.

    Returns
    -------
    (V,)

    Source: Bobenko, Pinkall 1996; mathematics.md 6.1.
    """
    result = np.zeros(mesh.n_vertices)
    inner = np.flatnonzero(~mesh.boundary_vertex & (mesh.valences == _QUAD))
    if not len(inner):
        return result
    corners = _star_corners(mesh, inner, _QUAD)
    quads = (mesh.face_sizes[mesh.corner_face[corners]] == _QUAD).all(axis=1)
    inner, corners = inner[quads], corners[quads]
    length = np.log(mesh.edge_lengths[mesh.corner_edge])
    follow = mesh.corner_next
    one, two = follow[corners], follow[follow[corners]]
    last = follow[two]
    # Corner edges of a quad from the vertex: own, next, opposite to own, opposite to next.
    ratio = length[corners] + length[two] - length[one] - length[last]
    result[inner] = np.abs(ratio.sum(axis=1))
    return result

"""Faces that lie on one another, and vertices on the edges of faces that they are no corner of."""

from __future__ import annotations

import numpy as np

from ddgfab.io.raw import RawMesh
from ddgfab.io.weld import noise
from ddgfab.mesh import Floats, Ints, Mesh, extent, unit

FOLDED = 1e-6
"""Faces lie on one another where the cosine of their angle differs from 1 by less (0.08 deg)."""

CHUNK = 2_000_000
"""Pairs of a vertex and an edge that are compared at once."""


def check_folded(raw: RawMesh, mesh: Mesh) -> None:
    """No two neighbours that lie on one another, as a quad and the triangles it was cut into.

    Raises
    ------
    MeshError
        Names the faces with their lines.
    """
    inner = np.flatnonzero(mesh.edge_faces[:, 1] >= 0)
    faces = mesh.edge_faces[inner]
    ends = mesh.vertices[mesh.edges[inner]]
    sides = np.stack([_inward(mesh, ends, faces[:, i]) for i in (0, 1)])
    normals = unit(mesh.vector_areas)
    same = np.einsum("ij,ij->i", sides[0], sides[1]) > 1 - FOLDED
    same &= np.einsum("ij,ij->i", normals[faces[:, 0]], normals[faces[:, 1]]) < -1 + FOLDED
    if same.any():
        a, b = sorted(faces[np.flatnonzero(same)[0]].tolist())
        raise raw.fail(_on_one_another(raw, a, b), face=b)


def _inward(mesh: Mesh, ends: Floats, faces: Ints) -> Floats:
    """Unit vectors across an edge into a face."""
    along = unit(ends[:, 1] - ends[:, 0])
    way = mesh.face_centres[faces] - ends[:, 0]
    return unit(way - np.einsum("ij,ij->i", way, along)[:, None] * along)


def _on_one_another(raw: RawMesh, a: int, b: int) -> str:
    return (
        f"faces {a}{raw.line_of(a)} and {b}{raw.line_of(b)} lie on one another: the mesh holds "
        "a surface twice (a face and its parts?)\nremove one of them and export again"
    )


def overlapping(mesh: Mesh, corner: int, faces: Ints) -> str:
    """For the message of an edge with three faces or more: which of them lie on one another."""
    ends = mesh.vertices[mesh.edges[mesh.corner_edge[corner]]][None]
    ways = _inward(mesh, np.repeat(ends, len(faces), axis=0), faces)
    alike = np.triu(ways @ ways.T > 1 - FOLDED, 1)
    if not alike.any():
        return ""
    i, j = np.argwhere(alike)[0]
    return f"\nfaces {faces[i]} and {faces[j]} lie on one another: remove one of them"


def check_junctions(raw: RawMesh, mesh: Mesh) -> None:
    """No vertex of the rim on the edge of a face of the same piece that it is no corner of.

    Raises
    ------
    MeshError
        Names the vertex, the edge and the face.
    """
    rim = np.flatnonzero(mesh.boundary_edge)
    if not len(rim):
        return
    ends = mesh.edges[rim]
    vertices = np.unique(ends)
    tolerance = max(noise(raw), 1e-9 * extent(mesh.vertices))
    piece = np.full(mesh.n_vertices, -1)
    piece[mesh.corners] = mesh.components[mesh.corner_face]
    points = mesh.vertices
    axis = int(np.ptp(points[vertices], axis=0).argmax())
    order = vertices[np.argsort(points[vertices, axis], kind="stable")]
    ranked = points[order, axis]
    low, high = np.sort(points[ends, axis], axis=1).T
    first = np.searchsorted(ranked, low - tolerance)
    last = np.searchsorted(ranked, high + tolerance, side="right")
    for part in np.array_split(np.arange(len(rim)), (last - first).sum() // CHUNK + 1):
        count = last[part] - first[part]
        edge = np.repeat(part, count)
        offset = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        vertex = order[first[edge] + offset]
        a, b = points[ends[edge, 0]], points[ends[edge, 1]]
        way = b - a
        share = np.einsum("ij,ij->i", points[vertex] - a, way) / np.einsum("ij,ij->i", way, way)
        gap = np.linalg.norm(points[vertex] - a - share[:, None] * way, axis=1)
        hit = (gap <= tolerance) & (share > 1e-6) & (share < 1 - 1e-6)
        hit &= (vertex != ends[edge, 0]) & (vertex != ends[edge, 1])
        hit &= piece[vertex] == piece[ends[edge, 0]]
        if hit.any():
            at = np.flatnonzero(hit)[0]
            face = int(mesh.edge_faces[rim[edge[at]], 0])
            start, end = sorted(ends[edge[at]].tolist())
            raise raw.fail(
                f"vertex {vertex[at]} lies on edge {start}-{end} of face {face}{raw.line_of(face)} "
                "but is no corner of it (vertices counted from 0)\n"
                f"give face {face} a corner there, or split the face",
                face=face,
            )

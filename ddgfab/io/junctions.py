"""Faces that lie on one another, and vertices on the edges of faces of which they are no corner."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ddgfab.io.near import DIRECTIONS
from ddgfab.io.raw import RawMesh
from ddgfab.io.weld import noise
from ddgfab.mesh import Floats, Ints, Mesh, extent, unit

FOLDED = 1e-6
"""Faces lie on one another where the cosine of their angle differs from 1 by less (0.08 deg)."""

CHUNK = 2_000_000
"""Pairs of a vertex and an edge that are compared at once."""

COMPARED = 20
"""Of the faces at an edge, so many are searched for one that is part of another."""

PAIRS = 100_000_000
"""With more of them than this, they are not compared at all."""


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
    pairs, count = np.unique(np.sort(faces, axis=1), axis=0, return_counts=True)
    for a, b in pairs[count > 1].tolist():  # not flat, but with common corners only
        if _part_of(mesh, a, b):
            raise raw.fail(_on_one_another(raw, a, b), face=b)


def _part_of(mesh: Mesh, a: int, b: int) -> bool:
    """Whether all corners of one of two faces are corners of the other."""
    one, other = ({*mesh.corners[slice(*mesh.face_start[i : i + 2])].tolist()} for i in (a, b))
    return one <= other or other <= one


def _inward(mesh: Mesh, ends: Floats, faces: Ints) -> Floats:
    """Unit vectors across an edge into a face."""
    along = unit(ends[:, 1] - ends[:, 0])
    way = mesh.face_centers[faces] - ends[:, 0]
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
    side = np.cross(unit(ends[0, 1] - ends[0, 0]), ways[0])
    angle = np.arctan2(ways @ side, ways @ ways[0])
    order = np.argsort(angle, kind="stable")
    gap = np.diff(angle[order], append=angle[order[0]] + 2 * np.pi)
    alike = np.flatnonzero(gap < np.arccos(1 - FOLDED))
    some = range(min(len(faces), COMPARED))
    parts = [(i, j) for j in some for i in range(j) if _part_of(mesh, faces[i], faces[j])]
    if not len(alike) and not parts:
        return ""
    if len(alike):
        parts = [(order[alike[0]], order[(alike[0] + 1) % len(order)])]
    i, j = sorted(parts[0])
    return f"\nfaces {faces[i]} and {faces[j]} lie on one another: remove one of them"


def check_junctions(raw: RawMesh, mesh: Mesh) -> str:
    """No vertex of the rim on the edge of a face of the same piece that it is not a corner of.

    Each edge is compared with the vertices beside it along the direction, of 13, that leaves the
    fewest, so that the work is almost linear.

    Returns
    -------
    A note where long edges in many directions leave so many pairs that they are not compared,
    otherwise an empty text.

    Raises
    ------
    MeshError
        Names the vertex, the edge and the face.
    """
    rim = np.flatnonzero(mesh.boundary_edge)
    if not len(rim):
        return ""
    ends = mesh.edges[rim]
    vertices = np.unique(ends)
    tolerance = max(noise(raw), 1e-9 * extent(mesh.vertices))
    piece = np.full(mesh.n_vertices, -1)
    piece[mesh.corners] = mesh.components[mesh.corner_face]
    beside = _Beside.of(mesh.vertices, vertices, ends, tolerance)
    total = int((beside.last - beside.first).sum())
    if total > PAIRS:
        return (
            f"vertices on edges that they do not belong to were not looked for: {len(rim)} edges "
            f"of the rim leave {total} pairs to compare; the limit is {PAIRS}"
        )
    points = mesh.vertices
    for edge, vertex in beside.pairs():
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
                "but is not a corner of it (vertices counted from 0)\n"
                f"give face {face} a corner there, or split the face",
                face=face,
            )
    return ""


@dataclass(frozen=True, eq=False)
class _Beside:
    """For each edge the vertices beside it along the direction that leaves the fewest.

    Attributes
    ----------
    orders : (13, n) the vertices, sorted along each direction
    best : (E,) direction of each edge
    first, last : (E,) where its vertices begin and end in that order
    """

    orders: Ints
    best: Ints
    first: Ints
    last: Ints

    @staticmethod
    def of(points: Floats, vertices: Ints, ends: Ints, tolerance: float) -> _Beside:
        ways = unit(DIRECTIONS)
        orders = np.empty((len(ways), len(vertices)), dtype=np.int64)
        best, first = np.zeros((2, len(ends)), dtype=np.int64)
        last = np.full(len(ends), len(vertices), dtype=np.int64)
        for k, way in enumerate(ways):
            along = points @ way
            order = np.argsort(along[vertices], kind="stable")
            orders[k] = vertices[order]
            ranked = along[orders[k]]
            low, high = np.sort(along[ends], axis=1).T
            start = np.searchsorted(ranked, low - tolerance)
            stop = np.searchsorted(ranked, high + tolerance, side="right")
            fewer = stop - start < last - first
            best[fewer], first[fewer], last[fewer] = k, start[fewer], stop[fewer]
        return _Beside(orders, best, first, last)

    def pairs(self) -> Iterator[tuple[Ints, Ints]]:
        """Edges and vertices to compare, some `CHUNK` pairs at a time."""
        every = np.cumsum(self.last - self.first)
        cuts = np.searchsorted(every, np.arange(CHUNK, int(every[-1]), CHUNK), side="right")
        for part in np.split(np.arange(len(self.best)), np.unique(cuts)):
            count = self.last[part] - self.first[part]
            edge = np.repeat(part, count)
            offset = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
            yield edge, self.orders[self.best[edge], self.first[edge] + offset]

"""A polygon mesh from its corners: manifold or not, edges, stars of vertices, boundary loops."""

from __future__ import annotations

from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from ddgfab.errors import MeshError

Ints = NDArray[np.int64]
_T = TypeVar("_T", bound=np.generic)


class MeshLike(Protocol):
    """What tables and checks need of a mesh; see `ddgfab.mesh.Mesh`."""

    @property
    def n_vertices(self) -> int:
        """Number of vertices."""

    @property
    def vertices(self) -> NDArray[np.float64]:
        """(V, 3) coordinates."""

    @property
    def corners(self) -> Ints:
        """(C,) vertex of each corner."""

    @property
    def corner_face(self) -> Ints:
        """(C,) face of each corner."""

    @property
    def corner_next(self) -> Ints:
        """(C,) the corner after each in its face."""

    @property
    def corner_previous(self) -> Ints:
        """(C,) the corner before each in its face."""

    @property
    def corner_edge(self) -> Ints:
        """(C,) edge that starts at each corner."""

    @property
    def corner_twin(self) -> Ints:
        """(C,) the opposite corner across the edge, or -1."""

    @property
    def split_vertices(self) -> Ints:
        """Vertices where several fans of faces meet."""


def frozen(array: NDArray[_T]) -> NDArray[_T]:
    """The array, read only from now on."""
    array.setflags(write=False)
    return array


def require_manifold(mesh: MeshLike) -> None:
    """Raise `MeshError` where a mesh is not an oriented manifold with finite coordinates."""
    bad = np.flatnonzero(~np.isfinite(mesh.vertices).all(axis=1))
    if len(bad):
        raise MeshError(f"vertex {bad[0]} has a coordinate that is not finite")
    out = np.flatnonzero((mesh.corners < 0) | (mesh.corners >= mesh.n_vertices))
    if len(out):
        raise MeshError(
            f"face {mesh.corner_face[out[0]]} names vertex {mesh.corners[out[0]]}; "
            f"the mesh has {mesh.n_vertices}"
        )
    ends = np.stack([mesh.corners, mesh.corners[mesh.corner_next]])
    loop = np.flatnonzero(ends[0] == ends[1])
    if len(loop):
        raise MeshError(
            f"face {mesh.corner_face[loop[0]]} repeats vertex {ends[0, loop[0]]} in a row"
        )
    key = ends[0] * mesh.n_vertices + ends[1]
    order = np.argsort(key, kind="stable")
    twice = np.flatnonzero(key[order][1:] == key[order][:-1])
    if len(twice):
        a, b = order[twice[0]], order[twice[0] + 1]
        raise MeshError(
            f"faces {mesh.corner_face[a]} and {mesh.corner_face[b]} run the same way along "
            f"edge {ends[0, a]}-{ends[1, a]}: three faces at it, or opposite orientation"
        )
    if len(mesh.split_vertices):
        raise MeshError(
            f"vertex {mesh.split_vertices[0]} is not manifold: several sheets meet only there"
        )


def edge_tables(
    n_vertices: int, corners: Ints, corner_next: Ints, corner_face: Ints
) -> tuple[Ints, Ints, Ints, Ints]:
    """Edges, edge of each corner, left and right face of each edge, twin of each corner.

    Edges (E, 2) run as in their left face, in the order of their first appearance; the right face
    of a boundary edge and the twin (C,) of its corner are -1.
    """
    start, end = corners, corners[corner_next]
    key = np.minimum(start, end) * n_vertices + np.maximum(start, end)
    _, first, inverse = np.unique(key, return_index=True, return_inverse=True)
    order = np.argsort(first, kind="stable")  # edges in order of first appearance
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    corner_edge, first = rank[inverse], first[order]
    edges = np.stack([start[first], end[first]], axis=1)
    second = np.full(len(edges), -1)
    others = np.setdiff1d(np.arange(len(start)), first, assume_unique=True)
    second[corner_edge[others]] = others
    faces = np.stack([corner_face[first], np.where(second < 0, -1, corner_face[second])], axis=1)
    twin = np.full(len(start), -1)
    twin[first] = second
    twin[others] = first[corner_edge[others]]
    return frozen(edges), frozen(corner_edge), frozen(faces), frozen(twin)


def loops_of(edges: Ints) -> tuple[Ints, ...]:
    """Closed loops of vertex ids along boundary edges (E, 2)."""
    start, end = edges.T
    follow = dict(zip(start.tolist(), end.tolist(), strict=True))
    loops = []
    while follow:
        first, vertex = next(iter(follow.items()))
        loop = [first]
        del follow[first]
        while vertex != first and vertex in follow:
            loop.append(vertex)
            vertex = follow.pop(vertex)
        loops.append(np.array(loop))
    return tuple(loops)


def star_tables(mesh: MeshLike) -> tuple[Ints, Ints, Ints]:
    """Start of each vertex' star; its edges counterclockwise; the face after each edge, or -1."""
    twin, previous = mesh.corner_twin, mesh.corner_previous
    turn = twin[previous]  # the next outgoing half-edge counterclockwise, -1 at the boundary
    # One half-edge to begin with: at a boundary vertex the one without a face on its right.
    begin = np.full(mesh.n_vertices, -1)
    begin[mesh.corners[::-1]] = np.arange(len(mesh.corners))[::-1]
    rim = np.flatnonzero(twin < 0)
    begin[mesh.corners[rim]] = rim
    vertex, step, edge, face = [], [], [], []
    live = np.flatnonzero(begin >= 0)
    corner = begin[live]
    for count in range(len(mesh.corners) + 1):
        if not len(live):
            break
        vertex.append(live)
        step.append(np.full(len(live), count))
        edge.append(mesh.corner_edge[corner])
        face.append(mesh.corner_face[corner])
        following = turn[corner]
        end = following < 0  # the last edge of a boundary star has no face after it
        vertex.append(live[end])
        step.append(np.full(int(end.sum()), count + 1))
        edge.append(mesh.corner_edge[previous[corner[end]]])
        face.append(np.full(int(end.sum()), -1))
        go = ~end & (following != begin[live])
        live, corner = live[go], following[go]
    owner = np.concatenate(vertex)
    order = np.lexsort((np.concatenate(step), owner))
    counts = np.bincount(owner, minlength=mesh.n_vertices)
    return (
        frozen(np.concatenate([[0], np.cumsum(counts)])),
        frozen(np.concatenate(edge)[order]),
        frozen(np.concatenate(face)[order]),
    )

"""Tables of a polygon mesh from its corners: edges, stars of vertices, loops of the boundary."""

from __future__ import annotations

from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int64]
_T = TypeVar("_T", bound=np.generic)


class Corners(Protocol):
    """What the stars are made of; see `ddgfab.mesh.Mesh`."""

    @property
    def n_vertices(self) -> int:
        """Number of vertices."""

    @property
    def corners(self) -> Ints:
        """(C,) vertex of each corner."""

    @property
    def corner_face(self) -> Ints:
        """(C,) face of each corner."""

    @property
    def corner_previous(self) -> Ints:
        """(C,) the corner before each in its face."""

    @property
    def corner_edge(self) -> Ints:
        """(C,) edge that starts at each corner."""

    @property
    def corner_twin(self) -> Ints:
        """(C,) the opposite corner across the edge, or -1."""


def frozen(array: NDArray[_T]) -> NDArray[_T]:
    """The array, read only from now on."""
    array.setflags(write=False)
    return array


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


def star_tables(mesh: Corners) -> tuple[Ints, Ints, Ints]:
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

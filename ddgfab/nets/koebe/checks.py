"""Whether faces are those of a polyhedron: a sphere whose graph is 3-connected (Steinitz)."""

from __future__ import annotations

import numpy as np

from ddgfab.errors import MeshError
from ddgfab.mesh import Ints, Mesh

SHOWN = 3
"""How many elements of a kind an error names."""

LEAST = 4
"""Vertices, and faces, of the smallest polyhedron, the tetrahedron."""


def check_polyhedron(mesh: Mesh) -> None:
    """Raise unless the faces are those of a convex polyhedron, combinatorially.

    Only the faces count; vertices may lie anywhere. By Steinitz' theorem the condition is a
    connected closed surface of Euler number 2 with a 3-connected graph. On a sphere the latter
    means that no face visits a vertex twice and that two faces share nothing, one vertex or one
    edge. Takes a time proportional to the number of edges (`_shared_twice`).

    Raises
    ------
    MeshError
        Boundary (names an edge), several components (names a face of each), another Euler number,
        a cut vertex, or a cut pair, which it names with the two faces that meet there twice.

    Source: Steinitz 1922; Mohar, Thomassen, Graphs on Surfaces, 2.3 and 5.5; mathematics.md 7.1.
    """
    open_edges = np.flatnonzero(mesh.boundary_edge)
    if len(open_edges):
        i, j = mesh.edges[open_edges[0]]
        raise MeshError(
            f"not a sphere: {len(open_edges)} edges have one face only (the first is "
            f"{i}-{j}, of face {mesh.edge_faces[open_edges[0], 0]})\n"
            "a Koebe polyhedron needs a closed surface: fill its holes with faces"
        )
    pieces = mesh.components.max() + 1
    if pieces > 1:
        firsts = np.unique(mesh.components, return_index=True)[1][: SHOWN + 1]
        raise MeshError(
            f"disconnected: {pieces} separate surfaces (faces {', '.join(map(str, firsts))} lie "
            "on different ones)\ntake one surface at a time"
        )
    used = int((mesh.valences > 0).sum())
    if used < mesh.n_vertices:
        raise MeshError(
            f"vertex {int((mesh.valences == 0).argmax())} belongs to no face; remove it"
        )
    euler = used - mesh.n_edges + mesh.n_faces
    if euler != 2:
        raise MeshError(
            f"not a sphere: V - E + F = {used} - {mesh.n_edges} + {mesh.n_faces} = {euler}, "
            f"2 needed (it has {(2 - euler) // 2} handles)"
        )
    _check_connectivity(mesh)


def _check_connectivity(mesh: Mesh) -> None:
    vertex, face = mesh.corners, mesh.corner_face
    key = np.sort(face * mesh.n_vertices + vertex)
    twice = np.flatnonzero(key[1:] == key[:-1])
    if len(twice):
        f, v = divmod(int(key[twice[0]]), mesh.n_vertices)
        raise MeshError(f"not 3-connected: vertex {v} is a cut vertex (face {f} visits it twice)")
    if min(mesh.n_vertices, mesh.n_faces) < LEAST:
        raise MeshError(
            f"a polyhedron has {LEAST} vertices and faces or more; this has {mesh.n_vertices} "
            f"and {mesh.n_faces}"
        )
    shared = _shared_twice(mesh)
    if not len(shared):
        return
    (v, w, f, g), pairs = shared[0].tolist(), len(np.unique(shared[:, :2], axis=0))
    more = f"; {pairs} such pairs" if pairs > 1 else ""
    raise MeshError(
        f"not 3-connected: vertices {v} and {w} are a cut pair (faces {f} and {g} meet at both, "
        f"but not along one edge between them{more})\n"
        "a convex polyhedron cannot have that: add edges or merge faces there"
    )


def _shared_twice(mesh: Mesh) -> Ints:
    """(K, 4) v, w, f, g: vertices v < w of two faces f < g without a common edge v-w of f and g.

    These are the 4-cycles of the graph of incidences (vertices and faces, joined by corners) that
    do not go round one edge. All 4-cycles are listed from their node of greatest degree, which in
    a planar graph takes a number of steps proportional to its edges (Chiba, Nishizeki 1985).
    """
    count = mesh.n_vertices + mesh.n_faces
    one, two = mesh.corners, mesh.n_vertices + mesh.corner_face
    tail, head = np.concatenate([one, two]), np.concatenate([two, one])
    degree = np.bincount(tail, minlength=count)
    rank = np.empty(count, dtype=np.int64)
    rank[np.argsort(-degree, kind="stable")] = np.arange(count)
    order = np.argsort(tail, kind="stable")
    tail, head = tail[order], head[order]
    begin = np.concatenate([[0], np.cumsum(degree)])
    down = np.flatnonzero(rank[tail] < rank[head])
    top, middle = tail[down], head[down]
    each = degree[middle]
    path = np.repeat(np.arange(len(top)), each)
    within = np.arange(len(path)) - np.repeat(np.cumsum(each) - each, each)
    bottom = head[begin[middle[path]] + within]
    keep = rank[bottom] > rank[top[path]]
    top, middle, bottom = top[path[keep]], middle[path[keep]], bottom[keep]
    key = top * count + bottom
    order = np.lexsort((middle, key))
    key, top, middle, bottom = key[order], top[order], middle[order], bottom[order]
    runs = np.flatnonzero(np.concatenate([[True], key[1:] != key[:-1]]))
    sizes = np.diff(np.concatenate([runs, [len(key)]]))
    cycles = []
    for size in np.unique(sizes[sizes > 1]).tolist():
        at = runs[sizes == size]
        # In a run of many, neighbours and the two ends: one pair at least is off any single edge.
        for a, b in [(k, k + 1) for k in range(size - 1)] + ([(0, size - 1)] if size > 2 else []):
            cycles.append(np.stack([top[at], bottom[at], middle[at + a], middle[at + b]], axis=1))
    if not cycles:
        return np.empty((0, 4), dtype=np.int64)
    found = np.concatenate(cycles)
    swap = found[:, 0] >= mesh.n_vertices  # the pair at top and bottom are faces
    found[swap] = found[swap][:, [2, 3, 0, 1]]
    found[:, 2:] -= mesh.n_vertices
    found = np.concatenate([np.sort(found[:, :2], axis=1), np.sort(found[:, 2:], axis=1)], axis=1)
    known = np.concatenate([np.sort(mesh.edges, axis=1), np.sort(mesh.edge_faces, axis=1)], axis=1)
    both, labels = np.unique(np.concatenate([known, found]), axis=0, return_inverse=True)
    is_edge = np.zeros(len(both), dtype=bool)
    is_edge[labels[: len(known)]] = True
    return found[~is_edge[labels[len(known) :]]]

"""Quads from triangles: pairs that a program cut along a diagonal become one face again."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ddgfab.mesh import Floats, Ints, Mesh, unit

STRETCHED = 1e-3
"""Quads with a corner whose sine is smaller are never made."""

SEARCHED = 50
"""Triangles left over are brought together until so many have been looked at for each one."""


def paired_in_order(mesh: Mesh) -> bool:
    """Whether all faces are triangles, of which the first two, the next two, ... form quads.

    So programs write meshes of quads that they cut. One quad alone is not a pattern.
    """
    if mesh.n_faces < 4 or mesh.n_faces % 2 or (mesh.face_sizes != 3).any():
        return False
    pairs = np.arange(mesh.n_faces).reshape(-1, 2)
    edges, _ = _diagonals(mesh)
    found = {tuple(sorted(pair)) for pair in mesh.edge_faces[edges].tolist()}
    return all((a, b) in found for a, b in pairs.tolist())


def merge_pairs(mesh: Mesh) -> tuple[Mesh, int]:
    """The mesh with pairs of triangles merged into quads, and how many triangles are left.

    Where the triangles come in pairs, one after the other, these are taken. Otherwise diagonals
    are taken in the order of their worth (flat quads with right angles first), then chains of
    exchanges along neighbours bring leftover triangles together where they can.
    """
    edges, cost = _diagonals(mesh)
    faces = mesh.edge_faces[edges]
    if paired_in_order(mesh):
        chosen = edges[(faces.max(axis=1) == faces.min(axis=1) + 1) & (faces.min(axis=1) % 2 == 0)]
    else:
        chosen = edges[_matched(faces, cost, mesh.n_faces)]
    return _without(mesh, chosen), int((mesh.face_sizes == 3).sum()) - 2 * len(chosen)


def _diagonals(mesh: Mesh) -> tuple[Ints, Floats]:
    """Edges between two triangles that form a convex quad, and what each costs."""
    pair = mesh.edge_faces
    inner = pair[:, 1] >= 0
    triangles = inner & (mesh.face_sizes[pair] == 3).all(axis=1)
    edges = np.flatnonzero(triangles)
    corners = mesh.corners.reshape(-1)
    start = mesh.face_start[pair[edges]]  # (E, 2)
    triple = corners[start[..., None] + np.arange(3)]  # (E, 2, 3)
    ends = mesh.edges[edges]
    tips = triple.sum(axis=2) - ends.sum(axis=1)[:, None]
    loop = np.stack([ends[:, 0], tips[:, 0], ends[:, 1], tips[:, 1]], axis=1)
    sides = unit(np.roll(mesh.vertices[loop], -1, axis=1) - mesh.vertices[loop])
    before = -np.roll(sides, 1, axis=1)
    cosine = np.einsum("eij,eij->ei", sides, before)
    turn = np.cross(before, sides)
    normal = unit(turn.sum(axis=1))
    sine = -np.einsum("eij,ej->ei", turn, normal)
    convex = (np.abs(sine) > STRETCHED).all(axis=1) & (
        (sine > 0).all(axis=1) | (sine < 0).all(axis=1)
    )
    fold = 1 - np.einsum("ij,ij->i", *(unit(mesh.vector_areas)[pair[edges, i]] for i in (0, 1)))
    cost = np.abs(cosine).max(axis=1) + 4 * fold
    return edges[convex], cost[convex]


def _matched(faces: Ints, cost: Floats, count: int) -> NDArray[np.int64]:
    """Rows of pairs that share no face: cheapest first, then longer by alternating paths."""
    partner = np.full(count, -1)
    by = np.full(count, -1)
    for row in np.lexsort((np.arange(len(cost)), np.round(cost, 9))).tolist():
        a, b = faces[row].tolist()
        if partner[a] < 0 and partner[b] < 0:
            partner[a], partner[b] = b, a
            by[a] = by[b] = row
    around: list[list[tuple[int, int]]] = [[] for _ in range(count)]
    for row, (a, b) in enumerate(faces.tolist()):
        around[a].append((b, row))
        around[b].append((a, row))
    dead: set[int] = set()  # no free triangle is to be reached from these any more
    budget = SEARCHED * count
    for free in np.flatnonzero(partner < 0).tolist():
        if partner[free] < 0 and around[free] and budget > 0:
            budget -= _augment(free, around, partner, by, dead)
    return np.unique(by[by >= 0])


def _augment(
    free: int,
    around: list[list[tuple[int, int]]],
    partner: Ints,
    by: Ints,
    dead: set[int],
) -> int:
    """Exchange partners along the shortest alternating path to another free triangle.

    Returns how many triangles were looked at.
    """
    came: dict[int, tuple[int, int]] = {free: (-1, -1)}
    layer = [free]
    while layer:
        ahead = []
        for face in layer:
            for other, row in around[face]:
                mate = int(partner[other])
                if other in came or mate == face or other in dead:
                    continue
                if mate < 0:
                    came[other] = (face, row)
                    _exchange(other, free, came, partner, by)
                    return len(came)
                if mate not in came:
                    came[other] = (face, row)
                    came[mate] = (other, -1)
                    ahead.append(mate)
        layer = ahead
    dead.update(came)
    return len(came)


def _exchange(
    end: int, free: int, came: dict[int, tuple[int, int]], partner: Ints, by: Ints
) -> None:
    """Pair the triangles along a path from a free one to another free one the other way."""
    at = end
    while True:
        face, row = came[at]
        partner[at], partner[face] = face, at
        by[at] = by[face] = row
        if face == free:
            return
        at = came[face][0]


def _without(mesh: Mesh, edges: Ints) -> Mesh:
    """The mesh with these edges removed; a merged face stands where the first of the two stood."""
    faces = dict(enumerate(face.tolist() for face in mesh.faces))
    for edge in edges.tolist():
        a, b = sorted(mesh.edge_faces[edge].tolist())
        ends = set(mesh.edges[edge].tolist())
        loop = faces[a]
        tip = next(v for v in faces.pop(b) if v not in ends)
        at = next(i for i in range(3) if {loop[i], loop[(i + 1) % 3]} == ends)
        faces[a] = [*loop[: at + 1], tip, *loop[at + 1 :]]
    return Mesh.build(mesh.vertices, list(faces.values()))

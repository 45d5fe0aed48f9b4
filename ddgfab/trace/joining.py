"""Nets of neighboring patches as one mesh: borders kept together where their lines meet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.spatial import cKDTree

from ddgfab.arguments import checked
from ddgfab.errors import MeshError
from ddgfab.mesh import Floats, Ints, Mesh

_SAME: Final = 0.35
"""Vertices of both sides of a border nearer than this [spacings] become one."""


@dataclass(frozen=True, eq=False)
class JoinedMeshes:
    """Several meshes as one.

    Attributes
    ----------
    index : vertex of the whole for each vertex of each mesh
    borders : (patch, patch, vertices together, vertices of one side only, greatest movement)
    """

    mesh: Mesh
    index: tuple[Ints, ...]
    borders: tuple[tuple[int, int, int, int, float], ...]


@checked
def joined(
    meshes: Sequence[Mesh], shared: Sequence[Sequence[Ints]], spacing: float
) -> JoinedMeshes:
    """One mesh of several whose rims meet.

    Vertices of both sides that are near each other become one, at the place of the earlier mesh.
    Others become corners of the face on the other side. Faces are turned over where the side of
    the earlier mesh asks for it.

    Parameters
    ----------
    shared : [i][j] ids of the rim vertices of mesh i that lie on the rim of mesh j
    spacing : about the length of edges

    Raises
    ------
    MeshError
        Rims that do not fit; names the patch.
    """
    points = [mesh.vertices for mesh in meshes]
    start = np.concatenate([[0], np.cumsum([len(x) for x in points])])
    every = np.concatenate(points)
    name = np.arange(len(every))
    borders = []
    faces: list[list[int]] = []
    extra: list[tuple[int, int, int]] = []  # patch whose face gets a corner, vertex, from patch
    for j in range(len(meshes)):
        for i in range(j):
            one, two = start[i] + shared[i][j], start[j] + shared[j][i]
            if not len(one) or not len(two):
                continue
            pairs = _pairs(every[one], every[two], _SAME * spacing)
            moved = 0.0
            for a, b in pairs:
                root = int(name[one[a]])
                moved = max(moved, float(np.linalg.norm(every[root] - every[two[b]])))
                name[name == name[two[b]]] = root
            left = np.setdiff1d(np.arange(len(one)), pairs[:, 0])
            right = np.setdiff1d(np.arange(len(two)), pairs[:, 1])
            extra += [(j, int(one[k]), i) for k in left] + [(i, int(two[k]), j) for k in right]
            borders.append((i, j, len(pairs), len(left) + len(right), moved))
    for k, mesh in enumerate(meshes):
        rings = [[int(name[start[k] + v]) for v in face] for face in mesh.faces]
        guests = [int(name[v]) for patch, v, _ in extra if patch == k]
        rings = _with_corners(rings, guests, every, name[start[k] + np.arange(len(points[k]))])
        rings = [ring for ring in (_clean(ring) for ring in rings) if len(ring) > 2]
        faces += _turned(rings, faces)
    used = np.unique(np.concatenate([np.array(ring) for ring in faces]))
    place = np.full(len(every), -1)
    place[used] = np.arange(len(used))
    try:
        mesh = Mesh.build(every[used], [place[ring] for ring in faces])
    except MeshError as fault:
        raise MeshError(
            f"the nets of the patches do not fit along their borders: {fault}\nchange the "
            "spacing a little, or trace one face at a time: --face 0"
        ) from None
    index = tuple(place[name[start[k] : start[k + 1]]] for k in range(len(meshes)))
    return JoinedMeshes(mesh, index, tuple(borders))


def _pairs(one: Floats, two: Floats, reach: float) -> Ints:
    """(k, 2) points of both sides that are each other's nearest of those left, within `reach`."""
    i, j = np.arange(len(one)), np.arange(len(two))
    found = [np.zeros((0, 2), dtype=np.int64)]
    while len(i) and len(j):
        far, there = cKDTree(two[j]).query(one[i])
        back = cKDTree(one[i]).query(two[j])[1]
        keep = np.flatnonzero((far < reach) & (back[there] == np.arange(len(i))))
        if not len(keep):
            break
        found.append(np.stack([i[keep], j[there[keep]]], axis=1))
        i, j = np.delete(i, keep), np.delete(j, there[keep])
    return np.concatenate(found)


def _with_corners(
    rings: list[list[int]], guests: list[int], points: Floats, own: Ints
) -> list[list[int]]:
    """Faces with vertices of the other side as corners of the rim edges that they lie on."""
    guests = [v for v in dict.fromkeys(guests) if v not in set(own.tolist())]
    if not guests:
        return rings
    directed = {(a, b) for ring in rings for a, b in _sides(ring)}
    rim = [pair for pair in sorted(directed) if pair[::-1] not in directed]
    a, b = points[[pair[0] for pair in rim]], points[[pair[1] for pair in rim]]
    found: dict[tuple[int, int], list[tuple[float, int]]] = {}
    for v in guests:
        way = b - a
        part = np.einsum("nx,nx->n", points[v] - a, way) / np.einsum("nx,nx->n", way, way)
        part = np.clip(part, 0, 1)
        k = int(np.linalg.norm(a + part[:, None] * way - points[v], axis=1).argmin())
        found.setdefault(rim[k], []).append((float(part[k]), v))
    out = []
    for ring in rings:
        row: list[int] = []
        for side in _sides(ring):
            row += [side[0], *(v for _, v in sorted(found.get(side, [])))]
        out.append(row)
    return out


def _sides(ring: list[int]) -> list[tuple[int, int]]:
    return list(zip(ring, ring[1:] + ring[:1], strict=True))


def _clean(ring: list[int]) -> list[int]:
    return [v for k, v in enumerate(ring) if v != ring[k - 1]]


def _turned(rings: list[list[int]], before: list[list[int]]) -> list[list[int]]:
    """Faces turned over where most of their common edges run the same way as those before."""
    there = {side for ring in before for side in _sides(ring)}
    sides = [side for ring in rings for side in _sides(ring)]
    same = sum(side in there for side in sides)
    against = sum(side[::-1] in there for side in sides)
    return [ring[::-1] for ring in rings] if same > against else rings

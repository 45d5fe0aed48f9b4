"""Cells of a planar map: half-edges sorted round their nodes, faces on their left."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ddgfab.mesh import Floats, Ints

Flags = NDArray[np.bool_]


def cells(
    uv: Floats, edges: Ints, towards: Floats, chords: Floats, rim: Flags
) -> tuple[list[Ints], Floats]:
    """Faces of a planar map and their signed areas, without those on the right of the rim.

    Edges that end in the open are left out.

    Parameters
    ----------
    uv : (n, 2) nodes
    edges : (e, 2) their ids
    towards : (e, 2, 2) a point of each edge near its first, and near its last node: its direction
    chords : (e,) integrals of (u dv - v du) / 2 along the edges
    rim : (e,) edges with the surface on their left, and the outside or a hole on their right
    """
    alive = np.ones(len(edges), dtype=bool)
    while True:
        degree = np.bincount(edges[alive].ravel(), minlength=len(uv))
        dangling = alive & (degree[edges] == 1).any(axis=1)
        if not dangling.any():
            break
        alive &= ~dangling
    edges, towards, chords, rim = edges[alive], towards[alive], chords[alive], rim[alive]
    outside = np.concatenate([np.zeros(len(edges), dtype=bool), rim])
    tail = np.concatenate([edges[:, 0], edges[:, 1]])
    head = np.concatenate([edges[:, 1], edges[:, 0]])
    way = np.concatenate([towards[:, 0], towards[:, 1]]) - uv[tail]
    area = np.concatenate([chords, -chords])
    half = len(edges)
    twin = np.concatenate([np.arange(half, 2 * half), np.arange(half)])
    order = np.lexsort((np.arctan2(way[:, 1], way[:, 0]), tail))
    place = np.empty(2 * half, dtype=np.int64)
    place[order] = np.arange(2 * half)
    start = np.searchsorted(tail[order], np.arange(len(uv) + 1))
    back = place[twin]  # where the way back stands in the order round its node
    node = head
    before = np.where(back == start[node], start[node + 1] - 1, back - 1)
    follow = order[before]
    faces, areas = [], []
    seen = np.zeros(2 * half, dtype=bool)
    for first in range(2 * half):
        if seen[first]:
            continue
        ring, at = [], first
        while not seen[at]:
            seen[at] = True
            ring.append(at)
            at = int(follow[at])
        if not outside[ring].any():
            faces.append(tail[ring])
            areas.append(float(area[ring].sum()))
    return faces, np.array(areas)

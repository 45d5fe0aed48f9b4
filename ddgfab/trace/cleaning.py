"""Cells of a network without short edges, spikes and vertices that no line needs."""

from __future__ import annotations

from typing import Final

import numpy as np

from ddgfab.mesh import Floats, Ints
from ddgfab.trace.slivers import without_slivers

_SHORT: Final = 0.3
"""Edges shorter than this part of the median collapse."""


def cleaned(points: Floats, rank: Ints, faces: list[Ints]) -> tuple[list[Ints], Ints]:
    """Faces without short edges, without vertices of valence 2 inside; the vertices they use."""
    parent = np.arange(len(points))

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = int(parent[i])
        return i

    ends = np.concatenate([np.stack([face, np.roll(face, -1)], axis=1) for face in faces])
    ends = np.unique(np.sort(ends, axis=1), axis=0)
    length = np.linalg.norm(points[ends[:, 1]] - points[ends[:, 0]], axis=1)
    short = np.flatnonzero(length < _SHORT * np.median(length))
    for k in short[np.argsort(length[short], kind="stable")]:
        a, b = root(int(ends[k, 0])), root(int(ends[k, 1]))
        if a != b and not (rank[a] == 2 and rank[b] == 2):
            low, high = sorted((a, b), key=lambda i: (rank[i], -i))
            parent[low] = high
    names = np.array([root(i) for i in range(len(points))])
    out = []
    for face in faces:
        ring = _without_spikes(names[face])
        if len(ring) >= 3:
            out.append(ring)
    out = without_slivers(points, out)
    out = [_without_spikes(ring) for ring in _without_passing(out, rank)]
    return out, np.unique(np.concatenate(out)) if out else np.zeros(0, dtype=np.int64)


def _without_spikes(ring: Ints) -> Ints:
    """A face without repeated corners and without edges that it runs along both ways."""
    row = ring.tolist()
    changed = True
    while changed and len(row) > 2:
        changed = False
        for i, corner in enumerate(row):
            if corner == row[i - 1]:
                del row[i]
            elif row[i - 2] == corner:  # there and back
                for k in sorted((i, (i - 1) % len(row)), reverse=True):
                    del row[k]
            else:
                continue
            changed = True
            break
    return np.array(row, dtype=np.int64)


def _without_passing(faces: list[Ints], rank: Ints) -> list[Ints]:
    """Faces without inner vertices that only two faces use: lines that end there were pruned."""
    flat = np.concatenate(faces) if faces else np.zeros(0, dtype=np.int64)
    uses = np.bincount(flat, minlength=len(rank))
    out = []
    for face in faces:
        ring = face[~((rank[face] == 0) & (uses[face] == 2))]
        out.append(ring if len(ring) >= 3 else face)
    return out

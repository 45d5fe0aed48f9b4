"""Which placed parts could be near each other, and planes that keep them apart; arrays only.

A plane with normal n separates two sets by at least min n.B - max n.A, whatever their shape: so
the directions of the parts' own faces certify distances in one batch.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ddgfab.mesh import Floats, Ints
from fabrication.specs import TriangleMesh

CANDIDATES: Final = 4
"""How many of each part's own planes are tried on a pair, best first."""

_NORMAL_STEPS: Final = 1_000_000  # normals that agree in so many steps count as one plane's
_NORMAL_BASE: Final = 2 * _NORMAL_STEPS + 1
_CHUNK: Final = 2_000_000  # numbers in a temporary array


@dataclass(frozen=True, eq=False)
class Supports:
    """Points and directions of m parts, padded to common sizes.

    points : (m, k, 3) vertices in the part's frame; shorter lists repeat their first one
    normals : (m, j, 3) unit normals of its faces; shorter lists repeat their first one
    offsets : (m, j) greatest n.x of the part along each normal
    """

    points: Floats
    normals: Floats
    offsets: Floats

    @staticmethod
    def build(meshes: Sequence[TriangleMesh]) -> Supports:
        """From the meshes of the parts."""
        points = _padded([mesh.vertices for mesh in meshes])
        normals = _padded([_directions(mesh) for mesh in meshes])
        offsets = np.empty(normals.shape[:2])
        step = max(1, _CHUNK // (normals.shape[1] * points.shape[1]))
        for begin in range(0, len(meshes), step):
            part = slice(begin, begin + step)
            reach = np.matmul(normals[part], points[part].transpose(0, 2, 1))
            offsets[part] = reach.max(axis=2)
        return Supports(points, normals, offsets)


def near_pairs(supports: Supports, owner: Ints, placements: Floats, reach: float) -> Ints:
    """(p, 2) pairs of pieces whose bounding boxes come nearer than `reach` [mm], sorted.

    Parameters
    ----------
    owner : (n,) part of each piece
    placements : (n, 4, 4)
    """
    points = _placed(supports.points[owner], placements)
    low, high = points.min(axis=1) - reach / 2, points.max(axis=1) + reach / 2
    pairs = _cell_pairs(low, high)
    a, b = pairs.T
    touch = ((low[a] <= high[b]) & (low[b] <= high[a])).all(axis=1)
    near: Ints = pairs[touch]
    return near


def separations(
    supports: Supports, owner: Ints, placements: Floats, pairs: Ints, needed: Floats
) -> Floats:
    """(p,) lower bounds [mm] on the distances of pairs; below zero where no plane was found.

    First the few planes of either part that face the other's middle; where those do not reach
    `needed`, all planes of both.
    """
    found = _separations(supports, owner, placements, pairs, CANDIDATES)
    rest = np.flatnonzero(found < needed)
    if len(rest):
        every = _separations(supports, owner, placements, pairs[rest], supports.normals.shape[1])
        found[rest] = np.maximum(found[rest], every)
    return found


def _separations(
    supports: Supports, owner: Ints, placements: Floats, pairs: Ints, candidates: int
) -> Floats:
    """Best lower bound over the `candidates` most promising planes of either part."""
    best = np.full(len(pairs), -np.inf)
    width = supports.points.shape[1] * min(candidates, supports.normals.shape[1])
    step = max(1, _CHUNK // max(width, 3 * supports.points.shape[1], 3 * supports.normals.shape[1]))
    for begin in range(0, len(pairs), step):
        part = slice(begin, begin + step)
        for a, b in (pairs[part].T, pairs[part, ::-1].T):
            bound = _one_sided(
                supports, owner[a], owner[b], placements[a], placements[b], candidates
            )
            best[part] = np.maximum(best[part], bound)
    return best


def _one_sided(
    supports: Supports, a: Ints, b: Ints, at_a: Floats, at_b: Floats, candidates: int
) -> Floats:
    """(p,) greatest over planes of a of the distance from the plane to b, in a's frame."""
    turn = at_a[:, :3, :3]
    motion = np.empty_like(at_a[:, :3])
    motion[:, :, :3] = np.einsum("pji,pjk->pik", turn, at_b[:, :3, :3])
    motion[:, :, 3] = np.einsum("pji,pj->pi", turn, at_b[:, :3, 3] - at_a[:, :3, 3])
    points = _placed(supports.points[b], motion)
    normals, offsets = supports.normals[a], supports.offsets[a]
    if candidates < normals.shape[1]:
        middle = (points.min(axis=1) + points.max(axis=1)) / 2
        facing = np.einsum("pjc,pc->pj", normals, middle) - offsets
        chosen = np.argpartition(-facing, candidates - 1, axis=1)[:, :candidates]
        normals = np.take_along_axis(normals, chosen[:, :, None], axis=1)
        offsets = np.take_along_axis(offsets, chosen, axis=1)
    bound: Floats = (np.matmul(normals, points.transpose(0, 2, 1)).min(axis=2) - offsets).max(
        axis=1
    )
    return bound


def _cell_pairs(low: Floats, high: Floats) -> Ints:
    """(p, 2) distinct pairs i < j of boxes that share a cell of a grid as coarse as the largest."""
    size = np.maximum((high - low).max(axis=0), np.finfo(np.float64).tiny)
    first = np.floor((low - low.min(axis=0)) / size).astype(np.int64)
    last = np.floor((high - low.min(axis=0)) / size).astype(np.int64)
    spread = last - first + 1  # one or two cells along each axis
    shape = last.max(axis=0) + 1
    counts = spread.prod(axis=1)
    piece = np.repeat(np.arange(len(low)), counts)
    rank = np.arange(len(piece)) - np.repeat(np.cumsum(counts) - counts, counts)
    s = spread[piece]
    step = np.stack([rank % s[:, 0], rank // s[:, 0] % s[:, 1], rank // (s[:, 0] * s[:, 1])], 1)
    cell = first[piece] + step
    key = (cell[:, 0] * shape[1] + cell[:, 1]) * shape[2] + cell[:, 2]
    order = np.argsort(key, kind="stable")
    piece, key = piece[order], key[order]
    begin = np.flatnonzero(np.r_[True, key[1:] != key[:-1]])
    counts = np.diff(np.r_[begin, len(key)])
    left_in_cell = np.repeat(begin + counts, counts) - np.arange(len(key)) - 1
    left = np.repeat(np.arange(len(key)), left_in_cell)
    shift = np.arange(len(left)) - np.repeat(np.cumsum(left_in_cell) - left_in_cell, left_in_cell)
    i, j = piece[left], piece[left + 1 + shift]
    touch = ((low[i] <= high[j]) & (low[j] <= high[i])).all(axis=1)
    i, j = i[touch], j[touch]
    n = len(low)
    keys = np.unique(np.minimum(i, j) * n + np.maximum(i, j))
    return np.stack([keys // n, keys % n], axis=1)


def _directions(mesh: TriangleMesh) -> Floats:
    """The distinct unit normals of a mesh's triangles, in order of first appearance."""
    corners = mesh.vertices[mesh.triangles]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.sqrt(np.einsum("ij,ij->i", cross, cross))
    normals = cross[length > 0] / length[length > 0, None]
    if not len(normals):
        return np.vstack([np.eye(3), -np.eye(3)])  # any direction gives a sound bound
    x, y, z = np.rint((normals + 1.0) * _NORMAL_STEPS).astype(np.int64).T
    _, first = np.unique((x * _NORMAL_BASE + y) * _NORMAL_BASE + z, return_index=True)
    distinct: Floats = normals[np.sort(first)]
    return distinct


def _padded(lists: Sequence[Floats]) -> Floats:
    """Lists of vectors as one array, the shorter ones filled up with their first vector."""
    longest = max(len(item) for item in lists)
    result = np.empty((len(lists), longest, 3))
    for row, item in zip(result, lists, strict=True):
        row[: len(item)] = item
        row[len(item) :] = item[0]
    return result


def _placed(points: Floats, motions: NDArray[np.float64]) -> Floats:
    """(n, k, 3) points moved by (n, 3 or 4, 4) rigid motions."""
    moved: Floats = np.matmul(points, motions[:, :3, :3].transpose(0, 2, 1))
    moved += motions[:, None, :3, 3]
    return moved

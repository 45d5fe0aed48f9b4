"""Faces of a net of lines: bars that bound polygons, where the polygons are clear."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ddgfab.errors import MeshError
from ddgfab.io.near import CHUNK, near_pairs
from ddgfab.mesh import Floats, Ints, unit
from ddgfab.tolerances import COORDINATE_LIMIT, WELD_COARSE

NEAR_ENDS = 1e-5
"""Ends of lines nearer than this part of the net's size are one point."""

PAIRS = 100_000_000
"""Lines that leave more pairs than this to compare are refused."""


@dataclass(frozen=True, eq=False)
class Wires:
    """Straight bars between points.

    Attributes
    ----------
    points : (V, 3)
    bars : (E, 2) ids of points, each pair once
    wire : (E,) the polyline that each bar came from
    """

    points: Floats
    bars: Ints
    wire: Ints

    @staticmethod
    def of(points: Floats, wires: Sequence[Sequence[int]], step: float, file: str) -> Wires:
        """Bars of polylines; ends nearer than the file's digits (or `NEAR_ENDS`) become one."""
        pairs = np.array([pair for w in wires for pair in pairwise(w)])
        owner = np.repeat(np.arange(len(wires)), [len(w) - 1 for w in wires])
        if pairs.max(initial=0) >= len(points):
            raise MeshError(
                f"a line 'l' names vertex {pairs.max()} (counting from 0); the file has "
                f"{len(points)} vertices",
                file=file,
            )
        used = np.unique(pairs)
        large = used[~(np.abs(points[used]) <= COORDINATE_LIMIT).all(axis=1)]
        if len(large):
            raise MeshError(
                f"vertex {large[0]} (counting from 0) has a coordinate beyond {COORDINATE_LIMIT:g}",
                file=file,
            )
        size = float(np.linalg.norm(points[used] - points[used].mean(axis=0), axis=1).max())
        near = near_pairs(points[used], min(max(2.5 * step, NEAR_ENDS * size), WELD_COARSE * size))
        graph = coo_array((np.ones(len(near)), near.T), shape=(len(used), len(used)))
        label = connected_components(graph, directed=False)[1]
        first = used[np.unique(label, return_index=True)[1]]
        bars = np.sort(first[label[np.searchsorted(used, pairs)]], axis=1)
        kept = bars[:, 0] != bars[:, 1]
        bars, at = np.unique(bars[kept], axis=0, return_index=True)
        return Wires(points, bars, owner[kept][at])


def faces_of_wires(
    wires: Wires, lines: Sequence[int], file: str
) -> tuple[list[list[int]], list[int]]:
    """Polygons that the bars bound, seen along the direction in which the net is broadest.

    Seen so, the bars must form a plane drawing: then its bounded regions are the faces, whatever
    their number of sides. Bars with a free end bound nothing and are left out.

    Parameters
    ----------
    lines : line in the file of each polyline
    file : for messages

    Returns
    -------
    Faces as vertex ids, counterclockwise seen from above, and the line of a bar of each.

    Raises
    ------
    MeshError
        Bars that cross, a net that closes up (its faces overlap from any side), or no region.
    """
    bars, wire = _without_free_ends(wires)
    if not len(bars):
        raise MeshError(
            "the mesh has no faces, and its lines bound none: export a mesh of polygons",
            file=file,
            line=lines[0],
        )
    flat = _seen_flat(wires.points, bars)
    loops = _loops(flat, bars)
    area = [_area(flat[loop]) for loop in loops]
    count = len(np.unique(bars))
    graph = coo_array((np.ones(len(bars)), bars.T), shape=(len(flat), len(flat)))
    pieces = connected_components(graph, directed=False)[0] - (len(flat) - count)
    outside = sum(value <= 0 for value in area)
    simple = all(len(set(loop)) == len(loop) for loop, a in zip(loops, area, strict=True) if a > 0)
    crossing = _crossing(flat, bars, file)
    if crossing is not None:
        a, b = (lines[int(wire[i])] for i in crossing)
        raise MeshError(
            f"the mesh has no faces, and which its lines bound is not clear: the lines of file "
            f"lines {a} and {b} cross without a common point (seen from the net's broad side)\n"
            "split them where they cross, or export a mesh of polygons",
            file=file,
            line=b,
        )
    if count - len(bars) + len(loops) != 2 * pieces or outside != pieces or not simple:
        raise MeshError(
            f"the mesh has no faces, and which its {len(bars)} lines bound is not clear (a net "
            "that closes up?): export a mesh of polygons",
            file=file,
            line=lines[0],
        )
    found = [loop for loop, a in zip(loops, area, strict=True) if a > 0]
    place = {(a, b): int(w) for (a, b), w in zip(bars.tolist(), wire.tolist(), strict=True)}
    at = [lines[place[min(f[0], f[1]), max(f[0], f[1])]] for f in found]
    order = sorted(range(len(found)), key=lambda i: (min(found[i]), sorted(found[i])))
    return [found[i] for i in order], [at[i] for i in order]


def _without_free_ends(wires: Wires) -> tuple[Ints, Ints]:
    """Bars that are left when those with a free end go, again and again."""
    bars, wire = wires.bars, wires.wire
    while len(bars):
        degree = np.bincount(bars.ravel(), minlength=len(wires.points))
        keep = (degree[bars] > 1).all(axis=1)
        if keep.all():
            break
        bars, wire = bars[keep], wire[keep]
    return bars, wire


def _seen_flat(points: Floats, bars: Ints) -> Floats:
    """(V, 2) points in the plane of least squares, seen from the side of +z (or +y, +x)."""
    used = np.unique(bars)
    middle = points[used].mean(axis=0)
    axes = np.linalg.svd(points[used] - middle, full_matrices=False)[2]
    normal = unit(np.cross(axes[0], axes[1]))
    lead = normal[2] if abs(normal[2]) > 1e-6 else normal[np.abs(normal).argmax()]
    second = axes[1] if lead > 0 else -axes[1]
    return np.stack([(points - middle) @ axes[0], (points - middle) @ second], axis=1)


def _loops(flat: Floats, bars: Ints) -> list[list[int]]:
    """Closed walks that keep the region on their left: at each point the next bar clockwise."""
    ends = np.concatenate([bars, bars[:, ::-1]])
    way = flat[ends[:, 1]] - flat[ends[:, 0]]
    order = np.lexsort((np.arctan2(way[:, 1], way[:, 0]), ends[:, 0]))
    about: dict[int, list[int]] = {}
    for start, end in ends[order].tolist():
        about.setdefault(start, []).append(end)
    before = {
        (vertex, around[i]): around[i - 1]
        for vertex, around in about.items()
        for i in range(len(around))
    }
    loops = []
    left = dict.fromkeys(map(tuple, ends.tolist()))
    while left:
        start, end = next(iter(left))
        loop = []
        while (start, end) in left:
            del left[start, end]
            loop.append(start)
            start, end = end, before[end, start]
        loops.append(loop)
    return loops


def _area(loop: Floats) -> float:
    x, y = loop.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def _crossing(flat: Floats, bars: Ints, file: str) -> tuple[int, int] | None:
    """Two bars that cross between their ends, or None. A sweep keeps the pairs few.

    Raises
    ------
    MeshError
        More pairs to compare than `PAIRS`.
    """
    p, q = flat[bars[:, 0]], flat[bars[:, 1]]
    low, high = np.minimum(p, q), np.maximum(p, q)
    orders = np.argsort(low, axis=0, kind="stable").T
    lasts = [
        np.searchsorted(low[order, k], high[order, k], side="right")
        for k, order in enumerate(orders)
    ]
    counts = [last - np.arange(1, len(bars) + 1) for last in lasts]
    k = int(counts[1].sum() < counts[0].sum())
    order, count = orders[k], counts[k]
    if count.sum() > PAIRS:
        raise MeshError(
            f"the mesh has no faces, and its {len(bars)} lines are too many to find out which "
            f"they bound ({count.sum()} pairs to compare, the limit is {PAIRS}): export a mesh of "
            "polygons",
            file=file,
        )
    every = np.cumsum(count)
    cuts = np.searchsorted(every, np.arange(CHUNK, int(every[-1]), CHUNK), side="right")
    for part in np.split(np.arange(len(bars)), np.unique(cuts)):
        one = np.repeat(part, count[part])
        other = np.arange(len(one)) - np.repeat(np.cumsum(count[part]) - count[part], count[part])
        i, j = order[one], order[one + 1 + other]
        apart = (low[i] > high[j]) | (low[j] > high[i])
        joined = (bars[i][:, :, None] == bars[j][:, None, :]).any(axis=(1, 2))
        close = ~(apart.any(axis=1) | joined)
        i, j = i[close], j[close]
        a, b, c, d = p[i], q[i], p[j], q[j]
        one_side = _side(a, b, c) * _side(a, b, d)
        other_side = _side(c, d, a) * _side(c, d, b)
        hit = np.flatnonzero((one_side < 0) & (other_side < 0))
        if len(hit):
            return int(i[hit[0]]), int(j[hit[0]])
    return None


def _side(a: Floats, b: Floats, c: Floats) -> Floats:
    """Twice the signed area of triangles a, b, c."""
    u, v = b - a, c - a
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])

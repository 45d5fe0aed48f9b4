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

PAIRS = 10_000_000
"""Lines that leave more pairs than this to compare are refused: some seconds of computing."""


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
    bars = wires.bars
    degree = np.bincount(bars.ravel(), minlength=len(wires.points)).tolist()
    at: dict[int, list[int]] = {}
    ends = bars.tolist()
    for bar, (one, two) in enumerate(ends):
        at.setdefault(one, []).append(bar)
        at.setdefault(two, []).append(bar)
    keep = np.ones(len(bars), dtype=bool)
    free = [vertex for vertex in at if degree[vertex] == 1]
    while free:
        vertex = free.pop()
        for bar in at[vertex]:
            if keep[bar]:
                keep[bar] = False
                for end in ends[bar]:
                    degree[end] -= 1
                    if degree[end] == 1:
                        free.append(end)
    return bars[keep], wires.wire[keep]


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
    """Two bars that cross between their ends, or None.

    Only bars are compared that overlap along an axis, or pass the same cell of a grid: whichever
    leaves fewest pairs.

    Raises
    ------
    MeshError
        More pairs to compare than `PAIRS`.
    """
    p, q = flat[bars[:, 0]], flat[bars[:, 1]]
    low, high = np.minimum(p, q), np.maximum(p, q)
    ways = [_along(low[:, 0], high[:, 0]), _along(low[:, 1], high[:, 1]), _in_cells(p, q)]
    order, count = min(ways, key=lambda way: int(way[1].sum()))
    if count.sum() > PAIRS:
        raise MeshError(
            f"the mesh has no faces, and its {len(bars)} lines are too many to find out which "
            f"they bound ({count.sum()} pairs to compare, the limit is {PAIRS}): export a mesh of "
            "polygons",
            file=file,
        )
    if not count.sum():
        return None
    every = np.cumsum(count)
    cuts = np.searchsorted(every, np.arange(CHUNK, int(every[-1]), CHUNK), side="right")
    for part in np.split(np.arange(len(order)), np.unique(cuts)):
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


def _along(low: Floats, high: Floats) -> tuple[Ints, Ints]:
    """Bars in the order in which they begin along an axis, and how many begin before each ends."""
    order = np.argsort(low, kind="stable")
    last = np.searchsorted(low[order], high[order], side="right")
    return order, last - np.arange(1, len(order) + 1)


def _in_cells(p: Floats, q: Floats) -> tuple[Ints, Ints]:
    """Bars by the cells of a square grid that they pass.

    Returns
    -------
    order : ids of bars, those of one cell after each other
    count : how many of the same cell follow each

    Long bars are cut into pieces no longer than a cell, so that there are at most four pieces a
    bar, and a piece lies in few cells.
    """
    long = np.abs(q - p).max(axis=1)
    span = float(np.ptp(np.concatenate([p, q]), axis=0).max())
    size = max(float(long.sum()) / (3 * len(p)), span * 1e-6) or 1.0
    pieces = np.maximum(np.ceil(long / size), 1).astype(np.int64)
    bar = np.repeat(np.arange(len(p)), pieces)
    step = (np.arange(len(bar)) - np.repeat(np.cumsum(pieces) - pieces, pieces)) / pieces[bar]
    way = (q - p)[bar]
    start = p[bar] + step[:, None] * way
    end = start + way / pieces[bar][:, None]
    edge = 1e-9 * span
    first = np.floor((np.minimum(start, end) - edge) / size).astype(np.int64)
    last = np.floor((np.maximum(start, end) + edge) / size).astype(np.int64)
    first, last = first - first.min(axis=0), last - first.min(axis=0)
    width = int(last[:, 1].max()) + 1
    found = []
    for x in range(int((last - first)[:, 0].max()) + 1):
        for y in range(int((last - first)[:, 1].max()) + 1):
            inside = (first + np.array([x, y]) <= last).all(axis=1)
            cell = (first[inside, 0] + x) * width + first[inside, 1] + y
            found.append(np.stack([cell, bar[inside]], axis=1))
    entries = np.unique(np.concatenate(found), axis=0)
    ends = np.searchsorted(entries[:, 0], entries[:, 0], side="right")
    return entries[:, 1], ends - np.arange(1, len(entries) + 1)


def _side(a: Floats, b: Floats, c: Floats) -> Floats:
    """Twice the signed area of triangles a, b, c."""
    u, v = b - a, c - a
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])

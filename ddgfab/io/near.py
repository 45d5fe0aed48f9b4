"""Pairs of near points, in time that grows with their number and not with its square."""

from __future__ import annotations

from itertools import product

import numpy as np

from ddgfab.mesh import Floats, Ints

_SWEEP = np.array([0.5773, 0.2113, 0.7887])  # a direction no grid is perpendicular to

DIRECTIONS = np.array(list(product((-1, 0, 1), repeat=3))[:13], dtype=np.float64)
"""(13, 3) half of the directions to the neighbours of a cube."""

SWEPT = 32
"""Points with more neighbours than this along the sweep, on average, are sorted into cubes."""

CHUNK = 2_000_000
"""Pairs that are compared at once."""

CROWD = 16
"""Of more points in a place than this, only the outermost are compared with others."""


def near_pairs(points: Floats, distance: float) -> Ints:
    """(k, 2) pairs whose chains join all points nearer than a distance.

    A sweep along a direction in general position, then the true distance: few points are that
    near along it, so the work is almost linear; unlike a k-d tree it needs no further import.
    Points that a sweep does not separate are sorted into cubes. Of many points in a place
    `_crowds` leaves few, so that a crowd costs no square of its size.
    """
    first, copy = _crowds(points, distance)
    pairs = [np.stack([copy, first[copy]], axis=1)]
    left = np.flatnonzero(first == np.arange(len(points)))
    if distance > 0 and len(left):
        along = points[left] @ (_SWEEP / np.linalg.norm(_SWEEP))
        order = np.argsort(along, kind="stable")
        left, along = left[order], along[order]
        rank = np.arange(len(left))
        last = np.searchsorted(along, along + distance, side="right")
        if (last - rank - 1).sum() <= SWEPT * len(left):
            pairs += _compared(points, distance, left, rank, rank + 1, last)
        else:
            pairs += _by_cubes(points, distance, left)
    return np.concatenate(pairs)


def labeled(rows: Floats) -> tuple[Ints, Ints]:
    """First row of each kind of equal rows, in ascending order, and the kind of every row.

    As np.unique along an axis, in a tenth of its time.
    """
    order = np.lexsort(rows.T[::-1])
    ranked = rows[order]
    new = np.ones(len(rows), dtype=bool)
    new[1:] = (ranked[1:] != ranked[:-1]).any(axis=1)
    kind = np.empty(len(rows), dtype=np.int64)
    kind[order] = np.cumsum(new) - 1
    return order[new], kind


def _by_cubes(points: Floats, distance: float, ids: Ints) -> list[Ints]:
    """Near pairs of points in the same cube of the distance's side, or in neighbouring ones."""
    place = np.floor(points[ids] / distance)
    place -= place.min(axis=0)
    some, cell = labeled(place)
    cells = place[some]
    order = np.argsort(cell, kind="stable")
    ids, cell = ids[order], cell[order]
    start = np.searchsorted(cell, np.arange(len(cells) + 1))
    rank = np.arange(len(ids))
    pairs = _compared(points, distance, ids, rank, rank + 1, start[cell + 1])
    for way in DIRECTIONS:
        there = _rows_in(cells + way, cells)
        have = np.flatnonzero(there[cell] >= 0)
        beside = there[cell[have]]
        pairs += _compared(points, distance, ids, have, start[beside], start[beside + 1])
    return pairs


def _rows_in(wanted: Floats, table: Floats) -> Ints:
    """Where each wanted row stands in a table of different rows, -1 where it does not."""
    label = labeled(np.concatenate([table, wanted]))[1]
    at = np.full(label.max(initial=0) + 1, -1, dtype=np.int64)
    at[label[: len(table)]] = np.arange(len(table))
    return at[label[len(table) :]]


def _compared(
    points: Floats, distance: float, ids: Ints, rank: Ints, first: Ints, last: Ints
) -> list[Ints]:
    """Those pairs of ids[rank] and ids[first:last] that are near."""
    every = np.cumsum(last - first)
    if not len(every) or not every[-1]:
        return []
    cuts = np.searchsorted(every, np.arange(CHUNK, int(every[-1]), CHUNK), side="right")
    found = []
    for part in np.split(np.arange(len(rank)), np.unique(cuts)):
        count = last[part] - first[part]
        one = np.repeat(rank[part], count)
        other = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        other += np.repeat(first[part], count)
        near = np.linalg.norm(points[ids[one]] - points[ids[other]], axis=1) <= distance
        found.append(np.stack([ids[one[near]], ids[other[near]]], axis=1))
    return found


def _crowds(points: Floats, distance: float) -> tuple[Ints, Ints]:
    """For each point another one near it that stands for it, and the points that are stood for.

    Points at equal coordinates have one representative. Of a crowd in a cube of the distance's
    diagonal, those between the outermost in 13 directions are represented by one of them.
    """
    first, label = labeled(points)
    stands = first[label]
    if not distance > 0:
        return stands, np.flatnonzero(stands != np.arange(len(points)))
    cells = np.floor(points[first] * (np.sqrt(3.0) / distance))
    cell = labeled(cells)[1]
    count = np.bincount(cell)
    crowded = np.flatnonzero(count > CROWD)
    if len(crowded):
        inside = np.flatnonzero(np.isin(cell, crowded))
        inside = inside[np.argsort(cell[inside], kind="stable")]
        for members in np.split(first[inside], np.cumsum(count[crowded])[:-1]):
            reach = points[members] @ DIRECTIONS.T
            outer = np.unique(np.concatenate([reach.argmax(axis=0), reach.argmin(axis=0)]))
            inner = np.setdiff1d(np.arange(len(members)), outer)
            # The outermost stay apart as points; one of them stands for all the others.
            stands[members[inner]] = members[outer[0]]
        stands = stands[stands]
    return stands, np.flatnonzero(stands != np.arange(len(points)))

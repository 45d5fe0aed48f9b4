"""Which of many boxes meet: a tree of boxes descended level by level; arrays only.

Work grows with the number of boxes and of pairs that meet, whatever the sizes of the boxes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from ddgfab.mesh import Floats, Ints

_LEAF: Final = 4  # boxes in a leaf of the tree
_BITS: Final = 20  # of each coordinate in the order of the boxes
_FEW: Final = 60_000  # of so few pairs every one is looked at
_CHUNK: Final = 400_000  # pairs of leaves that are opened at a time


@dataclass(frozen=True, eq=False)
class _Tree:
    """Boxes in the order of a curve that fills space, and the boxes around 4, 8, 16, ... of them.

    order : (n,) ids of the boxes
    levels : from the root down: (k, 3) low and high corners of the nodes, k = 1, 2, 4, ...
    """

    order: Ints
    levels: list[tuple[Floats, Floats]]

    @staticmethod
    def build(low: Floats, high: Floats, depth: int) -> _Tree:
        """A tree with so many levels below the root; missing boxes are empty."""
        order = _curve(low, high)
        width = _LEAF << depth
        lows, highs = np.full((width, 3), np.inf), np.full((width, 3), -np.inf)
        lows[: len(order)], highs[: len(order)] = low[order], high[order]
        step, levels = _LEAF, []
        while len(lows) > 1:
            lows = lows.reshape(-1, step, 3).min(axis=1)
            highs = highs.reshape(-1, step, 3).max(axis=1)
            levels.append((lows, highs))
            step = 2
        return _Tree(order, levels[::-1])


def box_pairs(low: Floats, high: Floats) -> Ints:
    """(p, 2) pairs i < j of axis-parallel boxes that meet, sorted; touching counts.

    Parameters
    ----------
    low, high : (n, 3) corners; boxes with a corner that is not finite meet none
    """
    pairs = box_pairs_between(low, high, low, high, same=True)
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]


def box_pairs_between(
    low: Floats, high: Floats, other_low: Floats, other_high: Floats, *, same: bool = False
) -> Ints:
    """(p, 2) pairs of a box of the first and one of the second list that meet; in no order.

    With `same` both lists are one, and pairs come once, without those of a box with itself.
    """
    if len(low) * len(other_low) <= _FEW:
        near = np.ones((len(low), len(other_low)), dtype=np.bool_)
        for k in range(3):
            near &= low[:, None, k] <= other_high[:, k]
            near &= other_low[:, k] <= high[:, None, k]
        return np.argwhere(np.triu(near, 1) if same else near)
    depth = max(0, int(np.ceil(np.log2(max(len(low), len(other_low)) / _LEAF))))
    first = _Tree.build(low, high, depth)
    second = first if same else _Tree.build(other_low, other_high, depth)
    a = b = np.zeros(1, dtype=np.int64)
    for level in range(1, depth + 1):
        a, b = _children(a, b, 2)
        if same:
            a, b = a[a <= b], b[a <= b]
        meet = _meet(*first.levels[level], *second.levels[level], a, b)
        a, b = a[meet], b[meet]
    found = [np.zeros((0, 2), dtype=np.int64)]
    for begin in range(0, len(a), _CHUNK):
        i, j = _children(a[begin : begin + _CHUNK], b[begin : begin + _CHUNK], _LEAF)
        there = (i < len(first.order)) & (j < len(second.order))
        if same:
            there &= i < j
        i, j = first.order[i[there]], second.order[j[there]]
        meet = _meet(low, high, other_low, other_high, i, j)
        pairs = np.stack([i[meet], j[meet]], axis=1)
        found.append(np.sort(pairs, axis=1) if same else pairs)
    return np.concatenate(found)


def _children(a: Ints, b: Ints, count: int) -> tuple[Ints, Ints]:
    """All pairs of the children of pairs of nodes."""
    steps = np.arange(count)
    i = (count * a[:, None, None] + steps[:, None]) + 0 * steps
    j = (count * b[:, None, None] + 0 * steps[:, None]) + steps
    return i.ravel(), j.ravel()


def _meet(
    low: Floats, high: Floats, other_low: Floats, other_high: Floats, i: Ints, j: Ints
) -> Ints:
    """Which pairs of boxes meet, as places in the list of pairs."""
    rows = np.arange(len(i))
    for axis in range(3):
        meet = (low[i, axis] <= other_high[j, axis]) & (other_low[j, axis] <= high[i, axis])
        i, j, rows = i[meet], j[meet], rows[meet]
    return rows


def _curve(low: Floats, high: Floats) -> Ints:
    """Ids of the boxes so that neighbours in the list are near in space (Morton order)."""
    middle = (low + high) / 2
    finite = np.asarray(np.isfinite(middle).all(axis=1))
    known = middle[finite]
    if not len(known):
        return np.arange(len(low))
    span = np.ptp(known, axis=0)
    span = np.maximum(span, np.finfo(np.float64).tiny)
    scaled = (np.where(finite[:, None], middle, known[0]) - known.min(axis=0)) / span
    cells = (np.clip(scaled, 0.0, 1.0) * (2**_BITS - 1)).astype(np.int64)
    key = np.zeros(len(low), dtype=np.int64)
    for axis in range(3):
        key |= _spread(cells[:, axis]) << axis
    return np.argsort(key, kind="stable")


def _spread(values: Ints) -> Ints:
    """Bits of numbers below 2^20 moved apart, two free places after each."""
    x = values
    for shift, mask in (
        (32, 0x1F00000000FFFF),
        (16, 0x1F0000FF0000FF),
        (8, 0x100F00F00F00F00F),
        (4, 0x10C30C30C30C30C3),
        (2, 0x1249249249249249),
    ):
        x = (x | (x << shift)) & mask
    return x

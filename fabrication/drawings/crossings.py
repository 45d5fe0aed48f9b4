"""Where many lines cross each other on paper."""

from __future__ import annotations

from typing import Final

import numpy as np

from ddgfab.mesh import Floats, Ints
from fabrication.drawings.polylines import Polylines

SLACK: Final = 1e-7
"""Crossings nearer to the ends of a segment than this part of it are at its end."""

MANY: Final = 1 << 19
"""Pairs of segments that are looked at in one go."""


def crossings(lines: Polylines) -> tuple[Ints, Floats]:
    """For every crossing of two lines, as seen along the third coordinate, one of the lines.

    Returns
    -------
    lines, parts
        (k,) each: the line, and the part of its parameter 0..1 where another one crosses it. A
        crossing inside both lines is there twice.
    """
    counts = np.diff(lines.start) - 1
    total = int(counts.sum())
    owner = np.repeat(np.arange(lines.count), counts)
    first = np.repeat(lines.start[:-1] - (np.cumsum(counts) - counts), counts) + np.arange(total)
    place = first - lines.start[owner]
    start, end = lines.points[first, :2], lines.points[first + 1, :2]
    way = end - start
    low, high = np.minimum(start, end) - SLACK, np.maximum(start, end) + SLACK
    one: list[Ints] = []
    two: list[Ints] = []
    rows = max(1, MANY // max(total, 1))
    for k in range(0, total, rows):
        own = slice(k, k + rows)
        near = (low[own, None, 0] <= high[:, 0]) & (high[own, None, 0] >= low[:, 0])
        near &= (low[own, None, 1] <= high[:, 1]) & (high[own, None, 1] >= low[:, 1])
        near &= owner[own, None] != owner
        i, j = np.nonzero(near)
        one.append(i + k)
        two.append(j)
    i, j = (np.concatenate(found) if found else np.zeros(0, dtype=np.int64) for found in (one, two))
    a, b, between = way[i], way[j], start[j] - start[i]
    turn = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        s = (between[:, 0] * b[:, 1] - between[:, 1] * b[:, 0]) / turn
        t = (between[:, 0] * a[:, 1] - between[:, 1] * a[:, 0]) / turn
    inside = (s > SLACK) & (s < 1.0 - SLACK) & (t > -SLACK) & (t < 1.0 + SLACK)
    i, s = i[inside], s[inside]
    return owner[i], (place[i] + s) / counts[owner[i]]

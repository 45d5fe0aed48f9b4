"""Many lines of straight segments in a few arrays: places on them, pieces, and pieces once each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ddgfab.mesh import Floats, Ints

SHORT: Final = 1e-6
"""Pieces shorter than this part of their line, and lines that are shorter [mm], are dropped."""

SAME: Final = 1e-3
"""Pieces whose ends are nearer than this [mm] are one piece."""


@dataclass(frozen=True, eq=False)
class Span:
    """Pieces of lines: the line, and from which to which part of its parameter 0..1; (n,) each."""

    line: Ints
    first: Floats
    last: Floats

    def chosen(self, which: Ints) -> Span:
        """Some of them."""
        return Span(self.line[which], self.first[which], self.last[which])

    def runs(self, visible: NDArray[np.bool_]) -> Iterator[tuple[int, float, float, bool]]:
        """Pieces that follow each other on one line, and are all visible or all hidden, as one."""
        if not len(self.line):
            return
        follows = (self.line[1:] == self.line[:-1]) & (visible[1:] == visible[:-1])
        follows &= np.abs(self.first[1:] - self.last[:-1]) < SHORT
        begin = np.flatnonzero(np.concatenate([[True], ~follows]))
        end = np.append(begin[1:], len(self.line)) - 1
        yield from zip(
            self.line[begin].tolist(),
            self.first[begin].tolist(),
            self.last[end].tolist(),
            visible[begin].tolist(),
            strict=True,
        )


@dataclass(frozen=True, eq=False)
class Polylines:
    """Lines through points, one after the other.

    Attributes
    ----------
    points : (n, 3)
    start : (m + 1,) first point of every line; at least two each
    """

    points: Floats
    start: Ints

    @classmethod
    def straight(cls, ends: Floats) -> Polylines:
        """Lines between two points each, (m, 2, 3)."""
        return cls(ends.reshape(-1, 3), np.arange(0, 2 * len(ends) + 1, 2))

    @property
    def count(self) -> int:
        """Number of lines."""
        return len(self.start) - 1

    def chosen(self, which: Ints) -> Polylines:
        """Some of the lines."""
        sizes = np.diff(self.start)[which]
        start = np.concatenate([[0], np.cumsum(sizes)])
        at = np.repeat(self.start[which] - start[:-1], sizes) + np.arange(start[-1])
        return Polylines(self.points[at], start)

    def joined(self, more: Polylines) -> Polylines:
        """These and more."""
        return Polylines(
            np.concatenate([self.points, more.points]),
            np.concatenate([self.start, self.start[-1] + more.start[1:]]),
        )

    def turned(self, axes: Floats) -> Polylines:
        """In the axes of a view, (3, 3) rows."""
        return Polylines(self.points @ axes.T, self.start)

    def at(self, line: Ints, part: Floats) -> Floats:
        """(k, 3) points of lines at parts of their parameter 0..1."""
        first, segments = self.start[line], self.start[line + 1] - self.start[line] - 1
        place = part * segments
        whole = np.minimum(place.astype(np.int64), segments - 1)
        rest = (place - whole)[:, None]
        at = first + whole
        return np.asarray(self.points[at] * (1.0 - rest) + self.points[at + 1] * rest)

    def part(self, line: int, first: float, last: float) -> Floats:
        """The points of a piece of one line."""
        begin, end = int(self.start[line]), int(self.start[line + 1])
        if first == 0.0 and last == 1.0:
            return self.points[begin:end]
        segments = end - begin - 1
        inner = [
            k / segments for k in range(1, segments) if first + 1e-9 < k / segments < last - 1e-9
        ]
        parts = np.array([first, *inner, last])
        return self.at(np.full(len(parts), line), parts)

    def seen(self) -> NDArray[np.bool_]:
        """(m,) whether a line is more than a point as seen along its third coordinate."""
        low = np.minimum.reduceat(self.points[:, :2], self.start[:-1], axis=0)
        high = np.maximum.reduceat(self.points[:, :2], self.start[:-1], axis=0)
        return np.asarray((high - low).max(axis=1) > SHORT)

    def whole(self) -> Span:
        """Every line from end to end, without those that are seen as points."""
        line = np.flatnonzero(self.seen()) if self.count else np.zeros(0, dtype=np.int64)
        return Span(line, np.zeros(len(line)), np.ones(len(line)))

    def cut(self, places: tuple[Ints, Floats]) -> Span:
        """Pieces between places (line and part of its parameter), without lines seen as points."""
        whole = self.whole()
        line = np.concatenate([whole.line, whole.line, places[0]])
        part = np.concatenate([whole.first, whole.last, places[1]])
        order = np.lexsort([part, line])
        line, part = line[order], part[order]
        piece = np.flatnonzero((line[1:] == line[:-1]) & (part[1:] - part[:-1] > SHORT))
        kept = piece[self.seen()[line[piece]]] if len(piece) else piece
        return Span(line[kept], part[kept], part[kept + 1])

    def once(self, spans: Span, visible: NDArray[np.bool_]) -> tuple[Span, NDArray[np.bool_]]:
        """Of pieces in one place, as seen along the third coordinate, one: a visible one."""
        if not len(spans.line):
            return spans, visible
        order = np.argsort(~visible, kind="stable")
        here = spans.chosen(order)
        one, two = (self.at(here.line, part)[:, :2] for part in (here.first, here.last))
        middle = self.at(here.line, 0.5 * (here.first + here.last))[:, :2]
        swap = (one[:, 0] > two[:, 0] + SAME) | (
            (np.abs(one[:, 0] - two[:, 0]) <= SAME) & (one[:, 1] > two[:, 1])
        )
        one[swap], two[swap] = two[swap], one[swap]
        keys = np.round(np.column_stack([one, two, middle]) / SAME).astype(np.int64)
        by_key = np.lexsort([np.arange(len(keys)), *keys.T])
        first = np.ones(len(keys), dtype=bool)
        first[1:] = (np.diff(keys[by_key], axis=0) != 0).any(axis=1)
        kept = np.sort(order[by_key[first]])
        return spans.chosen(kept), visible[kept]

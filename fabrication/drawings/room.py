"""Where texts find room: candidates are weighed by what they would lie on."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from typing import Final, TypeAlias

from fabrication.drawings.sheet import Item, Point, Text

Stroke: TypeAlias = tuple[Point, Point]
_Box: TypeAlias = tuple[float, float, float, float, float, float]
"""Middle, half width, half height, cosine and sine of a rectangle."""

CLEAR: Final = 0.6
"""Distance [mm] that texts keep from each other and from lines."""

ON_TEXT: Final = 1000.0
ON_OUTLINE: Final = 300.0
ON_LINE: Final = 10.0
LINE_ON_TEXT: Final = 100.0
LINE_ON_OUTLINE: Final = 0.4
LINE_ON_LINE: Final = 0.2
LINE_ALONG_LINE: Final = 20.0
"""What it costs when a text lies on another, on an outline, on a thin line; when a line of its own
crosses a text, an outline, a thin line, or lies on one. A candidate that costs less than `GOOD`
is taken."""

GOOD: Final = 1.0

_CELL: Final = 8.0
"""Size [mm] of the squares by which neighbors are found."""

_COLUMN: Final = 1 << 20
"""Squares of a column."""


class Room:
    """What is on a view so far; texts are put where they cost least."""

    def __init__(self) -> None:
        self._texts: list[_Box] = []
        self._strokes: list[Stroke] = []
        self._costs: list[tuple[float, float]] = []
        self._strokes_at: dict[int, list[int]] = {}
        self._texts_at: dict[int, list[int]] = {}

    def add_outline(self, strokes: Iterable[Stroke]) -> None:
        """An edge of the part."""
        self._add(strokes, (ON_OUTLINE, LINE_ON_OUTLINE))

    def add_lines(self, strokes: Iterable[Stroke]) -> None:
        """Thin lines."""
        self._add(strokes, (ON_LINE, LINE_ON_LINE))

    def _add(self, strokes: Iterable[Stroke], costs: tuple[float, float]) -> None:
        for stroke in strokes:
            index = len(self._strokes)
            self._strokes.append(stroke)
            self._costs.append(costs)
            for cell in _cells(stroke):
                self._strokes_at.setdefault(cell, []).append(index)

    def add_text(self, text: Text) -> None:
        """A text that stands."""
        box = box_of(text)
        for cell in _cells_of_box(box):
            self._texts_at.setdefault(cell, []).append(len(self._texts))
        self._texts.append(box)

    def cost(self, text: Text, most: float = math.inf) -> float:
        """What a text costs at its place; any value where that is above `most`."""
        box = box_of(text, CLEAR)
        cells = _cells_of_box(box)
        total = 0.0
        for k in _near(self._texts_at, cells):
            if overlap(box, self._texts[k]):
                total += ON_TEXT
                if total >= most:
                    return total
        for k in _near(self._strokes_at, cells):
            if meets(box, self._strokes[k]):
                total += self._costs[k][0]
                if total >= most:
                    return total
        return total

    def cost_of_lines(self, strokes: Iterable[Stroke], most: float, *, alone: bool) -> float:
        """What lines cost, any value where that is above `most`.

        alone : whether they must not run along others
        """
        total = 0.0
        for own in strokes:
            cells = _cells(own)
            for k in _near(self._texts_at, cells):
                if meets(self._texts[k], own):
                    total += LINE_ON_TEXT
            if total >= most:
                return total
            for k in _near(self._strokes_at, cells):
                if cross(own, self._strokes[k]):
                    total += self._costs[k][1]
                elif alone and lies_on(own, self._strokes[k]):
                    total += LINE_ALONG_LINE
        return total


def _near(table: dict[int, list[int]], cells: Iterable[int]) -> set[int]:
    """What is in some squares."""
    found: set[int] = set()
    for cell in cells:
        if cell in table:
            found.update(table[cell])
    return found


def _cells(stroke: Stroke) -> list[int]:
    """The squares that a straight line goes through."""
    (ax, ay), (bx, by) = stroke
    if ax > bx:
        ax, ay, bx, by = bx, by, ax, ay
    first, last = math.floor(ax / _CELL), math.floor(bx / _CELL)
    if first == last:
        low, high = (ay, by) if ay <= by else (by, ay)
        base = first * _COLUMN
        return list(range(base + math.floor(low / _CELL), base + math.floor(high / _CELL) + 1))
    slope = (by - ay) / (bx - ax)
    cells: list[int] = []
    for column in range(first, last + 1):
        left, right = max(ax, column * _CELL), min(bx, (column + 1) * _CELL)
        y0, y1 = ay + slope * (left - ax), ay + slope * (right - ax)
        if y0 > y1:
            y0, y1 = y1, y0
        base = column * _COLUMN
        cells += range(base + math.floor(y0 / _CELL), base + math.floor(y1 / _CELL) + 1)
    return cells


def _cells_of_box(box: _Box) -> list[int]:
    """The squares that a rectangle may meet."""
    x, y, half_width, half_height, c, s = box
    reach_x = half_width * abs(c) + half_height * abs(s)
    reach_y = half_width * abs(s) + half_height * abs(c)
    low, high = math.floor((y - reach_y) / _CELL), math.floor((y + reach_y) / _CELL)
    first, last = math.floor((x - reach_x) / _CELL), math.floor((x + reach_x) / _CELL)
    return [
        column * _COLUMN + row for column in range(first, last + 1) for row in range(low, high + 1)
    ]


def box_of(text: Text, margin: float = 0.0) -> _Box:
    """The rectangle of a text."""
    left, low, right, high = text.bounds(margin)
    c, s = math.cos(text.angle), math.sin(text.angle)
    u, v = 0.5 * (left + right), 0.5 * (low + high)
    x, y = text.at
    return (x + c * u - s * v, y + s * u + c * v, 0.5 * (right - left), 0.5 * (high - low), c, s)


def overlap(one: _Box, two: _Box) -> bool:
    """Whether two rectangles overlap: no side of either separates them."""
    dx, dy = two[0] - one[0], two[1] - one[1]
    reach = one[2] + one[3] + two[2] + two[3]
    if abs(dx) > reach or abs(dy) > reach:
        return False
    for c, s in ((one[4], one[5]), (two[4], two[5])):
        for x, y in ((c, s), (-s, c)):
            extent = sum(
                half_width * abs(x * bc + y * bs) + half_height * abs(y * bc - x * bs)
                for _, _, half_width, half_height, bc, bs in (one, two)
            )
            if abs(dx * x + dy * y) >= extent - 1e-9:
                return False
    return True


def meets(box: _Box, stroke: Stroke) -> bool:
    """Whether a straight line meets a rectangle."""
    x, y, half_width, half_height, c, s = box
    (ax, ay), (bx, by) = stroke
    reach = half_width + half_height
    if max(ax, bx) < x - reach or min(ax, bx) > x + reach:
        return False
    if max(ay, by) < y - reach or min(ay, by) > y + reach:
        return False
    ax, ay, bx, by = ax - x, ay - y, bx - x, by - y
    first, last = 0.0, 1.0
    for begin, end, half in (
        (ax * c + ay * s, bx * c + by * s, half_width),
        (ay * c - ax * s, by * c - bx * s, half_height),
    ):
        way = end - begin
        if abs(way) < 1e-12:
            if abs(begin) >= half:
                return False
            continue
        one, two = (-half - begin) / way, (half - begin) / way
        first, last = max(first, min(one, two)), min(last, max(one, two))
        if first >= last:
            return False
    return True


def cross(one: Stroke, two: Stroke) -> bool:
    """Whether two straight lines cross inside both."""
    (ax, ay), (bx, by) = one
    (cx, cy), (dx, dy) = two
    if max(ax, bx) < min(cx, dx) or max(cx, dx) < min(ax, bx):
        return False
    if max(ay, by) < min(cy, dy) or max(cy, dy) < min(ay, by):
        return False

    def side(px: float, py: float, qx: float, qy: float, rx: float, ry: float) -> float:
        return (qx - px) * (ry - py) - (qy - py) * (rx - px)

    return (
        side(ax, ay, bx, by, cx, cy) * side(ax, ay, bx, by, dx, dy) < -1e-9
        and side(cx, cy, dx, dy, ax, ay) * side(cx, cy, dx, dy, bx, by) < -1e-9
    )


def lies_on(one: Stroke, two: Stroke, near: float = 1.0) -> bool:
    """Whether two straight lines run along each other, nearer than so [mm], over more than that."""
    (ax, ay), (bx, by) = one
    ux, uy = bx - ax, by - ay
    size = math.hypot(ux, uy)
    if size < near:
        return False
    ux, uy = ux / size, uy / size
    along = [ux * (x - ax) + uy * (y - ay) for x, y in two]
    if min(max(along), size) - max(min(along), 0.0) <= near:
        return False
    return all(abs(ux * (y - ay) - uy * (x - ax)) < near for x, y in two)


def strokes_of(item: Item, step: float = math.pi / 8.0) -> list[Stroke]:
    """Straight lines for a path, an arc or the sides of a filled polygon; none for a text."""
    points = list(item.stroke_points(step))
    return list(itertools.pairwise(points))

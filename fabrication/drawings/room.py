"""Where texts find room: candidates are weighed by what they would lie on."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
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
LINE_ON_OUTLINE: Final = 2.0
LINE_ON_LINE: Final = 0.2
"""What it costs when a text lies on another, on an outline, on a thin line; when a line of its own
crosses a text, an outline, a thin line. A candidate that costs less than `GOOD` is taken."""

GOOD: Final = 0.1


class Room:
    """What is on a view so far; texts are put where they cost least."""

    def __init__(self) -> None:
        self._texts: list[_Box] = []
        self._outlines: list[Stroke] = []
        self._lines: list[Stroke] = []

    def add_outline(self, strokes: Iterable[Stroke]) -> None:
        """An edge of the part."""
        self._outlines += strokes

    def add_lines(self, strokes: Iterable[Stroke]) -> None:
        """Thin lines."""
        self._lines += strokes

    def add_text(self, text: Text) -> None:
        """A text that stands."""
        self._texts.append(box_of(text))

    def cost(self, text: Text, strokes: Sequence[Stroke] = (), most: float = math.inf) -> float:
        """What a text with lines of its own costs at its place; any value where above `most`."""
        box = box_of(text, CLEAR)
        total = 0.0
        for other in self._texts:
            if overlap(box, other):
                total += ON_TEXT
                if total >= most:
                    return total
        for stroke in self._outlines:
            if meets(box, stroke):
                total += ON_OUTLINE
                if total >= most:
                    return total
        for stroke in self._lines:
            if meets(box, stroke):
                total += ON_LINE
        for own in strokes:
            for other in self._texts:
                if meets(other, own):
                    total += LINE_ON_TEXT
            if total >= most:
                return total
            for stroke in self._outlines:
                if cross(own, stroke):
                    total += LINE_ON_OUTLINE
            for stroke in self._lines:
                if cross(own, stroke):
                    total += LINE_ON_LINE
        return total


def box_of(text: Text, margin: float = 0.0) -> _Box:
    """The rectangle of a text."""
    (ax, ay), (bx, by), (cx, cy), _ = text.box(margin)
    width, height = math.hypot(bx - ax, by - ay), math.hypot(cx - bx, cy - by)
    return (
        0.5 * (ax + cx),
        0.5 * (ay + cy),
        0.5 * width,
        0.5 * height,
        math.cos(text.angle),
        math.sin(text.angle),
    )


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


def strokes_of(item: Item, step: float = math.pi / 8.0) -> list[Stroke]:
    """Straight lines for a path, an arc or the sides of a filled polygon; none for a text."""
    points = list(item.stroke_points(step))
    return list(itertools.pairwise(points))

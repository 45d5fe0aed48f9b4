"""Lengths: a dimension line between extension lines, or along a line of the part (ISO 129-1)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import Literal, TypeAlias

from fabrication.boundary import Vec
from fabrication.drawings.lettering import LEAST
from fabrication.drawings.marks import (
    ABOVE,
    ARROW,
    FIRST,
    FOOT,
    MM_PLACES,
    NEXT,
    OVER,
    ROWS,
    arrow,
    readable,
)
from fabrication.drawings.placing import Candidate, PlacedView
from fabrication.drawings.room import Stroke
from fabrication.drawings.sheet import Dimension, Item, Path, Point, Text
from fabrication.drawings.views import shown

Way: TypeAlias = Literal["along", "across", "up"]
Side: TypeAlias = Literal["above", "below", "left", "right"]

TOWARD: dict[str, Point] = {
    "above": (0.0, 1.0), "below": (0.0, -1.0), "left": (-1.0, 0.0), "right": (1.0, 0.0),
}  # fmt: skip
"""Direction on paper of each side of a view."""


@dataclass(frozen=True)
class Length:
    """A distance between two points of the part.

    way : "along" the line between them; "across" or "up": of the view, as the points lie there
    side : where the dimension line is: "out", away from the middle of the part, or to one side of
        it; "on": from point to point, on the part
    first : how far from the outline the first dimension line is tried, in lines
    """

    name: str
    start: Vec
    end: Vec
    way: Way = "along"
    side: Side | Literal["out", "on"] = "out"
    prefix: str = ""
    suffix: str = ""
    first: int = 0

    def place(self, view: PlacedView) -> None:
        """Where it costs least: over the line, or beside it where that is short."""
        p, q = view.at(self.start), view.at(self.end)
        value = self.value(view)
        ux, uy = self._direction(p, q)
        ahead = (q[0] - p[0]) * ux + (q[1] - p[1]) * uy
        if ahead < 0.0:
            p, q, ahead = q, p, -ahead
        label = f"{self.prefix}{shown(value, MM_PLACES)}{self.suffix}"
        best = view.best(self._candidates(view, p, q, (ux, uy), label))
        feet = (p, (p[0] + ahead * ux, p[1] + ahead * uy))
        true = not view.crosses_break(p, q)
        view.add_dimension(Dimension(self.name, value, best.text, best.draw(), feet, true))

    def value(self, view: PlacedView) -> float:
        """The distance [mm] in the part itself."""
        between = (
            self.end[0] - self.start[0], self.end[1] - self.start[1], self.end[2] - self.start[2],
        )  # fmt: skip
        if self.way == "along":
            return math.hypot(*between)
        return abs(view.way(between)[0 if self.way == "across" else 1])

    def _direction(self, p: Point, q: Point) -> Point:
        if self.way == "across":
            return (1.0, 0.0)
        if self.way == "up":
            return (0.0, 1.0)
        size = math.hypot(q[0] - p[0], q[1] - p[1]) or 1.0
        return ((q[0] - p[0]) / size, (q[1] - p[1]) / size)

    def _normal(self, view: PlacedView, p: Point, q: Point, way: Point) -> Point:
        """Unit direction from the part to the dimension line."""
        if self.way != "along" and self.side in TOWARD:
            return TOWARD[self.side]
        nx, ny = -way[1], way[0]
        middle = (0.5 * (view.low[0] + view.high[0]), 0.5 * (view.low[1] + view.high[1]))
        out = (0.5 * (p[0] + q[0]) - middle[0]) * nx + (0.5 * (p[1] + q[1]) - middle[1]) * ny
        if self.side in TOWARD:
            out = TOWARD[self.side][0] * nx + TOWARD[self.side][1] * ny
        return (nx, ny) if out >= 0.0 else (-nx, -ny)

    def _candidates(
        self, view: PlacedView, p: Point, q: Point, way: Point, label: str
    ) -> Iterator[Candidate]:
        if self.side == "on":
            yield from _on(p, q, way, label)
            return
        normal = self._normal(view, p, q, way)
        nx, ny = normal
        base = max(p[0] * nx + p[1] * ny, q[0] * nx + q[1] * ny)
        if self.way != "along":
            base = max(base, view.reach(normal))
        for row in range(self.first, self.first + ROWS):
            level = base + FIRST + NEXT * row
            yield from _between(p, q, way, normal, level, label, 0.5 * (row - self.first))


def _on(p: Point, q: Point, way: Point, label: str) -> Iterator[Candidate]:
    """Along the line itself, above it."""
    length = math.hypot(q[0] - p[0], q[1] - p[1])
    angle = readable(math.atan2(way[1], way[0]))
    lines: tuple[Stroke, ...] = ((p, q),)

    def draw() -> tuple[Item, ...]:
        return (Path((p, q), "thin"), arrow(p, -way[0], -way[1]), arrow(q, *way))

    for s in (0.3, 0.7, 0.25, 0.75, 0.35, 0.65, 0.2, 0.8, 0.4, 0.6, 0.5, 0.15, 0.85):
        x, y = p[0] + s * length * way[0], p[1] + s * length * way[1]
        for lift in (ABOVE, -ABOVE - LEAST):
            at = (x - lift * math.sin(angle), y + lift * math.cos(angle))
            yield Candidate(Text(at, label, LEAST, "center", angle), (), lines, draw)


def _between(
    p: Point, q: Point, way: Point, normal: Point, level: float, label: str, dislike: float
) -> Iterator[Candidate]:
    """A dimension line at a level along a normal, its text over it or beside it."""
    (ux, uy), (nx, ny) = way, normal

    def on_line(point: Point) -> Point:
        lift = level - (point[0] * nx + point[1] * ny)
        return (point[0] + lift * nx, point[1] + lift * ny)

    a, b = on_line(p), on_line(q)
    length = math.hypot(b[0] - a[0], b[1] - a[1])
    angle = readable(math.atan2(uy, ux))
    extensions = tuple(extension(foot, end, normal) for foot, end in ((p, a), (q, b)))
    lifted = (-ABOVE * math.sin(angle), ABOVE * math.cos(angle))
    wide = Text((0.0, 0.0), label).width
    inside = length >= 2.0 * ARROW + 1.0
    reach = 0.0 if inside else ARROW + 2.5
    line: Stroke = ((a[0] - reach * ux, a[1] - reach * uy), (b[0] + reach * ux, b[1] + reach * uy))

    def draw(*lines: Stroke) -> tuple[Item, ...]:
        sense = 1.0 if inside else -1.0
        heads = (arrow(a, -sense * ux, -sense * uy), arrow(b, sense * ux, sense * uy))
        return (*(Path(stroke, "thin") for stroke in (*extensions, *lines)), *heads)

    if wide + 1.5 <= length:
        for s in (0.5, 0.35, 0.65, 0.25, 0.75):
            if min(s, 1.0 - s) * length < 0.5 * wide + 0.5:
                continue
            x, y = a[0] + s * length * ux, a[1] + s * length * uy
            text = Text((x + lifted[0], y + lifted[1]), label, LEAST, "center", angle)
            cost = dislike + abs(s - 0.5)
            yield Candidate(text, extensions, (line,), partial(draw, line), cost)
        return
    for sign, end in ((1.0, b), (-1.0, a)):
        start = ARROW + 1.0 if not inside else 1.0
        far = start + wide + 1.0
        tail: Stroke = (end, (end[0] + sign * far * ux, end[1] + sign * far * uy))
        middle = start + 0.5 * wide + 0.3
        x, y = end[0] + sign * middle * ux, end[1] + sign * middle * uy
        text = Text((x + lifted[0], y + lifted[1]), label, LEAST, "center", angle)
        cost = dislike + 0.2 * (sign < 0.0)
        yield Candidate(text, extensions, (line, tail), partial(draw, line, tail), cost)


def extension(foot: Point, end: Point, normal: Point) -> Stroke:
    """The line from beside a point of the part to beyond the dimension line."""
    nx, ny = normal
    return (
        (foot[0] + FOOT * nx, foot[1] + FOOT * ny),
        (end[0] + OVER * nx, end[1] + OVER * ny),
    )

"""Dimensions and notes: what a shape measures, and how it is drawn (ISO 129-1)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, Literal

from fabrication.boundary import Vec
from fabrication.drawings.lettering import LEAST
from fabrication.drawings.placing import Candidate, PlacedView
from fabrication.drawings.room import Stroke
from fabrication.drawings.sheet import Arc, Dimension, Fill, Item, Path, Point, Text
from fabrication.drawings.views import shown

ARROW: Final = 2.5
"""Length of an arrowhead [mm]."""

NARROW: Final = 0.4
"""Half of its width [mm]."""

FIRST: Final = 8.0
"""From the outline to the first dimension line [mm]."""

NEXT: Final = 6.5
"""From one dimension line to the next [mm]."""

ROWS: Final = 7
"""So many dimension lines are tried."""

FOOT: Final = 1.0
"""From the outline to the extension line [mm]."""

OVER: Final = 1.5
"""How far an extension line reaches beyond the dimension line [mm]."""

ABOVE: Final = 1.1
"""From a dimension line to the text over it [mm]."""

MM_PLACES: Final = 1
DEG_PLACES: Final = 2


def arrow(tip: Point, ux: float, uy: float) -> Fill:
    """An arrowhead whose tip is at a point, pointing along a unit direction."""
    x, y = tip
    bx, by = x - ARROW * ux, y - ARROW * uy
    return Fill((tip, (bx - NARROW * uy, by + NARROW * ux), (bx + NARROW * uy, by - NARROW * ux)))


def readable(angle: float) -> float:
    """The angle [rad] of a text along a direction, to be read from below or from the right."""
    angle = math.remainder(angle, 2.0 * math.pi)
    if angle <= -0.5 * math.pi + 1e-6:
        return angle + math.pi
    return angle - math.pi if angle > 0.5 * math.pi + 1e-6 else angle


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
    way: Literal["along", "across", "up"] = "along"
    side: Literal["out", "above", "below", "left", "right", "on"] = "out"
    prefix: str = ""
    suffix: str = ""
    first: int = 0

    def place(self, view: PlacedView) -> None:
        """Where it costs least: over the line, or beside it where that is short."""
        p, q = view.at(self.start), view.at(self.end)
        value = self.value(view)
        ux, uy = self._direction(p, q)
        if (q[0] - p[0]) * ux + (q[1] - p[1]) * uy < 0.0:
            p, q = q, p
        label = f"{self.prefix}{shown(value, MM_PLACES)}{self.suffix}"
        best = view.best(self._candidates(view, p, q, (ux, uy), label))
        true = not view.crosses_break(p, q)
        view.add_dimension(Dimension(self.name, value, best.text, best.items, (p, q), true))

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
        fixed = {"above": (0.0, 1.0), "below": (0.0, -1.0), "left": (-1.0, 0.0)}
        fixed["right"] = (1.0, 0.0)
        if self.way != "along" and self.side in fixed:
            return fixed[self.side]
        nx, ny = -way[1], way[0]
        middle = (0.5 * (view.low[0] + view.high[0]), 0.5 * (view.low[1] + view.high[1]))
        out = (0.5 * (p[0] + q[0]) - middle[0]) * nx + (0.5 * (p[1] + q[1]) - middle[1]) * ny
        if self.side in fixed:
            out = fixed[self.side][0] * nx + fixed[self.side][1] * ny
        return (nx, ny) if out >= 0.0 else (-nx, -ny)

    def _candidates(
        self, view: PlacedView, p: Point, q: Point, way: Point, label: str
    ) -> Iterator[Candidate]:
        if self.side == "on":
            yield from self._on(p, q, way, label)
            return
        normal = self._normal(view, p, q, way)
        nx, ny = normal
        base = max(p[0] * nx + p[1] * ny, q[0] * nx + q[1] * ny)
        if self.way != "along":
            edges = (view.low, view.high)
            base = max(base, *(x * abs(nx) * (1 if nx > 0 else -1) + y * ny for x, y in edges))
        for row in range(self.first, self.first + ROWS):
            level = base + FIRST + NEXT * row
            yield from _between(p, q, way, normal, level, label, 0.5 * (row - self.first))

    def _on(self, p: Point, q: Point, way: Point, label: str) -> Iterator[Candidate]:
        """Along the line itself, above it."""
        length = math.hypot(q[0] - p[0], q[1] - p[1])
        angle = readable(math.atan2(way[1], way[0]))
        items: tuple[Item, ...] = (
            Path((p, q), "thin"), arrow(p, -way[0], -way[1]), arrow(q, *way),
        )  # fmt: skip
        for s in (0.3, 0.7, 0.25, 0.75, 0.35, 0.65, 0.2, 0.8, 0.4, 0.6, 0.5, 0.15, 0.85):
            x, y = p[0] + s * length * way[0], p[1] + s * length * way[1]
            for lift in (ABOVE, -ABOVE - LEAST):
                at = (x - lift * math.sin(angle), y + lift * math.cos(angle))
                yield Candidate(Text(at, label, LEAST, "center", angle), (), items)


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
    extensions: list[Stroke] = []
    for foot, end in ((p, a), (q, b)):
        extensions.append(
            (
                (foot[0] + FOOT * nx, foot[1] + FOOT * ny),
                (end[0] + OVER * nx, end[1] + OVER * ny),
            )
        )
    lifted = (-ABOVE * math.sin(angle), ABOVE * math.cos(angle))
    wide = Text((0.0, 0.0), label).width
    inside = length >= 2.0 * ARROW + 1.0
    if inside:
        line: Stroke = (a, b)
        arrows = (arrow(a, -ux, -uy), arrow(b, ux, uy))
    else:
        reach = ARROW + 2.5
        line = ((a[0] - reach * ux, a[1] - reach * uy), (b[0] + reach * ux, b[1] + reach * uy))
        arrows = (arrow(a, ux, uy), arrow(b, -ux, -uy))
    drawn = [Path(stroke, "thin") for stroke in (*extensions, line)]
    if wide + 1.5 <= length:
        for s in (0.5, 0.35, 0.65, 0.25, 0.75):
            if min(s, 1.0 - s) * length < 0.5 * wide + 0.5:
                continue
            x, y = a[0] + s * length * ux, a[1] + s * length * uy
            text = Text((x + lifted[0], y + lifted[1]), label, LEAST, "center", angle)
            strokes = (*extensions, line)
            yield Candidate(text, strokes, (*drawn, *arrows), dislike + abs(s - 0.5))
        return
    for sign, end in ((1.0, b), (-1.0, a)):
        start = ARROW + 1.0 if not inside else 1.0
        far = start + wide + 1.0
        tail: Stroke = (end, (end[0] + sign * far * ux, end[1] + sign * far * uy))
        middle = start + 0.5 * wide + 0.3
        x, y = end[0] + sign * middle * ux, end[1] + sign * middle * uy
        text = Text((x + lifted[0], y + lifted[1]), label, LEAST, "center", angle)
        items: tuple[Item, ...] = (*drawn, Path(tail, "thin"), *arrows)
        yield Candidate(text, (*extensions, line, tail), items, dislike + 0.2 * (sign < 0.0))


@dataclass(frozen=True)
class Angle:
    """An angle at a point between two directions of the part, as seen.

    value_deg : what is written, with its sign where `signed`
    inside : whether the text is between the directions; else beyond the arc
    """

    name: str
    at: Vec
    first: Vec
    second: Vec
    value_deg: float
    signed: bool = False
    prefix: str = ""

    def place(self, view: PlacedView) -> None:
        """An arc with arrowheads, and the text near its middle."""
        corner = view.at(self.at)
        one, two = (math.atan2(*reversed(view.way(way))) for way in (self.first, self.second))
        turn = math.remainder(two - one, 2.0 * math.pi)
        start, end = (one, one + turn) if turn >= 0.0 else (two, two - turn)
        sign = "+" if self.signed and self.value_deg > 0.0 else ""
        label = f"{self.prefix}{sign}{shown(self.value_deg, DEG_PLACES)}°"
        best = view.best(self._candidates(corner, start, end, label))
        away = (math.cos(start), math.sin(start)), (math.cos(end), math.sin(end))
        feet = (corner, *((corner[0] + x, corner[1] + y) for x, y in away))
        view.add_dimension(Dimension(self.name, self.value_deg, best.text, best.items, feet))

    def _candidates(
        self, corner: Point, start: float, end: float, label: str
    ) -> Iterator[Candidate]:
        middle = 0.5 * (start + end)
        height = LEAST
        for step in range(12):
            radius = 7.0 + 2.5 * step
            drawn = self._arc(corner, radius, start, end)
            for turn in (0.0, 0.15, -0.15, 0.3, -0.3):
                at_angle = middle + turn * (end - start)
                far = radius + 2.0 + abs(math.cos(at_angle)) * 0.5 * Text((0, 0), label).width
                x = corner[0] + far * math.cos(at_angle)
                y = corner[1] + far * math.sin(at_angle) - 0.5 * height
                text = Text((x, y), label, height, "center")
                yield Candidate(text, (), drawn, 0.05 * step + 0.05 * abs(turn))

    def _arc(self, corner: Point, radius: float, start: float, end: float) -> tuple[Item, ...]:
        arc = Arc(corner, radius, start, end, "thin")
        if radius * (end - start) < 2.5 * ARROW:
            return (arc,)
        lean = 0.5 * ARROW / radius
        heads = []
        for angle, sense in ((start, -1.0), (end, 1.0)):
            along = angle + sense * (0.5 * math.pi - lean)
            heads.append(arrow(arc.at(angle), math.cos(along), math.sin(along)))
        return (arc, *heads)


@dataclass(frozen=True)
class Note:
    """A text that a line leads from to a point of the part.

    name, value : of a dimension that it is, "" and 0 for a remark
    toward : direction of the part in which the text is tried first
    """

    text: str
    at: Vec
    name: str = ""
    value: float = 0.0
    toward: Vec | None = None
    dot: bool = False

    def place(self, view: PlacedView) -> None:
        """Around the point, the nearest free place."""
        best = view.best(self._candidates(view))
        if self.name:
            view.add_dimension(Dimension(self.name, self.value, best.text, best.items, (), False))
            return
        for item in best.items:
            view.add_item(item)
        view.add_text(best.text)

    def _candidates(self, view: PlacedView) -> Iterator[Candidate]:
        point = view.at(self.at)
        wanted = 0.25 * math.pi
        if self.toward is not None:
            x, y = view.way(self.toward)
            wanted = math.atan2(y, x)
        wide = Text((0.0, 0.0), self.text).width
        for step in range(11):
            reach = 7.0 + 4.0 * step
            for k in range(12):
                turn = (k + 1) // 2 * (1 if k % 2 else -1) * math.pi / 6.0
                angle = wanted + turn
                ux, uy = math.cos(angle), math.sin(angle)
                elbow = (point[0] + reach * ux, point[1] + reach * uy)
                sense = 1.0 if ux >= 0.0 else -1.0
                end = (elbow[0] + sense * (wide + 1.0), elbow[1])
                at = (elbow[0] + 0.5 * sense * (wide + 1.0), elbow[1] + ABOVE)
                head: Item = arrow(point, -ux, -uy)
                if self.dot:
                    head = _dot(point)
                strokes: tuple[Stroke, ...] = ((point, elbow), (elbow, end))
                items = (Path((point, elbow, end), "thin"), head)
                text = Text(at, self.text, LEAST, "center")
                yield Candidate(text, strokes, items, 0.4 * step + 0.25 * abs(turn))


def _dot(point: Point) -> Fill:
    """A small disc."""
    turns = (math.pi / 6.0 * k for k in range(12))
    return Fill(tuple((point[0] + 0.5 * math.cos(t), point[1] + 0.5 * math.sin(t)) for t in turns))


@dataclass(frozen=True)
class Label:
    """A text beside a point of the part, without a line.

    along : direction of the part that the text is parallel to; None: level
    toward : direction from the point to the text
    """

    text: str
    at: Vec
    toward: Vec
    along: Vec | None = None
    height: float = LEAST
    bold: bool = False
    slide: float = 0.0

    def place(self, view: PlacedView) -> None:
        """As near as may be; along the direction up to `slide` [mm of the part] to either side."""
        view.add_text(view.best(self._candidates(view)).text)

    def _candidates(self, view: PlacedView) -> Iterator[Candidate]:
        x, y = view.at(self.at)
        tx, ty = view.way(self.toward)
        size = math.hypot(tx, ty) or 1.0
        tx, ty = tx / size, ty / size
        angle, ax, ay = 0.0, 0.0, 0.0
        if self.along is not None:
            ax, ay = view.way(self.along)
            long = math.hypot(ax, ay) or 1.0
            ax, ay = ax / long, ay / long
            angle = readable(math.atan2(ay, ax))
        wide = Text((0.0, 0.0), self.text, self.height, bold=self.bold).width
        c, s = math.cos(angle), math.sin(angle)
        reach = 0.5 * (wide * abs(tx * c + ty * s) + self.height * abs(ty * c - tx * s))
        for step in range(12):
            far = 1.5 + reach + 1.5 * step
            for part in (0.0, 0.25, -0.25, 0.5, -0.5, 0.75, -0.75, 1.0, -1.0):
                shift = part * self.slide * view.scale
                if part and not shift:
                    continue
                cx, cy = x + far * tx + shift * ax, y + far * ty + shift * ay
                at = (cx + 0.5 * self.height * s, cy - 0.5 * self.height * c)
                text = Text(at, self.text, self.height, "center", angle, self.bold)
                yield Candidate(text, (), (), 0.2 * step + 0.1 * abs(part))


@dataclass(frozen=True)
class Ray:
    """A chain line from a point in a direction, some way beyond the part [mm on paper]."""

    at: Vec
    direction: Vec
    length: float
    beyond: float = 6.0

    def place(self, view: PlacedView) -> None:
        """Where it is."""
        x, y = view.at(self.at)
        dx, dy = view.way(self.direction)
        size = math.hypot(dx, dy) or 1.0
        reach = self.length * view.scale * size + self.beyond
        end = (x + reach * dx / size, y + reach * dy / size)
        view.add_item(Path(((x, y), end), "chain"))

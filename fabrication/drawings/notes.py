"""Notes and labels: texts at a point of the part, with a line to it or without; center lines."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from fabrication.boundary import Vec
from fabrication.drawings.lettering import LEAST
from fabrication.drawings.marks import ABOVE, arrow, dot, readable
from fabrication.drawings.placing import Candidate, PlacedView
from fabrication.drawings.room import Stroke
from fabrication.drawings.sheet import Dimension, Item, Path, Point, Text


@dataclass(frozen=True)
class Note:
    """A text that a line leads from to a point of the part.

    value : of a dimension that it is; None for a remark
    toward : direction of the part in which the text is tried first
    dotted : whether the line ends on the part, in a dot, not at an edge
    across : the two points of the part that the value is measured between
    """

    text: str
    at: Vec
    name: str = ""
    value: float | None = None
    toward: Vec | None = None
    dotted: bool = False
    across: tuple[Vec, Vec] | None = None

    def place(self, view: PlacedView) -> None:
        """Around the point, the nearest free place."""
        best = view.best(self._candidates(view))
        if self.value is not None:
            feet = tuple(view.at(point) for point in self.across or ())
            true = len(feet) > 1 and not view.crosses_break(*feet)
            view.add_dimension(Dimension(self.name, self.value, best.text, best.draw(), feet, true))
            return
        for item in best.draw():
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
                strokes: tuple[Stroke, ...] = ((point, elbow), (elbow, end))

                def draw(
                    elbow: Point = elbow, end: Point = end, way: Point = (-ux, -uy)
                ) -> tuple[Item, ...]:
                    head = dot(point) if self.dotted else arrow(point, *way)
                    return (Path((point, elbow, end), "thin"), head)

                text = Text(at, self.text, LEAST, "center")
                yield Candidate(text, strokes, (), draw, 0.4 * step + 0.25 * abs(turn))


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
                yield Candidate(text, dislike=0.2 * step + 0.1 * abs(part))


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

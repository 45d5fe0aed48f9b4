"""A view at a scale: the edges of the part on paper, and the room that is left for texts."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple

from ddgfab.mesh import Floats
from fabrication.boundary import Vec
from fabrication.drawings.lettering import LEAST
from fabrication.drawings.projection import Curve
from fabrication.drawings.room import GOOD, LINE_ON_TEXT, Room, Stroke, strokes_of
from fabrication.drawings.sheet import Arc, Dimension, Item, Path, Pen, Point, Text
from fabrication.drawings.views import View

GAP: Final = 5.0
"""Room [mm] on paper between the two ends of a part that is shown without its middle."""

CENTER: Final = 2.0
"""How far [mm] center lines reach beyond their circle."""


@dataclass(frozen=True)
class Break:
    """What is left out of a long part: from where to where along the view's right [mm]."""

    first: float
    last: float


@dataclass(frozen=True, eq=False)
class Projected:
    """A view before it has a scale: its axes (3, 3), curves, and their bounds [mm]."""

    view: View
    axes: Floats
    curves: tuple[Curve, ...]
    low: Point
    high: Point


def view_basis(projected: Projected) -> tuple[Vec, Vec]:
    """What points to the right and up on paper, as plain numbers."""
    (a, b, c), (d, e, f), _ = projected.axes.tolist()
    return (a, b, c), (d, e, f)


def _nothing() -> tuple[Item, ...]:
    return ()


class Candidate(NamedTuple):
    """One way to show something.

    strokes : its lines that may lie on other lines: extension lines, leaders
    lines : those that may not: dimension lines
    draw : gives the items beside the text
    dislike : what it costs beside what it lies on
    """

    text: Text
    strokes: tuple[Stroke, ...] = ()
    lines: tuple[Stroke, ...] = ()
    draw: Callable[[], tuple[Item, ...]] = _nothing
    dislike: float = 0.0


class PlacedView:
    """A view on paper, its projected origin at (0, 0), while it is being filled."""

    def __init__(self, projected: Projected, scale: float, cut: Break | None = None) -> None:
        self.view, self.scale, self.cut = projected.view, scale, cut
        self._right, self._up = view_basis(projected)
        self.room = Room()
        self.outlines: list[Item] = []
        self.items: list[Item] = []
        self.dimensions: list[Dimension] = []
        self.crowded = 0
        self.low = self._paper(*projected.low)
        self.high = self._paper(*projected.high)
        for curve in sorted(projected.curves, key=lambda c: c.visible):
            self._draw(curve)
        if cut is not None:
            self._break_lines()

    # --- where things are --------------------------------------------------------------------
    def _paper(self, u: float, v: float) -> Point:
        """A point of the view's plane [mm] on paper."""
        if self.cut is not None and u > self.cut.first:
            away = self.cut.last - self.cut.first
            if u >= self.cut.last:
                return ((u - away) * self.scale + GAP, v * self.scale)
            part = (u - self.cut.first) / away
            return (self.cut.first * self.scale + part * GAP, v * self.scale)
        return (u * self.scale, v * self.scale)

    def at(self, point: Vec) -> Point:
        """A point of the part on paper."""
        return self._paper(*self.way(point))

    def way(self, direction: Vec) -> Point:
        """A direction of the part on paper, in the part's own size."""
        x, y, z = direction
        (a, b, c), (d, e, f) = self._right, self._up
        return (a * x + b * y + c * z, d * x + e * y + f * z)

    def reach(self, normal: Point) -> float:
        """How far [mm] the part reaches on paper along a direction."""
        nx, ny = normal
        (x0, y0), (x1, y1) = self.low, self.high
        return max(x0 * nx, x1 * nx) + max(y0 * ny, y1 * ny)

    def crosses_break(self, *points: Point) -> bool:
        """Whether the middle that is left out lies between points on paper."""
        if self.cut is None:
            return False
        edge = self.cut.first * self.scale + 0.5 * GAP
        sides = {point[0] > edge for point in points}
        return len(sides) > 1

    # --- the part itself ---------------------------------------------------------------------
    def _draw(self, curve: Curve) -> None:
        pen: Pen = "outline" if curve.visible else "hidden"
        if not curve.visible and not self.view.hidden:
            return
        if curve.circle is not None:
            u, v, radius, start, end = curve.circle
            self._add_edge(Arc(self._paper(u, v), radius * self.scale, start, end, pen))
            return
        points = curve.points.tolist()
        cut = self.cut
        runs = [points]
        if cut is not None:
            runs = [run for side in _sides(points, cut) for run in side]
        for run in runs:
            if len(run) > 1:
                self._add_edge(Path(tuple(self._paper(u, v) for u, v in run), pen))

    def _add_edge(self, item: Item) -> None:
        self.outlines.append(item)
        self.room.add_outline(strokes_of(item))

    def _break_lines(self) -> None:
        """Zigzags where the part is broken off."""
        assert self.cut is not None
        left = self.cut.first * self.scale
        low, high = self.low[1] - 2.0, self.high[1] + 2.0
        middle = 0.5 * (low + high)
        for x in (left, left + GAP):
            points = (
                (x, low), (x, middle - 1.5), (x - 1.0, middle - 0.75),
                (x + 1.0, middle + 0.75), (x, middle + 1.5), (x, high),
            )  # fmt: skip
            self.add_item(Path(points, "thin"))

    # --- what is added -----------------------------------------------------------------------
    def add_item(self, item: Item) -> None:
        """A line that texts avoid."""
        self.items.append(item)
        self.room.add_lines(strokes_of(item))

    def add_text(self, text: Text) -> None:
        """A text that stands where it is."""
        self.items.append(text)
        self.room.add_text(text)

    def add_dimension(self, dimension: Dimension) -> None:
        """A dimension that stands where it is."""
        self.dimensions.append(dimension)
        self.room.add_text(dimension.text)
        for item in dimension.items:
            self.room.add_lines(strokes_of(item))

    def best(self, candidates: Iterable[Candidate]) -> Candidate:
        """The candidate that costs least; the first one that costs nothing."""
        chosen: Candidate | None = None
        least = math.inf
        known: dict[tuple[tuple[Stroke, ...], tuple[Stroke, ...]], float] = {}
        for candidate in candidates:
            if candidate.dislike >= least:
                continue
            cost = candidate.dislike
            cost += self.room.cost(candidate.text, least - cost)
            if cost >= least:
                continue
            own = (candidate.strokes, candidate.lines)
            if own not in known:
                known[own] = self.room.cost_of_lines(own[1], least - cost, alone=True)
                known[own] += self.room.cost_of_lines(own[0], least - cost, alone=False)
            cost += known[own]
            if cost < least:
                chosen, least = candidate, cost
            if cost - candidate.dislike < GOOD:
                break
        assert chosen is not None
        self.crowded += least - chosen.dislike >= LINE_ON_TEXT
        return chosen

    def center_lines(self) -> None:
        """Crosses of chain lines at circles."""
        seen: dict[tuple[int, int], tuple[Point, float]] = {}
        for item in self.outlines:
            circle = item.circle()
            if circle is not None:
                (x, y), radius = circle
                key = (round(20.0 * x), round(20.0 * y))
                seen[key] = ((x, y), max(radius, seen.get(key, ((x, y), 0.0))[1]))
        for (x, y), radius in seen.values():
            reach = radius + CENTER
            self.add_item(Path(((x - reach, y), (x + reach, y)), "chain"))
            self.add_item(Path(((x, y - reach), (x, y + reach)), "chain"))

    def add_title(self) -> None:
        """The view's name below all that it shows."""
        (x0, y0), (x1, _) = self.extent()
        text = Text(
            (0.5 * (x0 + x1), y0 - 2.0 - LEAST), self.view.title, LEAST, "center", bold=True
        )
        self.items.append(text)

    @cached_property
    def whole(self) -> tuple[Point, Point]:
        """The rectangle round everything that is drawn, when nothing more is added."""
        return self.extent()

    def extent(self) -> tuple[Point, Point]:
        """The rectangle round everything that is drawn so far."""
        drawn = [*self.outlines, *self.items]
        drawn += [item for dimension in self.dimensions for item in dimension.parts()]
        points = [point for item in drawn for point in item.extent()] or [(0.0, 0.0)]
        xs, ys = [p[0] for p in points], [p[1] for p in points]
        return (min(xs), min(ys)), (max(xs), max(ys))


def _sides(points: Sequence[Sequence[float]], cut: Break) -> list[list[list[Sequence[float]]]]:
    """What of a line is before a break, and what behind it."""
    before: list[list[Sequence[float]]] = [[]]
    behind: list[list[Sequence[float]]] = [[]]
    for k, point in enumerate(points):
        if k:
            last = points[k - 1]
            for limit in sorted((cut.first, cut.last), reverse=last[0] > point[0]):
                if (last[0] < limit) != (point[0] < limit) and last[0] != point[0]:
                    s = (limit - last[0]) / (point[0] - last[0])
                    between = (limit, last[1] + s * (point[1] - last[1]))
                    (before if limit == cut.first else behind)[-1].append(between)
        if point[0] <= cut.first:
            before[-1].append(point)
        elif point[0] >= cut.last:
            behind[-1].append(point)
    return [before, behind]

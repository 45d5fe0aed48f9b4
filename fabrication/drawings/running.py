"""Running dimensions (ISO 129-1): distances from one origin, or angles about one point."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final, Literal

from fabrication.boundary import Vec
from fabrication.drawings.lengths import TOWARD, Side
from fabrication.drawings.lettering import BELOW, LEAST
from fabrication.drawings.marks import (
    DEG_PLACES,
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
from fabrication.drawings.sheet import Arc, Dimension, Item, Path, Point, Text
from fabrication.drawings.views import shown

ORIGIN: Final = 1.0
"""Radius [mm] of the circle at the origin."""

APART: Final = LEAST * (1.0 + BELOW) + 1.0
"""From one text to the next [mm]."""

KNEE: Final = 4.0
"""Length [mm] over which an extension line leads to a text that had to be moved aside."""


@dataclass(frozen=True)
class Running:
    """Distances of points from an origin along the view's right or up.

    points : name and point; the names are as those of `Dimension`
    """

    origin: Vec
    points: tuple[tuple[str, Vec], ...]
    way: Literal["across", "up"] = "across"
    side: Side = "below"
    first: int = 0

    def place(self, view: PlacedView) -> None:
        """On the first dimension line where all texts find room."""
        k = 0 if self.way == "across" else 1
        feet: dict[float, tuple[str, Vec]] = {}
        seen: set[float] = {0.0}
        for name, point in self.points:
            away = (
                point[0] - self.origin[0], point[1] - self.origin[1], point[2] - self.origin[2],
            )  # fmt: skip
            value = view.way(away)[k]
            if round(value, 6) + 0.0 not in seen:
                seen.add(round(value, 6))
                feet[value] = (name, point)
        if not feet:
            return
        normal = TOWARD[self.side]
        base = view.reach(normal)
        tried = [
            self._at(view, feet, base + FIRST + NEXT * row, k)
            for row in range(self.first, self.first + ROWS)
        ]
        costs = []
        for row, found in enumerate(tried):
            costs.append(0.5 * row + sum(view.room.cost(d.text) for d in found))
            if costs[-1] - 0.5 * row < 1.0:
                break
        best = tried[costs.index(min(costs))]
        view.crowded += min(costs) >= 100.0
        for dimension in best:
            view.add_dimension(dimension)
        start = view.at(self.origin)
        (nx, ny), level = normal, base + FIRST + NEXT * (self.first + costs.index(min(costs)))
        lift = level - start[0] * nx - start[1] * ny
        on_line = (start[0] + lift * nx, start[1] + lift * ny)
        foot = (start[0] + FOOT * nx, start[1] + FOOT * ny)
        near = (on_line[0] - ORIGIN * nx, on_line[1] - ORIGIN * ny)
        view.add_item(Arc(on_line, ORIGIN, 0.0, 2.0 * math.pi, "thin"))
        view.add_item(Path((foot, near), "thin"))

    def _at(
        self, view: PlacedView, feet: dict[float, tuple[str, Vec]], level: float, k: int
    ) -> list[Dimension]:
        """All dimensions with their line at a level."""
        nx, ny = normal = TOWARD[self.side]
        start = view.at(self.origin)
        angle = readable(math.atan2(ny, nx))
        values = sorted(feet)
        points = [view.at(feet[value][1]) for value in values]
        texts = spread([point[k] for point in points], APART)
        ends = [start[k], *(point[k] for point in points)]
        found = []
        for value, point, at in zip(values, points, texts, strict=True):
            label = shown(abs(value), MM_PLACES)
            lift = level - (point[0] * nx + point[1] * ny)
            end = (point[0] + lift * nx, point[1] + lift * ny)
            knee = _moved(end, normal, OVER)
            if abs(at - point[k]) > 1e-9:
                last = _moved(knee, normal, KNEE)
                last = (at, last[1]) if k == 0 else (last[0], at)
                leader: tuple[Point, ...] = (_moved(point, normal, FOOT), knee, last)
            else:
                last = knee
                leader = (_moved(point, normal, FOOT), knee)
            middle = _moved(last, normal, 0.8 + 0.5 * Text((0.0, 0.0), label).width)
            low = (
                middle[0] + 0.5 * LEAST * math.sin(angle),
                middle[1] - 0.5 * LEAST * math.cos(angle),
            )
            sense = 1.0 if value > 0.0 else -1.0
            before = max(
                (e for e in ends if sense * (point[k] - e) > 1e-9), key=lambda e: sense * e
            )
            begin = (before, end[1]) if k == 0 else (end[0], before)
            heading = (sense, 0.0) if k == 0 else (0.0, sense)
            items: tuple[Item, ...] = (
                Path(leader, "thin"), Path((begin, end), "thin"), arrow(end, *heading),
            )  # fmt: skip
            name = feet[value][0]
            foot = (point[0], start[1]) if k == 0 else (start[0], point[1])
            true = not view.crosses_break(start, point)
            text = Text(low, label, LEAST, "center", angle)
            found.append(Dimension(name, abs(value), text, items, (start, foot), true))
        return found


def _moved(point: Point, normal: Point, far: float) -> Point:
    return (point[0] + far * normal[0], point[1] + far * normal[1])


def spread(places: Sequence[float], apart: float) -> list[float]:
    """Sorted places, moved as little as may be so that they are so far apart.

    >>> spread([0.0, 1.0, 10.0], 3.0)
    [-1.0, 2.0, 10.0]
    """
    groups: list[tuple[float, int]] = []  # middle of a run of places, and how many
    for place in places:
        groups.append((place, 1))
        while len(groups) > 1:
            (a, m), (b, n) = groups[-2:]
            if b - a >= 0.5 * (m + n) * apart - 1e-12:
                break
            groups[-2:] = [((m * a + n * b) / (m + n), m + n)]
    return [
        middle + (k - 0.5 * (count - 1)) * apart for middle, count in groups for k in range(count)
    ]


@dataclass(frozen=True)
class Arm:
    """A direction about the center of a plan.

    azimuth : [rad], as the sheet shows it
    name : of the dimension of the azimuth
    reach : from the center, of the part in this direction [mm]
    more : further dimensions that stand below the azimuth: name, value, text, and for a distance
        from the center its size [mm]
    """

    name: str
    label: str
    azimuth: float
    reach: float
    more: tuple[tuple[str, float, str, float | None], ...] = ()


@dataclass(frozen=True)
class Azimuths:
    """Directions about z from the x axis, as seen from above: rays, one arc, and their values."""

    center: Vec
    arms: tuple[Arm, ...]
    radius: float

    def place(self, view: PlacedView) -> None:
        """Rays beyond the part, the arc beside it, texts at the ends of the rays."""
        center, scale = view.at(self.center), view.scale
        round_ = self.radius * scale + 5.0
        for arm in self.arms:
            tip = _polar(center, max(round_, arm.reach * scale) + 4.0, arm.azimuth)
            view.add_item(Path((center, tip), "chain"))
        turns = sorted(arm.azimuth % (2.0 * math.pi) for arm in self.arms)
        if turns[-1] > 1e-9:
            view.add_item(Arc(center, round_, 0.0, turns[-1], "thin"))
        view.add_item(Arc(_polar(center, round_, 0.0), ORIGIN, 0.0, 2.0 * math.pi, "thin"))
        for arm in self.arms:
            self._label(view, arm, center, max(round_, arm.reach * scale) + 4.0)

    def _label(self, view: PlacedView, arm: Arm, center: Point, far: float) -> None:
        degrees = math.degrees(arm.azimuth)
        label = f"{arm.label} {shown(degrees, DEG_PLACES)}°"
        lines = [label, *(text for _, _, text, _ in arm.more)]
        wide = max(Text((0.0, 0.0), line).width for line in lines)
        tall = LINE * (len(lines) - 1) + LEAST
        best = view.best(self._candidates(center, arm.azimuth, far, wide, tall))
        x, y = best.text.at[0], best.text.at[1] + LINE * (len(lines) - 1)
        along = (math.cos(arm.azimuth), math.sin(arm.azimuth))
        feet = (center, (center[0] + 1.0, center[1]), (center[0] + along[0], center[1] + along[1]))
        turn = arm.azimuth % (2.0 * math.pi)
        heads: tuple[Item, ...] = ()
        if turn > 1e-9:
            round_ = self.radius * view.scale + 5.0
            ahead = turn + 0.5 * math.pi - 1.25 / round_
            heads = (arrow(_polar(center, round_, turn), math.cos(ahead), math.sin(ahead)),)
        view.add_dimension(
            Dimension(arm.name, degrees, Text((x, y), label, LEAST, "center"), heads, feet)
        )
        for k, (name, value, text, size) in enumerate(arm.more, 1):
            ends: tuple[Point, ...] = ()
            if size is not None:
                ends = (center, _polar(center, size * view.scale, arm.azimuth))
            row = Text((x, y - k * LINE), text, LEAST, "center")
            view.add_dimension(Dimension(name, value, row, (), ends, size is not None))

    @staticmethod
    def _candidates(
        center: Point, azimuth: float, far: float, wide: float, tall: float
    ) -> Iterator[Candidate]:
        """Blocks of texts, as one text so high, beyond the end of the ray and beside it."""
        for step in range(8):
            for turn in (0.0, 0.12, -0.12, 0.24, -0.24):
                ux, uy = math.cos(azimuth + turn), math.sin(azimuth + turn)
                reach = far + 1.5 + 2.5 * step + 0.5 * wide * abs(ux) + 0.5 * (tall + 1.0) * abs(uy)
                at = (center[0] + reach * ux, center[1] + reach * uy - 0.5 * tall)
                block = Block(at, "", tall, "center", wide=wide)
                yield Candidate(block, dislike=0.1 * step + abs(turn))


LINE: Final = LEAST * (1.0 + BELOW) + 0.6
"""From one line of text to the next [mm]."""


@dataclass(frozen=True)
class Block(Text):
    """A rectangle for several lines of text."""

    wide: float = 0.0

    @property
    def width(self) -> float:
        """How wide it is [mm]."""
        return self.wide

    def bounds(self, margin: float = 0.0) -> tuple[float, float, float, float]:
        """Left, low, right and high side [mm] from its point, with a margin."""
        low = -BELOW * LEAST - margin
        return -0.5 * self.wide - margin, low, 0.5 * self.wide + margin, self.height + margin


def _polar(center: Point, radius: float, angle: float) -> Point:
    return (center[0] + radius * math.cos(angle), center[1] + radius * math.sin(angle))

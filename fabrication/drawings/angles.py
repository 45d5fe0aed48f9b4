"""Angles between two directions of a part (ISO 129-1)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from fabrication.boundary import Vec
from fabrication.drawings.lettering import LEAST
from fabrication.drawings.marks import ARROW, DEG_PLACES, arrow
from fabrication.drawings.placing import Candidate, PlacedView
from fabrication.drawings.room import Stroke, strokes_of
from fabrication.drawings.sheet import Arc, Dimension, Item, Path, Point, Text
from fabrication.drawings.views import shown

TAIL: Final = 6.0
"""How far [mm] the arc of a small angle goes on beyond its sides, with the arrows there."""


@dataclass(frozen=True)
class Angle:
    """An angle at a point between two directions of the part, as seen.

    value_deg : what is written, with its sign where `signed`
    beside : None: the text is between the directions; else the direction of the part towards
        which it stands beside them, for angles that are small
    least : least radius of the arc, in the part's own size [mm]
    """

    name: str
    at: Vec
    first: Vec
    second: Vec
    value_deg: float
    signed: bool = False
    beside: Vec | None = None
    least: float = 0.0

    def place(self, view: PlacedView) -> None:
        """An arc with arrowheads, and the text near its middle or at its end."""
        corner = view.at(self.at)
        one, two = (math.atan2(*reversed(view.way(way))) for way in (self.first, self.second))
        turn = math.remainder(two - one, 2.0 * math.pi)
        start, end = (one, one + turn) if turn >= 0.0 else (two, two - turn)
        sign = "+" if self.signed and round(self.value_deg, DEG_PLACES) > 0.0 else ""
        label = f"{sign}{shown(self.value_deg, DEG_PLACES)}°"
        if self.beside is None:
            best = view.best(_between(corner, start, end, label))
        else:
            least = self.least * view.scale
            best = view.best(_beside(corner, start, end, label, view.way(self.beside), least))
        away = (math.cos(start), math.sin(start)), (math.cos(end), math.sin(end))
        feet = (corner, *((corner[0] + x, corner[1] + y) for x, y in away))
        view.add_dimension(Dimension(self.name, self.value_deg, best.text, best.draw(), feet))


def _between(corner: Point, start: float, end: float, label: str) -> Iterator[Candidate]:
    """Texts between both sides, farther and farther from the corner."""
    middle = 0.5 * (start + end)
    wide = Text((0.0, 0.0), label).width
    for step in range(12):
        radius = 7.0 + 2.5 * step
        for turn in (0.0, 0.15, -0.15, 0.3, -0.3):
            at_angle = middle + turn * (end - start)
            far = radius + 2.0 + abs(math.cos(at_angle)) * 0.5 * wide
            x = corner[0] + far * math.cos(at_angle)
            y = corner[1] + far * math.sin(at_angle) - 0.5 * LEAST
            text = Text((x, y), label, LEAST, "center")
            yield Candidate(
                text,
                draw=lambda radius=radius: _arc(corner, radius, start, end),  # type: ignore[misc]
                dislike=0.05 * step + 0.05 * abs(turn),
            )


def _arc(corner: Point, radius: float, start: float, end: float) -> tuple[Item, ...]:
    arc = Arc(corner, radius, start, end, "thin")
    if radius * (end - start) < 2.5 * ARROW:
        return (arc,)
    return (arc, *_heads(arc, 1.0))


def _heads(arc: Arc, sense: float) -> list[Item]:
    """Arrowheads at both ends; sense 1: from inside, -1: from outside."""
    lean = 0.5 * ARROW / arc.radius
    heads: list[Item] = []
    for angle, outward in ((arc.start, -1.0), (arc.end, 1.0)):
        along = angle + sense * outward * (0.5 * math.pi - sense * lean)
        heads.append(arrow(arc.at(angle), math.cos(along), math.sin(along)))
    return heads


def _beside(
    corner: Point, start: float, end: float, label: str, beside: Point, least: float
) -> Iterator[Candidate]:
    """Arrows from outside, and the text at the end of the arc on one side."""
    wide = Text((0.0, 0.0), label).width
    middle = 0.5 * (start + end)
    toward = -math.sin(middle) * beside[0] + math.cos(middle) * beside[1]
    for step in range(10):
        radius = max(least, 8.0) + 5.0 + 3.0 * step
        tail = TAIL / radius
        far = end + tail if toward > 0.0 else start - tail
        x, y = corner[0] + radius * math.cos(far), corner[1] + radius * math.sin(far)
        sense = 1.0 if beside[0] > 1e-9 else -1.0 if beside[0] < -1e-9 else 0.0
        text = Text((x + sense * (0.5 * wide + 1.0), y - 0.5 * LEAST), label, LEAST, "center")
        whole = Arc(corner, radius, start - tail, end + tail, "thin")
        lines: list[Stroke] = strokes_of(whole, 0.2)

        def draw(radius: float = radius, whole: Arc = whole) -> tuple[Item, ...]:
            legs = [
                Path((corner, _at(corner, radius + 2.0, angle)), "thin") for angle in (start, end)
            ]
            return (*legs, whole, *_heads(Arc(corner, radius, start, end, "thin"), -1.0))

        yield Candidate(text, (), tuple(lines), draw, 0.3 * step)


def _at(corner: Point, radius: float, angle: float) -> Point:
    return (corner[0] + radius * math.cos(angle), corner[1] + radius * math.sin(angle))

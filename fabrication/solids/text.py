"""Text on flat faces: letters of square dots, engraved or raised, as part of an exact boundary.

The letters are data (three by five dots), so they are the same on every machine, every stroke and
every gap is one dot wide, and what they take or add is a whole number of dots.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, TypeAlias

from ddgfab.errors import DetailError
from fabrication.boundary import Vec
from fabrication.solids.builder import BoundaryBuilder, Coedges, add, cross, opposite, scale

Dot: TypeAlias = tuple[int, int]
Ring: TypeAlias = tuple[Dot, ...]

ROWS: Final = 5
"""Dots in the height of a letter."""

GAP: Final = 1
"""Dots between two letters."""

GLYPHS: Final[dict[str, str]] = {
    "0": "111 101 101 101 111",
    "1": "110 010 010 010 111",
    "2": "111 001 111 100 111",
    "3": "111 001 111 001 111",
    "4": "101 101 111 001 001",
    "5": "111 100 111 001 111",
    "6": "111 100 111 101 111",
    "7": "111 001 001 001 001",
    "8": "111 101 111 101 111",
    "9": "111 101 111 001 111",
    "C": "111 100 100 100 111",
    "H": "101 101 111 101 101",
    "L": "100 100 100 100 111",
    "P": "111 101 111 100 100",
    "T": "111 010 010 010 010",
    "-": "000 000 111 000 000",
    ".": "0 0 0 0 1",
    " ": "0 0 0 0 0",
}
"""Rows of dots from top to bottom. No two dots touch at a corner only: that is not a solid."""


@dataclass(frozen=True)
class Label:
    """A short text of square dots on a flat face.

    text : what is written; the glyphs that exist are those of `GLYPHS`
    unit : side of a dot [mm]: the width of a stroke, and of the gaps within a letter
    depth : how deep the text is engraved [mm]; negative: how far it stands out
    stacked : letters stand one below the other along the bar instead of beside each other
    """

    text: str
    unit: float
    depth: float
    stacked: bool = False


@dataclass(frozen=True)
class Outline:
    """One letter's border in dots, y up: the outer ring counterclockwise, islands clockwise."""

    outer: Ring
    islands: tuple[Ring, ...]


def rows_of(letter: str) -> list[str]:
    """Rows of dots of a letter, from above.

    Raises
    ------
    DetailError
        There is no such glyph; those that exist are named.
    """
    if letter not in GLYPHS:
        raise DetailError(f'no letter "{letter}" can be written; only {"".join(GLYPHS)}')
    return GLYPHS[letter].split()


def text_size(text: str, *, stacked: bool = False) -> tuple[int, int]:
    """Width and height of a text in dots."""
    widths = [len(rows_of(letter)[0]) for letter in text]
    if stacked:
        return max(widths, default=0), len(text) * (ROWS + GAP) - GAP
    return sum(widths) + GAP * (len(text) - 1), ROWS


def text_dots(text: str) -> int:
    """How many dots a text has: its area is as many squares."""
    return sum("".join(rows_of(letter)).count("1") for letter in text)


@lru_cache(maxsize=256)
def text_outlines(text: str, stacked: bool = False) -> tuple[Outline, ...]:
    """Borders of the letters of a text whose lower left corner is at the origin, in dots."""
    width, height = text_size(text, stacked=stacked)
    outlines = []
    x, y = 0, height - ROWS
    for letter in text:
        rows = rows_of(letter)
        across = len(rows[0])
        left = (width - across) // 2 if stacked else x
        dots = {
            (left + i, y + ROWS - 1 - j)
            for j, row in enumerate(rows)
            for i, mark in enumerate(row)
            if mark == "1"
        }
        if dots:
            rings = _rings(dots)
            outer = [ring for ring in rings if _twice_area(ring) > 0]
            islands = tuple(ring for ring in rings if _twice_area(ring) < 0)
            outlines.append(Outline(outer[0], islands))
        x += across + GAP
        y -= (ROWS + GAP) if stacked else 0
    return tuple(outlines)


def _rings(dots: set[Dot]) -> list[Ring]:
    """Closed borders of a set of dots, which lie on their left; without corners in line."""
    step: dict[Dot, Dot] = {}
    for x, y in sorted(dots):
        for beside, start, end in (
            ((x, y - 1), (x, y), (x + 1, y)),
            ((x + 1, y), (x + 1, y), (x + 1, y + 1)),
            ((x, y + 1), (x + 1, y + 1), (x, y + 1)),
            ((x - 1, y), (x, y + 1), (x, y)),
        ):
            if beside not in dots:
                step[start] = end
    rings = []
    while step:
        start = min(step)
        chain = [start]
        while (following := step.pop(chain[-1])) != start:
            chain.append(following)
        rings.append(
            tuple(
                here
                for before, here, after in zip(
                    [chain[-1], *chain[:-1]], chain, [*chain[1:], chain[0]], strict=True
                )
                if before[0] != after[0] and before[1] != after[1]
            )
        )
    return rings


def _twice_area(ring: Ring) -> int:
    return sum(p[0] * q[1] - p[1] * q[0] for p, q in zip(ring, [*ring[1:], ring[0]], strict=True))


def label_size(label: Label) -> tuple[float, float]:
    """Width and height [mm] of a label."""
    width, height = text_size(label.text, stacked=label.stacked)
    return width * label.unit, height * label.unit


def label_volume(label: Label | None) -> float:
    """Volume [mm3] that a label takes away; negative where it is raised."""
    return 0.0 if label is None else text_dots(label.text) * label.unit**2 * label.depth


def write_label(
    builder: BoundaryBuilder, label: Label, middle: Vec, xdir: Vec, ydir: Vec
) -> list[Coedges]:
    """Draw a label around a point of a plane face; the loops that the face gets as holes.

    xdir, ydir : unit vectors to the right and up; their product is the face's outward normal
    """
    normal = cross(xdir, ydir)
    width, height = label_size(label)
    corner = add(add(middle, xdir, -width / 2.0), ydir, -height / 2.0)
    floor = scale(normal, -label.depth)
    holes = []
    for outline in text_outlines(label.text, label.stacked):
        loops = []
        for ring in (outline.outer, *outline.islands):
            corners = [
                add(add(corner, xdir, x * label.unit), ydir, y * label.unit) for x, y in ring
            ]
            rim, foot = _walls(builder, corners, floor, 1.0 if label.depth > 0.0 else -1.0)
            loops.append(foot)
            if ring is outline.outer:
                holes.append(opposite(rim))
            else:
                builder.plane(normal, [opposite(rim)])
        builder.plane(normal, loops)
    return holes


def _walls(
    builder: BoundaryBuilder, corners: Sequence[Vec], floor: Vec, sign: float
) -> tuple[Coedges, Coedges]:
    """The walls under a ring, which face its left (sign 1) or right; the ring above and below."""
    above = [builder.point(p) for p in corners]
    below = [builder.point(add(p, floor)) for p in corners]
    rim, foot = [], []
    down = scale(floor, sign)
    n = len(corners)
    for k in range(n):
        j = (k + 1) % n
        top, bottom = builder.line(above[k], above[j]), builder.line(below[k], below[j])
        here, there = builder.line(above[k], below[k]), builder.line(above[j], below[j])
        along = add(corners[j], corners[k], -1.0)
        area = cross(along, down)
        size = sum(x * x for x in area) ** 0.5
        builder.plane(scale(area, sign / size), [[top, there, ~bottom, ~here]])
        rim.append(top)
        foot.append(bottom)
    return rim, foot

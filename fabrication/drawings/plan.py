"""Plans: the whole structure as lines, seen from the sides that its pieces face, with a label each.

The scale is the smallest of ISO 5455 at which the labels find room; the paper the smallest that
holds the view then, and where none does, the view is on several sheets.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from ddgfab.mesh import Floats
from fabrication.boundary import Vec
from fabrication.drawings.arrange import SCALES, scale_text
from fabrication.drawings.block import Block, block_items, block_rectangle, frame_items
from fabrication.drawings.lettering import BELOW, LEAST, text_width
from fabrication.drawings.marks import readable
from fabrication.drawings.room import ON_LINE, ON_TEXT, Room, Stroke
from fabrication.drawings.sheet import (
    A0,
    A1,
    A2,
    A3,
    Arc,
    Item,
    Paper,
    Path,
    Placed,
    Rectangle,
    Sheet,
    Text,
    frame_of,
)

PAPERS: Final = (A3, A2, A1, A0)
TILED: Final = A1
"""Paper of a view that needs several sheets."""

DOT: Final = 0.8
"""Radius [mm] of the circle at a joint."""

OFF: Final = 0.8
"""From the line of a bar to its label [mm]."""

UP: Final = 0.35
"""Pieces whose outward direction rises by this sine are seen from above."""

BORDER: Final = 10.0
"""Room [mm] between the lines of a view and the border of its area."""

TRIES: Final = 4
"""So many scales of the series are tried beyond the first at which a label has room."""

SOFT: Final = 1e-3
FEW: Final = 5e-5
"""A label on a line counts so much of one on a text; so many for each label are accepted: one in
twenty on a line, none on a text."""

VIEWS: Final[tuple[tuple[str, Vec, Vec], ...]] = (
    ("from above", (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    ("from the front (-y)", (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    ("from the right (+x)", (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    ("from the back (+y)", (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    ("from the left (-x)", (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)),
    ("from below", (1.0, 0.0, 0.0), (0.0, -1.0, 0.0)),
)
"""Names, and what points to the right and up."""


@dataclass(frozen=True, eq=False)
class Symbol:
    """A piece in a plan.

    lines : (n, 2, 3) of its lines
    center : (3,) where its label is
    outward : (3,) the side that it is seen from; zero: from above
    """

    label: str
    form: Literal["joint", "bar", "sheet", "block"]
    lines: Floats
    center: Floats
    outward: Floats


@dataclass(frozen=True, eq=False)
class _View:
    """Symbols as seen from one side: lines (n, 2, 2) of all, and the labels' symbols."""

    title: str
    lines: Floats
    symbols: tuple[Symbol, ...]
    centers: Floats
    ways: Floats
    axes: Floats

    @property
    def low(self) -> Floats:
        """(2,) lower left corner [mm]."""
        return np.asarray(np.concatenate([self.lines.reshape(-1, 2), self.centers]).min(axis=0))

    @property
    def size(self) -> Floats:
        """(2,) width and height [mm]."""
        both = np.concatenate([self.lines.reshape(-1, 2), self.centers])
        return np.asarray(np.ptp(both, axis=0))


def plan_sheets(symbols: Sequence[Symbol], block: Block, subject: str) -> list[Sheet]:
    """The views of a structure: every symbol is labelled on one of them."""
    drawn: list[tuple[Paper, tuple[Item, ...], Placed, str]] = []
    for view in _views(symbols):
        scale, labels = _labelled(view)
        paper, areas = _papers(view, scale)
        for n, (origin, area) in enumerate(areas, 1):
            title = view.title if len(areas) == 1 else f"{view.title}, part {n} of {len(areas)}"
            items = tuple(_window(view, scale, labels, origin, area))
            low, high = (area.x0, area.y0), (area.x1, area.y1)
            name = Text((area.x0, area.y1 - LEAST), title, 3.5, bold=True)
            drawn.append((paper, (*items, name), Placed(title, scale, low, high), title))
    sheets = []
    for n, (paper, items, placed, title) in enumerate(drawn, 1):
        own = replace(block, scale=scale_text(placed.scale), subtitle=f"{block.subtitle}, {title}")
        around = (*frame_items(paper), *block_items(paper, own, n, len(drawn)))
        sheets.append(
            Sheet(subject, f"{block.subtitle}, {title}", paper, (*around, *items), (), (placed,))
        )
    return sheets


def _views(symbols: Sequence[Symbol]) -> Iterator[_View]:
    """The sides from which some symbols are seen best."""
    towards = np.array([np.cross(right, up) for _, right, up in VIEWS])
    outward = np.array([symbol.outward for symbol in symbols])
    facing = outward @ towards.T
    best = np.where(
        (outward[:, 2] >= UP) | (np.abs(outward).max(axis=1) < 1e-9), 0, np.argmax(facing, axis=1)
    )
    for k, (title, right, up) in enumerate(VIEWS):
        own = np.flatnonzero(best == k).tolist()
        if not own:
            continue
        axes = np.array([right, up])
        near = np.flatnonzero((facing[:, k] > 0.05) | (best == k)).tolist()
        lines = np.concatenate([symbols[i].lines for i in near]) @ axes.T
        chosen = tuple(symbols[i] for i in own)
        centers = np.array([symbol.center for symbol in chosen]) @ axes.T
        ways = np.array([_way(symbol) for symbol in chosen]) @ axes.T
        yield _View(title, lines, chosen, centers, ways, axes)


def _way(symbol: Symbol) -> Floats:
    """(3,) from end to end of a bar; zero for others."""
    if symbol.form != "bar":
        return np.zeros(3)
    return np.asarray(symbol.lines[0, 1] - symbol.lines[0, 0])


def _labelled(view: _View) -> tuple[float, list[Text]]:
    """The scale, and the labels on paper, from the origin of the projection."""
    enough = [_least(view, k) for k in range(len(view.symbols))]
    largest = max(float(view.size.max()), 1e-9)
    first = max(float(np.percentile(enough, 90.0)), 0.3 * A3.width / largest)
    scales = [scale for scale in reversed(SCALES) if scale >= first * 0.999] or [SCALES[0]]
    best: tuple[float, float, list[Text]] | None = None
    for scale in scales[:TRIES]:
        labels, crowded = _labels(view, scale, math.inf if best is None else best[0])
        if best is None or crowded < best[0]:
            best = (crowded, scale, labels)
        if crowded <= FEW * len(view.symbols):
            break
    assert best is not None
    return best[1], best[2]


def _least(view: _View, index: int) -> float:
    """The scale at which a label is no longer than its bar, or no larger than its pane."""
    symbol = view.symbols[index]
    wide = text_width(symbol.label, LEAST)
    if symbol.form == "bar":
        long = math.hypot(*view.ways[index].tolist())
        return (wide + 2.0) / long if long > 1e-6 else 0.0
    if symbol.form != "sheet":
        return 0.0
    across: float
    up: float
    across, up = np.ptp(symbol.lines.reshape(-1, 3) @ view.axes.T, axis=0).tolist()
    return max((wide + 2.0) / max(across, 1e-6), 2.0 * LEAST / max(up, 1e-6))


def _labels(view: _View, scale: float, most: float) -> tuple[list[Text], float]:
    """Labels at a scale, and how many of them lie on a text, or by `SOFT` on a line.

    Stops where those are more than so many.
    """
    room = Room()
    ends = (view.lines * scale).tolist()
    room.add_lines([((a, b), (c, d)) for (a, b), (c, d) in ends if (a, b) != (c, d)])
    labels: list[Text] = []
    crowded = 0.0
    order = {"joint": 0, "bar": 1, "sheet": 2, "block": 3}
    for k in sorted(range(len(view.symbols)), key=lambda k: order[view.symbols[k].form]):
        x, y = (view.centers[k] * scale).tolist()
        way = (view.ways[k] * scale).tolist()
        best, least = None, math.inf
        for text, dislike in _places(view.symbols[k], x, y, way):
            cost = dislike + room.cost(text, least - dislike)
            if cost < least:
                best, least = text, cost
            if cost - dislike < 1.0:
                break
        assert best is not None
        crowded += 1.0 if least >= ON_TEXT else SOFT * (least >= ON_LINE)
        if crowded >= most:
            break
        room.add_text(best)
        labels.append(best)
    return labels, crowded


def _places(symbol: Symbol, x: float, y: float, way: list[float]) -> Iterator[tuple[Text, float]]:
    """Texts for a symbol at a point, and how little each is liked."""
    label, wide = symbol.label, text_width(symbol.label, LEAST)
    if symbol.form == "bar":
        angle = readable(math.atan2(way[1], way[0]))
        c, s = math.cos(angle), math.sin(angle)
        long = math.hypot(*way)
        for shift in (0.0, 0.1, -0.1, 0.2, -0.2, 0.3, -0.3):
            for lift in (OFF + BELOW * LEAST, -OFF - LEAST):
                at = (x + shift * long * c - lift * s, y + shift * long * s + lift * c)
                yield Text(at, label, LEAST, "center", angle), abs(shift)
        return
    if symbol.form == "joint":
        for step in range(4):
            for turn in range(16):
                angle = math.pi * (0.25 + turn / 8.0)
                ux, uy = math.cos(angle), math.sin(angle)
                far = DOT + 0.8 + 1.5 * step
                at = (
                    x + far * ux + 0.5 * wide * ux,
                    y + far * uy + 0.5 * LEAST * uy - 0.5 * LEAST,
                )
                yield Text(at, label, LEAST, "center"), 0.5 * step
        return
    for step in range(8):
        for turn in range(8 if step else 1):
            angle = math.pi * turn / 4.0
            at = (x + 2.0 * step * math.cos(angle), y + 2.0 * step * math.sin(angle) - 0.5 * LEAST)
            yield Text(at, label, LEAST, "center"), 0.2 * step


def _area(paper: Paper) -> Rectangle:
    """The room for the view: beside the title block on large paper, above it on small."""
    frame, about = frame_of(paper), block_rectangle(paper)
    return Rectangle(frame.x0 + 4.0, about.y1 + 4.0, frame.x1 - 4.0, frame.y1 - 4.0)


def _papers(view: _View, scale: float) -> tuple[Paper, list[tuple[tuple[float, float], Rectangle]]]:
    """The paper, and for each sheet which point of the view on paper is at its area's corner."""
    width, height = (view.size * scale + 2.0 * BORDER).tolist()
    x, y = (view.low * scale - BORDER).tolist()
    for paper in PAPERS:
        area = _area(paper)
        if width <= area.width and height + 6.0 <= area.height:
            left, low = 0.5 * (area.width - width), 0.5 * (area.height - 6.0 - height)
            return paper, [((x - left, y - low), area)]
    area = _area(TILED)
    across, up = area.width - 2.0 * BORDER, area.height - 6.0 - 2.0 * BORDER
    columns, rows = math.ceil(width / across), math.ceil(height / up)
    return TILED, [
        ((x + across * i, y + up * j), area) for j in reversed(range(rows)) for i in range(columns)
    ]


def _window(
    view: _View, scale: float, labels: Sequence[Text], origin: tuple[float, float], area: Rectangle
) -> Iterator[Item]:
    """Lines, joints and labels of a part of a view, where its area is on paper."""
    dx, dy = area.x0 - origin[0], area.y0 - origin[1]
    inner = Rectangle(area.x0 + BORDER, area.y0 + BORDER, area.x1 - BORDER, area.y1 - BORDER - 6.0)
    seen: set[Stroke] = set()
    for (a, b), (c, d) in (view.lines * scale + [dx, dy]).round(3).tolist():
        cut = clipped((a, b), (c, d), area)
        if cut is not None and cut not in seen:
            seen.add(cut)
            yield Path(cut, "thin")
    for symbol, center in zip(view.symbols, view.centers, strict=True):
        x, y = (center * scale + [dx, dy]).tolist()
        if symbol.form == "joint" and inner.contains((x, y), 0.0):
            yield Arc((x, y), DOT, 0.0, 2.0 * math.pi, "outline")
    for label in labels:
        text = label.moved(dx, dy)
        if inner.contains(text.at, 1e-6):
            yield text


def clipped(p: tuple[float, float], q: tuple[float, float], area: Rectangle) -> Stroke | None:
    """What of a straight line is in a rectangle.

    >>> clipped((-5.0, 1.0), (5.0, 1.0), Rectangle(0.0, 0.0, 2.0, 2.0))
    ((0.0, 1.0), (2.0, 1.0))
    """
    first, last = 0.0, 1.0
    for begin, end, low, high in (
        (p[0], q[0], area.x0, area.x1),
        (p[1], q[1], area.y0, area.y1),
    ):
        way = end - begin
        if abs(way) < 1e-12:
            if not low <= begin <= high:
                return None
            continue
        one, two = sorted(((low - begin) / way, (high - begin) / way))
        first, last = max(first, one), min(last, two)
    if first >= last:
        return None
    if first == 0.0 and last == 1.0:
        return p, q
    (x, y), (u, v) = p, (q[0] - p[0], q[1] - p[1])
    return (x + first * u, y + first * v), (x + last * u, y + last * v)

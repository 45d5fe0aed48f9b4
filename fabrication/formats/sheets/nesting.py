"""Drawings of glass on stock: every sheet of stock with its panes, to scale, several a sheet."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np

from fabrication.drawings.arrange import SCALES, scale_text
from fabrication.drawings.block import block_items, block_rectangle, frame_items
from fabrication.drawings.lettering import BELOW, LEAST, text_width
from fabrication.drawings.sheet import A3, Item, Path, Placed, Point, Sheet, Text, frame_of
from fabrication.formats.base import Whole
from fabrication.formats.nested import Lying, StockSheet, stock_sheets
from fabrication.formats.sheets.parts import project_block
from fabrication.solids.section import segments
from fabrication.specs import Loop

GLASS_ON_STOCK: Final = "Nesting"
"""Group of these sheets."""

TITLE: Final = 8.0
"""Room [mm] for the title above a sheet of stock."""

BETWEEN: Final = 6.0
"""Room [mm] between sheets of stock."""

CHORD: Final = 0.1
"""Angle [rad] of the chords that arcs are drawn by."""

MOST: Final = 0.9
"""The scale is the smallest at which so many of the marks have room in their panes."""


def nesting_sheets(whole: Whole) -> Iterator[tuple[str, Sheet]]:
    """Group and sheet of the glass on stock; none where nothing is nested."""
    stock = stock_sheets(whole)
    if not stock:
        return
    frame, about = frame_of(A3), block_rectangle(A3)
    left, low, top = frame.x0 + 6.0, about.y1 + 6.0, frame.y1 - 6.0
    width, height = frame.x1 - 6.0 - left, top - low
    scale = _scale(stock, width, height)
    titles = [text_width(_title(sheet), LEAST, True) for sheet in stock]
    wide = max(*titles, *(sheet.width * scale for sheet in stock)) + BETWEEN
    high = max(sheet.height for sheet in stock) * scale + TITLE + BETWEEN
    columns = max(1, math.floor((width + BETWEEN) / wide))
    rows = max(1, math.floor((height + BETWEEN) / high))
    pages = math.ceil(len(stock) / (columns * rows))
    block = project_block(whole.about, "Glass on stock, an estimate", "Nesting")
    block = replace(block, scale=scale_text(scale))
    for page in range(pages):
        lines: list[Item] = []
        items: list[Item] = [*frame_items(A3), *block_items(A3, block, page + 1, pages)]
        views = []
        for n, sheet in enumerate(stock[page * columns * rows : (page + 1) * columns * rows]):
            x = left + wide * (n % columns)
            y = top - high * (n // columns) - TITLE - sheet.height * scale
            far = (x + sheet.width * scale, y + sheet.height * scale)
            items.append(Path(((x, y), (far[0], y), far, (x, far[1])), "chain", closed=True))
            items.append(Text((x, far[1] + 2.0), _title(sheet), bold=True))
            views.append(Placed(sheet.title, scale, (x, y), far))
            for part in sheet.parts:
                lines += [_path(loop, scale, x, y, "outline") for loop in part.loops]
                lines += [_path(loop, scale, x, y, "thin") for loop in part.other]
                if (label := _label(part, scale, x, y)) is not None:
                    items.append(label)
        name = "Glass on stock" if page == 0 else f"Glass on stock ({page + 1})"
        placed = tuple(views)
        yield GLASS_ON_STOCK, Sheet("nesting", name, A3, tuple(items), (), placed, tuple(lines))


def _title(sheet: StockSheet) -> str:
    return f"{sheet.title}, fill {100.0 * sheet.fill:.0f} %"


def _scale(stock: list[StockSheet], width: float, height: float) -> float:
    """The smallest scale at which marks have room; the largest that fits, where none does."""
    fitting = [
        scale
        for scale in reversed(SCALES)
        if all(s.width * scale <= width and s.height * scale + TITLE <= height for s in stock)
    ]
    parts = [part for sheet in stock for part in sheet.parts]
    for scale in fitting:
        if sum(_label(p, scale, 0.0, 0.0) is not None for p in parts) >= MOST * len(parts):
            return scale
    return fitting[-1] if fitting else SCALES[-1]


def _path(loop: Loop, scale: float, x: float, y: float, pen: str) -> Path:
    """A closed line on paper, its arcs by chords."""
    points: list[Point] = []
    for s in segments(loop):
        count = max(1, math.ceil(abs(s.turn) / CHORD)) if s.turn else 1
        u, v, _, _ = s.points(np.linspace(0.0, 1.0, count + 1)[:-1])
        points += [(x + scale * a, y + scale * b) for a, b in zip(u, v, strict=True)]
    return Path(tuple(points), "outline" if pen == "outline" else "thin", closed=True)


def _label(part: Lying, scale: float, x: float, y: float) -> Text | None:
    """The mark at the middle of the corners, level or upright; None where it has no room."""
    corners = part.loops[0].points * scale
    middle = corners.mean(axis=0)
    after = np.roll(corners, -1, axis=0)
    along = after - corners
    normals = np.column_stack([-along[:, 1], along[:, 0]])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-12)[:, None]  # inwards
    half = np.array([0.5 * text_width(part.mark, LEAST), 0.5 * (1.0 + BELOW) * LEAST]) + 0.4
    for angle in (0.0, 0.5 * math.pi):
        box = half if angle == 0.0 else half[::-1]
        room = np.sum((middle - corners) * normals, axis=1) - np.abs(normals) @ box
        if (room >= 0.0).all():
            lift = -0.5 * (1.0 - BELOW) * LEAST  # from the middle to the base line
            dx, dy = (0.0, lift) if angle == 0.0 else (-lift, 0.0)
            at = (x + float(middle[0]) + dx, y + float(middle[1]) + dy)
            return Text(at, part.mark, LEAST, "center", angle)
    return None

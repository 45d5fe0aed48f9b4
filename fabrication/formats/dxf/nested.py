"""Glass on stock as DXF, 1:1: sheets of stock side by side, a row a thickness of glass."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from fabrication.drawings.strokes import strokes, width_of
from fabrication.formats.dxf.write import CUT, DETAIL, MARK, STOCK, Drawn
from fabrication.formats.nested import StockSheet
from fabrication.specs import Loop

BETWEEN: Final = 500.0
"""From one sheet of stock to the next [mm]."""

TITLE: Final = 60.0
"""Height of the letters of titles [mm]."""

LETTERS: Final = (30.0, 20.0, 10.0, 5.0)
"""Heights of piece marks [mm], of which the first is taken that is narrower than half the pane."""


def nested_lines(sheets: Sequence[StockSheet]) -> Iterator[Drawn]:
    """What is drawn of the sheets of stock: layer, line, whether it is closed."""
    x, y, row = 0.0, 0.0, ""
    for sheet in sheets:
        glass = sheet.title.rpartition(",")[0]
        if row and glass != row:
            x, y = 0.0, y - sheet.height - 2.0 * BETWEEN
        row, at = glass, np.array([x, y])
        w, h = sheet.width, sheet.height
        border = np.array([(0.0, 0.0), (w, 0.0), (w, h), (0.0, h)]) + at
        yield STOCK, Loop(border, np.zeros(4)), True
        for line in strokes(sheet.title, TITLE):
            yield STOCK, Loop(line + at + (0.0, h + TITLE), np.zeros(len(line))), False
        for part in sheet.parts:
            for layer, loops in ((CUT, part.loops), (DETAIL, part.other)):
                for loop in loops:
                    yield layer, Loop(loop.points + at, loop.bulges), True
            corners = part.loops[0].points
            room = 0.5 * float(np.ptp(corners[:, 0]))
            height = next((t for t in LETTERS if width_of(part.mark, t) <= room), None)
            if height is None:
                continue
            low = corners.mean(axis=0) + at - (0.5 * width_of(part.mark, height), 0.5 * height)
            for line in strokes(part.mark, height):
                yield MARK, Loop(line + low, np.zeros(len(line))), False
        x += w + BETWEEN

"""Lists on sheets: texts in columns, cut into parts that fit."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from fabrication.drawings.lettering import LEAST, clip, text_width
from fabrication.drawings.sheet import Item, Path, Text
from fabrication.drawings.views import List

LINE: Final = 4.6
"""Height of a row [mm]."""

PAD: Final = 1.5
"""Room [mm] between a text and the border of its cell."""

HEAD: Final = 6.0
"""Height of the title above a list [mm]."""


def height_of(table: List, width: float) -> float:
    """Height [mm] of a list that may be so wide, its title with it."""
    return sum(HEAD + LINE * (1 + len(part.rows)) for part in by_columns(table, width))


def widths_of(table: List) -> list[float]:
    """Widths of the columns [mm]."""
    return [
        max(text_width(text, LEAST) for text in (head, *(row[k] for row in table.rows))) + 2.0 * PAD
        for k, head in enumerate(table.headings)
    ]


def by_columns(table: List, width: float) -> list[List]:
    """The list in parts that are no wider [mm], each with the first column."""
    widths = widths_of(table)
    parts: list[list[int]] = [[0]]
    used = widths[0]
    for k in range(1, len(widths)):
        if used + widths[k] > width and len(parts[-1]) > 1:
            parts.append([0])
            used = widths[0]
        parts[-1].append(k)
        used += widths[k]
    if len(parts) == 1:
        return [table]
    return [
        List(
            table.title if n == 0 else f"{table.title} (continued)",
            tuple(table.headings[k] for k in part),
            tuple(tuple(row[k] for k in part) for row in table.rows),
        )
        for n, part in enumerate(parts)
    ]


def by_rows(table: List, height: float) -> tuple[List | None, List | None]:
    """What of a list fits into a height [mm], and what is left of it."""
    fit = int((height - HEAD) // LINE) - 1
    if fit >= len(table.rows):
        return table, None
    if fit < 1:
        return None, table
    title = table.title if table.title.endswith("(continued)") else f"{table.title} (continued)"
    return (
        List(table.title, table.headings, table.rows[:fit]),
        List(title, table.headings, table.rows[fit:]),
    )


def list_items(table: List, x: float, top: float, width: float) -> Iterator[Item]:
    """A list below a height, from x to the right: title, headings, rows with lines between."""
    widths = widths_of(table)
    total = sum(widths)
    if total > width:  # a single column that is too wide
        widths = [wide * width / total for wide in widths]
        total = width
    yield Text((x, top - HEAD + 1.8), clip(table.title, width, LEAST, True), LEAST, bold=True)
    y = top - HEAD
    bottom = y - LINE * (1 + len(table.rows))
    yield Path(((x, y), (x + total, y)), "outline")
    yield Path(((x, bottom), (x + total, bottom)), "outline")
    yield Path(((x, y - LINE), (x + total, y - LINE)), "thin")
    at = x
    for wide in (*widths, 0.0):
        yield Path(((at, y), (at, bottom)), "thin")
        at += wide
    for n, row in enumerate((table.headings, *table.rows)):
        base = y - LINE * (n + 1) + 1.1
        at = x
        for text, wide in zip(row, widths, strict=True):
            shown = clip(text, wide - 2.0 * PAD + 0.01, LEAST)
            if _is_number(text):
                yield Text((at + wide - PAD, base), shown, LEAST, "right")
            else:
                yield Text((at + PAD, base), shown)
            at += wide


def _is_number(text: str) -> bool:
    return bool(text) and not text.strip("+-0123456789.")

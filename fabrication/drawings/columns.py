"""Lists and paragraphs below each other, beside or below views, and on sheets of their own."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

from fabrication.drawings.block import WIDE, Block, block_items, block_rectangle, frame_items
from fabrication.drawings.lettering import LEAST, wrap
from fabrication.drawings.lists import HEAD, LINE, by_columns, by_rows, list_items
from fabrication.drawings.sheet import A4, Item, Paper, Rectangle, Sheet, Text, frame_of
from fabrication.drawings.views import List

GAP: Final = 4.0
"""Room [mm] between views, lists and title block."""

INSET: Final = 2.0
"""Room [mm] between lists and the frame."""


@dataclass(frozen=True)
class Paragraph:
    """A title and words, wrapped."""

    title: str
    text: str


@dataclass(frozen=True)
class Entry:
    """A list or paragraph as it is put into a column: its height, and its items at a place."""

    table: List | None = None
    title: str = ""
    lines: tuple[str, ...] = ()

    @property
    def height(self) -> float:
        """How high it is [mm], with the gap below it."""
        if self.table is not None:
            return HEAD + LINE * (1 + len(self.table.rows)) + GAP
        return HEAD + LINE * len(self.lines) + GAP

    def split(self, height: float) -> tuple[Entry | None, Entry | None]:
        """What fits into a height, and what is left."""
        if self.height <= height:
            return self, None
        if self.table is not None:
            first, rest = by_rows(self.table, height - GAP)
            return (
                None if first is None else Entry(first),
                None if rest is None else Entry(rest),
            )
        fit = int((height - HEAD - GAP) // LINE)
        if fit < 1:
            return None, self
        title = self.title if self.title.endswith("(continued)") else f"{self.title} (continued)"
        return (
            replace(self, lines=self.lines[:fit]),
            replace(self, title=title, lines=self.lines[fit:]),
        )

    def items(self, x: float, top: float, width: float) -> Iterator[Item]:
        """Below a height."""
        if self.table is not None:
            yield from list_items(self.table, x, top, width)
            return
        yield Text((x, top - HEAD + 1.8), self.title, LEAST, bold=True)
        for n, line in enumerate(self.lines):
            yield Text((x, top - HEAD - LINE * (n + 1) + 1.1), line)


def entries_of(parts: Sequence[List | Paragraph]) -> Iterator[Entry]:
    """Lists in parts as wide as the title block, paragraphs in lines."""
    for part in parts:
        if isinstance(part, Paragraph):
            yield Entry(title=part.title, lines=tuple(wrap(part.text, WIDE - 2.0 * INSET, LEAST)))
        elif part.rows:
            yield from (Entry(table) for table in by_columns(part, WIDE - 2.0 * INSET))


def column_rectangle(paper: Paper) -> Rectangle:
    """Where lists are: above the title block."""
    about, frame = block_rectangle(paper), frame_of(paper)
    return Rectangle(about.x0 + INSET, about.y1, about.x1 - INSET, frame.y1 - GAP)


def _pages(entries: Sequence[Entry]) -> Iterator[list[Entry]]:
    """Entries on sheets of A4."""
    height = column_rectangle(A4).height
    page: list[Entry] = []
    used = 0.0
    waiting = list(entries)
    while waiting:
        first, rest = waiting.pop(0).split(height - used)
        if first is not None:
            page.append(first)
            used += first.height
        if rest is not None:
            waiting.insert(0, rest)
            yield page
            page, used = [], 0.0
    if page:
        yield page


def column_items(entries: Sequence[Entry], area: Rectangle, *, at_top: bool = False) -> list[Item]:
    """Entries below each other, down to the bottom of a column or from its top."""
    top = area.y1 if at_top else area.y0 + sum(entry.height for entry in entries)
    items: list[Item] = []
    for entry in entries:
        items += entry.items(area.x0, top, area.width)
        top -= entry.height
    return items


def list_sheets(
    entries: Sequence[Entry], block: Block, subject: str, title: str, before: int = 0
) -> list[Sheet]:
    """Entries on sheets of A4.

    Parameters
    ----------
    before : number of sheets of the same subject that come first
    """
    pages = list(_pages(entries))
    sheets = []
    for n, own in enumerate(pages, 1 + before):
        items = [
            *frame_items(A4),
            *block_items(A4, replace(block, scale=""), n, len(pages) + before),
        ]
        items += column_items(own, column_rectangle(A4), at_top=True)
        name = title if n == 1 else f"{title} ({n})"
        sheets.append(Sheet(subject, name, A4, tuple(items)))
    return sheets


def page_count(entries: Sequence[Entry]) -> int:
    """On how many sheets `list_sheets` puts them."""
    return sum(1 for _ in _pages(entries))

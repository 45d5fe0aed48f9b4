"""A part's sheets: views, lists, frame and title block on the smallest paper that shows it well."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

from ddgfab.errors import DetailError
from fabrication.boundary import Boundary
from fabrication.drawings.arrange import Arranged, arrange, extent_of, into, project, scale_text
from fabrication.drawings.block import WIDE, Block, block_items, block_rectangle, frame_items
from fabrication.drawings.lettering import LEAST, wrap
from fabrication.drawings.lists import HEAD, LINE, by_columns, by_rows, list_items
from fabrication.drawings.placing import Projected
from fabrication.drawings.sheet import (
    A1,
    A2,
    A3,
    A4,
    Dimension,
    Item,
    Paper,
    Placed,
    Rectangle,
    Sheet,
    Text,
    frame_of,
)
from fabrication.drawings.views import Drawing, List
from fabrication.specs import TriangleMesh

GAP: Final = 4.0
"""Room [mm] between views, lists and title block."""

PAPERS: Final = ((A4, 1.0 / 20.0), (A3, 1.0 / 50.0), (A2, 0.0), (A1, 0.0))
"""Papers, and the least scale at which a part is shown on each."""

LEAST_VIEW: Final = 20.0
LEAST_BROKEN: Final = 10.0
"""The main view is to be so high and wide [mm], unless the part itself is smaller; that of a long
part, which may be shown without its middle."""

INSET: Final = 2.0
"""Room [mm] between lists and the frame."""

PART_OF_SHEET: Final = 0.45
MOST_OF_SHEET: Final = 0.65
"""Lists take at most this part of the height that views and lists share on the first sheet; the
larger one where they need no second sheet then."""


@dataclass(frozen=True)
class Paragraph:
    """A title and words, wrapped."""

    title: str
    text: str


@dataclass(frozen=True)
class _Entry:
    """A list or paragraph as it is put into a column: its height, and its items at a place."""

    table: List | None = None
    title: str = ""
    lines: tuple[str, ...] = ()

    @property
    def height(self) -> float:
        if self.table is not None:
            return HEAD + LINE * (1 + len(self.table.rows)) + GAP
        return HEAD + LINE * len(self.lines) + GAP

    def split(self, height: float) -> tuple[_Entry | None, _Entry | None]:
        """What fits into a height, and what is left."""
        if self.height <= height:
            return self, None
        if self.table is not None:
            first, rest = by_rows(self.table, height - GAP)
            return (
                None if first is None else _Entry(first),
                None if rest is None else _Entry(rest),
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


@dataclass(frozen=True, eq=False)
class _Tried:
    """A paper with views and lists on it; good: the views are large enough for it."""

    paper: Paper
    arranged: Arranged
    area: Rectangle
    here: list[_Entry]
    later: list[_Entry]
    good: bool

    @property
    def crowded(self) -> int:
        """How many texts found no good place."""
        return sum(view.crowded for view in self.arranged.views)


def _tries(projected: Sequence[Projected], entries: Sequence[_Entry]) -> Iterator[_Tried]:
    """Papers from the smallest; on A4 all lists below the views, if they may, then a part."""
    main = projected[0]
    size = extent_of(main)
    wanted = LEAST_BROKEN if main.view.breaks else LEAST_VIEW
    total = sum(entry.height for entry in entries) / _column_rectangle(A4).height
    for paper, least in PAPERS:
        shares: tuple[float, ...] = (PART_OF_SHEET,)
        if paper is A4 and PART_OF_SHEET < total <= MOST_OF_SHEET:
            shares = (MOST_OF_SHEET, PART_OF_SHEET)
        for share in shares:
            here, later, area = _room(paper, entries, share)
            arranged = arrange(projected, area.width, area.height)
            if arranged is not None:
                scale = arranged.scale
                large = scale >= 1.0 or scale * size >= wanted - 1e-9
                good = large and scale >= least - 1e-12
                yield _Tried(paper, arranged, area, here, later, good)


def part_sheets(
    drawing: Drawing,
    boundary: Boundary | None,
    mesh: TriangleMesh,
    block: Block,
    subject: str,
    extra: Sequence[List | Paragraph] = (),
) -> list[Sheet]:
    """The sheets of a part: the first with its views, more where its lists are long.

    Raises
    ------
    DetailError
        Its views fit no paper up to A1 at any scale.
    """
    projected = project(drawing.views, boundary, mesh)
    entries = list(_entries([*drawing.lists, *extra, *_notes(drawing)]))
    best: _Tried | None = None
    for tried in _tries(projected, entries):
        if best is None or tried.crowded < best.crowded:
            best = tried
        if tried.good and not tried.crowded:
            best = tried
            break
    if best is None:
        raise DetailError(f"the sheet of {subject} fits no paper up to A1 at any scale of ISO 5455")
    paper, arranged, area, here, later = (
        best.paper, best.arranged, best.area, best.here, best.later,
    )  # fmt: skip
    block = replace(block, scale=scale_text(arranged.scale))
    rest = list(_pages(later))
    count = 1 + len(rest)
    items: list[Item] = [*frame_items(paper), *block_items(paper, block, 1, count)]
    items += _column(here, _column_rectangle(paper))
    outlines: list[Item] = []
    dimensions: list[Dimension] = []
    placed = []
    for view, (x, y) in into(arranged, area):
        outlines += [item.moved(x, y) for item in view.outlines]
        items += [item.moved(x, y) for item in view.items]
        dimensions += [dimension.moved(x, y) for dimension in view.dimensions]
        (x0, y0), (x1, y1) = view.extent()
        placed.append(Placed(view.view.title, view.scale, (x0 + x, y0 + y), (x1 + x, y1 + y)))
    sheets = [
        Sheet(
            subject, subject, paper, tuple(items), tuple(dimensions), tuple(placed), tuple(outlines)
        )
    ]
    for n, entries_ in enumerate(rest, 2):
        own = [*frame_items(A4), *block_items(A4, replace(block, scale=""), n, count)]
        own += _column(entries_, _column_rectangle(A4), at_top=True)
        sheets.append(Sheet(subject, f"{subject} ({n})", A4, tuple(own)))
    return sheets


def _notes(drawing: Drawing) -> list[Paragraph]:
    return [Paragraph("Notes", " ".join(drawing.notes))] if drawing.notes else []


def _entries(parts: Sequence[List | Paragraph]) -> Iterator[_Entry]:
    """Lists in parts as wide as the title block, paragraphs in lines."""
    for part in parts:
        if isinstance(part, Paragraph):
            yield _Entry(title=part.title, lines=tuple(wrap(part.text, WIDE - 2.0 * INSET, LEAST)))
        elif part.rows:
            yield from (_Entry(table) for table in by_columns(part, WIDE - 2.0 * INSET))


def _column_rectangle(paper: Paper) -> Rectangle:
    """Where lists are: above the title block."""
    about, frame = block_rectangle(paper), frame_of(paper)
    return Rectangle(about.x0 + INSET, about.y1, about.x1 - INSET, frame.y1 - GAP)


def _room(
    paper: Paper, entries: Sequence[_Entry], share: float
) -> tuple[list[_Entry], list[_Entry], Rectangle]:
    """The entries on the first sheet, those on later ones, and the room for views."""
    column, frame = _column_rectangle(paper), frame_of(paper)
    beside = column.x0 > frame.x0 + 10.0
    most = column.height if beside else share * column.height
    here: list[_Entry] = []
    later: list[_Entry] = []
    used = 0.0
    for entry in entries:
        first, rest = entry.split(most - used) if not later else (None, entry)
        if first is not None:
            here.append(first)
            used += first.height
        if rest is not None:
            later.append(rest)
    if beside:
        area = Rectangle(frame.x0 + GAP, frame.y0 + GAP, column.x0 - GAP, frame.y1 - GAP)
    else:
        area = Rectangle(frame.x0 + GAP, column.y0 + used + GAP, frame.x1 - GAP, frame.y1 - GAP)
    return here, later, area


def _pages(entries: Sequence[_Entry]) -> Iterator[list[_Entry]]:
    """Entries on sheets of A4."""
    height = _column_rectangle(A4).height
    page: list[_Entry] = []
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


def _column(entries: Sequence[_Entry], area: Rectangle, *, at_top: bool = False) -> list[Item]:
    """Entries below each other, down to the bottom of a column or from its top."""
    top = area.y1 if at_top else area.y0 + sum(entry.height for entry in entries)
    items: list[Item] = []
    for entry in entries:
        items += entry.items(area.x0, top, area.width)
        top -= entry.height
    return items

"""A part's sheets: views, lists, frame and title block on the smallest paper that shows it well."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

from ddgfab.errors import DetailError
from fabrication.boundary import Boundary
from fabrication.drawings.arrange import Arranged, arrange, extent_of, into, project, scale_text
from fabrication.drawings.block import Block, block_items, cut_short, frame_items
from fabrication.drawings.columns import (
    GAP,
    Entry,
    Paragraph,
    column_items,
    column_rectangle,
    entries_of,
    list_sheets,
    page_count,
)
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
    frame_of,
)
from fabrication.drawings.views import Drawing, List
from fabrication.specs import TriangleMesh

PAPERS: Final = ((A4, 1.0 / 20.0), (A3, 1.0 / 50.0), (A2, 0.0), (A1, 0.0))
"""Papers, and the least scale at which a part is shown on each."""

LEAST_VIEW: Final = 20.0
LEAST_BROKEN: Final = 10.0
"""The main view is to be so high and wide [mm], unless the part itself is smaller; that of a long
part, which may be shown without its middle."""

PART_OF_SHEET: Final = 0.45
MOST_OF_SHEET: Final = 0.65
"""Lists take at most this part of the height that views and lists share on the first sheet; the
larger one where they need no second sheet then."""


@dataclass(frozen=True, eq=False)
class _Tried:
    """A paper with views and lists on it; good: the views are large enough for it."""

    paper: Paper
    arranged: Arranged
    area: Rectangle
    here: list[Entry]
    later: list[Entry]
    good: bool

    @property
    def crowded(self) -> int:
        """How many texts found no good place."""
        return sum(view.crowded for view in self.arranged.views)


def _tries(projected: Sequence[Projected], entries: Sequence[Entry]) -> Iterator[_Tried]:
    """Papers from the smallest; on A4 all lists below the views, if they may, then a part."""
    main = projected[0]
    size = extent_of(main)
    wanted = LEAST_BROKEN if main.view.breaks else LEAST_VIEW
    total = sum(entry.height for entry in entries) / column_rectangle(A4).height
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
    entries = list(entries_of([*drawing.lists, *extra, *_notes(drawing), *_in_full(block)]))
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
    count = 1 + page_count(later)
    items: list[Item] = [*frame_items(paper), *block_items(paper, block, 1, count)]
    items += column_items(here, column_rectangle(paper))
    outlines: list[Item] = []
    dimensions: list[Dimension] = []
    placed = []
    for view, (x, y) in into(arranged, area):
        outlines += [item.moved(x, y) for item in view.outlines]
        items += [item.moved(x, y) for item in view.items]
        dimensions += [dimension.moved(x, y) for dimension in view.dimensions]
        (x0, y0), (x1, y1) = view.whole
        placed.append(Placed(view.view.title, view.scale, (x0 + x, y0 + y), (x1 + x, y1 + y)))
    first = Sheet(
        subject, subject, paper, tuple(items), tuple(dimensions), tuple(placed), tuple(outlines)
    )
    return [first, *list_sheets(later, block, subject, subject, before=1)]


def _notes(drawing: Drawing) -> list[Paragraph]:
    return [Paragraph("Notes", " ".join(drawing.notes))] if drawing.notes else []


def _in_full(block: Block) -> list[Paragraph]:
    return [Paragraph(f"{label}, in full", value) for label, value in cut_short(block)]


def _room(
    paper: Paper, entries: Sequence[Entry], share: float
) -> tuple[list[Entry], list[Entry], Rectangle]:
    """The entries on the first sheet, those on later ones, and the room for views."""
    column, frame = column_rectangle(paper), frame_of(paper)
    beside = column.x0 > frame.x0 + 10.0
    most = column.height if beside else share * column.height
    here: list[Entry] = []
    later: list[Entry] = []
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

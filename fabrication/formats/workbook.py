"""Sheets of a workbook: a printable table a schedule; the first and the last are in `cover`."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Final, TypeAlias

from fabrication.formats.base import Title
from fabrication.formats.tables import (
    Legend,
    Row,
    columns_of,
    decimals,
    heading,
    plain,
    shown_decimals,
)

Sheet: TypeAlias = Any
Format: TypeAlias = Any

PAPERS: Final = {"A3": 8, "A4": 9}
"""Excel's numbers of the papers."""

FONT: Final = {"font_name": "Arial", "font_size": 9}
FONT_MM: Final = 9 * 25.4 / 72
LEAST_MM: Final = 2.5
"""Size of the font at full size, and the least when printed; sheets with more columns than fit
so are split."""

PAPER_PT: Final = {"A3": 1133.0, "A4": 784.0}
"""Printed width of the papers in landscape, without margins [pt]."""

DIGIT_PT: Final = 5.25
PADDING_PT: Final = 3.75
"""Width of a digit, and what a column has beside its digits [pt]."""

NARROWEST: Final = 6
WIDEST: Final = 90
"""Widths of columns, in digits; longer texts go on in the next line of their cell."""

BUTTON: Final = 2
"""What the filter's button takes of a header, in digits."""

LINE: Final = 12.0
"""Height of a line [pt]."""

LONGEST: Final = 32_000
"""Characters that a cell holds; Excel refuses 32,768."""

NUMBERED: Final = re.compile(r"_(\d+)(?=_|$)")
"""The number in names of columns such as edge_1_mm."""

NAME: Final = 31
"""Characters of a sheet's name."""

FOOTER: Final = 60
"""Characters of a text in a footer, which has room for 255 in all."""

COVER: Final = "cover"
COLUMNS: Final = "columns"
"""Names of the first and of the last sheet."""

UNITS: Final = (
    "Lengths in mm, areas in m2, masses in kg, angles in degrees, unless a column says so."
)


@dataclass(frozen=True)
class Book:
    """A workbook of xlsxwriter that is being written, its title block, and its paper."""

    workbook: Any
    title: Title
    paper: str

    def format(self, **properties: Any) -> Format:
        """A format in the workbook's font."""
        return self.workbook.add_format({**FONT, "valign": "top", **properties})

    def cell(self, **properties: Any) -> Format:
        """The same for cells of tables, with a hairline below."""
        return self.format(bottom=4, bottom_color="#BFBFBF", **properties)

    def add(self, name: str, subject: str) -> Sheet:
        """A sheet that prints on as many landscape pages as it is long, with a footer."""
        sheet = self.workbook.add_worksheet(name[:NAME])
        sheet.set_landscape()
        sheet.set_paper(PAPERS[self.paper])
        sheet.fit_to_pages(1, 0)
        sheet.set_margins(left=0.4, right=0.4, top=0.5, bottom=0.6)
        title = self.title
        known = [title.title, title.number, f"rev. {title.revision}" if title.revision else ""]
        left = " - ".join(_code(text, FOOTER // 2) for text in [*known, title.date] if text)
        sheet.set_footer(f"&L&8{_spaced(left)}&C&8 {_code(subject, FOOTER // 2)}&R&8 page &P of &N")
        return sheet


def _code(text: str, most: int) -> str:
    """A text for a footer, where & begins a code."""
    cut = text if len(text) <= most else f"{text[: most - 3]}..."
    return cut.replace("&", "&&")


def _spaced(text: str) -> str:
    """A text that no digit of joins the size of the font before it."""
    return f" {text}" if text else ""


# --- tables ----------------------------------------------------------------------------------
def sheets_of(
    name: str, rows: Sequence[Row], names: Sequence[str], legend: Legend, paper: str
) -> list[tuple[str, list[Row], list[str]]]:
    """The sheets of a schedule: name, rows and columns of each.

    One, where its columns fit the paper with texts of `LEAST_MM` or more; else so many that they
    do. Each begins with the columns that name the piece; columns of one number stay together, and
    those that say the same in all rows come last.
    """
    room = PAPER_PT[paper] * FONT_MM / LEAST_MM
    taken = {column: 0.0 if legend.hides(column) else _points(column, rows) for column in names}
    if sum(taken.values()) <= room or not names or not rows:
        return [(name, list(rows), list(names))]
    keys = [names[0], *(column for column in names[1:] if column == "number")]
    first = sum(taken[column] for column in keys)
    parts, used = [list(keys)], first
    others = [column for column in names if column not in keys]
    others.sort(key=lambda column: _is_constant(column, rows) and column not in legend.totals)
    for block in _blocks(others):
        wide = sum(taken[column] for column in block)
        if used + wide > room and len(parts[-1]) > len(keys):
            parts.append(list(keys))
            used = first
        parts[-1] += block
        used += wide
    return [
        (
            name if k == 1 else f"{name[: NAME - 5]} ({k})",
            [{column: row[column] for column in part if column in row} for row in rows],
            part,
        )
        for k, part in enumerate(parts, 1)
    ]


def _is_constant(column: str, rows: Sequence[Row]) -> bool:
    """Whether a column without a number says the same in all rows."""
    first = rows[0].get(column)
    alike = all(row.get(column) == first for row in rows)
    return alike and NUMBERED.search(column) is None and column != "status"


def _blocks(names: Sequence[str]) -> list[list[str]]:
    """Columns in a row that have the same number in their names, as those of one arm; or one."""
    found: list[list[str]] = []
    last = ""
    for column in names:
        number = NUMBERED.search(column)
        own = number[1] if number else ""
        if own and own == last:
            found[-1].append(column)
        else:
            found.append([column])
        last = own
    return found


def _points(column: str, rows: Sequence[Row]) -> float:
    """Width [pt] that a column takes at full size."""
    places = decimals(column)
    width, _ = _width(column, [_cell(row.get(column), places) for row in rows])
    return DIGIT_PT * width + PADDING_PT


def add_table(
    book: Book, name: str, rows: Sequence[Row], names: Sequence[str], legend: Legend
) -> None:
    """A schedule: filters, header on every page, numbers by unit, totals below the rows."""
    sheet = book.add(name, legend.title or name)
    left, right = (
        book.format(
            bold=True,
            text_wrap=True,
            bg_color="#E7E6E6",
            bottom=1,
            left=4,
            right=4,
            left_color="#7F7F7F",
            right_color="#7F7F7F",
            **way,
        )
        for way in ({"align": "left", "indent": 1}, {"align": "right"})
    )
    bold = book.format(bold=True, top=1)
    sheet.set_default_row(LINE)
    columns, heights, taken = [], [1], [1] * len(rows)
    for at, column in enumerate(names):
        places = decimals(column)
        values = [_cell(row.get(column), places) for row in rows]
        width, lines = _width(column, values)
        if not legend.hides(column):
            heights.append(lines)
            taken = [max(n, _lines(v, width)) for n, v in zip(taken, values, strict=True)]
        number = f"0.{'0' * shown_decimals(column)}"
        look = book.cell(num_format=number)
        total = book.format(num_format=number, bold=True, top=1)
        if all(isinstance(value, int) for value in values):
            total = book.format(num_format="0", bold=True, top=1)
        text, whole = book.cell(text_wrap=True, align="left", indent=1), book.cell(num_format="0")
        hidden = {"hidden": True} if legend.hides(column) else {}
        sheet.set_column(at, at, width, None, hidden)
        for line, value in enumerate(values, start=1):
            _write(sheet, line, at, value, (look, whole, text))
        header = right if _is_number(values) else left
        if column in legend.totals and rows:
            _add_up(sheet, len(rows) + 1, at, values, total)
        elif has_total(rows, legend):
            sheet.write_string(len(rows) + 1, at, "" if at else "Total", bold)
        columns.append({"header": heading(column), "header_format": header})
        sheet.write_string(0, at, heading(column), header)
    sheet.set_row(0, LINE * max(heights) + 3)
    for line, many in enumerate(taken, start=1):
        if many > 1:
            sheet.set_row(line, LINE * many)
    sheet.freeze_panes(1, 1)
    sheet.repeat_rows(0)
    if not rows or not names:
        return
    sheet.add_table(
        0,
        0,
        len(rows),
        len(names) - 1,
        {"name": _table_name(name), "style": "Table Style Light 1", "columns": columns},
    )


def has_total(rows: Sequence[Row], legend: Legend) -> bool:
    """Whether a schedule has a row of totals."""
    return bool(rows) and bool(set(legend.totals) & set(columns_of(rows)))


def _add_up(sheet: Sheet, line: int, at: int, values: Sequence[Any], look: Format) -> None:
    """The sum of a column below the table: of the rows that a filter leaves."""
    from xlsxwriter.utility import xl_col_to_name

    numbers = [value for value in values if isinstance(value, int | float)]
    column = xl_col_to_name(at)
    formula = f"=SUBTOTAL(109,{column}2:{column}{line})"
    sheet.write_formula(line, at, formula, look, math.fsum(numbers))


def _table_name(name: str) -> str:
    """A name that Excel takes for a table."""
    return "t_" + "".join(c if c.isalnum() and c.isascii() else "_" for c in name)


def _cell(value: Any, places: int) -> str | int | float | bool | None:
    """A value as a cell has it; texts that are too long are cut."""
    cell = plain(value, places)
    if isinstance(cell, str) and len(cell) > LONGEST:
        return f"{cell[:LONGEST]}... (all: in the CSV)"
    return cell


def _write(sheet: Sheet, line: int, at: int, value: Any, looks: tuple[Format, ...]) -> None:
    """One cell; text is never taken for a formula or a link."""
    number, whole, text = looks
    if isinstance(value, bool):
        sheet.write_boolean(line, at, value, text)
    elif isinstance(value, int):
        sheet.write_number(line, at, value, whole)
    elif isinstance(value, float):
        sheet.write_number(line, at, value, number)
    elif value is None:
        sheet.write_blank(line, at, None, text)
    else:
        sheet.write_string(line, at, value, text)


def _width(column: str, values: Sequence[Any]) -> tuple[int, int]:
    """Width of a column in digits, and how many lines its header takes in it."""
    places = shown_decimals(column)
    longest = max((len(_shown(value, places)) for value in values), default=0) + 2
    words = heading(column).split()
    width = max(longest, max(map(len, words)) + BUTTON, NARROWEST)
    width = min(width, WIDEST)
    lines, room = 1, width - BUTTON
    taken = len(words[0])
    for _, word in pairwise(words):
        taken += 1 + len(word)
        if taken > room:
            lines, taken = lines + 1, len(word)
    return width, lines


def _is_number(values: Sequence[Any]) -> bool:
    """Whether a column has numbers, and nothing else."""
    known = [value for value in values if value is not None]
    return bool(known) and all(isinstance(value, int | float) for value in known)


def _lines(value: Any, width: int) -> int:
    """How many lines a text takes in a column."""
    return math.ceil(len(value) / (width - BUTTON)) if isinstance(value, str) else 1


def _shown(value: Any, places: int) -> str:
    if value is None:
        return ""
    return f"{value:.{places}f}" if isinstance(value, float) else str(value)

"""XLSX: one Excel workbook, made to be printed: a cover, a sheet a schedule, and a legend."""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import ClassVar, Final

from ddgfab.errors import OutputError, clipped
from ddgfab.io.atomic import atomic_write
from fabrication.formats.archive import UNREADABLE
from fabrication.formats.base import Contents, Format, Title, Whole
from fabrication.formats.cover import add_columns, add_cover
from fabrication.formats.dates import epoch_time
from fabrication.formats.tables import SCHEDULES, Legend, Row, columns_of
from fabrication.formats.workbook import (
    FONT,
    PAPERS,
    Book,
    add_table,
    has_total,
    sheets_of,
)
from fabrication.specs import Check

WORKBOOK: Final = f"{SCHEDULES}/schedule.xlsx"
"""Name of the file."""

LONGEST_PROPERTY: Final = 255
"""Characters of a property of the file."""

_EPOCH: Final = datetime(2000, 1, 1)
"""The date of creation where neither the project nor SOURCE_DATE_EPOCH has one."""


class Xlsx(Format):
    """XLSX: schedules/schedule.xlsx."""

    name = "xlsx"
    suffixes = (".xlsx",)
    by_default = "always"
    needs = {"xlsxwriter": "xlsxwriter"}  # noqa: RUF012
    libraries = ("xlsxwriter",)
    options: ClassVar[Mapping[str, tuple[str, ...]]] = {"paper": tuple(PAPERS)}

    def whole_files(self, contents: Contents) -> list[str]:
        """The workbook."""
        return [WORKBOOK]

    def write_whole(self, folder: Path, whole: Whole) -> list[str]:
        """A cover, the schedules, and what their columns mean."""
        (folder / SCHEDULES).mkdir(exist_ok=True)
        write_xlsx(
            folder / WORKBOOK,
            whole.tables or {},
            legends=whole.legends,
            cover=whole,
            paper=self.option(whole.about, "paper"),
        )
        return []

    def check_whole(self, folder: Path, whole: Whole) -> list[Check]:
        """Read back: a sheet a schedule with header, as many rows, and sums where it has any."""
        checks = []
        paper = self.option(whole.about, "paper")
        sheets = [
            (name, part, whole.legends.get(table, Legend()))
            for table, rows in (whole.tables or {}).items()
            for name, part, _ in sheets_of(
                table, rows, columns_of(rows), whole.legends.get(table, Legend()), paper
            )
        ]
        for place, (name, rows, legend) in enumerate(sheets, 2):
            try:
                with zipfile.ZipFile(folder / WORKBOOK) as book:
                    sheet = book.read(f"xl/worksheets/sheet{place}.xml")
            except UNREADABLE as error:
                checks.append(Check(f"xlsx {name} readable", False, clipped(error)))
                continue
            found = len(re.findall(rb"<row ", sheet))
            # A schedule without rows may have no columns, and then an empty header.
            below = has_total(rows, legend)
            wanted = len(rows) + 1 + below if rows else min(found, 1)
            checks.append(Check(f"xlsx {name} rows", found == wanted, float(found), float(wanted)))
        return checks


FORMAT: Final = Xlsx()


def write_xlsx(
    path: Path,
    sheets: Mapping[str, Sequence[Row]],
    columns: Mapping[str, Sequence[str]] | None = None,
    *,
    legends: Mapping[str, Legend] | None = None,
    cover: Whole | None = None,
    paper: str = "A3",
) -> None:
    """Write rows as an Excel workbook, one sheet and one table a schedule (atomically).

    Numbers are rounded as in the CSV and shown with fewer decimals; text is never taken for a
    formula or a link. Sheets print in landscape, as wide as the paper, with the header on every
    page.

    Parameters
    ----------
    columns : which, in order, by sheet; by default all
    legends : titles, totals and meanings, by sheet
    cover : what the cover is about; without it there is neither cover nor legend
    paper : "A3" or "A4"

    Raises
    ------
    OutputError
        The file cannot be written, or xlsxwriter is not installed.
    """
    try:
        import xlsxwriter
    except ImportError as error:
        raise OutputError(f"{path}: needs xlsxwriter: pip install xlsxwriter") from error
    options = {
        "in_memory": True,  # a disk that is full would leave temporary files open
        "strings_to_formulas": False,
        "strings_to_urls": False,
        "strings_to_numbers": False,
        "default_format_properties": dict(FONT),  # xlsxwriter writes into it
    }
    known = legends or {}
    stream = io.BytesIO()
    with xlsxwriter.Workbook(stream, options) as workbook:
        title = Title() if cover is None else cover.about.title
        workbook.set_properties({"created": _created(title), **_properties(title)})
        book = Book(workbook, title, paper)
        if cover is not None:
            add_cover(book, cover)
        for name, rows in sheets.items():
            chosen = None if columns is None else columns.get(name)
            legend = known.get(name, Legend())
            names = list(chosen or columns_of(rows))
            for title_of, part, own in sheets_of(name, rows, names, legend, paper):
                add_table(book, title_of, part, own, legend)
        if cover is not None:
            add_columns(book, sheets, known)
    with atomic_write(path) as file:
        file.write(stream.getvalue())


def _properties(title: Title) -> dict[str, str]:
    """What the file states of itself."""
    found = {"title": title.title, "author": title.author, "subject": title.number}
    return {key: text[:LONGEST_PROPERTY] for key, text in found.items() if text}


def _created(title: Title) -> datetime:
    """The workbook's date: never the clock's, so that the same rows give the same bytes."""
    if found := epoch_time():
        return found
    return datetime.fromisoformat(title.date) if title.date else _EPOCH

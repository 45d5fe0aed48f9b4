"""XLSX: one Excel workbook, a sheet and a table a schedule."""

from __future__ import annotations

import io
import os
import re
import struct
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any, Final

from ddgfab.errors import OutputError, clipped
from ddgfab.io.atomic import atomic_write
from fabrication.formats.base import Format, Whole
from fabrication.formats.tables import SCHEDULES, Row, columns_of, decimals, plain
from fabrication.specs import Check

WORKBOOK: Final = f"{SCHEDULES}/schedule.xlsx"
"""Name of the file."""

_EPOCH: Final = datetime(2000, 1, 1)  # written as the creation date unless SOURCE_DATE_EPOCH is set
_WIDEST: Final = 40
_UNREADABLE: Final = (
    *(OSError, zipfile.BadZipFile, zlib.error, KeyError, ValueError, EOFError),
    *(NotImplementedError, RuntimeError, struct.error),
)
"""What an archive that is damaged comes to."""


class Xlsx(Format):
    """XLSX: schedules/schedule.xlsx."""

    name = "xlsx"
    suffixes = (".xlsx",)
    by_default = "always"
    needs = {"xlsxwriter": "xlsxwriter"}  # noqa: RUF012
    libraries = ("xlsxwriter",)

    def whole_files(self, tables: Sequence[str], plates: int) -> list[str]:
        """The workbook."""
        return [WORKBOOK]

    def write_whole(self, folder: Path, whole: Whole) -> list[str]:
        """See `write_xlsx`."""
        (folder / SCHEDULES).mkdir(exist_ok=True)
        write_xlsx(folder / WORKBOOK, whole.tables or {})
        return []

    def check_whole(self, folder: Path, whole: Whole) -> list[Check]:
        """Read back: a sheet a schedule with as many rows, and its header."""
        checks = []
        for place, (name, rows) in enumerate((whole.tables or {}).items(), 1):
            try:
                with zipfile.ZipFile(folder / WORKBOOK) as book:
                    sheet = book.read(f"xl/worksheets/sheet{place}.xml")
            except _UNREADABLE as error:
                checks.append(Check(f"xlsx {name} readable", False, clipped(error)))
                continue
            found = len(re.findall(rb"<row ", sheet))
            # A schedule without rows may have no columns, and then no header either.
            wanted = len(rows) + 1 if rows else min(found, 1)
            checks.append(Check(f"xlsx {name} rows", found == wanted, float(found), float(wanted)))
        return checks


FORMAT: Final = Xlsx()


def write_xlsx(
    path: Path,
    sheets: Mapping[str, Sequence[Row]],
    columns: Mapping[str, Sequence[str]] | None = None,
) -> None:
    """Write rows as an Excel workbook, one sheet and one table a schedule (atomically).

    Numbers are rounded as in the CSV; text is never taken for a formula or a link.

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
    }
    stream = io.BytesIO()
    with xlsxwriter.Workbook(stream, options) as workbook:
        workbook.set_properties({"created": _created()})
        for name, rows in sheets.items():
            chosen = None if columns is None else columns.get(name)
            _sheet(workbook, name, rows, list(chosen or columns_of(rows)))
    with atomic_write(path) as file:
        file.write(stream.getvalue())


def _sheet(workbook: Any, name: str, rows: Sequence[Row], names: list[str]) -> None:
    """One sheet: a real table with a frozen header and a number format a column."""
    sheet = workbook.add_worksheet(name[:31])
    sheet.freeze_panes(1, 0)
    header = workbook.add_format({"bold": True})
    for at, column in enumerate(names):
        places = decimals(column)
        values = [plain(row.get(column), places) for row in rows]
        number = workbook.add_format({"num_format": f"0.{'0' * places}"})
        sheet.write_string(0, at, column, header)
        widest = len(column) + 3
        for line, value in enumerate(values, start=1):
            if isinstance(value, bool):
                sheet.write_boolean(line, at, value)
            elif isinstance(value, int):
                sheet.write_number(line, at, value)
            elif isinstance(value, float):
                sheet.write_number(line, at, value, number)
            elif value is not None:
                sheet.write_string(line, at, value)
                widest = max(widest, len(value) + 1)
        sheet.set_column(at, at, min(widest, _WIDEST))
    if rows and names:
        table = re.sub(r"\W", "_", name) or "table"
        sheet.add_table(
            0,
            0,
            len(rows),
            len(names) - 1,
            {
                "name": f"t_{table}",
                "style": "Table Style Light 1",
                "columns": [{"header": column} for column in names],
            },
        )


def _created() -> datetime:
    """The workbook's date: fixed, so that the same rows give the same bytes."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "")
    return datetime(1970, 1, 1) + timedelta(seconds=int(epoch)) if epoch.isdigit() else _EPOCH

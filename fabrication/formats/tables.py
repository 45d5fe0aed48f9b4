"""Schedules as CSV and as Excel workbooks, from rows that are plain dictionaries."""

from __future__ import annotations

import csv
import io
import math
import os
import re
from collections.abc import Mapping, Sequence
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any, Final, TypeAlias

import numpy as np

from ddgfab.errors import OutputError
from ddgfab.io.atomic import atomic_path, atomic_write

Row: TypeAlias = Mapping[str, Any]

DECIMALS: Final[tuple[tuple[str, int], ...]] = (
    ("_mm", 3),
    ("_mm2", 1),
    ("_mm3", 1),
    ("_m", 4),
    ("_m2", 4),
    ("_m3", 6),
    ("_deg", 4),
    ("_kg", 3),
    ("_g", 2),
    ("_percent", 4),
    ("axis_x", 9),
    ("axis_y", 9),
    ("axis_z", 9),
)
"""Decimals by the end of a column's name, that is by its unit."""

OTHER_DECIMALS: Final = 6
"""Decimals of numbers in columns without a known unit."""

_EPOCH: Final = datetime(2000, 1, 1)  # written as the creation date unless SOURCE_DATE_EPOCH is set
_WIDEST: Final = 40


def columns_of(rows: Sequence[Row]) -> list[str]:
    """The rows' keys in order of first appearance."""
    return list(dict.fromkeys(key for row in rows for key in row))


def decimals(column: str) -> int:
    """How many decimals the numbers of a column have."""
    return next((places for end, places in DECIMALS if column.endswith(end)), OTHER_DECIMALS)


def csv_text(rows: Sequence[Row], columns: Sequence[str] | None = None) -> str:
    r"""The rows as CSV: comma, dot decimals, \n, fixed decimals by unit, empty for None and NaN.

    Parameters
    ----------
    columns : which, in order; by default all, in order of first appearance. A row may lack some.
    """
    names = list(columns_of(rows) if columns is None else columns)
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(names)
    places = [decimals(name) for name in names]
    writer.writerows(
        [_text(row.get(name), place) for name, place in zip(names, places, strict=True)]
        for row in rows
    )
    return stream.getvalue()


def write_csv(path: Path, rows: Sequence[Row], columns: Sequence[str] | None = None) -> None:
    """Write rows as CSV, UTF-8 (atomically); see `csv_text`.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    with atomic_write(path) as file:
        file.write(csv_text(rows, columns).encode("utf-8"))


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
    options = {"strings_to_formulas": False, "strings_to_urls": False, "strings_to_numbers": False}
    with atomic_path(path) as temporary:
        try:
            with xlsxwriter.Workbook(str(temporary), options) as workbook:
                workbook.set_properties({"created": _created()})
                for name, rows in sheets.items():
                    chosen = None if columns is None else columns.get(name)
                    _sheet(workbook, name, rows, list(chosen or columns_of(rows)))
        except xlsxwriter.exceptions.FileCreateError as error:
            cause = error.args[0] if error.args else error
            raise cause if isinstance(cause, OSError) else OSError(str(cause)) from error


def _sheet(workbook: Any, name: str, rows: Sequence[Row], names: list[str]) -> None:
    """One sheet: a real table with a frozen header and a number format a column."""
    sheet = workbook.add_worksheet(name[:31])
    sheet.freeze_panes(1, 0)
    header = workbook.add_format({"bold": True})
    for at, column in enumerate(names):
        places = decimals(column)
        values = [_plain(row.get(column), places) for row in rows]
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


def _plain(value: Any, places: int) -> str | int | float | bool | None:
    """A cell's value as one of Python's own, floats rounded, None for NaN and infinities."""
    if isinstance(value, np.generic):
        value = value.item()
    if value is None or isinstance(value, (bool, int, str)):
        return value
    if isinstance(value, float):
        return round(value, places) + 0.0 if math.isfinite(value) else None
    return str(value)


def _text(value: Any, places: int) -> str:
    """A cell of the CSV; never in exponent form, never a negative zero."""
    plain = _plain(value, places)
    if plain is None:
        return ""
    if isinstance(plain, bool):
        return "true" if plain else "false"
    return f"{plain:.{places}f}" if isinstance(plain, float) else str(plain)


def _created() -> datetime:
    """The workbook's date: fixed, so that the same rows give the same bytes."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "")
    return datetime(1970, 1, 1) + timedelta(seconds=int(epoch)) if epoch.isdigit() else _EPOCH

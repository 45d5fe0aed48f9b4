"""CSV: a file a schedule, from rows of plain values; columns.csv says what its columns mean."""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

from ddgfab.errors import InputError, clipped
from ddgfab.io.atomic import atomic_write
from ddgfab.io.regular import read_regular
from fabrication.formats.base import Contents, Format, Whole
from fabrication.formats.report import FileReport
from fabrication.formats.tables import (
    SCHEDULES,
    Legend,
    Row,
    columns_of,
    decimals,
    text_of,
    unit_of,
)
from fabrication.specs import Check

COLUMNS: Final = f"{SCHEDULES}/columns.csv"
"""File with unit and meaning of every column of every schedule."""

LIMIT_BYTES: Final = 128 * 1024 * 1024
"""Larger files are refused."""

COLUMNS_MOST: Final = 16_384
"""Tables of more columns are refused; spreadsheets have no more."""

SHOWN: Final = 100
"""So many lines of the wrong length are named one by one."""


class Csv(Format):
    """CSV: schedules/NAME.csv for each schedule, and schedules/columns.csv."""

    name = "csv"
    suffixes = (".csv",)
    by_default = "always"

    def whole_files(self, contents: Contents) -> list[str]:
        """A file a schedule, and their legend."""
        return [*(f"{SCHEDULES}/{name}.csv" for name in contents.tables), COLUMNS]

    def write_whole(self, folder: Path, whole: Whole) -> list[str]:
        """See `csv_text`."""
        (folder / SCHEDULES).mkdir(exist_ok=True)
        for name, rows in (whole.tables or {}).items():
            path = folder / SCHEDULES / f"{name}.csv"
            path.write_bytes(csv_text(rows).encode("utf-8"))
        legend = column_rows(whole.tables or {}, whole.legends)
        (folder / COLUMNS).write_bytes(csv_text(legend, LEGEND).encode("utf-8"))
        return []

    def check_whole(self, folder: Path, whole: Whole) -> list[Check]:
        """Read back: as many rows as the schedule has, each as wide as the header."""
        tables = whole.tables or {}
        checks = [
            _read_back(folder / SCHEDULES / f"{name}.csv", name, columns_of(rows), len(rows))
            for name, rows in tables.items()
        ]
        explained = sum(len(columns_of(rows)) for rows in tables.values())
        return [*checks, _read_back(folder / COLUMNS, "columns", LEGEND, explained)]

    def inspect(self, path: Path) -> FileReport:
        """Its rows and columns; see `Format.inspect`."""
        return inspect_csv(path)


FORMAT: Final = Csv()

LEGEND: Final = ("table", "column", "unit", "meaning")
"""Columns of columns.csv."""


def _read_back(path: Path, name: str, columns: Sequence[str], count: int) -> Check:
    """Whether a file has these columns, and so many rows, each with all of them."""
    try:
        with path.open(encoding="utf-8", newline="") as file:
            header, *found = list(csv.reader(file)) or [[]]
    except (OSError, ValueError, csv.Error) as error:
        return Check(f"csv {name} readable", False, clipped(error))
    whole = header == list(columns) and all(len(row) == len(header) for row in found)
    return Check(f"csv {name} rows", whole and len(found) == count, float(len(found)), float(count))


def column_rows(
    tables: Mapping[str, Sequence[Row]], legends: Mapping[str, Legend]
) -> list[dict[str, str]]:
    """Table, name, unit and meaning of every column of every schedule."""
    return [
        {
            "table": name,
            "column": column,
            "unit": unit_of(column),
            "meaning": legends.get(name, Legend()).meaning(column),
        }
        for name, rows in tables.items()
        for column in columns_of(rows)
    ]


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
        [text_of(row.get(name), place) for name, place in zip(names, places, strict=True)]
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


def inspect_csv(path: Path) -> FileReport:
    """Whether a CSV is a table: named columns, each name once, each row with all of them.

    Raises
    ------
    InputError
        Missing, not UTF-8, or without a header.
    """
    data = read_regular(path, LIMIT_BYTES, InputError, what="a CSV file", advice="split the table")
    count, wrong, uneven = 0, 0, []
    try:
        text = io.TextIOWrapper(io.BytesIO(data), encoding="utf-8-sig", newline="")
        reader = csv.reader(text, strict=True)
        header = next(reader, None)
        if not header:
            raise InputError("has no header", file=str(path))
        if len(header) > COLUMNS_MOST:
            raise InputError(f"has {len(header)} columns; {COLUMNS_MOST} are read", file=str(path))
        for row in reader:
            count += 1
            wrong += len(row) != len(header)
            if len(row) != len(header) and wrong <= SHOWN:
                uneven.append(f"line {reader.line_num} has {len(row)} cells, not {len(header)}")
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"not a CSV in UTF-8 ({error})", file=str(path)) from error
    problems = [f"column {at} has no name" for at, name in enumerate(header, 1) if not name]
    problems += [
        f'{often} columns are named "{name}"'
        for name, often in Counter(header).items()
        if name and often > 1
    ]
    problems += uneven
    problems += [f"{wrong} lines have more or fewer cells"] if wrong > SHOWN else []
    contents = ", ".join(
        f"{number} {what}{'' if number == 1 else 's'}"
        for number, what in ((count, "row"), (len(header), "column"))
    )
    return FileReport(str(path), "CSV", contents, tuple(problems), sound="every row complete")

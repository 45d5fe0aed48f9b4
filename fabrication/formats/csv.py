"""CSV: a file a schedule, from rows that are plain dictionaries."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from ddgfab.io.atomic import atomic_write
from fabrication.formats.base import Format, Whole
from fabrication.formats.tables import SCHEDULES, Row, columns_of, decimals, text_of
from fabrication.specs import Check


class Csv(Format):
    """CSV: schedules/NAME.csv for each schedule."""

    name = "csv"
    suffixes = (".csv",)

    def whole_files(self, tables: Sequence[str], plates: int) -> list[str]:
        """A file a schedule."""
        return [f"{SCHEDULES}/{name}.csv" for name in tables]

    def write_whole(self, folder: Path, whole: Whole) -> list[str]:
        """See `csv_text`."""
        (folder / SCHEDULES).mkdir(exist_ok=True)
        for name, rows in (whole.tables or {}).items():
            path = folder / SCHEDULES / f"{name}.csv"
            path.write_bytes(csv_text(rows).encode("utf-8"))
        return []

    def check_whole(self, folder: Path, whole: Whole) -> list[Check]:
        """Read back: as many rows as the schedule has, each as wide as the header."""
        checks = []
        for name, rows in (whole.tables or {}).items():
            with (folder / SCHEDULES / f"{name}.csv").open(encoding="utf-8", newline="") as file:
                header, *found = list(csv.reader(file)) or [[]]
            whole_rows = header == columns_of(rows) and all(len(r) == len(header) for r in found)
            right = whole_rows and len(found) == len(rows)
            checks.append(Check(f"csv {name} rows", right, float(len(found)), float(len(rows))))
        return checks


FORMAT: Final = Csv()


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

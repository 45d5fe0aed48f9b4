"""Table: rows of plain values that can be filtered, sorted, extended and written."""

from __future__ import annotations

import html
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, overload

from ddgfab.errors import DdgError
from fabrication.formats.tables import Legend

if TYPE_CHECKING:
    import pandas

Row = dict[str, Any]

STATUS: Final = (
    "ok, or rejected: beyond a limit or failed a check, not to be ordered; with the marks \
that are, where only some of the row's pieces are"
)
"""Meaning of the column that `Table.with_status` adds."""

SHOWN: Final = 20
"""Rows that a notebook shows."""


class Table(Sequence[Row]):
    """Rows as dictionaries in a fixed order; every change gives a new table.

    >>> beams = Table([{"mark": "B-0000", "mass_kg": 3.0}, {"mark": "B-0001", "mass_kg": 2.0}])
    >>> beams.sort("mass_kg")[0]["mark"]
    'B-0001'
    >>> beams.with_column("mass_lb", lambda row: row["mass_kg"] / 0.45359237).columns
    ['mark', 'mass_kg', 'mass_lb']

    Parameters
    ----------
    rows : mappings from columns to values; a row may lack some
    name : of its file and sheet
    legend : title, meanings of the columns, and which are added up
    """

    def __init__(
        self,
        rows: Iterable[Mapping[str, Any]],
        name: str = "table",
        legend: Legend | None = None,
    ) -> None:
        self.rows = [dict(row) for row in rows]
        self.name = name
        self.legend = Legend() if legend is None else legend

    @overload
    def __getitem__(self, index: int) -> Row: ...

    @overload
    def __getitem__(self, index: slice) -> Table: ...

    def __getitem__(self, index: int | slice) -> Row | Table:
        if isinstance(index, slice):
            return Table(self.rows[index], self.name, self.legend)
        return self.rows[index]

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[Row]:
        return iter(self.rows)

    def __repr__(self) -> str:
        return f"Table({self.name}: {len(self)} rows, {len(self.columns)} columns)"

    @property
    def columns(self) -> list[str]:
        """Names of the columns in order of first appearance."""
        return list(dict.fromkeys(key for row in self.rows for key in row))

    def column(self, name: str) -> list[Any]:
        """Values of one column; None where a row lacks it.

        Raises
        ------
        KeyError
            No row has such a column.
        """
        if self.rows and name not in self.columns:
            raise KeyError(f"{self.name} has no column {name!r}; it has {', '.join(self.columns)}")
        return [row.get(name) for row in self.rows]

    def filter(self, keep: Callable[[Row], bool]) -> Table:
        """The rows for which `keep` holds."""
        return Table([row for row in self.rows if keep(row)], self.name, self.legend)

    def sort(self, *columns: str, descending: bool = False) -> Table:
        """The rows by the values of columns; rows without a value come last, ties keep order.

        Raises
        ------
        KeyError
            No row has such a column.
        """
        rows = list(self.rows)
        for name in reversed(columns):
            self.column(name)
            with_value = [row for row in rows if row.get(name) is not None]
            without = [row for row in rows if row.get(name) is None]
            rows = sorted(with_value, key=lambda row: row[name], reverse=descending) + without
        return Table(rows, self.name, self.legend)

    def with_column(self, name: str, value: Callable[[Row], Any], meaning: str = "") -> Table:
        """The table with one more column, computed from each row, and what it means."""
        rows = [{**row, name: value(row)} for row in self.rows]
        known = {**self.legend.meanings, **({name: meaning} if meaning else {})}
        return Table(rows, self.name, replace(self.legend, meanings=known))

    def with_status(
        self,
        rejected: Collection[str],
        marks: Callable[[Row], Sequence[str]] | None = None,
    ) -> Table:
        """The table with a column "status" after "number": "ok", or "rejected" with the marks.

        A table whose rows are about no pieces, such as one of costs, stays as it is.

        Parameters
        ----------
        rejected : marks of pieces that failed a check or a limit
        marks : the pieces that a row is about; default its mark, or its marks
        """
        marks = marks or marks_in
        about = [marks(row) for row in self.rows]
        if self.rows and not any(about):
            return self
        rows = []
        for row, own in zip(self.rows, about, strict=True):
            bad = [mark for mark in own if mark in rejected]
            named = "" if len(bad) == len(own) else f": {' '.join(bad)}"
            status = {"status": f"rejected{named}" if bad else "ok"}
            at = list(row).index("number") + 1 if "number" in row else len(row)
            items = list(row.items())
            rows.append(dict([*items[:at], *status.items(), *items[at:]]))
        known = {**self.legend.meanings, "status": STATUS}
        return Table(rows, self.name, replace(self.legend, meanings=known))

    def to_csv(self, path: str | Path) -> None:
        """Write as CSV (UTF-8, comma, dot decimals).

        Raises
        ------
        OutputError
            The file cannot be written.
        """
        from fabrication.formats.csv import write_csv

        write_csv(Path(path), self.rows)

    def to_xlsx(self, path: str | Path) -> None:
        """Write as an Excel workbook of one sheet.

        Raises
        ------
        OutputError
            The file cannot be written.
        """
        from fabrication.formats.xlsx import write_xlsx

        write_xlsx(Path(path), {self.name: self.rows}, legends={self.name: self.legend})

    def to_dataframe(self) -> pandas.DataFrame:
        """The rows as a pandas data frame.

        Raises
        ------
        DdgError
            pandas is not installed.
        """
        try:
            import pandas
        except ImportError:
            raise DdgError(
                "to_dataframe needs pandas, which is not installed: pip install 'ddgfab[pandas]'"
            ) from None
        return pandas.DataFrame(self.rows, columns=self.columns)

    def _repr_html_(self) -> str:
        """The first rows, for notebooks."""
        columns = self.columns
        head = "".join(f"<th>{html.escape(name)}</th>" for name in columns)
        body = "".join(
            "<tr>" + "".join(f"<td>{_shown(row.get(name))}</td>" for name in columns) + "</tr>"
            for row in self.rows[:SHOWN]
        )
        more = f"<p>{html.escape(repr(self))}</p>"
        return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{more}"


def marks_in(row: Row) -> list[str]:
    """The pieces that a row names in its column "marks" or "mark"."""
    return str(row.get("marks", row.get("mark", ""))).split()


def _shown(value: Any) -> str:
    if value is None:
        return ""
    return html.escape(f"{value:.6g}" if isinstance(value, float) else str(value))

"""Cells of schedules: which columns there are, what they mean, how many decimals numbers have."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final, TypeAlias

import numpy as np

Row: TypeAlias = Mapping[str, Any]

SCHEDULES: Final = "schedules"
"""Folder of the schedules."""

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
    ("quantity", 3),
    ("rate", 4),
    ("cost", 2),
)
"""Decimals by the end of a column's name, that is by its unit."""

OTHER_DECIMALS: Final = 6
"""Decimals of numbers in columns without a known unit."""

SHOWN_DECIMALS: Final[tuple[tuple[str, int], ...]] = (
    ("_mm", 1),
    ("_mm2", 0),
    ("_m", 2),
    ("_m2", 3),
    ("_deg", 2),
    ("_kg", 2),
    ("_percent", 2),
    ("axis_x", 4),
    ("axis_y", 4),
    ("axis_z", 4),
)
"""How many of them sheets show, where that are fewer: what a shop measures."""

UNITS: Final = {
    "_mm": "mm",
    "_mm2": "mm2",
    "_mm3": "mm3",
    "_m": "m",
    "_m2": "m2",
    "_m3": "m3",
    "_deg": "deg",
    "_kg": "kg",
    "_g": "g",
    "_percent": "%",
}
"""Units by the end of a column's name."""

NUMBER: Final = "{k}"
"""Stands for the number in names of columns such as edge_1_mm, edge_2_mm, ..."""


@dataclass(frozen=True)
class Legend:
    """What people need to read a schedule.

    Attributes
    ----------
    title : of its sheet
    about : what a row is, a sentence
    meanings : of its columns; "edge_{k}_mm" is that of edge_1_mm, edge_2_mm, ...
    totals : columns that are added up below the rows
    unprinted : columns that sheets hide, by name or with {k}: what the CSV is for, or another sheet
    """

    title: str = ""
    about: str = ""
    meanings: Mapping[str, str] = field(default_factory=dict)
    totals: tuple[str, ...] = ()
    unprinted: tuple[str, ...] = ()

    def key(self, column: str) -> str:
        """The column's name in `meanings`: itself, or with {k} for its number."""
        return column if column in self.meanings else numbered(column)

    def hides(self, column: str) -> bool:
        """Whether sheets hide a column."""
        return bool({column, numbered(column)} & set(self.unprinted))

    def meaning(self, column: str) -> str:
        """What a column means; empty where the legend does not say."""
        text = self.meanings.get(self.key(column), "")
        found = re.search(r"_(\d+)(?=_|$)", column)
        return text.replace(NUMBER, found[1]) if found else text


def numbered(column: str) -> str:
    """A column's name with {k} for its number.

    >>> numbered("edge_12_mm"), numbered("mass_kg")
    ('edge_{k}_mm', 'mass_kg')
    """
    return re.sub(r"_\d+(?=_|$)", f"_{NUMBER}", column)


def unit_of(column: str) -> str:
    """The unit of a column by the end of its name; empty where it has none."""
    return next((unit for end, unit in UNITS.items() if column.endswith(end)), "")


def heading(column: str) -> str:
    """A column's name as people read it.

    >>> heading("mitre_start_deg"), heading("neighbour_2")
    ('mitre start [deg]', 'neighbour 2')
    """
    unit = unit_of(column)
    words = column[: len(column) - column[::-1].index("_") - 1] if unit else column
    return words.replace("_", " ") + (f" [{unit}]" if unit else "")


def columns_of(rows: Sequence[Row]) -> list[str]:
    """The rows' keys in order of first appearance."""
    return list(dict.fromkeys(key for row in rows for key in row))


def decimals(column: str) -> int:
    """How many decimals the numbers of a column have."""
    return next((places for end, places in DECIMALS if column.endswith(end)), OTHER_DECIMALS)


def shown_decimals(column: str) -> int:
    """How many decimals sheets show of the numbers of a column."""
    known = (places for end, places in SHOWN_DECIMALS if column.endswith(end))
    return next(known, decimals(column))


def plain(value: Any, places: int) -> str | int | float | bool | None:
    """A cell's value as one of Python's own, floats rounded, None for NaN and infinities."""
    if isinstance(value, np.generic):
        value = value.item()
    if value is None or isinstance(value, (bool, int, str)):
        return value
    if isinstance(value, float):
        return round(value, places) + 0.0 if math.isfinite(value) else None
    return str(value)


FORMULAS: Final = ("=", "+", "-", "@", "\t", "\r")
"""Beginnings of texts that spreadsheets take for formulas."""

WRITTEN: Final = re.compile(r"[+-]?[0-9]+(\.[0-9]+)?(e[+-]?[0-9]+)?")
"""A number that is written as a text, with all its digits."""


def text_of(value: Any, places: int) -> str:
    """A cell of the CSV; never in exponent form, never a negative zero.

    A text that a spreadsheet would run as a formula has an apostrophe before it; numbers that are
    written as texts, such as -47.5, are no formulas.
    """
    cell = plain(value, places)
    if cell is None:
        return ""
    if isinstance(cell, bool):
        return "true" if cell else "false"
    if isinstance(cell, str) and cell.startswith(FORMULAS) and not WRITTEN.fullmatch(cell):
        return f"'{cell}"
    return f"{cell:.{places}f}" if isinstance(cell, float) else str(cell)

"""Cells of schedules: which columns there are, how many decimals numbers have."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
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
)
"""Decimals by the end of a column's name, that is by its unit."""

OTHER_DECIMALS: Final = 6
"""Decimals of numbers in columns without a known unit."""


def columns_of(rows: Sequence[Row]) -> list[str]:
    """The rows' keys in order of first appearance."""
    return list(dict.fromkeys(key for row in rows for key in row))


def decimals(column: str) -> int:
    """How many decimals the numbers of a column have."""
    return next((places for end, places in DECIMALS if column.endswith(end)), OTHER_DECIMALS)


def plain(value: Any, places: int) -> str | int | float | bool | None:
    """A cell's value as one of Python's own, floats rounded, None for NaN and infinities."""
    if isinstance(value, np.generic):
        value = value.item()
    if value is None or isinstance(value, (bool, int, str)):
        return value
    if isinstance(value, float):
        return round(value, places) + 0.0 if math.isfinite(value) else None
    return str(value)


def text_of(value: Any, places: int) -> str:
    """A cell of the CSV; never in exponent form, never a negative zero."""
    cell = plain(value, places)
    if cell is None:
        return ""
    if isinstance(cell, bool):
        return "true" if cell else "false"
    return f"{cell:.{places}f}" if isinstance(cell, float) else str(cell)

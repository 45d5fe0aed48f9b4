"""Schedules as data of the page: columns, cells, and the pieces that each row is about."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from fabrication.formats.base import Whole
from fabrication.formats.html.page import Subject
from fabrication.formats.tables import (
    Legend,
    Row,
    columns_of,
    heading,
    plain,
    shown_decimals,
)


def tables_of(whole: Whole, subject: Subject, places: Mapping[str, int]) -> list[dict[str, Any]]:
    """All schedules; `places` are those of the pieces of the page, by mark."""
    tables = whole.tables or {}
    return [
        _table(name, rows, whole.legends.get(name, Legend()), subject, places)
        for name, rows in tables.items()
    ]


def _table(
    name: str, rows: Sequence[Row], legend: Legend, subject: Subject, places: Mapping[str, int]
) -> dict[str, Any]:
    columns = columns_of(rows)
    return {
        "name": name,
        "title": legend.title or name,
        "about": legend.about,
        "columns": [
            {
                "name": column,
                "heading": heading(column),
                "meaning": legend.meaning(column),
                "decimals": shown_decimals(column),
                "hidden": legend.hides(column),
            }
            for column in columns
        ],
        "rows": [[plain(row.get(c), shown_decimals(c)) for c in columns] for row in rows],
        "pieces": [[places[m] for m in subject.marks_of(row) if m in places] for row in rows],
    }

"""The first sheet of a workbook, and the last one: cover with totals, and what the columns mean."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from fabrication.formats.base import Whole
from fabrication.formats.tables import Legend, Row, columns_of, heading, unit_of
from fabrication.formats.workbook import (
    COLUMNS,
    COVER,
    LINE,
    LONGEST,
    NAME,
    UNITS,
    Book,
    add_table,
)


def totals_of(whole: Whole) -> list[dict[str, Any]]:
    """Part numbers, pieces, mass and rejected pieces of every role, and of all; as the manifest."""
    found: dict[str, list[float]] = {}
    for part in whole.parts.values():
        marks = [instance.mark for instance in part.family.instances]
        own = found.setdefault(part.kind.role, [0, 0, 0.0, 0, 0.0])
        bad = sum(mark in whole.failed for mark in marks)
        for k, value in enumerate((1, len(marks), len(marks) * part.mass, bad, bad * part.mass)):
            own[k] += value
    names = ("part_numbers", "pieces", "mass_kg", "rejected", "rejected_kg")
    rows = [{"role": role, **dict(zip(names, own, strict=True))} for role, own in found.items()]
    whole_row = {name: sum(own[k] for own in found.values()) for k, name in enumerate(names)}
    return [*rows, {"role": "all", **whole_row}]


def add_cover(book: Book, whole: Whole) -> None:
    """Title block, totals by role, what is in the workbook, units and conventions."""
    sheet = book.add(COVER, "cover")
    big, bold = book.format(bold=True, font_size=16), book.format(bold=True)
    head = book.format(bold=True, bottom=1, bg_color="#E7E6E6")
    heads = book.format(bold=True, bottom=1, bg_color="#E7E6E6", align="right")
    text, wrapped = book.format(), book.format(text_wrap=True)
    after = book.format(align="left", indent=1)
    sheet.set_column(0, 0, 26)
    sheet.set_column(1, 14, 13)
    title = book.title
    sheet.set_row(0, 24)
    sheet.write_string(0, 0, title.title[:LONGEST], big)
    line = 2
    rest = {
        "project number": title.number,
        "revision": title.revision,
        "date": title.date,
        "client": title.client,
        "author": title.author,
        "project file": whole.about.project,
    }
    for label, value in rest.items():
        sheet.write_string(line, 0, label, bold)
        sheet.write_string(line, 1, value[:LONGEST] or "not stated", text)
        line += 1
    line += 1
    totals = totals_of(whole)
    for at, column in enumerate(totals[0]):
        sheet.write_string(line, at, heading(column), heads if at else head)
    for row in totals:
        line += 1
        last = row is totals[-1]
        for at, (column, value) in enumerate(row.items()):
            number = book.format(
                num_format="0.0" if unit_of(column) else "0", bold=last, top=1 if last else 0
            )
            if isinstance(value, str):
                sheet.write_string(line, at, value, number)
            else:
                sheet.write_number(line, at, round(value, 6), number)
    line += 2
    for at, label in enumerate(("sheet", "rows", "what a row is")):
        sheet.write_string(line, at, label, (head, heads, head)[at])
    for name, rows in (whole.tables or {}).items():
        line += 1
        legend = whole.legends.get(name, Legend())
        sheet.write_url(line, 0, f"internal:'{name[:NAME]}'!A1", text, legend.title or name)
        sheet.write_number(line, 1, len(rows), text)
        sheet.write_string(line, 2, legend.about, after)
    line += 1
    sheet.write_url(line, 0, f"internal:'{COLUMNS}'!A1", text, "Columns")
    sheet.write_string(line, 2, "a column of a sheet: its unit, and what it means", after)
    line += 2
    for sentence in (UNITS, *whole.about.remarks, *whole.about.conventions):
        sheet.merge_range(line, 0, line, 14, sentence, wrapped)
        sheet.set_row(line, LINE * (1 + len(sentence) // 190) + 2)
        line += 1


def add_columns(
    book: Book, tables: Mapping[str, Sequence[Row]], legends: Mapping[str, Legend]
) -> None:
    """The legend: a row a column, those that differ in a number once."""
    found: dict[tuple[str, str], Row] = {}
    for name, rows in tables.items():
        legend = legends.get(name, Legend())
        for column in columns_of(rows):
            key = legend.key(column)
            meaning = legend.meanings.get(key, "").replace("{k}", "k")
            row = {"sheet": name, "column": heading(key).replace("{k}", "k"), "meaning": meaning}
            found.setdefault((name, key), row)
    about = Legend(title="Columns", meanings={})
    add_table(book, COLUMNS, list(found.values()), ("sheet", "column", "meaning"), about)

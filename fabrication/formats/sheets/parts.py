"""The sheets of part numbers: what the schedules say of them, beside what their shapes show."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, Final

from fabrication.drawings.block import Block
from fabrication.drawings.columns import Paragraph
from fabrication.drawings.compose import part_sheets
from fabrication.drawings.overall import overall_drawing
from fabrication.drawings.sheet import Sheet
from fabrication.drawings.views import Drawn, List, shown
from fabrication.formats.base import Part, Provenance, Row, Whole
from fabrication.formats.tables import NUMBER, heading, plain, shown_decimals
from fabrication.specs import Family

BOUGHT: Final = "IfcMechanicalFastener"
"""Class of what is bought and needs no sheet."""

DOCUMENT: Final = "Part drawing"


def is_drawn(family: Family) -> bool:
    """Whether there is a sheet of a part number: not of what is bought."""
    return family.kind.ifc != BOUGHT


def sheets_of_parts(whole: Whole) -> Iterator[tuple[str, Sheet]]:
    """Group and sheet of every part number, in their order."""
    rows = rows_by_number(whole)
    orders = {row["number"]: row for row in (whole.tables or {}).get("bom", ()) if "number" in row}
    for number, part in whole.parts.items():
        if is_drawn(part.family):
            own = rows.get(number, ())
            for sheet in sheets_of(part, own, orders.get(number, {}), whole.about, whole.failed):
                yield part.kind.title, sheet


def rows_by_number(whole: Whole) -> dict[str, list[Row]]:
    """Rows of the schedules that are about single pieces, by part number."""
    found: dict[str, list[Row]] = {}
    for rows in (whole.tables or {}).values():
        for row in rows:
            if "mark" in row and "number" in row:
                found.setdefault(row["number"], []).append(row)
    return found


def sheets_of(
    part: Part,
    rows: Sequence[Row],
    order: Row,
    about: Provenance,
    failed: frozenset[str] = frozenset(),
) -> list[Sheet]:
    """The sheets of one part number.

    Parameters
    ----------
    rows : of its pieces in their schedule
    order : its row in the parts list
    failed : marks of pieces that must not be made
    """
    shape, shared = part.shape, alike(rows)
    drawing = shape.drawing(shared) if isinstance(shape, Drawn) else overall_drawing(part.mesh)
    marks = [instance.mark for instance in part.family.instances]
    good = [mark for mark in marks if mark not in failed]
    bad = [mark for mark in marks if mark in failed]
    extra: list[List | Paragraph] = [*lists_of(drawing.columns, rows, shared)]
    if good:
        extra.append(Paragraph(f"Piece marks ({len(good)})", " ".join(good)))
    if bad:
        extra.append(Paragraph(f"REJECTED, not to be made ({len(bad)})", " ".join(bad)))
    block = block_of(about, part, order, len(good))
    return part_sheets(drawing, part.boundary, part.mesh, block, part.number, extra)


def project_block(about: Provenance, subtitle: str, document: str) -> Block:
    """The title block of a sheet of the project."""
    title = about.title
    return Block(
        title=title.title,
        subtitle=subtitle,
        number=title.number,
        document=document,
        owner=about.header.organization,
        client=title.client,
        author=title.author,
        date=title.date,
        revision=title.revision,
    )


def block_of(about: Provenance, part: Part, order: Row, quantity: int) -> Block:
    """The title block of a part's sheet."""
    block = project_block(about, f"{part.kind.role.capitalize()} {part.number}", DOCUMENT)
    return replace(
        block,
        number=f"{block.number}-{part.number}" if block.number else part.number,
        material=str(order.get("material") or part.material.name),
        mass=f"{part.mass:.2f} kg" if part.mass >= 0.1 else f"{1000.0 * part.mass:.2f} g",
        quantity=str(quantity),
        tolerance=part.material.tolerance,
    )


def alike(rows: Sequence[Row]) -> dict[str, Any]:
    """What a schedule says of all these pieces alike, as sheets write it, by column."""
    first, *others = rows or ({},)
    found = {}
    for name, value in first.items():
        if value is None or value == "":
            continue
        text = cell(value, name) if others else ""
        if all(cell(row.get(name), name) == text for row in others):
            found[name] = value
    return found


def lists_of(columns: Sequence[str], rows: Sequence[Row], shared: Row) -> Iterator[List]:
    """Columns of a schedule: what all pieces share, by number where it has one; the rest by piece.

    Parameters
    ----------
    columns : names, with {k} for a number
    shared : what `alike` finds of the rows
    """
    if not rows:
        return
    have = {key for row in rows for key, value in row.items() if value is not None}
    numbers = {name: _numbers(name, have) for name in columns}
    single = [n for n in columns if NUMBER not in n and n in shared]
    if single:
        yield _data([(heading(name), cell(shared[name], name)) for name in single])
    several = [
        name
        for name in columns
        if numbers[name] and all(name.format(k=k) in shared for k in numbers[name])
    ]
    if several:
        counted = sorted({k for name in several for k in numbers[name]})
        yield List(
            "By side" if several[0].startswith("edge") else "By arm",
            ("no.", *(heading(_plain(name)) for name in several)),
            tuple(
                (str(k), *(cell(shared.get(n.format(k=k)), n.format(k=k)) for n in several))
                for k in counted
            ),
        )
    varied = [
        key
        for name in columns
        if name not in several and name not in single
        for key in ([name.format(k=k) for k in numbers[name]] if NUMBER in name else [name])
        if key in have
    ]
    if varied:
        yield List(
            "By piece",
            ("mark", *map(heading, varied)),
            tuple((str(row["mark"]), *(cell(row.get(key), key) for key in varied)) for row in rows),
        )


def _data(values: Sequence[tuple[str, str]]) -> List:
    """Names and values side by side, in up to three columns each."""
    columns = max(1, min(3, len(values) // 2))
    rows = -(-len(values) // columns)
    padded = [*values, *[("", "")] * (rows * columns - len(values))]
    return List(
        "Data",
        ("", "value") * columns,
        tuple(
            tuple(text for k in range(columns) for text in padded[n + k * rows])
            for n in range(rows)
        ),
    )


def _numbers(name: str, have: set[str]) -> list[int]:
    """The numbers for which a column has values, from 1 on."""
    if NUMBER not in name:
        return []
    before, after = name.split(NUMBER)
    found = []
    for key in have:
        middle = key[len(before) : len(key) - len(after)]
        if key.startswith(before) and key.endswith(after) and middle.isdecimal():
            found.append(int(middle))
    return sorted(found)


def _plain(name: str) -> str:
    """A numbered column's name without the number."""
    return re.sub(r"_?\{k\}", "", name)


def cell(value: Any, column: str) -> str:
    """A value of a schedule as sheets show it."""
    found = plain(value, 9)
    if found is None:
        return ""
    if isinstance(found, float):
        return shown(found, shown_decimals(column))
    return str(found)

"""The sheets of part numbers: what the schedules say of them, beside what their shapes show."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

from fabrication.drawings.block import Block
from fabrication.drawings.compose import Paragraph, part_sheets
from fabrication.drawings.sheet import Sheet
from fabrication.drawings.views import Drawing, Drawn, List, shown, three_views
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
    shape = part.shape
    drawing = shape.drawing() if isinstance(shape, Drawn) else Drawing(three_views())
    marks = [instance.mark for instance in part.family.instances]
    good = [mark for mark in marks if mark not in failed]
    bad = [mark for mark in marks if mark in failed]
    extra: list[List | Paragraph] = [*lists_of(drawing.columns, rows)]
    if good:
        extra.append(Paragraph(f"Piece marks ({len(good)})", " ".join(good)))
    if bad:
        extra.append(Paragraph(f"REJECTED, not to be made ({len(bad)})", " ".join(bad)))
    block = block_of(about, part, order, len(good))
    return part_sheets(drawing, part.boundary, part.mesh, block, part.number, extra)


def block_of(about: Provenance, part: Part, order: Row, quantity: int) -> Block:
    """The title block of a part's sheet."""
    title = about.title
    number = f"{title.number}-{part.number}" if title.number else part.number
    return Block(
        title=title.title,
        subtitle=f"{part.kind.role.capitalize()} {part.number}",
        number=number,
        document=DOCUMENT,
        owner=about.header.organization,
        client=title.client,
        author=title.author,
        date=title.date,
        revision=title.revision,
        material=str(order.get("material") or part.material.name),
        mass=f"{part.mass:.2f} kg" if part.mass >= 0.1 else f"{1000.0 * part.mass:.2f} g",
        quantity=str(quantity),
        tolerance=part.material.tolerance,
    )


def lists_of(columns: Sequence[str], rows: Sequence[Row]) -> Iterator[List]:
    """Columns of a schedule: by their number what all pieces share, by piece what they do not."""
    have = list(dict.fromkeys(key for row in rows for key in row))
    numbered = [name for name in columns if NUMBER in name]
    counts = [k for k in range(1, 100) if any(n.format(k=k) in have for n in numbered)]
    common: list[str] = []
    varied: list[str] = [name for name in columns if NUMBER not in name and name in have]
    for name in numbered:
        own = [name.format(k=k) for k in counts if name.format(k=k) in have]
        if own:
            same = all(len({cell(row.get(key), key) for row in rows}) == 1 for key in own)
            (common if same else varied).append(name)
    used = [k for k in counts if any(_filled(rows[0], name.format(k=k)) for name in common)]
    if common and used:
        keys = [(name, [name.format(k=k) for k in used]) for name in common]
        yield List(
            "By side" if common[0].startswith("edge") else "By arm",
            ("no.", *(heading(_plain(name)) for name, _ in keys)),
            tuple(
                (str(k), *(cell(rows[0].get(own[n]), own[n]) for _, own in keys))
                for n, k in enumerate(used)
            ),
        )
    if varied and rows:
        every = [
            key
            for name in varied
            for key in ([name.format(k=k) for k in counts] if NUMBER in name else [name])
            if any(_filled(row, key) for row in rows)
        ]
        if every:
            yield List(
                "By piece",
                ("mark", *(heading(key) for key in every)),
                tuple(
                    (str(row["mark"]), *(cell(row.get(key), key) for key in every)) for row in rows
                ),
            )


def _plain(name: str) -> str:
    """A numbered column's name without the number."""
    return re.sub(r"_?\{k\}", "", name)


def _filled(row: Mapping[str, Any], key: str) -> bool:
    return row.get(key) is not None


def cell(value: Any, column: str) -> str:
    """A value of a schedule as sheets show it."""
    found = plain(value, 9)
    if found is None:
        return ""
    if isinstance(found, float):
        return shown(found, shown_decimals(column))
    return str(found)

"""Overviews: where each mark goes; and the order of erection, with marks and weights."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from ddgfab.mesh import Floats
from fabrication.drawings.columns import Paragraph, entries_of, list_sheets
from fabrication.drawings.plan import Symbol, plan_sheets
from fabrication.drawings.sheet import Sheet
from fabrication.drawings.views import List
from fabrication.formats.base import Part, Whole
from fabrication.formats.sheets.erection import Ring, rings_of
from fabrication.formats.sheets.parts import is_drawn, project_block
from fabrication.specs import Form

OVERVIEW: Final = "Overview"
ERECTION: Final = "Erection"
"""Groups of sheets."""

MANY: Final = 500
"""With more pieces than this there is an overview a role; with fewer one of all."""


def overview_sheets(whole: Whole) -> Iterator[tuple[str, Sheet]]:
    """Group and sheet of the overviews with all marks."""
    symbols = symbols_of(whole)
    if not symbols:
        return
    groups: list[tuple[str, list[Symbol]]] = []
    if len(symbols) <= MANY:
        groups.append(("all parts", [symbol for _, symbol in symbols]))
    else:
        titles = dict.fromkeys(title for title, _ in symbols)
        groups += [
            (title.lower(), [symbol for own, symbol in symbols if own == title]) for title in titles
        ]
    for name, own in groups:
        block = project_block(whole.about, f"Overview, {name}", "Overview drawing")
        for sheet in plan_sheets(own, block, f"overview {name}"):
            yield OVERVIEW, sheet


def erection_sheets(whole: Whole) -> Iterator[tuple[str, Sheet]]:
    """Group and sheet of the order of erection: a plan of the rings, and what is in each."""
    rings = rings_of(whole)
    if not rings:
        return
    block = project_block(whole.about, "Erection, rings", "Erection drawing")
    ring_of = {mark: ring.number for ring in rings for mark in ring.marks}
    shown = {symbol.label: symbol for _, symbol in symbols_of(whole)}
    labelled = [
        replace(symbol, label=str(ring_of[mark]))
        for mark, symbol in shown.items()
        if mark in ring_of
    ]
    panes = [symbol for symbol in labelled if symbol.form == "sheet"]
    for sheet in plan_sheets(panes or labelled, block, "erection rings"):
        yield ERECTION, sheet
    block = replace(block, subtitle="Erection, marks and weights")
    entries = list(entries_of([_table(rings, whole), *_paragraphs(rings)]))
    for sheet in list_sheets(entries, block, "erection", "Erection, marks and weights"):
        yield ERECTION, sheet


def symbols_of(whole: Whole) -> list[tuple[str, Symbol]]:
    """Group and symbol of every piece that is not bought, where it is in the assembly."""
    found = []
    for family in whole.families:
        if not is_drawn(family) or family.number not in whole.parts:
            continue
        own, center = lines_of(whole.parts[family.number])
        for instance in family.instances:
            turn, shift = instance.placement[:3, :3], instance.placement[:3, 3]
            outward = turn[:, 2] if family.kind.form != "block" else np.zeros(3)
            symbol = Symbol(
                instance.mark,
                family.kind.form,
                own @ turn.T + shift,
                turn @ center + shift,
                outward,
            )
            found.append((family.kind.title, symbol))
    return found


def lines_of(part: Part) -> tuple[Floats, Floats]:
    """Lines (n, 2, 3) of a part in plans, and where its label is, in its own frame."""
    low, high = part.mesh.vertices.min(axis=0), part.mesh.vertices.max(axis=0)
    middle = 0.5 * (low + high)
    form: Form = part.kind.form
    if form == "joint":
        point = np.array([0.0, 0.0, high[2]])
        return np.array([[point, point]]), point
    if form == "bar":
        ends = np.array([middle, middle])
        ends[:, 0] = low[0], high[0]
        return ends[None], middle
    if form == "sheet":  # the border of the upper face
        heights = part.mesh.vertices[part.mesh.triangles, 2]
        top = (heights > high[2] - 1e-6).all(axis=1)
        pairs = part.mesh.triangles[top][:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
        ends, count = np.unique(np.sort(pairs, axis=1), axis=0, return_counts=True)
        lines = part.mesh.vertices[ends[count == 1]]
        return lines, np.asarray(lines.reshape(-1, 3).mean(axis=0))
    corners = ((low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1]))
    box = np.array([[x, y, high[2]] for x, y in corners])
    return np.stack([box, np.roll(box, -1, axis=0)], axis=1), middle


def _table(rings: Sequence[Ring], whole: Whole) -> List:
    """Pieces and weight of every ring, and the sum so far."""
    roles = list(dict.fromkeys(f.kind.title for f in whole.families if is_drawn(f)))
    rows, total = [], 0.0
    for ring in rings:
        total += ring.mass
        rows.append(
            (
                str(ring.number),
                *(str(ring.counts.get(role, 0)) for role in roles),
                f"{ring.mass:.1f}",
                f"{ring.heaviest[1]:.1f}",
                ring.heaviest[0],
                f"{total:.1f}",
            )
        )
    headings = ("ring", *(role.lower() for role in roles))
    headings += ("mass [kg]", "heaviest [kg]", "heaviest", "sum [kg]")
    return List("Rings in order of erection", headings, tuple(rows))


def _paragraphs(rings: Sequence[Ring]) -> Iterator[Paragraph]:
    yield Paragraph(
        "How rings are counted",
        "Ring 0 is what stands on the ground, or else the border, or else the lowest nodes; every "
        "further ring is one beam away from the one before. A beam or pane goes up with the last "
        "of its nodes. Bolts and temporary supports are not in the weights.",
    )
    for ring in rings:
        yield Paragraph(f"Ring {ring.number}", " ".join(ring.marks))

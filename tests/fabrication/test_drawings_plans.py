"""Overviews show every mark once; erection counts every piece and all weight; DXF of sheets."""

from __future__ import annotations

import io
from collections import Counter
from itertools import pairwise

import pytest
from roofs import barrel, hexagons
from sheet_checks import faults, whole_of

from fabrication import design
from fabrication.drawings.dxf import sheets_dxf
from fabrication.drawings.running import spread
from fabrication.drawings.sheet import Fill, Sheet
from fabrication.formats.base import Whole
from fabrication.formats.sheets import groups, sheets_of_whole
from fabrication.formats.sheets.erection import rings_of


@pytest.fixture(scope="module")
def roof() -> tuple[Whole, list[tuple[str, Sheet]]]:
    whole = whole_of(design(barrel(4, 5)))
    return whole, list(sheets_of_whole(whole))


def marks(whole: Whole) -> list[str]:
    return [i.mark for family in whole.families for i in family.instances]


def test_every_mark_is_in_an_overview_once(roof: tuple[Whole, list[tuple[str, Sheet]]]) -> None:
    whole, sheets = roof
    texts = Counter(t.text for group, s in sheets if group == "Overview" for t in s.texts())
    assert all(texts[mark] == 1 for mark in marks(whole))


def test_closed_structures_are_seen_from_all_sides() -> None:
    whole = whole_of(design(net={"kind": "koebe", "shape": "goldberg", "cells": 2}))
    plans = [sheet for group, sheet in sheets_of_whole(whole) if group == "Overview"]
    assert len({sheet.views[0].title for sheet in plans}) == 6
    texts = Counter(t.text for sheet in plans for t in sheet.texts())
    assert all(texts[mark] == 1 for mark in marks(whole))


def test_plans_are_legible(roof: tuple[Whole, list[tuple[str, Sheet]]]) -> None:
    for group, sheet in roof[1]:
        if group in ("Overview", "Erection"):
            assert faults(sheet) == [], sheet.title


def test_rings_hold_every_piece_and_all_weight(roof: tuple[Whole, list[tuple[str, Sheet]]]) -> None:
    whole, sheets = roof
    rings = rings_of(whole)
    assert sorted(mark for ring in rings for mark in ring.marks) == sorted(marks(whole))
    total = sum(p.mass * len(p.family.instances) for p in whole.parts.values())
    assert sum(ring.mass for ring in rings) == pytest.approx(total)
    texts = [t.text for group, s in sheets if group == "Erection" for t in s.texts()]
    assert f"{total:.1f}" in texts
    # 5 x 6 nodes: two rings lie inside the border, of 3 x 4 - 2 and 2 nodes.
    assert [ring.counts["Nodes"] for ring in rings] == [18, 10, 2]
    assert whole.tables is not None
    ring_of = {mark: ring.number for ring in rings for mark in ring.marks}
    for row in whole.tables["beams"]:
        ends = ring_of[row["node_start"]], ring_of[row["node_end"]]
        assert ring_of[row["mark"]] == max(ends)
        assert max(ends) - min(ends) <= 1


@pytest.mark.parametrize("release", ["R2010", "R12"])
def test_dxf_of_sheets(release: str) -> None:
    """Clean by ezdxf's audit, with all items of the sheets, inside their papers."""
    ezdxf = pytest.importorskip("ezdxf")
    whole = whole_of(design(hexagons()))
    by_subject: dict[str, list[Sheet]] = {}
    for group, sheet in sheets_of_whole(whole):
        by_subject.setdefault(group + sheet.subject, []).append(sheet)
    for sheets in by_subject.values():
        document = ezdxf.read(io.StringIO(sheets_dxf(sheets, release)))
        audit = document.audit()
        assert not [*audit.errors, *audit.fixes]
        space = document.modelspace()
        items = [item for sheet in sheets for item in sheet.drawn()]
        assert len(space.query("TEXT")) == sum(1 for s in sheets for t in s.texts() if t.text)
        fills = sum(len(item.points) - 2 for item in items if isinstance(item, Fill))
        assert len(space.query("SOLID")) == fills
        assert len(space.query("CIRCLE")) == sum(item.circle() is not None for item in items)
        widest = sum(sheet.paper.width + 20.0 for sheet in sheets)
        for line in space.query("LINE"):
            assert 0.0 <= line.dxf.start.x <= widest
            assert 0.0 <= line.dxf.start.y <= 1200.0
        texts = {t.plain_text() for t in space.query("TEXT")}
        wanted = {t.text for sheet in sheets for t in sheet.texts() if t.text}
        assert texts == wanted


def test_groups_are_those_of_the_sheets(roof: tuple[Whole, list[tuple[str, Sheet]]]) -> None:
    whole, sheets = roof
    found = list(dict.fromkeys(group.lower() for group, _ in sheets))
    families = [part.family for part in whole.parts.values()]
    assert found == groups(families, list(whole.tables or ()))


def test_spread_keeps_order_and_distance() -> None:
    for places in ([0.0, 0.1, 0.2, 5.0, 5.5], [1.0], [], [3.0, 3.0, 3.0, 3.0]):
        found = spread(places, 2.0)
        assert all(b - a >= 2.0 - 1e-9 for a, b in pairwise(found))
        assert sum(found) == pytest.approx(sum(places))

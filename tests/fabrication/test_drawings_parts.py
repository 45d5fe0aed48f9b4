"""Sheets of beams, nodes, links and small parts: legible, true, and enough to make the part of."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from roofs import hexagons
from sheet_checks import faults, measured, whole_of

from fabrication import design, kit
from fabrication.drawings.sheet import Dimension, Sheet
from fabrication.formats.base import Whole
from fabrication.formats.sheets import sheets_of_whole
from fabrication.parts.beam import BeamShape
from fabrication.parts.link import LinkShape
from fabrication.parts.node import NodeShape

SMALL = {"kind": "canopy", "panels_along": 2, "panels_across": 2, "panel_mm": 1500}
RHS = {"profile": "RHS 120x60x5"}
CASES: Mapping[str, Mapping[str, Any]] = {
    "coped": {"beam": {"profile": "FL 80x10", "end": "cope"}},
    "stud": {"beam": {"profile": "FL 80x40"}, "connection": {"kind": "stud", "bolt": "M12"}},
    "hollow stud": {"beam": RHS, "connection": {"kind": "stud", "bolt": "M12"}},
    "end plate": {
        "beam": RHS,
        "node": {"series_mm": [300]},
        "connection": {"kind": "end_plate", "bolt": "M12"},
    },
    "tongue": {
        "beam": {"profile": "FL 160x60"},
        "node": {"kind": "star"},
        "connection": {"kind": "bolted_tongue", "bolt": "M16"},
    },
    "disc": {
        "net": {**SMALL, "panel_mm": 2200},
        "beam": {"profile": "FL 280x120"},
        "node": {"kind": "plates"},
        "connection": {"kind": "slotted", "bolt": "M16"},
    },
    "tee": {"beam": {"profile": "T 80x80x9"}},
}


@pytest.fixture(scope="module")
def shell() -> tuple[Whole, dict[str, Sheet]]:
    whole = whole_of(design(hexagons()))
    return whole, first_sheets(whole)


def first_sheets(whole: Whole) -> dict[str, Sheet]:
    """The sheet with the views of every part number."""
    return {s.subject: s for _, s in sheets_of_whole(whole) if s.subject in whole.parts and s.views}


def written(dimension: Dimension) -> float:
    """The number in a dimension's text."""
    words = dimension.text.text.replace("°", "").replace("Ø", "").split()
    number = float(words[-1])
    return 0.0 if number == 90.0 and dimension.name.startswith("mitre") else number  # square


def check_sheets(whole: Whole) -> None:
    """Every second sheet is legible; its numbers are those of drawing and schedule."""
    tables = whole.tables or {}
    rows = {
        row["number"]: row
        for rows in tables.values()
        for row in rows
        if {"mark", "number"} <= {*row}
    }
    for sheet in [*first_sheets(whole).values()][::2]:
        assert faults(sheet) == [], sheet.title
        for dimension in sheet.dimensions:
            found = measured(sheet, dimension)
            if found is not None:
                assert found == pytest.approx(abs(dimension.value), rel=1e-9), dimension.name
            wanted = rows.get(sheet.subject, {}).get(dimension.name)
            if isinstance(wanted, float):
                assert dimension.value == pytest.approx(wanted, abs=1e-6), dimension.name


@pytest.mark.parametrize("case", CASES)
def test_sheets_of_a_connection(case: str) -> None:
    whole = whole_of(design(**{"net": SMALL, **CASES[case]}))
    check_sheets(whole)
    holes = ("Ø" in t.text for s in first_sheets(whole).values() for t in s.texts())
    assert case in ("coped", "tee") or any(holes)


def test_sheets_of_a_kit() -> None:
    whole = whole_of(kit("bennett"))
    check_sheets(whole)
    for number, sheet in first_sheets(whole).items():
        shape = whole.parts[number].shape
        assert any("coupon" in t.text or "ISO 2768-1" in t.text for t in sheet.texts())
        if isinstance(shape, LinkShape):
            said = {d.name: written(d) for d in sheet.dimensions}
            assert said["length_mm"] == pytest.approx(shape.length, abs=0.05)
            assert said["twist_deg"] == pytest.approx(math.degrees(shape.twist), abs=0.005)
            assert said["diameter_mm"] == pytest.approx(shape.eye_diameter, abs=0.05)


def test_a_bar_is_made_again_from_its_sheet(shell: tuple[Whole, dict[str, Sheet]]) -> None:
    """Its side is a trapezoid of both lengths and the depth; its mitres follow from those."""
    whole, sheets = shell
    bars = 0
    for number, sheet in sheets.items():
        part = whole.parts[number]
        if not isinstance(part.shape, BeamShape):
            continue
        bars += 1
        said = {d.name: written(d) for d in sheet.dimensions}
        top, bottom = said["length_top_mm"], said["length_bottom_mm"]
        volume = 0.5 * (top + bottom) * said["depth"] * said["width"]
        assert volume == pytest.approx(part.properties.volume, rel=1e-3)
        tangents = [math.tan(math.radians(said[f"mitre_{end}_deg"])) for end in ("start", "end")]
        assert top - bottom == pytest.approx(said["depth"] * sum(tangents), abs=0.11)
    assert bars == 4


def test_a_node_is_made_again_from_its_sheet(shell: tuple[Whole, dict[str, Sheet]]) -> None:
    """A circle less a segment for every seat, times the height, less the mark."""
    whole, sheets = shell
    for number, sheet in sheets.items():
        part = whole.parts[number]
        if not isinstance(part.shape, NodeShape):
            continue
        said: dict[str, float] = {}
        for dimension in sheet.dimensions:
            said[dimension.name] = written(dimension)
        radius = 0.5 * said["diameter_mm"]
        area = math.pi * radius**2
        seats = [value for name, value in said.items() if name.startswith("seat_")]
        assert len(seats) == len([name for name in said if name.startswith("azimuth_")]) >= 2
        for seat in seats:
            half = math.acos(seat / radius)
            area -= radius**2 * half - seat * radius * math.sin(half)
        assert area * said["height_mm"] == pytest.approx(part.properties.volume, rel=5e-3)
        azimuths = [v for name, v in sorted(said.items()) if name.startswith("azimuth_")]
        wanted = sorted(math.degrees(seat.azimuth) for seat in part.shape.seats)
        assert azimuths == pytest.approx(wanted, abs=0.006)


def test_titles_of_any_kind_stay_in_their_block() -> None:
    """Long titles, quotes, and letters that the plain fonts have not."""
    title = {"title": 'Roof "Αθήνα" (Łódź) \\ 100 % ' * 15, "client": "O'Neill & Søn <x>"}
    whole = whole_of(design(net=SMALL, project=title))
    sheets = list(first_sheets(whole).values())
    assert all(faults(sheet) == [] for sheet in sheets[::7])
    shown = [text.text for text in sheets[0].texts() if text.text.startswith('Roof "')]
    assert [text.endswith("...") for text in shown] == [True]


def test_long_materials_and_tolerances_are_on_the_sheet_in_full() -> None:
    """The title block cuts them; a shop needs all of their words, whatever their length."""
    grade = "S355J2+N hot-dip galvanized, painted " + " ".join(f"layer{n}" for n in range(60))
    whole = whole_of(design(net=SMALL, beam={"grade": grade}))
    sheets: dict[str, list[Sheet]] = {}
    for _, sheet in sheets_of_whole(whole):
        sheets.setdefault(sheet.subject, []).append(sheet)
    beams = {n: part for n, part in whole.parts.items() if part.family.role == "beam"}
    assert beams
    for number, part in beams.items():
        words = " ".join(text.text for sheet in sheets[number] for text in sheet.texts())
        assert " ".join(grade.split()) in words
        assert part.material is not None
        assert part.material.tolerance in words
        assert all(faults(sheet) == [] for sheet in sheets[number])


def test_marks_of_hundreds_of_pieces_go_on_sheets_of_their_own() -> None:
    whole = whole_of(design(net={"kind": "koebe", "shape": "goldberg", "cells": 3}))
    number, family = max(
        ((n, p.family) for n, p in whole.parts.items()), key=lambda pair: len(pair[1].instances)
    )
    sheets = [sheet for _, sheet in sheets_of_whole(whole) if sheet.subject == number]
    texts = " ".join(text.text for sheet in sheets for text in sheet.texts())
    assert len(family.instances) >= 50
    assert all(instance.mark in texts for instance in family.instances)


def test_a_part_that_is_too_long_is_broken(tmp_path: Path) -> None:
    """A bar of 12 m shows both ends at a scale at which its depth is legible."""
    vertices = np.array([[0.0, 0, 0], [12000, 0, 0], [12000, 3000, 300], [0, 3000, 300]])
    limits = {"plausibility": "ignore", "min_angle_deg": 5}
    whole = whole_of(design((vertices, [[0, 1, 2, 3]]), checks=limits))
    sheets = first_sheets(whole)
    long = [s for n, s in sheets.items() if whole.parts[n].length > 11000 and n.startswith("BP")]
    assert long
    for sheet in long:
        assert faults(sheet) == []
        assert sheet.views[0].scale >= 0.1
        assert any(not d.true and d.value > 11000 for d in sheet.dimensions)

"""Schedules of kits: the linkage made again from its bill of materials, and the assembly order."""

from __future__ import annotations

import csv
from collections import Counter, deque
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from ddgfab.linkages import Mechanism
from fabrication.linkage.detail import detail_linkage
from fabrication.linkage.kit import Kit, detail_kit, kit
from fabrication.linkage.links import Linkage
from fabrication.linkage.project import make_kit_project
from fabrication.linkage.schedules import bar_azimuths, hinge_order, kit_schedules
from fabrication.solids import volume_of
from fabrication.table import Table

CASES = {
    "bennett": {"kind": "bennett"},
    "other hand": {"kind": "bennett", "alpha_deg": 35, "beta_deg": 120, "a_mm": 61.7},
    "cube": {"kind": "cube"},
    "knet": {
        "kind": "knet",
        "cells": [3, 2],
        "deltas_deg": [31, 47],
        "parameters": {"turn_0_deg": 7, "turn_1_deg": -11},
    },
}


@pytest.fixture(scope="module", params=CASES)
def linkage(request: pytest.FixtureRequest) -> Linkage:
    project = make_kit_project({"linkage": CASES[request.param]})
    return detail_linkage(project.mechanism(), project.part_settings())


def tables_of(linkage: Linkage) -> dict[str, Table]:
    return kit_schedules(linkage, {f.number: volume_of(f.shape) for f in linkage.families})


def bars_of(path: Path) -> dict[tuple[int, int], tuple[float, float]]:
    """Length [mm] and twist [rad] of every bar of a bom.csv, by its hinges."""
    bars = {}
    for row in csv.DictReader(path.open(encoding="utf-8")):
        if row["role"] != "link":
            continue
        length, twist = float(row["length_exact_mm"]), np.radians(float(row["twist_exact_deg"]))
        assert row["hand"] == ("right" if twist > 0 else "left")
        assert len(row["between"].split()) == int(row["count"])
        for pair in row["between"].split():
            i, j = map(int, pair.split(">"))
            bars[i, j] = (length, float(twist))
    return bars


def rebuilt(
    bars: dict[tuple[int, int], tuple[float, float]], angles: dict[tuple[int, int], float]
) -> tuple[dict[int, np.ndarray], dict[int, np.ndarray]]:
    """Hinge points and axes, walking along bars of the bill of materials.

    angles : of the bars about the axis at each hinge, which fix the pose of what moves
    """

    def turned(v: np.ndarray, axis: np.ndarray, angle: float) -> np.ndarray:
        return v * np.cos(angle) + np.cross(axis, v) * np.sin(angle)

    near: dict[int, list[int]] = {}
    for i, j in bars:
        near.setdefault(i, []).append(j)
        near.setdefault(j, []).append(i)
    points, axes = {0: np.zeros(3)}, {0: np.array([0.0, 0, 1])}
    zero = {0: np.array([1.0, 0, 0])}  # direction in which angles at a hinge are counted from
    waiting = deque([0])
    while waiting:
        v = waiting.popleft()
        for w in near[v]:
            if w in points:
                continue
            length, twist = bars.get((v, w)) or bars[w, v]
            way = turned(zero[v], axes[v], angles[v, w])
            points[w] = points[v] + length * way
            axes[w] = turned(axes[v], way, twist)
            zero[w] = turned(-way, axes[w], -angles[w, v])
            waiting.append(w)
    return points, axes


def test_the_linkage_is_made_again_from_its_bill_of_materials(
    linkage: Linkage, tmp_path: Path
) -> None:
    mechanism = linkage.mechanism
    for name, table in tables_of(linkage).items():
        table.to_csv(tmp_path / f"{name}.csv")
    bars = bars_of(tmp_path / "bom.csv")
    assert sorted(bars) == sorted(map(tuple, mechanism.bars.tolist()))
    for bar, (i, j) in enumerate(mechanism.bars.tolist()):
        assert bars[i, j][0] == pytest.approx(mechanism.lengths[bar], abs=1e-9)
        assert bars[i, j][1] == pytest.approx(mechanism.twists[bar], abs=1e-9)
    angles = {}
    for row in csv.DictReader((tmp_path / "links.csv").open(encoding="utf-8")):
        i, j = int(row["hinge_start"]), int(row["hinge_end"])
        angles[i, j] = np.radians(float(row["angle_start_exact_deg"]))
        angles[j, i] = np.radians(float(row["angle_end_exact_deg"]))
    points, axes = rebuilt(bars, angles)
    design = mechanism.pose(mechanism.design)
    size = np.ptp(design.points)
    # The first bar of hinge 0 runs along x there and here: the two frames are one.
    for v in range(mechanism.n_hinges):
        assert np.abs(points[v] - design.points[v]).max() < 1e-9 * size
        assert np.abs(axes[v] - design.axes[v]).max() < 1e-9
    for (i, j), (length, twist) in bars.items():  # those that were not walked along close too
        edge = points[j] - points[i]
        assert np.linalg.norm(edge) == pytest.approx(length, rel=1e-9)
        sine = edge @ np.cross(axes[i], axes[j]) / length
        assert np.arctan2(sine, axes[i] @ axes[j]) == pytest.approx(twist, abs=1e-9)
        assert abs(edge @ axes[i]) < 1e-9 * length


def test_another_length_in_the_bill_does_not_close(tmp_path: Path) -> None:
    project = make_kit_project({"linkage": {"kind": "bennett"}})
    linkage = detail_linkage(project.mechanism(), project.part_settings())
    tables = tables_of(linkage)
    tables["bom"].to_csv(tmp_path / "bom.csv")
    bars = bars_of(tmp_path / "bom.csv")
    azimuths = bar_azimuths(linkage.mechanism)
    angles = {}
    for bar, (i, j) in enumerate(linkage.mechanism.bars.tolist()):
        angles[i, j], angles[j, i] = azimuths[bar]
    bars[0, 2] = (bars[0, 2][0] + 1e-6, bars[0, 2][1])
    points, _ = rebuilt(bars, angles)
    gaps = [abs(np.linalg.norm(points[j] - points[i]) - bars[i, j][0]) for i, j in bars]
    assert max(gaps) > 1e-7


def test_every_part_is_listed_once_and_put_on_once(linkage: Linkage) -> None:
    tables = tables_of(linkage)
    marks = [mark for row in tables["bom"] for mark in row["marks"].split()]
    assert sorted(marks) == sorted(piece.mark for piece in linkage.pieces)
    put_on = Counter(row["part"] for row in tables["assembly"])
    for piece in linkage.pieces:
        hinges = {"link": 2, "coupon": 0}.get(piece.kind.role, 1)
        if piece.mark == "T-0001":  # the coupon's pin
            hinges = 0
        assert put_on[piece.mark] == hinges
    assert [row["step"] for row in tables["assembly"]] == list(
        range(1, len(tables["assembly"]) + 1)
    )


def test_stacks_rise_and_levels_differ_at_every_pin(linkage: Linkage) -> None:
    rows = tables_of(linkage)["assembly"]
    for hinge in range(linkage.mechanism.n_hinges):
        here = [row for row in rows if row["hinge"] == hinge]
        assert here[0]["role"] == "pin"
        rings = here[1:]
        assert all(a["to_mm"] <= b["from_mm"] + 1e-9 for a, b in pairwise(rings))
        levels = [row["level"] for row in rings if row["role"] == "link"]
        assert levels == sorted(set(levels))
        assert len(levels) == (linkage.mechanism.bars == hinge).sum()
        for row in rings:
            if row["role"] == "link":
                assert here[0]["from_mm"] < row["from_mm"] < row["to_mm"] < here[0]["to_mm"]


def test_pins_come_in_an_order_that_keeps_the_linkage_together(linkage: Linkage) -> None:
    mechanism: Mechanism = linkage.mechanism
    order = hinge_order(mechanism)
    assert sorted(order) == list(range(mechanism.n_hinges))
    there = {order[0]}
    for hinge in order[1:]:
        joined = {int(a + b) - hinge for a, b in mechanism.bars if hinge in (a, b)}
        assert joined & there
        there.add(hinge)


def test_levels_of_links_agree_with_the_stacks(linkage: Linkage) -> None:
    tables = tables_of(linkage)
    height = {(r["hinge"], r["part"]): r["from_mm"] for r in tables["assembly"]}
    for row in tables["links"]:
        for end in ("start", "end"):
            middle = height[row[f"hinge_{end}"], row["mark"]] + linkage.settings.eye_height / 2
            bar, place = row["bar"], ("start", "end").index(end)
            assert middle == pytest.approx(linkage.heights[bar, place], abs=1e-9)


def test_rods_are_bought_and_all_else_is_printed(linkage: Linkage) -> None:
    for row in tables_of(linkage)["bom"]:
        assert row["material"] == ("steel rod" if row["role"] == "pin" else "PLA")
        assert row["mass_g"] > 0


def test_labels_tell_how_links_go_on_their_pins(linkage: Linkage) -> None:
    tables = tables_of(linkage)
    side = {row["mark"]: row["label_side"] for row in tables["links"]}
    for row in tables["links"]:
        assert row["label_towards"] in (row["pin_start"], row["pin_end"])
        assert row["label_side"] in ("up", "down")
    for row in tables["assembly"]:
        assert row["label_side"] == side.get(row["part"])


def test_every_column_of_a_kit_has_a_meaning_and_every_meaning_a_column() -> None:
    found: dict[str, list[Table]] = {}
    for name, extra in (("bennett", {}), ("knet", {"parts": {"pin": "printed"}})):
        rates = {"rates": {"kg": 30.0, "cut": 1.5}}
        made = detail_kit(make_kit_project({"linkage": CASES[name], **extra, **rates}))
        for title, table in made.schedules.items():
            found.setdefault(title, []).append(table)
    assert set(found) == {"order", "bom", "links", "hinges", "assembly", "rods", "costs"}
    for title, tables in found.items():
        legend = tables[0].legend
        columns = {column for table in tables for column in table.columns}
        assert all(legend.meaning(column) for column in columns), title
        assert columns - {"status"} == set(legend.meanings) - {"status"}, title
        assert legend.title
        assert set(legend.totals) <= columns


def test_rods_hold_every_metal_pin_and_costs_are_rates_times_quantities() -> None:
    project = make_kit_project(
        {
            "linkage": CASES["cube"],
            "stock": {"length_mm": [60.0, 120.0]},
            "rates": {"kg": 30.0, "cut": 1.5, "currency": "CHF"},
        }
    )
    made = detail_kit(project)
    pins = {row["pin"]: row["length_mm"] for row in made.schedules["hinges"]}
    rods = made.schedules["rods"]
    assert sorted(" ".join(rods.column("marks")).split()) == sorted(pins)
    for row in rods:
        own = row["marks"].split()
        used = sum(pins[mark] for mark in own)
        assert row["used_mm"] == pytest.approx(used)
        assert used + 1.0 * (len(own) - 1) + 2 * 2.0 <= row["stock_mm"] + 1e-6
    costs = {row["item"]: row for row in made.schedules["costs"]}
    assert costs["ends of metal pins"]["cost"] == pytest.approx(1.5 * 2 * len(pins))
    grams = sum(row["total_g"] for row in made.schedules["bom"] if row["role"] != "pin")
    (plastic,) = [row for item, row in costs.items() if item.startswith("printed parts")]
    assert plastic["cost"] == pytest.approx(30.0 * grams / 1000.0)
    assert {row["currency"] for row in costs.values()} == {"CHF"}
    assert "estimate" in made.schedules["costs"].legend.title


def test_order_data_say_how_parts_are_printed_and_pins_are_made(bennett: Kit) -> None:
    found = {row["setting"]: row for row in bennett.schedules["order"]}
    assert found["printer.preset"]["basis"] == "default"
    bore = next(row["bore_mm"] for row in bennett.schedules["bom"] if row["role"] == "link")
    assert found["parts.clearance_mm"]["value"].startswith(f"diameter {bore:g} mm")
    printed = kit("bennett", parts={"pin": "printed", "clearance_mm": 0.25}).schedules
    found = {row["setting"]: row for row in printed["order"]}
    assert found["parts.pin"]["value"] == "printed, PLA"
    assert found["parts.clearance_mm"]["basis"] == "project"
    assert "rods" not in printed

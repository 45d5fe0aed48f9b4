"""Lists for shops: parts list, sizes, joints, cut list; legend and workbook of the canopy's kin."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
from detailing_cases import dome, grid, hexagons, vertical

from ddgfab.errors import ProjectError
from fabrication.gridshell.design import Design
from fabrication.gridshell.load import make_project
from fabrication.gridshell.schedules import schedules
from fabrication.table import Table

VARIANTS: dict[str, dict[str, dict[str, object]]] = {
    "plain": {},
    "bolted": {"beam": {"profile": "FL 80x40"}, "connection": {"kind": "stud"}},
    "end plates": {"beam": {"profile": "FL 80x20"}, "connection": {"kind": "end_plate"}},
    "hollow": {
        "beam": {"profile": "RHS 120x60x5"},
        "node": {"kind": "tube", "wall_mm": 25.0},
        "connection": {"kind": "stud"},
    },
    "hollow end plates": {
        "beam": {"profile": "RHS 100x60x5"},
        "connection": {"kind": "end_plate"},
    },
    "slotted": {
        "beam": {"profile": "FL 260x120"},
        "node": {"kind": "plates"},
        "connection": {"kind": "slotted", "bolt": "M16"},
    },
    "priced": {"rates": {"kg": 4.0}},
    "stars": {
        "beam": {"profile": "FL 100x40"},
        "node": {"kind": "star"},
        "connection": {"kind": "bolted_tongue"},
    },
    "hubs": {
        "beam": {"profile": "FL 100x40"},
        "node": {"kind": "tube", "min_diameter_mm": 60.0},
        "connection": {"kind": "bolted_tongue"},
        "ground": {"where": "boundary"},
    },
    "straps": {
        "beam": {"profile": "FL 100x12"},
        "node": {"kind": "star"},
        "connection": {"kind": "bolted_tongue", "ends": "doubled"},
    },
    "glazed": {"panel": {"build_up": "8/16Ar/6.6.2", "edge": "mitred", "step_mm": 30.0}},
}


def found_tables() -> dict[str, list[Table]]:
    """Every table of some structures that together have every column there is."""
    found: dict[str, list[Table]] = {}
    shells = [dome().detail(**sections) for sections in VARIANTS.values()]
    shells.append(hexagons().detail(panel={"offset_mm": 60.0}))
    for tables in map(schedules, shells):
        for name, table in tables.items():
            found.setdefault(name, []).append(table.with_status(()))
    return found


def test_every_column_has_a_meaning_and_every_meaning_a_column() -> None:
    torsion = {"skew_start_deg", "skew_end_deg", "roll_start_deg", "roll_end_deg"}
    for name, tables in found_tables().items():
        legend = tables[0].legend
        columns = {column for table in tables for column in table.columns} - {"status"}
        assert all(legend.meaning(column) for column in columns), name
        used = {legend.key(column) for column in columns}
        assert used == set(legend.meanings) - torsion - {"status"}, name
        assert legend.title, name
        assert legend.about, name
        assert set(legend.totals) <= columns


def test_meanings_name_the_number_of_their_column() -> None:
    legend = schedules(dome().detail())["panels"].legend
    assert "side 3" in legend.meaning("edge_3_mm")
    assert "{k}" not in legend.meaning("angle_2_deg")
    assert legend.meaning("no_such_column") == ""


def test_parts_list_counts_every_piece_and_all_the_mass() -> None:
    shell = dome().detail()
    tables = schedules(shell)
    bom = tables["bom"]
    assert sum(bom.column("quantity")) == len(shell.pieces)
    assert sorted(" ".join(bom.column("marks")).split()) == sorted(p.mark for p in shell.pieces)
    each = sum(sum(tables[name].column("mass_kg")) for name in ("panels", "beams", "nodes"))
    assert sum(bom.column("mass_kg")) == pytest.approx(each, rel=1e-12)
    roles = {row["role"]: row["material"] for row in bom}
    assert roles["beam"] == "steel (not stated)"
    graded = dome().detail(
        beam={"grade": "S355J2"}, panel={"build_up": "8/16Ar/6.6", "grade": "toughened"}
    )
    roles = {row["role"]: row["material"] for row in schedules(graded)["bom"]}
    assert roles["beam"] == "steel S355J2"
    assert roles["panel"] == "glass 8/16Ar/6.6, toughened"


def test_size_classes_hold_their_panes() -> None:
    tables = schedules(dome().detail())
    panes = {row["mark"]: row for row in tables["panels"]}
    assert sum(tables["sizes"].column("quantity")) == len(panes)
    assert sum(tables["sizes"].column("area_m2")) == pytest.approx(
        sum(tables["panels"].column("area_m2"))
    )
    for row in tables["sizes"]:
        for mark in row["marks"].split():
            assert panes[mark]["size_class"] == row["size_class"]
            for side in ("width_mm", "height_mm"):
                assert row[side] - 100.0 < panes[mark][side] <= row[side] + 1e-6
        assert row["rectangles_m2"] > row["area_m2"]


def test_a_pane_can_be_drawn_from_its_row() -> None:
    """Sides and angles close; the diagonals are those of the figure they make."""
    for row in schedules(dome().detail(panel={"corner_radius_mm": 8}))["panels"]:
        sides = [row[f"edge_{k}_mm"] for k in range(1, 5)]
        turns = [math.pi - math.radians(row[f"angle_{k}_deg"]) for k in range(1, 5)]
        heading, corner = 0.0, 0j
        corners = []
        for k in range(4):
            heading += turns[k] if k else 0.0
            corners.append(corner)
            corner += sides[k] * np.exp(1j * heading)
        assert abs(corner) < 1e-6 * sum(sides)
        assert abs(corners[2] - corners[0]) == pytest.approx(row["diagonal_13_mm"], rel=1e-9)
        assert abs(corners[3] - corners[1]) == pytest.approx(row["diagonal_24_mm"], rel=1e-9)


def test_joints_agree_with_panes_and_beams() -> None:
    shell = dome().detail(checks={"family_tolerance_mm": 0.0})
    tables = schedules(shell)
    panes = {row["mark"]: row for row in tables["panels"]}
    beams = {row["mark"]: row for row in tables["beams"]}
    assert len(tables["joints"]) == len(beams)
    gaskets = 0.0
    for row in tables["joints"]:
        beam = beams[row["beam"]]
        assert {row["panel_left"], row["panel_right"]} == {beam["panel_left"], beam["panel_right"]}
        own = [mark for mark in (row["panel_left"], row["panel_right"]) if mark]
        assert row["place"] == ("inner" if len(own) == 2 else "boundary")
        lengths = []
        for mark in own:
            k = next(k for k in range(1, 5) if panes[mark][f"beam_{k}"] == row["beam"])
            lengths.append(panes[mark][f"edge_{k}_mm"])
            if len(own) == 2:
                assert panes[mark][f"dihedral_{k}_deg"] == pytest.approx(row["dihedral_deg"])
                assert panes[mark][f"edge_work_{k}"] == "A"
            else:
                assert panes[mark][f"edge_work_{k}"] == "P"
        assert row["clamp_mm"] == pytest.approx(min(lengths))
        assert row["cap_mm"] == pytest.approx(max(lengths))
        gaskets += sum(lengths)
    assert sum(tables["joints"].column("gasket_mm")) == pytest.approx(gaskets)  # square edges


def test_left_and_right_are_as_the_legend_says() -> None:
    shell = dome().detail()
    case = shell.mesh
    for beam in shell.beams:
        middle = case.vertices[list(beam.vertices)].mean(axis=0)
        for mark, sign in zip(beam.panels, (1.0, -1.0), strict=True):
            if mark is not None:
                away = case.face_centers[int(mark[2:])] - middle
                assert sign * (away @ beam.placement[:3, 1]) > 0


def test_mitres_lengths_and_setbacks_of_a_beam_make_its_corners() -> None:
    """Top and bottom length differ by the mitres over the depth; setbacks fill the axis length."""
    for end in ("flat", "cope"):
        shell = dome().detail(beam={"end": end}, checks={"family_tolerance_mm": 0.0})
        for row in schedules(shell)["beams"]:
            lean = math.tan(math.radians(row["mitre_start_deg"]))
            lean += math.tan(math.radians(row["mitre_end_deg"]))
            depth = shell.project.beam.section().depth
            longer = row["length_top_mm"] - row["length_bottom_mm"]
            assert longer == pytest.approx(depth * lean, abs=1e-9)
            offsets = row["offset_start_mm"] + row["offset_end_mm"]
            assert offsets + row["length_top_mm"] == pytest.approx(row["length_axis_mm"])


def test_seats_of_a_node_are_its_arms() -> None:
    shell = dome().detail(connection={"kind": "stud"}, beam={"profile": "FL 80x40"})
    for row in schedules(shell)["nodes"]:
        shape = shell.nodes[row["vertex"]].shape
        for k in range(1, row["valence"] + 1):
            assert row[f"seat_{k}_mm"] + row[f"seat_depth_{k}_mm"] == pytest.approx(shape.radius)
            half = 0.5 * row[f"seat_width_{k}_mm"]
            assert math.hypot(row[f"seat_{k}_mm"], half) == pytest.approx(shape.radius)
            assert 0 < row[f"hole_{k}_mm"] < row["height_mm"]
            assert row[f"hole_{k}_diameter_mm"] > 5.0
        assert row["above_mm"] + row["below_mm"] == pytest.approx(row["height_mm"])


def test_parts_are_described_as_what_is_ordered() -> None:
    for sections, bar in (
        ({}, True),
        ({"node": {"kind": "tube", "wall_mm": 5.0}}, True),
        (VARIANTS["stars"], False),  # plates, not a bar
    ):
        tables = schedules(dome().detail(**sections))
        bars = {row["profile"] for row in tables["bars"]}
        roles = {row["role"]: row["description"].split(",")[0] for row in tables["bom"]}
        assert roles["beam"] in bars
        assert (roles["node"] in bars) == bar
        assert (roles["node"].startswith("diameter ")) != bar
        assert roles["panel"].endswith(" x 12.0")


def test_the_cut_list_has_every_bar_once_in_stock_that_holds_it() -> None:
    shell = dome().detail(stock={"length_mm": [6000, 3000], "kerf_mm": 4, "trim_mm": 15})
    tables = schedules(shell)
    lengths = {row["mark"]: row["length_cut_mm"] for row in tables["beams"]}
    lengths |= {row["mark"]: row["height_mm"] for row in tables["nodes"]}
    seen = []
    for row in tables["bars"]:
        own = row["marks"].split()
        seen += own
        used = sum(lengths[mark] for mark in own)
        assert row["used_mm"] == pytest.approx(used)
        assert row["stock_mm"] in (3000.0, 6000.0)
        assert used + 4 * (len(own) - 1) + 2 * 15 <= row["stock_mm"] + 1e-6
        assert re.findall(r"[BN]-\d+", row["cuts"]) == own
    assert sorted(seen) == sorted(lengths)
    assert {row["profile"] for row in tables["stock"]} == {"FL 60x8", "round 40"}
    assert sum(tables["stock"].column("bars")) == len(tables["bars"])
    assert sum(tables["stock"].column("used_mm")) == pytest.approx(sum(lengths.values()))


def test_a_beam_longer_than_all_stock_is_listed_without_one() -> None:
    shell = vertical(grid(1, 1, side=3000.0)).detail(stock={"length_mm": [2000]})
    tables = schedules(shell)
    beams = tables["bars"].filter(lambda row: row["marks"].startswith("B-"))
    assert beams.column("stock_mm") == [None] * 4
    assert tables["stock"][0]["waste_percent"] == pytest.approx(0.0)


def test_costs_are_rates_times_what_the_lists_have() -> None:
    rates = {"kg": 4.0, "m2": 90.0, "cut": 2.5, "node": 60.0, "hole": 3.0}
    shell = dome().detail(rates=rates, connection={"kind": "stud"}, beam={"profile": "FL 80x40"})
    tables = schedules(shell)
    costs = {row["item"]: row["cost"] for row in tables["costs"]}
    steel = sum(tables["beams"].column("mass_kg")) + sum(tables["nodes"].column("mass_kg"))
    assert costs["steel of beams"] + costs["steel of nodes"] == pytest.approx(4.0 * steel)
    assert costs["panes"] == pytest.approx(90.0 * sum(tables["panels"].column("area_m2")))
    assert costs["ends of beams"] == pytest.approx(2.5 * 2 * len(shell.beams))
    assert costs["nodes"] == pytest.approx(60.0 * len(shell.nodes))
    assert costs["holes for bolts, in nodes and beams"] == pytest.approx(3.0 * 4 * len(shell.beams))
    assert costs["openings behind the holes of beams"] == pytest.approx(3.0 * 2 * len(shell.beams))
    assert "costs" not in schedules(dome().detail())
    timber = dome().detail(rates=rates, **VARIANTS["slotted"])
    costs = {row["item"]: row["quantity"] for row in schedules(timber)["costs"]}
    bolts = 4 * len(timber.beams)
    assert costs["holes for bolts, in nodes and beams"] == 3 * bolts  # both discs and the beam
    assert costs["recesses for heads and nuts in beams"] == 2 * bolts
    assert "openings behind the holes of beams" not in costs
    only = schedules(dome().detail(rates={"cut": 0.0}))["costs"]
    assert only.column("item") == ["ends of beams"]


@pytest.mark.parametrize(
    ("section", "message"),
    [
        ({"rates": {"kg": -1}}, "greater than or equal to 0"),
        ({"rates": {"currency": "x" * 21}}, "currency"),
        ({"stock": {"length_mm": []}}, "length_mm"),
        ({"stock": {"length_mm": "long"}}, '"auto"'),
        ({"stock": {"kerf_mm": -1}}, "kerf_mm"),
    ],
)
def test_wrong_stock_and_rates_are_named(section: dict[str, object], message: str) -> None:
    with pytest.raises(ProjectError, match=message):
        make_project(section)


@pytest.mark.parametrize("value", ["29.11.2026", "2026-13-01", "today", 7])
def test_dates_are_dates(value: object) -> None:
    with pytest.raises(ProjectError, match="must be a date such as 2026-11-30"):
        make_project({"project": {"date": value}})


def test_the_title_block_is_plain_text_of_any_length(
    small_design: Design, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    settings = make_project({"project": {"title": "Hall & yard \u202eroof\ufffe " * 400}})
    block = settings.project.block("x")
    assert block.title.startswith("Hall & yard roof Hall")
    assert block.date == ""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    assert settings.project.block("x").date == "1970-01-02"
    assert make_project({"project": {"date": "2026-11-30"}}).project.block("x").date == "2026-11-30"

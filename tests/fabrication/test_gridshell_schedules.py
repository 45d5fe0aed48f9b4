"""Schedules: the columns of product.md, and values that agree with the geometry in the world."""

from __future__ import annotations

import csv
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from detailing_cases import dome, fan, grid, vertical

from ddgfab.errors import DdgError
from ddgfab.mesh import Mesh, unit
from fabrication.families import families
from fabrication.formats.tables import heading
from fabrication.gridshell.schedules import (
    beam_rows,
    family_masses,
    node_rows,
    panel_rows,
    schedules,
)
from fabrication.table import Table

PANEL = ["mark", "number", "face", "sides", "size_class", "area_m2", "mass_kg", "thickness_mm"]
PANEL += ["width_mm", "height_mm", "corner_radius_mm", "planarity_mm", "planarity_class"]
PANEL += ["diagonal_13_mm", "diagonal_24_mm"]
BEAM = ["mark", "number", "edge", "node_start", "node_end", "profile", "length_axis_mm"]
BEAM += [
    "length_cut_mm",
    "length_top_mm",
    "length_bottom_mm",
    "mitre_start_deg",
    "mitre_end_deg",
    "torsion_deg",
    "mass_kg",
]
BEAM += ["panel_left", "panel_right"]
BEAM += ["offset_start_mm", "offset_end_mm", "connection", "weld_mm"]
NODE = ["mark", "number", "vertex", "valence", "x_mm", "y_mm", "z_mm"]
NODE += ["axis_x", "axis_y", "axis_z", "diameter_mm", "height_mm", "above_mm", "below_mm"]
NODE += ["mark_radius_mm", "mark_diameter_mm", "mark_depth_mm", "mass_kg"]


def test_columns_are_those_of_the_contract() -> None:
    tables = schedules(dome().detail())
    sides = [
        f"{w}_{k}{u}"
        for k in range(1, 5)
        for w, u in (
            ("edge", "_mm"),
            ("angle", "_deg"),
            ("edge_work", ""),
            ("beam", ""),
            ("dihedral", "_deg"),
            ("neighbour", ""),
        )
    ]
    arms = [
        f"{w}_{k}{u}"
        for k in range(1, 5)
        for w, u in (
            ("beam", ""),
            ("azimuth", "_deg"),
            ("elevation", "_deg"),
            ("seat", "_mm"),
            ("seat_depth", "_mm"),
            ("seat_width", "_mm"),
        )
    ]
    assert tables["panels"].columns == PANEL + sides
    assert tables["beams"].columns == BEAM
    assert tables["nodes"].columns == NODE + arms


def test_flat_grid_by_hand() -> None:
    shell = vertical(grid(2, 2)).detail(panel={"gap_mm": 20.0, "thickness_mm": 10.0})
    tables = schedules(shell)
    panel = tables["panels"][0]
    assert (panel["mark"], panel["number"], panel["face"], panel["sides"]) == (
        "P-0000",
        "PP-001",
        0,
        4,
    )
    assert panel["area_m2"] == pytest.approx(1.48**2)
    assert panel["mass_kg"] == pytest.approx(1.48**2 * 0.01 * 2500)
    assert [panel[f"edge_{k}_mm"] for k in (1, 2, 3, 4)] == pytest.approx([1480] * 4)
    assert [panel[f"angle_{k}_deg"] for k in (1, 2, 3, 4)] == pytest.approx([90] * 4)
    length = 1500 - 2 * (math.sqrt(384) + 0.5)
    for beam in tables["beams"]:
        assert beam["length_cut_mm"] == pytest.approx(length)
        assert beam["mass_kg"] == pytest.approx(length * 480 * 7850e-9)
        assert (beam["mitre_start_deg"], beam["mitre_end_deg"]) == (0.0, 0.0)
    node = tables["nodes"][4]
    assert (node["valence"], node["diameter_mm"], node["height_mm"]) == (4, 40.0, 66.0)
    assert node["azimuth_1_deg"] == 0.0


@pytest.mark.parametrize("end", ["flat", "cope"])
def test_ids_and_angles_agree_between_the_schedules(end: str) -> None:
    case = dome()
    shell = case.detail(beam={"end": end})
    tables = schedules(shell)
    for table in (tables["panels"], tables["beams"], tables["nodes"]):
        names = table.column("mark")
        assert len(set(names)) == len(names) == len(table)
    panels = {row["mark"] for row in tables["panels"]}
    beams = {row["mark"]: row for row in tables["beams"]}
    arms = {}
    for row in tables["nodes"]:
        for k in range(1, row["valence"] + 1):
            arms[row["mark"], row[f"beam_{k}"]] = row[f"elevation_{k}_deg"]
    for mark, row in beams.items():
        # A cut parallel to the axis: the mitre is how far the beam falls from the node's plane.
        assert row["mitre_start_deg"] == pytest.approx(-arms[row["node_start"], mark], abs=0.2)
        assert row["mitre_end_deg"] == pytest.approx(-arms[row["node_end"], mark], abs=0.2)
        assert {row["panel_left"], row["panel_right"]} - {None} <= panels
    for row in tables["panels"]:
        for k in range(1, 5):
            other = row[f"neighbour_{k}"]
            if other is not None:
                assert row["mark"] in [
                    tables["panels"][int(other[2:])][f"neighbour_{j}"] for j in range(1, 5)
                ]


def test_turned_beams_list_the_ends_of_the_shared_shape() -> None:
    # A fan of equal triangles: rim beams run both ways round, all are one number.
    shell = fan(6, True).detail(panel={"offset_mm": 40.0})
    found = families(shell.pieces)
    rows = beam_rows(shell, found, family_masses(found, shell.project))
    spokes = [row for row in rows if "N-0000" in (row["node_start"], row["node_end"])]
    apex_first = [row["node_start"] == "N-0000" for row in spokes]
    assert len({row["number"] for row in spokes}) == 1
    assert len(set(apex_first)) == 1  # the shared shape begins at the apex, or ends there
    assert {b.nodes[0] == "N-0000" for b in shell.beams if "N-0000" in b.nodes} == {True, False}


@pytest.mark.parametrize("end", ["flat", "cope"])
def test_azimuths_count_from_the_mark_of_the_part_in_hand(end: str) -> None:
    # A skew lattice with shuffled faces, so that the nodes' first arms lie differently.
    lattice = grid(4, 4)
    skew = lattice.vertices @ np.array([[1, 0, 0], [0.4, 1, 0], [0, 0, 1.0]])
    order = np.random.default_rng(5).permutation(lattice.n_faces)
    case = vertical(Mesh.build(skew, [lattice.face(f) for f in order]))
    shell = case.detail(beam={"end": end})
    found = families(shell.pieces)
    inside = {n.mark for n in shell.nodes if len(n.arms) == 4}
    assert sum(inside <= {i.mark for i in f.instances} for f in found) == 1
    rows = {r["mark"]: r for r in node_rows(shell, found, family_masses(found, shell.project))}
    seen = 0
    for family in found:
        for instance in family.instances if family.role == "node" else ():
            row = rows[instance.mark]
            azimuths = [row[f"azimuth_{k}_deg"] for k in range(1, row["valence"] + 1)]
            assert azimuths == sorted(azimuths)
            assert azimuths[0] == pytest.approx(0)
            for k, azimuth in enumerate(azimuths, 1):
                edge = int(row[f"beam_{k}"][2:])
                i, j = case.mesh.edges[edge]
                other = j if i == row["vertex"] else i
                away = unit(case.mesh.vertices[other] - case.mesh.vertices[row["vertex"]])
                a = math.radians(azimuth)
                assert np.allclose(instance.placement[:3, :3] @ [math.cos(a), math.sin(a), 0], away)
                seen += 1
    assert seen == 80


def test_sides_of_turned_panels_match_their_edges() -> None:
    case = dome()
    shell = case.detail(checks={"family_tolerance_mm": 30.0})  # so that many are turned
    found = families(shell.pieces, 30.0)
    assert sum(f.role == "panel" for f in found) < len(shell.panels)
    for row in panel_rows(shell, found, family_masses(found, shell.project)):
        panel = shell.panels[row["face"]]
        lengths = {s.neighbour: case.mesh.edge_lengths[s.edge] for s in panel.sides}
        for k in range(1, 5):
            if row[f"neighbour_{k}"] is not None:
                assert row[f"edge_{k}_mm"] == pytest.approx(lengths[row[f"neighbour_{k}"]], abs=80)


def test_a_turned_panel_lists_its_neighbour_at_the_right_side() -> None:
    # A scalene quad and its copy turned by half a turn about the middle of side 1-2, which is
    # 1118 mm long and no other side is; the copy's corners are listed from another one.
    quad = np.array([[0, 0, 0], [1500, 0, 0], [1000, 1000, 0], [-300, 900, 0.0]])
    copy = quad[1] + quad[2] - quad
    mesh = Mesh.build(np.vstack([quad, copy[[3, 0]]]), [[0, 1, 2, 3], [2, 1, 4, 5]])
    shell = vertical(mesh).detail()
    found = families(shell.pieces)
    rows = panel_rows(shell, found, family_masses(found, shell.project))
    assert [row["number"] for row in rows] == ["PP-001", "PP-001"]
    for row, other in zip(rows, ["P-0001", "P-0000"], strict=True):
        k = next(k for k in range(1, 5) if row[f"neighbour_{k}"] is not None)
        assert row[f"neighbour_{k}"] == other
        lengths = [row[f"edge_{j}_mm"] for j in range(1, 5)]
        assert lengths[k - 1] == min(lengths, key=lambda length: abs(length - 1118))


def test_masses_once_per_number() -> None:
    shell = vertical(grid(3, 3)).detail()
    found = families(shell.pieces)
    masses = family_masses(found, shell.project)
    assert list(masses) == [f.number for f in found]
    assert all(mass > 0 for mass in masses.values())


def test_mixed_polygons_leave_missing_sides_empty() -> None:
    v = [[0, 0, 0], [1500, 0, 0], [1500, 1500, 0], [0, 1500, 0], [2500, 750, 0]]
    shell = vertical(Mesh.build(v, [[0, 1, 2, 3], [1, 4, 2]])).detail()
    row = schedules(shell)["panels"][1]
    assert row["sides"] == 3
    assert row["edge_4_mm"] is row["neighbour_4"] is None
    assert sum(row[f"angle_{k}_deg"] for k in (1, 2, 3)) == pytest.approx(180)


def test_no_panels_gives_an_empty_table() -> None:
    assert len(schedules(vertical(grid(1, 1)).detail(panel={"kind": "none"}))["panels"]) == 0


def test_tables_filter_sort_and_add_columns() -> None:
    table = schedules(dome().detail())["beams"]
    heavy = table.sort("mass_kg", descending=True)
    assert heavy.column("mass_kg") == sorted(table.column("mass_kg"), reverse=True)
    rim = table.filter(lambda row: row["panel_right"] is None or row["panel_left"] is None)
    assert 0 < len(rim) < len(table)
    priced = rim.with_column("price", lambda row: 2 * row["mass_kg"])
    assert priced.columns == [*table.columns, "price"]
    assert "price" not in table.columns
    assert repr(table) == f"Table(beams: {len(table)} rows, 20 columns)"
    assert isinstance(table[:3], Table)
    assert table.sort("panel_right").column("panel_right")[-1] is None
    with pytest.raises(KeyError, match="no column 'mass'"):
        table.sort("mass")
    shown = Table([{"a": "<b>", "x": 1.23456789}])._repr_html_()
    assert "&lt;b&gt;" in shown
    assert "1.23457" in shown


def test_files_and_data_frames(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    table = schedules(vertical(grid(2, 1)).detail())["nodes"]
    table.to_csv(tmp_path / "nodes.csv")
    with (tmp_path / "nodes.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["mark"] for row in rows] == table.column("mark")
    openpyxl = pytest.importorskip("openpyxl")
    table.to_xlsx(tmp_path / "nodes.xlsx")
    sheet = openpyxl.load_workbook(tmp_path / "nodes.xlsx")["nodes"]
    assert [cell.value for cell in sheet[1]] == [heading(c) for c in table.columns]
    pytest.importorskip("pandas")
    assert table.to_dataframe()["mark"].tolist() == table.column("mark")
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(DdgError, match="pandas, which is not installed"):
        table.to_dataframe()


def test_schedules_leave_the_kernel_out() -> None:
    program = (
        "import sys; sys.path.insert(0, 'tests/fabrication')\n"
        "from detailing_cases import dome\n"
        "from fabrication.gridshell.schedules import schedules\n"
        "schedules(dome().detail())\n"
        "heavy = {'OCP', 'build123d', 'cadquery', 'manifold3d', 'pyvista', 'pandas'}\n"
        "print(sorted(heavy & set(sys.modules)))"
    )
    root = Path(__file__).resolve().parents[2]
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=root, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"

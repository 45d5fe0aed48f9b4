"""The workbook and columns.csv of a job: how they print, and what they say of each column."""

from __future__ import annotations

import csv
from pathlib import Path

import openpyxl
import pytest
from detailing_cases import dome, grid, hexagons

from ddgfab.mesh import Mesh
from fabrication.formats.tables import columns_of
from fabrication.formats.workbook import COVER, sheets_of
from fabrication.gridshell.design import design
from fabrication.gridshell.schedules import schedules
from fabrication.job.result import JobResult


def test_the_workbook_of_a_job_prints_and_adds_up(small_job: JobResult) -> None:
    folder, manifest = small_job.folder, small_job.manifest
    book = openpyxl.load_workbook(folder / "schedules" / "schedule.xlsx")
    values = openpyxl.load_workbook(folder / "schedules" / "schedule.xlsx", data_only=True)
    names = book.sheetnames
    assert names[0] == COVER
    assert names[-1] == "columns"
    for sheet in book:
        setup = sheet.page_setup
        assert (setup.orientation, setup.fitToHeight) == ("landscape", 0)
        assert setup.fitToWidth in (None, 1)  # one page wide is the default of the format
        assert sheet.sheet_properties.pageSetUpPr.fitToPage
        assert sheet.oddFooter.right.text == "page &P of &N"
        if sheet.title != COVER:
            assert sheet.print_title_rows == "$1:$1"
            assert sheet.freeze_panes == "B2"
            (table,) = sheet.tables.values()
            assert table.autoFilter.ref == table.ref
    total = sum(part["mass_kg"] for part in manifest["parts"])
    sheet = values["bom"]
    header = [cell.value for cell in sheet[1]]
    last = [cell.value for cell in sheet[sheet.max_row]]
    assert last[header.index("quantity")] == len(manifest["parts"])
    # Cells are rounded to grams.
    assert last[header.index("mass [kg]")] == pytest.approx(total, abs=5e-4 * sheet.max_row)
    cover = {row[0]: row for row in values[COVER].iter_rows(values_only=True)}
    assert cover["all"][2] == len(manifest["parts"])
    assert cover["all"][3] == pytest.approx(total, abs=1e-4)
    for role in ("beam", "node", "panel"):
        own = [part["mass_kg"] for part in manifest["parts"] if part["role"] == role]
        assert cover[role][2:4] == (len(own), pytest.approx(sum(own), abs=1e-4))
    formula = book["bom"].cell(sheet.max_row, header.index("quantity") + 1).value
    assert formula == f"=SUBTOTAL(109,D2:D{sheet.max_row - 1})"


def test_columns_csv_explains_every_column_of_every_file(small_folder: Path) -> None:
    with (small_folder / "schedules" / "columns.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    told = {(row["table"], row["column"]): row for row in rows}
    assert len(told) == len(rows)
    there = set()
    for path in (small_folder / "schedules").glob("*.csv"):
        if path.name != "columns.csv":
            with path.open(encoding="utf-8", newline="") as file:
                header = next(csv.reader(file))
            there |= {(path.stem, column) for column in header}
    assert set(told) == there
    assert all(row["meaning"] for row in rows)
    assert told["beams", "mitre_end_deg"]["unit"] == "deg"


def test_rejected_panes_are_named_in_every_list() -> None:
    bent = grid(2, 2).vertices.copy()
    bent[0, 2] = 400.0
    mesh = Mesh.build(bent, [grid(2, 2).face(f) for f in range(4)])
    tables = design(mesh, checks={"torsion_deg": 90.0, "plausibility": "ignore"}).schedules
    for name, column in (("panels", "mark"), ("bom", "marks"), ("sizes", "marks")):
        named = {
            row[column]: row["status"]
            for row in tables[name]
            if "P-0000" in str(row[column]).split()
        }
        assert all(status.startswith("rejected") for status in named.values())
        assert named
    rim = [row for row in tables["joints"] if "P-0000" in row["marks"].split()]
    assert len(rim) == 4
    assert all("rejected" in row["status"] for row in rim)
    without = {name for name, table in tables.items() if "status" not in columns_of(table)}
    assert without == {"order"}


def test_diagonals_fix_panes_of_six_sides() -> None:
    """From sides and diagonals alone, triangle by triangle, the outline and its area."""
    shell = hexagons().detail(panel={"offset_mm": 60.0})
    for row in schedules(shell)["panels"]:
        sides = [row[f"edge_{k}_mm"] for k in range(1, 7)]
        rays = [sides[0], row["diagonal_13_mm"], row["diagonal_to_4_mm"], row["diagonal_to_5_mm"],
                sides[5]]  # fmt: skip
        assert row["diagonal_24_mm"] is None
        area = 0.0
        for a, b, c in zip(rays[:-1], rays[1:], sides[1:5], strict=True):
            half = 0.5 * (a + b + c)
            area += (half * (half - a) * (half - b) * (half - c)) ** 0.5
        assert area == pytest.approx(1e6 * row["area_m2"], rel=1e-9)


@pytest.mark.parametrize("paper", ["A3", "A4"])
def test_sheets_are_split_until_their_texts_are_large_enough(paper: str) -> None:
    """Every column once beside those that name the piece; constant ones last; each sheet fits."""
    table = schedules(dome().detail(connection={"kind": "stud"}, beam={"profile": "FL 80x40"}))[
        "nodes"
    ]
    names = list(table.columns)
    parts = sheets_of("nodes", table.rows, names, table.legend, paper)
    assert len(parts) > 1
    seen: list[str] = []
    for k, (title, rows, columns) in enumerate(parts):
        assert title == ("nodes" if not k else f"nodes ({k + 1})")
        assert columns[:2] == ["mark", "number"]
        assert len(rows) == len(table)
        assert set(rows[0]) == set(columns)
        seen += columns if not k else columns[2:]
        arms = [c.split("_")[1] for c in columns if c.startswith(("beam_", "seat_width"))]
        assert all(f"beam_{arm}" in columns for arm in arms if arm.isdigit())
    alike = [c for c in names if not any(s.isdigit() for s in c) and c not in table.legend.totals]
    alike = [c for c in alike if len(set(table.column(c))) == 1]
    assert "diameter_mm" in alike
    assert seen == [c for c in names if c not in alike] + alike
    one = sheets_of("bom", [{"mark": "A", "mass_kg": 1.0}], ["mark", "mass_kg"], table.legend, "A4")
    assert len(one) == 1

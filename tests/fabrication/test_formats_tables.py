"""Schedules: CSV read back by the csv module, XLSX by openpyxl."""

from __future__ import annotations

import csv
import io
import zipfile
from pathlib import Path

import numpy as np
import openpyxl
import pytest

from ddgfab.errors import OutputError
from fabrication.formats.csv import csv_text, write_csv
from fabrication.formats.tables import columns_of, heading
from fabrication.formats.xlsx import write_xlsx

ROWS = [
    {
        "mark": "B-0000",
        "node_start": "N-0001",
        "length_axis_mm": 1234.56789,
        "mitre_start_deg": -0.00001,
        "area_m2": 1.23456789,
        "mass_kg": 1e-7,
        "axis_z": 0.123456789123,
        "edge": np.int64(12),
        "ok": True,
    },
    {
        "mark": "=1+1",
        "node_start": None,
        "length_axis_mm": np.float64(1e15),
        "mitre_start_deg": float("nan"),
        "area_m2": 2,
        "mass_kg": 3.5,
        "axis_z": -1.0,
        "note": 'comma, "quote"\nline',
    },
]


def test_csv_has_fixed_decimals_by_unit_and_no_exponents() -> None:
    text = csv_text(ROWS)
    first, second = list(csv.DictReader(io.StringIO(text)))
    assert list(first) == columns_of(ROWS)
    assert first["length_axis_mm"] == "1234.568"
    assert first["mitre_start_deg"] == "0.0000"  # not -0.0000
    assert first["area_m2"] == "1.2346"
    assert first["mass_kg"] == "0.000"
    assert first["axis_z"] == "0.123456789"
    assert (first["edge"], first["ok"], first["note"]) == ("12", "true", "")
    assert second["length_axis_mm"] == "1000000000000000.000"
    assert second["mitre_start_deg"] == ""
    assert second["note"] == 'comma, "quote"\nline'
    assert "\r" not in text


def test_csv_columns_can_be_chosen_and_the_file_is_utf8(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    write_csv(path, [{"a": "Träger", "b": 1}], columns=["b", "a", "c"])
    assert path.read_bytes() == "b,a,c\n1,Träger,\n".encode()
    assert csv_text([]) == "\n"


def test_xlsx_holds_the_same_rows_as_tables(tmp_path: Path) -> None:
    path = tmp_path / "schedule.xlsx"
    write_xlsx(path, {"beams": ROWS, "nodes": [], "panels": [{"mark": "P-0000"}]})
    book = openpyxl.load_workbook(path)
    assert book.sheetnames == ["beams", "nodes", "panels"]
    sheet = book["beams"]
    assert sheet.freeze_panes == "B2"
    (table,) = sheet.tables.values()
    assert table.ref == f"A1:{chr(ord('A') + len(columns_of(ROWS)) - 1)}3"
    header, first, second = (list(row) for row in sheet.iter_rows(values_only=True))
    assert header == [heading(column) for column in columns_of(ROWS)]
    assert first[header.index("length axis [mm]")] == 1234.568
    assert sheet.cell(2, header.index("length axis [mm]") + 1).number_format == "0.0"
    assert first[header.index("edge")] == 12
    assert second[header.index("mitre start [deg]")] is None
    evil = sheet.cell(3, 1)
    assert (evil.value, evil.data_type) == ("=1+1", "s")  # a text, not a formula


@pytest.mark.parametrize("text", ["=1+1", "+1", "-1", "@A1", "{=A1}", "http://a.b", "12"])
def test_no_text_becomes_a_formula_a_link_or_a_number(tmp_path: Path, text: str) -> None:
    path = tmp_path / "a.xlsx"
    write_xlsx(path, {"s": [{"name": text}]})
    cell = openpyxl.load_workbook(path)["s"]["A2"]
    assert (cell.value, cell.data_type, cell.hyperlink) == (text, "s", None)
    with zipfile.ZipFile(path) as archive:
        assert b"<f>" not in archive.read("xl/worksheets/sheet1.xml")


@pytest.mark.parametrize("text", ["=1+1", "+cmd|' /C calc'!A0", "-5+A1", "-", "@SUM(A1)", "\t=1"])
def test_spreadsheets_take_no_text_of_a_csv_for_a_formula(text: str) -> None:
    (row,) = csv.DictReader(io.StringIO(csv_text([{"grade": text, "angle_deg": -5.0}])))
    assert row == {"grade": f"'{text}", "angle_deg": "-5.0000"}


@pytest.mark.parametrize("text", ["-5", "-47.000000000001", "+1.5e-7"])
def test_numbers_with_all_their_digits_stay_numbers(text: str) -> None:
    (row,) = csv.DictReader(io.StringIO(csv_text([{"twist_exact_deg": text}])))
    assert float(row["twist_exact_deg"]) == float(text)


def test_same_rows_same_bytes(tmp_path: Path) -> None:
    for name in "ab":
        write_xlsx(tmp_path / f"{name}.xlsx", {"beams": ROWS})
    assert (tmp_path / "a.xlsx").read_bytes() == (tmp_path / "b.xlsx").read_bytes()


def test_unwritable_paths_are_named_and_leave_nothing(tmp_path: Path) -> None:
    for writer in (
        lambda path: write_csv(path, ROWS),
        lambda path: write_xlsx(path, {"beams": ROWS}),
    ):
        with pytest.raises(OutputError, match="nowhere"):
            writer(tmp_path / "nowhere" / "a")
    assert list(tmp_path.iterdir()) == []

"""`ddgfab check`: sound files, and every way in which one can be broken."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import numpy as np
import pytest

from ddgfab.errors import InputError
from fabrication.formats.csv import write_csv
from fabrication.formats.report import inspect_file
from fabrication.formats.stl import write_stl
from fabrication.formats.threemf import threemf_bytes
from fabrication.parts.beam import BEAM
from fabrication.specs import TriangleMesh

CORNERS = np.array([[0.0, 0, 0], [10, 0, 0], [0, 10, 0], [0, 0, 10]])
TRIANGLES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
TETRAHEDRON = TriangleMesh(CORNERS, TRIANGLES)


def threemf(
    path: Path, build: str, *, unit: str = "centimeter", extra: str = "", prolog: str = ""
) -> Path:
    vertices = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in CORNERS)
    triangles = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in TRIANGLES)
    text = (
        f'<?xml version="1.0" encoding="UTF-8"?>{prolog}<model unit="{unit}" xmlns='
        '"http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>'
        f'<object id="1" type="model" name="pin"><mesh><vertices>{vertices}</vertices>'
        f"<triangles>{triangles}</triangles></mesh></object>{extra}</resources>"
        f"<build>{build}</build></model>"
    )
    with zipfile.ZipFile(io.BytesIO(threemf_bytes([]))) as ours:
        package = [(n, ours.read(n)) for n in ours.namelist() if not n.startswith("3D/")]
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in package:
            archive.writestr(name, content)
        archive.writestr("3D/3dmodel.model", text)
    return path


def test_a_sound_stl(tmp_path: Path) -> None:
    path = tmp_path / "a.stl"
    write_stl(path, TETRAHEDRON)
    report = inspect_file(path)
    assert report.passed
    assert report.volume_mm3 == pytest.approx(1000 / 6)
    assert "1 body, 4 triangles, 166.7 mm3, closed and valid" in report.text()
    assert report.to_dict()["bodies"][0]["triangles"] == 4


def test_open_inside_out_and_crossing_stls_are_found(tmp_path: Path) -> None:
    path = tmp_path / "a.stl"
    write_stl(path, TriangleMesh(CORNERS, TRIANGLES[:3]))
    assert "3 edges without exactly one partner" in inspect_file(path).problems[0]
    write_stl(path, TriangleMesh(CORNERS, TRIANGLES[:, ::-1]))
    assert "inside out" in inspect_file(path).problems[0]
    both = TriangleMesh(
        np.vstack([CORNERS, CORNERS + np.array([2, 1, 3])]), np.vstack([TRIANGLES, TRIANGLES + 4])
    )
    write_stl(path, both)
    report = inspect_file(path)
    assert "shells 1 and 2 intersect" in report.problems[0]
    assert not report.passed


def test_3mf_units_names_and_instances(tmp_path: Path) -> None:
    items = [f'<item objectid="1" transform="1 0 0 0 1 0 0 0 1 {x} 0 0"/>' for x in (0, 200)]
    report = inspect_file(threemf(tmp_path / "a.3mf", "".join(items)))
    (body,) = report.bodies
    assert report.passed
    assert (body.name, body.instances, report.unit) == ("pin", 2, "centimeter")
    assert report.volume_mm3 == pytest.approx(2 * 1000**2 / 6)
    pair = '<component objectid="1"/>' * 3
    kit = f'<object id="2"><components>{pair}</components></object>'
    nested = threemf(tmp_path / "b.3mf", '<item objectid="2"/>' * 2, extra=kit)
    assert inspect_file(nested).bodies[0].instances == 6


def test_broken_3mfs_are_refused(tmp_path: Path) -> None:
    ring = '<object id="2"><components><component objectid="2"/></components></object>'
    for path in (
        threemf(tmp_path / "a.3mf", "", extra=ring),
        threemf(tmp_path / "b.3mf", "", unit="cubit"),
        threemf(tmp_path / "c.3mf", "", prolog='<!DOCTYPE model [<!ENTITY x "pin">]>'),
    ):
        with pytest.raises(InputError, match=rf"{path.name}: not a readable 3MF"):
            inspect_file(path)
    (tmp_path / "d.3mf").write_bytes(b"PK no")
    with pytest.raises(InputError, match=r"d\.3mf: not a readable 3MF"):
        inspect_file(tmp_path / "d.3mf")


def test_other_files_and_missing_ones_are_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="not a file that can be checked"):
        inspect_file(tmp_path / "a.dwg")
    for name in ("none.stl", "none.3mf", "none.step"):
        with pytest.raises(InputError, match=name.replace(".", r"\.")):
            inspect_file(tmp_path / name)


@pytest.mark.slow
def test_step_files(tmp_path: Path) -> None:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox

    from fabrication.formats.step import StepProduct, write_assembly, write_part
    from fabrication.specs import Properties

    solid = BRepPrimAPI_MakeBox(10, 20, 30).Solid()
    properties = Properties(6000.0, 2200.0, (5, 10, 15))
    path = tmp_path / "a.step"
    write_part(path, StepProduct("BP-001", BEAM, solid, properties))
    report = inspect_file(path)
    assert report.passed
    assert (report.bodies[0].name, report.bodies[0].solids) == ("BP-001 part", 1)

    shifted = np.eye(4)
    shifted[0, 3] = 100
    write_assembly(
        tmp_path / "b.stp",
        [StepProduct("BP-001", BEAM, solid, properties)],
        [("BP-001", "B-0000", np.eye(4)), ("BP-001", "B-0001", shifted)],
        name="two",
    )
    report = inspect_file(tmp_path / "b.stp")
    assert report.volume_mm3 == pytest.approx(12000)
    assert "1 body, 2 instances" in report.text()

    path.write_bytes(path.read_bytes()[:2000])
    with pytest.raises(InputError, match=r"a\.step"):
        inspect_file(path)
    path.write_bytes(b"solid of another kind")
    with pytest.raises(InputError, match=r"a\.step"):
        inspect_file(path)


def test_a_csv_is_a_table_whose_rows_are_complete(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    write_csv(path, [{"mark": 'B-0000, "x"', "length_mm": 1.0}, {"mark": "a\nb", "length_mm": 2}])
    assert inspect_file(path).text() == f"{path}: CSV, 2 rows, 2 columns, every row complete"
    path.write_text('mark,mark,\n"a\nb",1,2\nc,1\n', "utf-8")
    assert inspect_file(path).problems == (
        "column 3 has no name",
        '2 columns are named "mark"',
        "line 4 has 2 cells, not 3",
    )
    for data in (b"", b"\n", b"\xff\xfe", b'a,b\n"open'):
        path.write_bytes(data)
        with pytest.raises(InputError, match=r"a\.csv: (has no header|not a CSV in UTF-8)"):
            inspect_file(path)

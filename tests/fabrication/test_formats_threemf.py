"""3MF: written from arrays, read back by our reader and by lib3mf, loaded by PrusaSlicer."""

from __future__ import annotations

import shutil
import subprocess
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ddgfab.errors import InputError
from fabrication.checks.mesh import measure_mesh
from fabrication.formats.report import inspect_file
from fabrication.formats.threemf import (
    Body3MF,
    Item3MF,
    check_threemf,
    read_threemf,
    threemf_bytes,
    write_threemf,
)
from fabrication.specs import TriangleMesh

CORNERS = np.array([[0.0, 0, 0], [10, 0, 0], [0, 10, 0], [0, 0, 10]])
TRIANGLES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
TETRAHEDRON = TriangleMesh(CORNERS, TRIANGLES)
SECOND = TriangleMesh(
    np.array([[-1.0, -2, 0], [11, 1e-7, 0], [3, 17.123456789, 0], [0, 0, 9]]), TRIANGLES
)
BODIES = [Body3MF('A & "B"', TETRAHEDRON, (1, 0, 0)), Body3MF("L-001", SECOND, (0, 0.5, 1))]


def placed(x: float) -> np.ndarray:
    motion = np.eye(4)
    motion[:2, :2] = [[0, -1], [1, 0]]
    motion[0, 3] = x
    return motion


ITEMS = [Item3MF(0, "one", placed(50)), Item3MF(1, "two", placed(100)), Item3MF(0, "x", placed(20))]


def test_read_back_by_both_readers(tmp_path: Path) -> None:
    path = tmp_path / "plate.3mf"
    write_threemf(path, BODIES, ITEMS)
    content = read_threemf(path)
    assert content.unit == "millimeter"
    assert content.placed == (2, 1)
    assert [body.name for body in content.bodies] == ['A & "B"', "L-001"]
    for back, body in zip(content.bodies, BODIES, strict=True):
        assert np.abs(back.mesh.vertices - body.mesh.vertices).max() <= 5e-7
        assert np.array_equal(back.mesh.triangles, body.mesh.triangles)
    checks = check_threemf(path, [(BODIES[0].name, TETRAHEDRON, 2), ("L-001", SECOND, 1)])
    assert len(checks) == 6
    assert all(check.passed for check in checks), checks
    report = inspect_file(path)
    assert report.passed
    assert [body.instances for body in report.bodies] == [2, 1]


def test_placements_as_lib3mf_sees_them(tmp_path: Path) -> None:
    import lib3mf

    path = tmp_path / "plate.3mf"
    write_threemf(path, BODIES, ITEMS)
    model = lib3mf.get_wrapper().CreateModel()
    model.QueryReader("3mf").ReadFromFile(str(path))
    items = model.GetBuildItems()
    for item in ITEMS:
        assert items.MoveNext()
        found = items.GetCurrent()
        rows = np.array([list(row) for row in found.GetObjectTransform().Fields])
        assert np.abs(rows.T - item.placement[:3]).max() < 1e-6
        assert found.GetPartNumber() == item.mark


def test_what_the_second_reader_finds_wrong(tmp_path: Path) -> None:
    path = tmp_path / "a.3mf"
    write_threemf(path, BODIES, ITEMS)
    expected = [(BODIES[0].name, TETRAHEDRON, 2), ("L-001", SECOND, 1)]

    def failing(expected: list[tuple[str, TriangleMesh, int]]) -> set[str]:
        return {check.name for check in check_threemf(path, expected) if not check.passed}

    assert failing([("B", TETRAHEDRON, 2), expected[1]]) == {"3mf objects"}
    assert failing([(BODIES[0].name, TETRAHEDRON, 1), expected[1]]) == {"3mf instances"}
    moved = replace(SECOND, vertices=SECOND.vertices + 1e-3)
    assert failing([expected[0], ("L-001", moved, 1)]) == {"3mf corners"}
    turned = replace(SECOND, triangles=np.roll(TRIANGLES, 1, axis=0))
    assert failing([expected[0], ("L-001", turned, 1)]) == {"3mf corners"}
    write_threemf(path, [Body3MF("open", replace(SECOND, triangles=TRIANGLES[:3]))])
    assert "3mf manifold" in failing([("open", replace(SECOND, triangles=TRIANGLES[:3]), 1)])
    path.write_bytes(b"PK")
    assert failing(expected) == {"3mf readable"}


def test_the_same_model_gives_the_same_bytes_and_plain_numbers() -> None:
    data = threemf_bytes(BODIES, ITEMS, "kit")
    assert data == threemf_bytes(BODIES, ITEMS, "kit")
    assert data != threemf_bytes(BODIES, ITEMS[:2], "kit")


def test_no_exponents_and_no_negative_zeros(tmp_path: Path) -> None:
    path = tmp_path / "a.3mf"
    small = replace(SECOND, vertices=SECOND.vertices - [0, 1.1e-7, 0])
    write_threemf(path, [Body3MF("a", small)])
    with zipfile.ZipFile(path) as archive:
        text = archive.read("3D/3dmodel.model").decode()
    assert "-0.000000" not in text
    assert 'x="11.000000" y="0.000000"' in text
    assert 'unit="millimeter"' in text


def test_broken_ones_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.3mf"
    path.write_bytes(threemf_bytes(BODIES)[:300])
    with pytest.raises(InputError, match=r"a\.3mf: not a readable 3MF"):
        read_threemf(path)


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("prusa-slicer") is None, reason="PrusaSlicer is not installed")
def test_prusaslicer_sees_the_objects_manifold(tmp_path: Path) -> None:
    path = tmp_path / "plate.3mf"
    write_threemf(path, BODIES, ITEMS)
    said = subprocess.run(
        ["prusa-slicer", "--info", str(path)], capture_output=True, text=True, timeout=60
    ).stdout
    assert said.count("manifold = yes") == said.count("number_of_parts =  1") == len(ITEMS)
    found = sorted(float(line.split("=")[1]) for line in said.splitlines() if "volume" in line)
    volumes = [measure_mesh(BODIES[item.body].mesh).volume for item in ITEMS]
    assert found == pytest.approx(sorted(volumes), rel=1e-5)

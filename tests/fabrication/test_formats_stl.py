"""Binary STL: read back with struct, admesh and prusa-slicer."""

from __future__ import annotations

import shutil
import struct
import subprocess
from pathlib import Path

import numpy as np
import pytest

from ddgfab.errors import InputError, OutputError
from fabrication.formats.stl import check_stl_part, read_stl, stl_bytes, write_stl
from fabrication.specs import TriangleMesh


def tetrahedron(scale: float = 10.0) -> TriangleMesh:
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]) * scale
    return TriangleMesh(vertices, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]))


def test_struct_reads_normals_and_corners() -> None:
    data = stl_bytes(tetrahedron(), "NP-001")
    assert data[:80].rstrip() == b"ddgfab NP-001"
    assert struct.unpack_from("<I", data, 80) == (4,)
    assert len(data) == 84 + 50 * 4
    slanted = struct.unpack_from("<12fH", data, 84 + 50 * 2)
    np.testing.assert_allclose(slanted[:3], np.full(3, 3**-0.5), atol=1e-7)
    assert slanted[3:12] == (10, 0, 0, 0, 10, 0, 0, 0, 10)
    assert slanted[12] == 0


def test_what_is_written_comes_back_welded(tmp_path: Path) -> None:
    path = tmp_path / "a.stl"
    write_stl(path, tetrahedron(0.1))
    back = read_stl(path)
    assert back.vertices.shape == (4, 3)
    assert all(check.passed for check in check_stl_part(path, tetrahedron(0.1)))
    failed = [c.name for c in check_stl_part(path, tetrahedron(0.1001)) if not c.passed]
    assert failed == ["stl corners"]
    assert stl_bytes(tetrahedron()) == stl_bytes(tetrahedron())


def test_text_stl_is_read_and_broken_ones_are_named(tmp_path: Path) -> None:
    facet = "facet normal 0 0 1\n outer loop\n{}endloop\nendfacet\n"
    corners = "vertex 0 0 0\nvertex 1e0 0 0\nvertex 0 1 0\n"
    path = tmp_path / "a.stl"
    path.write_text("solid a\n" + facet.format(corners) + "endsolid a\n")
    assert len(read_stl(path).triangles) == 1
    path.write_text("solid a\n" + facet.format(corners.replace("1e0", "x")) + "endsolid\n")
    with pytest.raises(InputError, match=r"a\.stl:5: a vertex needs three numbers"):
        read_stl(path)
    path.write_text("solid a\n" + facet.format(corners))
    with pytest.raises(InputError, match="ends early"):
        read_stl(path)
    path.write_bytes(stl_bytes(tetrahedron())[:-7])
    with pytest.raises(InputError, match="277 bytes, where its 4 triangles need 284"):
        read_stl(path)
    nan = tetrahedron(float("nan"))
    path.write_bytes(stl_bytes(nan))
    with pytest.raises(InputError, match="not finite"):
        read_stl(path)
    with pytest.raises(InputError, match="no such file"):
        read_stl(tmp_path / "none.stl")
    with pytest.raises(OutputError, match="nowhere"):
        write_stl(tmp_path / "nowhere" / "a.stl", tetrahedron())


def run(*command: str) -> str:
    if shutil.which(command[0]) is None:
        pytest.skip(f"{command[0]} is not installed")
    done = subprocess.run(
        command, capture_output=True, text=True, errors="replace", timeout=120, check=True
    )
    return done.stdout + done.stderr


def test_prusa_slicer_says_manifold(tmp_path: Path) -> None:
    path = tmp_path / "a.stl"
    write_stl(path, tetrahedron())
    out = run("prusa-slicer", "--info", str(path))
    assert "manifold = yes" in out
    assert "number_of_facets = 4" in out


def test_admesh_finds_nothing_to_mend(tmp_path: Path) -> None:
    path = tmp_path / "a.stl"
    write_stl(path, tetrahedron(10.0))
    out = run("admesh", str(path))
    volume = float(out.split("Volume")[1].split(":")[1].split()[0])
    assert volume == pytest.approx(1000 / 6, rel=1e-5)
    disconnected = next(line for line in out.splitlines() if "Total disconnected" in line)
    assert set(disconnected.split(":")[1].split()) == {"0"}

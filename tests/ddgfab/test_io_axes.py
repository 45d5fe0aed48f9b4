"""Node axes in mesh files: those of just this geometry, carried through every way of reading."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest

from ddgfab.errors import InputError
from ddgfab.forms.registry import generate
from ddgfab.io import read_mesh, write_mesh, write_ply
from ddgfab.mesh import Mesh
from ddgfab.support import SupportStructure, support_structure

SUFFIXES = (".obj", ".off", ".ply")


@pytest.fixture(scope="module")
def roof() -> SupportStructure:
    mesh = generate("conical", {})
    return support_structure(mesh)


def written(path: Path, roof: SupportStructure, shift: float = 0.0) -> Path:
    mesh = roof.mesh.with_vertices(roof.mesh.vertices + shift)
    write_mesh(path, mesh, units="mm", axes=roof.axes)
    return path


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_axes_come_back_exactly_and_have_the_same_lean(
    suffix: str, roof: SupportStructure, tmp_path: Path
) -> None:
    read = read_mesh(written(tmp_path / f"a{suffix}", roof))
    assert read.axes is not None
    assert np.abs(read.axes - roof.axes).max() < 1e-15
    again = support_structure(read.mesh, axes=read.axes)
    assert again.kind == "given"
    assert again.lean_deg_max == pytest.approx(roof.lean_deg_max, abs=1e-9)
    assert again.torsion_deg_max < 1e-9


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize(
    "ways",
    [
        {"scale": 0.001},
        {"units": "mm"},
        {"up": "-y"},
        {"up": "x"},
        {"flip": True},
        {"flip": True, "up": "y"},
        {"merge": 1.0},
    ],
    ids=str,
)
def test_axes_go_with_the_mesh(
    suffix: str, ways: dict[str, object], roof: SupportStructure, tmp_path: Path
) -> None:
    """Torsion and lean are those of the mesh as written, however it is turned or flipped."""
    read = read_mesh(written(tmp_path / f"a{suffix}", roof), **ways)  # type: ignore[arg-type]
    assert read.axes is not None
    found = SupportStructure.of(read.mesh, read.axes, "given")
    assert found.torsion_deg_max < 1e-9
    assert np.abs(found.lean - roof.lean).max() < 1e-6


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_local_origin_and_gzip_keep_them(
    suffix: str, roof: SupportStructure, tmp_path: Path
) -> None:
    path = written(tmp_path / f"a{suffix}", roof, shift=5e8)
    packed = tmp_path / f"b{suffix}.gz"
    packed.write_bytes(gzip.compress(path.read_bytes()))
    for file in (path, packed):
        read = read_mesh(file)
        assert read.origin.any()
        assert read.axes is not None
        assert np.abs(read.axes - roof.axes).max() < 1e-15


def test_vertices_that_go_take_their_axes_along(roof: SupportStructure, tmp_path: Path) -> None:
    mesh = roof.mesh
    rows = np.array([0, *range(mesh.n_vertices)])  # the first is unused: faces name the others
    faces = [(face + 1).tolist() for face in mesh.faces]
    corners = np.concatenate([np.array(face) for face in faces])
    loose = Mesh(mesh.vertices[rows], corners, mesh.face_start)
    write_ply(tmp_path / "a.ply", loose, axes=roof.axes[rows] * [[2.0, 2.0, 2.0]])
    read = read_mesh(tmp_path / "a.ply")
    assert read.mesh.n_vertices == mesh.n_vertices
    assert read.axes is not None
    assert np.abs(read.axes - roof.axes).max() < 1e-14


@pytest.mark.parametrize("change", ["a vertex", "a face", "no digest", "another digest"])
def test_axes_of_another_geometry_are_not_used(
    change: str, roof: SupportStructure, tmp_path: Path
) -> None:
    path = written(tmp_path / "a.obj", roof)
    lines = path.read_text().split("\n")
    at = next(i for i, line in enumerate(lines) if "node axes" in line)
    if change == "a vertex":
        row = next(i for i, line in enumerate(lines) if line.startswith("v "))
        words = lines[row].split()
        lines[row] = f"v {words[1]} {words[2]} {float(words[3]) + 1e-9!r}"
    elif change == "a face":
        lines = [line for line in lines if line]
        del lines[-1]
        lines[0] = "# edited"
    elif change == "no digest":
        lines[at] = "# normals: node axes"
    else:
        lines[at] = lines[at][:-4] + "0000"
    path.write_text("\n".join(lines) + "\n")
    read = read_mesh(path)
    assert read.axes is None
    assert any("has node axes" in note and "not used" in note for note in read.notes)


def test_ordinary_normals_are_never_axes(roof: SupportStructure, tmp_path: Path) -> None:
    for suffix in SUFFIXES:
        path = written(tmp_path / f"a{suffix}", roof)
        data = path.read_bytes()
        begin = data.index(b"normals: node axes")
        end = data.index(b"\n", begin)
        path.write_bytes(data[:begin] + b"by another program" + data[end:])
        read = read_mesh(path)
        assert read.axes is None
        assert not any("axes" in note for note in read.notes)


def test_axes_without_length_are_refused_when_written(
    roof: SupportStructure, tmp_path: Path
) -> None:
    axes = roof.axes.copy()
    axes[3] = 0.0
    with pytest.raises(InputError, match="an axis has length 0"):
        write_mesh(tmp_path / "a.obj", roof.mesh, axes=axes)

"""Rhino files: meshes, units, what is passed over, damage, and the library that may be missing."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ddgfab.errors import MeshError
from ddgfab.grid import grid_mesh
from ddgfab.io import STATED
from ddgfab.mesh import Mesh
from fabrication.meshes_in import read_mesh, rhino

rhino3dm = pytest.importorskip("rhino3dm")


def roof(offset: float = 0.0) -> Mesh:
    x, y = np.meshgrid(np.arange(5.0), np.arange(4.0), indexing="ij")
    return grid_mesh(np.stack([x + offset, y, 0.1 - 0.05 * (x - 2) ** 2 * y], axis=-1) * 1.1)


def rhino_mesh(mesh: Mesh, double: bool = True) -> Any:
    made = rhino3dm.Mesh()
    made.Vertices.UseDoublePrecisionVertices = double
    for point in mesh.vertices.tolist():
        made.Vertices.Add(*point)
    for face in mesh.faces:
        made.Faces.AddFace(*face.tolist())
    return made


def save(path: Path, *meshes: Any, unit: str = "Meters", others: bool = False) -> Path:
    model = rhino3dm.File3dm()
    model.Settings.ModelUnitSystem = getattr(rhino3dm.UnitSystem, unit)
    if others:
        model.Objects.AddSphere(rhino3dm.Sphere(rhino3dm.Point3d(0, 0, 0), 2.0))
        model.Objects.AddLine(rhino3dm.Point3d(0, 0, 0), rhino3dm.Point3d(1, 0, 0))
        model.Objects.AddPoint(rhino3dm.Point3d(0, 0, 0))
    for mesh in meshes:
        model.Objects.AddMesh(mesh)
    model.Write(str(path), 7)
    return path


@pytest.mark.parametrize("double", [True, False])
def test_a_mesh_is_as_it_was(double: bool, tmp_path: Path) -> None:
    mesh = roof()
    read = read_mesh(save(tmp_path / "a.3dm", rhino_mesh(mesh, double)))
    places = mesh.vertices if double else mesh.vertices.astype(np.float32)
    assert np.allclose(read.mesh.vertices, places, atol=1e-15 if double else 1e-7)
    assert [f.tolist() for f in read.mesh.faces] == [f.tolist() for f in mesh.faces]
    assert read.units == "m"
    assert read.notes == ()


def test_triangles_among_quads(tmp_path: Path) -> None:
    mesh = Mesh.build([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0]],
                      [[0, 1, 2, 3], [1, 4, 2]])  # fmt: skip
    read = read_mesh(save(tmp_path / "a.3dm", rhino_mesh(mesh)))
    assert read.mesh.face_sizes.tolist() == [4, 3]


@pytest.mark.parametrize(
    ("unit", "factor"),
    [("Millimeters", 1), ("Centimeters", 10), ("Meters", 1000), ("Inches", 25.4), ("Feet", 304.8)],
)
def test_the_unit_of_the_file(unit: str, factor: float, tmp_path: Path) -> None:
    read = read_mesh(save(tmp_path / "a.3dm", rhino_mesh(roof()), unit=unit), units=STATED)
    assert np.allclose(read.mesh.vertices, roof().vertices * factor)


def test_units_that_are_not_known_are_told(tmp_path: Path) -> None:
    read = read_mesh(save(tmp_path / "a.3dm", rhino_mesh(roof()), unit="Yards"), units=STATED)
    assert read.units is None
    assert any("its unit (Yards) is none of mm, cm, m, in, ft" in note for note in read.notes)


def test_several_meshes_are_joined_and_other_objects_counted(tmp_path: Path) -> None:
    """Two meshes with a common side become one net; a sphere, a line and a point are named."""
    both = rhino_mesh(roof()), rhino_mesh(roof(4.0).with_vertices(
        roof(4.0).vertices * [1, 1, 0] + roof().vertices[::-1] * [0, 0, 1]))  # fmt: skip
    read = read_mesh(save(tmp_path / "a.3dm", *both, others=True))
    assert read.faces == 2 * roof().n_faces
    text = " ".join(read.notes)
    assert "the file holds 2 meshes: they are read as one" in text
    assert "1 NURBS surfaces or polysurfaces" in text
    assert "1 curves" in text
    assert "1 points" in text


def test_a_file_without_meshes_says_what_it_holds(tmp_path: Path) -> None:
    path = save(tmp_path / "a.3dm", others=True)
    with pytest.raises(MeshError, match=r"holds no mesh \(1 NURBS surfaces .*QuadRemesh"):
        read_mesh(path)


def test_damage_is_a_message(tmp_path: Path) -> None:
    path = save(tmp_path / "a.3dm", rhino_mesh(roof()))
    whole = path.read_bytes()
    for data in (b"no Rhino file", whole[: len(whole) // 2]):
        path.write_bytes(data)
        with pytest.raises(
            MeshError, match=r"a\.3dm: (is not a Rhino file|holds no mesh|is damaged)"
        ):
            read_mesh(path)


def test_a_child_that_dies_or_hangs_is_a_message(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = save(tmp_path / "a.3dm", rhino_mesh(roof()))
    crash = tmp_path / "crash.sh"
    crash.write_text("#!/bin/sh\nkill -SEGV $$\n")
    crash.chmod(0o755)
    with monkeypatch.context() as patch:
        patch.setattr(sys, "executable", str(crash))
        with pytest.raises(MeshError, match="the library that reads Rhino files ended"):
            read_mesh(path)
    monkeypatch.setattr(rhino, "SECONDS", 0.001)
    with pytest.raises(MeshError, match=r"takes more than 0\.001 s to read"):
        read_mesh(path)


def test_the_library_may_be_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = save(tmp_path / "a.3dm", rhino_mesh(roof()))
    monkeypatch.setattr(rhino.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(MeshError, match=r"pip install 'ddgfab\[3dm\]'"):
        read_mesh(path)

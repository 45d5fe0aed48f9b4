"""Rhino files: read back by rhino3dm."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from roofs import barrel
from wholes import whole_of

from fabrication.checks.mesh import measure_mesh
from fabrication.formats.base import REJECTED_KIND, Whole
from fabrication.formats.rhino import FORMAT, MODEL, PLACED, read_pieces
from fabrication.gridshell.design import design
from fabrication.specs import TriangleMesh

rhino3dm = pytest.importorskip("rhino3dm")
REJECTED = frozenset({"B-0002", "N-0001"})


@pytest.fixture(scope="module")
def whole() -> Whole:
    return whole_of(design(barrel(1, 3), project={"name": "Dach 東"}), REJECTED)


@pytest.fixture(scope="module")
def folder(whole: Whole, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("rhino")
    assert FORMAT.write_whole(path, whole) == []
    return path


def test_every_piece_is_an_instance_with_user_text(whole: Whole, folder: Path) -> None:
    assert [check for check in FORMAT.check_whole(folder, whole) if not check.passed] == []
    model = rhino3dm.File3dm.Read(str(folder / MODEL))
    assert model.Settings.ModelUnitSystem == rhino3dm.UnitSystem.Millimeters
    texts = {
        item.Attributes.GetUserString("mark"): dict(item.Attributes.GetUserStrings())
        for item in model.Objects
        if isinstance(item.Geometry, rhino3dm.InstanceReference)
    }
    for number, mark, _ in whole.standing():
        part = whole.parts[number]
        assert texts[mark]["number"] == number
        assert texts[mark]["role"] == part.kind.role
        assert float(texts[mark]["mass_kg"]) == pytest.approx(part.mass, rel=1e-5)
        assert texts[mark]["status"] == ("rejected" if mark in REJECTED else "ok")
    layers = {layer.Name for layer in model.Layers}
    assert layers == {"BEAMS", "NODES", "PANELS", REJECTED_KIND.layer}


def test_blocks_are_closed_meshes_of_the_parts(whole: Whole, folder: Path) -> None:
    model = rhino3dm.File3dm.Read(str(folder / MODEL))
    meshes = {
        item.Attributes.Name: item.Geometry
        for item in model.Objects
        if isinstance(item.Geometry, rhino3dm.Mesh)
    }
    assert set(meshes) == set(whole.parts)
    for number, mesh in meshes.items():
        assert mesh.IsClosed
        points = np.array([(p.X, p.Y, p.Z) for p in mesh.Vertices])
        corners = np.array([mesh.Faces[k][:3] for k in range(mesh.Faces.Count)])
        volume = measure_mesh(TriangleMesh(points, corners)).volume
        wanted = measure_mesh(whole.parts[number].mesh).volume
        assert volume == pytest.approx(wanted, rel=1e-5)  # Rhino's meshes have single precision


def test_what_moved_or_is_missing_is_found(whole: Whole, tmp_path: Path) -> None:
    FORMAT.write_whole(tmp_path, whole)
    number, mark, placement = next(whole.standing())
    other = whole_of(design(barrel(1, 2)))
    names = {check.name for check in FORMAT.check_whole(tmp_path, other) if not check.passed}
    assert {"3dm pieces", "3dm positions"} <= names
    np.testing.assert_allclose(read_pieces(tmp_path / MODEL)[mark][2], placement, atol=PLACED)
    (tmp_path / MODEL).write_bytes(b"3D Geometry File Format nonsense")
    assert [check.passed for check in FORMAT.check_whole(tmp_path, whole)] == [False]
    assert number in whole.parts

"""Walls of bores are marked in the print plates, and nothing else is."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path

import numpy as np
import pytest

from fabrication.formats.threemf import Body3MF, read_threemf, write_threemf
from fabrication.formats.threemf.bores import bore_walls
from fabrication.linkage.kit import Kit
from fabrication.parts.link import LinkShape
from fabrication.parts.ring import RingShape
from fabrication.solids import boundary_of, mesh_of
from fabrication.specs import Shape, TriangleMesh

LINK = LinkShape(100.0, 0.9, 3.2, 3.2, 10.0, 6.0, (3.4, 3.4), 5.0, 5.0, 1.0)
CAP = RingShape(6.0, 3.1, 4.2, 1.2)


def area(mesh: TriangleMesh, chosen: np.ndarray) -> float:
    a, b, c = mesh.vertices[mesh.triangles[chosen]].transpose(1, 0, 2)
    return float(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())


@pytest.mark.parametrize(
    ("shape", "walls"),
    [(LINK, 2 * np.pi * 3.4 * 6.0), (CAP, np.pi * 3.1 * 3.0)],  # 2 pi r h of every bore
    ids=["link", "cap"],
)
def test_the_marked_triangles_are_the_walls_of_the_bores(shape: Shape, walls: float) -> None:
    boundary, mesh = boundary_of(shape), mesh_of(shape, 0.01)
    assert boundary is not None
    assert area(mesh, bore_walls(boundary, mesh)) == pytest.approx(walls, rel=0.005)


def test_triangles_off_the_walls_have_no_mark() -> None:
    boundary, mesh = boundary_of(LINK), mesh_of(LINK)
    assert boundary is not None
    away = TriangleMesh(mesh.vertices + np.array([0.0, 0.01, 0.0]), mesh.triangles)
    assert not bore_walls(boundary, away).any()  # off the walls


def test_marks_are_in_the_plate_and_readers_skip_them(bennett: Kit, tmp_path: Path) -> None:
    printed = bennett.printed[0]
    shape = next(f.shape for f in bennett.families if f.number == printed.number)
    boundary = boundary_of(shape)
    assert boundary is not None
    walls = bore_walls(boundary, printed.mesh)
    path = tmp_path / "plate.3mf"
    write_threemf(path, [Body3MF("one", printed.mesh, unsupported=walls)])
    with zipfile.ZipFile(path) as archive:
        model = archive.read("3D/3dmodel.model").decode()
    rows = re.findall(r"<triangle .*/>", model)
    marked = ['slic3rpe:custom_supports="8"' in row for row in rows]
    assert marked == walls.tolist()
    content = read_threemf(path)
    assert not content.warnings
    assert np.array_equal(content.bodies[0].mesh.triangles, printed.mesh.triangles)

"""A roof at coordinates of a survey (UTM): valid and in place in every format."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from roofs import barrel
from wholes import whole_of

from ddgfab.io import write_mesh
from fabrication.formats.base import Whole
from fabrication.formats.glb.read import read_glb
from fabrication.formats.registry import find
from fabrication.gridshell.design import Design, design

FAR = np.array([691_000.25, 5_334_000.75, 520.5])
"""Meters east, north and up."""

LIMIT = 1e-3
"""How far [mm] the far roof may differ from the near one: the mesh file has its own rounding."""

WHOLES = ("step", "ifc", "glb", "3dm", "compas")


@pytest.fixture(scope="module")
def near() -> Whole:
    return whole_of(design(barrel(1, 2)))


@pytest.fixture(scope="module")
def roof(tmp_path_factory: pytest.TempPathFactory) -> Design:
    """The same, far away, in meters."""
    mesh = barrel(1, 2)
    path = tmp_path_factory.mktemp("far") / "far.obj"
    write_mesh(path, mesh.with_vertices(mesh.vertices / 1000.0 + FAR))
    return design(path, project={"units": "m"})


@pytest.fixture(scope="module")
def far(roof: Design) -> Whole:
    return whole_of(roof)


def test_pieces_stand_where_those_of_the_near_roof_do(near: Whole, far: Whole) -> None:
    shift = np.array(far.about.origin) - FAR * 1000.0
    assert np.abs(far.about.origin).max() > 1e9
    pairs = zip(near.standing(), far.standing(), strict=True)
    for (number, mark, one), (same, alike, two) in pairs:
        assert (number, mark) == (same, alike)
        assert np.abs(two[:3, :3] - one[:3, :3]).max() < 1e-6
        assert np.abs(two[:3, 3] + shift - one[:3, 3]).max() < LIMIT
        assert np.abs(two[:3, 3]).max() < 1e5  # about an origin of its own
    for number, part in near.parts.items():
        volume = far.parts[number].properties.volume
        assert volume == pytest.approx(part.properties.volume, rel=1e-6)


@pytest.mark.slow
def test_every_whole_is_valid_and_in_place(roof: Design, far: Whole, tmp_path: Path) -> None:
    for name in WHOLES:
        if name == "3dm":
            pytest.importorskip("rhino3dm")
        made = roof.product().format(name)
        assert made.write_whole(tmp_path, far) == []
        checks = made.check_whole(tmp_path, far)
        assert checks
        assert [(name, c) for c in checks if not c.passed] == []
    # GLB has single precision, which is why its origin must be near.
    placed = {piece.name: piece for piece in read_glb(tmp_path / "model.glb").pieces}
    for number, mark, at in far.standing():
        exact = far.parts[number].mesh.vertices @ at[:3, :3].T + at[:3, 3]
        found = placed[mark].vertices()
        assert np.abs(found.min(axis=0) - exact.min(axis=0)).max() < 0.01
    for file in ("assembly.step", "model.ifc", "net.json"):
        text = (tmp_path / file).read_text("utf-8")
        assert f"{far.about.origin[1] * (1e-3 if file == 'model.ifc' else 1.0):.0f}"[:6] in text


@pytest.mark.slow
def test_every_part_file_is_valid(far: Whole, tmp_path: Path) -> None:
    for name in ("step", "stl", "3mf", "dxf", "nc1"):
        made = find(name)
        taken = [part for part in far.parts.values() if made.takes(part.family)]
        assert taken, name
        for part in taken:
            path = tmp_path / f"{part.number}{made.suffixes[0]}"
            made.write_part(path, part, far.about)
            checks = made.check_part(path, part)
            assert [(part.number, name, c) for c in checks if not c.passed] == []

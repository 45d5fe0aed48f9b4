"""Meshes on their side, far from the origin, of unlikely size, with a unit of their own."""

from __future__ import annotations

import gzip
import json
from pathlib import Path

import numpy as np
import pytest
from variant_cases import compas, is_roof, lists, obj, read, roof

from ddgfab.errors import MeshError
from ddgfab.io import (
    STATED,
    likely_setting,
    read_mesh,
    to_millimetres,
    unlikely_size,
    write_mesh,
)


@pytest.mark.parametrize("up", ["x", "y", "-z", "-y", "-x"])
@pytest.mark.parametrize("far", [False, True])
def test_on_its_side(up: str, far: bool, tmp_path: Path) -> None:
    """Turned files are told with the key that turns them, near and far from the origin."""
    mesh = roof()
    axis = np.zeros(3)
    axis["xyz".index(up[-1])] = -1.0 if up[0] == "-" else 1.0
    other = np.roll(axis, 1)
    points = mesh.vertices @ np.stack([other, np.cross(axis, other), axis])
    points += np.array([3e5, -2e5, 4e5]) * far
    path = tmp_path / "a.obj"
    notes = read(path, obj(points, lists(mesh))).notes
    assert any("look down" in note if up == "-z" else f"--up {up}" in note for note in notes)
    turned = read_mesh(path, up=up)
    assert not any("look down" in note or "upright" in note for note in turned.notes)
    assert np.allclose(np.ptp(turned.mesh.vertices[:, 2]), np.ptp(mesh.vertices[:, 2]), atol=1e-9)


PLACES = [
    (5e5, 0.0, 0.0),
    (0.0, 5.4e6, 0.0),
    (456_789.25, 5_412_345.75, 430.0),
    (-5e5, -2e6, 10.0),
    (691_234.567, 1_234_567.891, -12.3),
    (5e6, 5e6, 5e6),
]


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("kind", ["obj", "off", "ply", "json"])
def test_far_from_the_origin_with_enough_digits(
    place: tuple[float, float, float], kind: str, tmp_path: Path
) -> None:
    """All that is measured is as at the origin, to what four decimals leave."""
    mesh = roof()
    points = np.round(mesh.vertices + place, 4)
    path = tmp_path / f"a.{kind}"
    moved = mesh.with_vertices(points)
    if kind == "json":
        path.write_text(json.dumps(compas(2, moved, 0)))
    else:
        write_mesh(path, moved)
    found = read_mesh(path)
    assert np.abs(found.mesh.vertices).max() < 20
    assert np.allclose(found.in_place.vertices, points, atol=2e-9)
    assert np.allclose(found.mesh.vertices - found.mesh.vertices[0],
                       mesh.vertices - mesh.vertices[0], atol=2e-4)  # fmt: skip
    assert np.allclose(found.mesh.face_normals, mesh.face_normals, atol=2e-4)
    assert not any("rounded" in note for note in found.notes)


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("form", ["{:.6g}", "{:.7g}", "{:.8g}", "float"])
def test_far_from_the_origin_with_too_few_digits(
    place: tuple[float, float, float], form: str, tmp_path: Path
) -> None:
    """The loss is named, with its size, or the mesh is refused: it fell to pieces."""
    mesh = roof()
    points = mesh.vertices + place
    if form == "float":
        head = f"ply\nformat binary_little_endian 1.0\nelement vertex {mesh.n_vertices}\n"
        head += "".join(f"property float {axis}\n" for axis in "xyz")
        head += f"element face {mesh.n_faces}\nproperty list int int vertex_indices\nend_header\n"
        body = points.astype("<f4").tobytes()
        body += np.insert(mesh.corners, mesh.face_start[:-1], 4).astype("<i4").tobytes()
        path, content = tmp_path / "a.ply", head.encode() + body
    else:
        path, content = tmp_path / "a.obj", obj(points, lists(mesh), form).encode()
    try:
        notes = read(path, content).notes
    except MeshError:
        return
    assert any("so far from the origin its numbers are rounded to" in note for note in notes)


@pytest.mark.parametrize(
    ("median", "unlikely"),
    [
        *((m, True) for m in (1e-3, 1.5, 19.9, 20_100, 1.5e6)),
        *((m, False) for m in (20.1, 150, 1500, 6000, 19_900)),
    ],
)
def test_sizes_that_no_gridshell_has(median: float, unlikely: bool) -> None:
    assert bool(unlikely_size(median)) == unlikely


@pytest.mark.parametrize("edge", [1e-6, 1.5, 15.0, 900.0, 3e5, 1.5e9])
@pytest.mark.parametrize("unit", ["mm", "m", "ft"])
@pytest.mark.parametrize("scale", [1.0, 0.01])
@pytest.mark.parametrize("stated", [False, True])
def test_the_setting_that_is_advised_gives_a_likely_size(
    edge: float, unit: str, scale: float, stated: bool
) -> None:
    said = unit if stated else None
    factor = to_millimetres(unit, scale, said, None)
    if not unlikely_size(edge * factor):
        return
    key, value = likely_setting(edge * factor, factor, scale, said)
    changed = {"units": unit, "scale": scale, key: value}
    again = to_millimetres(str(changed["units"]), float(changed["scale"]), said, None)
    assert not unlikely_size(edge * again)
    assert key == "scale" or not stated


@pytest.mark.parametrize("unit", ["mm", "cm", "m", "in", "ft"])
@pytest.mark.parametrize("kind", ["obj", "off", "ply"])
def test_files_that_state_their_unit(unit: str, kind: str, tmp_path: Path) -> None:
    factor = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "ft": 304.8}[unit]
    path = tmp_path / f"a.{kind}"
    write_mesh(path, roof().scaled(1000 / factor), units=unit)
    assert is_roof(read_mesh(path, units=STATED).mesh, 1000.0)
    packed = tmp_path / f"a.{kind}.gz"
    packed.write_bytes(gzip.compress(path.read_bytes()))
    assert is_roof(read_mesh(packed, units=STATED).mesh, 1000.0)

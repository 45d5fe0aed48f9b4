"""Mesh checks: what manifold3d's status alone lets through must fail here."""

from __future__ import annotations

import time

import manifold3d
import numpy as np
import pytest

from fabrication.checks.mesh import check_mesh, measure_mesh, to_manifold
from fabrication.specs import TriangleMesh


def from_manifold(body: manifold3d.Manifold) -> TriangleMesh:
    mesh = body.to_mesh64()
    return TriangleMesh(
        np.array(mesh.vert_properties)[:, :3].copy(), np.array(mesh.tri_verts).astype(np.int64)
    )


def box(x: float = 10, y: float = 20, z: float = 30) -> TriangleMesh:
    return from_manifold(manifold3d.Manifold.cube((x, y, z)))


def failed(mesh: TriangleMesh, **changes: float) -> set[str]:
    expected = {"volume": 6000.0, "area": 2200.0, "chord": 0.0, "genus": 0} | changes
    return {check.name for check in check_mesh(mesh, **expected) if not check.passed}  # type: ignore[arg-type]


def test_a_box_passes_and_its_numbers_are_exact() -> None:
    report = measure_mesh(box())
    assert (report.watertight, report.components, report.genus) == (True, 1, 0)
    assert report.volume == pytest.approx(6000, rel=1e-14)
    assert report.area == pytest.approx(2200, rel=1e-14)
    assert failed(box()) == set()


def test_inside_out_is_accepted_by_the_status_and_refused_here() -> None:
    mesh = TriangleMesh(box().vertices, box().triangles[:, ::-1].copy())
    assert to_manifold(mesh).status().name == "NoError"
    assert {"mesh outward", "mesh volume"} <= failed(mesh)


def test_overlapping_shells_are_accepted_by_the_status_and_refused_here() -> None:
    one = box()
    mesh = TriangleMesh(
        np.vstack([one.vertices, one.vertices + 5]), np.vstack([one.triangles, one.triangles + 8])
    )
    assert to_manifold(mesh).status().name == "NoError"
    assert failed(mesh, volume=12000.0) == {"mesh components", "mesh crossings"}


def test_a_body_that_crosses_itself_is_accepted_by_the_status_and_refused_here() -> None:
    vertices = box().vertices.copy()
    vertices[(vertices == [10, 20, 30]).all(axis=1)] = [-5, 5, 5]  # through the opposite face
    mesh = TriangleMesh(vertices, box().triangles)
    assert to_manifold(mesh).status().name == "NoError"
    report = measure_mesh(mesh)
    assert failed(mesh, volume=report.volume, area=report.area) == {"mesh crossings"}


def test_a_hole_in_the_skin_is_no_manifold() -> None:
    mesh = TriangleMesh(box().vertices, box().triangles[1:])
    assert {"mesh manifold", "mesh watertight"} <= failed(mesh)
    assert measure_mesh(mesh).open_edges == 3


def test_three_sheets_at_an_edge_are_no_manifold() -> None:
    one = box()
    mesh = TriangleMesh(one.vertices, np.vstack([one.triangles, one.triangles[:1]]))
    assert {"mesh manifold", "mesh watertight"} <= failed(mesh)


def test_an_empty_mesh_fails() -> None:
    empty = TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64))
    assert {"mesh watertight", "mesh components", "mesh outward"} <= failed(empty)


def test_genus_counts_through_holes() -> None:
    body = manifold3d.Manifold.cube((100, 40, 10), True)
    for x in (-30, 30):
        body = body - manifold3d.Manifold.cylinder(20, 5, 5, 24, True).translate((x, 0, 0))
    mesh = from_manifold(body)
    assert measure_mesh(mesh).genus == body.genus() == 2
    known = {"volume": body.volume(), "area": body.surface_area()}
    assert failed(mesh, **known) == {"mesh genus"}
    assert failed(mesh, genus=2, **known) == set()


def test_the_volume_bound_is_that_of_the_chord() -> None:
    radius, height, sides = 40.0, 100.0, 64
    mesh = from_manifold(manifold3d.Manifold.cylinder(height, radius, radius, sides))
    exact = {
        "volume": np.pi * radius**2 * height,
        "area": 2 * np.pi * radius * (height + radius),
    }
    chord = radius * (1 - np.cos(np.pi / sides))
    assert failed(mesh, chord=chord, **exact) == set()
    # The polygon's deficit is about 2/3 of chord times mantle: a fifth of the chord cannot hold it.
    assert failed(mesh, chord=chord / 5, **exact) == {"mesh volume"}


def test_a_small_mesh_costs_less_than_a_few_milliseconds() -> None:
    mesh = box()
    failed(mesh)
    begin = time.process_time()
    for _ in range(20):
        failed(mesh)
    assert (time.process_time() - begin) / 20 < 5e-3  # 0.4 ms on the machine it was written on

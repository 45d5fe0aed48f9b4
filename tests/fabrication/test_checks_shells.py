"""Shells of meshes: outsides, cavities, overlaps; counted and measured on a second route."""

from __future__ import annotations

import itertools
from pathlib import Path

import manifold3d
import numpy as np
import pytest

from fabrication.checks.boxes import _spread, box_pairs, box_pairs_between
from fabrication.checks.shells import Shells, examine_shells
from fabrication.formats.report import inspect_file
from fabrication.formats.stl import weld, write_stl
from fabrication.specs import TriangleMesh

CASE = Path(__file__).parents[2] / "../shared/data/cases/stl_two_shells_overlap.stl"


def mesh_of(body: manifold3d.Manifold) -> TriangleMesh:
    mesh = body.to_mesh64()
    return TriangleMesh(
        np.array(mesh.vert_properties)[:, :3].copy(), np.array(mesh.tri_verts).astype(np.int64)
    )


def cube(side: float, *at: float) -> TriangleMesh:
    return mesh_of(manifold3d.Manifold.cube((side,) * 3).translate(at or (0, 0, 0)))


def inward(mesh: TriangleMesh) -> TriangleMesh:
    return TriangleMesh(mesh.vertices, mesh.triangles[:, ::-1].copy())


def soup(*meshes: TriangleMesh) -> TriangleMesh:
    """What a file of triangles without vertices holds: equal corners are one."""
    return weld(np.concatenate([mesh.vertices[mesh.triangles] for mesh in meshes]))


def examined(*meshes: TriangleMesh) -> Shells:
    found = examine_shells(soup(*meshes), 1e-6)
    assert isinstance(found, Shells)
    return found


SOUND = {
    "a cube": ([cube(10)], 1, 0, 0, 1000),
    "apart": ([cube(10), cube(10, 30, 0, 0)], 2, 0, 0, 2000),
    "a cavity": ([cube(10), inward(cube(5, 2, 2, 2))], 2, 1, 0, 875),
    "an island in a cavity": ([cube(10), inward(cube(6, 2, 2, 2)), cube(2, 3, 3, 3)], 3, 1, 0, 792),
    "a cavity that touches the wall": ([cube(10), inward(cube(6, 2, 2, 4))], 2, 1, 0, 784),
    "faces touch": ([cube(10), cube(10, 10, 0, 0)], 2, 0, 1, 2000),
    "a face touches a part of another": ([cube(10), cube(5, 10, 1, 1)], 2, 0, 1, 1125),
    "edges touch": ([cube(10), cube(10, 10, 10, 0)], 2, 0, 1, 2000),
    "corners touch": ([cube(10), cube(10, 10, 10, 10)], 2, 0, 1, 2000),
}

WRONG = {
    "inside out": ([inward(cube(10))], "inside out", -1000),
    "corners overlap": ([cube(10), cube(10, 5, 5, 5)], "they share 125 mm3", 1875),
    "in one plane": ([cube(10), cube(10, 5, 0, 0)], "they share 500 mm3", 1500),
    "a box in a box": ([cube(10), cube(5, 2, 2, 2)], "would count twice", 1000),
    "the same twice": ([cube(10), cube(10)], "12 triangles are there twice", 1000),
    "two in one": (
        [cube(10), cube(3, 1, 1, 1), cube(3, 5, 5, 5)],
        "shell 2 lies inside shell 1",
        1000,
    ),
    "a cavity in a cavity": (
        [cube(10), inward(cube(6, 2, 2, 2)), inward(cube(2, 3, 3, 3))],
        "shell 3 looks inwards and is not a cavity",
        784,
    ),
    "a cavity that comes out": (
        [cube(10), inward(cube(6, 2, 2, 5))],
        "shells 1 and 2 intersect",
        820,
    ),
    "a cavity outside": ([cube(10), inward(cube(5, 20, 0, 0))], "is not a cavity", 1000),
}


@pytest.mark.parametrize("name", SOUND)
def test_sound_meshes_are_counted(name: str) -> None:
    meshes, shells, cavities, touching, volume = SOUND[name]
    found = examined(*meshes)
    assert found.problems == ()
    assert len(found.volumes) == shells
    assert (found.cavities, len(found.touching)) == (cavities, touching)
    assert found.union == pytest.approx(volume)


@pytest.mark.parametrize("name", WRONG)
def test_what_bounds_no_body_is_told_and_its_volume_counted_once(name: str) -> None:
    meshes, text, volume = WRONG[name]
    found = examined(*meshes)
    assert text in found.problems[0]
    assert found.union == pytest.approx(volume)


def test_motion_and_order_change_nothing() -> None:
    rng = np.random.default_rng(3)
    for meshes, _, volume in WRONG.values():
        q = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        q[:, 0] *= np.sign(np.linalg.det(q))
        shift = rng.uniform(-2000, 2000, 3)
        moved = [TriangleMesh(m.vertices @ q.T + shift, m.triangles) for m in reversed(meshes)]
        found = examined(*moved)
        assert len(found.problems) == len(examined(*meshes).problems)
        assert found.union == pytest.approx(volume, rel=1e-9)


@pytest.mark.parametrize("seed", range(8))
def test_random_boxes_agree_with_manifold3d(seed: int) -> None:
    rng = np.random.default_rng(seed)
    bodies = []
    for _ in range(12):
        turn = [float(angle) for angle in rng.uniform(0, 360, 3)]
        body = manifold3d.Manifold.cube(tuple(rng.uniform(1, 4, 3)), True)
        bodies.append(body.rotate(turn).translate([float(x) for x in rng.uniform(0, 10, 3)]))
    found = examined(*[mesh_of(body) for body in bodies])
    sharing = [(a ^ b).volume() > 1e-9 for a, b in itertools.combinations(bodies, 2)]
    union = manifold3d.Manifold.batch_boolean(bodies, manifold3d.OpType.Add).volume()
    assert len(found.problems) == sum(sharing) > 0
    assert found.union == pytest.approx(union, rel=1e-9)


def test_many_shells_take_little_time_and_are_all_found() -> None:
    grid = list(itertools.product(range(10), repeat=3))
    holes = [inward(cube(1, 2 * x, 2 * y, 2 * z)) for x, y, z in grid]
    found = examined(cube(30, -1, -1, -1), *holes)
    assert (found.cavities, found.problems) == (1000, ())
    assert found.union == pytest.approx(27000 - 1000)
    holes[17] = inward(holes[17])
    assert len(examined(cube(30, -1, -1, -1), *holes).problems) == 1


def test_a_sheet_that_goes_through_itself_is_found() -> None:
    tube = manifold3d.Manifold.revolve(manifold3d.CrossSection.circle(2, 16).translate((10, 0)), 32)
    bent = mesh_of(tube.warp(lambda p: [p[0] * p[0] / 20, p[1] + p[0] / 9, p[2] + p[0] / 17]))
    found = examine_shells(bent, 1e-6)
    assert isinstance(found, Shells)
    assert any("go through each other" in text for text in found.problems)


def test_sheets_that_bound_nothing_are_a_problem_and_no_error() -> None:
    triangle = np.array([[[0.0, 0, 0], [9, 0, 0], [0, 9, 0]]])
    both = np.concatenate([triangle, triangle[:, ::-1]])
    found = examine_shells(weld(both), 1e-6)
    assert isinstance(found, Shells)
    assert found.problems
    rng = np.random.default_rng(4)
    for _ in range(300):
        corners = rng.integers(0, 3, (int(rng.integers(3, 8)), 3)).astype(float)
        soup_ = corners[rng.integers(0, len(corners), (int(rng.integers(1, 40)), 3))]
        found = examine_shells(weld(np.concatenate([soup_, soup_[:, ::-1]])), 1e-6)
        assert isinstance(found, int) or found.problems  # every sheet has two sides: no volume


def test_box_pairs_are_those_that_meet() -> None:
    rng = np.random.default_rng(0)
    for count in (0, 1, 5, 300, 700):
        low = rng.uniform(0, 10, (count, 3))
        high = low + rng.exponential(0.7, (count, 3)) ** 2
        meet = (low[:, None] <= high).all(axis=2) & (low <= high[:, None]).all(axis=2)
        assert np.array_equal(box_pairs(low, high), np.argwhere(np.triu(meet, 1)))
        other = box_pairs_between(low, high, low[:7], high[:7])
        assert {tuple(p) for p in other.tolist()} == {tuple(p) for p in np.argwhere(meet[:, :7])}


def test_bits_are_moved_apart_one_by_one() -> None:
    values = np.random.default_rng(0).integers(0, 2**20, 50)
    expected = [sum((v >> k & 1) << 3 * k for k in range(20)) for v in values.tolist()]
    assert _spread(values).tolist() == expected


def test_files_say_so(tmp_path: Path) -> None:
    path = tmp_path / "a.stl"
    write_stl(path, soup(cube(10), inward(cube(5, 2, 2, 2))))
    report = inspect_file(path)
    assert report.passed
    assert "1 body, 24 triangles, 2 shells, 1 cavity, " in report.text()
    write_stl(path, soup(cube(10), cube(10, 10, 0, 0)))
    assert "2 shells, 1 pair touches, " in inspect_file(path).text()
    write_stl(path, soup(cube(1), *[cube(1, 100000.3 + k, 0, 0) for k in range(3)]))
    assert inspect_file(path).passed  # single precision lets them overlap by its rounding
    write_stl(path, soup(cube(10), cube(5, 2, 2, 2)))
    assert not inspect_file(path).passed


@pytest.mark.skipif(not CASE.exists(), reason="the shared cases are not here")
def test_the_case_of_the_issue() -> None:
    report = inspect_file(CASE)
    assert "they share 125 mm3" in report.problems[0]
    assert report.volume_mm3 == pytest.approx(1875)

"""What a mesh must not lose: folded faces and reflex corners are found."""

from __future__ import annotations

import numpy as np
import pytest
from optimize_meshes import wavy

from ddgfab.errors import InputError
from ddgfab.grid import grid_mesh
from ddgfab.measures import inspect
from ddgfab.mesh import Mesh
from ddgfab.optimize import Change, Limits, folded_faces, interior_angles
from ddgfab.optimize.quality import zigzag


def test_folded_faces_are_found() -> None:
    mesh = wavy(6)
    assert not len(folded_faces(mesh))
    points = mesh.vertices.copy()
    a, b = mesh.face(7)[0], mesh.face(7)[2]
    points[[a, b]] = points[[b, a]]  # turns face 7 over and folds its neighbours
    bad = folded_faces(mesh.with_vertices(points), mesh)
    assert 7 in bad
    assert len(bad) < 20
    assert not len(folded_faces(mesh.with_vertices(points), mesh.with_vertices(points)))


def test_faces_with_a_collapsed_side_count_as_folded() -> None:
    mesh = wavy(6)
    points = mesh.vertices.copy()
    a, b = mesh.face(7)[:2]
    points[a] = points[b] + 1e-6 * (points[a] - points[b])
    at_edge = [f for f in range(mesh.n_faces) if {a, b} <= set(mesh.face(f))]
    assert folded_faces(mesh.with_vertices(points), mesh).tolist() == at_edge


def test_a_bow_tie_is_folded_and_has_reflex_corners_elsewhere() -> None:
    tie = Mesh.build([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1.2, 1.1, 0]], [[0, 1, 2, 3]])
    assert folded_faces(tie).tolist() == [0]
    dart = Mesh.build([[0, 0, 0], [2, 0, 0], [0.5, 0.5, 0], [0, 2, 0]], [[0, 1, 2, 3]])
    assert not len(folded_faces(dart))
    assert interior_angles(dart).max() > np.pi
    assert inspect(dart).corner_angle_deg[1] == pytest.approx(
        np.degrees(interior_angles(dart).max())
    )
    np.testing.assert_allclose(interior_angles(dart).sum(), 2 * np.pi)


def test_zigzag_is_zero_on_round_strips_and_sees_creases_and_alternation() -> None:
    """Ten faces along a strip: bends all 12 deg; one crease of 40 deg; bends of +20 and -20 deg."""

    def strip(bends: list[float]) -> Mesh:
        way = np.cumsum(np.radians([0.0, *bends]))
        line = np.cumsum(np.c_[np.cos(way), 0 * way, np.sin(way)], axis=0)
        line = np.vstack([np.zeros(3), line])
        return grid_mesh(np.stack([line, line + np.array([0, 1, 0])], axis=1))

    def found(bends: list[float]) -> list[float]:
        mesh = strip(bends)
        return sorted(np.degrees(zigzag(mesh)[~mesh.boundary_edge]).tolist(), reverse=True)

    np.testing.assert_allclose(found([12.0] * 9), 0.0, atol=1e-9)
    np.testing.assert_allclose(
        found([0.0] * 4 + [40.0] + [0.0] * 4)[:4], [40, 20, 20, 0], atol=1e-9
    )
    np.testing.assert_allclose(found([20.0, -20.0] * 4), 40.0, atol=1e-9)
    assert not zigzag(Mesh.build(np.eye(3), [[0, 1, 2]])).any()


def test_crumpled_meshes_and_lost_rise_exceed_the_limits() -> None:
    mesh = wavy(10)
    up = mesh.vertices + np.outer((-1.0) ** (np.arange(mesh.n_vertices) // 11), [0, 0, 0.15])
    crumpled = Change(mesh, mesh.with_vertices(up), mesh)
    assert Limits().kinds(crumpled) == {"zigzag"}
    (said,) = Limits().exceeded(crumpled)
    assert "crumpled" in said
    assert not Limits(zigzag=np.pi).exceeded(crumpled)
    center = mesh.vertices.mean(axis=0)
    axis = np.linalg.svd(mesh.vertices - center)[2][2]
    low = mesh.vertices - 0.3 * np.outer((mesh.vertices - center) @ axis, axis)
    flatter = Change(mesh, mesh.with_vertices(low), mesh)
    assert "rise" in Limits().kinds(flatter)
    assert "only 7" in next(t for t in Limits().exceeded(flatter) if "rise" in t)
    assert not Limits(rise=0.5).exceeded(flatter)
    for bad in ({"rise": 1.0}, {"rise": -0.1}, {"zigzag": 0.0}):
        with pytest.raises(InputError, match=next(iter(bad))):
            Limits(**bad)

"""What a mesh must not lose: folded faces and reflex corners are found."""

from __future__ import annotations

import numpy as np
import pytest
from optimize_meshes import wavy

from ddgfab.measures import inspect
from ddgfab.mesh import Mesh
from ddgfab.optimize import folded_faces, interior_angles


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

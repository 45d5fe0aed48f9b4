"""Torsion and lean of node axes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from measure_meshes import mixed, random_grid

from ddgfab.errors import MeshError
from ddgfab.measures import (
    lean,
    torsion,
)
from ddgfab.mesh import Floats, Mesh, unit


# --- torsion and lean ---------------------------------------------------------------------------
def one_edge() -> Mesh:
    """A triangle whose edge 0 runs along x."""
    return Mesh.build([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])


@pytest.mark.parametrize("degrees", [0, 1e-7, 10, 45, 89])
def test_torsion_of_the_published_example(degrees: float) -> None:
    # mathematics.md 10.2: e = (1, 0, 0), a = (0, 0, 1) and (0, sin 10, cos 10): 10 deg.
    angle = np.radians(degrees)
    axes = np.array([[0, 0, 1], [0, np.sin(angle), np.cos(angle)], [0, 0, 1]])
    mesh = one_edge()
    assert torsion(mesh, axes)[0] == pytest.approx(angle, rel=1e-8, abs=1e-16)
    # Lines have neither direction nor length, and a part along the edge does not matter.
    other = axes * [[-3.0], [0.2], [1.0]] + [[5.0, 0, 0], [0, 0, 0], [0, 0, 0]]
    assert torsion(mesh, other)[0] == pytest.approx(angle, rel=1e-8, abs=1e-15)


def test_torsion_is_folded_at_a_right_angle() -> None:
    angle = np.radians(170)
    axes = np.array([[0, 0, 1], [0, np.sin(angle), np.cos(angle)], [0, 0, 1]])
    assert torsion(one_edge(), axes)[0] == pytest.approx(np.radians(10))


def test_axes_along_an_edge_never_pass_for_torsion_free() -> None:
    mesh = one_edge()
    for axis in ([1, 0, 0], [0, 0, 0]):
        assert torsion(mesh, [axis, [0, 0, 1], [0, 0, 1]])[0] == np.pi / 2


def test_axes_through_one_center_are_torsion_free_on_any_mesh() -> None:
    for mesh in (random_grid(11), mixed()):
        assert torsion(mesh, mesh.vertices - [0.3, 0.4, -5]).max() < 1e-14
        assert torsion(mesh, mesh.vertex_normals).max() > 0.01


def test_torsion_is_zero_just_where_the_determinant_is() -> None:
    rng = np.random.default_rng(6)
    mesh = random_grid(6)
    axes = unit(rng.normal(size=mesh.vertices.shape))
    i, j = mesh.edges.T
    along = unit(mesh.edge_vectors)
    det = np.linalg.det(np.stack([along, axes[i], axes[j]], axis=1))
    first, second = np.cross(along, axes[i]), np.cross(along, axes[j])
    sine = np.abs(det) / np.linalg.norm(first, axis=1) / np.linalg.norm(second, axis=1)
    assert np.sin(torsion(mesh, axes)) == pytest.approx(sine, abs=1e-12)


def test_lean_keeps_the_side() -> None:
    mesh = one_edge()
    axes = [[0, 0, 2], [1, 0, 1], [0, 0, -1]]
    assert np.degrees(lean(mesh, axes)) == pytest.approx([0, 45, 180])


@pytest.mark.parametrize("function", [torsion, lean])
def test_wrong_axes_are_refused(function: Callable[[Mesh, object], Floats]) -> None:
    mesh = one_edge()
    with pytest.raises(MeshError, match=r"shape \(2, 3\); expected \(3, 3\)"):
        function(mesh, np.zeros((2, 3)))
    with pytest.raises(MeshError, match="axis of vertex 1 is not finite"):
        function(mesh, [[0, 0, 1], [0, np.nan, 1], [0, 0, 1]])

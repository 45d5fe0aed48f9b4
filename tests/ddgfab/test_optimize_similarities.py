"""optimize: unit, place, orientation and the order of a mesh do not matter."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from optimize_meshes import ANY_ZIGZAG, dome, rotation, wavy

from ddgfab.mesh import Mesh
from ddgfab.optimize import (
    mean_edge,
    optimize,
)


def assert_same(one: Mesh, two: Mesh, tolerance: float) -> None:
    apart = np.linalg.norm(one.vertices - two.vertices, axis=1).max()
    assert apart < tolerance * mean_edge(one)


MESH = dome(10)


@pytest.fixture(scope="module")
def best() -> Mesh:
    """What is found where nothing is changed."""
    return optimize(MESH).mesh


@pytest.mark.parametrize("scale", [1e-3, 1e3, 1e6])
def test_unit_does_not_matter(best: Mesh, scale: float) -> None:
    found = optimize(MESH.with_vertices(scale * MESH.vertices)).mesh
    assert_same(best, found.with_vertices(found.vertices / scale), 1e-9)


def test_place_does_not_matter(best: Mesh) -> None:
    shift = np.array([1e5, -2e5, 3e4])
    found = optimize(MESH.with_vertices(MESH.vertices + shift)).mesh
    assert_same(best, found.with_vertices(found.vertices - shift), 1e-8)


def test_rotation_does_not_matter(best: Mesh) -> None:
    turn = rotation()
    found = optimize(MESH.with_vertices(MESH.vertices @ turn.T)).mesh
    assert_same(best, found.with_vertices(found.vertices @ turn), 1e-9)


def test_reflection_does_not_matter(best: Mesh) -> None:
    """Mirrored, with faces the other way round so that normals stay outside."""
    mirror = np.array([-1.0, 1.0, 1.0])
    faces = [face[::-1] for face in MESH.faces]
    found = optimize(Mesh.build(MESH.vertices * mirror, faces)).mesh
    assert_same(best, MESH.with_vertices(found.vertices * mirror), 1e-9)


def test_order_of_faces_corners_and_vertices_does_not_matter(best: Mesh) -> None:
    rng = np.random.default_rng(3)
    order = rng.permutation(MESH.n_vertices)
    where = np.argsort(order)
    faces = [np.roll(where[face], k) for k, face in enumerate(MESH.faces)]
    shuffled = [faces[f] for f in rng.permutation(MESH.n_faces)]
    found = optimize(Mesh.build(MESH.vertices[order], shuffled)).mesh
    assert_same(best, MESH.with_vertices(found.vertices[where]), 1e-9)


@pytest.mark.slow
def test_mean_distance_is_the_same_where_creases_may_form_elsewhere() -> None:
    """On symmetric meshes rounding chooses the side of a crease; this one has no symmetry."""
    mesh = wavy(20)
    options: dict[str, Any] = {"distance_limit": (1.0, 3.0), **ANY_ZIGZAG}
    one = optimize(mesh, **options)
    turned = optimize(mesh.with_vertices(mesh.vertices @ rotation().T), **options)
    assert turned.change.distance_mean == pytest.approx(one.change.distance_mean, rel=0.02)

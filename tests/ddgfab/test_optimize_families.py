"""Families: how congruent pieces are counted, and fewer of them by moving vertices a little."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from ddgfab.errors import InputError, OptimizeError
from ddgfab.grid import grid_mesh
from ddgfab.io import read_mesh
from ddgfab.measures import planarity_percent
from ddgfab.mesh import Floats, Mesh
from ddgfab.optimize import FamiliesResult, families, optimize
from ddgfab.optimize.repetition import cluster_shapes, count_families, family_labels, pieces

QUAD = np.array([[0.0, 0, 0], [2, 0, 0], [2.5, 1.5, 0], [0.2, 1, 0]])


def apart(*shapes: Floats) -> Mesh:
    """A mesh of faces that do not touch."""
    points = [shape + np.array([10.0 * k, 0, 0]) for k, shape in enumerate(shapes)]
    counts = np.cumsum([0, *(len(shape) for shape in shapes)])
    faces = [list(range(a, b)) for a, b in pairwise(counts)]
    return Mesh.build(np.concatenate(points), faces)


def turned(shape: Floats, angle: float) -> Floats:
    """A shape after a rotation about a skew axis (Rodrigues)."""
    axis = np.array([1.0, 2.0, 2.0]) / 3.0
    along = (shape @ axis)[:, None] * axis
    return np.asarray(
        along + np.cos(angle) * (shape - along) + np.sin(angle) * np.cross(axis, shape)
    )


def rough_grid(size: int = 6, noise: float = 0.02) -> Mesh:
    """A flat square grid whose vertices are off by a little in its plane."""
    i, j = np.meshgrid(np.arange(size + 1.0), np.arange(size + 1.0), indexing="ij")
    points = np.stack([i, j, 0 * i], axis=-1)
    points[..., :2] += noise * np.random.default_rng(0).normal(size=(*i.shape, 2))
    return grid_mesh(points)


def test_turned_panels_are_one_family_and_mirrored_ones_are_not() -> None:
    mirrored = QUAD[::-1] * [-1.0, 1.0, 1.0]  # counterclockwise again, seen from above
    mesh = apart(QUAD, turned(QUAD, 0.7), np.roll(QUAD, 2, axis=0), mirrored, 1.01 * QUAD)
    assert family_labels(mesh, "panel", 1e-6).tolist() == [0, 0, 0, 3, 4]
    assert count_families(mesh, "panel", 0.1) == 2  # scaling moves corners by less than 0.02


def test_the_tolerance_is_that_of_corners() -> None:
    """A corner that is off by d leaves a best fit that is off by at most d."""
    other = QUAD.copy()
    other[2] += [0.01, 0, 0]
    mesh = apart(QUAD, other)
    assert count_families(mesh, "panel", 0.0101) == 1
    assert count_families(mesh, "panel", 0.003) == 2


def test_numbers_of_corners_are_apart() -> None:
    mesh = apart(QUAD, QUAD[:3], turned(QUAD[:3], 1.0))
    assert family_labels(mesh, "panel", 1e-6).tolist() == [0, 1, 1]


def test_equal_edges() -> None:
    mesh = grid_mesh(np.stack(np.meshgrid([0.0, 1, 2], [0.0, 1.5, 3], [0.0]), axis=-1)[..., 0, :])
    labels = family_labels(mesh, "edge", 1e-9)
    assert len(np.unique(labels)) == 2
    for label in np.unique(labels):
        assert np.ptp(mesh.edge_lengths[labels == label]) < 1e-12
        assert label == np.flatnonzero(labels == label)[0]


def test_leaders_come_in_order() -> None:
    """Lengths 1.0, 1.08, 1.16 with tolerance 0.1: the first leads the second, not the third."""
    points = np.cumsum([[0.0, 0, 0], [1.0, 0, 0], [1.08, 0, 0], [1.16, 0, 0]], axis=0)
    wide = np.concatenate([points, points[::-1] + np.array([0, 5.0, 0])])
    mesh = Mesh.build(wide, [[0, 1, 6, 7], [1, 2, 5, 6], [2, 3, 4, 5]])
    labels = family_labels(mesh, "edge", 0.1)
    first = [
        labels[np.flatnonzero((np.sort(mesh.edges, axis=1) == [k, k + 1]).all(axis=1))[0]]
        for k in range(3)
    ]
    assert first[0] == first[1] != first[2]


def test_distances_tell_the_shape() -> None:
    (group,) = pieces(apart(QUAD), "panel")
    distances = group.distances(apart(QUAD).vertices)[0]
    again = group.distances(apart(np.roll(QUAD, -1, axis=0)).vertices)[0]
    assert np.allclose(distances[group.turns[1]], again)  # turned by one corner


def test_clusters_of_turned_shapes() -> None:
    """Two shapes, each turned at random: k-means finds them, and asks every piece for its own."""
    rng = np.random.default_rng(1)
    other = QUAD * [1.0, 1.4, 1.0]
    shapes = [np.roll(s, int(rng.integers(4)), axis=0) for s in [QUAD, other] * 10]
    (group,) = pieces(apart(*shapes), "panel")
    distances = group.distances(apart(*shapes).vertices)
    found = cluster_shapes(distances, group.turns, 2)
    assert np.abs(found.targets - distances).max() < 1e-12
    assert np.array_equal(found.cluster, found.cluster[:2][np.arange(20) % 2])


@pytest.mark.parametrize("of", ["panel", "edge"])
def test_a_rough_grid_becomes_a_grid(of: str) -> None:
    mesh = rough_grid()
    result = families(mesh, of="panel" if of == "panel" else "edge", max_movement=0.1)
    assert result.status == "converged"
    assert result.families_before >= 36
    assert result.families <= 0.1 * result.families_before
    assert result.families == count_families(result.mesh, result.of, result.tolerance)
    assert result.movement_max <= 0.1
    assert planarity_percent(result.mesh).max() < 1e-8


def test_limits_are_kept_and_fixed_vertices_stay() -> None:
    mesh = rough_grid()
    result = families(mesh, of="edge", max_movement=0.03, fixed=[0, 24])
    assert 0 < result.movement_max <= 0.03
    assert np.array_equal(result.mesh.vertices[[0, 24]], mesh.vertices[[0, 24]])


def test_what_cannot_be_less() -> None:
    """A regular grid has one family: the input comes back with an error."""
    mesh = rough_grid(noise=0.0)
    with pytest.raises(OptimizeError, match="36 panels have 1 families") as caught:
        families(mesh)
    assert isinstance(caught.value.result, FamiliesResult)
    again = families(mesh, throw=False)
    assert again.status == "missed"
    assert again.mesh is mesh


def test_refusals() -> None:
    mesh = rough_grid(2)
    with pytest.raises(InputError, match='families of "node"'):
        families(mesh, of="node")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="fit_tolerance = 0"):
        families(mesh, fit_tolerance=0.0)
    with pytest.raises(InputError, match="max_movement = -1"):
        families(mesh, max_movement=-1.0)
    with pytest.raises(InputError, match="fixed vertex 99"):
        families(mesh, fixed=[99])


def test_by_the_name_of_its_goal() -> None:
    result = optimize(rough_grid(), "families", of="edge", max_movement=0.1)
    assert isinstance(result, FamiliesResult)


@pytest.mark.slow
def test_a_roof(mesh_file: Callable[[str], Path]) -> None:
    """Measured: 630 lengths become 64, moving vertices by 0.05 mean edges at most."""
    mesh = read_mesh(mesh_file("six_quad.obj")).mesh
    unit = float(mesh.edge_lengths.mean())
    result = families(mesh, of="edge", max_movement=0.1 * unit)
    assert result.families_before > 600
    assert result.families < 100
    assert result.movement_max < 0.1 * unit
    assert planarity_percent(result.mesh).max() < 1e-8

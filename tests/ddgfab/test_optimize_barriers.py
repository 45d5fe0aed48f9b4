"""Barriers: exact gradients, finite at every start, infinite before a face is lost."""

from __future__ import annotations

import numpy as np
import pytest
from optimize_meshes import hexagons, roof, wavy

from ddgfab.grid import grid_mesh
from ddgfab.mesh import Floats, Mesh
from ddgfab.optimize.barriers import (
    RowBarrier,
    barriers,
    corner_barriers,
    edge_barrier,
    fold_barriers,
)


def mixed() -> Mesh:
    """A quad, a pentagon and a triangle round a common edge or vertex, none of them planar."""
    points = [
        [0, 0, 0], [1, 0, 0.1], [1.1, 1, 0], [0, 1, 0.2],
        [2, -0.3, 0.3], [2.4, 0.6, 0.1], [1.8, 1.2, -0.2], [0.5, 1.9, 0.4],
    ]  # fmt: skip
    return Mesh.build(points, [[0, 1, 2, 3], [1, 4, 5, 6, 2], [3, 2, 7]])


MESHES = {"quads": wavy(4, 0.1), "hexagons": hexagons(3), "mixed": mixed()}


@pytest.mark.parametrize("name", MESHES)
def test_gradients_against_differences(name: str) -> None:
    mesh = MESHES[name]
    rng = np.random.default_rng(2)
    x = mesh.vertices.ravel() + 0.05 * rng.normal(size=mesh.vertices.size)
    way = rng.normal(size=x.size)
    for barrier in barriers(mesh):
        local, step = x[barrier.index], 1e-5
        ahead = barrier.measure((x + step * way)[barrier.index])
        back = barrier.measure((x - step * way)[barrier.index])
        slopes = np.einsum("mk,mk->m", barrier.slopes(local), way[barrier.index])
        np.testing.assert_allclose(slopes, (ahead - back) / (2 * step), atol=1e-7)


def moved(mesh: Mesh, kinds: tuple[RowBarrier, ...], seed: int, part: float = 0.97) -> Floats:
    """Unknowns that are part of the way to where a row is at its bound."""
    rng = np.random.default_rng(seed)
    x, way = mesh.vertices.ravel(), rng.normal(size=mesh.vertices.size)
    length = 1.0
    while not all(np.isfinite(b.value(x + length * way)) for b in kinds):
        length *= 0.98
    return np.asarray(x + part * length * way)


def test_slope_of_the_cost_with_barriers_active() -> None:
    mesh = roof(6, 6, 1.0)
    for barrier in barriers(mesh):
        x = moved(mesh, (barrier,), 3)
        rows, first, second = barrier.active(x)
        assert len(first)
        assert (first < 0).all()
        assert (second > 0).all()
        way = np.random.default_rng(4).normal(size=x.size)
        step = 1e-7
        numeric = (barrier.value(x + step * way) - barrier.value(x - step * way)) / (2 * step)
        assert (rows.T @ first) @ way == pytest.approx(numeric, rel=1e-5, abs=1e-6)


@pytest.mark.parametrize("name", MESHES)
def test_nothing_costs_at_the_start(name: str) -> None:
    mesh = MESHES[name]
    assert sum(b.value(mesh.vertices.ravel()) for b in barriers(mesh)) == 0


def test_sharp_and_reflex_corners_of_the_input_are_possible_starts() -> None:
    dart = Mesh.build([[0, 0, 0], [2, 0, 0], [0.5, 0.5, 0], [0, 2, 0]], [[0, 1, 2, 3]])
    kite = Mesh.build([[0, 0, 0], [5, 0.2, 0], [5.2, 0, 0], [5, -0.2, 0]], [[0, 3, 2, 1]])
    box = Mesh.build(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [1, 0, -1], [1, 1, -1]],
        [[0, 1, 2, 3], [1, 4, 5, 2]],
    )
    for mesh in (dart, kite, box):
        for barrier in barriers(mesh):
            assert barrier.value(mesh.vertices.ravel()) == 0
            assert (barrier.low < barrier.high).all()


@pytest.mark.parametrize("bend", [0.01, 1e-4])
def test_corners_of_quads_that_are_nearly_straight_do_not_become_reflex(bend: float) -> None:
    def quad(height: float) -> Mesh:
        return Mesh.build([[0, 0, 0], [2, 0, 0], [1, height, 0], [0, 1, 0]], [[0, 1, 2, 3]])

    mesh = quad(0.5 + bend)  # straight at 0.5
    (corners,) = corner_barriers(mesh)
    assert corners.value(mesh.vertices.ravel()) == 0
    assert 0 < corners.value(quad(0.5 + bend / 100).vertices.ravel()) < np.inf
    assert np.isinf(corners.value(quad(0.5 - bend / 100).vertices.ravel()))


def test_infinite_before_a_quad_is_reflex_an_edge_collapses_or_a_face_folds() -> None:
    flat = grid_mesh(
        np.stack([*np.meshgrid(*2 * [np.arange(3.0)], indexing="ij"), np.zeros((3, 3))], -1)
    )
    center = 4
    for target, kinds in (
        ([0.45, 0.45, 0.0], corner_barriers(flat)),  # beyond the diagonal of its first face
        ([1.0, 0.2, 0.0], (edge_barrier(flat),)),
        ([1.0, 1.0, 9.0], fold_barriers(flat)),
    ):
        points = flat.vertices.copy()
        points[center] = target
        assert any(np.isinf(b.value(points.ravel())) for b in kinds)


def test_faces_that_turn_over_their_common_side_are_held_by_the_barriers_of_every_goal() -> None:
    """Two squares, one turned over the other: their corners and sides stay as they are."""
    flat = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0]]
    mesh = Mesh.build(np.array(flat, dtype=float), [[0, 1, 4, 3], [1, 2, 5, 4]])
    for turn, possible in ((80.0, True), (95.0, False), (170.0, False)):
        points = mesh.vertices.copy()
        points[[2, 5], 0] = 1 + np.cos(np.radians(turn))
        points[[2, 5], 2] = np.sin(np.radians(turn))
        costs = [barrier.value(points.ravel()) for barrier in barriers(mesh)]
        assert bool(np.isfinite(costs).all()) == possible

"""The solver at one penalty against exact answers; linear systems, failures, history."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.sparse import csc_array, csr_array, diags_array, eye_array, random_array

from ddgfab.errors import DegenerateError, InputError
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.optimize import PathOptions, Problem, Step, settle
from ddgfab.optimize.linear import SymmetricSolver
from ddgfab.optimize.terms import (
    LinearTerm,
    LocalTerm,
    closeness,
    fairness,
    planarity_terms,
    widened,
)


def grid(n: int = 6, noise: float = 0.0) -> Mesh:
    u, v = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0), indexing="ij")
    points = np.stack([u, v, 0.1 * u * v - 0.05 * v**2], axis=-1)
    jitter = np.random.default_rng(0).normal(size=points.shape)
    return grid_mesh(points + noise * jitter, (False, False))


EXACT = PathOptions(tolerance=1e-11, steps_per_stage=30)


def test_least_squares_without_equations_is_exact() -> None:
    """Equal pulls to two places: the middle."""
    mesh = grid()
    up = closeness(mesh, mesh.vertices + np.array([0, 0, 2.0]))
    found = settle(Problem.build(mesh, [closeness(mesh), up], fixed=[3]), 1.0, EXACT)
    moved = found.value.reshape(-1, 3) - mesh.vertices
    np.testing.assert_allclose(np.delete(moved, 3, 0)[:, 2], 1.0, atol=1e-5)
    assert not moved[3].any()


@dataclass(frozen=True, eq=False, kw_only=True)
class Sphere(LocalTerm):
    """|x|^2 - radius^2 for points in space."""

    radius: float

    def values(self, local: Floats) -> Floats:
        """(m,) residuals."""
        return np.asarray((local**2).sum(axis=1) - self.radius**2)

    def gradients(self, local: Floats) -> Floats:
        """(m, 3)."""
        return 2 * local


def sphere(mesh: Mesh, radius: float) -> Sphere:
    index = np.arange(3 * mesh.n_vertices).reshape(-1, 3)
    return Sphere(name="sphere", index=index, radius=radius, hard=True)


def test_nearest_points_of_a_sphere() -> None:
    """Under a high penalty the point of a sphere nearest to p is p / |p|."""
    mesh = grid()
    far = mesh.vertices + np.array([3.0, 1.0, 12.0])
    start = mesh.with_vertices(0.95 * far)
    radius = 14.0
    problem = Problem.build(start, [closeness(start, far), sphere(start, radius)])
    found = settle(problem, 1e4, replace(EXACT, steps_per_stage=100))
    assert found.status == "converged"
    assert np.abs(problem.vertices(found.value) - radius * unit(far)).max() < 1e-2
    assert found.history[-1].violation <= 1e-11


def test_equations_that_contradict_each_other() -> None:
    mesh = grid().with_vertices(grid().vertices + np.array([3.0, 1.0, 2.0]))
    both = [closeness(mesh), sphere(mesh, 5.0), sphere(mesh, 6.0)]
    found = settle(Problem.build(mesh, both), 1e3, EXACT)
    assert found.status == "missed"
    assert found.waypoints[-1].violation > 1.0


def test_fixed_vertices_stay_to_the_last_bit_and_unused_ones_too() -> None:
    mesh = grid(noise=0.02)
    spare = Mesh.build(np.r_[mesh.vertices, [[9.0, 9.0, 9.0]]], mesh.corners.reshape(-1, 4))
    problem = Problem.build(
        spare, [closeness(spare), fairness(spare), *planarity_terms(spare)], fixed=[0, 6, 24]
    )
    points = problem.vertices(settle(problem, 1e3, EXACT).value)
    for vertex in (0, 6, 24, -1):
        assert np.array_equal(points[vertex], spare.vertices[vertex])
    assert np.abs(points - spare.vertices).max() > 1e-3


def test_history_and_progress_tell_the_same() -> None:
    mesh = grid(noise=0.02)
    told: list[tuple[int, Step]] = []
    found = settle(
        Problem.build(mesh, [closeness(mesh), fairness(mesh), *planarity_terms(mesh)]),
        1e3,
        EXACT,
        lambda number, step: told.append((number, step)),
    )
    assert tuple(step for _, step in told) == found.history
    assert [number for number, _ in told] == list(range(len(told)))
    assert found.history[-1].violation <= 1e-11


def test_blocks_of_further_unknowns() -> None:
    mesh = grid()
    problem = Problem.build(mesh, blocks={"heights": np.zeros((mesh.n_faces, 1))})
    layout = problem.layout
    assert layout.size == 3 * mesh.n_vertices + mesh.n_faces
    columns = layout.index("heights", np.arange(mesh.n_faces))[:, 0]
    matrix = csr_array(
        (np.ones(len(columns)), (np.arange(len(columns)), columns)),
        shape=(len(columns), layout.size),
    )
    target = np.linspace(0.1, 0.4, mesh.n_faces)
    wish = LinearTerm(name="heights", matrix=matrix, target=target)
    found = settle(problem.with_terms(wish, closeness(mesh)), 1.0, EXACT)
    np.testing.assert_allclose(layout.values(found.value, "heights")[:, 0], target, atol=1e-4)
    with pytest.raises(InputError, match="axes"):
        layout.block("axes")


def test_quasi_definite_systems_are_solved_in_an_order_that_is_kept() -> None:
    size, rows = 60, 25
    lines = random_array((rows, size), density=0.1, rng=np.random.default_rng(2))
    solver = SymmetricSolver()
    for shift in (1.0, 3.0, 0.5):
        top = csr_array(diags_array(np.linspace(1, 2, size)) * shift)
        corner = -1e-3 * eye_array(rows)
        matrix = csc_array(
            np.block([[top.toarray(), lines.T.toarray()], [lines.toarray(), corner.toarray()]])
        )
        right = np.arange(size + rows, dtype=float)
        solve_with = solver.factor(matrix)
        np.testing.assert_allclose(matrix @ solve_with(right), right, atol=1e-8)
        many = np.stack([right, 2 * right, right**2], axis=1)
        np.testing.assert_allclose(matrix @ solve_with(many), many, atol=1e-6)


def test_singular_systems_are_named() -> None:
    with pytest.raises(DegenerateError, match="singular"):
        SymmetricSolver().factor(csc_array(np.zeros((3, 3)) + 0.0))
    mesh = grid()
    nothing = replace(fairness(mesh), weight=0.0)  # damping alone holds the unknowns
    assert settle(Problem.build(mesh, [nothing]), 1.0).status == "converged"


def test_widened_only_adds_columns() -> None:
    matrix = csr_array(np.array([[1.0, 0.0], [0.0, 2.0]]))
    assert widened(matrix, 5).toarray().tolist() == [[1, 0, 0, 0, 0], [0, 2, 0, 0, 0]]

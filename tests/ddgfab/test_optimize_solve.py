"""The solver: its three routes against each other and against exact answers, failures, history."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csc_array, csr_array, diags_array, eye_array, random_array

from ddgfab.errors import DegenerateError, InputError, OptimizeError
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Mesh
from ddgfab.optimize import Problem, SolveOptions, Step, Term, mean_edge, polish, solve
from ddgfab.optimize.linear import SymmetricSolver
from ddgfab.optimize.terms import (
    LinearTerm,
    closeness,
    edge_lengths,
    fairness,
    on_surface,
    planarity_terms,
    widened,
)


def grid(n: int = 6, noise: float = 0.0) -> Mesh:
    u, v = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0), indexing="ij")
    points = np.stack([u, v, 0.1 * u * v - 0.05 * v**2], axis=-1)
    jitter = np.random.default_rng(0).normal(size=points.shape)
    return grid_mesh(points + noise * jitter, (False, False))


def plain(term: Term) -> Term:
    """The same term without its structure, so that the solver takes the direct route."""
    matrix = term.jacobian(np.zeros(3 * grid().n_vertices))
    target = -term.residual(np.zeros(matrix.shape[1]))
    return LinearTerm(name=term.name, matrix=matrix, target=target, weight=term.weight)


def test_fair_and_direct_routes_agree() -> None:
    mesh = grid(noise=0.03)
    soft = [closeness(mesh, weight=1e-2), fairness(mesh, smoothing=0.2)]
    exact = SolveOptions(forcing=1e-10, iterations=500, decrease=1e-8)
    fair = solve(Problem.build(mesh, [*soft, *planarity_terms(mesh)]), exact)
    direct = solve(Problem.build(mesh, [*map(plain, soft), *planarity_terms(mesh)]), exact)
    np.testing.assert_allclose(fair.value, direct.value, atol=1e-5)
    np.testing.assert_allclose(fair.history[-1].objective, direct.history[-1].objective, rtol=1e-6)


def test_dual_and_direct_routes_agree() -> None:
    """Round a cap of a paraboloid, cut along its principal directions: planar but for the noise."""
    mesh = grid(noise=0.0)
    x, y = mesh.vertices[:, 0], mesh.vertices[:, 1]
    jitter = 1e-3 * np.random.default_rng(4).normal(size=len(x))
    mesh = mesh.with_vertices(np.stack([x, y, 0.1 * x**2 + 0.07 * y**2 + jitter], axis=1))
    exact = SolveOptions(decrease=1e-9)
    dual = solve(Problem.build(mesh, [closeness(mesh), *planarity_terms(mesh)]), exact)
    direct = solve(Problem.build(mesh, [plain(closeness(mesh)), *planarity_terms(mesh)]), exact)
    np.testing.assert_allclose(dual.value, direct.value, atol=1e-5)


def test_least_squares_without_hard_terms_is_exact() -> None:
    """Equal pulls to two places: the middle, in one step."""
    mesh = grid()
    up = closeness(mesh, mesh.vertices + np.array([0, 0, 2.0]))
    found = solve(Problem.build(mesh, [closeness(mesh), up], fixed=[3]))
    moved = found.value.reshape(-1, 3) - mesh.vertices
    np.testing.assert_allclose(np.delete(moved, 3, 0)[:, 2], 1.0, atol=1e-5)
    assert not moved[3].any()


def test_polish_moves_least_and_converges_quadratically() -> None:
    mesh = grid(noise=1e-3)
    mesh = mesh.with_vertices(
        solve(
            Problem.build(
                mesh, [fairness(mesh), closeness(mesh, weight=0.1), *planarity_terms(mesh)]
            )
        ).value.reshape(-1, 3)
    )
    rough = mesh.with_vertices(
        mesh.vertices + 1e-4 * np.random.default_rng(1).normal(size=mesh.vertices.shape)
    )
    problem = Problem.build(rough, planarity_terms(rough))
    found = polish(problem)
    violations = [step.violation for step in found.history]
    assert len(violations) <= 4
    assert violations[-1] < 1e-11
    # Least movement: orthogonal to every movement that keeps the faces planar, to first order.
    move = (found.value - rough.vertices.ravel()) / mean_edge(rough)
    lines = planarity_terms(rough)[0].jacobian(found.value).toarray()
    inside = lines.T @ np.linalg.lstsq(lines.T, move, rcond=None)[0]
    assert np.linalg.norm(move - inside) < 0.05 * np.linalg.norm(move)


def test_fixed_vertices_stay_to_the_last_bit_and_unused_ones_too() -> None:
    mesh = grid(noise=0.02)
    spare = Mesh.build(np.r_[mesh.vertices, [[9.0, 9.0, 9.0]]], mesh.corners.reshape(-1, 4))
    problem = Problem.build(
        spare, [closeness(spare), fairness(spare), *planarity_terms(spare)], fixed=[0, 6, 24]
    )
    points = problem.vertices(solve(problem).value)
    for vertex in (0, 6, 24, -1):
        assert np.array_equal(points[vertex], spare.vertices[vertex])
    assert np.abs(points - spare.vertices).max() > 1e-3


@pytest.mark.parametrize("unit", [1e-6, 1e6])
def test_answers_scale_with_the_unit(unit: float) -> None:
    mesh = grid(noise=0.02)
    large = mesh.scaled(unit)
    found = [
        solve(Problem.build(m, [closeness(m), fairness(m), *planarity_terms(m)])).value
        for m in (mesh, large)
    ]
    np.testing.assert_allclose(found[0] * unit, found[1], rtol=0, atol=1e-8 * unit)


def test_terms_that_are_not_linear_are_solved_directly() -> None:
    mesh = grid(noise=0.02)
    raised = mesh.with_vertices(mesh.vertices + np.array([0.0, 0.0, 0.3]))
    problem = Problem.build(
        mesh,
        [fairness(mesh), on_surface(mesh, raised, weight=10.0), *planarity_terms(mesh)],
    )
    found = solve(problem, SolveOptions(tolerance=1e-8))
    assert found.converged
    assert np.abs(on_surface(mesh, raised).residual(found.value)).mean() < 0.1


def test_contradiction_is_an_error_with_names_and_the_point_reached() -> None:
    mesh = grid()
    problem = Problem.build(
        mesh,
        [
            closeness(mesh),
            edge_lengths(mesh, target=1.0, hard=True),
            edge_lengths(mesh, target=2.0, edges=[4], hard=True),
        ],
    )
    with pytest.raises(OptimizeError, match=r"edge length .*edge 4") as caught:
        solve(problem, SolveOptions(max_steps=8))
    assert caught.value.solution.status in ("stopped", "stalled")
    quiet = solve(problem, SolveOptions(max_steps=8), throw=False)
    np.testing.assert_array_equal(quiet.value, caught.value.solution.value)


def test_history_and_progress_tell_the_same() -> None:
    mesh = grid(noise=0.02)
    told: list[tuple[int, Step]] = []
    found = solve(
        Problem.build(mesh, [closeness(mesh), fairness(mesh), *planarity_terms(mesh)]),
        progress=lambda number, step: told.append((number, step)),
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
    wish = LinearTerm(name="heights", matrix=matrix, target=np.arange(1.0, mesh.n_faces + 1))
    found = solve(problem.with_terms(wish, closeness(mesh)))
    np.testing.assert_allclose(layout.values(found.value, "heights")[:, 0], wish.target, atol=1e-4)
    with pytest.raises(InputError, match="axes"):
        layout.block("axes")


@pytest.mark.parametrize("backend", SymmetricSolver.available())
def test_backends_solve_quasi_definite_systems_and_keep_their_order(backend: str) -> None:
    size, rows = 60, 25
    lines = random_array((rows, size), density=0.1, rng=np.random.default_rng(2))
    solver = SymmetricSolver(backend)
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
        SymmetricSolver("scipy").factor(csc_array(np.zeros((3, 3)) + 0.0))
    mesh = grid()
    nothing = replace(fairness(mesh), weight=0.0)
    assert solve(Problem.build(mesh, [nothing])).converged


def test_widened_only_adds_columns() -> None:
    matrix = csr_array(np.array([[1.0, 0.0], [0.0, 2.0]]))
    assert widened(matrix, 5).toarray().tolist() == [[1, 0, 0, 0, 0], [0, 2, 0, 0, 0]]

"""Node axes on moving vertices: derivatives of their terms and barriers, and what they measure."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from ddgfab.grid import grid_mesh
from ddgfab.measures import lean, torsion
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.optimize import Problem, Term
from ddgfab.optimize.surface import SmoothSurface
from ddgfab.optimize.terms.axes import (
    AXES,
    AxisLean,
    axis_torsion,
    unit_axes,
    vertex_normals,
)
from ddgfab.optimize.terms.cover import covered
from ddgfab.optimize.within import Within, lean_within, movement_within
from ddgfab.support import parallel_axes

STEP = 1e-6


def hill(m: int = 3, n: int = 4) -> Mesh:
    """A bent net without symmetry, its quads not planar."""
    i, j = np.meshgrid(np.arange(m + 1.0), np.arange(n + 1.0), indexing="ij")
    x, y = i + 0.2 * j, 1.3 * j - 0.1 * i
    return grid_mesh(np.stack([x, y, 0.1 * x * y - 0.07 * x**2 + 0.02 * y**3], axis=-1))


def mixed() -> Mesh:
    """A pentagon, a quad and a triangle that meet."""
    points = [
        [0.0, 0, 0], [2, 0, 0.1], [2.5, 1.5, 0.3], [1, 2.4, 0.2], [-0.5, 1.4, 0.1],
        [3.5, -0.2, 0.0], [4, 1.2, 0.5], [3.2, 2.6, 0.2],
    ]  # fmt: skip
    return Mesh.build(points, [[0, 1, 2, 3, 4], [1, 5, 6, 2], [2, 6, 7]])


def problem_on(mesh: Mesh, seed: int = 0, noise: float = 0.1) -> tuple[Problem, Floats]:
    """Problem with axes, and a point near its start where nothing is special."""
    problem = Problem.build(mesh, blocks={AXES: 1.2 * mesh.vertex_normals})
    away = np.random.default_rng(seed).normal(size=len(problem.start))
    return problem, problem.start + noise * away


def slope(function: Callable[[Floats], Floats], x: Floats) -> Floats:
    """Central differences, a column an unknown."""
    moves = STEP * np.eye(len(x))
    return np.stack([(function(x + h) - function(x - h)) / (2 * STEP) for h in moves], axis=-1)


def terms(mesh: Mesh) -> dict[str, Term]:
    """Every term of this room."""
    layout = problem_on(mesh)[0].layout
    return {
        "torsion": axis_torsion(mesh, layout),
        "length": unit_axes(mesh, layout),
        "lean": AxisLean(mesh=mesh, layout=layout),
    }


@pytest.mark.parametrize("mesh", [hill(), mixed()], ids=["quads", "mixed"])
def test_jacobians_by_finite_differences(mesh: Mesh) -> None:
    _, x = problem_on(mesh)
    for name, term in terms(mesh).items():
        exact = term.jacobian(x).toarray()
        assert exact.shape == (len(term.residual(x)), len(x))
        error = np.abs(exact - slope(term.residual, x)).max()
        assert error < 1e-7 * max(np.abs(exact).max(), 1), name


def bounds(mesh: Mesh, problem: Problem) -> dict[str, Within]:
    return {
        "lean": lean_within(mesh, problem.layout, 0.6),
        "movement": movement_within(mesh, problem.layout, 0.3),
    }


@pytest.mark.parametrize("mesh", [hill(), mixed()], ids=["quads", "mixed"])
def test_barriers_of_radius(mesh: Mesh) -> None:
    """Gradient by differences; the model of the second derivative is semidefinite, and exact where
    the vectors are linear in the unknowns."""
    problem, x = problem_on(mesh, noise=0.06)
    for name, barrier in bounds(mesh, problem).items():
        rows, first, second = barrier.active(x)
        assert np.isfinite(barrier.value(x))
        assert len(first) > 0
        wanted = slope(lambda at, b=barrier: np.asarray([b.value(at)]), x)[0]  # type: ignore[misc]
        np.testing.assert_allclose(rows.T @ first, wanted, atol=1e-6 * max(1, np.abs(wanted).max()))
        assert second.min() >= 0
        if name == "movement":
            gradient = lambda at, b=barrier: b.active(at)[0].T @ b.active(at)[1]  # noqa: E731
            hessian = (rows.T @ (second[:, None] * rows.toarray())).astype(float)
            np.testing.assert_allclose(hessian, slope(gradient, x), atol=1e-4)


def test_barriers_end_at_their_limits() -> None:
    mesh = hill()
    problem = Problem.build(mesh, blocks={AXES: mesh.vertex_normals})
    for barrier in bounds(mesh, problem).values():
        assert barrier.value(problem.start) == 0.0
    turned, moved = problem.start.copy(), problem.start.copy()
    axis, normal = problem.layout.index(AXES, [7])[0], mesh.vertex_normals[7]
    across = unit(np.cross(normal, [1.0, 0, 0]))
    for angle, inside in ((0.59, True), (0.61, False)):
        turned[axis] = 2.0 * (np.cos(angle) * normal + np.sin(angle) * across)
        assert np.isfinite(bounds(mesh, problem)["lean"].value(turned)) == inside
    for far, cost in ((0.14, False), (0.16, True)):  # free up to half the limit
        moved[3 * 7] = mesh.vertices[7, 0] + far
        assert (bounds(mesh, problem)["movement"].value(moved) > 0) == cost


def test_normals_are_those_of_the_mesh() -> None:
    mesh = mixed()
    normals, _ = vertex_normals(mesh, mesh.vertices)
    assert np.allclose(normals, mesh.vertex_normals, atol=1e-14)


def test_terms_are_the_measures() -> None:
    """sin(torsion) = |det(e, a, b)| / (sin(e, a) sin(e, b)); |a - n| = 2 sin(lean / 2)."""
    mesh = hill()
    problem, x = problem_on(mesh)
    axes = unit(problem.layout.values(x, AXES))
    moved = mesh.with_vertices(problem.vertices(x))
    along = unit(moved.edge_vectors)
    sines = [np.linalg.norm(np.cross(along, axes[ends]), axis=1) for ends in moved.edges.T]
    value = np.abs(axis_torsion(mesh, problem.layout).residual(x)) / (sines[0] * sines[1])
    assert np.allclose(value, np.sin(torsion(moved, axes)), atol=1e-12)
    away = AxisLean(mesh=mesh, layout=problem.layout).residual(x).reshape(-1, 3)
    assert np.allclose(np.linalg.norm(away, axis=1), 2 * np.sin(lean(moved, axes) / 2), atol=1e-12)


def test_axes_cannot_shrink_out_of_torsion() -> None:
    mesh = hill()
    problem, x = problem_on(mesh)
    small = x.copy()
    small[problem.layout.block(AXES)] *= 1e-3
    term = axis_torsion(mesh, problem.layout)
    np.testing.assert_allclose(term.residual(small), term.residual(x), atol=1e-12)
    assert np.abs(unit_axes(mesh, problem.layout).residual(small)).min() > 0.49


def test_torsion_term_vanishes_on_parallel_meshes() -> None:
    """A translation net has planar faces; axes to a parallel mesh are free of torsion."""
    i, j = np.meshgrid(np.arange(5.0), np.arange(6.0), indexing="ij")
    mesh = grid_mesh(np.stack([i, j, 0.1 * i**2 + 0.05 * j**2], axis=-1))
    problem = Problem.build(mesh, blocks={AXES: parallel_axes(mesh)})
    assert np.abs(axis_torsion(mesh, problem.layout).residual(problem.start)).max() < 1e-11


def test_a_surface_is_covered_by_its_mesh_and_not_by_a_part() -> None:
    """Shrunk towards its middle the mesh stays near the surface, but leaves the flanks bare."""
    i, j = np.meshgrid(np.arange(-4.0, 5.0), np.arange(-4.0, 5.0), indexing="ij")
    mesh = grid_mesh(np.stack([i, j, 0.12 * (i**2 + j**2)], axis=-1))
    cover = covered(mesh)
    here = mesh.vertices.ravel()
    assert np.abs(cover.at(here).residual(here)).max() < 1e-12
    raised = (mesh.vertices + 0.2 * mesh.vertex_normals).ravel()
    np.testing.assert_allclose(np.abs(cover.at(raised).residual(raised)), 0.2, atol=0.02)
    half = mesh.vertices * [0.5, 0.5, 0.25]  # on the same paraboloid
    assert SmoothSurface(mesh).distance(half).max() < 0.1
    assert np.abs(cover.at(half.ravel()).residual(half.ravel())).max() > 0.3
    error = cover.at(raised).jacobian(raised).toarray() - slope(cover.at(raised).residual, raised)
    assert np.abs(error).max() < 1e-7

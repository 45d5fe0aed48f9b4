"""Terms for node axes on moving vertices, and Newton's method with the curvature of equations."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pytest

from ddgfab.errors import OptimizeError
from ddgfab.grid import grid_mesh
from ddgfab.measures import torsion
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.optimize import Problem, Term
from ddgfab.optimize.newton import NewtonOptions, curvature, newton
from ddgfab.optimize.terms import LinearTerm, LocalTerm, closeness, planarity_terms
from ddgfab.optimize.torsion_problem import TorsionFreeOptions, smooth_change, terms_of
from ddgfab.optimize.torsion_terms import (
    AXES,
    AxisLean,
    Power,
    axis_torsion,
    corner_angles,
    edge_stretch,
    vertex_normals,
)
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


def problem_on(mesh: Mesh, seed: int = 0) -> tuple[Problem, Floats]:
    """Problem with axes, and a point near its start where nothing is special."""
    problem = Problem.build(mesh, blocks={AXES: mesh.vertex_normals})
    noise = np.random.default_rng(seed).normal(size=len(problem.start))
    return problem, problem.start + 0.1 * noise


def slope(function: Callable[[Floats], Floats], x: Floats) -> Floats:
    """Central differences, a column an unknown."""
    moves = STEP * np.eye(len(x))
    return np.stack([(function(x + h) - function(x - h)) / (2 * STEP) for h in moves], axis=-1)


def terms(mesh: Mesh) -> dict[str, Term]:
    """Every term of this room."""
    layout = problem_on(mesh)[0].layout
    lean = AxisLean(mesh=mesh, layout=layout)
    return {
        "torsion": axis_torsion(mesh, layout),
        "lean": lean,
        "limited lean": Power(term=lean, width=3, limit=0.3, power=4),
        "movement": Power(term=closeness(mesh), width=3, limit=0.5, power=2),
        "stretch": Power(term=edge_stretch(mesh), limit=0.7, power=2),
        "smooth": smooth_change(mesh, 1.0),
        **{term.name: term for term in corner_angles(mesh)},
    }


@pytest.mark.parametrize("mesh", [hill(), mixed()], ids=["quads", "mixed"])
def test_jacobians_by_finite_differences(mesh: Mesh) -> None:
    _, x = problem_on(mesh)
    for name, term in terms(mesh).items():
        exact = term.jacobian(x).toarray()
        assert exact.shape == (len(term.residual(x)), len(x))
        error = np.abs(exact - slope(term.residual, x)).max()
        assert error < 1e-7 * max(np.abs(exact).max(), 1), name


def test_normals_are_those_of_the_mesh() -> None:
    mesh = mixed()
    normals, _ = vertex_normals(mesh, mesh.vertices)
    assert np.allclose(normals, mesh.vertex_normals, atol=1e-14)


def test_torsion_term_is_the_measure() -> None:
    """sin(torsion) = |det(e, a, b)| / (sin(e, a) sin(e, b)) with unit vectors."""
    mesh = hill()
    problem, x = problem_on(mesh)
    axes = unit(problem.layout.values(x, AXES))
    x[problem.layout.block(AXES)] = axes.ravel()
    moved = mesh.with_vertices(problem.vertices(x))
    along = unit(moved.edge_vectors)
    sines = [np.linalg.norm(np.cross(along, axes[ends]), axis=1) for ends in moved.edges.T]
    value = np.abs(axis_torsion(mesh, problem.layout).residual(x)) / (sines[0] * sines[1])
    assert np.allclose(value, np.sin(torsion(moved, axes)), atol=1e-12)


def test_torsion_term_vanishes_on_parallel_meshes() -> None:
    """A translation net has planar faces; axes to a parallel mesh are free of torsion."""
    i, j = np.meshgrid(np.arange(5.0), np.arange(6.0), indexing="ij")
    mesh = grid_mesh(np.stack([i, j, 0.1 * i**2 + 0.05 * j**2], axis=-1))
    problem = Problem.build(mesh, blocks={AXES: parallel_axes(mesh)})
    assert np.abs(axis_torsion(mesh, problem.layout).residual(problem.start)).max() < 1e-11


def test_corner_angles_know_reflex_corners() -> None:
    low = -np.tan(np.radians(30.0))
    dart = Mesh.build([[0, 0, 0], [1, low, 0], [0, 2, 0], [-1, low, 0]], [[0, 1, 2, 3]])
    (term,) = corner_angles(dart)
    angles = term.residual(dart.vertices.ravel()) + np.pi / 2
    assert angles[0] == pytest.approx(np.radians(240.0))  # 120 deg to each side of the y axis
    assert angles.sum() == pytest.approx(2 * np.pi)


def test_hessian_of_a_limit_on_linear_residuals_is_exact() -> None:
    """Where r is linear, `Power.hessian` is the second derivative of half the squares."""
    mesh = hill(1, 2)
    limit = Power(term=closeness(mesh), width=3, limit=0.4, power=3)
    x = mesh.vertices.ravel() + np.random.default_rng(1).normal(size=3 * mesh.n_vertices)

    def gradient(at: Floats) -> Floats:
        return np.asarray(limit.jacobian(at).T @ limit.residual(at))

    exact = slope(gradient, x)
    assert np.abs(limit.hessian(x).toarray() - exact).max() < 1e-7 * np.abs(exact).max()


def test_curvature_of_equations() -> None:
    mesh = hill()
    problem, x = problem_on(mesh)
    for term in (axis_torsion(mesh, problem.layout), *planarity_terms(mesh)):
        force = np.random.default_rng(2).normal(size=len(term.residual(x)))
        exact = slope(lambda at, t=term, f=force: np.asarray(t.jacobian(at).T @ f), x)  # type: ignore[misc]
        found = curvature(term, x, force, problem.scale).toarray()
        assert np.abs(found - exact).max() < 1e-6 * np.abs(exact).max()


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


def on_spheres(mesh: Mesh, radii: Sequence[float]) -> tuple[Sphere, ...]:
    index = np.arange(3 * mesh.n_vertices).reshape(-1, 3)
    return tuple(Sphere(name=f"sphere {r}", index=index, radius=r, hard=True) for r in radii)


def test_newton_projects_on_spheres() -> None:
    """The point of a sphere nearest to p is p / |p|; multipliers are large where p is far."""
    mesh = hill()
    start = unit(np.random.default_rng(3).normal(size=mesh.vertices.shape)) + 0.2
    far = 40.0 * unit(mesh.vertices + np.array([3.0, 1.0, 2.0]))
    problem = Problem.build(
        mesh.with_vertices(start), [closeness(mesh, far), *on_spheres(mesh, [1.0])]
    )
    options = NewtonOptions(decrease=1e-12, steps=60)
    solution = newton(problem, options)
    assert solution.converged
    assert np.abs(problem.vertices(solution.value) - unit(far)).max() < 1e-4
    assert solution.history[-1].violation <= options.tolerance


def test_newton_says_what_contradicts() -> None:
    mesh = hill()
    problem = Problem.build(mesh, [closeness(mesh), *on_spheres(mesh, [1.0, 2.0])])
    with pytest.raises(OptimizeError, match=r"not met after \d+ steps: sphere 1.0 .*row") as caught:
        newton(problem)
    assert caught.value.solution is not None
    kept = newton(problem, throw=False)
    assert kept.status == "stopped"


def test_newton_keeps_fixed_vertices() -> None:
    mesh = hill()
    problem = Problem.build(mesh, [closeness(mesh), *planarity_terms(mesh)], fixed=[0, 7, 19])
    found = problem.vertices(newton(problem).value)
    assert np.array_equal(found[[0, 7, 19]], mesh.vertices[[0, 7, 19]])
    assert not np.array_equal(found[5], mesh.vertices[5])


def test_smooth_change_lets_linear_motions_pass() -> None:
    """Shifts, and shears of the plan of a regular grid, bend nothing; mixing in z does."""
    i, j = np.meshgrid(np.arange(5.0), np.arange(4.0), indexing="ij")
    mesh = grid_mesh(np.stack([i, j, 0.1 * i**2], axis=-1))
    change = smooth_change(mesh, 1.0)
    for by in ([1.0, 0.2, 0.1], [0.3, 1.0, 0.0]), ([0.5, 0.0, 0.0], [0.0, 2.0, 1.0]):
        moved = mesh.vertices @ np.array([*by, [0.0, 0.0, 1.0]]) + np.array([1.0, 2.0, 3.0])
        assert np.abs(change.residual(moved.ravel())).max() < 1e-12
    bent = mesh.vertices + 0.1 * mesh.vertices[:, [2, 1, 0]]
    # x grows by 0.01 i^2: second differences of 0.02 over an edge of about 1
    assert 0.01 < np.abs(change.residual(bent.ravel())).max() < 0.02


def test_limits_come_first_in_the_terms_of_the_recipe() -> None:
    """The lean's limit is a sine, and corner angles keep what the input has."""
    mesh = hill()
    problem, _ = problem_on(mesh)
    found = terms_of(mesh, problem, (20.0, 0.5), TorsionFreeOptions())
    limits = [term for term in found if isinstance(term, Power)]
    assert limits[0].limit == pytest.approx(np.sin(np.radians(18.0)))
    assert limits[1].limit == pytest.approx(0.45)
    assert {term.name for term in found if term.hard} == {"axis torsion", "planarity"}
    assert any(isinstance(term, LinearTerm) for term in found)

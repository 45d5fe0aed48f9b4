"""Node axes by sequential quadratic programme: derivatives, optimality, families, real nets."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.linalg import matrix_rank

from ddgfab.errors import SupportError
from ddgfab.forms import canopy
from ddgfab.grid import grid_mesh
from ddgfab.io import read_mesh
from ddgfab.measures import lean, torsion
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.support import AxesOptions, even_lean, nearest_axes, torsion_free_axes
from ddgfab.support.nearest_axes import _hessian, constraints, jacobian, tangent_frames


def rough_grid(rows: int, cols: int, seed: int = 5, noise: float = 0.05) -> Mesh:
    """A curved grid whose faces are not planar."""
    rng = np.random.default_rng(seed)
    u, v = np.meshgrid(np.arange(rows + 1.0), np.arange(cols + 1.0), indexing="ij")
    x = np.stack([u, v, -0.1 * u**2 - 0.06 * v**2], axis=-1)
    return grid_mesh(x + noise * rng.normal(size=x.shape))


def torus(noise: float) -> Mesh:
    rng = np.random.default_rng(0)
    u, v = np.meshgrid(np.arange(16) * np.pi / 8, np.arange(9) * 2 * np.pi / 9, indexing="ij")
    r = 3 + np.cos(v)
    x = np.stack([r * np.cos(u), r * np.sin(u), np.sin(v)], axis=-1)
    return grid_mesh(x + noise * rng.normal(size=x.shape), closed=(True, True))


def test_jacobian_against_central_differences() -> None:
    mesh = rough_grid(3, 4)
    axes = unit(mesh.vertex_normals + 0.2 * np.random.default_rng(1).normal(size=(20, 3)))
    frames = tangent_frames(axes)
    step = 1e-6
    columns = []
    for k in range(2 * mesh.n_vertices):
        move = np.zeros((mesh.n_vertices, 2))
        move.flat[k] = step
        turn = np.einsum("vk,vkx->vx", move, frames)
        columns.append(
            (constraints(mesh, unit(axes + turn)) - constraints(mesh, unit(axes - turn)))
            / (2 * step)
        )
    assert np.abs(np.stack(columns, axis=1) - jacobian(mesh, axes, frames).toarray()).max() < 1e-9


def test_hessian_against_differences_of_the_lagrangian() -> None:
    """At torsion-free axes, d2/dt2 of sum (1 - <a, n>) + <force, c> along random directions."""
    mesh = rough_grid(3, 3)
    axes = torsion_free_axes(mesh).axes
    rng = np.random.default_rng(2)
    force, frames = rng.normal(size=mesh.n_edges), tangent_frames(axes)
    pull = np.einsum("vx,vx->v", axes, mesh.vertex_normals)
    hessian = _hessian(mesh, axes, frames, pull, force)

    def lagrangian(move: Floats) -> float:
        moved = unit(axes + np.einsum("vk,vkx->vx", move.reshape(-1, 2), frames))
        away = 1 - np.einsum("vx,vx->v", moved, mesh.vertex_normals)
        return float(away.sum() + force @ constraints(mesh, moved))

    for _ in range(5):
        way, step = rng.normal(size=2 * mesh.n_vertices), 1e-4
        second = (lagrangian(step * way) - 2 * lagrangian(0 * way) + lagrangian(-step * way)) / (
            step**2
        )
        assert second == pytest.approx(way @ hessian @ way, rel=1e-5, abs=1e-4)


def test_result_is_stationary_and_nearer_than_other_structures() -> None:
    mesh = rough_grid(6, 5)
    best = torsion_free_axes(mesh)
    frames = tangent_frames(best.axes)
    gradient = -np.einsum("vkx,vx->vk", frames, mesh.vertex_normals).ravel()
    matrix = jacobian(mesh, best.axes, frames).toarray()
    force = np.linalg.lstsq(matrix.T, -gradient, rcond=None)[0]
    assert np.abs(gradient + matrix.T @ force).max() < 1e-6  # Lagrange multipliers exist

    def distance(axes: Floats) -> float:
        return float(np.sum((axes - mesh.vertex_normals) ** 2))

    rng = np.random.default_rng(7)
    for _ in range(4):
        target = unit(best.axes + 0.05 * rng.normal(size=best.axes.shape))
        other = torsion_free_axes(mesh, target=target)
        assert other.torsion_deg_max < 1e-9
        assert distance(other.axes) > distance(best.axes)


@pytest.mark.parametrize(("rows", "cols"), [(1, 1), (2, 3), (4, 4), (3, 6)])
def test_family_of_a_disk_has_dimension_half_the_boundary_plus_two(rows: int, cols: int) -> None:
    mesh = rough_grid(rows, cols)
    axes = torsion_free_axes(mesh).axes
    rank = matrix_rank(jacobian(mesh, axes, tangent_frames(axes)).toarray(), tol=1e-8)
    assert 2 * mesh.n_vertices - rank == mesh.boundary_edge.sum() // 2 + 2


@pytest.mark.parametrize(
    ("name", "scale", "greatest", "mean"),
    [
        ("conical1.obj", 1.0, 2.9, 0.3),
        ("six_quad.obj", 1e3, 9.7, 2.0),
        ("quad_dome.obj", 1.0, 1.4, 1.0),
        ("botanic_garden_bubble.obj", 1e-3, 33.9, 10.5),
        ("heart.obj", 1.0, 64.7, 32.4),
    ],
)
def test_published_meshes(
    mesh_file: Callable[[str], Path], name: str, scale: float, greatest: float, mean: float
) -> None:
    """Leans as an independent study measured them (docs/parts.md), within 2 %."""
    mesh = read_mesh(mesh_file(name)).mesh.scaled(scale)
    structure = torsion_free_axes(mesh)
    # Measured afresh, by the route that knows nothing of the solver.
    assert np.degrees(torsion(mesh, structure.axes).max()) < 1e-9
    assert np.degrees(lean(mesh, structure.axes).max()) < 1.02 * greatest + 0.05
    assert np.degrees(lean(mesh, structure.axes).mean()) < 1.02 * mean
    assert len(structure.history_deg) <= 12
    assert structure.status == "converged"


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_rigid_motions_and_scales_carry_the_axes_along(scale: float) -> None:
    mesh = rough_grid(5, 6)
    turn = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    moved = mesh.with_vertices(scale * (mesh.vertices @ turn.T + [5.0, -2.0, 1.0]))
    assert (
        np.abs(torsion_free_axes(moved).axes - torsion_free_axes(mesh).axes @ turn.T).max() < 1e-6
    )


def test_same_input_same_bits() -> None:
    mesh = rough_grid(7, 7)
    assert (torsion_free_axes(mesh).axes == torsion_free_axes(mesh).axes).all()


def test_holes_mixed_faces_and_unused_vertices() -> None:
    base = canopy()
    rng = np.random.default_rng(1)
    points = base.vertices + 20 * rng.normal(size=base.vertices.shape)
    faces = [f for k, f in enumerate(base.faces) if k not in (60, 61, 71, 150)]
    corner = faces.pop(40)
    faces += [corner[[0, 1, 2]], corner[[0, 2, 3]]]
    mesh = Mesh.build(np.concatenate([points, [[0.0, 0.0, 9e3]]]), faces)
    assert len(mesh.boundary_loops) == 3
    structure = torsion_free_axes(mesh)
    assert structure.torsion_deg_max < 1e-9
    assert structure.lean_deg_max < 10
    assert (structure.axes[-1] == 0).all()  # the vertex without faces has no axis


def test_closed_mesh_with_dependent_conditions() -> None:
    """A round torus is circular, so it has axes although 2V = E; a shaken one has none."""
    assert torsion_free_axes(torus(0.0)).torsion_deg_max < 1e-9
    shaken = torus(0.02)
    with pytest.raises(SupportError, match="worst edges") as caught:
        torsion_free_axes(shaken)
    stopped = torsion_free_axes(shaken, throw=False)
    assert stopped.status == "stopped"
    assert f"{stopped.worst_edges(1)[0]} (" in str(caught.value)
    assert len(stopped.history_deg) == AxesOptions().max_steps


def test_weights_pull() -> None:
    mesh = rough_grid(5, 5)
    plain = torsion_free_axes(mesh)
    vertex = int(plain.worst_vertices(1)[0])
    weights = np.ones(mesh.n_vertices)
    weights[vertex] = 1e4
    assert torsion_free_axes(mesh, weights=weights).lean[vertex] < 0.1 * plain.lean[vertex]


def test_even_lean_lowers_the_greatest(mesh_file: Callable[[str], Path]) -> None:
    mesh = read_mesh(mesh_file("six_quad.obj")).mesh
    plain, even = torsion_free_axes(mesh), even_lean(mesh)
    assert even.torsion_deg_max < 1e-9
    assert even.lean_deg_max < 0.9 * plain.lean_deg_max
    assert even.lean_deg_mean > plain.lean_deg_mean


def test_steps_do_not_grow_with_the_mesh() -> None:
    """So time follows that of one sparse solve (near-linear: benchmarks)."""
    counts = [len(torsion_free_axes(rough_grid(n, n, noise=0.01)).history_deg) for n in (6, 12, 24)]
    assert max(counts) <= 10


def test_the_line_search_keeps_to_the_nearest_structure() -> None:
    """Full steps on a very rough mesh end at axes twice as far; others starts find none nearer."""
    mesh = rough_grid(6, 6, seed=1, noise=0.4)

    def distance(start: Floats | None) -> float:
        found = torsion_free_axes(mesh, start)
        return float(np.sum((found.axes - mesh.vertex_normals) ** 2))

    rng = np.random.default_rng(0)
    noise = 0.2 * rng.normal(size=(4, *mesh.vertices.shape))
    others = [distance(unit(mesh.vertex_normals + n)) for n in noise]
    assert distance(None) <= min(others) + 1e-9


def test_axes_free_of_torsion_count_though_a_finer_aim_is_not_reached() -> None:
    options = AxesOptions(torsion_deg=1e-30, max_steps=12)
    found = torsion_free_axes(rough_grid(4, 4), options=options)
    assert len(found.history_deg) == 12
    assert (found.status, found.torsion_free) == ("converged", True)


@pytest.mark.parametrize("last", [1, 3])
def test_a_solve_that_breaks_down_leaves_the_axes_before_it(
    monkeypatch: pytest.MonkeyPatch, last: int
) -> None:
    calls = []

    def broken(*given: Any) -> tuple[Floats, Floats]:
        calls.append(1)
        move, force = step(*given)
        return (move, force) if len(calls) < last else (np.nan * move, force)

    mesh, options = rough_grid(5, 5, noise=0.2), AxesOptions(newton_step=0.0)
    whole = torsion_free_axes(mesh, options=options)  # the cheap steps only
    step = nearest_axes._cheap_step
    monkeypatch.setattr(nearest_axes, "_cheap_step", broken)
    found = torsion_free_axes(mesh, options=options, throw=False)
    assert len(calls) == last
    assert found.status == "stopped"
    assert len(found.history_deg) == max(1, last - 1)
    if last > 1:
        assert found.history_deg == whole.history_deg[: last - 1]
    else:
        assert np.abs(found.axes - mesh.vertex_normals).max() < 1e-15
    calls.clear()
    with pytest.raises(SupportError, match="torsion stays"):
        torsion_free_axes(mesh, options=options)

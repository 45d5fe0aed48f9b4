"""Pane sizes: quads are divided until they fit, and stay so while they are optimized."""

from __future__ import annotations

import numpy as np
import pytest
from optimize_meshes import dome, hexagons, rotation

from ddgfab.errors import InputError
from ddgfab.grid import grid_mesh
from ddgfab.measures import planarity_percent
from ddgfab.mesh import Mesh
from ddgfab.optimize import Limits, OptimizeResult, optimize
from ddgfab.optimize.pane_size import misfit, pane_sizes
from ddgfab.optimize.panes import divided, further, pane_lengths, parts_for_panes, strips

PANE = (0.6, 1.0)


def flat(nx: int, ny: int, side: float = 1.0) -> Mesh:
    x, y = np.meshgrid(side * np.arange(nx + 1.0), np.arange(ny + 1.0), indexing="ij")
    return grid_mesh(np.stack([x, y, 0 * x], axis=-1))


def test_sizes_are_those_of_rectangles_wherever_they_lie() -> None:
    mesh = flat(3, 2, 2.5)
    turned = mesh.with_vertices(mesh.vertices @ rotation().T + [3, 4, 5])
    np.testing.assert_allclose(pane_sizes(turned, (1.2, 2)), np.tile([1.0, 2.5], (6, 1)))
    np.testing.assert_allclose(misfit(turned, (1.2, 2)), 1.25)
    np.testing.assert_allclose(misfit(turned, (2, 1.2)), 1.25)  # in any order
    triangle = Mesh.build([[0, 0, 0], [4, 0, 0], [0, 3, 0]], [[0, 1, 2]])
    np.testing.assert_allclose(pane_sizes(triangle, (3, 4)), [[3, 4]])
    np.testing.assert_allclose(pane_sizes(triangle, (2.4, 5)), [[2.4, 5]])  # along the long side


def test_the_fewest_strips_are_divided() -> None:
    """Squares of side 1 in panes of 0.6 x 1.2: one family of strips is halved, the other is not."""
    mesh = flat(6, 4)
    parts = parts_for_panes(mesh, (0.6, 1.2))
    assert sorted(np.unique(parts).tolist()) == [1, 2]
    cut = divided(mesh, parts)
    assert cut.n_faces == 2 * mesh.n_faces
    assert misfit(cut, (0.6, 1.2)).max() <= 1
    assert len(np.unique(strips(mesh))) == 10


def test_divided_meshes_keep_vertices_boundary_and_orientation() -> None:
    mesh = dome(6)
    parts = parts_for_panes(mesh, PANE)
    assert parts.max() > 1
    cut = divided(mesh, parts)
    cut.validate()
    np.testing.assert_array_equal(cut.vertices[: mesh.n_vertices], mesh.vertices)
    assert len(cut.boundary_loops) == 1
    assert cut.n_vertices - cut.n_edges + cut.n_faces == 1
    assert cut.face_areas.sum() == pytest.approx(mesh.face_areas.sum(), rel=0.05)
    owner = np.repeat(
        np.arange(mesh.n_faces), parts[mesh.corner_edge.reshape(-1, 4)[:, :2]].prod(1)
    )
    facing = np.einsum("fx,fx->f", cut.face_normals, mesh.face_normals[owner])
    assert facing.min() > 0.9


def test_divided_meshes_lie_on_the_curved_surface() -> None:
    """New vertices of a coarse sphere patch are nearer to the sphere than its edges."""
    u, v = np.meshgrid(np.linspace(-0.6, 0.6, 5), np.linspace(-0.6, 0.6, 5), indexing="ij")
    mesh = grid_mesh(np.stack([np.sin(u), np.cos(u) * np.sin(v), np.cos(u) * np.cos(v)], axis=-1))
    new = divided(mesh, np.full(mesh.n_edges, 2)).vertices[mesh.n_vertices :]
    straight = mesh.vertices[mesh.edges].mean(axis=1)
    off, flat_off = (1 - np.linalg.norm(p, axis=1) for p in (new, straight))
    assert np.abs(off).mean() < 0.6 * flat_off.mean()


def test_panes_fit_after_optimizing() -> None:
    mesh = dome(8)
    assert misfit(mesh, PANE).max() > 1
    result = optimize(mesh, max_pane=PANE)
    assert misfit(result.mesh, PANE).max() <= 1
    assert planarity_percent(result.mesh).max() <= 0.2
    assert result.original.n_faces == result.mesh.n_faces > mesh.n_faces
    assert not len(result.change.folded)


def test_the_soft_term_keeps_edges_short() -> None:
    mesh = dome(8)
    longest = 1.05 * mesh.edge_lengths.max()
    soft = pane_lengths(mesh, (longest, longest))
    assert (soft.residual(mesh.vertices.ravel()) >= 0).all()
    small = 0.7 * longest
    pulled = pane_lengths(mesh, (small, small))
    assert pulled.residual(mesh.vertices.ravel()).max() > 0


def test_strips_whose_panes_came_out_too_large_are_divided_further() -> None:
    mesh = flat(4, 3)
    parts = np.ones(mesh.n_edges, dtype=np.int64)
    points = mesh.vertices.copy()
    points[points[:, 0] > 3.5] += [0.5, 0, 0]  # the last strip is 1.5 wide
    found = further(mesh, parts, mesh.with_vertices(points), (1.1, 1.2))
    assert found.sum() > parts.sum()
    assert found.max() == 2


def test_panes_beyond_the_limit_are_named() -> None:
    mesh = hexagons(5)
    with pytest.raises(InputError, match=r"only meshes of quads can be divided: faces 0, 1"):
        optimize(mesh, max_pane=(1.0, 1.2))
    with pytest.raises(InputError, match="more than 64 parts"):
        optimize(dome(4), max_pane=(1e-3, 1e-3))
    with pytest.raises(InputError, match="two positive lengths"):
        optimize(dome(4), max_pane=(0.0, 1.0))
    with pytest.raises(InputError, match="max_pane is for goals planar"):
        optimize(dome(4), "families", max_pane=PANE)


def test_the_limit_of_panes_is_one_of_the_limits() -> None:
    result = optimize(dome(6))
    assert isinstance(result, OptimizeResult)
    (said,) = Limits(pane=(0.5, 0.5)).exceeded(result.change)
    assert "larger than a pane of 0.5 x 0.5" in said
    assert not Limits(pane=(3.0, 3.0)).exceeded(result.change)

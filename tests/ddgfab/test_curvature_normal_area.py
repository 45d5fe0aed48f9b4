"""Least area along normals: its Hessian, convergence to smooth surfaces, refusals."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.curvature import (
    area_gradient,
    area_hessian,
    minimise_area,
    minimise_area_along_normals,
    triangulate,
)
from ddgfab.errors import DegenerateError, MeshError
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Floats, Mesh


def scherk(x: Floats, y: Floats) -> Floats:
    return np.log(np.cos(y) / np.cos(x))


def graph(cells: int, bump: float = 0.0, half: float = 0.8) -> Mesh:
    """Scherk's surface over a square, with a bump that vanishes on the boundary."""
    x, y = np.meshgrid(*[np.linspace(-half, half, cells + 1)] * 2, indexing="ij")
    wave = np.cos(0.5 * np.pi * x / half) * np.cos(0.5 * np.pi * y / half)
    return triangulate(grid_mesh(np.stack([x, y, scherk(x, y) + bump * wave], axis=-1)))


def test_hessian_against_differences_of_the_gradient() -> None:
    rng = np.random.default_rng(4)
    mesh = Mesh.build(rng.standard_normal((5, 3)), [[0, 1, 2], [0, 2, 3], [0, 3, 4]])
    hessian = area_hessian(mesh).toarray()
    step = 1e-5
    for k, move in enumerate(step * np.eye(15)):
        ahead, back = (mesh.vertices + s * move.reshape(5, 3) for s in (1.0, -1.0))
        slope = area_gradient(mesh.with_vertices(ahead)) - area_gradient(mesh.with_vertices(back))
        np.testing.assert_allclose(hessian[:, k], slope.ravel() / (2 * step), atol=1e-7)
    # Moves of the whole mesh change nothing.
    np.testing.assert_allclose(hessian @ np.tile(np.eye(3), (5, 1)), 0, atol=1e-12)


@pytest.mark.parametrize("alternate", [False, True])
def test_a_saddle_that_slides_for_ever_converges_along_normals(alternate: bool) -> None:
    x, y = np.meshgrid(*[np.linspace(0, 1, 9)] * 2, indexing="ij")
    mesh = triangulate(grid_mesh(np.stack([x, y, x * y], axis=-1)), alternate=alternate)
    with pytest.raises(DegenerateError, match="minimise_area_along_normals"):
        minimise_area(mesh)
    found = minimise_area_along_normals(mesh)
    assert found.status == "converged"
    assert len(found.areas) < 15
    assert (np.diff(found.areas) <= 0).all()
    inner = ~mesh.boundary_vertex
    normal = np.einsum("vx,vx->v", area_gradient(found.mesh), found.mesh.vertex_normals)
    assert np.abs(normal[inner]).max() < 1e-10 * mesh.edge_lengths.max()
    np.testing.assert_array_equal(found.mesh.vertices[~inner], mesh.vertices[~inner])
    assert found.mesh.face_areas.min() > 0.7 * found.mesh.face_areas.mean()
    # It is a minimum: other normal moves have more area.
    rng = np.random.default_rng(1)
    for _ in range(3):
        move = 1e-3 * rng.standard_normal(mesh.n_vertices) * inner
        other = found.mesh.vertices + move[:, None] * found.mesh.vertex_normals
        assert mesh.with_vertices(other).face_areas.sum() > found.areas[-1]


@pytest.mark.parametrize("bump", [0.0, 0.3])
def test_scherks_surface_is_reached_with_order_two(bump: float) -> None:
    errors = []
    for cells in (8, 16, 32):
        x, y, z = minimise_area_along_normals(graph(cells, bump)).mesh.vertices.T
        errors.append(np.abs(z - scherk(x, y)).max())
    assert errors[-1] < 4e-5
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert (orders > 1.85).all()


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_scale_does_not_matter(scale: float) -> None:
    mesh = graph(6, 0.2)
    one, other = (minimise_area_along_normals(m) for m in (mesh, mesh.scaled(scale)))
    np.testing.assert_allclose(other.mesh.vertices, scale * one.mesh.vertices, atol=1e-9 * scale)


def test_refusals() -> None:
    mesh = graph(6, 0.3)
    stopped = minimise_area_along_normals(mesh, max_steps=4, throw=False)
    assert stopped.status == "stopped"
    assert stopped.mesh.face_areas.sum() < mesh.face_areas.sum()
    with pytest.raises(DegenerateError, match=r"after \d steps: gradient .* at vertex \d+"):
        minimise_area_along_normals(mesh, max_steps=4)
    with pytest.raises(MeshError, match="a triangle mesh is needed"):
        minimise_area_along_normals(grid_mesh(mesh.vertices.reshape(7, 7, 3)))
    with pytest.raises(MeshError, match="no vertex is fixed"):
        minimise_area_along_normals(mesh, np.zeros(mesh.n_vertices, dtype=bool))
    held = minimise_area_along_normals(mesh, np.ones(mesh.n_vertices, dtype=bool))
    np.testing.assert_array_equal(held.mesh.vertices, mesh.vertices)

"""Least area: the Hessian, Plateau's problem, convergence to smooth surfaces, refusals."""

from __future__ import annotations

import re

import numpy as np
import pytest
from similarity_cases import SIMILARITIES, Similarity

from ddgfab.curvature import (
    area_gradient,
    area_hessian,
    associated_family,
    minimize_area,
    minimize_area_along_normals,
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


def bilinear(corners: list[tuple[float, float, float]], cells: int, alternate: bool) -> Mesh:
    """Triangles over a bilinear patch: the start of Plateau's problem for a skew quadrilateral."""
    u, v = np.meshgrid(*[np.linspace(0, 1, cells + 1)] * 2, indexing="ij")
    p = np.array(corners, dtype=np.float64)
    weights = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v], axis=-1)
    return triangulate(grid_mesh(weights @ p), alternate=alternate)


TETRAHEDRON = [(1.0, 1.0, 1.0), (1.0, -1.0, -1.0), (-1.0, -1.0, 1.0), (-1.0, 1.0, -1.0)]
SADDLE = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 1.0), (0.0, 1.0, 0.0)]
UNEVEN = [(0.0, 0.0, 0.0), (2.0, 0.0, 0.3), (1.5, 1.0, 1.0), (0.0, 1.0, -0.4)]


@pytest.mark.parametrize("alternate", [False, True])
@pytest.mark.parametrize("corners", [TETRAHEDRON, SADDLE, UNEVEN])
def test_skew_quadrilaterals_become_stationary(
    corners: list[tuple[float, float, float]], alternate: bool
) -> None:
    """All of the gradient vanishes; the conjugate surface closes, which is a second route."""
    mesh = bilinear(corners, 6, alternate)
    found = minimize_area(mesh)
    assert found.status == "converged"
    assert len(found.areas) < 45
    assert (np.diff(found.areas) <= 1e-14).all()
    inner = ~mesh.boundary_vertex
    gradient = area_gradient(found.mesh)[inner]
    assert np.linalg.norm(gradient, axis=1).max() <= 1e-10 * mesh.edge_lengths.max()
    np.testing.assert_array_equal(found.mesh.vertices[~inner], mesh.vertices[~inner])
    assert associated_family(found.mesh).closing < 1e-10
    # It is a minimum: other moves have more area, along the normals or in the surface.
    rng = np.random.default_rng(1)
    for _ in range(3):
        move = 1e-3 * rng.standard_normal(mesh.vertices.shape) * inner[:, None]
        assert mesh.with_vertices(found.mesh.vertices + move).face_areas.sum() > found.areas[-1]


def test_plateau_keeps_the_half_turn_of_the_start() -> None:
    """(x, y, z) -> (-x, -y, z) maps the quadrilateral and its diagonals to themselves."""
    for cells in (4, 6):
        x = minimize_area(bilinear(TETRAHEDRON, cells, False)).mesh.vertices
        np.testing.assert_allclose(x[::-1], x * [-1, -1, 1], atol=1e-9)


def test_triangles_that_collapse_are_named() -> None:
    mesh = bilinear(SADDLE, 8, False)
    with pytest.raises(DegenerateError, match="minimize_area_along_normals") as error:
        minimize_area(mesh)
    triangle, *corners = (
        int(n) for n in re.findall(r"\d+", str(error.value).partition(" collapses")[0])
    )
    assert mesh.faces[triangle].tolist() == corners
    assert minimize_area(bilinear(SADDLE, 8, True)).status == "converged"


@pytest.mark.parametrize("alternate", [False, True])
def test_along_normals_says_that_the_rest_of_the_gradient_stays(alternate: bool) -> None:
    mesh = bilinear(SADDLE, 8, alternate)
    found = minimize_area_along_normals(mesh)
    assert found.status == "normal"
    assert len(found.areas) < 15
    assert (np.diff(found.areas) <= 1e-14).all()
    inner = ~mesh.boundary_vertex
    gradient = area_gradient(found.mesh)
    normal = np.einsum("vx,vx->v", gradient, found.mesh.vertex_normals)
    limit = 1e-10 * mesh.edge_lengths.max()
    assert np.abs(normal[inner]).max() == pytest.approx(found.normal_gradients[-1])
    assert found.normal_gradients[-1] <= limit
    whole = np.linalg.norm(gradient[inner], axis=1).max()
    assert whole == pytest.approx(found.gradients[-1])
    assert whole > 1e-4
    np.testing.assert_array_equal(found.mesh.vertices[~inner], mesh.vertices[~inner])
    assert found.mesh.face_areas.min() > 0.7 * found.mesh.face_areas.mean()
    # It is a minimum: other normal moves have more area.
    rng = np.random.default_rng(1)
    for _ in range(3):
        move = 1e-3 * rng.standard_normal(mesh.n_vertices) * inner
        other = found.mesh.vertices + move[:, None] * found.mesh.vertex_normals
        assert mesh.with_vertices(other).face_areas.sum() > found.areas[-1]
    # Its conjugate closes only roughly, which has to be asked for.
    with pytest.raises(DegenerateError, match="minimize_area first"):
        associated_family(found.mesh)
    assert 1e-6 < associated_family(found.mesh, tolerance=0.1).closing < 0.1


def test_along_normals_converges_where_all_of_the_gradient_vanishes() -> None:
    flat = graph(5, 0.0)
    flat = flat.with_vertices(flat.vertices * [1, 1, 0])
    bumped = flat.with_vertices(
        flat.vertices + np.where(flat.boundary_vertex, 0.0, 0.05)[:, None] * [0, 0, 1]
    )
    assert minimize_area_along_normals(flat).status == "converged"
    assert minimize_area(bumped).status == "converged"


@pytest.mark.parametrize("at", SIMILARITIES, ids=lambda at: at.name)
def test_least_area_commutes_with_similarities(at: Similarity) -> None:
    mesh = bilinear(UNEVEN, 4, False)
    plain = minimize_area(mesh, tolerance=1e-9).mesh.vertices
    image = at.mesh(mesh)
    found = minimize_area(image, tolerance=max(1e-9, 10 * at.rounding))
    assert found.status == "converged"
    size = max(1e-8, 1e4 * at.rounding) * at.scale
    np.testing.assert_allclose(found.mesh.vertices, at(plain), atol=size, rtol=0)


@pytest.mark.parametrize("bump", [0.0, 0.3])
def test_scherks_surface_is_reached_with_order_two(bump: float) -> None:
    errors = []
    for cells in (8, 16, 32):
        x, y, z = minimize_area_along_normals(graph(cells, bump)).mesh.vertices.T
        errors.append(np.abs(z - scherk(x, y)).max())
    assert errors[-1] < 4e-5
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert (orders > 1.85).all()


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_scale_does_not_matter(scale: float) -> None:
    mesh = graph(6, 0.2)
    one, other = (minimize_area_along_normals(m) for m in (mesh, mesh.scaled(scale)))
    np.testing.assert_allclose(other.mesh.vertices, scale * one.mesh.vertices, atol=1e-9 * scale)


def test_refusals() -> None:
    mesh = graph(6, 0.3)
    stopped = minimize_area_along_normals(mesh, max_steps=4, throw=False)
    assert stopped.status == "stopped"
    assert stopped.mesh.face_areas.sum() < mesh.face_areas.sum()
    with pytest.raises(DegenerateError, match=r"after \d steps: gradient .* at vertex \d+"):
        minimize_area_along_normals(mesh, max_steps=4)
    with pytest.raises(MeshError, match="a triangle mesh is needed"):
        minimize_area_along_normals(grid_mesh(mesh.vertices.reshape(7, 7, 3)))
    with pytest.raises(MeshError, match="no vertex is fixed"):
        minimize_area_along_normals(mesh, np.zeros(mesh.n_vertices, dtype=bool))
    held = minimize_area_along_normals(mesh, np.ones(mesh.n_vertices, dtype=bool))
    np.testing.assert_array_equal(held.mesh.vertices, mesh.vertices)

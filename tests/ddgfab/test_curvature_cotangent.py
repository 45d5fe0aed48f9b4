"""Area, its gradient and its minimisation on triangle meshes: mathematics.md 8.4."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab import Mesh
from ddgfab.curvature import (
    angle_defects,
    area_gradient,
    area_hessian,
    associated_family,
    cotangent_laplacian,
    cotangent_mean_curvature,
    mean_curvature_vectors,
    minimize_area,
    mixed_vertex_areas,
    triangulate,
)
from ddgfab.errors import DegenerateError, MeshError
from ddgfab.grid import grid_mesh

K_GON, NECK, STEP = 8, 1.0, 0.3
"""The discrete catenoid of mathematics.md 8.4: r cosh(a z / r), rings STEP apart."""


def catenoid_radii(z: np.ndarray) -> np.ndarray:
    a = NECK / STEP * np.arccosh(1 + STEP**2 / (NECK**2 * (1 + np.cos(2 * np.pi / K_GON))))
    return NECK * np.cosh(a * z / NECK)


def rings(radii: np.ndarray, z: np.ndarray, n: int = K_GON, closed: bool = True) -> Mesh:
    angle = 2 * np.pi * np.arange(n) / n
    net = np.stack(
        [
            np.cos(angle)[:, None] * radii,
            np.sin(angle)[:, None] * radii,
            np.broadcast_to(z, (n, len(z))),
        ],
        axis=-1,
    )
    return triangulate(grid_mesh(net, closed=(closed, False)))


def random_patch(seed: int = 0) -> Mesh:
    u, v = np.meshgrid(np.arange(5.0), np.arange(6.0), indexing="ij")
    x = np.stack([u, v, 0.2 * u * v], axis=-1)
    x += 0.1 * np.random.default_rng(seed).standard_normal(x.shape)
    return triangulate(grid_mesh(x))


def test_gradient_against_central_differences() -> None:
    mesh = random_patch()
    gradient, step = area_gradient(mesh), 1e-5
    for vertex in (0, 7, 13, 29):
        for axis in range(3):
            areas = []
            for sign in (1, -1):
                moved = mesh.vertices.copy()
                moved[vertex, axis] += sign * step
                areas.append(mesh.with_vertices(moved).face_areas.sum())
            assert gradient[vertex, axis] == pytest.approx(
                (areas[0] - areas[1]) / (2 * step), abs=1e-9
            )


def test_laplacian_is_symmetric_and_kills_constants_and_flat_coordinates() -> None:
    mesh = random_patch()
    laplacian = cotangent_laplacian(mesh)
    assert abs(laplacian - laplacian.T).max() < 1e-14
    assert np.abs(laplacian @ np.ones(mesh.n_vertices)).max() < 1e-12
    plane = mesh.with_vertices(mesh.vertices * [1, 1, 0])
    inner = ~plane.boundary_vertex
    assert np.abs(area_gradient(plane)[inner]).max() < 1e-12
    # Half the Dirichlet energy of the embedding is its area.
    x = mesh.vertices
    assert 0.5 * (x * (laplacian @ x)).sum() == pytest.approx(mesh.face_areas.sum(), rel=1e-12)


def test_discrete_catenoid_is_exactly_critical() -> None:
    z = STEP * np.arange(-2, 3)
    radii = catenoid_radii(z)
    np.testing.assert_allclose(
        radii, [1.21644208, 1.05272078, 1, 1.05272078, 1.21644208], atol=5e-9
    )
    mesh = rings(radii, z)
    assert mesh.face_areas.sum() == pytest.approx(8.48799228, abs=5e-9)
    inner = ~mesh.boundary_vertex
    assert np.abs(area_gradient(mesh)[inner]).max() < 1e-14


def test_catenoids_are_stable_up_to_one_and_a_fifth_radii() -> None:
    """mathematics.md 8.4: critical all the same, rings beyond |z| = 1.2 r are no minimum any
    more."""
    for count, stable in ((2, True), (3, True), (5, False), (6, False)):
        z = STEP * np.arange(-count, count + 1)
        mesh = rings(catenoid_radii(z), z)
        inner = ~mesh.boundary_vertex
        assert np.abs(area_gradient(mesh)[inner]).max() < 1e-14
        free = np.repeat(inner, 3)
        least = np.linalg.eigvalsh(area_hessian(mesh).toarray()[np.ix_(free, free)])[0]
        assert (least > 0.01) if stable else (least < -0.1)


def test_iteration_finds_the_discrete_catenoid() -> None:
    z = STEP * np.arange(-2, 3)
    radii = catenoid_radii(z)
    bulged = rings(radii * np.where(np.abs(z) < 0.5, 1.1, 1.0), z)
    found = minimize_area(bulged)
    assert found.status == "converged"
    assert (np.diff(found.areas) <= 1e-12).all()
    np.testing.assert_allclose(found.mesh.vertices, rings(radii, z).vertices, atol=1e-8)
    assert found.areas[-1] == pytest.approx(8.48799228, abs=5e-9)


def test_flat_boundary_gives_the_flat_disc() -> None:
    mesh = random_patch()
    rim = mesh.boundary_vertex
    flat = mesh.vertices * np.where(rim[:, None], [1, 1, 0], [1, 1, 1])
    found = minimize_area(mesh.with_vertices(flat))
    assert np.abs(found.mesh.vertices[:, 2]).max() < 1e-9


def test_family_of_the_catenoid_strip_is_isometric() -> None:
    z = STEP * np.arange(-2, 3)
    whole = rings(catenoid_radii(z), z)
    cut = Mesh.build(whole.vertices, whole.faces[: 2 * 5 * 4])  # five of eight segments: a disc
    family = associated_family(cut)
    assert family.closing < 1e-13
    ids = family.triangles
    first = family.points[ids] - family.points[np.roll(ids, -1, axis=1)]
    wanted = np.linalg.norm(first, axis=-1)
    for angle in (0.3, 1.0, np.pi / 2):
        points = family.at(angle)
        sides = points[ids] - points[np.roll(ids, -1, axis=1)]
        np.testing.assert_allclose(np.linalg.norm(sides, axis=-1), wanted, rtol=1e-12)
    # The conjugate of a catenoid is a helicoid: what was a parallel runs along the axis, so
    # the height grows by the same amount from segment to segment.
    waist = np.abs(cut.vertices[:, 2]) < STEP / 2
    ring_edges = np.flatnonzero(waist[cut.edges].all(axis=1))
    heights = np.sort(family.conjugate[ring_edges, 2])
    steps = np.diff(heights)
    np.testing.assert_allclose(steps, steps[0], rtol=1e-10)
    assert abs(steps[0]) > 0.1


def test_curvature_of_meshes_inscribed_in_a_sphere_is_exact() -> None:
    """Without obtuse triangles <x_i, grad_i A> = 1/4 sum (cot + cot)|x_i - x_j|^2 = 2 A_i."""
    u = np.linspace(-0.5, 0.5, 11)
    first, second = np.meshgrid(u, u, indexing="ij")
    plane = first - 0.5 * second, 0.75**0.5 * second  # sheared towards equilateral triangles
    grid = np.stack([*plane, np.full_like(first, 2.0)], axis=-1)
    mesh = triangulate(grid_mesh(2 * grid / np.linalg.norm(grid, axis=-1, keepdims=True)))
    inner = ~mesh.boundary_vertex
    vectors = mean_curvature_vectors(mesh)
    outward = np.einsum("vi,vi->v", vectors, mesh.vertices)[inner]
    np.testing.assert_allclose(outward, 2.0, rtol=1e-12)
    h = cotangent_mean_curvature(mesh)
    assert np.isnan(h[~inner]).all()
    np.testing.assert_allclose(h[inner], -0.5, rtol=1e-6)  # measured along the vertex normals


def test_mixed_areas_add_up() -> None:
    mesh = random_patch()
    areas = mixed_vertex_areas(mesh)
    assert areas.sum() == pytest.approx(mesh.face_areas.sum(), rel=1e-12)
    assert (areas > 0).all()


def test_angle_defects_obey_gauss_and_bonnet() -> None:
    assert angle_defects(random_patch()).sum() == pytest.approx(2 * np.pi, abs=1e-10)
    assert angle_defects(rings(np.ones(4), np.arange(4.0))).sum() == pytest.approx(0, abs=1e-10)


def test_refusals() -> None:
    quads = grid_mesh(
        np.stack([*np.meshgrid([0.0, 1], [0.0, 1], indexing="ij"), np.eye(2)], axis=-1)
    )
    with pytest.raises(MeshError, match=r"face 0 has 4 corners.*triangulate"):
        area_gradient(quads)
    flat = Mesh.build([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    with pytest.raises(DegenerateError, match=r"triangle 0 \(0, 1, 2\) has area 0"):
        cotangent_laplacian(flat)
    patch = random_patch()
    with pytest.raises(MeshError, match="no vertex is fixed in the component of face 0"):
        minimize_area(patch, np.zeros(patch.n_vertices, dtype=bool))
    with pytest.raises(MeshError, match="flags are needed"):
        minimize_area(patch, [True])
    with pytest.raises(DegenerateError, match=r"after 1 steps: gradient .* at vertex"):
        minimize_area(patch, max_steps=1)
    assert minimize_area(patch, max_steps=1, throw=False).status == "stopped"
    with pytest.raises(DegenerateError, match="minimize_area first"):
        associated_family(patch)
    with pytest.raises(MeshError, match="Euler characteristic 0"):
        associated_family(rings(np.ones(4), np.arange(4.0)))
    tall = 0.8 * np.arange(-2, 3)
    with pytest.raises(
        DegenerateError, match=r"triangle \d+ \(\d+, \d+, \d+\) collapses: after \d+ steps"
    ):
        minimize_area(rings(np.ones(5), tall))

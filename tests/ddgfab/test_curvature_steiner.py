"""Curvatures from parallel Gauss images: mathematics.md 8.2."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab import Mesh
from ddgfab.curvature import steiner_curvatures
from ddgfab.errors import DegenerateError, MeshError
from ddgfab.forms import generate, rotational_net
from ddgfab.grid import grid_mesh
from ddgfab.measures import oriented_areas
from ddgfab.nets import vertex_normals
from ddgfab.transforms import christoffel_dual


def ring(radii: list[float], heights: list[float], n: int = 12) -> Mesh:
    net = rotational_net(np.column_stack([radii, heights]), np.linspace(0, 2 * np.pi, n + 1)[:5])
    return grid_mesh(net)


def test_sphere_of_radius_two_and_a_half() -> None:
    """A net inscribed in a sphere, sigma = x / 2.5: H = -0.4, K = 0.16, exactly."""
    angle = np.linspace(0.3, 1.2, 6)
    mesh = ring(list(2.5 * np.cos(angle)), list(2.5 * np.sin(angle)))
    found = steiner_curvatures(mesh, mesh.vertices / 2.5)
    np.testing.assert_allclose(found.mean, -0.4, rtol=1e-12)
    np.testing.assert_allclose(found.gauss, 0.16, rtol=1e-12)
    np.testing.assert_allclose(found.principal, [[-0.4] * mesh.n_faces] * 2, atol=1e-7)


@pytest.mark.parametrize("scale", [1e-12, 1e-6, 1e6, 1e12])
def test_no_digits_are_lost_between_sizes(scale: float) -> None:
    """A net on a sphere of radius 2.5 scale about a far center: H = -0.4 / scale."""
    angle = np.linspace(0.3, 1.2, 6)
    mesh = ring(list(2.5 * np.cos(angle)), list(2.5 * np.sin(angle)))
    far = mesh.with_vertices(scale * (mesh.vertices + 7.0))
    found = steiner_curvatures(far, mesh.vertices / 2.5)
    assert found.mean * scale == pytest.approx(-0.4, abs=1e-11)
    assert found.gauss * scale**2 == pytest.approx(0.16, abs=1e-11)


def test_cylinder_of_radius_two() -> None:
    mesh = ring([2.0, 2.0, 2.0], [0.0, 1.0, 2.5])
    sigma = mesh.vertices * [0.5, 0.5, 0.0]
    found = steiner_curvatures(mesh, sigma)
    np.testing.assert_allclose(found.mean, -0.25, rtol=1e-12)
    np.testing.assert_allclose(found.gauss, 0.0, atol=1e-12)


def test_steiners_polynomial() -> None:
    """A second route: areas of three offsets of a circular net give H and K by interpolation."""
    mesh = generate("circular")
    from ddgfab import Net

    net = np.asarray(Net.from_mesh(mesh))
    patch = grid_mesh(net)
    normals = vertex_normals(net, np.array([0.0, 0.0, 1.0])).reshape(-1, 3)
    found = steiner_curvatures(patch, normals)
    t = 100.0
    here, up, down = (oriented_areas(patch, patch.vertices + d * normals) for d in (0.0, t, -t))
    np.testing.assert_allclose(found.mean, -(up - down) / (4 * t * here), rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(
        found.gauss, (up + down - 2 * here) / (2 * t**2 * here), rtol=1e-4, atol=1e-12
    )


def test_christoffel_dual_of_a_sphere_is_minimal() -> None:
    """The dual has H = 0 with the sphere as its Gauss image (mathematics.md 6.2, 7.6)."""
    alpha = np.pi / 10
    length = np.arcsinh(np.tan(alpha))
    i = 2.0 * np.arange(-2, 3)
    meridian = np.column_stack([1 / np.cosh(i * length), np.tanh(i * length)])
    net = rotational_net(meridian, 2 * alpha * np.arange(6))
    sphere = net / np.linalg.norm(net, axis=-1, keepdims=True)
    dual = christoffel_dual(sphere)
    mesh = grid_mesh(dual)
    found = steiner_curvatures(mesh, sphere.reshape(-1, 3))
    assert np.abs(found.mean).max() < 1e-12
    assert (found.gauss < 0).all()


def test_refusals() -> None:
    mesh = ring([2.0, 2.0, 1.5], [0.0, 1.0, 2.5])
    with pytest.raises(MeshError, match="Gauss image has shape"):
        steiner_curvatures(mesh, mesh.vertices[1:])
    bent = mesh.vertices.copy()
    bent[4] += [0.1, 0, 0.2]
    with pytest.raises(MeshError, match=r"not parallel: its edge \d+ \(\d+-\d+\).*sine"):
        steiner_curvatures(mesh, bent)
    flat = Mesh.build([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 0, 0]], [[0, 1, 2, 3]])
    with pytest.raises(DegenerateError, match="face 0 has area 0"):
        steiner_curvatures(flat, flat.vertices)

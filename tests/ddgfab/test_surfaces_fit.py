"""Spline surfaces fitted to meshes: directions with and without noise, refusals."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree
from surface_cases import ellipsoid_cap

from ddgfab.errors import DegenerateError, MeshError
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Mesh
from ddgfab.surfaces.fit import fit_mesh
from ddgfab.surfaces.principal import lifted, principal
from ddgfab.trace import network_mesh, place
from ddgfab.trace.field import PrincipalField


def cap_mesh(count: int, noise: float) -> tuple[Mesh, np.ndarray]:
    """A triangle mesh of an ellipsoid cap with noise [part of its size], its parameters."""
    rng = np.random.default_rng(5)
    side = int(np.sqrt(count))
    u, v = np.meshgrid(np.linspace(-1, 1, side), np.linspace(-1, 1, side - 3), indexing="ij")
    jitter = rng.uniform(-0.3, 0.3, (2, *u.shape)) / side
    jitter[:, [0, -1]] = 0
    jitter[:, :, [0, -1]] = 0
    uv = np.stack([u + jitter[0], v + jitter[1]], axis=-1).reshape(-1, 2) * [0.62, 0.55]
    exact = ellipsoid_cap((90, 80)).points(uv)
    noisy = exact + noise * 4 * rng.normal(size=exact.shape)
    quads = grid_mesh(np.zeros((*u.shape, 3))).faces
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return Mesh.build(noisy, triangles), uv


def direction_errors(count: int, noise: float) -> np.ndarray:
    """Angles [deg] between the principal directions of the cap and of the fit, inside."""
    mesh, uv = cap_mesh(count, noise)
    surface = fit_mesh(mesh).surface
    keep = np.flatnonzero((np.abs(uv) < [0.5, 0.44]).all(axis=1))
    true = ellipsoid_cap((90, 80)).jets(uv[keep])
    exact = lifted(true, principal(true).first)
    # the fit's parameters of these points: nearest of a fine grid, then projection is enough
    u0, u1, v0, v1 = surface.trim.box
    grid = np.stack(
        np.meshgrid(np.linspace(u0, u1, 250), np.linspace(v0, v1, 250), indexing="ij"), axis=-1
    ).reshape(-1, 2)
    where = grid[cKDTree(surface.points(grid)).query(true.x)[1]]
    jets = surface.jets(where)
    found = principal(jets)
    side = [lifted(jets, d) for d in (found.first, found.second)]
    cos = np.max([np.abs(np.einsum("nx,nx->n", exact, d)) for d in side], axis=0)
    return np.degrees(np.arccos(np.clip(cos, -1, 1)))


def test_directions_without_noise_and_with() -> None:
    clean = direction_errors(2500, 0.0)
    assert clean.mean() < 0.2  # the grid of the comparison
    noisy = direction_errors(2500, 1e-4)
    assert noisy.mean() < 3.0


def test_residual_measures_the_noise() -> None:
    mesh, _ = cap_mesh(1500, 1e-3)
    found = fit_mesh(mesh)
    assert found.rms == pytest.approx(4e-3, rel=0.2)  # movement in the plan is a parameter
    assert fit_mesh(cap_mesh(1500, 0.0)[0]).rms < 1e-6


def test_a_net_is_traced_on_the_fit() -> None:
    mesh, _ = cap_mesh(1500, 1e-4)
    found = network_mesh(place(PrincipalField(fit_mesh(mesh).surface), (0.3, 0.3)))
    x, y, z = found.mesh.vertices.T
    assert np.abs(x**2 / 9 + y**2 / 4 + z**2 - 1).max() < 5e-3
    assert found.area_error < 1e-10


def test_refusals() -> None:
    u, v = np.meshgrid(np.linspace(0, 2, 40), np.linspace(0, 2, 40), indexing="ij")
    rng = np.random.default_rng(3)
    crease = grid_mesh(np.stack([u, v, np.abs(u - 1) + np.abs(v - 1)], axis=-1))
    with pytest.raises(DegenerateError, match="creases"):
        fit_mesh(grid_mesh(np.stack([u, v, rng.uniform(0, 0.8, u.shape)], axis=-1)))
    assert fit_mesh(crease).rms > 0
    ring = [face for k, face in enumerate(crease.faces) if k != 60]
    with pytest.raises(MeshError, match="2 rims"):
        fit_mesh(Mesh.build(crease.vertices, ring))


def test_a_tube_is_spread_with_a_warning() -> None:
    turn, along = np.meshgrid(np.linspace(0, 1.6 * np.pi, 40), np.linspace(0, 2, 30), indexing="ij")
    bend = 1 + 0.1 * along * (2 - along)
    tube = grid_mesh(np.stack([bend * np.cos(turn), bend * np.sin(turn), along], axis=-1))
    found = fit_mesh(tube)
    assert "upside down in plan" in found.warning
    assert "spread over a rectangle" in found.warning
    x, y, z = found.surface.points(found.surface.trim.loops[0]).T
    assert np.abs(np.hypot(x, y) - 1 - 0.1 * z * (2 - z)).max() < 1e-5


def test_triangles_without_four_corners_are_spread_over_a_circle() -> None:
    turn, along = np.meshgrid(np.linspace(0, 1.4 * np.pi, 50), np.linspace(0, 4, 45), indexing="ij")
    tube = grid_mesh(np.stack([np.cos(turn), np.sin(turn), along], axis=-1))
    found = fit_mesh(
        Mesh.build(tube.vertices, [t for a, b, c, d in tube.faces for t in ((a, b, c), (a, c, d))])
    )
    assert "spread over a circle" in found.warning
    x, y, _ = found.surface.points(0.8 * found.surface.trim.loops[0]).T
    assert np.abs(np.hypot(x, y) - 1).max() < 5e-3


def test_a_smoother_surface_is_further_away() -> None:
    mesh, _ = cap_mesh(1500, 1e-4)
    near, smooth = fit_mesh(mesh), fit_mesh(mesh, smooth=2e-3)
    assert smooth.smoothness > near.smoothness
    assert near.rms < smooth.rms < 2e-3 * mesh.diameter

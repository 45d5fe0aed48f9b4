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
from ddgfab.surfaces.nearest import nearest_points
from ddgfab.surfaces.principal import lifted, principal
from ddgfab.trace import trace


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
    jets = surface.jets(nearest_points(surface, true.x).uv)
    found = principal(jets)
    side = [lifted(jets, d) for d in (found.first, found.second)]
    cos = np.max([np.abs(np.einsum("nx,nx->n", exact, d)) for d in side], axis=0)
    return np.degrees(np.arccos(np.clip(cos, -1, 1)))


def ring_errors(count: int, noise: float) -> np.ndarray:
    """The same of quadratic patches through the vertices of two rings: what is done elsewhere."""
    mesh, uv = cap_mesh(count, noise)
    near = np.flatnonzero((np.abs(uv) < [0.45, 0.4]).all(axis=1))[::23]
    true = ellipsoid_cap((90, 80)).jets(uv[near])
    exact = lifted(true, principal(true).first)
    _, rings = cKDTree(mesh.vertices).query(mesh.vertices[near], k=19)  # a vertex and two rings
    out = []
    for i, ring in zip(near, rings, strict=True):
        normal = mesh.vertex_normals[i]
        axes = np.linalg.svd(normal[None])[2]
        gap = mesh.vertices[ring] - mesh.vertices[i]
        x, y, z = gap @ axes[1], gap @ axes[2], gap @ normal
        rows = np.stack([x**2 / 2, x * y, y**2 / 2, x, y, np.ones_like(x)], axis=1)
        a, b, c = np.linalg.lstsq(rows, z, rcond=None)[0][:3]
        turn = 0.5 * np.arctan2(2 * b, a - c)
        first = np.cos(turn) * axes[1] + np.sin(turn) * axes[2]
        both = np.abs([first @ exact[len(out)], np.cross(normal, first) @ exact[len(out)]])
        out.append(np.degrees(np.arccos(np.clip(both.max(), -1, 1))))
    return np.array(out)


def test_directions_without_noise_and_with() -> None:
    """Mean and 99 % of the errors [deg] at 6000 vertices; the noise is a part of the size."""
    clean = direction_errors(6000, 0.0)
    assert clean.max() < 0.01
    noisy = direction_errors(6000, 1e-4)
    assert noisy.mean() < 1.5
    assert np.percentile(noisy, 99) < 6
    rough = direction_errors(6000, 1e-3)
    assert rough.mean() < 4
    assert np.percentile(rough, 99) < 15
    assert ring_errors(6000, 1e-4).mean() > 8 * noisy.mean()


def test_residual_measures_the_noise() -> None:
    mesh, _ = cap_mesh(1500, 1e-3)
    found = fit_mesh(mesh)
    assert found.rms == pytest.approx(4e-3, rel=0.2)  # movement in the plan is a parameter
    assert fit_mesh(cap_mesh(1500, 0.0)[0]).rms < 1e-6


def test_a_net_is_traced_on_the_fit() -> None:
    mesh, _ = cap_mesh(1500, 1e-4)
    made = trace(fit_mesh(mesh).surface, 0.3)  # false umbilics at the rim: not at any spacing
    assert made.network.spacing[0] == pytest.approx(0.3, rel=0.051)
    found = made.traced
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

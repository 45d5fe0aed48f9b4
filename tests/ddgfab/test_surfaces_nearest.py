"""Nearest points of spline surfaces against points that were moved along the normal."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree
from surface_cases import ellipsoid_cap, graph

from ddgfab.surfaces.nearest import nearest_points
from ddgfab.surfaces.principal import principal


def test_points_along_the_normal_come_back() -> None:
    surface, rng = ellipsoid_cap(), np.random.default_rng(3)
    uv = rng.uniform(-0.85, 0.85, (200, 2))
    jets = surface.jets(uv)
    normal = principal(jets).normal
    for height in (0.0, 0.1, -0.2, 0.5):
        found = nearest_points(surface, jets.x + height * normal)
        assert np.abs(found.uv - uv).max() < 1e-6
        assert np.abs(found.distance - abs(height)).max() < 1e-13


def test_far_points_and_points_beyond_the_sides() -> None:
    surface = graph(lambda x, y: 0.3 * x**2 - 0.4 * y**2 + 0.1 * x * y)
    points = np.random.default_rng(4).uniform(-2, 2, (200, 3))
    found = nearest_points(surface, points)
    side = np.linspace(-1, 1, 501)
    grid = np.stack(np.meshgrid(side, side, indexing="ij"), axis=-1).reshape(-1, 2)
    sampled = cKDTree(surface.points(grid)).query(points)[0]
    assert (found.distance <= sampled + 1e-12).all()
    assert (sampled - found.distance).max() < 2e-3  # half a step of the grid, near the surface
    assert np.abs(found.uv).max() <= 1

"""Meshes without symmetry for the tests of measures."""

from __future__ import annotations

import numpy as np

from ddgfab.mesh import Floats, Mesh


def grid(points: Floats) -> Mesh:
    """Mesh of an (m, n, 3) net."""
    m, n, _ = points.shape
    at = (np.arange(m - 1)[:, None] * n + np.arange(n - 1)).ravel()
    return Mesh.build(points.reshape(-1, 3), np.stack([at, at + n, at + n + 1, at + 1], axis=1))


def random_grid(seed: int, m: int = 5, n: int = 6) -> Mesh:
    rng = np.random.default_rng(seed)
    i, j = np.meshgrid(np.arange(m), np.arange(n), indexing="ij")
    return grid(np.stack([i, j, 0 * i], axis=-1) + rng.uniform(-0.2, 0.2, (m, n, 3)))


def mixed() -> Mesh:
    """A pentagon, a ring of skew quads, a ring of triangles: inner valences 3 and 5."""
    t = np.arange(5) * 2 * np.pi / 5
    top = np.stack([np.cos(t), np.sin(t), 1 + 0.1 * np.sin(2 * t)], axis=1)
    middle = np.stack([2 * np.cos(t + 0.2), 2 * np.sin(t + 0.2), 0 * t], axis=1)
    low = np.stack([3 * np.cos(t - 0.4), 3 * np.sin(t - 0.4), 0.3 * np.sin(t) - 1.5], axis=1)
    after = [1, 2, 3, 4, 0]
    faces = [[0, 1, 2, 3, 4]]
    for k, m in enumerate(after):
        faces += [[k, 5 + k, 5 + m, m], [5 + k, 10 + k, 10 + m], [5 + k, 10 + m, 5 + m]]
    return Mesh.build(np.concatenate([top, middle, low]), faces)

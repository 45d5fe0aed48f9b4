"""Meshes that tests of support structures start from."""

from __future__ import annotations

import numpy as np

from ddgfab.grid import grid_mesh
from ddgfab.mesh import Mesh


def planar_net(rows: int = 5, cols: int = 4) -> Mesh:
    """A projective image of a translation surface: planar faces, neither circular nor conical."""
    u, v = np.meshgrid(np.linspace(-1, 1, rows + 1), np.linspace(-1, 1, cols + 1), indexing="ij")
    x = np.stack([u + 0.1 * v, v + 0.2 * u, 1.5 - 0.3 * u**2 - 0.2 * v**2 - 0.1 * u**3], axis=-1)
    return grid_mesh(1000 * x / (1 + 0.15 * x[..., :1] + 0.1 * x[..., 1:2]))

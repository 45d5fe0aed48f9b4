"""Small meshes whose structures are known exactly."""

from __future__ import annotations

import numpy as np

from ddgfab.grid import grid_mesh
from ddgfab.mesh import Mesh


def barrel(rows: int = 3, columns: int = 4, radius: float = 8000.0, angle: float = 0.18) -> Mesh:
    """A piece of a cylinder [mm]: planar faces, circular and conical, axes known exactly."""
    turn = angle * (np.arange(columns + 1) - columns / 2)
    along = 1500.0 * np.arange(rows + 1)
    points = np.empty((rows + 1, columns + 1, 3))
    points[..., 0] = along[:, None]
    points[..., 1] = -radius * np.sin(turn)
    points[..., 2] = radius * np.cos(turn)
    mesh = grid_mesh(points)
    upward = mesh.face_normals[:, 2].mean() > 0
    return mesh if upward else grid_mesh(points[:, ::-1])

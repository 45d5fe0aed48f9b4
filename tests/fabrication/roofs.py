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


def hexagons(radius: float = 9000.0, side: float = 900.0) -> Mesh:
    """Seven hexagons in planes that touch a paraboloid [mm]: planar faces, three at each vertex.

    Planes that touch it at three points meet over the middle of the circle through the points.
    """
    middle = [(0.0, 0.0)]
    middle += [
        (np.sqrt(3) * side * np.cos(a), np.sqrt(3) * side * np.sin(a))
        for a in np.pi * np.arange(6) / 3
    ]
    index: dict[tuple[int, int], int] = {}
    points, faces = [], []
    for x, y in middle:
        face = []
        for a in np.pi * (np.arange(6) / 3 + 1 / 6):
            u, v = x + side * np.cos(a), y + side * np.sin(a)
            key = (round(u), round(v))
            if key not in index:
                index[key] = len(points)
                z = (-x * (u - x) - y * (v - y) - (x**2 + y**2) / 2) / radius
                points.append((u, v, z))
            face.append(index[key])
        faces.append(face)
    return Mesh.build(np.array(points), faces)

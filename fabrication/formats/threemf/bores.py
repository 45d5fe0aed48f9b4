"""Which triangles of a printed part are the walls of its bores: support there spoils the fit."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from fabrication.boundary import Boundary
from fabrication.specs import TriangleMesh

ON_WALL: Final = 1e-6
"""Vertices are on the wall of a bore within this [mm]: meshes take them from the exact surface."""

ALONG: Final = 0.5
"""Greatest cosine between a wall's normal and the axis: 0 for walls, 1 for the ends of holes."""

NO_AREA: Final = 1e-300
"""Keeps the normal of a triangle without area finite."""


def bore_walls(boundary: Boundary, mesh: TriangleMesh) -> NDArray[np.bool_]:
    """(m,) whether a triangle of the boundary's mesh is part of the wall of a round hole.

    A hole is a cylinder face that looks towards its axis. A triangle belongs to it where its three
    corners lie on the cylinder, no further along the axis than the face goes.
    """
    a, b, c = mesh.vertices[mesh.triangles].transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), NO_AREA)
    found = np.zeros(len(mesh.triangles), dtype=np.bool_)
    start = boundary.edge_points(np.array([0.0, 1.0]))[boundary.coedge_edge]
    for face in np.flatnonzero(boundary.face_cylinder & (boundary.face_sign < 0.0)):
        origin, axis = boundary.face_origin[face], boundary.face_axis[face]
        ends = (start[boundary.coedge_face == face] - origin) @ axis
        away = mesh.vertices - origin
        along = away @ axis
        radius = np.linalg.norm(away - along[:, None] * axis, axis=1)
        on = np.abs(radius - boundary.face_radius[face]) < ON_WALL
        on &= (along > ends.min() - ON_WALL) & (along < ends.max() + ON_WALL)
        # The floor of a blind hole has its corners on the wall's rim too, but faces along the axis.
        found |= on[mesh.triangles].all(axis=1) & (np.abs(normals @ axis) < ALONG)
    return found

"""Nets on a rectangle of Z^2 as meshes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import MeshError
from ddgfab.mesh import Mesh


@checked
def grid_mesh(points: ArrayLike, closed: tuple[bool, bool] = (False, False)) -> Mesh:
    """Quad mesh of a net.

    Vertex (i, j) gets the id i (N + 1) + j. A face runs (i, j), (i+1, j), (i+1, j+1), (i, j+1):
    its normal is on the side of (first direction) x (second direction).

    Parameters
    ----------
    points : (M + 1, N + 1, 3)
    closed : per direction, whether the last line is joined to the first

    Raises
    ------
    MeshError
        Wrong shape, or a closed direction with fewer than three lines.

    Examples
    --------
    >>> import numpy as np
    >>> points = np.dstack([*np.meshgrid([0.0, 1, 2], [0.0, 1], indexing="ij"), np.zeros((3, 2))])
    >>> mesh = grid_mesh(points)
    >>> mesh.n_vertices, mesh.n_faces
    (6, 2)
    """
    net = np.asarray(points, dtype=np.float64)
    if net.ndim != 3 or net.shape[2] != 3 or min(net.shape[:2]) < 2:
        raise MeshError(f"a net has shape (M + 1, N + 1, 3) with M, N > 0; this one {net.shape}")
    for axis in (0, 1):
        if closed[axis] and net.shape[axis] < 3:
            raise MeshError(f"direction {axis} is closed but has {net.shape[axis]} lines; 3 needed")
    ids = np.arange(net.shape[0] * net.shape[1]).reshape(net.shape[:2])
    for axis in (0, 1):
        if closed[axis]:
            ids = np.concatenate([ids, ids.take([0], axis=axis)], axis=axis)
    faces = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], axis=-1)
    return Mesh.build(net.reshape(-1, 3), faces.reshape(-1, 4))

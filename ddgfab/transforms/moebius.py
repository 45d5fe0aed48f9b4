"""Moebius transformations: inversions, which keep circles, spheres and so circular nets."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.errors import DegenerateError
from ddgfab.mesh import Floats
from ddgfab.tolerances import RELATIVE_DEGENERATE


def invert(points: ArrayLike, centre: ArrayLike, radius: float) -> Floats:
    """(..., 3) images of points in the inversion x -> c + R^2 (x - c) / |x - c|^2.

    Orientation is reversed. Lengths at x are multiplied by R^2 / |x - c|^2.

    Raises
    ------
    DegenerateError
        A point in the centre; names its index.
    """
    x = np.asarray(points, dtype=np.float64)
    away = x - np.asarray(centre, dtype=np.float64)
    square = np.sum(away * away, axis=-1, keepdims=True)
    at = np.argwhere(square[..., 0] <= (RELATIVE_DEGENERATE * radius) ** 2)
    if len(at):
        raise DegenerateError(f"point {tuple(at[0].tolist())} lies in the centre of the inversion")
    return np.asarray(centre + radius**2 * away / square)


def invert_normals(points: ArrayLike, normals: ArrayLike, centre: ArrayLike) -> Floats:
    """(..., 3) unit normals at the images of points: reflected in the plane across x - c.

    Contact elements go to contact elements, so normals by reflection (`circular.vertex_normals`)
    stay such. The side is kept: a normal away from the centre becomes one towards it.
    """
    away = np.asarray(points, dtype=np.float64) - np.asarray(centre, dtype=np.float64)
    n = np.asarray(normals, dtype=np.float64)
    along = np.sum(n * away, axis=-1, keepdims=True) / np.sum(away * away, axis=-1, keepdims=True)
    return np.asarray(n - 2.0 * along * away)

"""Our frame [mm, z up] and that of glTF [m, y up]."""

from __future__ import annotations

from typing import Final

import numpy as np

from ddgfab.mesh import Floats

_METRE: Final = 0.001
_Y_UP: Final = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])


def converted(points: Floats) -> Floats:
    """(n, 3) points."""
    return np.asarray(points @ _Y_UP.T * _METRE)


def converted_normals(normals: Floats) -> Floats:
    """(n, 3) unit vectors."""
    return np.asarray(normals @ _Y_UP.T)


def converted_motion(placements: Floats) -> Floats:
    """(..., 4, 4) placements."""
    result = np.array(placements, dtype=np.float64)
    result[..., :3, :3] = _Y_UP @ result[..., :3, :3] @ _Y_UP.T
    result[..., :3, 3] = result[..., :3, 3] @ _Y_UP.T * _METRE
    return result + 0.0

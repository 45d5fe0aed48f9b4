"""How large the panes of a mesh are: the rectangle along a side that holds each face."""

from __future__ import annotations

from typing import Final

import numpy as np

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.optimize.terms.planarity import polygon_corners


def pane_limit(limit: tuple[float, float]) -> tuple[float, float]:
    """The two lengths, the lesser first.

    Raises
    ------
    InputError
        Lengths that are not positive.
    """
    low, high = sorted(float(v) for v in limit)
    if not (low > 0 and np.isfinite(high)):
        raise InputError(f"max_pane = {limit[0]:g}, {limit[1]:g}: two positive lengths")
    return low, high


@checked
def pane_sizes(mesh: Mesh, limit: tuple[float, float]) -> Floats:
    """(F, 2) lesser and greater length of the rectangle along a side that holds each face.

    Of the rectangles along its sides the one that fits best into the two lengths given.
    """
    low, high = pane_limit(limit)
    found = np.zeros((mesh.n_faces, 2))
    for size in np.unique(mesh.face_sizes).tolist():
        ids, corners = polygon_corners(mesh, size)
        points = mesh.vertices[corners]
        normal = mesh.face_normals[ids]
        sides = unit(np.roll(points, -1, axis=1) - points)
        across = unit(np.cross(normal[:, None], sides))
        along = unit(np.cross(across, normal[:, None]))
        spans = np.sort(
            np.stack([np.ptp(points @ a.transpose(0, 2, 1), axis=1) for a in (along, across)], -1),
            axis=-1,
        )  # (f, k, 2)
        best = np.maximum(spans[..., 0] / low, spans[..., 1] / high).argmin(axis=1)
        found[ids] = spans[np.arange(len(ids)), best]
    return found


FIT: Final = 1e-9
"""Part by which a pane may be too large: rounding."""


def misfit(mesh: Mesh, limit: tuple[float, float]) -> Floats:
    """(F,) by how much faces are larger than a pane: up to 1 they fit."""
    low, high = pane_limit(limit)
    sizes = pane_sizes(mesh, limit)
    return np.maximum(sizes[:, 0] / low, sizes[:, 1] / high)

"""Nearest points of a spline surface: a grid for the first guess, then Gauss-Newton steps."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from ddgfab.arguments import checked
from ddgfab.mesh import Floats
from ddgfab.surfaces.spline import SplineSurface

_SIDE: Final = 48
"""Parameters a side of the grid of first guesses."""
_STEPS: Final = 20
_STILL: Final = 1e-13
"""Steps shorter than this part of the rectangle of parameters end the search."""


class Nearest(NamedTuple):
    """Parameters (n, 2) and points (n, 3) of a surface nearest to given ones, distances (n,)."""

    uv: Floats
    x: Floats
    distance: Floats


@checked
def nearest_points(surface: SplineSurface, points: ArrayLike) -> Nearest:
    """Nearest points of the whole patch, also beyond its trim.

    Parameters
    ----------
    points : (n, 3)
    """
    given = np.asarray(points, dtype=np.float64).reshape(-1, 3)
    u0, u1, v0, v1 = surface.domain
    low, high = np.array([u0, v0]), np.array([u1, v1])
    one, two = np.linspace(u0, u1, _SIDE), np.linspace(v0, v1, _SIDE)
    grid = np.stack(np.meshgrid(one, two, indexing="ij"), axis=-1).reshape(-1, 2)
    uv = grid[cKDTree(surface.points(grid)).query(given)[1]]
    far = np.linalg.norm(surface.points(uv) - given, axis=1)
    damping = np.full(len(given), 1e-12)
    for _ in range(_STEPS):
        jets = surface.jets(uv)
        gap = given - jets.x
        e, f, g = (np.einsum("nx,nx->n", a, b) for a, b in _pairs(jets.u, jets.v))
        # the second derivatives belong to the Hessian where they leave it positive
        h = [-np.einsum("nx,nx->n", gap, part) for part in (jets.uu, jets.uv, jets.vv)]
        whole = (e + h[0] > 0) & ((e + h[0]) * (g + h[2]) - (f + h[1]) ** 2 > 0.01 * e * g)
        a, b, c = (k + np.where(whole, m, 0.0) for k, m in zip((e, f, g), h, strict=True))
        p, q = np.einsum("nx,nx->n", gap, jets.u), np.einsum("nx,nx->n", gap, jets.v)
        # at a side of the rectangle only the way along it is left
        edge = [
            (uv[:, k] <= low[k]) & (r < 0) | (uv[:, k] >= high[k]) & (r > 0)
            for k, r in ((0, p), (1, q))
        ]
        a, c = a * (1 + damping), c * (1 + damping)
        det = np.where(a * c - b**2 > 0, a * c - b**2, np.inf)
        move = np.stack([(c * p - b * q) / det, (a * q - b * p) / det], axis=1)
        move[edge[0], 0], move[edge[1], 1] = 0.0, 0.0
        move[edge[0], 1] = np.where(edge[1], 0.0, q / c)[edge[0]]
        move[edge[1], 0] = np.where(edge[0], 0.0, p / a)[edge[1]]
        new = np.clip(uv + move, low, high)
        reached = np.linalg.norm(surface.points(new) - given, axis=1)
        better = reached <= far
        damping = np.where(better, damping / 10, np.maximum(30 * damping, 1e-3))
        still = np.abs(new - uv).max(axis=1) <= _STILL * (high - low).max()
        uv, far = np.where(better[:, None], new, uv), np.where(better, reached, far)
        if (still | (damping > 1e6)).all():
            break
    x = surface.points(uv)
    return Nearest(uv, x, np.asarray(np.linalg.norm(x - given, axis=1)))


def _pairs(u: Floats, v: Floats) -> tuple[tuple[Floats, Floats], ...]:
    return (u, u), (u, v), (v, v)

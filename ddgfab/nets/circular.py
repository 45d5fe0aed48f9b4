"""Circular nets: every quad has a circumcircle; their normals come by reflection."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.errors import DegenerateError
from ddgfab.mesh import Floats, unit
from ddgfab.tolerances import RELATIVE_DEGENERATE


def circularity(points: ArrayLike) -> Floats:
    """(M, N) distance of the fourth point of each quad from the circle of the others, by radius.

    Zero for all quads: a circular net (maths.md 2.1).

    Parameters
    ----------
    points : (M + 1, N + 1, 3)

    Raises
    ------
    DegenerateError
        Three corners of a quad on a line; names the quad.
    """
    x = np.asarray(points, dtype=np.float64)
    origin = x[:-1, :-1]
    a, b, fourth = x[1:, :-1] - origin, x[:-1, 1:] - origin, x[1:, 1:] - origin
    normal = np.cross(a, b)
    square = np.einsum("ijk,ijk->ij", normal, normal)
    aa, bb = np.einsum("ijk,ijk->ij", a, a), np.einsum("ijk,ijk->ij", b, b)
    flat = np.argwhere(square <= RELATIVE_DEGENERATE**2 * aa * bb)
    if len(flat):
        raise DegenerateError(f"quad {tuple(flat[0].tolist())}: three corners lie on a line")
    centre = bb[..., None] * np.cross(normal, a) + aa[..., None] * np.cross(b, normal)
    centre /= 2.0 * square[..., None]
    radius = np.linalg.norm(centre, axis=-1)
    off_sphere = np.abs(np.linalg.norm(fourth - centre, axis=-1) - radius)
    off_plane = np.abs(np.einsum("ijk,ijk->ij", fourth, normal)) / np.sqrt(square)
    return np.asarray(np.maximum(off_sphere, off_plane) / radius)


def vertex_normals(points: ArrayLike, first: ArrayLike) -> Floats:
    """(M + 1, N + 1, 3) unit normals: each edge's bisector plane reflects one end to the other.

    n_k = n - 2 <n, e> e with unit e = x_k - x. On circular nets the result does not depend on
    the path; ``points + d * normals`` is parallel, circular, and has vertex distance |d|
    (maths.md 2.7). Neighbouring normals and their edge lie in one plane: no torsion.

    Parameters
    ----------
    points : (M + 1, N + 1, 3)
    first : (3,) normal at points[0, 0], free on the sphere
    """
    x = np.asarray(points, dtype=np.float64)
    normals = np.empty_like(x)
    normals[0, 0] = unit(np.asarray(first, dtype=np.float64))
    for i in range(1, len(x)):
        normals[i, 0] = _reflected(normals[i - 1, 0], unit(x[i, 0] - x[i - 1, 0]))
    for j in range(1, x.shape[1]):
        normals[:, j] = _reflected(normals[:, j - 1], unit(x[:, j] - x[:, j - 1]))
    return normals


def _reflected(normal: Floats, along: Floats) -> Floats:
    return np.asarray(normal - 2.0 * np.sum(normal * along, axis=-1, keepdims=True) * along)

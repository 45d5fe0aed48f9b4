"""Curvature of nets of skew quads from their normals, and its exact value on K-nets.

mathematics.md 8.3.

Source: Hoffmann, Sageman-Furnas, Wardetzky, A discrete parametrized surface theory in R^3, 2017.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats, unit
from ddgfab.quads import finite
from ddgfab.tolerances import RELATIVE_DEGENERATE, UNIT_NORMAL


@checked
def skew_curvature(points: ArrayLike, normals: ArrayLike) -> tuple[Floats, Floats]:
    """(M, N) Gauss and mean curvature of each quad of a net with normals at its vertices.

    With N across both diagonals of the normals' quad and the mixed area A(f, g) = 1/4
    [det(f12 - f, g2 - g1, N) + det(g12 - g, f2 - f1, N)]: K = A(n, n) / A(x, x) and
    H = -A(x, n) / A(x, x). A sphere with outward normals has H = -1 / R.

    Parameters
    ----------
    points : (M + 1, N + 1, 3); only the diagonals count, quads may be skew
    normals : (M + 1, N + 1, 3) unit

    Raises
    ------
    InputError
        Arrays of different or wrong shapes, points that are not finite, or normals that are not
        unit; names the vertex.
    DegenerateError
        Parallel diagonals of normals, or a quad without area across N; names the quad.
    """
    x, n = np.asarray(points, dtype=np.float64), np.asarray(normals, dtype=np.float64)
    if x.ndim != 3 or x.shape[2] != 3 or min(x.shape[:2]) < 2 or n.shape != x.shape:
        raise InputError(
            f"points {x.shape} and normals {n.shape}: (M + 1, N + 1, 3) twice is needed"
        )
    finite(x, "points")
    finite(n, "normals")
    length = np.linalg.norm(n, axis=-1)
    bad = np.argwhere(~(np.abs(length - 1.0) <= UNIT_NORMAL))
    if len(bad):
        i, j = bad[0].tolist()
        raise InputError(f"the normal at ({i}, {j}) has length {length[i, j]:.12g}; 1 is needed")
    first, second = n[1:, 1:] - n[:-1, :-1], n[:-1, 1:] - n[1:, :-1]
    across = np.cross(first, second)
    size = np.linalg.norm(across, axis=-1)
    scale = np.linalg.norm(first, axis=-1) * np.linalg.norm(second, axis=-1)
    _refuse(size <= RELATIVE_DEGENERATE * np.maximum(scale, RELATIVE_DEGENERATE), size, "normals")
    across = unit(across)

    def mixed(f: Floats, g: Floats) -> Floats:
        one = np.cross(f[1:, 1:] - f[:-1, :-1], g[:-1, 1:] - g[1:, :-1])
        two = np.cross(g[1:, 1:] - g[:-1, :-1], f[:-1, 1:] - f[1:, :-1])
        return np.asarray(0.25 * np.einsum("ijk,ijk->ij", one + two, across))

    area = mixed(x, x)
    diagonals = np.linalg.norm(x[1:, 1:] - x[:-1, :-1], axis=-1) * np.linalg.norm(
        x[:-1, 1:] - x[1:, :-1], axis=-1
    )
    _refuse(np.abs(area) <= RELATIVE_DEGENERATE * diagonals, area, "points")
    return mixed(n, n) / area, -mixed(x, n) / area


@checked
def knet_curvature(delta1: ArrayLike, delta2: ArrayLike, r: float = 1.0) -> Floats:
    """(M, N) Gauss curvature of the quads of a K-net with edges r sin(delta): exact.

    K = -2 / (r^2 (cos delta1 + cos delta2)), whatever the angles of the quads.

    Parameters
    ----------
    delta1, delta2 : (M,), (N,) [rad] angles between normals along the edges of each direction
    r : scale

    Raises
    ------
    InputError
        A scale that is not positive, or an angle that is not between 0 and pi / 2; names it.
    """
    a, b = _angles(delta1, 0), _angles(delta2, 1)
    if not (np.isfinite(r) and r > 0):
        raise InputError(f"the scale of a K-net is {r:g}; it must be positive")
    curvature = np.asarray(-2.0 / (np.cos(a)[:, None] + np.cos(b))) / r / r
    finite(curvature, f"curvature at the scale {r:g}")
    return curvature


@checked
def unit_curvature_scale(delta1: float, delta2: float) -> float:
    """Scale r at which a K-net of constant angles [rad] has curvature -1 exactly.

    r^2 = 2 / (cos delta1 + cos delta2); tends to 1 for fine nets.

    Raises
    ------
    InputError
        An angle that is not between 0 and pi / 2.
    """
    a, b = _angles(delta1, 0), _angles(delta2, 1)
    return float(np.sqrt(2.0 / (np.cos(a) + np.cos(b)))[0])


def _angles(delta: ArrayLike, direction: int) -> Floats:
    given = np.atleast_1d(np.asarray(delta, dtype=np.float64))
    bad = np.flatnonzero(~((given > 0) & (given < 0.5 * np.pi)))
    if given.ndim != 1 or len(bad):
        row = given.ndim == 1
        what = f"delta {bad[0]} = {given[bad[0]]:g} rad" if row else f"shape {given.shape}"
        raise InputError(
            f"direction {direction}: {what}; angles between 0 and pi/2 in one row are needed"
        )
    return given


def _refuse(bad: np.ndarray[tuple[int, int], np.dtype[np.bool_]], value: Floats, what: str) -> None:
    found = np.argwhere(bad)
    if len(found):
        i, j = found[0].tolist()
        raise DegenerateError(
            f"quad ({i}, {j}): the diagonals of its {what} span no area ({value[i, j]:.3g})",
            cell=(i, j),
        )

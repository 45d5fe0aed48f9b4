"""Cross-ratios of quads: real where the four corners lie on a circle.

Source: Bobenko, Suris, Discrete Differential Geometry, 4.3 and 9; mathematics.md 2.2.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ddgfab.arguments import Complexes, checked, complex_together
from ddgfab.errors import InputError
from ddgfab.mesh import Floats
from ddgfab.quads import Place, columns, cross, dot, finite, measure, norm


@checked
def complex_cross_ratio(
    a: Complexes, b: Complexes, c: Complexes, d: Complexes
) -> NDArray[np.complex128]:
    """(a - b)(c - d) / ((b - c)(d - a)) of points of the complex plane; real when concircular.

    Raises
    ------
    InputError
        Shapes that do not go together, numbers that are not finite; names the argument.
    DegenerateError
        b = c or d = a; names the index.

    Source: mathematics.md 2.2.
    """
    p, q, r, s = (z.astype(np.complex128) for z in complex_together(a=a, b=b, c=c, d=d))
    for name, z in zip("abcd", (p, q, r, s), strict=True):
        finite(np.abs(z), name)
    below = (q - r) * (s - p)
    Place().refuse(below == 0, "neighbouring corners coincide")
    return np.asarray((p - q) * (r - s) / below)


@checked
def cross_ratio(a: ArrayLike, b: ArrayLike, c: ArrayLike, d: ArrayLike) -> tuple[Floats, Floats]:
    """Real part and length of the imaginary part of the quaternionic cross-ratio of four points.

    q = (a - b)(b - c)^-1 (c - d)(d - a)^-1 with points of R^3 (or R^2) as imaginary quaternions.
    Imaginary part zero: concircular; then real part negative: convex, embedded. Square: -1.

    Parameters
    ----------
    a, b, c, d : (..., 2 or 3), in cyclic order

    Raises
    ------
    DegenerateError
        b = c or d = a; names the index.

    Source: Bobenko, Pinkall; mathematics.md 2.2.
    """
    p, q, r, s = columns(a, b, c, d)
    both = _cross_ratio(p, q, s, r, Place())
    return both[0], both[1]


@checked
def cross_ratios(points: ArrayLike, axes: tuple[int, int] = (0, 1)) -> tuple[Floats, Floats]:
    """Cross-ratios q(x, x_k, x_kl, x_l) of the quads of a net in R^2 or R^3; see `cross_ratio`."""
    both = measure(points, axes, _cross_ratio)
    return both[..., 0], both[..., 1]


def _cross_ratio(x: Floats, x1: Floats, x2: Floats, x12: Floats, place: Place) -> Floats:
    if len(x) > 3:
        raise InputError(f"cross-ratios need points in R^2 or R^3, not R^{len(x)}")
    u, v, w, z = x - x1, x1 - x12, x12 - x2, x2 - x
    below = dot(v, v) * dot(z, z)
    place.refuse(below == 0, "neighbouring corners coincide")
    first, second = dot(u, v), dot(w, z)
    if len(x) == 2:
        twist, turn = u[0] * v[1] - u[1] * v[0], w[0] * z[1] - w[1] * z[0]
        real = first * second - twist * turn
        return np.stack([real, np.abs(first * turn + second * twist)]) / below
    left, right = cross(u, v), cross(w, z)
    imaginary = first * right + second * left - cross(left, right)
    return np.stack([first * second - dot(left, right), norm(imaginary)]) / below

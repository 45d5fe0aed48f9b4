"""The ellipsoid in its curvature lines: the smooth surface that circular nets are tested against.

x^2 / A + y^2 / B + z^2 / C = 1 with confocal coordinates A >= u >= B >= v >= C. The lines
u = const and v = const are its curvature lines. Source: Jacobi; mathematics.md 9.3.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked, together, vectors
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats, unit
from ddgfab.tolerances import COORDINATE_LIMIT


@checked
def ellipsoid_patch(
    u: ArrayLike, v: ArrayLike, a: float = 9.0, b: float = 4.0, c: float = 1.0
) -> Floats:
    """(..., 3) points in the octant x, y, z >= 0 of the ellipsoid with squared semi-axes a, b, c.

    x^2 = a (a - u)(a - v) / ((a - b)(a - c)), and cyclically.

    Parameters
    ----------
    u, v : arrays that broadcast to one shape, a >= u >= b >= v >= c; for the net of a rectangle of
        parameters give ``u[:, None], v[None, :]``
    a, b, c : squares of the semi-axes, a > b > c > 0

    Raises
    ------
    InputError
        Semi-axes out of order, parameters out of range or not finite.
    """
    p, q = _checked(u, v, a, b, c)
    squares = [
        a * (a - p) * (a - q) / ((a - b) * (a - c)),
        b * (p - b) * (b - q) / ((a - b) * (b - c)),
        c * (p - c) * (q - c) / ((a - c) * (b - c)),
    ]
    return np.sqrt(np.stack(squares, axis=-1))


@checked
def ellipsoid_normals(points: ArrayLike, a: float = 9.0, b: float = 4.0, c: float = 1.0) -> Floats:
    """(..., 3) outward unit normals at points (..., 3) of the ellipsoid.

    Raises
    ------
    InputError
        Semi-axes out of order, points without three finite coordinates.
    DegenerateError
        A point in the center or so far away that its normal overflows; names it.
    """
    _refuse_axes(a, b, c)
    (x,) = vectors(points=points)
    with np.errstate(over="ignore"):
        gradient = x / [a, b, c]
        length = np.linalg.norm(gradient, axis=-1)
    bad = ~((length > 0) & np.isfinite(length))
    if bad.any():
        at = tuple(np.argwhere(bad)[0].tolist())
        raise DegenerateError(f"point {at} is {x[at]}: it has no normal")
    return unit(gradient)


@checked
def ellipsoid_curvatures(
    u: ArrayLike, v: ArrayLike, a: float = 9.0, b: float = 4.0, c: float = 1.0
) -> tuple[Floats, Floats]:
    """Principal curvatures along the lines on which u runs, and v runs; positive (inward normal).

    sqrt(a b c) / (u^(3/2) v^(1/2)) where u runs, the smaller, and sqrt(a b c) / (u^(1/2) v^(3/2))
    where v runs; K = a b c / (u v)^2.

    Parameters
    ----------
    u, v, a, b, c : as in `ellipsoid_patch`
    """
    p, q = _checked(u, v, a, b, c)
    root = np.sqrt(a * b * c)
    return root / (p * np.sqrt(p * q)), root / (q * np.sqrt(p * q))


@checked
def ellipsoid_umbilics(a: float = 9.0, b: float = 4.0, c: float = 1.0) -> Floats:
    """(4, 3) umbilics, at u = v = b."""
    x, _, z = ellipsoid_patch(b, b, a, b, c)
    return np.array([[x, 0, z], [-x, 0, z], [-x, 0, -z], [x, 0, -z]])


def _checked(u: ArrayLike, v: ArrayLike, a: float, b: float, c: float) -> tuple[Floats, Floats]:
    _refuse_axes(a, b, c)
    p, q = together(u=u, v=v)
    for name, values, low, high in (("u", p, b, a), ("v", q, c, b)):
        bad = ~((values >= low) & (values <= high))
        if bad.any():
            raise InputError(f"{name} = {values[bad].flat[0]:g} lies outside {low:g}..{high:g}")
    return p, q


def _refuse_axes(a: float, b: float, c: float) -> None:
    if not (COORDINATE_LIMIT > a > b > c > 0):
        raise InputError(f"squared semi-axes {a:g}, {b:g}, {c:g}: a > b > c > 0 is needed")

"""Conjugate nets: all elementary quads are planar; their coefficients and evolution in the plane.

x_kl = x + (1 + c^lk) Delta_k x + (1 + c^kl) Delta_l x: of the two superscripts the second is the
direction that is multiplied. Source: Bobenko, Suris, Discrete Differential Geometry, 2.1;
mathematics.md 1.2-1.5. For three and more directions see `cubes`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.mesh import Floats
from ddgfab.quads import Place, columns, cross, dot, edge_frame, measure, norm, pairs, sweep
from ddgfab.tolerances import RELATIVE_DEGENERATE


@checked
def planarity(points: ArrayLike, axes: tuple[int, int] = (0, 1)) -> Floats:
    """Distance of the diagonals of each quad, divided by their mean length.

    Signed in R^3, by the side of n = (x_kl - x) x (x_l - x_k) on which x_k lies from x.
    Zero for all quads: a conjugate net (mathematics.md 1.3).

    Parameters
    ----------
    points : (n1, ..., nd, dim)
    axes : the two directions of the quads

    Returns
    -------
    The shape of the net, one less in the two directions.

    Raises
    ------
    DegenerateError
        Parallel diagonals, as of a folded quad; names the quad. See `planarity_flagged`.
    """
    return measure(points, axes, _planarity)


def _planarity(x: Floats, x1: Floats, x2: Floats, x12: Floats, place: Place) -> Floats:
    first, second = x12 - x, x2 - x1
    frame = edge_frame(first, second, place, "the diagonals are parallel")
    away = x1 - x
    mean = 0.5 * (frame.length + np.hypot(frame.along, frame.across))
    if len(x) == 3:
        return np.asarray(dot(away, cross(frame.e, frame.w)) / mean)
    away = away - dot(away, frame.e) * frame.e
    return np.asarray(norm(away - dot(away, frame.w) * frame.w) / mean)


@checked
def planarity_flagged(points: ArrayLike) -> tuple[Floats, NDArray[np.bool_]]:
    """As `planarity` without sign, and 0 with a flag where diagonals are parallel.

    Lines that are parallel lie in one plane: no plane need be fitted to such quads.

    Returns
    -------
    values : (M, N) not negative
    parallel : (M, N) True where the diagonals are parallel, or one has no length

    Raises
    ------
    DegenerateError
        A quad whose diagonals have both no length; names the quad.

    Source: mathematics.md 1.3.
    """

    def kernel(x: Floats, x1: Floats, x2: Floats, x12: Floats, place: Place) -> Floats:
        first, second = x12 - x, x2 - x1
        square, other = dot(first, first), dot(second, second)
        place.refuse((square == 0) & (other == 0), "both diagonals have no length")
        along = np.divide(dot(first, second), square, out=np.zeros_like(square), where=square > 0)
        across = norm(second - along * first)
        flag = (square == 0) | (across <= RELATIVE_DEGENERATE * np.sqrt(other))
        values = np.zeros(flag.shape)
        a, b, c, d = (np.asarray(p[:, ~flag]) for p in (x, x1, x2, x12))
        values[~flag] = np.abs(_planarity(a, b, c, d, place))
        return np.stack([values, flag.astype(np.float64)])

    both = measure(points, (0, 1), kernel)
    return both[..., 0], both[..., 1] > 0


@checked
def conjugate_residuals(points: ArrayLike) -> dict[str, float]:
    """Greatest planarity over the quads of all pairs of directions."""
    return {
        "planarity": max(
            float(np.abs(planarity(points, pair)).max(initial=0.0)) for pair in pairs(points)
        )
    }


@checked
def quad_volumes(points: ArrayLike, axes: tuple[int, int] = (0, 1)) -> Floats:
    """Volume of the tetrahedron of each quad's corners in R^3 (mathematics.md 1.2, 2.6)."""

    def kernel(x: Floats, x1: Floats, x2: Floats, x12: Floats, place: Place) -> Floats:
        return np.asarray(np.abs(dot(x12 - x, cross(x1 - x, x2 - x))) / 6.0)

    return measure(points, axes, kernel, dim=3)


@checked
def quad_volume_density(
    surface: Callable[[float, float], ArrayLike], at: tuple[float, float], step: float
) -> float:
    """3 vol / step^4 of a small parameter quad of a smooth surface in R^3.

    Tends to |det(f_1, f_2, f_12)| / 2 with an error of the order of the step: zero in the limit
    everywhere for conjugate nets of curves (mathematics.md 1.2).

    Parameters
    ----------
    surface : (u, v) -> (3,)
    at : parameters of the corner
    step : side of the quad in parameters; not zero
    """
    if not (np.isfinite(step) and step != 0):
        raise InputError(f"step {step}: a number other than zero is needed")
    u, v = at
    corners = [[surface(u + a, v + b) for b in (0.0, step)] for a in (0.0, step)]
    return float(3.0 * quad_volumes(np.asarray(corners, dtype=np.float64))[0, 0] / step**4)


@checked
def conj_coeffs(
    x: ArrayLike, xk: ArrayLike, xl: ArrayLike, xkl: ArrayLike
) -> tuple[Floats, Floats]:
    """(c^lk, c^kl) of quads: x_kl = x + (1 + c^lk) Delta_k x + (1 + c^kl) Delta_l x.

    By least squares where a quad is not planar. Both zero: a parallelogram.

    Parameters
    ----------
    x, xk, xl, xkl : (..., dim) corners

    Raises
    ------
    DegenerateError
        Parallel edges at x; names the index of the quad.

    Source: mathematics.md 1.4.
    """
    p, pk, pl, pkl = columns(x, xk, xl, xkl)
    return coeffs_kernel(p, pk, pl, pkl, Place())


def coeffs_kernel(
    x: Floats, xk: Floats, xl: Floats, xkl: Floats, place: Place
) -> tuple[Floats, Floats]:
    """`conj_coeffs` with components first."""
    a, b = xk - x, xl - x
    frame = edge_frame(a, b, place, "the edges at the first corner are parallel")
    mixed = xkl - x - a - b
    c_kl = dot(mixed, frame.w) / frame.across
    c_lk = (dot(mixed, frame.e) - c_kl * frame.along) / frame.length
    return np.asarray(c_lk), np.asarray(c_kl)


@checked
def coefficients(points: ArrayLike, axes: tuple[int, int] = (0, 1)) -> tuple[Floats, Floats]:
    """(c^lk, c^kl) of all quads of directions k, l of a net; see `conj_coeffs`."""

    def kernel(x: Floats, xk: Floats, xl: Floats, xkl: Floats, place: Place) -> Floats:
        return np.stack(coeffs_kernel(x, xk, xl, xkl, place))

    both = measure(points, axes, kernel)
    return both[..., 0], both[..., 1]


@checked
def conj_residual(x: ArrayLike, xk: ArrayLike, xl: ArrayLike, xkl: ArrayLike) -> Floats:
    """Distance of x_kl from the plane of the others, by the length of its diagonal (1.4)."""
    p, pk, pl, pkl = columns(x, xk, xl, xkl)
    c_lk, c_kl = coeffs_kernel(p, pk, pl, pkl, Place())
    fitted = p + (1.0 + c_lk) * (pk - p) + (1.0 + c_kl) * (pl - p)
    diagonal = norm(pkl - p)
    Place().refuse(diagonal == 0, "the diagonal has no length")
    return np.asarray(norm(pkl - fitted) / diagonal)


@checked
def evolve_conjugate(first: ArrayLike, second: ArrayLike, c21: ArrayLike, c12: ArrayLike) -> Floats:
    """(M + 1, N + 1, dim) conjugate net from two polylines and its coefficients.

    Parameters
    ----------
    first, second : (M + 1, dim), (N + 1, dim) polylines from one point, dim > 1
    c21 : (M, N) or number, multiplies edges of the first direction
    c12 : (M, N) or number, multiplies edges of the second direction

    Raises
    ------
    InputError
        Shapes that do not fit, polylines with different first points.
    DegenerateError
        Parallel edges at the first corner of a cell; names the cell.

    Source: Bobenko, Suris 2.1; mathematics.md 1.5.
    """

    def rule(x: Floats, x1: Floats, x2: Floats, c: Floats, d: Floats, place: Place) -> Floats:
        a, b = x1 - x, x2 - x
        edge_frame(a, b, place, "the edges at the first corner are parallel")
        return np.asarray(x + (1.0 + c) * a + (1.0 + d) * b)

    return sweep(first, second, (c21, c12), rule)

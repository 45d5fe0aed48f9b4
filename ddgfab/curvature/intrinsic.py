"""Gauss curvature from the first fundamental form alone: Brioschi's formula. mathematics.md 5.1."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats
from ddgfab.tolerances import COORDINATE_LIMIT, RELATIVE_DEGENERATE

Metric: TypeAlias = Callable[[Floats, Floats], tuple[Floats, Floats, Floats]]
"""E, F, G at arrays u, v."""

Parametrisation: TypeAlias = Callable[[NDArray[Any], NDArray[Any]], NDArray[Any]]
"""(..., 3) points at arrays u, v of one shape, which may be complex."""

COMPLEX_STEP: Final = 1e-30
"""Imaginary step of first derivatives: no difference is taken, and it may be tiny."""

DIFFERENCE_STEP: Final = 0.02
"""Step of sixth-order differences on parameters of the order of one: truncation ~ step^6 meets
rounding ~ eps / step^2 there, both below 1e-10."""

FIRST: Final = np.array([-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0]) / 60.0
"""Sixth-order central first difference on seven points."""

SECOND: Final = np.array([2.0, -27.0, 270.0, -490.0, 270.0, -27.0, 2.0]) / 180.0
"""Sixth-order central second difference on seven points."""


@dataclass(frozen=True, eq=False)
class MetricJet:
    """E, F, G and the derivatives that Brioschi's formula reads, arrays of one shape."""

    e: Floats
    f: Floats
    g: Floats
    e_u: Floats
    e_v: Floats
    f_u: Floats
    f_v: Floats
    g_u: Floats
    g_v: Floats
    e_vv: Floats
    f_uv: Floats
    g_uu: Floats


@checked
def brioschi(jet: MetricJet) -> Floats:
    """(...) Gauss curvature: (det A - det B) = 8 (E G - F^2)^2 K.

    Raises
    ------
    DegenerateError
        E G - F^2 zero or negative: no surface is immersed there; names the place and the value.
        Derivatives that are not finite.

    Source: Brioschi 1852; mathematics.md 5.1.
    """
    e, f, g = jet.e, jet.f, jet.g
    zero = np.zeros_like(e)
    area = e * g - f * f
    bad = np.argwhere(~(area > RELATIVE_DEGENERATE * np.abs(e * g)))
    if len(bad):
        at = tuple(int(i) for i in bad[0])
        raise DegenerateError(
            f"the metric at {at} is degenerate: E G - F^2 = {area[at]:.3g} (cuspidal edge?)",
            cell=at,
        )
    a = _matrix(
        (-jet.e_vv + 2 * jet.f_uv - jet.g_uu, jet.e_u, 2 * jet.f_u - jet.e_v),
        (2 * jet.f_v - jet.g_u, 2 * e, 2 * f),
        (jet.g_v, 2 * f, 2 * g),
    )
    b = _matrix((zero, jet.e_v, jet.g_u), (jet.e_v, 2 * e, 2 * f), (jet.g_u, 2 * f, 2 * g))
    found = (np.linalg.det(a) - np.linalg.det(b)) / (8.0 * area * area)
    bad = np.argwhere(~np.isfinite(found))
    if len(bad):
        at = tuple(int(i) for i in bad[0])
        raise DegenerateError(f"derivatives of the metric at {at} are too large", cell=at)
    return np.asarray(found)


@checked
def metric_of(surface: Parametrisation) -> Metric:
    """First fundamental form of an analytic parametrisation, by complex step.

    Parameters
    ----------
    surface : made of analytic functions, so that complex parameters go through it

    Source: Squire, Trapp 1998: x_u = Im x(u + i h, v) / h without cancellation.
    """

    def metric(u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
        p, q = np.broadcast_arrays(u + 0j, v + 0j)
        x_u = surface(p + 1j * COMPLEX_STEP, q).imag / COMPLEX_STEP
        x_v = surface(p, q + 1j * COMPLEX_STEP).imag / COMPLEX_STEP
        return _dot(x_u, x_u), _dot(x_u, x_v), _dot(x_v, x_v)

    return metric


@checked
def gauss_curvature(
    metric: Metric, u: ArrayLike, v: ArrayLike, step: float = DIFFERENCE_STEP
) -> Floats:
    """(...) Gauss curvature of a metric given as a function, by differences of sixth order.

    Parameters
    ----------
    metric : of a surface (`metric_of`), or abstract: E, F, G at arrays u, v
    u, v : arrays that broadcast to one shape
    step : of the differences, in units of the parameters

    Raises
    ------
    InputError
        A step that is not positive.
    DegenerateError
        A degenerate metric; names the place.
    """
    if not 0 < step <= COORDINATE_LIMIT:
        raise InputError(f"the step of the differences is {step:g}; it must be positive")
    p, q = np.broadcast_arrays(np.asarray(u, dtype=np.float64), np.asarray(v, dtype=np.float64))
    at = step * np.arange(-3.0, 4.0)
    # axis 0: u of the stencil, axis 1: v of the stencil
    e, f, g = metric(
        p + np.expand_dims(at, tuple(range(1, p.ndim + 2))),
        q + np.expand_dims(at, tuple(range(1, p.ndim + 1))),
    )
    shape = (7, 7, *p.shape)
    e, f, g = (np.broadcast_to(form, shape) for form in (e, f, g))

    def along_u(form: Floats, weights: Floats) -> Floats:
        return np.tensordot(weights, form[:, 3], 1)

    def along_v(form: Floats, weights: Floats) -> Floats:
        return np.tensordot(weights, form[3], 1)

    first, second = FIRST / step, SECOND / step**2
    return brioschi(
        MetricJet(
            e[3, 3],
            f[3, 3],
            g[3, 3],
            along_u(e, first),
            along_v(e, first),
            along_u(f, first),
            along_v(f, first),
            along_u(g, first),
            along_v(g, first),
            along_v(e, second),
            np.tensordot(first, np.tensordot(first, f, 1), 1),
            along_u(g, second),
        )
    )


@checked
def net_curvature(points: ArrayLike, du: float, dv: float) -> Floats:
    """(M - 3, N - 3) Gauss curvature at the inner vertices of a surface sampled on a net.

    Central differences twice: the error falls with the square of the steps. Vertices of the two
    outermost rings have no value.

    Parameters
    ----------
    points : (M + 1, N + 1, 3) at parameters of constant steps
    du, dv : the steps

    Raises
    ------
    InputError
        Fewer than 5 x 5 points, or a step that is not positive.
    DegenerateError
        Tangents that are parallel; names the vertex, counted from the first with a value.
    """
    x = np.asarray(points, dtype=np.float64)
    if x.ndim != 3 or x.shape[2] != 3 or min(x.shape[:2]) < 5:
        raise InputError(f"points have shape {x.shape}; (5 or more, 5 or more, 3) is needed")
    if not (0 < du <= COORDINATE_LIMIT and 0 < dv <= COORDINATE_LIMIT):
        raise InputError(f"steps {du:g}, {dv:g}: they must be positive")
    x_u = (x[2:, 1:-1] - x[:-2, 1:-1]) / (2 * du)
    x_v = (x[1:-1, 2:] - x[1:-1, :-2]) / (2 * dv)
    e, f, g = _dot(x_u, x_u), _dot(x_u, x_v), _dot(x_v, x_v)

    def along_u(form: Floats) -> Floats:
        return np.asarray((form[2:, 1:-1] - form[:-2, 1:-1]) / (2 * du))

    def along_v(form: Floats) -> Floats:
        return np.asarray((form[1:-1, 2:] - form[1:-1, :-2]) / (2 * dv))

    own = (slice(1, -1), slice(1, -1))
    mixed = (f[2:, 2:] - f[2:, :-2] - f[:-2, 2:] + f[:-2, :-2]) / (4 * du * dv)
    e_vv = (e[1:-1, 2:] - 2 * e[own] + e[1:-1, :-2]) / dv**2
    g_uu = (g[2:, 1:-1] - 2 * g[own] + g[:-2, 1:-1]) / du**2
    return brioschi(
        MetricJet(
            e[own],
            f[own],
            g[own],
            along_u(e),
            along_v(e),
            along_u(f),
            along_v(f),
            along_u(g),
            along_v(g),
            e_vv,
            mixed,
            g_uu,
        )
    )


def _dot(a: Floats, b: Floats) -> Floats:
    return np.asarray(np.einsum("...i,...i->...", a, b))


def _matrix(*rows: tuple[Floats, Floats, Floats]) -> Floats:
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)

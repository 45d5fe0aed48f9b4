"""Smooth isothermic surfaces and their duals: conformal curvature line parametrisations.

Source: Christoffel 1867; Bobenko, Suris, 1.7; mathematics.md 5.4 (Theorem 4.1, equation (15)).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats, extent
from ddgfab.tolerances import COORDINATE_LIMIT, RELATIVE_DEGENERATE

Surface = Callable[[Floats, Floats], ArrayLike]
"""Parameters u, v (arrays of one shape) to points (..., 3)."""

STEP: Final = 1e-3
"""Step of the differences of fourth order, as part of the parameters' unit: their error is about
STEP^4, that of rounding 1e-16 / STEP (first derivatives) or / STEP^2 (second ones)."""

_FIRST: Final = np.array([1.0, -8.0, 8.0, -1.0]) / 12.0
_PLACES: Final = np.array([-2.0, -1.0, 1.0, 2.0])


def _parameters(u: ArrayLike, v: ArrayLike, step: float) -> tuple[Floats, Floats]:
    """Finite parameters, and a step that is positive."""
    if not 0 < step <= COORDINATE_LIMIT:
        raise InputError(f"step {step}: a positive number is needed")
    p, q = _floats(u), _floats(v)
    for name, values in (("u", p), ("v", q)):
        bad = np.argwhere(~(np.abs(values) <= COORDINATE_LIMIT))
        if len(bad):
            at = tuple(bad[0].tolist())
            raise InputError(f"{name} {at} is {values[at]:g}; a finite number is needed")
    return p, q


def _derivatives(surface: Surface, u: Floats, v: Floats, step: float) -> tuple[Floats, Floats]:
    """First derivatives (..., 3) in u and in v, by differences of fourth order."""
    along_u = sum(
        w * _points(surface, u + k * step, v) for w, k in zip(_FIRST, _PLACES, strict=True)
    )
    along_v = sum(
        w * _points(surface, u, v + k * step) for w, k in zip(_FIRST, _PLACES, strict=True)
    )
    return np.asarray(along_u / step), np.asarray(along_v / step)


def _points(surface: Surface, u: Floats, v: Floats) -> Floats:
    x = np.asarray(surface(u, v), dtype=np.float64)
    if x.shape != (*u.shape, 3):
        raise InputError(f"the surface gave shape {x.shape} for parameters {u.shape}")
    bad = np.argwhere(~np.isfinite(x))
    if len(bad):
        at = tuple(bad[0][:-1].tolist())
        raise DegenerateError(f"the surface is not finite at u = {u[at]:g}, v = {v[at]:g}")
    return x


def smooth_frame(
    surface: Surface, u: Floats, v: Floats, step: float
) -> tuple[Floats, Floats, Floats]:
    """Points and first derivatives (..., 3) in u and in v; refuses lines that stand still."""
    d1, d2 = _derivatives(surface, u, v, step)
    _speeds(d1, d2, u, v)
    return _points(surface, u, v), d1, d2


@checked
def smooth_isothermic_residuals(
    surface: Surface, u: ArrayLike, v: ArrayLike, *, step: float = STEP
) -> dict[str, float]:
    """How far a parametrisation is from isothermic at parameters u, v; all relative, zero if it is.

    Greatest of: | |d1x| - |d2x| | / |d1x| (conformal), the cosine of the angle of the parameter
    lines (orthogonal), and det(d1x, d2x, d12x) / (|d1x| |d2x| |d12x|) (conjugate).

    Parameters
    ----------
    surface : vectorised map
    u, v : arrays that broadcast to one shape
    step : of the differences, in the parameters' unit

    Raises
    ------
    InputError
        Parameters that are not finite or whose shapes do not go together, a step not positive.
    DegenerateError
        A parameter line that stands still, or a point that is not finite; names the parameters.

    Source: mathematics.md 5.4.
    """
    try:
        p, q = (np.array(a) for a in np.broadcast_arrays(*_parameters(u, v, step)))
    except ValueError as error:
        raise InputError(str(error)) from None
    d1, d2 = _derivatives(surface, p, q, step)
    mixed = sum(
        w * _derivatives(surface, p, q + k * step, step)[0]
        for w, k in zip(_FIRST, _PLACES, strict=True)
    )
    d12 = np.asarray(mixed) / step
    a, b = _speeds(d1, d2, p, q)
    det = np.einsum("...i,...i->...", np.cross(d1, d2), d12)
    # Where the mixed derivative is small beside the others the lines are conjugate as well.
    size = a * b * np.maximum(np.linalg.norm(d12, axis=-1), np.sqrt(a * b))
    return {
        "conformal": float((np.abs(a - b) / a).max()),
        "orthogonal": float((np.abs(np.einsum("...i,...i->...", d1, d2)) / (a * b)).max()),
        "conjugate": float((np.abs(det) / size).max()),
    }


def _floats(values: ArrayLike) -> Floats:
    return np.asarray(values, dtype=np.float64)


def _speeds(d1: Floats, d2: Floats, u: Floats, v: Floats) -> tuple[Floats, Floats]:
    a, b = np.linalg.norm(d1, axis=-1), np.linalg.norm(d2, axis=-1)
    # Differences of a constant leave rounding errors.
    still = np.argwhere(np.minimum(a, b) <= RELATIVE_DEGENERATE * np.maximum(a, b))
    if len(still):
        at = tuple(still[0].tolist())
        raise DegenerateError(f"a parameter line stands still at u = {u[at]:g}, v = {v[at]:g}")
    return a, b


@checked
def smooth_dual(
    surface: Surface, u: ArrayLike, v: ArrayLike, *, step: float = STEP
) -> tuple[Floats, float]:
    """Christoffel dual at a grid of parameters, with d1x* = d1x / s^2, d2x* = -d2x / s^2.

    s^2 = |d1x| |d2x|, integrated by Simpson's rule over each step of the grid, along the first
    v and then along v; the first point is the origin. The dual of a sphere is a minimal surface.

    Parameters
    ----------
    surface : vectorised isothermic parametrisation
    u, v : (M + 1,), (N + 1,) parameters, in order
    step : of the differences, in the parameters' unit

    Returns
    -------
    points : (M + 1, N + 1, 3)
    defect : greatest gap of a grid cell's four integrals over the size of the dual: how far the
        form is from closed, and the error of the rule

    Raises
    ------
    InputError
        Fewer than two parameters in a direction, numbers that are not finite, a step not positive.
    DegenerateError
        As `smooth_isothermic_residuals`.

    Source: mathematics.md 5.4, 6.2.
    """
    p, q = _parameters(u, v, step)
    if p.ndim != 1 or q.ndim != 1 or min(len(p), len(q)) < 2:
        raise InputError(f"parameters of shapes {p.shape}, {q.shape}: two numbers at least each")

    def form(a: Floats, b: Floats, direction: int) -> Floats:
        grid = np.meshgrid(a, b, indexing="ij")
        both = _derivatives(surface, grid[0], grid[1], step)
        speed = _speeds(*both, *grid)
        return both[direction] * ((1 - 2 * direction) / (speed[0] * speed[1]))[..., None]

    half_p, half_q = 0.5 * (p[1:] + p[:-1]), 0.5 * (q[1:] + q[:-1])
    ends = form(p, q, 0)
    along = np.diff(p)[:, None, None] / 6 * (ends[1:] + ends[:-1] + 4 * form(half_p, q, 0))
    ends = form(p, q, 1)
    across = np.diff(q)[:, None] / 6 * (ends[:, 1:] + ends[:, :-1] + 4 * form(p, half_q, 1))
    dual = np.zeros((len(p), len(q), 3))
    dual[1:, 0] = np.cumsum(along[:, 0], axis=0)
    dual[:, 1:] = dual[:, :1] + np.cumsum(across, axis=1)
    gap = np.linalg.norm(np.diff(along, axis=1) - np.diff(across, axis=0), axis=-1)
    size = extent(dual)
    return dual, float(gap.max()) / size

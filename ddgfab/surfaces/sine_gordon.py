"""Solutions of the sine-Gordon equation phi_uv = sin phi: Baecklund transforms, solitons.

phi is the angle between the asymptotic lines of a surface of curvature -1 in unit-speed asymptotic
parameters. Source: mathematics.md 5.2; Rogers, Schief, Baecklund and Darboux Transformations,
1.2-1.4.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked, finite_together
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats
from ddgfab.tolerances import RELATIVE_DEGENERATE

Solution: TypeAlias = Callable[[Floats, Floats], tuple[Floats, Floats, Floats]]
"""phi, phi_u, phi_v of a solution at arrays u, v."""

ODE_RELATIVE: Final = 1e-12
"""Relative error that the integrators of smooth oracles keep at every step."""

ODE_ABSOLUTE: Final = 1e-13
"""Absolute error [rad, or units of length] that they keep at every step."""


@checked
def soliton(u: ArrayLike, v: ArrayLike, a: float, c: float = 1.0) -> Floats:
    """One soliton 4 atan(c e^(a u + v / a)): the Baecklund transform of 0.

    Parameters
    ----------
    u, v : arrays that broadcast to one shape
    a : parameter of the transform, not 0
    c : its constant of integration; negative: an antisoliton

    Raises
    ------
    InputError
        a = 0, a number that is not finite, or shapes that do not go together.

    Source: mathematics.md 5.2.
    """
    _parameters([a], [c])
    p, q = finite_together(u=u, v=v)
    with np.errstate(over="ignore", invalid="ignore"):  # atan of an infinite number is pi / 2
        angle = np.asarray(4.0 * np.arctan(c * np.exp(a * p + q / a)))
    return _known(angle)


@checked
def permute(phi: ArrayLike, first: ArrayLike, second: ArrayLike, a: float, b: float) -> Floats:
    """The fourth solution phi12 from phi and its transforms with parameters a and b, by algebra.

    tan((phi12 - phi) / 4) = (a + b) / (a - b) tan((first - second) / 4), on the branch that is
    continuous in first - second and zero where that is zero.

    Raises
    ------
    DegenerateError
        a = b or a = -b; says the values.

    Source: Bianchi's permutability theorem; mathematics.md 5.2.
    """
    _distinct([a, b])
    ratio = (a + b) / (a - b)
    base, one, other = finite_together(phi=phi, first=first, second=second)
    quarter = 0.25 * (one - other)
    turns = np.round(quarter / np.pi)
    own = np.arctan(abs(ratio) * np.tan(quarter - np.pi * turns)) + np.pi * turns
    return np.asarray(base + 4.0 * np.sign(ratio) * own)


@checked
def solitons(
    u: ArrayLike, v: ArrayLike, parameters: Sequence[float], constants: Sequence[float]
) -> Floats:
    """The n-soliton: transforms of 0 with n parameters, put together by `permute` alone.

    Parameters
    ----------
    u, v : arrays that broadcast to one shape
    parameters : (n,) of the transforms; all different, also in absolute value, none 0
    constants : (n,) as c in `soliton`

    Raises
    ------
    InputError
        Different numbers of parameters and constants, or one that is 0 or not finite.
    DegenerateError
        Two parameters that are equal or opposite; names them.

    Source: Lamb's diagram: the solution of parameters i..j comes from those of i..j-1, i+1..j and
    i+1..j-1; mathematics.md 5.2.
    """
    _parameters(parameters, constants)
    _distinct(parameters)
    p, q = finite_together(u=u, v=v)
    before = [np.zeros(p.shape)] * (len(parameters) + 1)
    row = [soliton(p, q, a, c) for a, c in zip(parameters, constants, strict=True)]
    for width in range(2, len(parameters) + 1):
        after = [
            permute(before[k + 1], row[k], row[k + 1], parameters[k], parameters[k + width - 1])
            for k in range(len(parameters) - width + 1)
        ]
        before, row = row, after
    return row[0]


@checked
def breather_angle(u: ArrayLike, v: ArrayLike, rate: float) -> Floats:
    """The breather 4 atan(rate / q sin(q (u - v)) / cosh(rate (u + v))), q = sqrt(1 - rate^2).

    The two-soliton of conjugate complex parameters of absolute value 1 with real part `rate`.

    Raises
    ------
    InputError
        A rate that is not between 0 and 1, parameters that are not finite or too large, shapes
        that do not go together.
    """
    if not 0.0 < rate < 1.0:
        raise InputError(f"the rate of a breather is {rate:g}; it must lie between 0 and 1")
    p, q = finite_together(u=u, v=v)
    pulse = np.sqrt(1.0 - rate * rate)
    with np.errstate(over="ignore", invalid="ignore"):  # far away the wave has died out
        wave = np.sin(pulse * (p - q)) / np.cosh(rate * (p + q))
    return _known(np.asarray(4.0 * np.arctan(rate / pulse * wave)))


@checked
def baecklund_angle(
    solution: Solution, a: float, u: ArrayLike, v: ArrayLike, start: float
) -> Floats:
    """(M, N) transform of a solution, by integration of Baecklund's two equations on a grid.

    phi'_u = phi_u + 2 a sin((phi' + phi) / 2), phi'_v = -phi_v + (2 / a) sin((phi' - phi) / 2):
    first along u at v[0], then along v from all u at once.

    Parameters
    ----------
    solution : gives phi, phi_u, phi_v at arrays u, v
    a : parameter of the transform, not 0
    u, v : (M,), (N,) increasing
    start : phi' at (u[0], v[0])

    Raises
    ------
    InputError
        a = 0, or u, v that do not increase; names the step.
    DegenerateError
        The integration does not reach the end of the grid; says how far it came.

    Source: mathematics.md 5.2.
    """
    _parameters([a], [start])
    p, q = increasing(u, "u"), increasing(v, "v")

    def along_u(s: float, y: Floats) -> Floats:
        phi, phi_u, _ = solution(np.array([s]), q[:1])
        return phi_u + 2.0 * a * np.sin(0.5 * (y + phi))

    def along_v(s: float, y: Floats) -> Floats:
        phi, _, phi_v = solution(p, np.full(len(p), s))
        return -phi_v + (2.0 / a) * np.sin(0.5 * (y - phi))

    first = integrated(along_u, np.array([start]), p)[:, 0]
    return np.ascontiguousarray(integrated(along_v, first, q).T)


@checked
def sine_gordon_defect(phi: ArrayLike, u: ArrayLike, v: ArrayLike) -> Floats:
    """(M - 1, N - 1) of sampled angles (M, N): the second difference less sin phi, cell by cell.

    Falls with the square of the steps for samples of a smooth solution.

    Raises
    ------
    InputError
        Angles that do not fit u (M,) and v (N,), or these do not increase.
    """
    p, q = increasing(u, "u"), increasing(v, "v")
    h = np.asarray(phi, dtype=np.float64)
    if h.shape != (len(p), len(q)):
        raise InputError(f"angles have shape {h.shape}; expected {(len(p), len(q))}")
    cell = np.diff(p)[:, None] * np.diff(q)
    middle = 0.25 * (h[1:, 1:] + h[1:, :-1] + h[:-1, 1:] + h[:-1, :-1])
    return np.diff(np.diff(h, axis=0), axis=1) / cell - np.sin(middle)


def increasing(values: ArrayLike, name: str) -> Floats:
    """Parameters (2 or more,) that increase; raises `InputError` with the step where not."""
    given = np.asarray(values, dtype=np.float64)
    if given.ndim != 1 or len(given) < 2 or not np.isfinite(given).all():
        raise InputError(f"{name} has shape {given.shape}; two or more finite numbers are needed")
    bad = np.flatnonzero(np.diff(given) <= 0)
    if len(bad):
        raise InputError(
            f"{name} does not increase at step {bad[0]}: {given[bad[0]]:g}, {given[bad[0] + 1]:g}"
        )
    return given


def integrated(slope: Callable[[float, Floats], Floats], start: Floats, at: Floats) -> Floats:
    """(len(at), n) solution of y' = slope(s, y) with y(at[0]) = start (n,), at given places.

    Raises
    ------
    DegenerateError
        The integrator gives up; says where.

    Source: Dormand, Prince, order 8 (scipy's DOP853).
    """
    from scipy.integrate import solve_ivp  # heavy: only where it is needed

    found = solve_ivp(
        slope,
        (float(at[0]), float(at[-1])),
        start,
        method="DOP853",
        t_eval=at,
        rtol=ODE_RELATIVE,
        atol=ODE_ABSOLUTE,
    )
    if not found.success or found.y.shape[1] != len(at):
        raise DegenerateError(f"integration stops before {at[-1]:g}: {found.message}")
    return np.asarray(found.y.T)


def _known(angles: Floats) -> Floats:
    """Angles, or `InputError` where parameters were so large that they cannot be computed."""
    if not np.isfinite(angles).all():
        raise InputError("u or v is too large: the angle is not determined in floating point")
    return angles


def _parameters(parameters: Sequence[float], constants: Sequence[float]) -> None:
    if len(parameters) != len(constants) or not len(parameters):
        raise InputError(
            f"{len(parameters)} parameters and {len(constants)} constants: as many are needed"
        )
    for k, (a, c) in enumerate(zip(parameters, constants, strict=True)):
        if a == 0 or not np.isfinite(a) or not np.isfinite(c):
            raise InputError(f"transform {k} has parameter {a:g} and constant {c:g}")


def _distinct(parameters: Sequence[float]) -> None:
    for k, b in enumerate(parameters):
        for i, a in enumerate(parameters[:k]):
            if abs(abs(a) - abs(b)) <= RELATIVE_DEGENERATE * max(abs(a), abs(b)):
                raise DegenerateError(
                    f"transforms {i} and {k} have parameters {a:g} and {b:g}: equal or opposite "
                    "ones cannot be put together"
                )

"""Closed forms of surfaces of curvature -1, not in asymptotic parameters; complex ones are taken.

A second route to `ddgfab.surfaces.k_surfaces`, and oracles for Brioschi's formula: derivatives
come by complex step. With asymptotic parameters p, q: the pseudosphere is at (q - p, p + q), the
breather at (p - q, p + q), Kuen at (p + q, 2 atan exp(q - p)), Dini at (q cot(sigma / 2) -
p tan(sigma / 2), -p - q), up to a motion. Source: mathematics.md 3.15.
"""

from __future__ import annotations

from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ddgfab.arguments import Complexes, checked, complex_together
from ddgfab.errors import InputError
from ddgfab.quads import finite

Array: TypeAlias = NDArray[Any]  # float64, or complex128 where a parameter is complex

QUADRATURE: Final = 60
"""Nodes of the quadrature of heights; exact to rounding but for the last percent below the rim."""

FARTHEST: Final = 300.0
"""Greatest |rate u| of the closed breather, whose hyperbolic functions are squared."""


@checked
def pseudosphere_lines(u: Complexes, v: Complexes) -> Array:
    """(..., 3) points (sech u cos v, sech u sin v, u - tanh u); the cuspidal edge is u = 0."""
    p, q = complex_together(u=u, v=v)
    with np.errstate(over="ignore"):
        sech = 1.0 / np.cosh(p)
    return np.stack([sech * np.cos(q), sech * np.sin(q), p - np.tanh(p)], axis=-1)


@checked
def kuen_lines(u: Complexes, v: Complexes) -> Array:
    """(..., 3) points of Kuen's surface, 0 < v < pi; cuspidal edges where u sin v = +-1.

    Raises
    ------
    InputError
        v [rad] that is not between 0 and pi, shapes that do not go together, numbers that are not
        finite.
    """
    p, q = complex_together(u=u, v=v)
    outside = ~((q.real > 0) & (q.real < np.pi))
    if outside.any():
        raise InputError(f"v = {q.real[outside].flat[0]:g} rad; it must lie between 0 and pi")
    finite(p.real, "u")
    d = 1.0 + p * p * np.sin(q) ** 2
    return np.stack(
        [
            2.0 * (np.cos(p) + p * np.sin(p)) * np.sin(q) / d,
            2.0 * (np.sin(p) - p * np.cos(p)) * np.sin(q) / d,
            np.log(np.tan(0.5 * q)) + 2.0 * np.cos(q) / d,
        ],
        axis=-1,
    )


@checked
def breather_lines(u: Complexes, v: Complexes, rate: float) -> Array:
    """(..., 3) points of the breather that decays along u at a rate between 0 and 1.

    Raises
    ------
    InputError
        A rate that is not between 0 and 1.
    """
    if not 0.0 < rate < 1.0:
        raise InputError(f"the rate of a breather is {rate:g}; it must lie between 0 and 1")
    p, q = complex_together(u=u, v=v)
    pulse = np.sqrt(1.0 - rate * rate)
    far = float(np.abs(rate * p.real).max(initial=0.0))
    if far > FARTHEST:
        raise InputError(f"rate * u reaches {far:g}; {FARTHEST:g} is the most")
    cosh, sinh = np.cosh(rate * p), np.sinh(rate * p)
    cos, sin = np.cos(pulse * q), np.sin(pulse * q)
    d = rate * ((pulse * cosh) ** 2 + (rate * sin) ** 2)
    factor = 2.0 * pulse * cosh / d
    return np.stack(
        [
            -p + 2.0 * pulse**2 * cosh * sinh / d,
            factor * (-pulse * np.cos(q) * cos - np.sin(q) * sin),
            factor * (-pulse * np.sin(q) * cos + np.cos(q) * sin),
        ],
        axis=-1,
    )


@checked
def dini_lines(u: Complexes, v: Complexes, sigma: float = 0.5 * np.pi) -> Array:
    """(..., 3) points of Dini's surface: the tractrix in u turned by v and raised with it.

    Lines v = const are the tractrices; the lines u = const are helices across them at an angle, so
    that F is not 0, and the parameters are not curvature lines unless sigma = pi / 2.

    Raises
    ------
    InputError
        sigma [rad] that is not between 0 and pi.

    Source: the tractrix of length sin(sigma), pitch cos(sigma) a radian; sigma = pi / 2 is the
    pseudosphere.
    """
    if not 0.0 < sigma < np.pi:
        raise InputError(f"sigma = {sigma:g} rad; it must lie between 0 and pi")
    s, c = np.sin(sigma), np.cos(sigma)
    p, q = complex_together(u=u, v=v)
    with np.errstate(over="ignore"):
        sech = s / np.cosh(p)
    return np.stack([sech * np.cos(q), sech * np.sin(q), s * (p - np.tanh(p)) + c * q], axis=-1)


@checked
def rotational_lines(u: Complexes, v: Complexes, waist: float) -> Array:
    """(..., 3) points of the waisted rotational surface: radius waist cosh u, v its azimuth.

    u is the arc length of the meridian; the height is the integral of sqrt(1 - waist^2 sinh^2 u),
    by quadrature. The smooth counterpart of crab nets that have a waist.

    Raises
    ------
    InputError
        A waist that is not positive, or a u beyond the rim, where waist sinh |u| = 1; names it.

    Source: Minding 1839: r'' = r for unit-speed meridians of curvature -1.
    """
    if not (waist > 0 and np.isfinite(waist)):
        raise InputError(f"the waist is {waist:g}; a positive radius is needed")
    p, q = complex_together(u=u, v=v)
    with np.errstate(over="ignore"):
        beyond = waist * np.sinh(np.abs(p.real)) >= 1.0
    if beyond.any():
        raise InputError(
            f"u = {p.real[beyond].flat[0]:g} is beyond the rim at {np.arcsinh(1 / waist):.6g}"
        )
    t, weight = np.polynomial.legendre.leggauss(QUADRATURE)
    at = p[..., None] * (0.5 + 0.5 * t)
    height = 0.5 * p * np.sum(weight * np.sqrt(1.0 - (waist * np.sinh(at)) ** 2), axis=-1)
    radius = waist * np.cosh(p)
    return np.stack([radius * np.cos(q), radius * np.sin(q), height], axis=-1)

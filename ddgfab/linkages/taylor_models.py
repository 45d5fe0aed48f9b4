"""Taylor models of angles: a polynomial in the driving angle and a proven bound on what is left.

A model says: on the complex disc |s| <= R around the middle of an interval an analytic function is
its value at the middle plus sum_j p_j s^j plus a rest of modulus r at most. Derivatives of the rest
on the real interval |s| <= h < R follow from Cauchy's estimates. Bounds are proven up to the
rounding of float64. Source: the closing angle of an isogram is that of mathematics.md 3.7.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ddgfab.mesh import Floats

ORDER = 8
"""Degree of the polynomials."""

DISC = 2.0
"""Radius of the disc over half the interval."""

WIDER = (2.0, 4.0, 16.0, 64.0, 256.0, 1024.0)
"""Discs, over R, on which truncated tails are estimated; the best counts."""


TINY = float(np.finfo(np.float64).tiny)
"""In place of zero where it is multiplied by infinity."""


@dataclass(frozen=True, eq=False)
class TaylorModel:
    """Deviation of an angle from its value at the middle of T intervals.

    terms : (ORDER, T) coefficients of s, s^2, ...
    rest : (T,) bound of the rest on |s| <= DISC * half
    """

    terms: Floats
    rest: Floats

    @staticmethod
    def linear(rate: float, count: int) -> TaylorModel:
        """rate * s, exactly."""
        terms = np.zeros((ORDER, count))
        terms[0] = rate
        return TaylorModel(terms, np.zeros(count))

    def __add__(self, other: TaylorModel) -> TaylorModel:
        return TaylorModel(self.terms + other.terms, self.rest + other.rest)

    def __sub__(self, other: TaylorModel) -> TaylorModel:
        return TaylorModel(self.terms - other.terms, self.rest + other.rest)

    def scaled(self, factor: float) -> TaylorModel:
        """The model times a number."""
        return TaylorModel(factor * self.terms, abs(factor) * self.rest)

    def speeds(self, half: Floats) -> tuple[Floats, Floats]:
        """(T,) bounds of the first and second derivative on the real interval |s| <= half."""
        j = np.arange(1, ORDER + 1)[:, None]
        size, power = np.abs(self.terms), half ** (j - 1)
        room = (DISC - 1.0) * half
        first = (j * size * power).sum(axis=0) + self.rest / room
        second = (j * (j - 1) * size * half ** np.maximum(j - 2, 0)).sum(axis=0)
        return first, second + 2.0 * self.rest / room**2


def product(a: Floats, b: Floats) -> Floats:
    """Product of two series (n, T) from order 0, cut after as many terms."""
    out = np.zeros_like(a)
    for i in range(len(a)):
        out[i:] += a[i] * b[: len(a) - i]
    return out


def compose(series: Floats, inner: TaylorModel) -> Floats:
    """(ORDER, T) coefficients 1, 2, ... of f(p(s)); series (ORDER + 1, T) are those of f."""
    p = np.concatenate([np.zeros((1, inner.terms.shape[1])), inner.terms])
    out = np.zeros_like(p)
    for coefficient in series[::-1]:
        out = product(out, p)
        out[0] += coefficient
    return out[1:]


def reach(inner: TaylorModel, radius: Floats) -> Floats:
    """(T,) bound of |p(s)| on |s| <= radius."""
    j = np.arange(1, ORDER + 1)[:, None]
    return np.asarray((np.abs(inner.terms) * radius**j).sum(axis=0))


def closing(ratio: float, angle: Floats, inner: TaylorModel, half: Floats) -> TaylorModel:
    """The other angle of an isogram, psi = 2 atan(C / tan(phi / 2)), after phi moves.

    Parameters
    ----------
    ratio : C = tan(phi/2) tan(psi/2)
    angle : (T,) phi at the middle
    inner : its deviation
    half : (T,) half widths of the intervals

    The rest is infinite where the disc reaches too near a pole to say anything.
    """
    inner_reach = reach(inner, DISC * half) + inner.rest
    steep = _steepest(ratio, angle, inner_reach)
    rest = steep * np.maximum(inner.rest, TINY)
    tail = np.full_like(half, np.inf)
    for factor in WIDER:
        wide = reach(inner, factor * DISC * half)
        size = _steepest(ratio, angle, wide) * np.maximum(wide, TINY)
        tail = np.minimum(tail, size * factor ** -(ORDER + 1) / (1.0 - 1.0 / factor))
    return TaylorModel(compose(_closing_series(ratio, angle), inner), rest + tail)


def _steepest(ratio: float, angle: Floats, around: Floats) -> Floats:
    """(T,) bound of |dpsi/dphi| on the complex disc of radius `around` about real angles.

    dpsi/dphi = -2 C / ((1 + C^2) - (1 - C^2) cos(phi)); the real part of the denominator bounds it.
    """
    square = ratio * ratio
    away = abs(1.0 - square) * (np.abs(np.sin(angle)) * around + 0.5 * around**2)
    peak = (1.0 - square) * np.cos(angle) + away
    with np.errstate(over="ignore", invalid="ignore"):
        low = (1.0 + square) - np.where(peak > 0, peak * np.cosh(np.minimum(around, 50.0)), peak)
        out = np.where((low > 0) & (around < 50.0), 2.0 * abs(ratio) / np.abs(low), np.inf)
    return np.asarray(out)


def _closing_series(ratio: float, angle: Floats) -> Floats:
    """(ORDER + 1, T) Taylor coefficients of psi(phi) at real angles, the constant left 0."""
    square = ratio * ratio
    count = len(angle)
    below = np.empty((ORDER, count))
    factor = 1.0
    waves = (np.cos(angle), -np.sin(angle), -np.cos(angle), np.sin(angle))
    for j in range(ORDER):
        below[j] = -(1.0 - square) * waves[j % 4] * factor
        factor /= j + 1
    below[0] += 1.0 + square
    inverse = np.empty_like(below)
    inverse[0] = 1.0 / below[0]
    for j in range(1, ORDER):
        inverse[j] = -(below[1 : j + 1] * inverse[:j][::-1]).sum(axis=0) / below[0]
    out = np.zeros((ORDER + 1, count))
    out[1:] = -2.0 * ratio * inverse / np.arange(1, ORDER + 1)[:, None]
    return out

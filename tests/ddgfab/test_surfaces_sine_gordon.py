"""Sine-Gordon: transforms by algebra against integration, the printed number, bad input."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats
from ddgfab.surfaces import (
    baecklund_angle,
    breather_angle,
    permute,
    sine_gordon_defect,
    soliton,
    solitons,
)

A, B, C = 0.7, 1.3, -0.9


def zero(u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
    flat = 0.0 * (u + v)
    return flat, flat, flat


def one(u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
    """A soliton and its derivatives: d/du 4 atan(e^s) = 2 a sech(s)."""
    s = A * u + v / A
    sech = 1.0 / np.cosh(s)
    return 4 * np.arctan(np.exp(s)), 2 * A * sech, 2 / A * sech


def test_printed_number() -> None:
    """mathematics.md 5.2."""
    u, v = 0.3, -0.4
    got = permute(0.0, soliton(u, v, 0.7, 1.0), soliton(u, v, 1.3, 0.5), 0.7, 1.3)
    assert got == pytest.approx(-1.42434448882123, abs=1e-14)
    assert solitons(u, v, [0.7, 1.3], [1.0, 0.5]) == pytest.approx(got, abs=1e-15)


@pytest.mark.parametrize(("parameters"), [[A], [A, B], [A, B, C], [A, B, C, 2.1]])
def test_solitons_solve_the_equation(parameters: list[float]) -> None:
    """Second order: the defect of samples falls by 4 when the steps are halved."""
    constants = [1.0, 0.5, 2.0, -0.3][: len(parameters)]
    worst = []
    for n in (40, 80, 160):
        u = v = np.linspace(-1.0, 1.0, n + 1)
        phi = solitons(u[:, None], v, parameters, constants)
        worst.append(float(np.abs(sine_gordon_defect(phi, u, v)).max()))
    assert worst[-1] < 0.05
    assert np.log2(worst[0] / worst[1]) == pytest.approx(2.0, abs=0.25)
    assert np.log2(worst[1] / worst[2]) == pytest.approx(2.0, abs=0.1)


def test_breather_solves_the_equation() -> None:
    worst = []
    for n in (40, 80):
        u = v = np.linspace(-3.0, 3.0, n + 1)
        phi = breather_angle(u[:, None], v, 0.6)
        worst.append(float(np.abs(sine_gordon_defect(phi, u, v)).max()))
    assert np.log2(worst[0] / worst[1]) == pytest.approx(2.0, abs=0.1)


def test_order_of_transforms_does_not_matter() -> None:
    u, v = np.linspace(-2, 2, 9)[:, None], np.linspace(-2, 2, 8)
    first = solitons(u, v, [A, B, C], [1.0, 0.5, 2.0])
    for order in ([1, 0, 2], [2, 1, 0], [1, 2, 0]):
        other = solitons(u, v, [[A, B, C][k] for k in order], [[1.0, 0.5, 2.0][k] for k in order])
        turns = (first - other) / (2 * np.pi)  # the angle itself is one up to whole turns
        assert np.abs(turns - np.round(turns)).max() < 1e-12


def test_transform_of_zero_is_a_soliton() -> None:
    u, v = np.linspace(-1.0, 2.0, 7), np.linspace(-1.5, 1.0, 6)
    want = soliton(u[:, None], v, B, 0.5)
    got = baecklund_angle(zero, B, u, v, float(want[0, 0]))
    assert np.abs(got - want).max() < 1e-10


def test_permutability_is_a_transform_of_a_transform() -> None:
    """phi12 by algebra = the transform of phi1 with the other parameter, by integration."""
    u, v = np.linspace(-1.0, 1.5, 7), np.linspace(-1.2, 1.0, 6)
    first, second = soliton(u[:, None], v, A), soliton(u[:, None], v, B, 0.5)
    want = permute(0.0, first, second, A, B)
    got = baecklund_angle(one, B, u, v, float(want[0, 0]))
    assert np.abs(got - want).max() < 1e-10


def test_permute_is_continuous_through_the_pole() -> None:
    """A soliton less an antisoliton passes 2 pi, where the tangent of the formula has its pole."""
    gap = np.linspace(-4 * np.pi, 4 * np.pi, 4001)
    got = permute(0.0, gap, 0.0 * gap, 1.3, 0.7)
    assert np.abs(np.diff(got)).max() < 0.05
    assert np.diff(got).min() > 0


def test_bad_input() -> None:
    with pytest.raises(InputError, match="parameter 0"):
        soliton(0.0, 0.0, 0.0)
    with pytest.raises(DegenerateError, match=r"transforms 0 and 1 .* 0\.7 and -0\.7"):
        permute(0.0, 0.1, 0.2, 0.7, -0.7)
    with pytest.raises(DegenerateError, match="transforms 1 and 2"):
        solitons(0.0, 0.0, [0.5, 0.7, 0.7], [1.0, 1.0, 1.0])
    with pytest.raises(InputError, match="2 parameters and 1 constants"):
        solitons(0.0, 0.0, [0.5, 0.7], [1.0])
    with pytest.raises(InputError, match="rate of a breather is 1"):
        breather_angle(0.0, 0.0, 1.0)
    with pytest.raises(InputError, match="u does not increase at step 1"):
        baecklund_angle(zero, 1.0, [0.0, 1.0, 0.5], [0.0, 1.0], 0.1)
    with pytest.raises(InputError, match=r"angles have shape \(2, 3\)"):
        sine_gordon_defect(np.zeros((2, 3)), [0.0, 1.0], [0.0, 1.0])

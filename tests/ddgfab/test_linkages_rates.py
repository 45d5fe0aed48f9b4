"""Bounds on speeds and accelerations hold, for all kinds, and are not far from the truth."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.linkages import Mechanism, bennett, crab_mechanism, cube, knet_mechanism, taylor_models
from ddgfab.linkages.crab_rates import _second, _steepest, power
from ddgfab.linkages.frames import angular_velocity
from ddgfab.linkages.taylor_models import ORDER, TaylorModel, closing, product
from ddgfab.nets.knet.crab import crab_net
from ddgfab.nets.knet.net import knet

STEPS = 61


def a_knet(m: int, n: int, path: str = "locked") -> Mechanism:
    rng = np.random.default_rng(0)
    deltas = [rng.uniform(0.2, 0.4, size) for size in (m, n)]
    turns = [rng.uniform(-0.15, 0.15, size - 1) for size in (m, n)]
    return knet_mechanism(knet(deltas, turns, 1.4), scale_mm=100.0, path=path)  # type: ignore[arg-type]


TWISTS = np.radians([30.0, 150.0, 90.0])
KINDS = {
    "bennett": lambda: bennett(100.0, np.radians(40), beta=np.radians(70)),
    "cube": lambda: cube(100 * np.sin(TWISTS), TWISTS, corners=(1.0, -1.0), rates=(3.0, -2.0)),
    "knet": lambda: a_knet(5, 4),
    "knet fold": lambda: a_knet(4, 6, "fold"),
    "crab": lambda: crab_mechanism(crab_net(8, 0.45, 0.9, 6), scale_mm=100.0),
    "crab narrow": lambda: crab_mechanism(crab_net(6, 0.35, 0.5, 5), scale_mm=100.0),
}


def truth(mechanism: Mechanism, t: float, half: float) -> tuple[np.ndarray, ...]:
    """Greatest spins, spin rates and accelerations found by differences of exact velocities."""
    ts = t + np.linspace(-half, half, STEPS)
    step = ts[1] - ts[0]
    spins = angular_velocity(*mechanism.moving_frames(ts))
    points, _ = mechanism.drive.place(ts + 1e-30j)
    speeds = points.imag / 1e-30
    # A difference of velocities over a step is a mean of accelerations: no more than their maximum.
    return (
        np.linalg.norm(spins, axis=-1).max(axis=0),
        np.linalg.norm(np.diff(spins, axis=0), axis=-1).max(axis=0) / step,
        np.linalg.norm(np.diff(speeds, axis=0), axis=-1).max(axis=0) / step,
    )


@pytest.mark.parametrize("kind", list(KINDS))
@pytest.mark.parametrize("half", [0.05, 0.01, 0.001])
def test_bounds_hold(kind: str, half: float) -> None:
    mechanism = KINDS[kind]()
    for t in (mechanism.design, mechanism.design - 0.3):
        bounds = mechanism.drive.bounds(np.array([t]), np.array([half]))
        spin, rate, pull = truth(mechanism, t, half)
        slack = 1e-9
        assert (bounds.spin[0] >= spin * (1 - slack) - slack).all()
        assert (bounds.spin_rate[0] >= rate * (1 - slack) - 1e-7).all()
        assert (bounds.acceleration[0] >= pull * (1 - slack) - 1e-6).all()


@pytest.mark.parametrize("kind", list(KINDS))
def test_bounds_are_near_the_truth(kind: str) -> None:
    """Within a small factor on small intervals, so that proofs need few of them."""
    mechanism = KINDS[kind]()
    t, half = mechanism.design, 0.002
    bounds = mechanism.drive.bounds(np.array([t]), np.array([half]))
    _, _, pull = truth(mechanism, t, half)
    assert np.median(bounds.acceleration[0][pull > 1] / pull[pull > 1]) < 4.0


def test_intervals_too_wide_say_so() -> None:
    """No number is better than a wrong one: the disc reaches a pole."""
    mechanism = KINDS["bennett"]()
    bounds = mechanism.drive.bounds(np.array([1.0]), np.array([1.0]))
    assert np.isinf(bounds.acceleration).any()
    assert not np.isnan(bounds.acceleration).any()


def test_several_intervals_at_once() -> None:
    mechanism = KINDS["knet"]()
    ts, half = mechanism.design + np.array([0.0, 0.1, 0.2]), np.array([0.01, 0.02, 0.005])
    together = mechanism.drive.bounds(ts, half)
    for k in range(3):
        alone = mechanism.drive.bounds(ts[k : k + 1], half[k : k + 1])
        assert together.acceleration[k] == pytest.approx(alone.acceleration[0])


def test_closing_angle_is_enclosed() -> None:
    """psi(phi(s)) against the model's polynomial and rest, on the complex disc."""
    rng = np.random.default_rng(2)
    half = np.full(5, 0.02)
    angle = rng.uniform(0.3, 2.8, 5)
    terms = np.zeros((ORDER, 5))
    terms[:3] = rng.uniform(-1, 1, (3, 5))
    ratio = 0.6
    model = closing(ratio, angle, TaylorModel(terms, np.zeros(5)), half)
    for turn in np.linspace(0, 2 * np.pi, 9):
        s = 2 * half * np.exp(1j * turn)
        powers = s[None] ** np.arange(1, ORDER + 1)[:, None]
        phi = angle + (terms * powers).sum(axis=0)
        psi = 2 * np.arctan(ratio / np.tan(phi / 2)) - 2 * np.arctan(ratio / np.tan(angle / 2))
        left = np.abs(psi - (model.terms * powers).sum(axis=0))
        assert (left <= model.rest + 1e-14).all()
        assert (model.rest < 1e-5).all()


@pytest.mark.parametrize("disc", [2.0, 3.0, 6.0])
def test_derivatives_of_the_rest_are_bounded(disc: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Blaschke products, the steepest functions that a disc allows, against Cauchy's estimates.

    On |s| <= R the function rest * b(s / R)^k, b(z) = (z - c) / (1 - c z), has modulus rest at
    most, and nowhere does a function so bounded have greater derivatives at c R than b itself
    (Schwarz and Pick), nor much greater second ones than b^2. At the end of the real interval the
    second derivative of b^2 is more than rest / (R - half)^2 where the disc is wide, so that the
    factor 2 of the estimate is needed; a disc of twice the interval alone would not show it.
    """
    monkeypatch.setattr(taylor_models, "DISC", disc)
    half, rest = 0.3, 0.7
    radius = disc * half
    model = TaylorModel(np.zeros((ORDER, 1)), np.array([rest]))
    first, second = (float(bound[0]) for bound in model.speeds(np.array([half])))
    step = 1e-4 * half
    steepest = np.zeros(2)
    for center in np.linspace(-half, half, 41) / radius:
        for power_of in (1, 2):

            def value(s: np.ndarray, c: float = center, k: int = power_of) -> np.ndarray:
                return np.asarray(rest * ((s / radius - c) / (1 - c * s / radius)) ** k)

            around = radius * np.exp(1j * np.linspace(0, 2 * np.pi, 200))
            assert np.abs(value(around)).max() <= rest * (1 + 1e-12)
            s = np.linspace(-half, half, 81)
            low, here, high = value(s - step), value(s), value(s + step)
            found = np.abs([(high - low) / (2 * step), (high - 2 * here + low) / step**2])
            steepest = np.maximum(steepest, found.max(axis=1))
    assert steepest[0] <= first * (1 + 1e-6)
    assert steepest[1] <= second * (1 + 1e-6)
    assert first < 2 * steepest[0]
    assert second < 2.3 * steepest[1]


def test_polynomials_have_their_own_derivatives() -> None:
    """Without a rest, and all coefficients positive, the bounds are reached at the end."""
    rng = np.random.default_rng(5)
    terms, half = rng.uniform(0.1, 1.0, (ORDER, 3)), np.array([0.1, 0.5, 1.2])
    first, second = TaylorModel(terms, np.zeros(3)).speeds(half)
    for k in range(3):
        polynomial = np.polynomial.Polynomial([0.0, *terms[:, k]])
        assert first[k] == pytest.approx(polynomial.deriv()(half[k]))
        assert second[k] == pytest.approx(polynomial.deriv(2)(half[k]))


def test_series() -> None:
    rng = np.random.default_rng(3)
    series = rng.uniform(0.1, 1.0, (6, 2))
    root = power(series, 0.5)
    assert product(root, root) == pytest.approx(series)
    inverse = power(series, -1.0)
    one = product(inverse, series)
    assert one[0] == pytest.approx([1, 1])
    assert np.abs(one[1:]).max() < 1e-10


@pytest.mark.parametrize("ratio", [0.2, -0.7, 1.0, 3.0])
@pytest.mark.parametrize("around", [0.3, 0.02])
def test_the_slope_of_an_isogram_is_bounded_on_a_disc(ratio: float, around: float) -> None:
    angles = np.linspace(-3.0, 3.0, 13)
    on_disc = around * np.exp(1j * np.linspace(0, 2 * np.pi, 73))
    z = angles[:, None] + on_disc
    slope = np.abs(-2.0 * ratio / ((1 + ratio**2) - (1 - ratio**2) * np.cos(z))).max(axis=1)
    bound = taylor_models._steepest(ratio, angles, np.full(len(angles), around))
    assert (slope <= bound * (1 + 1e-12)).all()
    if around < 0.1:
        assert (bound <= 1.2 * slope).all()


def second_ring(gamma: float, delta: float, z: np.ndarray) -> np.ndarray:
    """y = acos(cos(delta) / M) on the complex plane."""
    c = np.cos(gamma)
    m = np.sqrt((1 + c * c) / 2 + (1 - c * c) / 2 * np.cos(2 * z))
    return np.asarray(np.arccos(np.cos(delta) / m))


@pytest.mark.parametrize("half", [0.05, 0.01])
def test_the_angle_of_the_second_ring_is_enclosed(half: float) -> None:
    """Values on the disc of the model, and slopes on a disc, against the complex function."""
    net = crab_net(8, 0.45, 0.9, 4)
    drive = crab_mechanism(net, scale_mm=1.0).drive
    gamma, delta = float(drive.gamma), float(drive.delta)
    ts, count = np.linspace(0.1, 1.1, 7), 7
    model = _second(drive, ts, np.full(count, half))
    c = np.cos(gamma)
    for turn in np.linspace(0, 2 * np.pi, 17):
        s = 2 * half * np.exp(1j * turn)
        powers = s ** np.arange(1, ORDER + 1)[:, None]
        left = np.abs(
            second_ring(gamma, delta, ts + s)
            - second_ring(gamma, delta, ts.astype(complex))
            - (model.terms * powers).sum(axis=0)
        )
        assert (left <= model.rest + 1e-14).all()
    steep = _steepest(ts, np.full(count, half), np.cos(delta), (1 + c * c) / 2, (1 - c * c) / 2)
    z = ts[:, None] + half * np.exp(1j * np.linspace(0, 2 * np.pi, 49))
    step = 1e-6
    found = np.abs(second_ring(gamma, delta, z + step) - second_ring(gamma, delta, z - step))
    slopes = (found / (2 * step)).max(axis=1)
    assert (slopes <= steep * (1 + 1e-6)).all()
    assert (steep <= 2 * slopes).all()

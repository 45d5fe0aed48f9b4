"""Bounds on speeds and accelerations hold, for all kinds, and are not far from the truth."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.linkages import Mechanism, bennett, crab_mechanism, cube, knet_mechanism
from ddgfab.linkages.crab_rates import power
from ddgfab.linkages.frames import angular_velocity
from ddgfab.linkages.models import ORDER, Model, closing, product
from ddgfab.nets.knet import knet
from ddgfab.nets.knet_crab import crab_net

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
    model = closing(ratio, angle, Model(terms, np.zeros(5)), half)
    for turn in np.linspace(0, 2 * np.pi, 9):
        s = 2 * half * np.exp(1j * turn)
        powers = s[None] ** np.arange(1, ORDER + 1)[:, None]
        phi = angle + (terms * powers).sum(axis=0)
        psi = 2 * np.arctan(ratio / np.tan(phi / 2)) - 2 * np.arctan(ratio / np.tan(angle / 2))
        left = np.abs(psi - (model.terms * powers).sum(axis=0))
        assert (left <= model.rest + 1e-14).all()
        assert (model.rest < 1e-5).all()


def test_series() -> None:
    rng = np.random.default_rng(3)
    series = rng.uniform(0.1, 1.0, (6, 2))
    root = power(series, 0.5)
    assert product(root, root) == pytest.approx(series)
    inverse = power(series, -1.0)
    one = product(inverse, series)
    assert one[0] == pytest.approx([1, 1])
    assert np.abs(one[1:]).max() < 1e-10

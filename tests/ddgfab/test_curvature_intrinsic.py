"""Brioschi's formula: torus, sphere, the angle of a Chebyshev net, sampled nets, bad input."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ddgfab.curvature import MetricJet, brioschi, gauss_curvature, metric_of, net_curvature
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats
from ddgfab.surfaces import dini, soliton

U, V = np.linspace(-1.0, 1.2, 5)[:, None], np.linspace(-0.7, 1.0, 4)


def torus(u: Any, v: Any) -> Any:
    out = 3.0 + np.cos(u)
    return np.stack([out * np.cos(v), out * np.sin(v), np.sin(u)], axis=-1)


def test_torus() -> None:
    """mathematics.md 5.1: K = cos u / (3 + cos u)."""
    want = np.cos(U) / (3.0 + np.cos(U)) + 0.0 * V
    assert np.abs(gauss_curvature(metric_of(torus), U, V) - want).max() < 1e-10


def test_skew_parameters_change_nothing() -> None:
    """The same torus with F far from 0: K belongs to the surface."""

    def skew(u: Any, v: Any) -> Any:
        return torus(u + 0.4 * np.sin(v), v + 0.3 * u)

    want = np.cos(U + 0.4 * np.sin(V))
    want = want / (3.0 + want)
    assert np.abs(gauss_curvature(metric_of(skew), U, V) - want).max() < 1e-9


def test_chebyshev_net_has_the_sine_gordon_curvature() -> None:
    """mathematics.md 5.1: E = G = 1, F = cos phi gives phi_uv = -K sin phi, for any phi."""

    def angle(u: Floats, v: Floats) -> Floats:
        return np.asarray(1.2 + 0.3 * np.sin(u + 2 * v) + 0.2 * u * v)

    def metric(u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
        phi = angle(u, v)
        return np.ones_like(phi), np.cos(phi), np.ones_like(phi)

    mixed = -0.6 * np.sin(U + 2 * V) + 0.2
    got = gauss_curvature(metric, U, V)
    assert np.abs(got + mixed / np.sin(angle(U, V))).max() < 1e-9


def test_soliton_metric_has_curvature_minus_one() -> None:
    def metric(u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
        phi = soliton(u, v, 0.7)
        return np.ones_like(phi), np.cos(phi), np.ones_like(phi)

    got = gauss_curvature(metric, np.array([-1.0, -0.6, 0.5]), np.array([0.2, -0.4, 0.7]), 0.01)
    assert np.abs(got + 1.0).max() < 1e-8


def test_curvature_scales_with_the_inverse_square() -> None:
    for size in (1e-6, 1e6):
        got = gauss_curvature(metric_of(lambda u, v, s=size: s * torus(u, v)), U, V)
        want = np.cos(U) / (3.0 + np.cos(U)) / size**2 + 0.0 * V
        assert np.abs(got - want).max() < 1e-9 / size**2


def test_given_derivatives() -> None:
    """Polar coordinates E = 1, G = u^2 of the plane, and G = sin^2 u of the sphere."""
    u = np.array([0.3, 0.8, 1.4])
    o, i = np.zeros_like(u), np.ones_like(u)
    plane = MetricJet(i, o, u**2, o, o, o, o, 2 * u, o, o, o, 2 * i)
    assert np.abs(brioschi(plane)).max() < 1e-14
    g, g_u, g_uu = np.sin(u) ** 2, np.sin(2 * u), 2 * np.cos(2 * u)
    sphere = MetricJet(i, o, g, o, o, o, o, g_u, o, o, o, g_uu)
    assert np.abs(brioschi(sphere) - 1.0).max() < 1e-13


def test_sampled_net_converges_with_order_two() -> None:
    """On a K-surface in its asymptotic lines, at one point of the surface."""
    worst = []
    for n in (10, 20, 40):
        u, v = np.linspace(0.5, 1.0, n + 1), np.linspace(2.0, 2.5, n + 1)
        got = net_curvature(dini(u[:, None], v).points, 0.5 / n, 0.5 / n)
        assert got.shape == (n - 3, n - 3)
        worst.append(abs(float(got[n // 2 - 2, n // 2 - 2]) + 1.0))
    assert np.log2(worst[0] / worst[1]) == pytest.approx(2.0, abs=0.1)
    assert np.log2(worst[1] / worst[2]) == pytest.approx(2.0, abs=0.1)


def test_bad_input() -> None:
    def cone(u: Any, v: Any) -> Any:
        return np.stack([u * np.cos(v), u * np.sin(v), u], axis=-1)

    with pytest.raises(DegenerateError, match=r"metric at \(1, 0\).*E G - F\^2 = 0"):
        gauss_curvature(metric_of(cone), np.array([[1.0], [0.0]]), np.array([0.5]))
    with pytest.raises(InputError, match="step of the differences is 0"):
        gauss_curvature(metric_of(torus), U, V, 0.0)
    with pytest.raises(InputError, match=r"shape \(4, 5, 3\)"):
        net_curvature(np.zeros((4, 5, 3)), 0.1, 0.1)
    with pytest.raises(InputError, match=r"steps 0\.1, -1"):
        net_curvature(np.zeros((5, 5, 3)), 0.1, -1.0)
    with pytest.raises(DegenerateError, match=r"\(0, 0\)"):
        net_curvature(np.zeros((5, 5, 3)), 0.1, 0.1)

"""Discrete Kuen surfaces: K-nets in closed form, limits of breathers, smooth limit."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.errors import InputError
from ddgfab.nets.knet import breather, dini, kuen, vacuum
from ddgfab.surfaces import kuen as smooth_kuen

ALPHAS, BETAS = np.linspace(0.1, 0.3, 12), np.linspace(0.2, 0.1, 9)


@pytest.mark.parametrize("r", [1.0, 3000.0, 1e-6])
def test_is_a_knet(r: float) -> None:
    net = kuen(ALPHAS, BETAS, t0=0.7, shift=1.5, r=r)
    assert max(net.residuals().values()) < 1e-12


def test_is_the_limit_of_breathers() -> None:
    """The distance falls with tau^2."""
    want = kuen(ALPHAS, BETAS, t0=0.7).points
    apart = [
        np.abs(breather(ALPHAS, BETAS, tau, t0=0.7).points - want).max() for tau in (0.1, 0.05)
    ]
    assert np.log2(apart[0] / apart[1]) == pytest.approx(2.0, abs=0.05)


def test_is_a_transform_of_the_transform_of_the_line() -> None:
    """Both steps of sigma = pi / 2: segments of length 1, tangent at both ends, normals across."""
    line, net = vacuum(ALPHAS, BETAS), kuen(ALPHAS, BETAS, t0=0.7, shift=0.3)
    middle = dini(ALPHAS, BETAS, np.pi / 2, t0=0.7)
    for one, two in ((line, middle), (middle, net)):
        step = two.points - one.points
        assert np.abs(np.linalg.norm(step, axis=-1) - 1.0).max() < 1e-13
        for a, b in ((step, one.normals), (step, two.normals), (one.normals, two.normals)):
            assert np.abs(np.einsum("ijk,ijk->ij", a, b)).max() < 1e-13


def test_converges_to_the_smooth_surface_with_order_two() -> None:
    worst = []
    for n in (10, 20, 40):
        angles, at = np.full(n, 1.0 / n), np.arange(n + 1) / n
        smooth = smooth_kuen(at[:, None], at)
        net = kuen(angles, angles)
        worst.append(float(np.abs(net.points - smooth.points).max()))
        assert np.abs(net.normals - smooth.normals).max() < 2 * worst[-1]
    assert np.log2(worst[0] / worst[1]) == pytest.approx(2.0, abs=0.02)
    assert np.log2(worst[1] / worst[2]) == pytest.approx(2.0, abs=0.01)


def test_bad_input() -> None:
    with pytest.raises(InputError, match=r"t0 = 0"):
        kuen(ALPHAS, BETAS, t0=0.0)
    with pytest.raises(InputError, match="alpha 1"):
        kuen([0.1, np.pi / 2], BETAS)
    with pytest.raises(InputError, match="beta 0"):
        kuen(ALPHAS, [np.pi / 2])
    with pytest.raises(InputError, match="alpha 2"):
        kuen([0.1, 0.2, -0.1], BETAS)

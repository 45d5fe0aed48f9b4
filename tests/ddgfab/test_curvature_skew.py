"""Curvature of skew quads: exact on K-nets, spheres and planes as limits, the printed numbers."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.curvature import knet_curvature, skew_curvature, unit_curvature_scale
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats
from ddgfab.nets.knet.net import KNet, knet

RNG = np.random.default_rng(7)


def random_net(r: float, constant: float | None = None) -> KNet:
    m, n = 9, 7
    deltas = [
        RNG.uniform(0.1, 0.5, k) if constant is None else np.full(k, constant) for k in (m, n)
    ]
    turns = [RNG.uniform(-0.3, 0.3, k - 1) for k in (m, n)]
    return knet(deltas, turns, 1.2, r=r)


def printed_quad() -> tuple[Floats, Floats]:
    """The quad of mathematics.md 3.4, from its normals."""
    n, n1 = np.array([0.0, 0, 1]), np.array([np.sqrt(0.19), 0, 0.9])
    n2 = np.array([0.0, -0.6, 0.8])
    s = n1 + n2
    n12 = -n + 2 * (n @ s) / (s @ s) * s
    x1, x2 = np.cross(n, n1), -np.cross(n, n2)
    x12 = x1 - np.cross(n1, n12)
    return np.array([[0 * n, x2], [x1, x12]]), np.array([[n, n2], [n1, n12]])


def test_printed_numbers() -> None:
    gauss, mean = skew_curvature(*printed_quad())
    assert gauss[0, 0] == pytest.approx(-1.176470588235, abs=1e-12)
    assert mean[0, 0] == pytest.approx(0.083219432875, abs=1e-12)
    assert knet_curvature([0.3], [0.3])[0, 0] == pytest.approx(-1.0467516, abs=1e-7)


@pytest.mark.parametrize("r", [1.0, 7.0, 1e-6, 1e6])
def test_exact_on_knets_whatever_the_angles(r: float) -> None:
    net = random_net(r)
    gauss, _ = skew_curvature(net.points, net.normals)
    want = knet_curvature(net.deltas[0], net.deltas[1], r)
    assert np.abs(gauss / want - 1).max() < 1e-11


def test_mean_curvature_formula() -> None:
    """mathematics.md 8.3: H from the angle between n1 and n2 alone."""
    net = random_net(1.0)
    _, mean = skew_curvature(net.points, net.normals)
    n = net.normals
    c1, c2 = np.cos(net.deltas[0])[:, None], np.cos(net.deltas[1])
    c = np.einsum("ijk,ijk->ij", n[1:, :-1], n[:-1, 1:])
    d = np.einsum("ijk,ijk->ij", n[:-1, :-1], np.cross(n[1:, :-1], n[:-1, 1:]))
    want = ((1 - c) + (c1 + c2) - 2 * (1 + c) / (c1 + c2)) / (2 * d)
    assert np.abs(mean / want - 1).max() < 1e-9


def test_normalised_to_minus_one() -> None:
    net = random_net(unit_curvature_scale(0.3, 0.3), 0.3)
    gauss, _ = skew_curvature(net.points, net.normals)
    assert np.abs(gauss + 1).max() < 1e-12


def test_tends_to_minus_one_with_order_two() -> None:
    """At scale 1, K + 1 falls with delta^2 / 2."""
    for delta in (0.1, 0.05):
        assert knet_curvature([delta], [delta])[0, 0] + 1 == pytest.approx(
            -(delta**2) / 2, rel=delta**2
        )


def test_sphere() -> None:
    """Outward normals of a sphere: K = 1 / R^2 and H = -1 / R exactly, also on skew quads."""
    n = RNG.normal(size=(5, 4, 3)) * 0.1 + [0, 0, 1]
    n[..., 0] += 0.5 * np.arange(5)[:, None]
    n[..., 1] += 0.5 * np.arange(4)
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    gauss, mean = skew_curvature(3.0 * n, n)
    assert np.abs(gauss - 1 / 9).max() < 1e-12
    assert np.abs(mean + 1 / 3).max() < 1e-12


def test_bad_input() -> None:
    points, normals = printed_quad()
    with pytest.raises(InputError, match=r"normal at \(0, 1\) has length 1\.5"):
        skew_curvature(points, normals * [[[1.0], [1.5]], [[1.0], [1.0]]])
    with pytest.raises(InputError, match=r"points \(2, 2, 3\) and normals \(1, 2, 3\)"):
        skew_curvature(points, normals[:1])
    with pytest.raises(DegenerateError, match=r"quad \(0, 0\): the diagonals of its normals"):
        skew_curvature(points, np.broadcast_to(normals[0, 0], points.shape))
    with pytest.raises(DegenerateError, match=r"quad \(0, 0\): the diagonals of its points"):
        skew_curvature(np.zeros_like(points), normals)
    with pytest.raises(InputError, match=r"direction 1: delta 1 = 1\.6 rad"):
        knet_curvature([0.3], [0.3, 1.6])
    with pytest.raises(InputError, match="scale of a K-net is 0"):
        knet_curvature([0.3], [0.3], 0.0)
    with pytest.raises(InputError, match=r"direction 0: delta 0 = -0\.1 rad"):
        unit_curvature_scale(-0.1, 0.3)

"""Minimal nets converge to smooth minimal surfaces with the order that the theory gives."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from net_cases import apart

from ddgfab.mesh import unit
from ddgfab.nets.minimal import (
    MinimalNet,
    catenoid,
    enneper,
    scherk,
    schwarz_p,
)
from ddgfab.surfaces import smooth_catenoid, smooth_enneper, smooth_scherk_tower, smooth_schwarz_p


def orders(errors: list[float]) -> list[float]:
    return [float(np.log2(a / b)) for a, b in pairwise(errors)]


def test_enneper_converges_with_order_two() -> None:
    errors = []
    for n in (4, 8, 16, 32):
        h = 0.6 / n
        line = h * (2.0 * np.arange(n + 1) - n)
        smooth = 2 * np.swapaxes(smooth_enneper().net(line, line), 0, 1).reshape(-1, 3)
        errors.append(apart(enneper((n, n), h).mesh.vertices, smooth))
    assert np.abs(np.array(orders(errors)) - 2).max() < 0.05


def test_catenoid_converges_with_order_two() -> None:
    errors = []
    for n in (12, 24, 48, 96):
        rings = n // 12
        step = 2 * np.arcsinh(np.tan(np.pi / n))
        u, v = step * np.arange(-rings, rings + 1), 2 * np.pi / n * np.arange(n)
        smooth = np.swapaxes(smooth_catenoid().net(u, v), 0, 1).reshape(-1, 3)
        errors.append(apart(catenoid(n, (-rings, rings)).mesh.vertices, smooth))
    assert np.abs(np.array(orders(errors)) - 2).max() < 0.1


def on_normals(net: MinimalNet) -> np.ndarray:
    """Parameters z = g at which the smooth surface has the directions of the Koebe vertices."""
    n = unit(net.gauss.mesh.vertices)
    return np.asarray((n[:, 0] + 1j * n[:, 1]) / (1 + n[:, 2]))


def test_scherk_converges_with_order_two() -> None:
    """At equal normals, with equal heights of the arcs."""
    smooth, errors = smooth_scherk_tower(), []
    for cells in (12, 24, 48):
        net = scherk(cells)
        net = net.scaled(0.5 * np.pi / float(net.mesh.vertices[:, 2].max()))
        z = on_normals(net) * np.exp(0.25j * np.pi)
        near = np.abs(z) < 0.7
        errors.append(apart(net.mesh.vertices[near], smooth.points(z[near])))
    assert np.abs(np.array(orders(errors)) - 2).max() < 0.2
    assert errors[-1] < 2e-3


def test_schwarz_p_converges_with_order_two() -> None:
    """At equal normals, with equal sides of the square."""
    smooth, errors = smooth_schwarz_p(), []
    # The way to the corner ends in a branch point, f like 1 / sqrt: z = c (1 - s^2) along it.
    node, weight = np.polynomial.legendre.leggauss(40)
    s = 0.5 * (node + 1)
    corner = (7 - 4 * 3**0.5) ** 0.25 * np.exp(0.25j * np.pi)
    z = corner * (1 - s**2)
    form = smooth.f(z) * corner * s * weight
    across = np.hypot(
        float((form * (1 - z**2)).sum().real / 2), float((1j * form * (1 + z**2)).sum().real / 2)
    )
    for cells in (4, 8, 16, 32):
        net = schwarz_p(cells)
        corners = net.mesh.vertices[net.mesh.valences == 2]
        reach = np.linalg.norm(corners - corners.mean(axis=0), axis=1).mean()
        net = net.scaled(across / float(reach))
        z = on_normals(net)
        near = np.abs(z) < 0.35
        errors.append(apart(net.mesh.vertices[near], smooth.points(z[near])))
    assert np.abs(np.array(orders(errors)) - 2).max() < 0.25, errors
    assert errors[-1] < 1e-3

"""Smooth Ribaucour transforms, and limits in one direction only: semidiscrete surfaces."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from test_surfaces_limits import one_soliton, orders
from test_surfaces_sequences import START, isothermic

from ddgfab.errors import DdgError
from ddgfab.mesh import Floats
from ddgfab.nets.knet import knet
from ddgfab.surfaces import ellipsoid_patch, smooth_darboux, smooth_ribaucour, surface_of
from ddgfab.transforms import darboux, ribaucour

U, V = np.linspace(5.0, 7.0, 9), np.linspace(1.8, 3.0, 7)
FIRST = np.array([1.0, 2.0, 3.0])


def test_equal_constant_rates_are_an_inversion() -> None:
    """Closed form: p = c (x - m), so x' lies on the ray from m to x, at the inverse distance."""
    x = ellipsoid_patch(U[:, None], V[None])
    away = (x[0, 0] - FIRST) / np.linalg.norm(x[0, 0] - FIRST)
    for c in (0.3, -0.2):
        made = smooth_ribaucour(ellipsoid_patch, U, V, FIRST, (c, c))
        middle = x[0, 0] - away / c
        ray = x - middle
        power = (FIRST - middle) @ (x[0, 0] - middle)  # of the inversion, and of its mirror image
        image = middle + power * ray / (ray**2).sum(axis=-1, keepdims=True)
        np.testing.assert_allclose(made(*np.meshgrid(U, V, indexing="ij")), image, atol=1e-12)
    mirrored = smooth_ribaucour(ellipsoid_patch, U, V, FIRST, (0.0, 0.0))
    turned = x - 2 * ((x - 0.5 * (x[0, 0] + FIRST)) @ away)[..., None] * away
    np.testing.assert_allclose(mirrored(*np.meshgrid(U, V, indexing="ij")), turned, atol=1e-12)


def test_both_surfaces_envelop_spheres_in_lines_of_curvature() -> None:
    rates = (lambda u: 0.2 + 0.1 * np.sin(u), lambda v: 0.05 * v - 0.1)
    one = smooth_ribaucour(ellipsoid_patch, U, V, FIRST, rates)
    two = smooth_ribaucour(one, U, V, (3.0, 1.0, 0.0), (0.1, lambda v: 0.2 * v))  # a sequence
    u, v = np.meshgrid(U[1:-1], V[1:-1], indexing="ij")
    h = 1e-4
    sheets = []
    for sheet in (ellipsoid_patch, one, two):
        du = (np.asarray(sheet(u + h, v)) - sheet(u - h, v)) / (2 * h)
        dv = (np.asarray(sheet(u, v + h)) - sheet(u, v - h)) / (2 * h)
        n = np.cross(du, dv)
        n /= np.linalg.norm(n, axis=-1, keepdims=True)
        assert np.abs((du * dv).sum(axis=-1)).max() < 1e-6 * np.abs(du * du).sum(axis=-1).max()
        sheets.append((np.asarray(sheet(u, v)), n, du))
    for (x, n, du), (y, m, ey) in ((sheets[0], sheets[1]), (sheets[1], sheets[2])):
        way = y - x
        way /= np.linalg.norm(way, axis=-1, keepdims=True)
        for before, after in ((n, m), (du, ey)):  # tangents and normals are mirror images
            image = before - 2 * (before * way).sum(axis=-1, keepdims=True) * way
            assert np.abs(np.cross(image, after)).max() < 1e-5 * np.abs(after).max()


def torus(u: Floats, v: Floats) -> Floats:
    far = 3.0 + np.cos(v)
    return np.stack([far * np.cos(u), far * np.sin(u), np.sin(v)], axis=-1)


RATES = (lambda u: 0.3 + 0.2 * u, lambda v: 0.1 - 0.3 * v)
SMOOTH = smooth_ribaucour(torus, [0.0, 0.8], [0.2, 1.0], (5.0, 1.0, 2.0), RATES)


def circular(n: int, m: int) -> Floats:
    """The discrete transform of n x m cells of the torus, which are isosceles trapezoids.

    Along the axes by the cross-ratios of the smooth one.
    """
    u, v = 0.8 * np.arange(n + 1) / n, 0.2 + 0.8 * np.arange(m + 1) / m
    x = torus(*np.meshgrid(u, v, indexing="ij"))
    ratios = []
    for line, image in ((x[:, 0], SMOOTH(u, 0 * u + 0.2)), (x[0], SMOOTH(0 * v, v))):
        across = np.linalg.norm(image - line, axis=1)
        along = [np.linalg.norm(np.diff(side, axis=0), axis=1) for side in (line, image)]
        turn = np.einsum("ij,ij->i", np.diff(line, axis=0), np.diff(image, axis=0))
        mirror = np.einsum("ij,ij->i", np.diff(line, axis=0), (image - line)[:-1])
        mirror *= np.einsum("ij,ij->i", np.diff(image, axis=0), (image - line)[:-1])
        same = np.sign(turn - 2 * mirror / across[:-1] ** 2)  # edges of one side of the sphere
        q = -same * along[0] * along[1] / (across[1:] * across[:-1])
        ratios.append(1.0 / (1.0 - q))
    return ribaucour(x, (5.0, 1.0, 2.0), ratios)


def asymptotic(n: int, m: int) -> Floats:
    """K-net with n x m cells on 0 <= u, v <= 1 from the turns of the soliton's asymptotic lines."""
    a, b = 1.0 / n, 1.0 / m
    u, v = np.arange(1, n) / n, np.arange(1, m) / m
    turns = [-a * one_soliton(u, 0 * u)[1], b * one_soliton(0 * v, v)[2]]
    phi, phi_u, phi_v = (float(value) for value in one_soliton(np.zeros(()), np.zeros(())))
    bend_u, bend_v = -0.5 * a * phi_u, 0.5 * b * phi_v
    edge = [np.cos(bend_u), np.sin(bend_u), 0.0]
    made = knet([np.full(n, a), np.full(m, b)], turns, phi + bend_v - bend_u, edge=edge)
    return made.points


def isothermic_transform(n: int, m: int) -> Floats:
    u, v = 0.4 * np.arange(n + 1) / n, 0.4 * np.arange(m + 1) / m
    x = isothermic(*np.meshgrid(u, v, indexing="ij"))
    return darboux(x, -1.0 / 0.8, START, labels=[np.full(n, u[1] ** 2), np.full(m, -(v[1] ** 2))])


def smooth(kind: str, m: int) -> Floats:
    """The smooth surface at five parameters u, and at m + 1 parameters v."""
    part, at = np.arange(5) / 4, np.arange(m + 1) / m
    if kind == "circular":
        return SMOOTH(*np.meshgrid(0.8 * part, 0.2 + 0.8 * at, indexing="ij"))
    if kind == "k":
        return surface_of(one_soliton, part, at).points
    return smooth_darboux(isothermic, 0.4 * part, 0.4 * at, 0.8, START)


@pytest.mark.parametrize(
    ("kind", "net"),
    [("circular", circular), ("k", asymptotic), ("isothermic", isothermic_transform)],
)
def test_discrete_nets_tend_to_semidiscrete_and_these_to_smooth_ones(
    kind: str, net: Callable[[int, int], Floats]
) -> None:
    """Steps of u to zero while those of v stay: order 2. Then those of v: order 2."""
    last = []
    for m in (4, 8, 16):
        nets = [net(n, m)[:: n // 4] for n in (16, 32, 64)]
        steps = [float(np.abs(b - a).max()) for a, b in pairwise(nets)]
        assert orders(steps) == pytest.approx([2.0], abs=0.1)
        semidiscrete = nets[2] + (nets[2] - nets[1]) / 3
        last.append(float(np.abs(semidiscrete - smooth(kind, m)).max()))
    assert orders(last) == pytest.approx([2.0, 2.0], abs=0.25)


def test_refusals() -> None:
    with pytest.raises(DdgError, match=r"no lines of curvature at u = .* cosine of their angle"):
        smooth_ribaucour(lambda u, v: torus(u + 0.3 * v, v), U / 10, V, FIRST, (0.1, 0.1))
    with pytest.raises(DdgError, match="the start lies on the surface"):
        smooth_ribaucour(torus, U, V, torus(U[0], V[0]), (0.1, 0.1))
    with pytest.raises(DdgError, match="do not resolve the surface"):
        smooth_ribaucour(torus, [0, 60.0], V, FIRST, (0.1, 0.1))
    with pytest.raises(DdgError, match="three finite numbers"):
        smooth_ribaucour(torus, U, V, (0.0, np.nan, 1.0), (0.1, 0.1))
    with pytest.raises(DdgError, match="not finite"):
        smooth_ribaucour(torus, U, V, FIRST, (np.inf, 0.1))

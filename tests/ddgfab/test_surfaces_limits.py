"""K-nets tend to smooth K-surfaces: orders of convergence of points, angles and curvature."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.curvature import skew_curvature
from ddgfab.mesh import Floats
from ddgfab.nets.knet import KNet, crab_net, hirota_potential, knet, pseudosphere
from ddgfab.nets.knet import amsler as amsler_net
from ddgfab.nets.knet import breather as breather_net
from ddgfab.nets.knet import dini as dini_net
from ddgfab.surfaces import (
    amsler,
    amsler_angle,
    breather,
    dini,
    rotational_lines,
    soliton,
    surface_of,
)


def orders(errors: list[float]) -> Floats:
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


def one_soliton(u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
    sech = 1.0 / np.cosh(0.8 * u + v / 0.8)
    return soliton(u, v, 0.8), 1.6 * sech, 2.5 * sech


def net_of_soliton(n: int) -> KNet:
    """K-net on 0 <= u, v <= 1 whose axes turn as the smooth lines do: by -phi_u du and phi_v dv."""
    step, inner = 1.0 / n, np.arange(1, n) / n
    turns = [-step * one_soliton(inner, 0 * inner)[1], step * one_soliton(0 * inner, inner)[2]]
    phi, phi_u, phi_v = (float(value) for value in one_soliton(np.zeros(()), np.zeros(())))
    # The first edges are chords: they leave the tangents by half a turn.
    bend_u, bend_v = -0.5 * step * phi_u, 0.5 * step * phi_v
    edge = [np.cos(bend_u), np.sin(bend_u), 0.0]
    return knet([np.full(n, step)] * 2, turns, phi + bend_v - bend_u, edge=edge)


def test_amsler_table() -> None:
    """mathematics.md 3.14: the angle of the last cell against f(((M + 1/2) / M)^2), printed
    numbers."""
    start, errors = np.pi / 3, []
    for m in (8, 16, 32, 64):
        net = amsler_net(np.full(m + 1, 1 / m), np.full(m + 1, 1 / m), start)
        x, n = net.points, net.normals[m, m]
        one, two = x[m + 1, m] - x[m, m], x[m, m + 1] - x[m, m]
        angle = np.arctan2(n @ np.cross(one, two), one @ two)
        errors.append(abs(float(angle - amsler_angle(((m + 0.5) / m) ** 2, start)[0])))
    for got, printed in zip(errors, (4.3e-4, 1.6e-4, 4.7e-5, 1.3e-5), strict=True):
        assert float(f"{got:.1e}") == printed
    assert orders(errors)[-1] > 1.8


def test_amsler_net_tends_to_the_surface() -> None:
    """Points on u = v = 1 with second order; the smooth surface by integration of its frame."""
    start, errors = 1.2, []
    smooth = amsler([0.0, 0.5, 1.0], [0.0, 0.5, 1.0], start)
    for m in (8, 16, 32):
        net = amsler_net(np.full(m, 1 / m), np.full(m, 1 / m), start)
        half = m // 2
        errors.append(float(np.abs(net.points[::half, ::half] - smooth.points).max()))
    assert orders(errors) == pytest.approx([2.0, 2.0], abs=0.1)


def test_pseudosphere_distance_is_the_closed_form() -> None:
    """mathematics.md 3.9: at equal radius, rings stand s (1 - sin(alpha) / L) off the smooth
    ones."""
    for n in (8, 16, 32):
        alpha = np.pi / n
        step = np.log(np.tan(np.pi / 4 + alpha / 2))
        column = pseudosphere((1, 12), alpha).points[0]
        s = step * np.arange(13)
        smooth = np.tanh(s) - s
        assert np.abs(np.hypot(column[:, 0], column[:, 1]) - 1 / np.cosh(s)).max() < 1e-14
        gap = column[:, 2] - smooth
        assert np.abs(gap - s * (1 - np.sin(alpha) / step)).max() < 1e-14
        assert gap[1:] / s[1:] == pytest.approx(alpha**2 / 3, rel=2 * alpha**2)


@pytest.mark.parametrize("kind", ["dini", "breather"])
def test_closed_forms_tend_to_their_surfaces_with_order_two(kind: str) -> None:
    errors = []
    for n in (10, 20, 40):
        angles, at = np.full(n, 1.2 / n), 1.2 * np.arange(n + 1) / n
        if kind == "dini":
            net, smooth = dini_net(angles, angles, 1.1, t0=0.6), dini(at[:, None], at, 1.1, 0.6)
        else:
            start = 0.7 + 0.3j
            net = breather_net(angles, angles, 0.8, t0=start)
            smooth = breather(at[:, None], at, 0.8, start)
        errors.append(float(np.abs(net.points - smooth.points).max()))
        assert np.abs(net.normals - smooth.normals).max() < 3 * errors[-1]
    assert orders(errors) == pytest.approx([2.0, 2.0], abs=0.05)


def test_crab_nets_tend_to_waisted_surfaces() -> None:
    """From a ring of horizontal normals: waist and rings against the smooth ones, second order.

    Both keep radius^2 - cos^2 of the normals' angle with the axis: the waist's square.
    """
    waist, widths, heights = 0.8, [], []
    for n in (20, 40, 80):
        delta = np.pi / n * np.hypot(1.0, waist)  # a step up and half a step round, at the waist
        net = crab_net(n, delta, np.pi / 2, n // 4 + 1)
        assert np.ptp(net.radii**2 - np.cos(net.thetas) ** 2) < 1e-13
        widths.append(abs(float(net.radii[0]) - waist))
        u = np.arccosh(net.radii[1:] / net.radii[0])
        smooth = rotational_lines(u, 0.0, float(net.radii[0]))
        heights.append(float(np.abs(net.heights[1:] - smooth[:, 2]).max()))
    assert orders(widths) == pytest.approx([2.0, 2.0], abs=0.05)
    assert orders(heights) == pytest.approx([2.0, 2.0], abs=0.1)


def test_hirota_equation_tends_to_sine_gordon() -> None:
    """Cauchy data from a soliton: angle and second difference of h tend to phi and sin(phi).

    (h_12 - h_1 - h_2 + h) / eps^2 -> sin(phi), both with second order; mathematics.md 3.8.
    """
    angle_errors, equation_errors = [], []
    for n in (16, 32, 64):
        net = net_of_soliton(n)
        x, middle = net.points, (np.arange(n) + 0.5) / n
        one, two = np.diff(x, axis=0)[:, :-1], np.diff(x, axis=1)[:-1]
        sine = np.einsum("ijk,ijk->ij", net.normals[:-1, :-1], np.cross(one, two))
        angle = np.arctan2(sine, np.einsum("ijk,ijk->ij", one, two))
        gap = angle - soliton(middle[:, None], middle, 0.8)
        angle_errors.append(float(np.abs(np.remainder(gap + np.pi, 2 * np.pi) - np.pi).max()))
        h = hirota_potential(net)
        mixed = np.diff(np.diff(h, axis=0), axis=1) * n**2
        mean = 0.25 * (h[1:, 1:] + h[1:, :-1] + h[:-1, 1:] + h[:-1, :-1])
        equation_errors.append(float(np.abs(mixed - np.sin(mean)).max()))
    assert orders(equation_errors) == pytest.approx([2.0, 2.0], abs=0.1)
    assert orders(angle_errors) == pytest.approx([2.0, 2.0], abs=0.1)


def test_net_of_a_soliton_tends_to_its_surface() -> None:
    """A K-net from the turns of two asymptotic lines against the surface of the same solution."""
    errors = []
    for n in (8, 16, 32):
        at = np.arange(n + 1) / n
        smooth = surface_of(one_soliton, at, at)
        errors.append(float(np.abs(net_of_soliton(n).points - smooth.points).max()))
    assert orders(errors) == pytest.approx([2.0, 2.0], abs=0.15)


def test_curvature_of_skew_quads_tends_to_minus_one() -> None:
    errors = []
    for n in (10, 20, 40):
        angles = np.full(n, 1.0 / n)
        net = dini_net(angles, angles, 1.1, t0=0.6)
        errors.append(float(np.abs(skew_curvature(net.points, net.normals)[0] + 1.0).max()))
    assert orders(errors) == pytest.approx([2.0, 2.0], abs=0.05)

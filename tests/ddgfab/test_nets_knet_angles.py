"""Angles of K-nets, the skew parallelogram, and Hirota's equation on a potential."""

from __future__ import annotations

import numpy as np
import pytest
from knet_cases import EXACT, any_knet

from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import unit
from ddgfab.nets.knet import (
    KNet,
    amsler,
    angle_coefficient,
    angle_relation_defect,
    breather,
    chi_of_phi,
    evolve_hirota,
    hirota_potential,
    hirota_residual,
    knet,
    product_defect,
    quad_angles,
    skew_parallelogram,
    vertex_angle_defect,
)


def nets() -> dict[str, KNet]:
    """Uneven, folding over several times, and with angles for which k > 1."""
    rng = np.random.default_rng(1)
    wide = [rng.uniform(1.7, 2.4, 6), rng.uniform(1.4, 2.0, 5)]
    return {
        "uneven": any_knet(9, 12),
        "breather": breather(np.full(20, np.pi / 16), np.full(20, np.pi / 16), 0.8, t0=0.7 + 0.3j),
        "wide": knet(wide, [0.3 * rng.normal(size=5), 0.3 * rng.normal(size=4)], 1.0),
    }


def modulo(angles: np.ndarray) -> np.ndarray:
    return np.remainder(angles + np.pi, 2 * np.pi) - np.pi


@pytest.mark.parametrize("name", ["uneven", "breather", "wide"])
def test_exact_relations_of_angles(name: str) -> None:
    net = nets()[name]
    phi, phi_12, psi_1, psi_2 = quad_angles(net)
    assert np.abs(modulo(phi - phi_12)).max() < EXACT
    assert np.abs(modulo(psi_1 - psi_2)).max() < EXACT
    a, b = net.deltas
    ratio = np.cos((a[:, None] + b) / 2) / np.cos((a[:, None] - b) / 2)
    assert np.allclose((1 - angle_coefficient(a, b)) / (1 + angle_coefficient(a, b)), ratio)
    # Multiplied out, so that right angles and folds do no harm.
    left = np.sin(phi / 2) * np.sin(psi_1 / 2)
    assert np.allclose(left, ratio * np.cos(phi / 2) * np.cos(psi_1 / 2), atol=EXACT)
    assert np.abs(angle_relation_defect(net)).max() < EXACT
    assert np.abs(vertex_angle_defect(net)).max() < EXACT
    assert product_defect(net).max() < EXACT


def test_angle_defects_see_nets_that_are_none() -> None:
    net = any_knet(4, 5)
    other = KNet(net.points, net.m, 1.0, (net.deltas[0] + 0.05, net.deltas[1]))
    assert np.abs(angle_relation_defect(other)).max() > 1e-3
    assert product_defect(other).max() > 1e-5
    points = net.points.copy()
    points[2, 2] += 0.02 * unit(net.points[2, 3] - net.points[2, 2])
    moved = KNet(points, net.m, 1.0, net.deltas)
    assert np.abs(angle_relation_defect(moved)).max() > 1e-3


@pytest.mark.parametrize("name", ["uneven", "breather", "wide"])
@pytest.mark.parametrize("start", [(0.0, 0.0), (0.7, -1.9)])
def test_hirota_holds_on_the_potential(name: str, start: tuple[float, float]) -> None:
    net = nets()[name]
    k = angle_coefficient(*net.deltas)
    h = hirota_potential(net, start)
    assert (h[0, 0], h[1, 0]) == start
    assert np.abs(hirota_residual(h, k)).max() < 1e-12
    # It is the potential of the measured angles of all quads, not only of the first ones.
    phi, _, psi, _ = quad_angles(net)
    assert np.abs(modulo((h[1:, :-1] + h[:-1, 1:]) / 2 - phi)).max() < 1e-11
    assert np.abs(modulo((h[1:, 1:] + h[:-1, :-1]) / 2 - (np.pi - psi))).max() < 1e-11
    assert np.allclose(evolve_hirota(h[:, 0], h[0], k), h)


def test_the_equation_of_the_textbooks_is_of_leading_order_only() -> None:
    """k, not eps^2 / 4; and on the raw angle phi a relative defect of O(eps^2) remains."""
    size, relative, coefficient = [], [], []
    for cells in (10, 20, 40, 80):
        delta = 1.0 / cells
        net = amsler(np.full(cells, delta), np.full(cells, delta), np.pi / 3)
        k = float(angle_coefficient(delta, delta))
        eps = np.sin(delta)
        assert k == pytest.approx((1 - np.sqrt(1 - eps**2)) / (1 + np.sqrt(1 - eps**2)))
        h = hirota_potential(net)
        size.append(np.abs(hirota_residual(h, k)).max())
        coefficient.append(np.abs(hirota_residual(h, eps**2 / 4)).max() / k)
        phi = quad_angles(net)[0]
        relative.append(np.abs(hirota_residual(phi, k)).max() / k)
    assert max(size) < 1e-13
    for values in (relative, coefficient):
        orders = np.log2(np.array(values[:-1]) / values[1:])
        assert orders == pytest.approx([2, 2, 2], abs=0.35)
    assert coefficient[0] > 1e-3


def test_limit_is_sine_gordon() -> None:
    """(phi_12 - phi_1 - phi_2 + phi) / eps^2 tends to sin phi, the order is at least one."""
    errors = []
    for cells in (20, 40, 80):
        delta = 1.0 / cells
        phi = quad_angles(amsler(np.full(cells, delta), np.full(cells, delta), 1.1))[0]
        second = phi[1:, 1:] - phi[1:, :-1] - phi[:-1, 1:] + phi[:-1, :-1]
        middle = 0.25 * (phi[1:, 1:] + phi[1:, :-1] + phi[:-1, 1:] + phi[:-1, :-1])
        errors.append(np.abs(second / np.sin(delta) ** 2 - np.sin(middle)).max())
    assert errors[-1] < 2e-3
    assert np.all(np.log2(np.array(errors[:-1]) / errors[1:]) > 0.9)


def test_chi_of_phi_is_continuous_and_monotone() -> None:
    phi = np.linspace(-9, 9, 4001)
    chi = chi_of_phi(phi, 0.3)
    assert np.diff(chi).min() > 0
    assert np.diff(chi).max() < 0.02
    assert np.allclose(np.tan(chi / 2), 1.3 / 0.7 * np.tan(phi / 2))
    assert chi_of_phi(phi + 4 * np.pi, 0.3) == pytest.approx(chi + 4 * np.pi)
    assert np.diff(chi_of_phi(phi, 1.5)).max() < 0
    assert chi_of_phi(phi, 0.0) == pytest.approx(phi)


def test_bad_input_of_angles() -> None:
    with pytest.raises(InputError, match=r"delta 1 of the second direction is 3.5"):
        angle_coefficient([0.1, 0.2], [0.3, 3.5])
    with pytest.raises(InputError, match=r"k of quad \(1,\) is 1"):
        chi_of_phi([0.1, 0.2], [0.5, 1.0])
    with pytest.raises(InputError, match="3 directions"):
        quad_angles(any_knet(2, 2, 2))
    with pytest.raises(InputError, match="start with 0 and 1"):
        evolve_hirota([0.0, 1.0], [1.0, 2.0], 0.1)
    with pytest.raises(InputError, match=r"k has shape \(2, 2\); \(1, 2\)"):
        evolve_hirota([0.0, 1.0], [0.0, 1.0, 2.0], np.full((2, 2), 0.1))
    with pytest.raises(InputError, match="potential has shape"):
        hirota_residual([1.0, 2.0], 0.1)


# --- the skew parallelogram ----------------------------------------------------------------------
def test_half_turn_of_a_skew_parallelogram() -> None:
    """Made by a half-turn about the z-axis: the axis and the exchange of corners are known."""
    x, x1 = np.array([1.0, 0.2, -0.3]), np.array([-0.4, 0.9, 0.5])
    x12, x2 = x * [-1, -1, 1], x1 * [-1, -1, 1]
    quad = skew_parallelogram(x, x1, x2, x12)
    assert np.abs(quad.axis) == pytest.approx([0, 0, 1], abs=1e-15)
    assert quad.center[:2] == pytest.approx([0, 0], abs=1e-15)
    assert quad.half_turn([x, x1, x2, x12]) == pytest.approx(np.array([x12, x2, x1, x]), abs=1e-15)
    # Twists are equal on opposite sides, of other sign on neighbours; one scale for both.
    twists = quad.twists()
    assert twists[:2] == pytest.approx(twists[2:])
    assert twists[0] * twists[1] < 0
    a, b = quad.sides
    assert a / abs(np.sin(twists[0])) == pytest.approx(b / abs(np.sin(twists[1])), rel=1e-13)
    assert quad.scale() == pytest.approx(a / abs(np.sin(twists[0])))


def test_planar_parallelogram_takes_the_normal_and_others_are_refused() -> None:
    o, e1, e2 = np.zeros(3), np.array([2.0, 0, 0]), np.array([0.5, 1.0, 0])
    quad = skew_parallelogram(o, e1, e2, e1 + e2)
    assert quad.planar
    assert np.abs(quad.axis) == pytest.approx([0, 0, 1])
    assert quad.half_turn(o) == pytest.approx(e1 + e2)
    assert quad.twists() == pytest.approx(np.zeros(4))
    with pytest.raises(DegenerateError, match="no scale"):
        quad.scale()
    # An isosceles trapezoid with its legs and diagonals as sides.
    with pytest.raises(DegenerateError, match="antiparallelogram"):
        skew_parallelogram([-2, 0, 0], [1, 1, 0], [-1, 1, 0], [2, 0, 0])
    with pytest.raises(InputError, match=r"sides x x_1 and x_12 x_2 are 2 and 2.06155281"):
        skew_parallelogram(o, e1, e2, e1 + e2 + [0, 0, 0.5])
    with pytest.raises(DegenerateError, match="side x x_1 has no length"):
        skew_parallelogram(o, o, e2, e2)
    with pytest.raises(DegenerateError, match="on a line"):
        skew_parallelogram(o, e1, 0.5 * e1, 1.5 * e1)
    with pytest.raises(InputError, match=r"four points \(3,\)"):
        skew_parallelogram(o[:2], e1[:2], e2[:2], e2[:2])

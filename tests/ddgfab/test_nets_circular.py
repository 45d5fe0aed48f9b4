"""Circular nets in two directions: circles, cross-ratios, evolution, convergence."""

from __future__ import annotations

import time
import tracemalloc

import numpy as np
import pytest

from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats
from ddgfab.nets import circular as ci
from ddgfab.nets import conjugate as cn
from ddgfab.nets import crossratio as cr
from ddgfab.nets.axes import circle_axes
from ddgfab.surfaces import ellipsoid_normals, ellipsoid_patch
from ddgfab.transforms import invert

E = np.eye(3)


def polylines(count: int, dim: int = 3) -> tuple[Floats, Floats]:
    """Two curved polylines from the origin, perpendicular there."""
    way = np.linspace(0.0, 1.0, count + 1)
    first, second = np.zeros((count + 1, dim)), np.zeros((count + 1, dim))
    first[:, 0], first[:, -1] = way, 0.2 * way**2
    second[:, 1], second[:, 0], second[:, -1] = (
        way,
        0.1 * way**2,
        -0.3 * way**2 * (dim > 2) + (way if dim == 2 else 0.0),
    )
    return first, second


def circular_net(count: int = 7, dim: int = 3, seed: int = 1) -> Floats:
    angles = np.pi / 2 + 0.02 * np.random.default_rng(seed).normal(size=(count, count))
    first, second = polylines(count, dim)
    return ci.evolve_by_angles(first, second, angles)


def wobbly_grid() -> Floats:
    grid = np.stack(np.meshgrid(np.arange(6.0), np.arange(5.0), [0.0], indexing="ij"), axis=-1)
    return grid[:, :, 0] + 0.1 * np.random.default_rng(5).normal(size=(6, 5, 3))


def ellipsoid(cells: int) -> Floats:
    u, v = np.linspace(5, 7, cells + 1), np.linspace(2, 3, cells + 1)
    return ellipsoid_patch(u[:, None], v[None, :])


# --- circles -------------------------------------------------------------------------------------
@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_circumcircle(scale: float) -> None:
    rng = np.random.default_rng(2)
    p, q, r = scale * rng.normal(size=(3, 40, 3))
    c, radius, n = ci.circumcircle(p, q, r)
    for point in (p, q, r):
        assert np.allclose(np.linalg.norm(point - c, axis=-1), radius, rtol=1e-10)
        assert np.abs(np.sum((point - c) * n, axis=-1)).max() < 1e-11 * radius.max()
    assert (np.sum(np.cross(q - p, r - p) * n, axis=-1) > 0).all()
    # Second route: the formula of mathematics.md 2.1, and R = product of the sides / (4 area).
    a, b = q - p, r - p
    w = np.cross(a, b)
    square = np.sum(w * w, axis=-1, keepdims=True)
    aa, bb = np.sum(a * a, axis=-1, keepdims=True), np.sum(b * b, axis=-1, keepdims=True)
    center = p + (bb * np.cross(w, a) + aa * np.cross(b, w)) / (2 * square)
    assert np.allclose(center, c, rtol=1e-8, atol=1e-8 * scale)
    sides = np.sqrt(aa * bb)[:, 0] * np.linalg.norm(q - r, axis=-1)
    assert np.allclose(radius, sides / (2 * np.sqrt(square[:, 0])), rtol=1e-9)


def test_circularity_measures_distance_over_radius() -> None:
    square = np.array([[[1.0, 0, 0], [0, 1, 0]], [[0, -1, 0], [-1, 0, 0]]])
    assert ci.circularity(square)[0, 0] < 1e-15
    for move, wanted in (([-0.1, 0, 0], 0.1), ([0, 0, 0.2], 0.2)):
        moved = square.copy()
        moved[1, 1] += move
        assert ci.circularity(moved)[0, 0] == pytest.approx(wanted)
    assert ci.circularity(wobbly_grid()).max() > 0.05


# --- cross-ratios --------------------------------------------------------------------------------
def quaternion(v: Floats) -> Floats:
    """Imaginary quaternion as a 4 x 4 matrix of left multiplication."""
    x, y, z = v
    return np.array([[0, -x, -y, -z], [x, 0, -z, y], [y, z, 0, -x], [z, -y, x, 0]])


def test_cross_ratio_is_the_quaternionic_one() -> None:
    rng = np.random.default_rng(3)
    for _ in range(20):
        a, b, c, d = rng.normal(size=(4, 3))
        inverse = np.linalg.inv
        q = quaternion(a - b) @ inverse(quaternion(b - c)) @ quaternion(c - d)
        q = (q @ inverse(quaternion(d - a)))[:, 0]
        real, imag = cr.cross_ratio(a, b, c, d)
        assert real == pytest.approx(q[0], abs=1e-10)
        assert imag == pytest.approx(np.linalg.norm(q[1:]), abs=1e-10)
        flat = [p[0] + 1j * p[1] for p in (a, b, c, d)]
        z = cr.complex_cross_ratio(*flat)
        plane = cr.cross_ratio(a[:2], b[:2], c[:2], d[:2])
        lifted = cr.cross_ratio(*(p * [1, 1, 0] for p in (a, b, c, d)))
        for found in (plane, lifted):
            assert np.allclose(found, [z.real, abs(z.imag)], atol=1e-9 * abs(z))


def test_cross_ratio_of_squares_circles_and_under_inversion() -> None:
    assert cr.cross_ratio([0, 0, 0], E[0], E[0] + E[1], E[1]) == pytest.approx((-1, 0))
    x = circular_net()
    real, imag = cr.cross_ratios(x)
    assert np.abs(imag).max() < 1e-12
    assert (real < 0).all()  # convex
    # Quads that are not circular have the same cross-ratio after an inversion, too.
    y = wobbly_grid()
    for before, after in zip(
        cr.cross_ratios(y), cr.cross_ratios(invert(y, [2.0, 2.0, 4.0], 3.0)), strict=True
    ):
        assert np.allclose(before, after, atol=1e-12)
    assert cr.cross_ratios(y)[1].max() > 0.05
    assert ci.circularity(invert(x, [0.3, 0.4, 2.0], 1.5)).max() < 1e-12


# --- the fourth point ----------------------------------------------------------------------------
@pytest.mark.parametrize(("t", "q"), [(0.3, -7 / 3), (0.5, -1.0), (0.8, -0.25)])
def test_fourth_point_by_t(t: float, q: float) -> None:
    rng = np.random.default_rng(4)
    for dim in (2, 3):
        x, x1, x2 = rng.normal(size=(3, dim))
        x12 = ci.fourth_by_t(x, x1, x2, t)
        assert cr.cross_ratio(x, x1, x12, x2) == pytest.approx((q, 0), abs=1e-12)
        assert ci.circularity(np.array([[x, x2], [x1, x12]])).max() < 1e-12


def test_fourth_point_by_angle() -> None:
    x12 = ci.fourth_by_angle([0, 0, 0], E[0], E[1], np.pi / 3)
    # sqrt(3)-family: 1 - (1 + sqrt 3) / 4, (3 + sqrt 3) / 4.
    assert x12 == pytest.approx([0.3169873, 1.1830127, 0], abs=1e-7)
    assert x12[1] == pytest.approx((3 + np.sqrt(3)) / 4, abs=1e-15)
    rng = np.random.default_rng(7)
    x, x1, x2 = rng.normal(size=(3, 50, 4))
    angles = rng.uniform(0.3, 2.8, size=50)
    points = np.stack(
        [np.stack([x, x2], axis=1), np.stack([x1, ci.fourth_by_angle(x, x1, x2, angles)], axis=1)],
        axis=1,
    )
    for quad, angle in zip(points, angles, strict=True):
        assert ci.circularity(quad).max() < 1e-10
        found = ci.interior_angles(quad)[0, 0] - angle
        assert found / np.pi == pytest.approx(round(found / np.pi), abs=1e-10)


def test_both_parametrisations_agree() -> None:
    rng = np.random.default_rng(8)
    x, x1, x2 = rng.normal(size=(3, 3))
    for t in (0.2, 0.5, 0.9, -0.7, 1.6):
        x12 = ci.fourth_by_t(x, x1, x2, t)
        quad = np.array([[x, x2], [x1, x12]])
        again = ci.fourth_by_angle(x, x1, x2, ci.interior_angles(quad)[0, 0], convex=0 < t < 1)
        assert np.abs(again - x12).max() < 1e-12 * np.abs(x12).max()


def test_convexity_is_refused_where_asked() -> None:
    x, x1, x2 = np.zeros(3), E[0], E[1]
    for t in (-0.5, 1.5):
        ci.fourth_by_t(x, x1, x2, t)
        with pytest.raises(DegenerateError, match=f"between 0 and 1.*value {t}"):
            ci.fourth_by_t(x, x1, x2, t, convex=True)
    # At x_1 the direction to x_2 is at 45 deg, the tangent of the circle at 135 deg.
    for degrees in (40, 140, -30):
        with pytest.raises(DegenerateError, match="not convex"):
            ci.fourth_by_angle(x, x1, x2, np.radians(degrees), convex=True)
    for degrees in (50, 130):
        ci.fourth_by_angle(x, x1, x2, np.radians(degrees), convex=True)
    first, second = polylines(3)
    angles = np.full((3, 3), np.pi / 2)
    angles[1, 2] = 0.1
    with pytest.raises(DegenerateError, match=r"quad \(1, 2\): the quad is not convex") as caught:
        ci.evolve_by_angles(first, second, angles, convex=True)
    assert caught.value.cell == (1, 2)
    ratios = np.full((3, 3), -1.0)
    ratios[2, 0] = 0.5
    with pytest.raises(DegenerateError, match=r"quad \(2, 0\): t must lie"):
        ci.evolve_by_cross_ratio(first, second, ratios, convex=True)


# --- evolution -----------------------------------------------------------------------------------
@pytest.mark.parametrize("dim", [2, 3, 5])
def test_evolution_by_angles_makes_circles_and_gives_the_angles_back(dim: int) -> None:
    first, second = polylines(9, dim)
    angles = np.pi / 2 + 0.02 * np.random.default_rng(0).normal(size=(9, 9))
    x = ci.evolve_by_angles(first, second, angles)
    assert np.array_equal(x[:, 0], first)
    assert np.array_equal(x[0], second)
    assert max(ci.circular_residuals(x).values()) < 1e-12
    assert np.abs(ci.interior_angles(x) - angles).max() < 1e-11
    assert ci.angle_sum_defect(x).max() < 1e-11
    # Corners (0, 0), (1, 0), (2, 2), (0, 1): the angles at the first and the third add up to
    # 90 deg + acos(4 / 5), short of 180 deg by 90 deg - acos(4 / 5) = atan(4 / 3).
    kite = [[[0.0, 0], [0, 1]], [[1, 0], [2, 2]]]
    assert ci.angle_sum_defect(kite)[0, 0] == pytest.approx(np.arctan2(4, 3), abs=1e-15)


def test_evolution_by_cross_ratio_makes_circles_with_them() -> None:
    first, second = polylines(4)
    ratios = -1.0 + 0.1 * np.random.default_rng(0).normal(size=(4, 4))
    x = ci.evolve_by_cross_ratio(first, second, ratios)
    assert ci.circularity(x).max() < 1e-11
    real, imag = cr.cross_ratios(x)
    assert np.abs(real - ratios).max() < 1e-10
    assert imag.max() < 1e-10


def test_reconstruction_converges_by_angles_and_not_by_cross_ratios() -> None:
    by_angle, by_ratio = [], []
    for cells in (4, 8, 16, 32, 64):
        x = ellipsoid(cells)
        y = ci.evolve_by_angles(x[:, 0], x[0], ci.interior_angles(x))
        z = ci.evolve_by_cross_ratio(x[:, 0], x[0], cr.cross_ratios(x)[0])
        by_angle.append(np.linalg.norm(y - x, axis=-1).max())
        by_ratio.append(np.linalg.norm(z - x, axis=-1).max())
    rates = np.log2(np.array(by_angle)[:-1] / np.array(by_angle)[1:])
    assert rates == pytest.approx([2, 2, 2, 2], abs=0.05)
    assert by_angle[0] == pytest.approx(1.49e-3, rel=0.01)  # measured, for this patch
    assert min(by_ratio[1:]) > 0.2


def test_curvature_lines_are_nearly_circular_with_the_known_orders() -> None:
    """Volume h^6, distance from the circle h^3, angle sums h^2, diagonals h^3, axis h^2 (2.6)."""
    rows = []
    normal = ellipsoid_normals(ellipsoid_patch(6, 2.5))
    for h in 0.2 / 2.0 ** np.arange(4):
        u, v = 6 + h * np.array([-0.5, 0.5]), 2.5 + h * np.array([-0.5, 0.5])
        x = ellipsoid_patch(u[:, None], v[None, :])
        axis = circle_axes(x)[1][0, 0]
        rows.append(
            [
                cn.quad_volumes(x)[0, 0],
                ci.circularity(x)[0, 0] * ci.circumcircle(x[0, 0], x[1, 0], x[0, 1])[1],
                ci.angle_sum_defect(x)[0, 0],
                abs(cn.planarity(x)[0, 0]),
                np.linalg.norm(np.cross(axis, normal)),
            ]
        )
    orders = np.log2(np.array(rows)[:-1] / np.array(rows)[1:])
    for row in orders:
        assert row == pytest.approx([6, 3, 2, 3, 2], abs=0.02)


def test_surfaces_of_revolution_are_circular_for_any_spacing() -> None:
    z = np.array([0.0, 0.3, 0.35, 1.2, 1.3])
    turn = np.array([0.0, 0.5, 0.6, 1.4, 1.5, 2.9])[:, None]
    radius = 1 + 0.3 * np.sin(2 * z)
    x = np.stack(np.broadcast_arrays(radius * np.cos(turn), radius * np.sin(turn), z), axis=-1)
    assert ci.circularity(x).max() < 1e-14


def test_net_of_more_directions_is_measured_in_each_pair() -> None:
    x = np.stack(np.meshgrid(np.arange(3.0), np.arange(4.0), np.arange(5.0), indexing="ij"), -1)
    x[1, 2, 3] += [0.1, 0, 0]
    assert ci.circularity(x, (0, 2)).shape == (2, 4, 4)
    assert ci.circularity(x, (0, 2)).max() > 0.05
    assert np.argwhere(ci.circularity(x, (0, 2)) > 1e-9).min(axis=0).tolist() == [0, 2, 2]
    x[1, 2, 3] = x[1, 2, 2]
    with pytest.raises(DegenerateError, match=r"directions \(1, 2\) at \(1, 2, 2\)"):
        ci.circularity(x, (1, 2))
    assert ci.circular_residuals(x[:, :, :2])["circularity"] < 1e-15


def test_degenerate_quads_are_named() -> None:
    x, x1, x2 = np.zeros(3), E[0], E[1]
    with pytest.raises(DegenerateError, match="lie on a line"):
        ci.fourth_by_t(x, x1, 2 * x1, 0.5)
    with pytest.raises(DegenerateError, match="lie on a line"):
        ci.fourth_by_angle(x, x1, 2 * x1, 1.0)
    for t, corner in ((0.0, "x_1"), (1.0, "x_2")):
        with pytest.raises(DegenerateError, match=f"t = .* on {corner}"):
            ci.fourth_by_t(x, x1, x2, t)
    with pytest.raises(DegenerateError, match="falls on x_2"):
        ci.fourth_by_angle(x, x1, x2, np.pi / 4)
    with pytest.raises(DegenerateError, match="falls on x_1"):
        ci.fourth_by_angle(x, x1, x2, 3 * np.pi / 4)
    with pytest.raises(DegenerateError, match="1 - q"):
        ci.evolve_by_cross_ratio([x, x1], [x, x2], 1.0)
    with pytest.raises(DegenerateError, match=r"circle \(1,\)"):
        ci.circumcircle([x, x], [x1, x1], [x2, 3 * x1])
    with pytest.raises(DegenerateError, match="neighbouring corners coincide"):
        cr.cross_ratio(x, x1, x1, x2)
    with pytest.raises(DegenerateError, match="neighbouring corners coincide"):
        cr.complex_cross_ratio(0, 1, 1j, 0)
    with pytest.raises(InputError, match="R\\^4"):
        cr.cross_ratios(np.random.default_rng(0).normal(size=(2, 2, 4)))
    with pytest.raises(InputError, match="nan"):
        ci.fourth_by_angle(x, x1, [0, np.nan, 0], 1.0)


def test_large_nets_are_measured_without_copies() -> None:
    """Memory within five times the data; time is watched by benchmarks/nets.py."""
    count = 300
    first, second = polylines(count)
    angles = np.full((count, count), np.pi / 2)
    tracemalloc.start()
    begin = time.perf_counter()
    x = ci.evolve_by_angles(first, second, angles)
    ci.circularity(x), cn.planarity(x), cr.cross_ratios(x), ci.interior_angles(x)
    taken = time.perf_counter() - begin
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 5 * x.nbytes
    assert taken < 5.0
    assert ci.circularity(x).max() < 1e-11

"""Conjugate nets: planarity, coefficients, evolution."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats
from ddgfab.nets import conjugate as cn

SCALES = [1e-6, 1.0, 1e6]


def curves(count: int, dim: int, seed: int) -> tuple[Floats, Floats]:
    """Two wavy polylines from the origin."""
    rng = np.random.default_rng(seed)
    lines = []
    for k in (0, 1):
        steps = 0.2 * rng.normal(size=(count, dim))
        steps[:, k] += 1.0
        lines.append(np.concatenate([np.zeros((1, dim)), np.cumsum(steps, axis=0)]))
    return lines[0], lines[1]


def skew_net(seed: int = 5) -> Floats:
    rng = np.random.default_rng(seed)
    grid = np.stack(np.meshgrid(np.arange(6.0), np.arange(5.0), indexing="ij"), axis=-1)
    return np.concatenate([grid, np.zeros((6, 5, 1))], axis=-1) + 0.15 * rng.normal(size=(6, 5, 3))


@pytest.mark.parametrize("scale", SCALES)
def test_planarity_is_the_distance_of_the_diagonals(scale: float) -> None:
    """Second route: six volumes of the tetrahedron by |d1 x d2|."""
    x = skew_net() * scale
    first, second = x[1:, 1:] - x[:-1, :-1], x[:-1, 1:] - x[1:, :-1]
    normal = np.cross(first, second)
    volume = np.einsum("ijk,ijk->ij", x[1:, :-1] - x[:-1, :-1], normal)
    mean = 0.5 * (np.linalg.norm(first, axis=-1) + np.linalg.norm(second, axis=-1))
    expected = volume / np.linalg.norm(normal, axis=-1) / mean
    assert np.abs(expected).max() > 0.05
    assert np.allclose(cn.planarity(x), expected, rtol=1e-12, atol=1e-15)
    assert np.allclose(6 * cn.quad_volumes(x), np.abs(volume), rtol=1e-9, atol=1e-15 * scale**3)
    # In more coordinates without sign, and the same.
    wide = np.concatenate([x, np.zeros((6, 5, 2))], axis=-1)
    assert np.allclose(cn.planarity(wide), np.abs(expected), atol=1e-14)


def test_planarity_of_translation_surfaces_and_its_order_on_a_graph() -> None:
    rng = np.random.default_rng(0)
    p, q = rng.normal(size=(7, 1, 3)), rng.normal(size=(1, 6, 3))
    assert np.abs(cn.planarity(p + q)).max() < 1e-14
    # z = xy + 0.3 x^3 about (.4, .3): in plan the diagonals cross in the middle, apart by
    # h^2 f_12 / 2 in height; f_1 = .3 + .9 * .16 = .444, f_2 = .4, f_12 = 1. So planarity / h tends
    # to .5 / sqrt(1 + f_1^2 + f_2^2) / mean sqrt(2 + (f_1 +- f_2)^2) = .28036.
    slope = np.array([0.444 + 0.4, 0.444 - 0.4])
    limit = 0.5 / np.sqrt(1 + 0.444**2 + 0.4**2) / np.sqrt(2 + slope**2).mean()
    values = []
    for h in (0.2, 0.1, 0.05):
        u, v = np.meshgrid([0.4 - h / 2, 0.4 + h / 2], [0.3 - h / 2, 0.3 + h / 2], indexing="ij")
        values.append(abs(cn.planarity(np.stack([u, v, u * v + 0.3 * u**3], axis=-1))[0, 0]) / h)
    assert limit == pytest.approx(0.28036, abs=1e-5)
    errors = np.abs(np.array(values) - limit)
    assert errors[2] < 1e-4
    assert np.log2(errors[:-1] / errors[1:]) == pytest.approx([2, 2], abs=0.2)


def test_planarity_refuses_parallel_diagonals_and_the_other_flags_them() -> None:
    x = skew_net()
    x[3, 3] = x[2, 2] + 1.5 * (x[2, 3] - x[3, 2])
    with pytest.raises(DegenerateError, match=r"quad \(2, 2\).*diagonals are parallel") as caught:
        cn.planarity(x)
    assert caught.value.cell == (2, 2)
    values, fitted = cn.planarity_flagged(x)
    assert fitted[2, 2]
    assert fitted.sum() == 1
    # Parallel diagonals make a quad planar: its corners have no volume.
    assert values[2, 2] == 0.0
    assert cn.quad_volumes(x)[2, 2] < 1e-15
    rest = ~fitted
    assert (values[rest] > 0).all()
    clean, none = cn.planarity_flagged(skew_net())
    assert not none.any()
    assert np.allclose(clean, np.abs(cn.planarity(skew_net())), atol=1e-15)
    with pytest.raises(DegenerateError, match="both diagonals"):
        cn.planarity_flagged(np.zeros((2, 2, 3)))


def test_quad_volume_density() -> None:
    def surface(u: float, v: float) -> list[float]:
        return [np.exp(u) * np.cos(v), u * v + np.sin(u), u + v**3 + u * u * v]

    # f_1, f_2, f_12 by hand.
    u, v = 0.3, 0.5
    rows = [
        [np.exp(u) * np.cos(v), v + np.cos(u), 1 + 2 * u * v],
        [-np.exp(u) * np.sin(v), u, 3 * v**2 + u**2],
        [-np.exp(u) * np.sin(v), 1, 2 * u],
    ]
    limit = abs(np.linalg.det(rows)) / 2
    assert limit == pytest.approx(0.79840, abs=5e-6)
    values = [cn.quad_volume_density(surface, (u, v), e) for e in (0.01, 0.001)]
    assert values == pytest.approx([0.8161, 0.8002], abs=5e-5)
    errors = np.array(values) - limit
    assert errors[0] / errors[1] == pytest.approx(10, rel=0.05)  # first order
    assert cn.quad_volume_density(lambda a, b: [a, b, a * a + b * b], (u, v), 0.01) < 1e-9
    with pytest.raises(InputError, match="other than zero"):
        cn.quad_volume_density(surface, (u, v), 0.0)


@pytest.mark.parametrize("dim", [2, 3, 5])
def test_coefficients_give_the_net_back(dim: int) -> None:
    rng = np.random.default_rng(dim)
    first, second = curves(8, dim, 1)
    c21, c12 = rng.uniform(-0.1, 0.1, size=(2, 8, 8))
    x = cn.evolve_conjugate(first, second, c21, c12)
    assert np.array_equal(x[:, 0], first)
    assert np.array_equal(x[0], second)
    assert cn.conjugate_residuals(x)["planarity"] < 1e-13
    again = cn.coefficients(x)
    assert np.allclose(again[0], c21, atol=1e-12)
    assert np.allclose(again[1], c12, atol=1e-12)
    # The definition, with plain differences.
    mixed = np.diff(np.diff(x, axis=0), axis=1)
    made = c21[..., None] * np.diff(x, axis=0)[:, :-1] + c12[..., None] * np.diff(x, axis=1)[:-1]
    assert np.abs(mixed - made).max() < 1e-12 * np.abs(x).max()
    # Affine maps keep coefficients.
    affine = x @ (np.eye(dim) + 0.3 * rng.normal(size=(dim, dim))) + 7.0
    assert np.allclose(cn.coefficients(affine)[0], c21, atol=1e-11)


def test_parallelograms_have_no_coefficients_and_the_residual_sees_skew_quads() -> None:
    first, second = curves(5, 3, 2)
    x = cn.evolve_conjugate(first, second, 0.0, 0.0)
    assert np.allclose(x, first[:, None] + second[None], atol=1e-14)
    corners = ([0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0.5])
    assert cn.conj_coeffs(*corners) == pytest.approx((0, 0), abs=1e-15)
    assert cn.conj_residual(*corners) == pytest.approx(0.5 / 1.5)


def test_plain_double_loop_gives_the_same_net() -> None:
    rng = np.random.default_rng(9)
    first, second = curves(5, 3, 4)[0], curves(8, 3, 4)[1]
    c21, c12 = rng.uniform(-0.1, 0.1, size=(2, 5, 8))
    x = cn.evolve_conjugate(first, second, c21, c12)
    y = np.empty_like(x)
    y[:, 0], y[0] = first, second
    for i in range(5):
        for j in range(8):
            y[i + 1, j + 1] = (
                y[i, j]
                + (1 + c21[i, j]) * (y[i + 1, j] - y[i, j])
                + (1 + c12[i, j]) * (y[i, j + 1] - y[i, j])
            )
    assert np.allclose(x, y, rtol=0, atol=1e-14)


@pytest.mark.parametrize("shape", [(1, 1), (1, 4), (4, 1), (2, 1)])
def test_thin_nets(shape: tuple[int, int]) -> None:
    first, second = curves(shape[0], 3, 4)[0], curves(shape[1], 3, 4)[1]
    c = np.random.default_rng(0).uniform(-0.2, 0.2, size=(2, *shape))
    x = cn.evolve_conjugate(first, second, c[0], c[1])
    assert np.allclose(cn.coefficients(x), c, atol=1e-13)


def test_quads_beyond_the_first_block_are_named_by_their_own_indices() -> None:
    grid = np.stack(np.meshgrid(np.arange(200.0), np.arange(150.0), [0.0], indexing="ij"), -1)
    x = grid[:, :, 0]
    x[181, 31] = x[180, 30] + [-1.0, 1.0, 0.0]
    with pytest.raises(DegenerateError, match=r"quad \(180, 30\)"):
        cn.planarity(x)


def test_bad_input_is_named() -> None:
    first, second = curves(3, 3, 1)
    with pytest.raises(InputError, match="share their first point"):
        cn.evolve_conjugate(first, second + 1.0, 0.0, 0.0)
    with pytest.raises(InputError, match=r"\(2, 3\); \(3, 3\) is needed"):
        cn.evolve_conjugate(first, second, np.zeros((2, 3)), 0.0)
    bad = np.zeros((3, 3))
    bad[1, 2] = np.nan
    with pytest.raises(InputError, match=r"entry \(1, 2\) is nan, not a finite"):
        cn.evolve_conjugate(first, second, 0.0, bad)
    with pytest.raises(InputError, match="shapes"):
        cn.evolve_conjugate(first, second[:, :2], 0.0, 0.0)
    with pytest.raises(InputError, match="two at least"):
        cn.evolve_conjugate(first, second[:1], 0.0, 0.0)
    with pytest.raises(InputError, match=r"directions \(0, 2\)"):
        cn.planarity(np.zeros((2, 2, 3)), (0, 2))
    with pytest.raises(InputError, match="shape"):
        cn.planarity(np.zeros((2, 3)))
    flat = np.zeros((3, 3))
    line = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]])
    with pytest.raises(DegenerateError, match=r"quad \(0, 0\).*parallel.*limit 1e-12; value 0"):
        cn.evolve_conjugate(line, 2 * line, flat, flat)
    with pytest.raises(DegenerateError, match="no length"):
        cn.conj_coeffs([0, 0, 0], [0, 0, 0], [0, 1, 0], [1, 1, 0])
    with pytest.raises(DegenerateError, match=r"quad \(0, 1\): coordinates grow beyond 1e\+60"):
        cn.evolve_conjugate(first, second, 1e40, 1e40)

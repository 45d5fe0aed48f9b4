"""Nets of several sheets: layers, lattices of transforms, common transforms, samples."""

from __future__ import annotations

import re
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from net_cases import planar_net, surfaces

from ddgfab.errors import DegenerateError, InputError
from ddgfab.forms.registry import generate
from ddgfab.net import Net
from ddgfab.nets import conjugate as cn
from ddgfab.nets import cubes
from ddgfab.nets.layers import common_transform, lattice, sample, stack_transforms
from ddgfab.nets.miquel import evolve_circular_by_angles
from ddgfab.transforms import combescure


def test_layers_and_lattices_are_larger_nets() -> None:
    first, second = surfaces((6, 5, 2), 3)[0, 1], surfaces((6, 5, 2), 3)[0, 1]
    # A Combescure transform: with all edges parallel, vertical quads are trapezoids (1.10).
    c = cn.coefficients(first)
    other = cn.evolve_conjugate(
        [0, 0, 1] + 1.3 * (first[:, 0] - first[0, 0]), [0, 0, 1] + 1.3 * first[0], *c
    )
    y = stack_transforms([first, other])
    assert y.shape == (6, 5, 2, 3)
    assert cn.conjugate_residuals(y)["planarity"] < 1e-12
    tilted = other + np.random.default_rng(0).normal(size=other.shape) * 0.01
    assert cn.conjugate_residuals(stack_transforms([second, tilted]))["planarity"] > 1e-4

    stretch = np.diag([1.0, 2.0, 3.0])
    with pytest.raises(DegenerateError, match="cannot be checked"):
        lattice(first, lambda x: 2.0 * x, lambda x: x @ stretch)
    z = lattice(first, lambda x: 2.0 * x, lambda x: x @ stretch, residuals=lambda _: {})
    assert z.shape == (6, 5, 2, 2, 3)
    assert np.array_equal(z[..., 1, 0, :], 2 * first)
    assert np.array_equal(z[..., 0, 1, :], first * [1, 2, 3])
    assert np.allclose(z[..., 1, 1, :], 2 * first * [1, 2, 3])
    with pytest.raises(DegenerateError, match="do not commute"):
        lattice(first, lambda x: 2.0 * x, lambda x: x + 1.0)
    common = lattice(first, lambda x: 2.0 * x, lambda x: x + 1.0, lambda x, a, b: a + b - x)
    assert np.allclose(common[..., 1, 1, :], 2 * first + 1)
    with pytest.raises(InputError, match="sheet 1 has shape"):
        stack_transforms([first, first[1:]])
    with pytest.raises(InputError, match="1 sheets"):
        stack_transforms([first])


def test_lattices_of_transforms_that_commute_need_planar_quads_of_their_own() -> None:
    """Combescure transforms commute when both give factors of the same boundary edges."""
    x = planar_net() / 1000.0
    along, across = np.linspace(0.6, 1.6, 5), np.linspace(1.4, 0.8, 4)

    def to_a(y: np.ndarray) -> np.ndarray:
        return combescure(y, along, across, y[0, 0] + [0.0, 0.0, 0.4])

    def to_b(y: np.ndarray) -> np.ndarray:
        return combescure(y, along[::-1], across**2, y[0, 0] + [0.3, 0.1, 0.2])

    a, b = to_a(x), to_b(x)
    assert np.abs(to_a(b) - to_b(a)).max() < 1e-12
    skew = np.stack([stack_transforms([x, b]), stack_transforms([a, to_b(a)])], axis=-3)
    assert np.abs(cn.planarity(skew, (2, 3))).max() > 0.01
    with pytest.raises(DegenerateError, match="no conjugate net") as caught:
        lattice(x, to_a, to_b)
    assert re.search(r"quad of the two new directions at \(\d, \d\), relative", str(caught.value))
    with pytest.raises(DegenerateError, match="no conjugate net"):
        lattice(x, to_a, to_b, lambda x, a, b: to_b(a))
    # The common transform: conjugate in all directions.
    z = lattice(x, to_a, to_b, lambda x, a, b: common_transform(x, a, b, to_b(a)[0, 0]))
    assert cn.conjugate_residuals(z)["planarity"] < 1e-9
    # With the caller's condition; and with nothing to check.
    with pytest.raises(DegenerateError, match="the given"):
        lattice(x, to_a, to_b, residuals=cn.conjugate_residuals)
    noise = np.random.default_rng(2).normal(size=x.shape)
    with pytest.raises(DegenerateError, match="cannot be checked"):
        lattice(x, lambda y: y + noise, lambda y: y + 2.0 * noise)


def test_lattices_keep_the_class_of_their_transforms() -> None:
    """Circular and A-nets: a wrong common transform is refused for each."""
    y = evolve_circular_by_angles(
        [
            np.outer(np.arange(n), e) + 0.05 * np.outer(np.arange(n) ** 2, [1, 2, 1])
            for n, e in zip((4, 3, 2, 2), (*np.eye(3), [0.4, 0.3, -0.6]), strict=True)
        ],
        dict.fromkeys(combinations(range(4), 2), 1.5),
    )
    x, a, b, both = y[:, :, 0, 0], y[:, :, 1, 0], y[:, :, 0, 1], y[:, :, 1, 1]
    z = lattice(x, lambda _: a, lambda _: b, lambda *_: both)
    assert np.array_equal(z, y)
    # In the plane of the quad, but off its circle at one point.
    off = both.copy()
    off[1, 1] += 0.01 * (both - x)[1, 1]
    with pytest.raises(DegenerateError, match="net, although"):
        lattice(x, lambda _: a, lambda _: b, lambda *_: off)


def test_common_transform_is_found_from_one_point() -> None:
    y = cubes.evolve_nd(surfaces((4, 3, 2, 2), 3, seed=4, size=0.05))
    x, a, b, both = y[:, :, 0, 0], y[:, :, 1, 0], y[:, :, 0, 1], y[:, :, 1, 1]
    assert np.abs(common_transform(x, a, b, both[0, 0]) - both).max() < 1e-12
    z = lattice(x, lambda _: a, lambda _: b, lambda *nets: common_transform(*nets, both[0, 0]))
    assert np.abs(z - y).max() < 1e-12
    wrong = a.copy()
    wrong[2, 2] += 0.05 * (a[2, 2] - a[1, 2])
    with pytest.raises(DegenerateError, match=r"first transform, point \(2, 2\)"):
        common_transform(x, wrong, b, both[0, 0])


def test_smooth_surfaces_are_sampled_sheet_by_sheet() -> None:
    sheets = [
        sample(lambda u, v, w=w: [u + w, v + u * w, u * v], [0.0, 1, 2], [0.0, 0.5])
        for w in (0.0, 0.1)
    ]
    y = stack_transforms(sheets)
    assert y.shape == (3, 2, 2, 3)
    assert y[2, 1, 1] == pytest.approx([2.1, 0.7, 1.0])
    with pytest.raises(InputError, match="lists are needed"):
        sample(lambda u: [u, u], 3.0)
    with pytest.raises(InputError, match="nan"):
        sample(lambda u: [u, np.nan], [1.0, 2.0])


def test_lattices_of_conical_nets_are_conical() -> None:
    """Mirror images in two planes; a common net of planar quads without cones is refused."""
    x = Net.from_mesh(generate("conical")).points[:9, :7] / 1000.0
    a, b = x * [1.0, 1.0, -1.0] - [0.0, 0.0, 4.0], x * [-1.0, 1.0, 1.0] - [30.0, 0.0, 0.0]
    both = a * [-1.0, 1.0, 1.0] - [30.0, 0.0, 0.0]
    z = lattice(x, lambda _: a, lambda _: b, lambda *_: both)
    assert np.array_equal(z[..., 1, 1, :], both)
    corner = both[0, 0] + 0.3 * (b - x)[0, 0] + 0.03 * (a - x)[0, 0]
    other = common_transform(x, a, b, corner)
    planar = np.stack([stack_transforms([x, b]), stack_transforms([a, other])], axis=-3)
    assert cn.conjugate_residuals(planar)["planarity"] < 1e-12
    with pytest.raises(DegenerateError, match="no conical net, although"):
        lattice(x, lambda _: a, lambda _: b, lambda *_: other)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (lambda y: y[1:], r"the net of transform_b has shape \(5, 5, 3\); \(6, 5, 3\)"),
        (lambda y: None, "the net of transform_b is not an array of numbers"),
        (lambda y: y * np.nan, r"the net of transform_b: entry \(0, 0, 0\) is nan"),
    ],
)
def test_nets_of_transforms_are_looked_at(wrong: Any, words: str) -> None:
    x = planar_net()
    with pytest.raises(InputError, match=words):
        lattice(x, lambda y: y + 1.0, wrong)
    with pytest.raises(InputError, match="net has shape"):
        lattice(np.zeros((0, 3)), lambda y: y, lambda y: y)

"""T-nets: Moutard evolution, the star-triangle map, consistency in three and four directions."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats
from ddgfab.nets import (
    coordinate_surfaces,
    evolve_moutard,
    evolve_tnet,
    moutard_coefficients,
    moutard_cube,
    star_triangle,
)
from ddgfab.nets.knet import evolve_spherical, spherical_fourth


def axes(sizes: tuple[int, ...], dim: int, seed: int = 0) -> list[Floats]:
    """Wavy polylines from one point."""
    rng = np.random.default_rng(seed)
    start = rng.normal(size=dim)
    steps = [
        0.3 * rng.normal(size=(n - 1, dim)) + np.eye(dim)[k % dim] for k, n in enumerate(sizes)
    ]
    return [start + np.concatenate([np.zeros((1, dim)), np.cumsum(s, axis=0)]) for s in steps]


def surfaces(sizes: tuple[int, ...], dim: int) -> dict[tuple[int, int], Floats]:
    """T-nets on the coordinate planes with uneven coefficients."""
    rng, lines = np.random.default_rng(3), axes(sizes, dim)
    out = {}
    for k, m in combinations(range(len(sizes)), 2):
        a = rng.uniform(0.4, 1.4, (sizes[k] - 1, sizes[m] - 1))
        out[k, m] = evolve_moutard(lines[k], lines[m], a)
    return out


def test_evolution_has_the_given_coefficients() -> None:
    first, second = axes((5, 7), 4)
    a = np.random.default_rng(1).uniform(-1.5, 1.5, (4, 6))
    net = evolve_moutard(first, second, a)
    found, gap = moutard_coefficients(net)
    assert np.allclose(found, a, rtol=1e-11, atol=0)
    assert gap.max() < 1e-13
    assert np.array_equal(net[:, 0], first)
    # Exchanged directions have the opposite coefficient.
    assert np.allclose(moutard_coefficients(net, (1, 0))[0], -a, rtol=1e-11, atol=0)


def test_a_net_that_is_no_t_net_has_a_gap() -> None:
    x = np.random.default_rng(2).normal(size=(4, 5, 3))
    assert moutard_coefficients(x)[1].min() > 1e-3


def test_star_triangle_gives_one_eighth_point_from_three_faces() -> None:
    """The three computations of m_123 agree with the minus sign of the map, not with plus."""
    rng = np.random.default_rng(4)
    a12, a23, a31 = rng.uniform(-2, 2, 3)
    m, m1, m2, m3 = rng.normal(size=(4, 5))
    m12, m23, m31 = m + a12 * (m2 - m1), m + a23 * (m3 - m2), m + a31 * (m1 - m3)
    b12, b23, b31 = star_triangle(a12, a23, a31)
    for sign, agree in ((1, True), (-1, False)):
        one = m1 + sign * b23 * (m31 - m12)
        two = m2 + sign * b31 * (m12 - m23)
        three = m3 + sign * b12 * (m23 - m31)
        spread = max(np.abs(one - two).max(), np.abs(two - three).max())
        assert (spread < 1e-13 * np.abs(one).max()) == agree
    assert np.allclose(moutard_cube(m, m1, m2, m3, m12, m31, m23), m1 + b23 * (m31 - m12))


def test_star_triangle_is_an_involution_and_refuses_a_zero_denominator() -> None:
    a = np.random.default_rng(5).uniform(0.3, 2, (3, 8))
    # Applied twice: the denominator of the image is that of a inverted, and signs cancel.
    assert np.allclose(star_triangle(*star_triangle(*a)), a)
    with pytest.raises(DegenerateError, match=r"cube \(1,\).*zero"):
        star_triangle([1.0, 1.0], [1.0, 1.0], [1.0, -0.5])
    with pytest.raises(InputError, match="not a finite number"):
        star_triangle(1.0, np.nan, 1.0)


@pytest.mark.parametrize(
    ("sizes", "dim"), [((4, 3, 5), 3), ((3, 3, 2, 4), 3), ((2, 3, 2, 2, 2), 5)]
)
def test_consistency_in_three_four_and_five_directions(sizes: tuple[int, ...], dim: int) -> None:
    """Every 2-face of the net fulfils the equation, and every other cube gives the same points."""
    net = evolve_tnet(surfaces(sizes, dim), verify=True)
    for pair in combinations(range(len(sizes)), 2):
        assert moutard_coefficients(net, pair)[1].max() < 1e-10
    # The same with the directions in another order: other cubes, the same net.
    order = tuple(reversed(range(len(sizes))))
    turned = evolve_tnet(coordinate_surfaces(net.transpose(*order, len(sizes))))
    assert np.allclose(turned.transpose(*order, len(sizes)), net, rtol=1e-9, atol=1e-9)


def test_spherical_nets_are_t_nets_by_the_star_triangle_map() -> None:
    """Half-turns and the star-triangle map are two routes to the same net of unit vectors."""
    lines = [v / np.linalg.norm(v, axis=1)[:, None] for v in axes((4, 5, 3, 3), 3)]
    m = evolve_spherical(lines)
    assert np.abs(np.linalg.norm(m, axis=-1) - 1).max() < 1e-14
    assert np.allclose(evolve_tnet(coordinate_surfaces(m), verify=True), m, atol=1e-10)


def test_spherical_fourth_number_check() -> None:
    """mathematics.md 3.4: n_12 = (.43082141, -.59302326, .68023256), as m_12 = -n_12 with m_1 =
    -n_1."""
    n, n1, n2 = np.array([[0, 0, 1], [np.sqrt(0.19), 0, 0.9], [0, -0.6, 0.8]])
    n12 = -spherical_fourth(n, -n1, n2)
    assert n12 == pytest.approx([0.43082141, -0.59302326, 0.68023256], abs=1e-8)
    factor = n @ (n1 + n2) / (1 + n1 @ n2)
    assert factor == pytest.approx(0.98837209, abs=1e-8)
    assert n12 == pytest.approx(-n + factor * (n1 + n2), abs=1e-15)
    # Half-turn: angles across the quad agree.
    assert n12 @ n1 == pytest.approx(n @ n2, abs=1e-15)


def test_bad_input_is_named() -> None:
    e = np.eye(3)
    with pytest.raises(InputError, match=r"m_i \(\) has length 1.1"):
        spherical_fourth(e[2], 1.1 * e[0], e[1])
    with pytest.raises(DegenerateError, match=r"n_1 = -n_2"):
        spherical_fourth(e[2], e[0], e[0])
    with pytest.raises(DegenerateError, match="m and m_j are parallel, the edge has no length"):
        spherical_fourth(e[2], e[0], -e[2])
    with pytest.raises(InputError, match=r"axis 1, vector \(2,\) has length 2"):
        evolve_spherical([e[[0, 1]], [e[0], e[1], 2 * e[2]]])
    with pytest.raises(InputError, match=r"axes 0 and 1 start"):
        evolve_spherical([e[[0, 1]], e[[1, 2]]])
    with pytest.raises(InputError, match="two directions"):
        evolve_spherical([e])
    # m_1 = m_2 at the second cell of row 0: made so by an axis that repeats the other's vector.
    lines = [np.stack([e[0], e[1]]), np.stack([e[0], e[2], e[2]])]
    made = evolve_spherical([lines[0], lines[1][:2]])
    lines[1][2] = made[1, 1]
    with pytest.raises(DegenerateError, match="n_1 = -n_2") as caught:
        evolve_spherical(lines)
    assert caught.value.cell == (0, 1)
    given = surfaces((3, 3, 3), 3)
    with pytest.raises(InputError, match=r"surface \(1, 2\) has shape \(3, 3, 3\)"):
        evolve_tnet({**given, (0, 2): given[0, 2][:, :2]})
    with pytest.raises(InputError, match="are needed"):
        evolve_tnet({(0, 1): given[0, 1]})
    with pytest.raises(InputError, match="differ on a common axis"):
        evolve_tnet({**given, (1, 2): given[1, 2] + 0.1})
    bad = given[0, 1].copy()
    bad[2, 2] += 0.1
    with pytest.raises(DegenerateError, match=r"surface \(0, 1\), quad \(1, 1\)"):
        evolve_tnet({**given, (0, 1): bad})
    with pytest.raises(DegenerateError, match=r"quad \(0, 0\): m_k = m_l"):
        moutard_coefficients(np.array([[[0.0, 0, 1], [1, 0, 0]], [[1, 0, 0], [0, 1, 0]]]))

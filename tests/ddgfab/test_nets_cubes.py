"""Conjugate nets in three and more directions: cubes, phi, consistency, layers."""

from __future__ import annotations

import re
from itertools import combinations, permutations
from typing import Any

import numpy as np
import pytest
from net_cases import planar_net

from ddgfab.errors import DegenerateError, InputError
from ddgfab.forms.registry import generate
from ddgfab.mesh import Floats
from ddgfab.net import Net
from ddgfab.nets import conjugate as cn
from ddgfab.nets import cubes
from ddgfab.nets.layers import common_transform, lattice, sample, stack_transforms
from ddgfab.nets.miquel import evolve_circular_by_angles
from ddgfab.transforms import combescure


def given_c() -> Floats:
    """The coefficients of mathematics.md 1.7, C[l, k] = c^lk."""
    return np.array([[0, 0.1, -0.2], [0.2, 0, -0.1], [0.05, 0.3, 0]])


def random_coefficients(count: int, seed: int = 3) -> Floats:
    c = np.random.default_rng(seed).uniform(-0.3, 0.3, size=(count, 3, 3))
    c[:, range(3), range(3)] = 0
    return c


def cube_of(c: Floats, dim: int, seed: int = 1) -> list[Floats]:
    """x, x_1, x_2, x_3, x_12, x_13, x_23 with coefficients c."""
    rng = np.random.default_rng(seed)
    x = rng.normal(size=dim)
    e = np.eye(3, dim) + 0.2 * rng.normal(size=(3, dim))
    quads = [x + (1 + c[m, k]) * e[k] + (1 + c[k, m]) * e[m] for k, m in combinations(range(3), 2)]
    return [x, *(x + e), *quads]


def surfaces(sizes: tuple[int, ...], dim: int, seed: int = 0, size: float = 0.1) -> dict:
    """Random conjugate coordinate surfaces with common axes."""
    rng = np.random.default_rng(seed)
    lines = []
    for k, n in enumerate(sizes):
        steps = 0.15 * rng.normal(size=(n - 1, dim))
        steps[:, k % dim] += 1.0
        if k >= dim:
            steps += 0.5
        lines.append(np.concatenate([np.zeros((1, dim)), np.cumsum(steps, axis=0)]))
    out = {}
    for k, m in combinations(range(len(sizes)), 2):
        c = rng.uniform(-size, size, size=(2, sizes[k] - 1, sizes[m] - 1))
        out[k, m] = cn.evolve_conjugate(lines[k], lines[m], c[0], c[1])
    return out


def test_phi_numbers() -> None:
    assert cubes.cube_xi(given_c()) == pytest.approx([1.28174387, 1.32479564, 0.65395095], abs=1e-8)
    p = cubes.phi(given_c())
    wanted = {
        (0, 1): 0.019073569482,  # c_3^12
        (1, 0): 0.220708446866,
        (1, 2): -0.182561307902,  # c_1^23
        (2, 1): 0.204359673025,
        (2, 0): 0.068119891008,  # c_2^31
        (0, 2): -0.273387829246,
    }
    for at, value in wanted.items():
        assert p[at] == pytest.approx(value, abs=1e-12)
    assert np.abs(cubes.phi_inverse(p) - given_c()).max() < 1e-14


def test_phi_solves_the_linear_system_of_the_lemma_and_its_inverse_inverts() -> None:
    c = random_coefficients(200)
    p = cubes.phi(c)
    for i, j, k in permutations(range(3)):
        left = (1 + c[:, i, k]) * p[:, j, k] - c[:, j, k] * p[:, i, j] - c[:, i, k] * p[:, j, i]
        assert np.abs(left - c[:, j, k]).max() < 1e-13
    assert np.abs(cubes.phi_inverse(p) - c).max() < 1e-12
    assert np.abs(cubes.phi(cubes.phi_inverse(c)) - c).max() < 1e-12
    again = cubes.seen_from_opposite(cubes.seen_from_opposite(c))
    assert np.abs(again - c).max() < 1e-14


@pytest.mark.parametrize("dim", [3, 4, 6])
def test_phi_is_what_the_opposite_faces_of_a_cube_have(dim: int) -> None:
    c = random_coefficients(1, dim)[0]
    corners = cube_of(c, dim)
    x, x1, x2, x3, x12, x13, x23 = corners
    last = cubes.cube_point(*corners)
    p = cubes.phi(c)
    faces = {(0, 1): (x3, x13, x23), (0, 2): (x2, x12, x23), (1, 2): (x1, x12, x13)}
    for (k, m), (base, end_k, end_m) in faces.items():
        assert cn.conj_residual(base, end_k, end_m, last) < 1e-13
        made = cn.conj_coeffs(base, end_k, end_m, last)
        assert made == pytest.approx((p[m, k], p[k, m]), abs=1e-12)
    # Seen from the opposite corner of a quad.
    seen = cubes.seen_from_opposite(c)
    assert cn.conj_coeffs(x12, x2, x1, x) == pytest.approx((seen[1, 0], seen[0, 1]), abs=1e-12)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_eighth_vertex_is_the_point_of_three_planes(scale: float) -> None:
    corners = [scale * p for p in cube_of(given_c(), 3)]
    _, x1, x2, x3, x12, x13, x23 = corners
    normals, heights = [], []
    for base, a, b in ((x1, x12, x13), (x2, x12, x23), (x3, x13, x23)):
        n = np.cross(a - base, b - base)
        n /= np.linalg.norm(n)
        normals.append(n)
        heights.append(n @ base)
    expected = np.linalg.solve(normals, heights)
    assert np.abs(cubes.cube_point(*corners) - expected).max() < 1e-12 * scale


def test_evolution_keeps_planarity_and_is_affinely_covariant() -> None:
    given = surfaces((7, 6, 5), 3)
    x = cubes.evolve_3d(given[0, 1], given[0, 2], given[1, 2])
    assert x.shape == (7, 6, 5, 3)
    assert cn.conjugate_residuals(x)["planarity"] < 1e-11
    for pair, surface in cubes.coordinate_surfaces(x).items():
        assert np.array_equal(surface, given[pair])
    matrix = np.array([[1, 0.4, 0], [0, 2, 0.3], [0.2, 0, 0.7]])
    image = cubes.evolve_nd({pair: s @ matrix for pair, s in given.items()}, verify=True)
    assert np.abs(image - x @ matrix).max() < 1e-10
    # From another corner: the same net.
    back = cubes.evolve_nd(cubes.coordinate_surfaces(x[::-1, ::-1, ::-1]))
    assert np.abs(back[::-1, ::-1, ::-1] - x).max() < 1e-9 * np.abs(x).max()


@pytest.mark.parametrize("dim", [3, 4])
def test_four_directions_are_consistent(dim: int) -> None:
    """All four cubes at x_1234 give the same point (Theorem 2.5)."""
    x = cubes.evolve_nd(surfaces((2, 2, 2, 2), dim, seed=dim, size=0.4), verify=True)
    made = []
    for i in range(4):
        # The cube in the layer u_i = 1, based at x_i.
        layer = np.take(x, 1, axis=i)
        c = [layer[t] for t in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))]
        made.append(cubes.cube_point(*c, layer[1, 1, 0], layer[1, 0, 1], layer[0, 1, 1]))
    scale = np.ptp(x.reshape(-1, dim), axis=0).max()
    assert np.ptp(made, axis=0).max() < 1e-10 * scale


def test_five_cube_every_vertex_from_every_face() -> None:
    x = cubes.evolve_nd(surfaces((2,) * 5, 5, seed=8), verify=True)
    scale = np.ptp(x.reshape(-1, 5), axis=0).max()
    worst = 0.0
    for vertex in np.ndindex(*(2,) * 5):
        nonzero = [k for k in range(5) if vertex[k]]
        for three in combinations(nonzero, 3):
            p = {}
            for shift in np.ndindex(2, 2, 2):
                at = list(vertex)
                for k, s in zip(three, shift, strict=True):
                    at[k] = s
                p[shift] = x[tuple(at)]
            again = cubes.cube_point(
                p[0, 0, 0], p[1, 0, 0], p[0, 1, 0], p[0, 0, 1], p[1, 1, 0], p[1, 0, 1], p[0, 1, 1]
            )
            worst = max(worst, float(np.abs(again - x[vertex]).max()))
    assert worst < 1e-13 * scale


def test_larger_nets_of_four_directions() -> None:
    given = surfaces((4, 3, 3, 4), 4, seed=2, size=0.05)
    x = cubes.evolve_nd(given, verify=True)
    assert np.isfinite(x).all()
    assert cn.conjugate_residuals(x)["planarity"] < 1e-11


def test_degenerate_cubes_are_named() -> None:
    c = given_c()
    c[0, 1] = -1.0
    with pytest.raises(DegenerateError, match=r"cube \(1,\): 1 \+ c = 0"):
        cubes.cube_xi(np.stack([given_c(), c]))
    # M_kl = 1/2 everywhere off the diagonal: I - M has no inverse. c / (1 + c) = 1/2 for c = 1.
    with pytest.raises(DegenerateError, match="planes of the three further faces"):
        cubes.cube_xi(np.ones((3, 3)))
    half = np.full((3, 3), -0.5)
    with pytest.raises(DegenerateError, match="three corners of a quad"):
        cubes.seen_from_opposite(half)
    corners = cube_of(given_c(), 3)
    corners[5] = corners[5] + [0, 0.01, 0]
    with pytest.raises(DegenerateError, match=r"quad \(0, 2\) is not planar"):
        cubes.cube_point(*corners)
    with pytest.raises(InputError, match="shape"):
        cubes.phi(np.zeros((2, 3)))


def test_surfaces_that_do_not_fit_are_named() -> None:
    given = surfaces((4, 3, 3), 3)
    bent = given[1, 2].copy()
    bent[2, 1] += [0.1, 0, 0.1]
    with pytest.raises(DegenerateError, match=r"surface \(1, 2\), quad \(1, 0\): it is not planar"):
        cubes.evolve_nd({**given, (1, 2): bent})
    with pytest.raises(InputError, match=r"differ on axis 1"):
        cubes.evolve_nd({**given, (1, 2): given[1, 2] * 1.1})
    with pytest.raises(InputError, match=r"\(3, 3, 3\) is needed"):
        cubes.evolve_nd({**given, (1, 2): given[1, 2][:2]})
    with pytest.raises(InputError, match="are needed"):
        cubes.evolve_nd({(0, 1): given[0, 1], (0, 2): given[0, 2]})
    # The cube below point (2, 1, 1) gets a quad with 1 + c = 0.
    lines = np.eye(3)[:, None] * np.arange(3.0)[None, :, None]
    c = np.zeros((2, 2))
    c[1, 0] = -1.0
    broken = {pair: cn.evolve_conjugate(lines[pair[0]], lines[pair[1]], 0, 0) for pair in given}
    broken[0, 1] = cn.evolve_conjugate(lines[0], lines[1], 0, c)
    with pytest.raises(DegenerateError, match=r"cube below point \(2, 1, 1\)") as caught:
        cubes.evolve_nd(broken)
    assert caught.value.cell == (2, 1, 1)


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


@pytest.mark.parametrize(
    ("directions", "where", "checked", "message"),
    [
        (3, (0, 1, 2), True, r"\(1, 1, 1\): .*not planar"),
        (4, (0, 1, 2, 3), True, r"\(1, 1, 1, 1\): another cube"),
        # Not seen by the cube of the first three directions, which does not use these points.
        (4, (0, 1, 2), False, r"\(1, 1, 1, 1\): another cube"),
    ],
)
def test_verify_sees_wrong_points(
    monkeypatch: pytest.MonkeyPatch,
    directions: int,
    where: tuple[int, ...],
    checked: bool,
    message: str,
) -> None:
    given = surfaces((3,) * directions, 4)
    made, fill = cubes._from_cube, cubes._fill
    bump = np.array([[0.0], [0.0], [0.0], [1e-3]])

    def wrong(net: Floats, subset: tuple[int, ...], verify: bool, limit: float) -> None:
        if subset != where:
            fill(net, subset, verify, limit)
            return
        monkeypatch.setattr(cubes, "_from_cube", lambda *a: made(*a) + bump)
        fill(net, subset, verify and checked, limit)
        monkeypatch.setattr(cubes, "_from_cube", made)

    monkeypatch.setattr(cubes, "_fill", wrong)
    with pytest.raises(DegenerateError, match="point " + message):
        cubes.evolve_nd(given, verify=True)
    assert np.isfinite(cubes.evolve_nd(given)).all()


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
        (lambda y: None, "the net of transform_b is no array of numbers"),
        (lambda y: y * np.nan, r"the net of transform_b: entry \(0, 0, 0\) is nan"),
    ],
)
def test_nets_of_transforms_are_looked_at(wrong: Any, words: str) -> None:
    x = planar_net()
    with pytest.raises(InputError, match=words):
        lattice(x, lambda y: y + 1.0, wrong)
    with pytest.raises(InputError, match="net has shape"):
        lattice(np.zeros((0, 3)), lambda y: y, lambda y: y)

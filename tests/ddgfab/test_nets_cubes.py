"""Conjugate nets in three and more directions: cubes, phi, consistency, layers."""

from __future__ import annotations

from itertools import combinations, permutations

import numpy as np
import pytest
from net_cases import surfaces

from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats
from ddgfab.nets import conjugate as cn
from ddgfab.nets import cubes


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

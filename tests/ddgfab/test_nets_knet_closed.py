"""Closed forms of K-nets: vacuum, Dini, pseudosphere, breather; Amsler against Painleve III."""

from __future__ import annotations

import numpy as np
import pytest
from knet_cases import EXACT
from scipy.integrate import solve_ivp

from ddgfab.errors import InputError
from ddgfab.mesh import Floats
from ddgfab.nets.knet import KNet, amsler, breather, dini, knet, pseudosphere, quad_angles, vacuum
from ddgfab.transforms import baecklund


def uneven(m: int, n: int, seed: int = 0) -> tuple[Floats, Floats]:
    rng = np.random.default_rng(seed)
    return rng.uniform(0.1, 0.5, m), rng.uniform(0.1, 0.5, n)


def rebuilt(net: KNet) -> Floats:
    """The points by evolution from the axes: a second route to closed forms."""
    return net.cauchy().build().points


# --- Dini and pseudosphere -----------------------------------------------------------------------
def test_vacuum_is_a_k_net_on_a_line() -> None:
    a, b = uneven(6, 8)
    net = vacuum(a, b, r=2.0)
    assert max(net.residuals().values()) < EXACT
    assert np.array_equal(net.points[..., :2], np.zeros((7, 9, 2)))
    assert net.points[6, 8, 2] == pytest.approx(2 * (np.sin(a).sum() - np.sin(b).sum()))
    # Cauchy data of it: no turns, the corner angle pi.
    again = knet((a, b), [np.zeros(5), np.zeros(7)], np.pi, r=2.0, normal=(1, 0, 0), edge=(0, 0, 1))
    assert np.allclose(again.points, net.points, atol=EXACT)
    assert np.allclose(again.normals, net.normals, atol=EXACT)


@pytest.mark.parametrize("sigma", [0.05, 0.9, np.pi / 2, 2.5, 3.1])
@pytest.mark.parametrize("t0", [0.3, -4.0])
def test_dini_is_a_k_net_and_the_transform_of_the_vacuum(sigma: float, t0: float) -> None:
    """Closed form against the half-turns of `baecklund` and against evolution."""
    a, b = uneven(9, 7)
    net = dini(a, b, sigma, t0=t0, r=1.5)
    assert max(net.residuals().values()) < EXACT
    made = baecklund(vacuum(a, b, r=1.5), sigma, 2 * np.arctan(t0))
    assert np.allclose(made.points, net.points, atol=1e-11)
    assert np.allclose(made.normals, net.normals, atol=1e-11)
    assert np.allclose(rebuilt(net), net.points, atol=1e-10)


def test_dini_converges_to_its_smooth_surface() -> None:
    """x(u, v) of asymptotic parameters (mathematics.md 3.15, 5.5), second order in the cell
    size."""
    sigma, errors = 1.1, []
    for cells in (10, 20, 40, 80):
        delta = 1.0 / cells
        # Edges of length one per unit of u: r sin(delta) = delta, r -> 1.
        net = dini(np.full(cells, delta), np.full(cells, delta), sigma, r=delta / np.sin(delta))
        u, v = np.meshgrid(*[np.linspace(0, 1, cells + 1)] * 2, indexing="ij")
        psi = 2 * np.arctan(np.exp(-u * np.tan(sigma / 2) + v / np.tan(sigma / 2)))
        theta, s = u + v, np.sin(sigma)
        smooth = np.stack(
            [
                -s * np.sin(psi) * np.sin(theta),
                s * np.sin(psi) * np.cos(theta),
                u - v - s * np.cos(psi),
            ],
            axis=-1,
        )
        errors.append(np.abs(net.points - smooth).max())
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx([2, 2, 2], abs=0.1)


def test_pseudosphere_numbers_and_rotation() -> None:
    """alpha = pi / 8 (mathematics.md 3.9); L = .4031997192."""
    alpha = np.pi / 8
    net = pseudosphere((3, 6), alpha)
    assert np.log(np.tan(np.pi / 4 + alpha / 2)) == pytest.approx(0.4031997192, abs=1e-10)
    x = net.points[0, 1:5]
    radii = np.hypot(x[:, 0], x[:, 1])
    want = [0.9238795325, 0.7445208382, 0.5478765278, 0.3834236723]
    assert radii == pytest.approx(want, abs=1e-10)
    assert radii[0] == pytest.approx(np.cos(alpha), rel=1e-15)
    heights = [0.0, -0.0977676425, -0.3114910881, -0.6071611619]
    assert x[:, 2] == pytest.approx(heights, abs=1e-10)
    assert max(net.residuals().values()) < EXACT
    assert np.allclose(rebuilt(net), net.points, atol=1e-11)
    # Rotational: (i + 1, j + 1) is (i, j) turned by 2 alpha about the z-axis.
    c, s = np.cos(2 * alpha), np.sin(2 * alpha)
    turned = net.points[:-1, :-1] @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    assert np.allclose(net.points[1:, 1:], turned, atol=1e-14)
    # The Dini form with t0 = 1 and sigma = pi / 2 is the same net, the offset moves along it.
    same = dini(np.full(3, alpha), np.full(6, alpha), np.pi / 2)
    assert np.allclose(same.points, net.points, atol=1e-14)
    moved = pseudosphere((3, 4), alpha, offset=2.0)
    shifted = net.points[:, 2:, 2] - net.points[0, 2, 2]
    assert np.allclose(moved.points[..., 2] - moved.points[0, 0, 2], shifted, atol=1e-14)


def test_pseudosphere_tends_to_the_smooth_one() -> None:
    """At equal radius the distance in height is s (1 - sin(alpha) / L) = s (alpha^2 / 3 + ...)."""
    for alpha, near in ((0.2, 0.02), (0.05, 1e-3)):
        step = np.log(np.tan(np.pi / 4 + alpha / 2))
        net = pseudosphere((1, int(2.0 / step)), alpha)
        x = net.points[0]
        s = np.arccosh(1 / np.hypot(x[:, 0], x[:, 1]))
        gap = np.abs((np.tanh(s) - s) - x[:, 2])
        assert gap == pytest.approx(s * (1 - np.sin(alpha) / step), abs=1e-12)
        assert gap[1:] / s[1:] == pytest.approx(alpha**2 / 3, rel=near + alpha**2)


def test_long_nets_do_not_overflow() -> None:
    net = dini(np.full(20, 0.6), np.full(500, 0.7), 0.9, t0=1e-3)
    assert np.isfinite(net.points).all()
    assert max(net.residuals()[k] for k in ("unit", "angle", "moutard")) < 1e-11
    assert np.isfinite(pseudosphere((2, 2000), 1.2, offset=-900).points).all()


# --- breather ------------------------------------------------------------------------------------
def test_breather_is_the_complex_bianchi_transform() -> None:
    """Against Bianchi's formula in complex numbers, bilinear product (mathematics.md 3.12)."""
    alpha, tau, t0 = np.pi / 16, 0.8, 0.7 + 0.3j
    net = breather(np.full(24, alpha), np.full(24, alpha), tau, t0=t0)
    assert max(net.residuals().values()) < 1e-13
    sigma = np.pi / 2 + 1j * tau
    i, j = np.indices((25, 25))
    a = np.cos((sigma + alpha) / 2) / np.cos((sigma - alpha) / 2)
    b = np.sin((sigma + alpha) / 2) / np.sin((sigma - alpha) / 2)
    psi = 2 * np.arctan(t0 * a**i * b**j)
    theta, zero = (i + j) * alpha, np.zeros((25, 25))
    t = np.stack([-np.sin(theta), np.cos(theta), zero], axis=-1)
    up, line = np.array([0, 0, 1.0]), vacuum(np.full(24, alpha), np.full(24, alpha))
    along = np.cos(psi)[..., None] * t + np.sin(psi)[..., None] * up
    m = line.m
    m1 = ((-1.0) ** i)[..., None] * (np.cos(sigma) * line.normals + np.sin(sigma) * along)
    m2 = m1.conj()
    factor = np.sum(m * (m1 - m2), -1) / (1 - np.sum(m1 * m2, -1))
    x12 = line.points + factor[..., None] * np.cross(m2, m1)
    m12 = m + factor[..., None] * (m2 - m1)
    assert np.abs(x12.imag).max() < 1e-13
    assert np.abs(m12.imag).max() < 1e-13
    assert np.allclose(x12.real, net.points, atol=1e-12)
    assert np.allclose(m12.real, net.m, atol=1e-12)


def test_breather_of_uneven_cells_evolves_from_its_axes() -> None:
    a, b = uneven(8, 9, seed=4)
    net = breather(a, b, -1.3, t0=0.2 - 2j, r=40.0)
    assert max(net.residuals().values()) < EXACT
    assert np.allclose(rebuilt(net), net.points, atol=1e-9)
    assert np.ptp(np.linalg.norm(net.points[..., :2], axis=-1)) > 1.0
    other = breather(a, b, 1.3, t0=np.conj(0.2 - 2j), r=40.0)
    # tau -> -tau and t0 -> its conjugate exchange the two transforms.
    assert np.allclose(other.points, net.points, atol=1e-10)


# --- Amsler --------------------------------------------------------------------------------------
def painleve(angle: float, ends: Floats) -> Floats:
    """f(s), s f'' + f' = sin f, f(0) = angle, regular at 0: f = angle + s sin(angle) + ..."""
    sine, cosine = np.sin(angle), np.cos(angle)
    s0 = 1e-6
    start = [angle + s0 * sine + s0**2 * sine * cosine / 4, sine + s0 * sine * cosine / 2]
    solution = solve_ivp(
        lambda s, y: [y[1], (np.sin(y[0]) - y[1]) / s],
        (s0, float(ends.max())),
        start,
        t_eval=ends,
        method="DOP853",
        rtol=1e-12,
        atol=1e-13,
    )
    return np.asarray(solution.y[0])


def test_amsler_contains_two_lines_and_is_a_k_net() -> None:
    a, b = uneven(10, 12)
    net = amsler(a, b, np.pi / 3, r=3.0)
    assert max(net.residuals().values()) < EXACT
    x = net.points
    for line, delta in ((x[:, 0], a), (x[0], b)):
        direction = line[-1] / np.linalg.norm(line[-1])
        assert np.abs(np.cross(line, direction)).max() < 1e-13
        assert line @ direction == pytest.approx(3 * np.append(0, np.cumsum(np.sin(delta))))
    assert np.arccos(x[1, 0] @ x[0, 1] / (9 * np.sin(a[0]) * np.sin(b[0]))) == pytest.approx(
        np.pi / 3
    )


def test_amsler_angles_converge_to_painleve() -> None:
    """mathematics.md 3.14: f(.25), f(1), and errors 4.3e-4, 1.6e-4, 4.7e-5, 1.3e-5 for M =
    8..64."""
    f = painleve(np.pi / 3, np.array([0.25, 1.0]))
    assert f == pytest.approx([1.269963844788, 1.983241599173], abs=1e-9)
    errors = []
    for cells in (8, 16, 32, 64):
        angles = np.full(cells + 1, 1.0 / cells)
        phi = quad_angles(amsler(angles, angles, np.pi / 3))[0][cells, cells]
        want = painleve(np.pi / 3, np.array([((cells + 0.5) / cells) ** 2]))[0]
        errors.append(abs(phi - want))
    assert errors == pytest.approx([4.3e-4, 1.6e-4, 4.7e-5, 1.3e-5], rel=0.05)


# --- bad input -----------------------------------------------------------------------------------
def test_bad_input_is_named() -> None:
    a, b = uneven(3, 4)
    with pytest.raises(InputError, match="alpha 1 is 0; angles between 0 and pi are"):
        vacuum([0.1, 0.0], b)
    with pytest.raises(InputError, match=r"beta 0 is 3.5"):
        dini(a, [3.5], 1.0)
    with pytest.raises(InputError, match=r"betas have shape \(0,\)"):
        vacuum(a, [])
    with pytest.raises(InputError, match="r = -2"):
        vacuum(a, b, r=-2)
    for sigma, text in ((0.0, "0"), (np.pi, "3.14159"), (4.0, "4"), (np.nan, "nan")):
        with pytest.raises(InputError, match=f"sigma of transform 0 is {text}"):
            dini(a, b, sigma)
    with pytest.raises(InputError, match="t0 = 0"):
        dini(a, b, 1.0, t0=0)
    with pytest.raises(InputError, match=r"beta 2 is .*sigma = beta"):
        dini(a, b, float(b[2]))
    with pytest.raises(InputError, match=r"alpha 1 is .*sigma \+ alpha = pi"):
        dini(a, b, np.pi - float(a[1]))
    with pytest.raises(InputError, match="tau = 0"):
        breather(a, b, 0.0)
    with pytest.raises(InputError, match="t0 = 0"):
        breather(a, b, 1.0, t0=0j)
    with pytest.raises(InputError, match=r"alpha = 1.6"):
        pseudosphere((2, 2), 1.6)
    with pytest.raises(InputError, match="cells of direction 0 = 0"):
        pseudosphere((0, 2), 0.2)
    with pytest.raises(InputError, match=r"angle = 3.14159: the lines coincide"):
        amsler(a, b, np.pi)
    with pytest.raises(InputError, match="angle = nan"):
        amsler(a, b, np.nan)

"""Isothermic nets, their duals and Darboux transforms: mathematics.md 6.1-6.3."""

from __future__ import annotations

import numpy as np
import pytest
from isothermic_cases import EXACT, catenoid, random_lines, same_up_to_translation

from ddgfab import Net
from ddgfab.errors import DegenerateError, InputError
from ddgfab.forms import generate
from ddgfab.grid import grid_mesh
from ddgfab.measures import mixed_areas
from ddgfab.nets import evolve_nd, lattice, stack_transforms
from ddgfab.nets.crossratio import cross_ratio, cross_ratios
from ddgfab.nets.isothermic import (
    cross_ratio_labels,
    evolve_isothermic,
    isothermic_point,
    isothermic_residuals,
)
from ddgfab.transforms import Moebius, christoffel_dual, darboux, darboux_common, darboux_dual
from ddgfab.transforms.christoffel import integrate


# --- the quad ------------------------------------------------------------------------------------
@pytest.mark.parametrize(("alpha1", "alpha2"), [(1.0, -1.0), (1.3, -0.7), (2.0, 0.5)])
def test_fourth_point_has_the_cross_ratio(alpha1: float, alpha2: float) -> None:
    x, x1, x2 = np.array([[0.1, 0, 0], [1, 0.2, 0.1], [-0.1, 1.2, 0.3]])
    point = isothermic_point(x, x1, x2, alpha1, alpha2)
    real, imaginary = cross_ratio(x, x1, point, x2)
    assert real == pytest.approx(alpha1 / alpha2, rel=EXACT)
    assert imaginary < EXACT


def test_conformal_square_has_labels_one_and_minus_one() -> None:
    point = isothermic_point([0, 0, 0], [1, 0, 0], [0, 1, 0], 1, -1)
    np.testing.assert_allclose(point, [1, 1, 0], atol=EXACT)
    square = np.array([[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0.0]]])
    labels, defect = cross_ratio_labels(square)
    assert defect < EXACT
    np.testing.assert_allclose(np.concatenate(labels), [1, -1], rtol=EXACT)


# --- nets ----------------------------------------------------------------------------------------
def test_labels_given_are_labels_found() -> None:
    a, b = random_lines(1, 5)
    alpha, beta = np.array([1.0, 1.3, 0.8, 1.1, 0.9]), -np.array([0.7, 1.0, 1.2, 0.9, 1.5])
    net = evolve_isothermic(a, b, alpha, beta)
    assert max(isothermic_residuals(net).values()) < 1e-11
    labels, _ = cross_ratio_labels(net)
    factor = labels[0][0] / alpha[0]
    np.testing.assert_allclose(labels[0], factor * alpha, rtol=1e-11)
    np.testing.assert_allclose(labels[1], factor * beta, rtol=1e-11)


def test_moebius_images_are_isothermic_with_the_same_labels() -> None:
    net = catenoid()
    image = Moebius.inversion([0.3, -2.0, 1.0], 2.0)(net)
    first, second = cross_ratio_labels(net)[0], cross_ratio_labels(image)[0]
    assert max(isothermic_residuals(image).values()) < 1e-11
    for one, two in zip(first, second, strict=True):
        np.testing.assert_allclose(one, two, rtol=1e-11)


def test_circular_net_need_not_be_isothermic() -> None:
    net = np.array(
        [
            [[np.cos(u) * np.cosh(v), np.sin(u) * np.cosh(v), w * v] for v in (0, 0.4, 0.9)]
            for u, w in ((0, 1), (0.5, 1), (0.9, 1))
        ]
    )
    assert isothermic_residuals(net)["circularity"] < EXACT  # a surface of revolution
    squeezed = generate("canal")  # no product of functions of u and v
    assert cross_ratio_labels(np.asarray(Net.from_mesh(squeezed)))[1] > 1e-3


def test_three_directions_are_consistent() -> None:
    """Three coordinate surfaces by labels, filled by planes alone: an isothermic 3-net."""
    rng = np.random.default_rng(3)
    labels = [np.array([1.0, 1.2]), np.array([-0.8, -1.1]), np.array([0.35, 0.3])]
    axes = np.eye(3) + 0.1 * rng.standard_normal((3, 3))
    lines = [np.cumsum(np.vstack([np.zeros(3), axes[k], axes[k] * 1.1]), axis=0) for k in range(3)]
    surfaces = {
        (i, j): evolve_isothermic(lines[i], lines[j], labels[i], labels[j])
        for i, j in ((0, 1), (0, 2), (1, 2))
    }
    net = evolve_nd(surfaces, verify=True)
    assert isothermic_residuals(net)["cross-ratio labels"] < 1e-10
    found = cross_ratio_labels(net)[0]
    factor = found[0][0] / labels[0][0]
    for own, given in zip(found, labels, strict=True):
        np.testing.assert_allclose(own, factor * given, rtol=1e-10)


def test_large_cauchy_problem_is_refused() -> None:
    a, b = random_lines(1, 6)
    evolve_isothermic(a, b, 1.0, -1.0)  # small: fine
    u = np.linspace(0, 1, 41)[:, None]
    lines = u * [1, 0, 0] + 0.1 * u**2 * [0, 0, 1], u * [0, 1, 0] + 0.1 * u**2 * [0, 0, 1]
    with pytest.raises(DegenerateError, match=r"(?s)40 x 40 cells.*ill-posed"):
        evolve_isothermic(*lines, 1.0, -1.0)
    assert evolve_isothermic(*lines, 1.0, -1.0, growth_limit=np.inf).shape == (41, 41, 3)


def test_errors_grow_as_the_warning_says() -> None:
    """mathematics.md 6.1 prints 32, 2.8e3, 2.8e5, 3e7, 3e9 at 4, 8, ..., 20 cells; noise does no
    less."""
    for cells, printed in ((4, 32), (8, 2.8e3), (12, 2.8e5), (16, 3e7), (20, 3e9)):
        u = np.arange(cells + 1.0)[:, None] / cells
        lines = u * [1, 0, 0], u * [0, 1, 0]
        with pytest.raises(DegenerateError, match="errors in them grow") as caught:
            evolve_isothermic(*lines, 1.0, -1.0, growth_limit=1.0)
        told = float(str(caught.value).split("factor of ")[1].split()[0])
        assert printed < told < 1e5 * printed
        if cells == 4:
            assert told < 200
        # So does a disturbance made here.
        rng = np.random.default_rng(cells)
        noise = [1e-12 * rng.standard_normal(line.shape) for line in lines]
        noise[1][0] = noise[0][0]
        nets = [
            evolve_isothermic(*pair, 1.0, -1.0, growth_limit=np.inf)
            for pair in (lines, [a + b for a, b in zip(lines, noise, strict=True)])
        ]
        seen = np.abs(nets[1] - nets[0]).max() / max(np.abs(n).max() for n in noise)
        assert told / 100 < seen < told * 10


# --- the dual ------------------------------------------------------------------------------------
def test_dual_properties() -> None:
    a, b = random_lines(5, 6)
    net = evolve_isothermic(a, b, np.linspace(0.8, 1.3, 6), -np.linspace(1.2, 0.7, 6))
    dual = christoffel_dual(net)
    np.testing.assert_allclose(cross_ratios(dual)[0], cross_ratios(net)[0], rtol=1e-9)
    assert same_up_to_translation(christoffel_dual(dual), net) < 1e-11
    # Diagonals are antiparallel: x12* - x* to x2 - x1.
    diagonal, other = dual[1:, 1:] - dual[:-1, :-1], net[:-1, 1:] - net[1:, :-1]
    turned = np.cross(diagonal, other)
    scale = np.linalg.norm(diagonal, axis=-1) * np.linalg.norm(other, axis=-1)
    assert (np.linalg.norm(turned, axis=-1) / scale).max() < 1e-10
    # Mixed area zero: H = 0 with respect to each other.
    mesh = grid_mesh(net)
    mixed = mixed_areas(mesh, mesh.vertices, dual.reshape(-1, 3))
    assert np.abs(mixed).max() < 1e-10


def test_dual_of_the_sphere_is_the_catenoid() -> None:
    """mathematics.md 6.2: (sech u cos v, sech u sin v, tanh u) to (-cosh u cos v, .., u), order
    two."""

    def sphere_dual_error(n: int) -> float:
        u, v = np.meshgrid(np.linspace(-0.8, 0.8, n + 1), np.linspace(0, 1.6, n + 1), indexing="ij")
        step = 1.6 / n
        sphere = np.stack([np.cos(v) / np.cosh(u), np.sin(v) / np.cosh(u), np.tanh(u)], axis=-1)
        dual = christoffel_dual(sphere) * step**2
        target = np.stack([-np.cosh(u) * np.cos(v), -np.cosh(u) * np.sin(v), u], axis=-1)
        return same_up_to_translation(dual, target)

    errors = [sphere_dual_error(n) for n in (8, 16, 32)]
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.05)


def test_dual_refuses_other_nets_and_labels() -> None:
    a, b = random_lines(5, 4)
    net = evolve_isothermic(a, b, 1.0, -1.0)
    bent = net.copy()
    bent[2, 2, 2] += 0.01
    with pytest.raises(InputError, match="not isothermic"):
        christoffel_dual(bent)
    with pytest.raises(DegenerateError, match=r"quad of directions \(0, 1\) at \(1, 0\).*close"):
        christoffel_dual(net, ([1.0, 1.2, 1.0, 1.0], -1.0))
    with pytest.raises(InputError, match="labels of direction 1 has shape"):
        christoffel_dual(net, (1.0, [-1.0, -1.0]))
    with pytest.raises(InputError, match="1 lists of labels"):
        christoffel_dual(net, (1.0,))


def test_integrate_undoes_differences_in_three_directions() -> None:
    x = np.random.default_rng(0).standard_normal((3, 4, 5, 3))
    assert same_up_to_translation(integrate([np.diff(x, axis=k) for k in range(3)]), x) < EXACT


# --- Darboux -------------------------------------------------------------------------------------
def test_darboux_pair_is_an_isothermic_net_of_one_direction_more() -> None:
    net = catenoid()
    transform = darboux(net, 3.0, [3.0, 0.2, 1.0])
    both = stack_transforms([net, transform])
    assert isothermic_residuals(both)["cross-ratio labels"] < 1e-12
    labels = cross_ratio_labels(both)[0]
    own = cross_ratio_labels(net)[0]
    assert labels[2][0] / labels[0][0] == pytest.approx(3.0 / own[0][0], rel=1e-10)
    # The net is the transform's transform.
    np.testing.assert_allclose(darboux(transform, 3.0, net[0, 0]), net, atol=1e-11)


def test_darboux_permutability() -> None:
    net = catenoid()
    first, second = darboux(net, 3.0, [3.0, 0.2, 1.0]), darboux(net, -2.0, [0.3, 0.2, 1.0])
    common = darboux_common(net, first, second, 3.0, -2.0)
    np.testing.assert_allclose(darboux(first, -2.0, common[0, 0]), common, atol=1e-11)
    np.testing.assert_allclose(darboux(second, 3.0, common[0, 0]), common, atol=1e-11)
    four = lattice(
        net,
        lambda x: darboux(x, 3.0, [3.0, 0.2, 1.0]),
        lambda x: darboux(x, -2.0, [0.3, 0.2, 1.0]),
        lambda x, a, b: darboux_common(x, a, b, 3.0, -2.0),
    )
    assert isothermic_residuals(four)["cross-ratio labels"] < 1e-10


def test_darboux_of_the_dual() -> None:
    net = catenoid()
    transform = darboux(net, 3.0, [3.0, 0.2, 1.0])
    by_formula = darboux_dual(net, transform, christoffel_dual(net), 3.0)
    labels = cross_ratio_labels(net)[0]  # the same gauge for both
    assert same_up_to_translation(christoffel_dual(transform, labels), by_formula) < 1e-10


def test_darboux_refusals() -> None:
    net = catenoid()
    own = cross_ratio_labels(net)[0]
    with pytest.raises(DegenerateError, match="label of edge 0 of direction 1"):
        darboux(net, float(own[1][0]), [3.0, 0.2, 1.0])
    with pytest.raises(DegenerateError, match="mu = 0"):
        darboux(net, 0.0, [3.0, 0.2, 1.0])
    with pytest.raises(DegenerateError, match="direction 0 at"):
        darboux(net, 3.0, net[0, 0])
    with pytest.raises(InputError, match="start point"):
        darboux(net, 3.0, [1.0, 2.0])
    with pytest.raises(DegenerateError, match="does not close"):
        darboux(net, 3.0, [3.0, 0.2, 1.0], (own[0] * [1, 1, 1.5, 1, 1], own[1]))
    with pytest.raises(DegenerateError, match="labels of the directions are equal"):
        darboux_common(net, net + 1, net + 2, 2.0, 2.0)


def test_quad_refusals() -> None:
    with pytest.raises(DegenerateError, match="labels of the directions are equal"):
        isothermic_point([0, 0, 0], [1, 0, 0], [0, 1, 0], 1.0, 1.0)
    with pytest.raises(DegenerateError, match="an edge has no length"):
        isothermic_point([0, 0, 0], [0, 0, 0], [0, 1, 0], 1.0, -1.0)
    with pytest.raises(DegenerateError, match="at infinity"):
        isothermic_point([0, 0, 0], [1, 0, 0], [2, 0, 0], 1.0, 2.0)
    with pytest.raises(DegenerateError, match=r"alpha2\[1\] is zero"):
        evolve_isothermic(*random_lines(0, 2), 1.0, [1.0, 0.0])

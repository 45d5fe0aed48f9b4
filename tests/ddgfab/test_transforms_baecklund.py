"""Baecklund transforms, Bianchi's permutability, lattices of transforms as K-nets."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest
from knet_cases import EXACT, any_knet

from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import unit
from ddgfab.nets import lattice, stack_transforms, star_flatness
from ddgfab.nets.knet import KNet, dini, knet, recover_knet, spherical_fourth, vacuum
from ddgfab.transforms import baecklund, baecklund_from, baecklund_lattice, bianchi


@pytest.mark.parametrize("cells", [(8, 9), (1, 1), (3, 4, 2)])
@pytest.mark.parametrize("sigma", [0.2, 1.0, np.pi / 2, 2.6])
def test_a_transform_is_a_k_net_at_constant_distance(cells: tuple[int, ...], sigma: float) -> None:
    net = any_knet(*cells, r=2.0)
    other = baecklund(net, sigma, 0.7)
    assert max(other.residuals().values()) < EXACT
    assert all(np.array_equal(a, b) for a, b in zip(other.deltas, net.deltas, strict=True))
    segment = other.points - net.points
    assert np.allclose(np.linalg.norm(segment, axis=-1), 2 * np.sin(sigma), atol=EXACT)
    # Tangent to both, and the normals make the angle sigma.
    for n in (net.normals, other.normals):
        assert np.abs(np.sum(segment * n, axis=-1)).max() < 1e-11
    assert np.allclose(np.sum(net.normals * other.normals, axis=-1), np.cos(sigma), atol=EXACT)
    # A second route: from its points alone.
    if min(cells) > 1:
        assert star_flatness(other.points).max() < 1e-11
        assert recover_knet(other.points).data.r == pytest.approx(2.0, rel=1e-9)


def test_psi_is_the_angle_of_the_first_segment() -> None:
    net = any_knet(3, 3)
    e, n = unit(net.points[1, 0] - net.points[0, 0]), net.normals[0, 0]
    for psi in (-2.0, 0.3, 1.4):
        segment = unit(baecklund(net, 0.8, psi).points[0, 0] - net.points[0, 0])
        across = np.cross(n, e)
        assert segment == pytest.approx(-np.cos(psi) * e - np.sin(psi) * across, abs=1e-13)


def test_sheets_make_a_net_of_one_more_direction() -> None:
    """stack_transforms: the pair is a K-net with a third direction of normal angle sigma."""
    net = any_knet(4, 5)
    other = baecklund(net, 1.2, -0.4)
    points = stack_transforms([net.points, other.points])
    pair = KNet(points, stack_transforms([net.m, other.m]), 1.0, (*net.deltas, np.array([1.2])))
    assert max(pair.residuals().values()) < EXACT
    data = pair.cauchy()
    assert np.allclose(data.build().points, points, atol=1e-11)


def test_transform_of_a_transform_leads_back() -> None:
    """With the opposite segment (normal n, the one before) the first net comes back."""
    net = any_knet(6, 5)
    other = baecklund(net, 0.9, 1.1)
    back = baecklund_from(other, net.m[0, 0])
    # x' = x + m' x m and x = x' + m x m': the same segment.
    assert np.allclose(back.points, net.points, atol=EXACT)
    assert np.allclose(back.m, net.m, atol=EXACT)


def test_bianchi_permutability() -> None:
    """One formula, a then b, and b then a: the same net; symmetric in the two."""
    net = any_knet(9, 7, r=1.5)
    a, b = baecklund(net, 0.8, 0.5), baecklund(net, 1.3, -0.4)
    both = bianchi(net, a, b)
    swapped = bianchi(net, b, a)
    assert np.allclose(both.m, swapped.m, atol=1e-14)
    assert np.allclose(both.points, swapped.points, atol=1e-14)
    for first, sigma in ((a, 1.3), (b, 0.8)):
        step = baecklund_from(first, both.m[0, 0])
        assert np.allclose(step.points, both.points, atol=1e-13)
        cosine = np.sum(first.m * both.m, axis=-1)
        assert np.allclose(cosine, np.cos(sigma), atol=1e-13)
    assert max(both.residuals().values()) < EXACT


def test_lattice_of_layers_gives_the_same_net() -> None:
    """`lattice` with transforms as maps of points and fields in R^6, by Bianchi's formula."""
    net = any_knet(4, 3)

    def packed(part: KNet) -> np.ndarray:
        return np.concatenate([part.points, part.m], axis=-1)

    def unpacked(array: np.ndarray) -> KNet:
        return KNet(array[..., :3], array[..., 3:], net.r, net.deltas)

    made = lattice(
        packed(net),
        lambda z: packed(baecklund(unpacked(z), 0.8, 0.5)),
        lambda z: packed(baecklund(unpacked(z), 1.3, -0.4)),
        lambda z, a, b: packed(bianchi(unpacked(z), unpacked(a), unpacked(b))),
    )
    ours = baecklund_lattice(net, (0.8, 1.3), (0.5, -0.4))
    assert ours.shape == (5, 4, 2, 2)
    assert np.array_equal(ours.points, made[..., :3])
    assert np.array_equal(ours.m, made[..., 3:])
    # Without it the transforms start in directions that do not fit: refused, with the distance.
    with pytest.raises(DegenerateError, match="do not commute"):
        lattice(
            packed(net),
            lambda z: packed(baecklund(unpacked(z), 0.8, 0.5)),
            lambda z: packed(baecklund(unpacked(z), 1.3, -0.4)),
        )


@pytest.mark.parametrize("count", [1, 2, 3])
def test_lattices_are_k_nets_of_more_directions(count: int) -> None:
    """A 2-net and two transforms: the 4D net; every 2-face fulfils the conditions."""
    net = any_knet(5, 4, r=0.7)
    sigmas, psis = (0.8, 1.3, 2.2)[:count], (0.5, -0.4, 2.0)[:count]
    made = baecklund_lattice(net, sigmas, psis)
    assert made.d == 2 + count
    assert max(made.residuals().values()) < EXACT
    assert [d.tolist() for d in made.deltas[2:]] == [[s] for s in sigmas]
    for k, (sigma, psi) in enumerate(zip(sigmas, psis, strict=True)):
        at = tuple(int(k == i) for i in range(count))
        one = made.points[(slice(None), slice(None), *at)]
        assert np.array_equal(one, baecklund(net, sigma, psi).points)
    # The whole net from its axes, by consistency in d directions.
    assert np.allclose(made.cauchy().build().points, made.points, atol=1e-10)


def test_the_order_of_three_transforms_does_not_matter() -> None:
    net = any_knet(3, 4)
    sigmas, psis = np.array([0.8, 1.3, 2.2]), np.array([0.5, -0.4, 2.0])
    made = baecklund_lattice(net, sigmas, psis).points
    for order in permutations(range(3)):
        other = baecklund_lattice(net, sigmas[list(order)], psis[list(order)]).points
        back = np.argsort(order)
        assert np.allclose(other.transpose(0, 1, *(2 + back), 5), made, atol=1e-12)


def test_two_dini_surfaces_have_a_common_transform() -> None:
    """Dini nets of one line by closed form: the two-soliton net is a K-net (3.9, 3.11)."""
    angles = np.full(12, 0.2)
    sheets = [dini(angles, angles, sigma, t0=t0) for sigma, t0 in ((0.7, 0.5), (1.9, -2.0))]
    line = dini(angles, angles, 1.0)
    with pytest.raises(InputError, match="first transform is none of the net: point"):
        bianchi(line, *sheets)
    both = bianchi(vacuum(angles, angles), *sheets)
    assert max(both.residuals().values()) < EXACT


def test_transforms_of_one_sigma_lead_back_and_are_refused_where_they_meet() -> None:
    """Of equal sigma: a = 0, the common transform is the net. Far from both solitons they meet."""
    net = any_knet(4, 4)
    one, other = baecklund(net, 1.0, 0.3), baecklund(net, 1.0, 1.3)
    assert np.allclose(bianchi(net, one, other).points, net.points, atol=1e-12)
    line = vacuum(np.full(4, 0.3), np.full(40, 0.3))
    with pytest.raises(DegenerateError, match=r"vertex \(0, \d+\): the two transforms coincide"):
        bianchi(line, baecklund(line, 1.0, 0.3), baecklund(line, 1.0, 1.3))


def test_large_net_keeps_its_norms() -> None:
    rng = np.random.default_rng(6)
    deltas = [rng.uniform(0.005, 0.02, 300) for _ in "ab"]
    net = knet(deltas, [0.01 * rng.normal(size=299) for _ in "ab"], 1.2)
    other = baecklund(net, 1.0, 0.7)
    assert np.abs(np.linalg.norm(other.m, axis=-1) - 1).max() < 1e-13
    assert other.residuals()["angle"] < 1e-12


def test_coarse_nets_keep_their_digits_where_the_way_along_the_axes_loses_them() -> None:
    """250 x 250 cells of about 0.3: by way of the axis errors grow by eleven decades."""
    rng = np.random.default_rng(0)
    count = 250
    deltas = [rng.uniform(0.1, 0.5, count) for _ in "ab"]
    net = knet(deltas, [0.3 * rng.normal(size=count - 1) for _ in "ab"], 1.1)
    other = baecklund(net, 1.0, 0.7)
    assert max(other.residuals().values()) < 1e-10
    m = np.empty_like(other.m)
    m[0, 0] = other.m[0, 0]
    for i in range(count):
        m[i + 1, 0] = spherical_fourth(net.m[i, 0], net.m[i + 1, 0], m[i, 0])
    for j in range(count):
        m[:, j + 1] = spherical_fourth(net.m[:, j], net.m[:, j + 1], m[:, j])
    assert np.abs(np.linalg.norm(m, axis=-1) - 1).max() < 1e-13
    assert np.abs(np.sum(m[1:] * m[:-1] - other.m[1:] * other.m[:-1], axis=-1)).max() > 1e-4


def test_a_start_far_from_the_soliton_is_refused() -> None:
    """t0 = 1e-18: the first segment is rounded to the line, and the soliton comes from noise."""
    line = vacuum(np.full(4, 0.3), np.full(60, 0.3))
    assert max(dini(*line.deltas, 0.9, t0=1e-18).residuals().values()) < EXACT
    with pytest.raises(DegenerateError, match=r"vertex \(\d+, \d+\): rounding errors have grown"):
        baecklund(line, 0.9, 2e-18)


def test_bad_input_is_named() -> None:
    net = any_knet(3, 4)
    for sigma in (0.0, np.pi, -0.5, 3.5, np.nan):
        with pytest.raises(InputError, match=r"sigma of transform 0 is .* between 0 and pi"):
            baecklund(net, sigma, 0.1)
    with pytest.raises(InputError, match="psi = inf"):
        baecklund(net, 1.0, np.inf)
    with pytest.raises(InputError, match=r"has length 1.5"):
        baecklund_from(net, 1.5 * net.m[0, 0])
    with pytest.raises(InputError, match="parallel to that of the net"):
        baecklund_from(net, -net.m[0, 0])
    with pytest.raises(DegenerateError, match=r"vertex \(0, 1\): the normal of the transform"):
        baecklund_from(net, net.m[0, 1])
    one = baecklund(net, 1.0, 0.1)
    with pytest.raises(DegenerateError, match=r"vertex \(0, 0\): the two transforms coincide"):
        bianchi(net, one, one)
    with pytest.raises(InputError, match="second transform is KNet"):
        bianchi(net, one, baecklund(any_knet(3, 3), 1.0, 0.1))
    with pytest.raises(InputError, match="sigma of transform 1 is 4"):
        baecklund_lattice(net, (1.0, 4.0), (0.1, 0.2))
    with pytest.raises(InputError, match=r"sigmas of shape \(2,\) and psis of shape \(1,\)"):
        baecklund_lattice(net, (1.0, 2.0), (0.1,))
    with pytest.raises(DegenerateError, match=r"vertex \(0, 0\): the two transforms coincide"):
        baecklund_lattice(net, (1.1, 1.1), (0.3, 0.3))

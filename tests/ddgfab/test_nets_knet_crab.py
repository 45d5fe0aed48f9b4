"""Rotational K-nets: numbers, invariants of the closed net, cone points, string equilibrium."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import unit
from ddgfab.nets.knet import CrabNet, crab_net, knet, pseudosphere, string_forces, string_tensions


def printed() -> CrabNet:
    """N = 6, delta = 30 deg, theta_0 = 60 deg (mathematics.md 3.13)."""
    return crab_net(6, np.radians(30), np.radians(60), 5)


def nets() -> list[CrabNet]:
    return [
        printed(),
        crab_net(12, np.radians(25), np.radians(10), 20, r=300.0),
        crab_net(5, np.radians(60), np.radians(100), 14),
        crab_net(7, np.radians(100), np.radians(60), 9, r=1e-3),
    ]


def cone() -> CrabNet:
    """A net through its cone point: radii change their sign after three rings."""
    return crab_net(5, np.radians(35), np.radians(50), 9)


def test_number_check() -> None:
    net = printed()
    assert np.degrees(net.thetas[1:]) == pytest.approx(
        [72.412046, 79.792181, 84.096104, 86.589372], abs=5e-7
    )
    assert net.radii[:4] == pytest.approx([0.5, 0.302169, 0.177219, 0.102860], abs=5e-7)
    assert net.heights[:4] == pytest.approx([0, 0.412771, 0.881854, 1.371330], abs=5e-7)
    assert net.edge_length == pytest.approx(0.5, rel=1e-15)


@pytest.mark.parametrize("net", nets(), ids=str)
def test_all_edges_are_equal_and_twist_as_they_should(net: CrabNet) -> None:
    x, n = net.points.reshape(-1, 3), net.normals.reshape(-1, 3)
    assert np.allclose(np.linalg.norm(n, axis=1), 1, atol=1e-15)
    for hand, ids in zip((1, -1), net.edges(), strict=True):
        a, b = ids.reshape(-1, 2).T
        e = x[b] - x[a]
        assert np.allclose(np.linalg.norm(e, axis=1), net.edge_length, rtol=1e-12)
        for normal in (n[a], n[b]):
            assert np.abs(np.sum(e * normal, axis=1)).max() < 1e-12 * net.r
        twist = np.arctan2(np.sum(np.cross(n[a], n[b]) * unit(e), axis=1), np.sum(n[a] * n[b], 1))
        assert np.allclose(twist, hand * net.delta, atol=1e-11)
    invariant = np.cos(net.thetas[:-1]) * np.cos(net.thetas[1:]) + np.cos(np.pi / net.n_fold) * (
        np.sin(net.thetas[:-1]) * np.sin(net.thetas[1:])
    )
    assert np.allclose(invariant, np.cos(net.delta), atol=1e-13)


@pytest.mark.parametrize("net", nets(), ids=str)
def test_patches_are_k_nets_and_evolve_from_their_axes(net: CrabNet) -> None:
    half = (net.rings - 1) // 2
    patch = net.patch((half, half), place=2)
    assert max(patch.residuals().values()) < 1e-11
    data = patch.cauchy()
    again = knet(
        data.deltas, data.turns, data.corner_angles, r=data.r,
        origin=data.origin, normal=data.normal, edge=data.edge,
    )  # fmt: skip
    assert np.allclose(again.points, patch.points, atol=1e-10 * net.r)
    assert np.array_equal(patch.points[0, 0], net.points[0, 2])
    assert np.array_equal(patch.points[1, 1], net.points[2, 1])


@pytest.mark.parametrize("net", nets(), ids=str)
def test_mesh_is_a_closed_band_of_quads(net: CrabNet) -> None:
    mesh = net.mesh()
    k, n = net.rings, net.n_fold
    assert mesh.n_faces == (k - 2) * n
    assert len(mesh.vertices) == k * n
    # The basket's bars (mathematics.md 11): 2 N a level.
    assert len(mesh.edges) == 2 * n * (k - 1)
    lengths = np.linalg.norm(mesh.edge_vectors, axis=1)
    assert np.allclose(lengths, net.edge_length, rtol=1e-12)
    assert sum(ids.size for ids in net.edges()) == 2 * len(mesh.edges)


@pytest.mark.parametrize("net", [*nets(), cone()], ids=str)
def test_rotational_nets_hang(net: CrabNet) -> None:
    """Forces vanish on all inner rings, and on the last ones carry the same load down and up."""
    forces = string_forces(net)
    tensions = string_tensions(net)
    assert tensions[0] == 1
    assert np.abs(forces[1:-1]).max() < 1e-12 * np.abs(tensions).max()
    load = forces[0, :, 2].sum()
    assert load == pytest.approx(2 * net.n_fold * net.heights[1] / net.edge_length)
    assert forces[-1, :, 2].sum() == pytest.approx(-load)
    # Other tensions do not hold it.
    assert np.abs(string_forces(net, np.ones(net.rings - 1))[1:-1]).max() > 1e-3


def test_cone_points_are_reported_and_not_clipped() -> None:
    net = cone()
    signs = np.sign(net.radii)
    assert len(set(signs)) == 2
    first = int(np.flatnonzero(signs != signs[0])[0])
    assert net.cone_rings[0] == first
    assert f"cone points at rings [{first}" in repr(net)
    # Behind it the net goes on: edges and normals as before.
    assert max(net.patch((4, 4)).residuals().values()) < 1e-12
    assert not len(printed().cone_rings)
    around = np.arctan2(net.points[first, 0, 1], net.points[first, 0, 0])
    expected = first * np.pi / net.n_fold + (np.pi if net.radii[first] < 0 else 0)
    assert np.remainder(around - expected, 2 * np.pi) == pytest.approx(0, abs=1e-9)


def test_pseudosphere_is_a_crab_net() -> None:
    """delta = pi / N and cos(theta_p) = sech(p L): radii sech(p L)."""
    count = 8
    step = np.log(np.tan(np.pi / 4 + np.pi / count / 2))
    p = 3.0 + np.arange(6)
    net = crab_net(count, np.pi / count, np.arccos(1 / np.cosh(p[0] * step)), 6)
    assert net.radii == pytest.approx(1 / np.cosh(step * p), rel=1e-12)
    closed = pseudosphere((count, 2 * count), np.pi / count)
    assert closed.points[count, count + 2] == pytest.approx(closed.points[0, 2], abs=1e-14)


def test_symmetric_flex_keeps_edges_and_twists() -> None:
    """delta and N fixed, theta_0 free (mathematics.md 4.5): another shape of the same bars."""
    one, other = (crab_net(9, 0.4, t, 8) for t in (0.7, 0.9))
    assert not np.allclose(one.points, other.points, atol=0.05)
    for net in (one, other):
        for ids in net.edges():
            x = net.points.reshape(-1, 3)[ids.reshape(-1, 2)]
            assert np.allclose(np.linalg.norm(x[:, 1] - x[:, 0], axis=1), np.sin(0.4))


def test_bad_input_is_named() -> None:
    with pytest.raises(InputError, match="n_fold = 2"):
        crab_net(2, 0.5, 1.0, 4)
    with pytest.raises(InputError, match="rings = 1"):
        crab_net(6, 0.5, 1.0, 1)
    with pytest.raises(InputError, match=r"delta 0 is 3.2"):
        crab_net(6, 3.2, 1.0, 4)
    with pytest.raises(InputError, match="theta0 = nan"):
        crab_net(6, 0.5, np.nan, 4)
    with pytest.raises(InputError, match="r = 0"):
        crab_net(6, 0.5, 1.0, 4, r=0)
    # Normals on the equator, 30 deg apart, cannot be 10 deg apart.
    with pytest.raises(DegenerateError, match=r"30 to 150 deg apart; delta = 10 deg is not"):
        crab_net(6, np.radians(10), np.pi / 2, 4)
    with pytest.raises(InputError, match="needs ring 6; there are 5"):
        printed().patch((3, 3))
    with pytest.raises(InputError, match="no quads"):
        crab_net(6, 0.5, 1.0, 2).mesh()
    # N = 4, delta = 150 deg, theta_0 = 135 deg: the points of ring 0 are one.
    tip = crab_net(4, np.radians(150), np.radians(135), 5)
    assert tip.cone_rings[0] == 0
    with pytest.raises(InputError, match="ring 0 has radius"):
        tip.mesh()
    with pytest.raises(DegenerateError, match="rings 0 and 1 are at one height"):
        string_tensions(crab_net(6, np.radians(30), 0.0, 4))
    with pytest.raises(InputError, match=r"tensions of shape \(5,\); \(4,\)"):
        string_forces(printed(), np.ones(5))

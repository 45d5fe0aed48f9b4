"""A-nets: planar stars, tangent normals, Lelieuvre fields both ways."""

from __future__ import annotations

import numpy as np
import pytest
from knet_cases import EXACT, any_knet

from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats
from ddgfab.nets import (
    anet_from_moutard,
    evolve_moutard,
    lelieuvre,
    moutard_coefficients,
    star_flatness,
    tangent_normals,
)


def anet(scale: float = 1.0) -> Floats:
    """A-net that is not a K-net, from a T-net with uneven coefficients."""
    rng = np.random.default_rng(8)
    lines = [
        np.array([0.2, 0.3, 1.0]) + np.cumsum(np.vstack([np.zeros(3), s]), axis=0)
        for s in (0.2 * rng.normal(size=(6, 3)) + [0.5, 0, 0.1] for _ in "ab")
    ]
    lines[1] = lines[0][0] + (lines[1] - lines[1][0])[:, [1, 0, 2]] * [-1, 1, 1]
    return anet_from_moutard(scale * evolve_moutard(*lines, rng.uniform(0.7, 1.2, (6, 6))))


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_a_net_of_a_moutard_field_has_planar_stars(scale: float) -> None:
    x = anet(scale)
    assert star_flatness(x).max() < 1e-13
    # Second route: the determinants of three edges at interior vertices.
    e = [x[2:, 1:-1] - x[1:-1, 1:-1], x[1:-1, 2:] - x[1:-1, 1:-1], x[:-2, 1:-1] - x[1:-1, 1:-1]]
    volume = np.einsum("ijk,ijk->ij", e[0], np.cross(e[1], e[2]))
    assert np.abs(volume).max() < 1e-12 * scale**6
    # Quads are far from planar: it is not a conjugate net.
    corner = np.einsum(
        "ijk,ijk->ij",
        x[1:, 1:] - x[:-1, :-1],
        np.cross(x[1:, :-1] - x[:-1, :-1], x[:-1, 1:] - x[:-1, :-1]),
    )
    assert np.abs(corner).min() > 1e-6 * scale**6


def test_lelieuvre_both_ways_and_its_freedom() -> None:
    x = anet()
    one, other = lelieuvre(x), lelieuvre(x, 1.7)
    assert np.allclose(anet_from_moutard(one, x[0, 0]), x, atol=EXACT)
    assert np.allclose(anet_from_moutard(other, x[0, 0]), x, atol=EXACT)
    assert moutard_coefficients(one)[1].max() < 1e-11
    # All edges, not only those of the axes that it was made along.
    for k in (0, 1):
        y = np.moveaxis(one, k, 0)
        assert np.allclose(np.cross(y[1:], y[:-1]), np.moveaxis(np.diff(x, axis=k), k, 0))
    even = np.indices(x.shape[:-1]).sum(axis=0) % 2 == 0
    ratio = np.einsum("ijk,ijk->ij", one, other) / np.einsum("ijk,ijk->ij", one, one)
    assert np.allclose(ratio, np.where(even, 1.7, 1 / 1.7))


def test_k_nets_are_a_nets_whose_field_has_one_length() -> None:
    for net in (any_knet(7, 9, r=1.0), any_knet(3, 4, 2)):
        assert star_flatness(net.points).max() < EXACT
        field = lelieuvre(net.points)
        assert np.abs(np.linalg.norm(field, axis=-1) - 1).max() < 1e-11
        sign = np.sign(np.sum(field * net.m, axis=-1))
        assert np.all(sign == sign.flat[0])
        assert np.allclose(anet_from_moutard(net.m), net.points, atol=EXACT)


def test_tangent_normals_of_a_sampled_saddle_and_their_side() -> None:
    """z = x y along its straight asymptotic lines is an A-net exactly; n ~ (-y, -x, 1)."""
    u, v = np.meshgrid(np.linspace(-1, 1, 6), np.linspace(-1, 0.5, 5), indexing="ij")
    x = np.stack([u, v, u * v], axis=-1)
    exact = np.stack([-v, -u, np.ones_like(u)], axis=-1)
    exact /= np.linalg.norm(exact, axis=-1, keepdims=True)
    assert star_flatness(x).max() < 1e-15
    assert np.allclose(tangent_normals(x), exact, atol=1e-13)
    assert np.allclose(tangent_normals(x[:, ::-1]), -exact[:, ::-1], atol=1e-13)


def test_closed_directions_count_their_seam() -> None:
    """On a closed torus of noise corners have four edges; where it is cut does not matter."""
    torus = np.random.default_rng(0).normal(size=(4, 5, 3))
    open_, closed = star_flatness(torus), star_flatness(torus, (True, True))
    assert np.allclose(open_[1:-1, 1:-1], closed[1:-1, 1:-1])
    assert open_[0, 0] < 1e-14 < closed[0, 0]
    rolled = star_flatness(np.roll(torus, (1, 2), axis=(0, 1)), (True, True))
    assert np.allclose(rolled, np.roll(closed, (1, 2), axis=(0, 1)))


def test_bad_input_is_named() -> None:
    x = anet()
    bent = x.copy()
    bent[3, 2] += 0.05
    with pytest.raises(InputError, match=r"no A-net: the edges at vertex \(\d, \d\) leave"):
        lelieuvre(bent)
    with pytest.raises(InputError, match=r"scale 0"):
        lelieuvre(x, 0.0)
    double = x.copy()
    double[2, 3] = double[2, 2]
    with pytest.raises(DegenerateError, match=r"direction 1 at vertex \(2, 2\): it has no length"):
        star_flatness(double)
    straight = np.stack(np.broadcast_arrays(np.arange(3.0)[:, None] + np.arange(4.0), 0.0, 0.0), -1)
    with pytest.raises(DegenerateError, match=r"vertex \(0, 0\): all edges are parallel"):
        tangent_normals(straight)
    grid = np.stack(np.meshgrid(np.arange(3.0), np.arange(4.0), [0.0], indexing="ij"), axis=-1)
    with pytest.raises(DegenerateError, match="its normals are parallel"):
        lelieuvre(grid[:, :, 0])
    field = lelieuvre(x)
    field[4, 5] *= 1.2
    with pytest.raises(InputError, match=r"no T-net: quad \(\d, \d\) of directions \(0, 1\)"):
        anet_from_moutard(field)
    with pytest.raises(InputError, match="flags"):
        star_flatness(x, (True,))

"""K-nets from Cauchy data: the invariants of mathematics.md 3.5, in two and more directions."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from knet_cases import EXACT, any_knet, by_projection, cauchy

from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats, unit
from ddgfab.nets.knet import KNet, knet, oriented_angle, skew_parallelogram

CASES = [(20, 20), (1, 1), (1, 6), (5, 1), (4, 3, 5), (2, 3, 2, 2)]


def layer(net: KNet, k: int, m: int) -> tuple[Floats, Floats]:
    """Points and normals of one 2-layer of a net, in the middle of the other directions."""
    at = tuple(slice(None) if a in (k, m) else n // 2 for a, n in enumerate(net.shape))
    return net.points[at], net.normals[at]


@pytest.mark.parametrize("cells", CASES)
@pytest.mark.parametrize("r", [1e-3, 1.0, 2500.0])
def test_every_defining_condition_holds(cells: tuple[int, ...], r: float) -> None:
    net = any_knet(*cells, r=r)
    assert net.shape == tuple(n + 1 for n in cells)
    assert set(net.residuals()) == {
        "unit", "lelieuvre", "moutard", "length", "angle", "tangent", "twist"
    }  # fmt: skip
    assert max(net.residuals().values()) < EXACT


def test_residuals_see_a_moved_point_a_turned_normal_and_a_wrong_angle() -> None:
    net = any_knet(4, 5)
    points, m = net.points.copy(), net.m.copy()
    points[2, 2] += 1e-3 * net.normals[2, 2]
    m[3, 1] = unit(m[3, 1] + [1e-3, 0, 0])
    wrong = (net.deltas[0] + 1e-3, net.deltas[1])
    moved = KNet(points, net.m, 1.0, net.deltas).residuals()
    assert moved["tangent"] > 1e-3
    assert moved["lelieuvre"] > 1e-3
    assert moved["unit"] < EXACT
    turned = KNet(net.points, m, 1.0, net.deltas).residuals()
    assert turned["moutard"] > 1e-4
    assert turned["angle"] > 1e-5
    angles = KNet(net.points, net.m, 1.0, wrong).residuals()
    assert angles["twist"] > 9e-4
    assert angles["length"] > 1e-3
    assert KNet(net.points, 1.001 * net.m, 1.0, net.deltas).residuals()["unit"] > 9e-4


@pytest.mark.parametrize("cells", [(6, 7), (3, 4, 2)])
def test_invariants_by_a_second_route_from_the_points_alone(cells: tuple[int, ...]) -> None:
    """Chebyshev sides, normals by crossing two edges, twist and lengths of r sin(delta)."""
    net = any_knet(*cells, r=3.0)
    x, n = net.points, by_projection(net.points, net.d)
    assert np.abs(np.abs(np.sum(n * net.normals, axis=-1)) - 1).max() < EXACT
    for k, delta in enumerate(net.deltas):
        edges = np.moveaxis(np.diff(x, axis=k), k, 0).reshape(cells[k], -1, 3)
        lengths = np.linalg.norm(edges, axis=-1)
        assert np.allclose(lengths, 3.0 * np.sin(delta)[:, None], rtol=EXACT)
        nu = np.moveaxis(n, k, 0)
        sines = np.linalg.norm(np.cross(nu[1:], nu[:-1]), axis=-1).reshape(cells[k], -1)
        assert np.allclose(sines, np.sin(delta)[:, None], rtol=1e-11)


def test_twists_have_opposite_hands() -> None:
    """+delta about edges of direction 0, -delta in all others."""
    net = any_knet(5, 4, 3)
    n = net.normals
    for k, delta in enumerate(net.deltas):
        a, b = (np.moveaxis(n, k, 0)[part] for part in (slice(None, -1), slice(1, None)))
        e = unit(np.moveaxis(np.diff(net.points, axis=k), k, 0))
        twist = np.arctan2(np.sum(np.cross(a, b) * e, axis=-1), np.sum(a * b, axis=-1))
        sign = 1 if k == 0 else -1
        assert np.allclose(twist, sign * delta.reshape(-1, 1, 1), atol=EXACT)


def test_quads_of_two_directions_are_skew_parallelograms_of_one_scale() -> None:
    net = any_knet(3, 4, 2, r=2.0)
    for k, m in combinations(range(3), 2):
        x, n = layer(net, k, m)
        for i, j in np.ndindex(x.shape[0] - 1, x.shape[1] - 1):
            quad = skew_parallelogram(x[i, j], x[i + 1, j], x[i, j + 1], x[i + 1, j + 1])
            assert np.allclose(quad.half_turn(quad.corners), quad.corners[[2, 3, 0, 1]], atol=EXACT)
            assert quad.scale() == pytest.approx(2.0, rel=1e-10)
            # The half-turn takes the line of n to that of n_12.
            moved = quad.half_turn(x[i, j] + n[i, j]) - x[i + 1, j + 1]
            assert np.linalg.norm(np.cross(moved, n[i + 1, j + 1])) < 1e-11


def test_number_check_of_a_quad() -> None:
    """mathematics.md 3.4: n = e_z, n1 = (sqrt .19, 0, .9), n2 = (0, -.6, .8), angle 90 deg."""
    net = knet([[np.arccos(0.9)], [np.arccos(0.8)]], [[], []], np.pi / 2, edge=(0, 1, 0))
    x, n = net.points, net.normals
    # Edge 0 along e_y and the corner angle 90 deg: edge 1 along -e_x.
    assert n[1, 0] == pytest.approx([np.sqrt(0.19), 0, 0.9], abs=1e-15)
    assert n[0, 1] == pytest.approx([0, -0.6, 0.8], abs=1e-15)
    assert n[1, 1] == pytest.approx([0.43082141, -0.59302326, 0.68023256], abs=1e-8)
    assert x[1, 0] == pytest.approx([0, 0.43588989, 0], abs=1e-8)
    assert x[0, 1] == pytest.approx([-0.6, 0, 0], abs=1e-15)
    assert x[1, 1] == pytest.approx([-0.53372093, 0.34465713, 0.25849284], abs=1e-8)


@pytest.mark.parametrize("cells", CASES)
def test_cauchy_data_are_those_of_the_net_and_build_it_again(cells: tuple[int, ...]) -> None:
    """Also where the net stands: origin, normal and first edge."""
    deltas, turns, corners = cauchy(*cells)
    rng = np.random.default_rng(1)
    origin, normal, edge = rng.normal(size=(3, 3))
    net = knet(deltas, turns, corners, r=1.7, origin=origin, normal=normal, edge=edge)
    data = net.cauchy()
    for k in range(len(cells)):
        assert np.allclose(data.deltas[k], deltas[k])
        assert np.allclose(data.turns[k], turns[k], atol=1e-11)
    assert np.allclose(data.corner_angles, corners, atol=EXACT)
    first = (0,) * len(cells)
    assert np.array_equal(net.points[first], origin)
    assert np.allclose(net.normals[first], unit(normal))
    assert np.allclose(data.build().points, net.points, atol=1e-11)
    assert np.allclose(net.to_net().points, net.points)


def test_turns_are_deviation_angles_of_edges() -> None:
    deltas, turns, corners = cauchy(6, 5, 4)
    net = knet(deltas, turns, corners)
    for k in range(3):
        line = tuple(slice(None) if a == k else 0 for a in range(3))
        e = np.diff(net.points[line], axis=0)
        n = net.normals[line][1:-1]
        assert np.allclose(oriented_angle(n, e[:-1], e[1:]), turns[k], atol=EXACT)
        # All edges at a vertex lie in its tangent plane, so that the turn is the whole angle.
        unsigned = np.arccos(np.sum(unit(e[:-1]) * unit(e[1:]), axis=-1))
        assert np.allclose(unsigned, np.abs(turns[k]), atol=1e-9)


def test_three_directions_do_not_depend_on_their_order() -> None:
    """3D consistency: the box made in another order of its directions is the same."""
    deltas, turns, corners = cauchy(3, 4, 2)
    net = knet(deltas, turns, corners)
    swapped = knet([deltas[0], deltas[2], deltas[1]], [turns[0], turns[2], turns[1]], corners[::-1])
    assert np.allclose(swapped.points.transpose(0, 2, 1, 3), net.points, atol=EXACT)
    assert np.allclose(swapped.normals.transpose(0, 2, 1, 3), net.normals, atol=EXACT)


def test_directions_zero_and_one_exchanged_change_the_gauge_only() -> None:
    """The net with its directions exchanged has the same m; n' = (-1)^u_1 m, so that all normal
    angles are replaced by pi - delta and turns alternate their sign with the normal."""
    deltas, turns, corner = cauchy(5, 6)
    net = knet(deltas, turns, corner)
    signs = [(-1.0) ** np.arange(1, len(d)) for d in deltas]
    swapped = knet(
        [np.pi - deltas[1], np.pi - deltas[0]],
        [signs[1] * turns[1], signs[0] * turns[0]],
        -corner,
        edge=net.points[0, 1],
    )
    assert np.allclose(swapped.points.transpose(1, 0, 2), net.points, atol=EXACT)
    assert np.allclose(swapped.m.transpose(1, 0, 2), net.m, atol=EXACT)


def test_norms_do_not_drift_where_the_lambda_form_explodes() -> None:
    """300 x 300 cells; the textbook form -n + lambda s loses all digits within 25 steps."""
    deltas, turns, corner = cauchy(300, 300, seed=4, largest=0.3)
    net = knet(deltas, turns, corner)
    assert np.abs(np.linalg.norm(net.m, axis=-1) - 1).max() < 1e-13
    assert net.residuals()["angle"] < 1e-12
    n = net.normals.copy()
    with np.errstate(all="ignore"):
        for i in range(60):
            for j in range(60):
                a, b, c = n[i, j], n[i + 1, j], n[i, j + 1]
                n[i + 1, j + 1] = -a + a @ (b + c) / (1 + b @ c) * (b + c)
    drift = np.abs(np.linalg.norm(n[:60, :60], axis=-1) - 1)
    assert not drift.max() < 1.0


def test_bad_input_names_direction_index_and_value() -> None:
    deltas, turns, corners = cauchy(4, 5)

    def with_delta(value: float) -> list[Floats]:
        out = [d.copy() for d in deltas]
        out[1][3] = value
        return out

    for value, text in ((0.0, "0"), (np.pi, "3.14159"), (-0.2, "-0.2"), (7.0, "7")):
        with pytest.raises(InputError, match=f"delta 3 of direction 1 is {text}.*no length"):
            knet(with_delta(value), turns, corners)
    with pytest.raises(InputError, match=r"deltas of direction 1: entry \(3,\) is nan"):
        knet(with_delta(np.nan), turns, corners)
    with pytest.raises(InputError, match=r"direction 0: deltas of shape \(4,\) and turns.*\(4,\)"):
        knet(deltas, [np.zeros(4), turns[1]], corners)
    with pytest.raises(InputError, match="deltas of 2 directions and turns of 1"):
        knet(deltas, turns[:1], corners)
    with pytest.raises(InputError, match="deltas of 1 directions"):
        knet(deltas[:1], turns[:1], [])
    with pytest.raises(InputError, match="2 directions need 1 corner angles"):
        knet(deltas, turns, [1.0, 2.0])
    with pytest.raises(InputError, match="corner angles: entry"):
        knet(deltas, turns, np.inf)
    with pytest.raises(InputError, match="r = -1"):
        knet(deltas, turns, corners, r=-1.0)
    with pytest.raises(InputError, match="normal has no length"):
        knet(deltas, turns, corners, normal=(0, 0, 0))
    with pytest.raises(DegenerateError, match="parallel to the normal"):
        knet(deltas, turns, corners, edge=(0, 0, 2))
    # n_1 = -n_2: delta_1 + delta_2 = pi on one great circle. Edges of both directions leave
    # opposite, so the normals' tangents agree, at the corner angle pi; at 0 they are opposite.
    with pytest.raises(DegenerateError, match=r"cell \(0, 0\).*n_1 = -n_2") as caught:
        knet([[2.0], [np.pi - 2.0]], [[], []], 0.0)
    assert caught.value.cell == (0, 0)
    net = any_knet(2, 2)
    with pytest.raises(InputError, match="no Cauchy data"):
        KNet(net.points[:1], net.m[:1], 1.0, (np.empty(0), net.deltas[1])).cauchy()

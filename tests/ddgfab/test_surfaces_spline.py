"""Spline surfaces: closed forms, bad input."""

from __future__ import annotations

import numpy as np
import pytest
from surface_cases import (
    BEZIER,
    ellipsoid_cap,
    ellipsoid_parameters,
    graph,
    quarter_cylinder,
    quarter_torus,
)

from ddgfab.errors import DegenerateError, InputError
from ddgfab.surfaces.principal import lifted, principal
from ddgfab.surfaces.sampled import interpolated
from ddgfab.surfaces.spline import SplineSurface

RNG = np.random.default_rng(14)
UV = RNG.uniform(0.02, 0.98, (40, 2))


def test_quarter_cylinder_is_exact() -> None:
    jets = quarter_cylinder().jets(UV)
    found = principal(jets)
    assert np.abs(np.hypot(jets.x[:, 0], jets.x[:, 1]) - 2).max() < 1e-13
    sizes = np.sort(np.abs([found.larger, found.smaller]), axis=0)
    assert np.abs(sizes - [[0.0], [0.5]]).max() < 1e-13


def test_quarter_torus_is_exact() -> None:
    jets = quarter_torus().jets(UV)
    found = principal(jets)
    x, y, z = jets.x.T
    assert np.abs((np.hypot(x, y) - 3) ** 2 + z**2 - 1).max() < 1e-13
    cos = np.hypot(x, y) - 3
    sizes = np.sort(np.abs([found.larger, found.smaller]), axis=0)
    assert np.abs(sizes[1] - 1).max() < 1e-12
    assert np.abs(sizes[0] - cos / (3 + cos)).max() < 1e-12


def test_derivatives_agree_with_differences() -> None:
    surface, h = quarter_torus(), 1e-5
    jets = surface.jets(UV)
    du, dv = np.array([h, 0]), np.array([0, h])
    ahead, back = surface.jets(UV + du), surface.jets(UV - du)
    left, right = surface.jets(UV + dv), surface.jets(UV - dv)
    assert np.abs((ahead.x - back.x) / (2 * h) - jets.u).max() < 1e-8
    assert np.abs((ahead.u - back.u) / (2 * h) - jets.uu).max() < 1e-8
    assert np.abs((left.u - right.u) / (2 * h) - jets.uv).max() < 1e-8
    assert np.abs((left.v - right.v) / (2 * h) - jets.vv).max() < 1e-8


def test_directions_are_orthogonal_unit_and_eigenvectors() -> None:
    surface = graph(lambda x, y: 0.3 * np.sin(1.3 * x + 0.2) + 0.2 * x * y - 0.25 * y**2)
    uv = RNG.uniform(-0.9, 0.9, (40, 2))
    jets = surface.jets(uv)
    found = principal(jets)
    one, two = lifted(jets, found.first), lifted(jets, found.second)
    assert np.abs(np.linalg.norm(one, axis=1) - 1).max() < 1e-12
    assert np.abs(np.einsum("nx,nx->n", one, two)).max() < 1e-12
    step = 1e-5  # n' = -curvature times the direction: the second route
    for directions, tangent, bend in (
        (found.first, one, found.larger),
        (found.second, two, found.smaller),
    ):
        ahead = principal(surface.jets(uv + step * directions)).normal
        back = principal(surface.jets(uv - step * directions)).normal
        turned = (ahead - back) / (2 * step)
        assert np.abs(turned + bend[:, None] * tangent).max() < 1e-7


def test_reversed_normal_swaps_the_families() -> None:
    surface = graph(lambda x, y: 0.3 * x**2 + 0.1 * y**2 + 0.05 * x * y)
    other = graph(lambda x, y: -(0.3 * x**2 + 0.1 * y**2 + 0.05 * x * y))
    uv = RNG.uniform(-0.9, 0.9, (20, 2))
    one, two = principal(surface.jets(uv)), principal(other.jets(uv))
    assert np.allclose(one.larger, -two.smaller, atol=1e-12)
    turn = one.first[:, 0] * two.second[:, 1] - one.first[:, 1] * two.second[:, 0]
    assert np.abs(turn).max() < 1e-10


def test_ellipsoid_curvatures_and_order_of_interpolation() -> None:
    point = ellipsoid_parameters(2.09463601335, 0.894427191)[None]
    found = principal(ellipsoid_cap((80, 80)).jets(point))
    sizes = np.sort(np.abs([found.larger[0], found.smaller[0]]))
    assert np.abs(sizes - [0.258198890, 0.619677337]).max() < 2e-7
    errors = []
    for samples in ((40, 44), (80, 88)):
        surface = ellipsoid_cap(samples)
        x, y, z = surface.points(RNG.uniform(-1, 1, (400, 2)) * [1.0, 0.85]).T
        errors.append(np.abs(x**2 / 9 + y**2 / 4 + z**2 - 1).max())
    assert errors[1] < 1e-7
    assert errors[0] / errors[1] > 30  # order 5 or more


def test_unequal_samples_do_not_transpose() -> None:
    surface = interpolated(
        lambda u, v: np.stack([u, v, u**2], axis=-1), (0.0, 2.0, 0.0, 1.0), (9, 13)
    )
    jets = surface.jets(np.array([[1.3, 0.4]]))
    assert np.allclose(jets.x, [[1.3, 0.4, 1.69]])
    found = principal(jets)
    straight = found.first if abs(found.larger[0]) < abs(found.smaller[0]) else found.second
    assert np.abs(straight[0, 0]) < 1e-10  # the ruling runs along v


def plain(**change: object) -> SplineSurface:
    flat = np.stack(np.meshgrid([0, 0.5, 1], [0, 0.5, 1], indexing="ij"), axis=-1)
    control = np.concatenate([flat, np.zeros((3, 3, 1))], axis=2)
    given = {"control": control, "knots": (BEZIER, BEZIER), "degrees": (2, 2)} | change
    return SplineSurface(**given)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"weights": np.full((3, 3), 1.0) - np.diag([0, 1.0, 0])}, r"weight 0 .*\(1, 1\)"),
        ({"weights": np.ones((3, 2))}, "weights have shape"),
        ({"knots": (BEZIER[1:], BEZIER)}, "5 knots along u"),
        ({"knots": (BEZIER, (0, 0, 0, 1, 1, 0.5))}, "along v are not in ascending order"),
        ({"knots": (BEZIER, (0, 0.1, 0.2, 1, 1, 1))}, "not clamped"),
        ({"degrees": (1, 2), "knots": ((0, 0, 0.5, 1, 1), BEZIER)}, "degree 1 along u"),
        ({"trim": [[(0, 0), (2, 0), (0, 1)]]}, "leaves the surface at u = 2"),
        ({"trim": [[(0, 0), (1, 1), (1, 0), (0, 1)]]}, r"cross at u = 0\.5, v = 0\.5"),
        ({"trim": [[(0, 0), (1, 1)]]}, "2 corners"),
        (
            {"trim": [[(0, 0), (0.4, 0), (0, 0.4)], [(0.6, 0.6), (0.9, 0.6), (0.6, 0.9)]]},
            "trim 1 is not a hole: it lies outside of trim 0",
        ),
    ],
)
def test_bad_input_is_named(change: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        plain(**change)


def test_collapsed_side_names_its_parameter() -> None:
    control = quarter_torus().control.copy()
    control[0] = control[0, :1]
    with pytest.raises(DegenerateError, match=r"no normal at u = 0, v = 0"):
        SplineSurface(control, (BEZIER, BEZIER), (2, 2))


def test_loops_are_oriented_and_holes_count() -> None:
    outer = [(0, 0), (0, 1), (1, 1), (1, 0)]
    hole = [(0.4, 0.4), (0.6, 0.4), (0.6, 0.6), (0.4, 0.6)]
    trim = plain(trim=[outer, hole]).trim
    assert trim.area == pytest.approx(1 - 0.04, abs=1e-15)
    assert trim.inside(np.array([[0.5, 0.5], [0.2, 0.5], [1.2, 0.5]])).tolist() == [
        False,
        True,
        False,
    ]
    part, side = trim.crossing(np.array([[0.2, 0.5]]), np.array([[0.9, 0.5]]))
    assert part[0] == pytest.approx(0.2 / 0.7)
    assert 4 <= side[0] < 8

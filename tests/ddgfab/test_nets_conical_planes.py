"""Conical nets of planes in two, three and four directions (mathematics.md 2.11)."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from net_cases import circular_net, planar_net
from similarity_cases import SIMILARITIES, Similarity

from ddgfab.errors import ArgumentError, DegenerateError, InputError
from ddgfab.mesh import Floats, unit
from ddgfab.nets import (
    circular_residuals,
    circular_to_conical,
    circularity,
    cone_offsets,
    conical_determinant,
    conical_plane,
    conical_to_circular,
    contact_planes,
    contact_points,
    coordinate_surfaces,
    evolve_circular_by_angles,
    evolve_conical,
    evolve_conical_by_angles,
    miquel_point,
    net_planes,
    planarity,
    plane_meets,
    plane_residuals,
)


def planes_net(sizes: tuple[int, ...], seed: int = 0) -> Floats:
    """A conical net from bent sequences of planes and angles near those of right ones."""
    rng = np.random.default_rng(seed)
    lines = []
    for k, n in enumerate(sizes):
        turn = 1.05 * k + 0.2
        way = 0.06 * np.arange(n)[:, None] * [[np.cos(turn), np.sin(turn), 0.0]]
        way = way + 0.004 * rng.normal(size=way.shape) * (np.arange(n) > 0)[:, None]
        normals = unit(np.array([0.1, -0.2, 1.0]) + way)
        distance = np.cumsum(0.3 + 0.02 * rng.normal(size=n)) * (np.arange(n) > 0)
        lines.append(np.concatenate([normals, distance[:, None]], axis=1))
    angles = {}
    for k, m in combinations(range(len(sizes)), 2):
        a, b = (unit(lines[i][1, :3] - lines[i][0, :3]) for i in (k, m))
        off = 0.02 * rng.normal(size=(sizes[k] - 1, sizes[m] - 1))
        angles[k, m] = np.pi - np.arccos(a @ b) + off
    return evolve_conical_by_angles(lines, angles, verify=True)


def cube_of(planes: Floats, at: tuple[int, int, int] = (0, 0, 0)) -> dict[tuple[int, ...], Floats]:
    return {s: planes[tuple(np.add(at, s))] for s in np.ndindex(2, 2, 2)}


def meet(*planes: Floats) -> Floats:
    rows = np.stack(planes)
    return np.asarray(np.linalg.solve(rows[:, :3], rows[:, 3]))


SEVEN = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (1, 0, 1), (0, 1, 1)]


def test_the_eighth_plane_by_four_routes() -> None:
    net = planes_net((5, 4, 4))
    for at in ((0, 0, 0), (3, 0, 1), (1, 2, 2), (3, 2, 2)):
        p = cube_of(net, at)
        eighth = conical_plane(*(p[s] for s in SEVEN))
        assert np.abs(eighth - p[1, 1, 1]).max() < 1e-10
        # The plane through the apices of the cones of three quads, one at each of P1, P2, P3.
        apices = [
            meet(p[1, 0, 0], p[1, 1, 0], p[1, 0, 1]),
            meet(p[0, 1, 0], p[1, 1, 0], p[0, 1, 1]),
            meet(p[0, 0, 1], p[1, 0, 1], p[0, 1, 1]),
        ]
        normal = unit(np.cross(apices[1] - apices[0], apices[2] - apices[0]))
        normal *= np.sign(normal @ eighth[:3])
        assert np.abs(normal - eighth[:3]).max() < 1e-8
        assert abs(normal @ apices[0] - eighth[3]) < 1e-8
        # Miquel's point of the Gauss image.
        image = miquel_point(*(p[s][:3] for s in SEVEN))
        assert np.abs(image - eighth[:3]).max() < 1e-9
        # The oriented sphere that four planes touch: <n, c> + r = d.
        four = np.stack([p[s] for s in SEVEN[:4]])
        rows = np.column_stack([four[:, :3], np.ones(4)])
        center_radius = np.linalg.solve(rows, four[:, 3])
        touch = eighth[:3] @ center_radius[:3] + center_radius[3] - eighth[3]
        assert abs(touch) < 1e-9 * max(1.0, float(np.abs(center_radius).max()))


def test_layers_are_conical_nets_of_points() -> None:
    assert max(plane_residuals(planes_net((4, 3, 3, 3))).values()) < 1e-9
    net = planes_net((5, 4, 4))
    assert max(plane_residuals(net).values()) < 1e-10
    for pair in combinations(range(3), 2):
        points = plane_meets(net, pair)
        layer = np.moveaxis(points, pair, (0, 1))[:, :, 1]
        planes = np.moveaxis(net, pair, (0, 1))[:, :, 1]
        # Random layers fold over; the planes keep one orientation.
        assert np.abs(planarity(layer)).max() < 1e-9
        assert np.abs(conical_determinant(layer, planes[1:-1, 1:-1, :3])).max() < 1e-9
        inner = net_planes(layer)
        sign = np.sign(np.sum(inner[..., :3] * planes[1:-1, 1:-1, :3], axis=-1, keepdims=True))
        assert np.abs(sign * inner - planes[1:-1, 1:-1]).max() < 1e-8


def test_order_of_directions_does_not_matter() -> None:
    net = planes_net((4, 3, 3, 3))
    backwards = evolve_conical(
        coordinate_surfaces(net.transpose(3, 2, 1, 0, 4)), verify=True, tolerance=1e-7
    )
    assert np.abs(backwards.transpose(3, 2, 1, 0, 4) - net).max() < 1e-8
    other = evolve_conical(coordinate_surfaces(net), verify=True)
    assert np.abs(other - net).max() < 1e-8


def circular_system() -> Floats:
    """A circular net of three directions, as in the tests of Miquel's theorem."""
    rng = np.random.default_rng(3)
    lines = [
        np.concatenate(
            [np.zeros((1, 3)), np.cumsum(0.3 * e + 0.03 * rng.normal(size=(n - 1, 3)), axis=0)]
        )
        for n, e in zip((5, 4, 4), np.eye(3), strict=True)
    ]
    return evolve_circular_by_angles(lines, dict.fromkeys(((0, 1), (0, 2), (1, 2)), np.pi / 2))


def test_planes_at_circular_systems_are_conical() -> None:
    """Independent data: vertex normals of a circular net of three directions."""
    x = circular_system()
    first = np.array([0.5, 0.6, 0.7])
    planes = contact_planes(x, first)
    assert max(plane_residuals(planes).values()) < 1e-10
    again = evolve_conical(coordinate_surfaces(planes), verify=True)
    assert np.abs(again - planes).max() < 1e-10
    assert np.abs(contact_points(planes, x[0, 0, 0]) - x).max() < 1e-10
    other = contact_points(planes, x[0, 0, 0] + [0.02, -0.03, 0.01])
    assert max(circular_residuals(other).values()) < 1e-9
    assert np.abs(other - x).max() > 1e-3


def test_two_directions_are_the_known_conical_net() -> None:
    x = circular_net()
    k = circular_to_conical(x)
    assert np.abs(plane_meets(contact_planes(x)) - k).max() < 1e-9
    inner = net_planes(k)
    outer = contact_planes(x)[1:-1, 1:-1]
    sign = np.sign(np.sum(inner[..., :3] * outer[..., :3], axis=-1, keepdims=True))
    assert np.abs(sign * inner - outer).max() < 1e-9
    assert np.abs(contact_points(inner, x[1, 1]) - conical_to_circular(k, x[1, 1])).max() < 1e-8


@pytest.mark.parametrize("steps", [[120.0, 300.0], [-200.0, 450.0]])
def test_offsets_at_constant_distance_are_a_direction(steps: list[float]) -> None:
    """Parallel planes: the Gauss image stands still, the layers are the face offsets."""
    k = circular_to_conical(circular_net())
    planes = net_planes(k)
    stack = np.stack([planes + s * np.eye(4)[3] for s in (0.0, *steps)], axis=2)
    net = evolve_conical(coordinate_surfaces(stack), verify=True)
    assert np.abs(net - stack).max() < 1e-8
    for at, step in enumerate(steps, start=1):
        moved = k[1:-1, 1:-1] + step * cone_offsets(k)
        assert np.abs(plane_meets(net)[:, :, at] - moved).max() < 1e-8
    points = contact_points(stack, k[1, 1])
    shifts = np.diff(points, axis=2)
    wanted = np.diff([0.0, *steps])[:, None] * planes[:, :, None, :3]
    assert np.abs(shifts - wanted).max() < 1e-8


@pytest.mark.parametrize("at", SIMILARITIES, ids=lambda at: at.name)
def test_similarities(at: Similarity) -> None:
    def image(planes: Floats) -> Floats:
        normals = at.vectors(planes[..., :3], 0)
        return np.concatenate(
            [normals, (at.scale * planes[..., 3] + normals @ at.shift)[..., None]], axis=-1
        )

    net = planes_net((4, 4, 3))
    moved = image(net)
    limit = 1e4 * at.rounding
    found = evolve_conical(coordinate_surfaces(moved), tolerance=max(1e-8, limit))
    off = np.abs(found - moved)
    assert off[..., :3].max() < max(1e-9, limit)
    reach = at.scale + float(np.linalg.norm(at.shift))
    assert off[..., 3].max() < max(1e-9, limit) * reach
    meets = at(plane_meets(net))
    assert np.abs(plane_meets(moved) - meets).max() < max(1e-9, limit) * at.scale * 10
    plain, other = plane_residuals(net), plane_residuals(moved)
    assert all(abs(plain[key] - other[key]) < max(1e-10, limit) for key in plain)
    turned = contact_points(moved, at(np.array([0.1, 0.2, 0.3])))
    assert np.abs(turned - at(contact_points(net, [0.1, 0.2, 0.3]))).max() < (
        max(1e-9, limit) * at.scale * 10
    )


def test_nets_that_are_not_conical_are_seen_and_refused() -> None:
    bad = net_planes(planar_net())
    assert plane_residuals(bad)["unit"] < 1e-12
    assert plane_residuals(bad)["planarity"] > 1e-4
    net = planes_net((4, 4, 3))
    given = coordinate_surfaces(net)
    moved = given[0, 1].copy()
    moved[2, 2, 3] += 0.01
    with pytest.raises(DegenerateError, match=r"surface \(0, 1\), quad \(1, 1\): it is not planar"):
        evolve_conical({**given, (0, 1): moved})
    longer = given[1, 2] * 2.0
    with pytest.raises(InputError, match=r"surface \(1, 2\): the normal of plane \(0, 0\) has len"):
        evolve_conical({**given, (1, 2): longer})
    with pytest.raises(InputError, match="four numbers"):
        evolve_conical({pair: value[..., :3] for pair, value in given.items()})
    with pytest.raises(InputError, match=r"\(0, 2\), \(1, 2\)\] are needed"):
        evolve_conical({(0, 1): given[0, 1], (1, 2): given[1, 2]})
    p = cube_of(net)
    with pytest.raises(DegenerateError, match=r"quad \(0, 2\) is not planar"):
        conical_plane(*(p[s] + (0.01 if s == (1, 0, 1) else 0.0) * np.eye(4)[3] for s in SEVEN))
    flat = np.broadcast_to([0.0, 0.0, 1.0, 0.0], (3, 3, 4))
    with pytest.raises(DegenerateError, match=r"quad \(0, 0\): an edge has no length"):
        plane_meets(flat)
    with pytest.raises(ArgumentError, match="points is"):
        net_planes("roof.obj")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="three finite numbers"):
        contact_points(net, [1.0, 2.0])


def test_gauss_images_are_circular_nets_on_the_sphere() -> None:
    net = planes_net((5, 4, 3))
    assert np.abs(np.linalg.norm(net[..., :3], axis=-1) - 1).max() < 1e-14
    for pair in combinations(range(3), 2):
        assert circularity(net[..., :3], pair).max() < 1e-10

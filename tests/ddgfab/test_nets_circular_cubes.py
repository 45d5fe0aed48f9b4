"""Circular nets in three and four directions: Miquel's theorem."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats
from ddgfab.nets import circular as ci
from ddgfab.nets import miquel
from ddgfab.nets.axes import vertex_normals
from ddgfab.nets.conjugate import coefficients
from ddgfab.nets.cubes import coordinate_surfaces
from ddgfab.nets.layers import lattice, stack_transforms
from ddgfab.transforms import invert

E = np.eye(3)
ORIGIN = np.zeros(3)


def quads(t: tuple[float, float, float]) -> tuple[Floats, Floats, Floats]:
    return (
        ci.fourth_by_t(ORIGIN, E[0], E[1], t[0]),
        ci.fourth_by_t(ORIGIN, E[0], E[2], t[1]),
        ci.fourth_by_t(ORIGIN, E[1], E[2], t[2]),
    )


def net(sizes: tuple[int, ...], dim: int = 3, seed: int = 0) -> Floats:
    """Circular net from slightly bent axes and angles near the ones of right angles."""
    rng = np.random.default_rng(seed)
    directions = np.eye(max(dim, len(sizes)))[: len(sizes), :dim]
    if len(sizes) > dim:
        directions[dim:] = 0.6
    lines = []
    for n, along in zip(sizes, directions, strict=True):
        steps = 0.3 * along + 0.02 * rng.normal(size=(n - 1, dim))
        lines.append(np.concatenate([np.zeros((1, dim)), np.cumsum(steps, axis=0)]))
    angles = {}
    for k, m in combinations(range(len(sizes)), 2):
        a, b = lines[k][1], lines[m][1]
        corner = np.arccos(a @ b / np.linalg.norm(a) / np.linalg.norm(b))
        angles[k, m] = np.pi - corner + 0.02 * rng.normal(size=(sizes[k] - 1, sizes[m] - 1))
    return miquel.evolve_circular_by_angles(lines, angles, verify=True)


def test_miquel_numbers() -> None:
    x12, x13, x23 = quads((0.3, 0.5, 0.6))
    assert x12 == pytest.approx([1.20689655, 0.51724138, 0], abs=1e-8)
    assert x13 == pytest.approx([1, 0, 1], abs=1e-15)
    assert x23 == pytest.approx([0, 0.76923077, 1.15384615], abs=1e-8)
    last = miquel.miquel_point(ORIGIN, *E, x12, x13, x23)
    assert last == pytest.approx(np.array([17, 5, 16]) / 15, abs=1e-14)
    unit_cube = miquel.miquel_point(ORIGIN, *E, *quads((0.5, 0.5, 0.5)))
    assert unit_cube == pytest.approx([1, 1, 1], abs=1e-15)


def test_the_eighth_point_lies_on_three_circles_and_the_sphere() -> None:
    """Second route: invert at x; circles through x become lines, the sphere a plane."""
    rng = np.random.default_rng(6)
    for _ in range(20):
        x, x1, x2, x3 = rng.normal(size=(4, 3))
        t = rng.uniform(0.2, 0.8, size=3)
        x12, x13 = ci.fourth_by_t(x, x1, x2, t[0]), ci.fourth_by_t(x, x1, x3, t[1])
        x23 = ci.fourth_by_t(x, x2, x3, t[2])
        last = miquel.miquel_point(x, x1, x2, x3, x12, x13, x23)
        scale = np.abs(last - x).max()
        cube = np.array([[[x, x3], [x2, x23]], [[x1, x13], [x12, last]]])
        for pair in combinations(range(3), 2):
            assert ci.circularity(cube, pair).max() < 1e-8 * max(scale, 1)
        images = invert(np.array([x1, x2, x3, x12, x13, x23, last]), x, 1.0)
        normal = np.cross(images[1] - images[0], images[2] - images[0])
        heights = (images - images[0]) @ (normal / np.linalg.norm(normal))
        assert np.abs(heights).max() < 1e-8
        assert miquel.sphere_defect(cube).max() < 1e-7


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_three_directions(scale: float) -> None:
    x = net((7, 6, 5)) * scale
    assert max(ci.circular_residuals(x).values()) < 1e-10
    assert miquel.sphere_defect(x).max() < 1e-9
    again = miquel.evolve_circular(coordinate_surfaces(x))
    assert np.abs(again - x).max() < 1e-11 * scale
    # Moebius images of the surfaces evolve to the image of the net.
    center = scale * np.array([3.0, 2.0, 6.0])
    image = invert(x, center, scale)
    other = miquel.evolve_circular(coordinate_surfaces(image))
    assert np.abs(other - image).max() < 1e-9 * np.abs(image).max()
    assert np.abs(image).max() > 0.1 * scale


@pytest.mark.parametrize("dim", [3, 4])
def test_four_directions(dim: int) -> None:
    x = net((4, 3, 3, 3), dim)
    assert x.shape == (4, 3, 3, 3, dim)
    assert max(ci.circular_residuals(x).values()) < 1e-9
    backwards = miquel.evolve_circular(coordinate_surfaces(x.transpose(3, 2, 1, 0, 4)))
    assert np.abs(backwards.transpose(3, 2, 1, 0, 4) - x).max() < 1e-10


def test_planar_cubes_also_close() -> None:
    """Miquel's theorem proper: eight points in the plane, six circles."""
    rng = np.random.default_rng(1)
    x, x1, x2, x3 = rng.normal(size=(4, 2))
    x12, x13 = ci.fourth_by_t(x, x1, x2, 0.4), ci.fourth_by_t(x, x1, x3, 0.7)
    x23 = ci.fourth_by_t(x, x2, x3, 0.5)
    last = miquel.miquel_point(x, x1, x2, x3, x12, x13, x23)
    cube = np.array([[[x, x3], [x2, x23]], [[x1, x13], [x12, last]]])
    for pair in combinations(range(3), 2):
        assert ci.circularity(cube, pair).max() < 1e-11


def test_ribaucour_transforms_are_layers() -> None:
    x = net((6, 5))
    n = vertex_normals(x, [0.1, 0.2, 1.0])
    pair = stack_transforms([x, x + 0.1 * n])
    assert max(ci.circular_residuals(pair).values()) < 1e-11
    # The second layer follows from its two boundary lines.
    assert np.abs(miquel.evolve_circular(coordinate_surfaces(pair)) - pair).max() < 1e-11


def test_common_transform_of_two_is_a_net_of_four_directions() -> None:
    y = net((5, 4, 2, 2))
    x, a, b = y[:, :, 0, 0], y[:, :, 1, 0], y[:, :, 0, 1]
    z = lattice(x, lambda _: a, lambda _: b, lambda *_: y[:, :, 1, 1])
    assert np.array_equal(z, y)
    assert max(ci.circular_residuals(z).values()) < 1e-10


def test_bad_cubes_and_surfaces_are_named() -> None:
    x12, x13, x23 = quads((0.3, 0.5, 0.6))
    with pytest.raises(DegenerateError, match=r"quad \(0, 2\) is not circular"):
        miquel.miquel_point(ORIGIN, *E, x12, x13 + 0.1 * E[0], x23)
    x = net((4, 4, 3))
    given = coordinate_surfaces(x)
    moved = given[0, 1].copy()
    c = coefficients(moved)
    assert np.abs(c).max() < 0.5
    moved[3, 3] += 0.1 * (moved[3, 3] - moved[2, 3])
    with pytest.raises(DegenerateError, match=r"surface \(0, 1\), quad \(2, 2\): it is not circ"):
        miquel.evolve_circular({**given, (0, 1): moved})
    with pytest.raises(InputError, match=r"\[\(0, 1\), \(0, 2\), \(1, 2\)\] are needed"):
        miquel.evolve_circular_by_angles([x[:, 0, 0], x[0, :, 0], x[0, 0]], {(0, 1): 1.0})
    with pytest.raises(InputError, match="three directions"):
        miquel.sphere_defect(x[0])
    with pytest.raises(DegenerateError, match="in one plane"):
        miquel.sphere_defect(x * [1, 1, 0] + 0.0)

"""Axes of circles, discrete developables, vertex normals."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats, unit
from ddgfab.nets import circular as ci
from ddgfab.nets.axes import (
    axis_coplanarity,
    axis_intersections,
    circle_axes,
    normals_closure,
    vertex_normals,
)
from ddgfab.nets.miquel import evolve_circular_by_angles
from ddgfab.surfaces import ellipsoid_normals, ellipsoid_patch
from ddgfab.transforms import invert


def bent_net() -> Floats:
    """A circular net without symmetries."""
    way = np.linspace(0.0, 1.0, 9)
    first = np.stack([way, 0.1 * way**2, 0.3 * way**2], axis=1)
    second = np.stack([0.2 * way**2, way, -0.4 * way**2], axis=1)[:7]
    angles = np.pi / 2 + 0.02 * np.random.default_rng(2).normal(size=(8, 6))
    return ci.evolve_by_angles(first, second, angles)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_neighbouring_axes_are_coplanar_on_circular_nets_only(scale: float) -> None:
    x = bent_net() * scale
    c, n = circle_axes(x)
    for k, point in enumerate((x[:-1, :-1], x[1:, :-1], x[1:, 1:], x[:-1, 1:])):
        radius = np.linalg.norm(point - c, axis=-1)
        if k == 0:
            first = radius
        assert np.allclose(radius, first, rtol=1e-10)
    for axis in (0, 1):
        assert np.abs(axis_coplanarity(c, n, axis)).max() < 1e-13 * scale
    y = x.copy()
    y[3, 3] += [0.0, 0.0, 0.05 * scale]
    c, n = circle_axes(y)
    assert max(np.abs(axis_coplanarity(c, n, axis)).max() for axis in (0, 1)) > 1e-4 * scale


def test_axes_meet_at_equal_distance_from_the_common_edge() -> None:
    x = bent_net()
    c, n = circle_axes(x)
    points, infinite = axis_intersections(c[:, 2], n[:, 2])
    assert points.shape == (7, 3)
    assert not infinite.any()
    for k, point in enumerate(points):
        # The point has the same distance from the six vertices of both quads: it is the center of
        # their sphere.
        six = x[k : k + 3, 2:4].reshape(-1, 3)
        distances = np.linalg.norm(six - point, axis=1)
        assert np.ptp(distances) < 1e-9 * distances.mean()


def test_axes_of_a_net_on_a_sphere_meet_at_its_center() -> None:
    plane = np.stack(np.meshgrid(np.arange(5.0), np.arange(4.0), [0.0], indexing="ij"), axis=-1)
    center = np.array([1.3, 0.4, 1.0])
    x = invert(plane[:, :, 0], center, 2.0)  # the sphere through the center of inversion
    middle, radius = center - [0, 0, 2.0], 2.0
    assert np.abs(np.linalg.norm(x - middle, axis=-1) - radius).max() < 1e-14
    c, n = circle_axes(x)
    assert np.abs(np.cross(middle - c, n)).max() < 1e-13
    for turned in (False, True):
        axes = (c.swapaxes(0, 1), n.swapaxes(0, 1)) if turned else (c, n)
        points, infinite = axis_intersections(*axes)
        assert points.shape == ((3, 3, 3) if turned else (4, 2, 3))
        assert not infinite.any()
        assert np.abs(points - middle).max() < 1e-12


def test_parallel_axes_meet_at_infinity() -> None:
    x = np.stack(np.meshgrid(np.arange(4.0), np.arange(3.0), [2.0], indexing="ij"), axis=-1)[
        :, :, 0
    ]
    points, infinite = axis_intersections(*(a[:, 0] for a in circle_axes(x)))
    assert infinite.all()
    assert np.array_equal(points, np.tile([0.0, 0, 1], (2, 1)))
    with pytest.raises(DegenerateError, match=r"axis \(1,\): its direction is zero"):
        axis_intersections(np.eye(3), np.diag([1.0, 0.0, 1.0]))
    with pytest.raises(InputError, match="K > 1"):
        axis_intersections(np.zeros((1, 3)), np.ones((1, 3)))


def test_vertex_normals_close_on_circular_nets_of_two_and_three_directions() -> None:
    x = bent_net()
    n = vertex_normals(x, [0.3, 0.2, 2.0])
    assert np.abs(np.linalg.norm(n, axis=-1) - 1).max() < 1e-14
    assert normals_closure(x, n) < 1e-13
    offset = x + 0.07 * n
    assert np.abs(np.linalg.norm(offset - x, axis=-1) - 0.07).max() < 1e-15
    assert ci.circularity(offset).max() < 1e-11
    assert ci.circularity(n).max() < 1e-11  # the Gauss image is inscribed in the sphere
    for axis in (0, 1):
        a, b = np.diff(x, axis=axis), np.diff(offset, axis=axis)
        assert np.abs(np.cross(unit(a), unit(b))).max() < 1e-12
    y = x.copy()
    y[3, 3] += [0.0, 0.0, 0.02]
    assert normals_closure(y, vertex_normals(y, [0.3, 0.2, 2.0])) > 1e-3

    lines = [0.3 * np.outer(np.arange(4.0), e) for e in np.eye(3)]
    angles = dict.fromkeys(((0, 1), (0, 2), (1, 2)), 1.5)
    cube = evolve_circular_by_angles(lines, angles)
    assert normals_closure(cube, vertex_normals(cube, [1.0, 1.0, 1.0])) < 1e-12


def test_vertex_normals_track_the_smooth_ones() -> None:
    errors = []
    for cells in (8, 16, 32):
        u, v = np.linspace(5, 7, cells + 1), np.linspace(2, 3, cells + 1)
        x = ellipsoid_patch(u[:, None], v[None, :])
        true = ellipsoid_normals(x)
        errors.append(np.linalg.norm(vertex_normals(x, true[0, 0]) - true, axis=-1).max())
    assert np.log2(np.array(errors)[:-1] / np.array(errors)[1:]) == pytest.approx([2, 2], abs=0.1)
    assert errors[2] < 1e-4


def test_bad_input_is_named() -> None:
    x = bent_net()
    with pytest.raises(InputError, match="first normal"):
        vertex_normals(x, [0, 0, 0])
    with pytest.raises(InputError, match="R\\^3"):
        vertex_normals(x[..., :2], [0, 0, 1])
    with pytest.raises(InputError, match="normals have shape"):
        normals_closure(x, x[1:])
    x[4, 3] = x[4, 2]
    with pytest.raises(DegenerateError, match=r"direction 1 at \(4, 2\): it has no length"):
        vertex_normals(x, [0, 0, 1])

"""Umbilics with index, curvature lines on the ellipsoid."""

from __future__ import annotations

import numpy as np
import pytest
from surface_cases import ellipsoid_cap, ellipsoid_parameters, exact_ellipsoid, graph

from ddgfab.errors import DegenerateError
from ddgfab.trace import PrincipalField, Tracer
from ddgfab.trace.samples import Samples
from ddgfab.trace.umbilics import check_anisotropy, umbilics


def confocal(x: np.ndarray) -> np.ndarray:
    """(n, 2) confocal coordinates of points of x^2 / 9 + y^2 / 4 + z^2 = 1, by the cubic."""
    x2, y2, z2 = (x**2).T
    # t^2 + p t + q = 0 from sum x_i^2 / (a_i - t) = 1 divided by t
    p = x2 + y2 + z2 - 14
    q = 36 + 9 + 4 - x2 * 5 - y2 * 10 - z2 * 13
    root = np.sqrt(np.maximum(p**2 - 4 * q, 0))
    return np.stack([(-p + root) / 2, (-p - root) / 2], axis=1)


def test_umbilics_of_the_ellipsoid() -> None:
    for surface, limit in ((exact_ellipsoid(), 3e-13), (ellipsoid_cap((120, 110)), 1e-9)):
        found = umbilics(Samples.of(surface))
        assert [umbilic.index for umbilic in found] == [0.5, 0.5]
        at = np.array([umbilic.x for umbilic in found])
        # sqrt(a (a - b) / (a - c)); on samples what is left is that of the interpolated curvature
        assert np.abs(at[:, 0] - np.sqrt(45 / 8) * np.array([-1, 1])).max() < limit
        assert np.abs(at[:, 1]).max() < limit


def test_monkey_saddle_has_a_star_and_a_rotational_apex_index_one() -> None:
    (star,) = umbilics(Samples.of(graph(lambda x, y: x**3 - 3 * x * y**2)))
    assert star.index == -0.5
    assert star.corners == 6
    assert np.abs(star.uv).max() < 1e-9

    def apex(x, y):
        return -0.2 * (x**2 + y**2) - 0.05 * (x**2 + y**2) ** 2

    (top,) = umbilics(Samples.of(graph(apex, (0.8, 0.8), (60, 60))))
    assert top.index == 1
    assert np.abs(top.uv).max() < 1e-3


def test_line_of_umbilics_and_sphere_are_refused() -> None:
    def apex(x, y):  # the ring r = 1.28... is umbilic
        return -0.2 * (x**2 + y**2) - 0.05 * (x**2 + y**2) ** 2

    with pytest.raises(DegenerateError, match="a line of umbilics"):
        umbilics(Samples.of(graph(apex, (1.6, 1.6), (80, 80))))
    sphere = Samples.of(graph(lambda x, y: np.sqrt(9 - x**2 - y**2)))
    with pytest.raises(DegenerateError, match="100 % of it is spherical or plane"):
        check_anisotropy(sphere)


def drift(step: float) -> float:
    """How far a confocal coordinate moves along the curvature lines through (u, v) = (6, 2.5)."""
    field = PrincipalField(ellipsoid_cap((160, 150)))
    seed = ellipsoid_parameters(2.09463601335, 0.894427191)[None]
    worst = 0.0
    for family in (0, 1):
        (line,) = Tracer(field, family, step, 0.95, np.zeros((0, 3))).lines(seed)
        worst = max(worst, float(np.ptp(confocal(line.x), axis=0).min()))
    return worst


def test_lines_are_curvature_lines_to_order_four() -> None:
    one, two, three = drift(0.2), drift(0.1), drift(0.05)
    assert one / two > 10
    assert two / three > 10
    assert three < 1e-7


def test_lines_end_on_the_rim_and_do_not_depend_on_the_seed() -> None:
    surface = graph(lambda x, y: 0.3 * x**2 - 0.2 * y**2 + 0.1 * x * y + 0.05 * x**3)
    tracer = Tracer(PrincipalField(surface), 0, 0.02, 10.0, np.zeros((0, 3)))
    (line,) = tracer.lines(np.array([[0.1, 0.2]]))
    assert line.ends == ("boundary", "boundary")
    for uv in (line.uv[0], line.uv[-1]):
        assert min(np.abs(np.abs(uv) - 1)) < 1e-14
    (other,) = tracer.lines(line.uv[10:11])
    ends = np.array([line.uv[0], line.uv[-1]])
    again = np.array([other.uv[0], other.uv[-1]])
    if np.linalg.norm(ends[0] - again[0]) > 0.1:
        again = again[::-1]
    assert np.abs(ends - again).max() < 1e-6


def test_closed_lines_close() -> None:
    def top(x, y):
        return -0.2 * (x**2 + y**2) - 0.05 * (x**2 + y**2) ** 2

    field = PrincipalField(graph(top, (0.9, 0.9), (70, 60)))
    lines = [
        Tracer(field, family, 0.05, 9.0, np.zeros((1, 3))).lines(np.array([[0.5, 0.1]]))[0]
        for family in (0, 1)
    ]
    (round_,) = [line for line in lines if line.closed]
    (straight,) = [line for line in lines if not line.closed]
    assert np.ptp(np.linalg.norm(round_.uv, axis=1)) < 1e-4
    assert round_.length == pytest.approx(2 * np.pi * np.hypot(0.5, 0.1), rel=1e-3)
    assert set(straight.ends) == {"umbilic", "boundary"}

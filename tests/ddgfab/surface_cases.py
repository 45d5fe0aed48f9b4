"""Surfaces whose curvatures are known in closed form."""

from __future__ import annotations

import numpy as np

from ddgfab.surfaces.sampled import interpolated
from ddgfab.surfaces.spline import SplineSurface

QUARTER = np.array([[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
QUARTER_WEIGHTS = np.array([1.0, np.sqrt(0.5), 1.0])
BEZIER = (0, 0, 0, 1, 1, 1)


def quarter_cylinder(radius: float = 2.0, height: float = 3.0) -> SplineSurface:
    """Rational quadratic along u, a quadratic line along v."""
    control = np.zeros((3, 3, 3))
    control[..., :2] = radius * QUARTER[:, None]
    control[..., 2] = np.array([0, height / 2, height])
    weights = np.repeat(QUARTER_WEIGHTS[:, None], 3, axis=1)
    return SplineSurface(control, (BEZIER, BEZIER), (2, 2), weights)


def quarter_torus(radius: float = 3.0, tube: float = 1.0) -> SplineSurface:
    """Rational biquadratic: u along the turn, v along the tube."""
    control = np.zeros((3, 3, 3))
    far = radius + tube * QUARTER[:, 0]
    control[..., :2] = QUARTER[:, None] * far[None, :, None]
    control[..., 2] = tube * QUARTER[:, 1]
    weights = np.outer(QUARTER_WEIGHTS, QUARTER_WEIGHTS)
    return SplineSurface(control, (BEZIER, BEZIER), (2, 2), weights)


def ellipsoid_cap(samples: tuple[int, int] = (80, 80)) -> SplineSurface:
    """Upper part of x^2 / 9 + y^2 / 4 + z^2 = 1; two umbilics at v = 0."""

    def point(u, v):
        return np.stack([3 * np.sin(u), 2 * np.cos(u) * np.sin(v), np.cos(u) * np.cos(v)], axis=-1)

    return interpolated(point, (-1.08, 1.08, -0.9, 0.9), samples)


def ellipsoid_parameters(x: float, y: float) -> np.ndarray:
    """(2,) parameters of the point of the cap above x, y."""
    u = np.arcsin(x / 3)
    return np.array([u, np.arcsin(y / (2 * np.cos(u)))])


def graph(function, half=(1.0, 1.0), samples=(60, 50), **options):
    """The graph of a function of x and y."""
    return interpolated(
        lambda x, y: np.stack([x, y, function(x, y)], axis=-1),
        (-half[0], half[0], -half[1], half[1]),
        samples,
        **options,
    )


def exact_ellipsoid(half: float = 0.6) -> SplineSurface:
    """Upper part of x^2 / 9 + y^2 / 4 + z^2 = 1 without any error: rational, by stereographic
    projection of a square of the plane."""
    power = {  # coefficients of u^i v^j of the homogeneous coordinates
        0: {(1, 0): 6.0},
        1: {(0, 1): 4.0},
        2: {(0, 0): 1.0, (2, 0): -1.0, (0, 2): -1.0},
        3: {(0, 0): 1.0, (2, 0): 1.0, (0, 2): 1.0},
    }
    # values of 1, u, u^2 at the Bernstein coefficients of degree 2 on -half to half
    bernstein = np.array([[1.0, -half, half**2], [1.0, 0.0, -(half**2)], [1.0, half, half**2]])
    control = np.zeros((3, 3, 4))
    for k, terms in power.items():
        for (i, j), factor in terms.items():
            control[..., k] += factor * np.outer(bernstein[:, i], bernstein[:, j])
    weights = control[..., 3]
    knots = [-half] * 3 + [half] * 3
    return SplineSurface(control[..., :3] / weights[..., None], (knots, knots), (2, 2), weights)

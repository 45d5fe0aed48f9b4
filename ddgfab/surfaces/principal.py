"""Principal directions and curvatures from the derivatives of a surface, without eigensolver.

Source: do Carmo, Differential Geometry of Curves and Surfaces, 3.3.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from ddgfab.mesh import Floats, unit
from ddgfab.surfaces.spline import Jets

DETERMINED: Final = 0.05
"""Anisotropy below which a principal direction is too uncertain to be printed as an angle."""


class Forms(NamedTuple):
    """First and second fundamental forms in a triangular frame, (n,) each, and normals (n, 3).

    I = R^T R with R = [[a, b], [0, c]]; the shape operator in that orthonormal frame is
    [[p, q], [q, r]].
    """

    normal: Floats
    a: Floats
    b: Floats
    c: Floats
    p: Floats
    q: Floats
    r: Floats
    second: tuple[Floats, Floats, Floats]

    def parameter(self, vectors: Floats) -> Floats:
        """(n, 2) directions in the parameter plane of vectors (n, 2) in the orthonormal frame."""
        second = vectors[:, 1] / self.c
        return np.stack([(vectors[:, 0] - self.b * second) / self.a, second], axis=1)

    def frame(self, directions: Floats) -> Floats:
        """(n, 2) coordinates in the orthonormal frame of directions in the parameter plane."""
        first = self.a * directions[:, 0] + self.b * directions[:, 1]
        return np.stack([first, self.c * directions[:, 1]], axis=1)


def forms(jets: Jets) -> Forms:
    """Fundamental forms at the points of `jets`; n = unit(x_u × x_v)."""
    normal = unit(np.cross(jets.u, jets.v))
    a = np.linalg.norm(jets.u, axis=1)
    b = np.einsum("nx,nx->n", jets.u, jets.v) / a
    c = np.linalg.norm(jets.v - (b / a)[:, None] * jets.u, axis=1)
    low, mid, high = (np.einsum("nx,nx->n", part, normal) for part in (jets.uu, jets.uv, jets.vv))
    p = low / a**2
    q = (mid / a - b * low / a**2) / c
    r = (high - 2 * b * mid / a + b**2 * low / a**2) / c**2
    return Forms(normal, a, b, c, p, q, r, (low, mid, high))


class Principal(NamedTuple):
    """Principal curvatures and directions at n points.

    normal : (n, 3); larger, smaller : (n,) curvatures, a sphere with outward normals has -1/R
    first, second : (n, 2) parameter directions of unit length on the surface, of the larger and
        the smaller curvature
    anisotropy : (n,) difference of the curvatures over the sum of their absolute values, 0 to 1
    deviator : (n, 2) half of the difference of the curvatures times (cos, sin) of twice the angle
        of the first direction: smooth through umbilics, where it vanishes
    """

    normal: Floats
    larger: Floats
    smaller: Floats
    first: Floats
    second: Floats
    anisotropy: Floats
    deviator: Floats


def principal(jets: Jets) -> Principal:
    """Principal curvatures and directions at the points of `jets`.

    Families of lines are matched by direction, not by curvature: reversing the normal exchanges
    the larger and the smaller.
    """
    form = forms(jets)
    deviator = np.stack([0.5 * (form.p - form.r), form.q], axis=1)
    half = np.hypot(deviator[:, 0], deviator[:, 1])
    mean = 0.5 * (form.p + form.r)
    larger, smaller = mean + half, mean - half
    angle = 0.5 * np.arctan2(deviator[:, 1], deviator[:, 0])
    cos, sin = np.cos(angle), np.sin(angle)
    total = np.abs(larger) + np.abs(smaller)
    anisotropy = np.divide(2 * half, total, out=np.zeros_like(half), where=total > 0)
    return Principal(
        form.normal,
        larger,
        smaller,
        form.parameter(np.stack([cos, sin], axis=1)),
        form.parameter(np.stack([-sin, cos], axis=1)),
        anisotropy,
        deviator,
    )


def lifted(jets: Jets, directions: Floats) -> Floats:
    """(n, 3) tangent vectors in space of parameter directions (n, 2)."""
    return directions[:, :1] * jets.u + directions[:, 1:] * jets.v

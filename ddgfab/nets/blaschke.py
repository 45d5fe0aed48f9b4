"""The Blaschke cylinder: oriented planes as points of R^4, in a frame that motions take along.

An oriented plane <n, x> = d, |n| = 1, is the point (n, d) of R^4, on the cylinder |n| = 1.
Source: Bobenko, Suris, Discrete Differential Geometry, 3.4; mathematics.md 2.11.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.errors import InputError
from ddgfab.mesh import Floats
from ddgfab.quads import net_points
from ddgfab.tolerances import RELATIVE_DEGENERATE


class Scaling(NamedTuple):
    """Origin and unit of length in which planes are computed."""

    center: Floats
    size: float

    def scaled(self, planes: Floats) -> Floats:
        """The planes (n, d) with d from the center, in this unit."""
        out = planes.copy()
        out[..., 3] = (planes[..., 3] - planes[..., :3] @ self.center) / self.size
        return out

    def back(self, planes: Floats) -> Floats:
        """The planes in the units of the input, their normals made unit."""
        out = planes / np.linalg.norm(planes[..., :3], axis=-1, keepdims=True)
        out[..., 3] = self.size * out[..., 3] + out[..., :3] @ self.center
        return np.asarray(out)


def frame_of(planes: Sequence[Floats]) -> Scaling:
    """The point nearest to all planes and their greatest distance from it."""
    rows = np.concatenate(planes)
    center = np.linalg.lstsq(rows[:, :3], rows[:, 3], rcond=RELATIVE_DEGENERATE)[0]
    away = float(np.abs(rows[:, 3] - rows[:, :3] @ center).max())
    far = float(np.abs(rows[:, 3]).max())
    # Planes through one point have no size of their own.
    return Scaling(np.asarray(center), away if away > RELATIVE_DEGENERATE * far else max(far, 1.0))


def on_cylinder(planes: Floats) -> tuple[Floats, Scaling]:
    """The points (n, d) of planes in their frame, and the frame."""
    frame = frame_of([planes.reshape(-1, 4)])
    return frame.scaled(planes), frame


def unit_planes(planes: ArrayLike, tolerance: float, what: str = "") -> Floats:
    """Float array (n1, ..., nd, 4) with unit normals; raises `InputError` for others."""
    p = net_points(planes)
    if p.shape[-1] != 4:
        raise InputError(f"{what}planes (n, d) have four numbers each; these {p.shape[-1]}")
    length = np.linalg.norm(p[..., :3], axis=-1)
    bad = ~(np.abs(length - 1.0) <= tolerance)
    if bad.any():
        at = tuple(int(i) for i in np.argwhere(bad)[0])
        raise InputError(
            f"{what}the normal of plane {at} has length {length[at]:.9g}; unit normals are needed "
            f"(to {tolerance:g})"
        )
    return p


def with_distance(normals: Floats, points: Floats) -> Floats:
    """(..., 4) planes (n, d) with these unit normals through these points, (..., 3) both."""
    # About the first point, so that the distance keeps its digits far from the origin.
    origin = points.reshape(-1, 3)[0]
    local = np.sum(normals * (points - origin), axis=-1)
    return np.concatenate([normals, (local + normals @ origin)[..., None]], axis=-1)

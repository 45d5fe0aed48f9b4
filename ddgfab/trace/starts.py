"""Points that lines must run through, and points of the rim at which lines must end."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.errors import InputError
from ddgfab.mesh import Floats
from ddgfab.surfaces.nearest import nearest_points
from ddgfab.surfaces.principal import lifted
from ddgfab.surfaces.spline import SplineSurface
from ddgfab.trace.lines import Tracer

_OFF: Final = 0.01
"""Points may be this far from the surface, as a part of its size."""
_INWARD: Final = 0.2
"""A line that ends at a given point of the rim is started this part of a step inside."""


def points_on(
    surface: SplineSurface, given: ArrayLike | None, size: float, what: str = "through"
) -> Floats:
    """(k, 2) parameters of points that lines are to run through.

    Raises
    ------
    InputError
        Points of another shape, off the surface or outside of its trim; names the first.
    """
    if given is None:
        return np.zeros((0, 2))
    points = _checked(given, what)
    found = nearest_points(surface, points)
    limit = _OFF * size
    for k, (far, inside) in enumerate(
        zip(found.distance, surface.trim.inside(found.uv), strict=True)
    ):
        x, y, z = points[k]
        if far > limit:
            raise InputError(
                f"{surface.name}: point {k} of {what} ({x:g}, {y:g}, {z:g}) lies {far:.4g} from "
                f"the surface (limit {limit:.4g}, 1 % of the size)"
            )
        if not inside:
            raise InputError(
                f"{surface.name}: point {k} of {what} ({x:g}, {y:g}, {z:g}) lies outside of the "
                "trimming curves"
            )
    return found.uv


def rim_seeds(tracers: Sequence[Tracer], ends: ArrayLike | None, size: float) -> list[Floats]:
    """Parameters (k, 2), a little inside, of lines of each family that end at points of the rim.

    Of both families the one that meets the rim more steeply ends there.

    Raises
    ------
    InputError
        Points of another shape, or off the surface.
    """
    surface, trim = tracers[0].surface, tracers[0].trim
    if ends is None or not len(np.asarray(ends)):
        return [np.zeros((0, 2))] * len(tracers)
    points = _checked(ends, "ends")
    found = nearest_points(surface, points)
    worst = int(found.distance.argmax())
    if found.distance[worst] > _OFF * size:
        x, y, z = points[worst]
        raise InputError(
            f"{surface.name}: point {worst} of ends ({x:g}, {y:g}, {z:g}) lies "
            f"{found.distance[worst]:.4g} from the surface (limit {_OFF * size:.4g})"
        )
    way = trim.ends - trim.starts
    gap = found.uv[:, None] - trim.starts
    part = np.clip(np.einsum("nsx,sx->ns", gap, way) / np.einsum("sx,sx->s", way, way), 0, 1)
    foot = trim.starts + part[..., None] * way
    side = np.linalg.norm(foot - found.uv[:, None], axis=2).argmin(axis=1)
    row = np.arange(len(points))
    uv = foot[row, side]
    jets = surface.jets(uv)
    along = lifted(jets, way[side])
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    inward = np.stack([-way[side][:, 1], way[side][:, 0]], axis=1)
    seeds, steep = [], []
    for tracer in tracers:
        speed = tracer.field.directions(jets, tracer.family)
        speed = np.where(np.einsum("nx,nx->n", speed, inward)[:, None] < 0, -speed, speed)
        tangent = lifted(jets, speed)
        steep.append(np.abs(np.einsum("nx,nx->n", tangent, along)))
        step = np.full(len(uv), _INWARD * tracer.step)
        seeds.append(tracer.stepped(uv, speed, tangent, step))
    family = np.argmin(steep, axis=0)
    return [seed[(family == k) & trim.inside(seed)] for k, seed in enumerate(seeds)]


def _checked(given: ArrayLike, what: str) -> Floats:
    points = np.asarray(given, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
        raise InputError(f"{what} has shape {points.shape}: finite points (k, 3) are needed")
    return points

"""Drawn curves as one family of lines: the direction between them by radial basis functions.

What is interpolated is t t^T, t the unit tangent: it has no sign and no jump. Source: Alliez,
Cohen-Steiner, Devillers, Lévy, Desbrun 2003 (tensors); Hardy 1971, Multiquadric equations.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import RBFInterpolator

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.mesh import Floats, extent
from ddgfab.surfaces.nearest import Nearest, nearest_points
from ddgfab.surfaces.principal import forms
from ddgfab.surfaces.spline import Jets, SplineSurface

_SAMPLES: Final = 320
"""Points of all curves together, about; tangents are interpolated between them."""
_LEAST: Final = 5
"""Points of one curve, at least."""
_FINE: Final = 1e-9
"""Points of a curve nearer than this part of the surface's size are one."""
_OFF: Final = 0.02
"""Curves may be this far from the surface, as a part of its size."""


@checked
def laid_curves(surface: SplineSurface, curves: Sequence[ArrayLike]) -> list[Floats]:
    """Curves (m, 3) laid on a surface, cut at its rim, with points at equal distances.

    Curves in one level plane (z the same everywhere) are drawings in plan: they are laid on the
    surface along z. All others go to the nearest points.

    Raises
    ------
    InputError
        No curves; one of another shape, of one point, farther from the surface than 2 % of its
        size, or outside of its rim; names the curve.
    """
    given = [np.asarray(curve, dtype=np.float64) for curve in curves]
    if not given:
        raise InputError(f"{surface.name}: no curve is drawn; one or more are needed")
    for k, curve in enumerate(given):
        if curve.ndim != 2 or curve.shape[1] != 3 or not np.isfinite(curve).all():
            raise InputError(f"curve {k} has shape {curve.shape}: finite points (m, 3) are needed")
    size = extent(surface.control.reshape(-1, 3))
    heights = np.concatenate([curve[:, 2] for curve in given])
    target = surface
    if np.ptp(heights) <= _FINE * size:  # a drawing in plan
        flat = surface.control * [1.0, 1.0, 0.0] + [0.0, 0.0, heights[0]]
        target = SplineSurface(
            flat, surface.knots, surface.degrees, surface.weights, name=f"{surface.name} in plan"
        )
    lengths = [float(np.linalg.norm(np.diff(c, axis=0), axis=1).sum()) for c in given]
    step = max(sum(lengths) / _SAMPLES, _FINE * size)
    out = []
    for k, curve in enumerate(given):
        if lengths[k] <= _FINE * size:
            raise InputError(f"curve {k} of {len(given)} has no length")
        dense = _even(curve, max(_LEAST, round(lengths[k] / step) + 1))
        found = nearest_points(target, dense)
        worst = int(found.distance.argmax())
        inside = surface.trim.inside(found.uv) & ~_beyond(surface, found, _FINE * size)
        off = np.where(inside, found.distance, 0.0)
        if off.max() > _OFF * size:
            x, y, z = dense[int(off.argmax())]
            raise InputError(
                f"{surface.name}: curve {k} of {len(given)} lies {off.max():.4g} off the surface "
                f"at ({x:.4g}, {y:.4g}, {z:.4g}) (limit {_OFF * size:.4g}, 2 % of the size)"
            )
        inside &= found.distance <= _OFF * size
        runs = np.split(np.arange(len(dense)), np.flatnonzero(np.diff(inside.astype(int))) + 1)
        longest = max((run for run in runs if inside[run[0]]), key=len, default=np.zeros(0, int))
        if len(longest) < _LEAST:
            x, y, z = dense[worst]
            raise InputError(
                f"{surface.name}: curve {k} of {len(given)} does not lie on the surface: it is "
                f"outside of its rim, at ({x:.4g}, {y:.4g}, {z:.4g}) for instance"
            )
        out.append(surface.points(found.uv[longest]))
    return out


def followed(surface: SplineSurface, curves: Sequence[Floats]) -> Callable[[Jets], Floats]:
    """Directions (n, 2) that follow curves on a surface, for jets of n points.

    Parameters
    ----------
    curves : (m, 3) points on the surface, in order, as `laid_curves` gives them
    """
    centers = np.concatenate([0.5 * (curve[1:] + curve[:-1]) for curve in curves])
    tangents = np.concatenate([np.diff(curve, axis=0) for curve in curves])
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    one, two = (0, 0, 0, 1, 1, 2), (0, 1, 2, 1, 2, 2)
    values = tangents[:, one] * tangents[:, two]
    keep = np.unique(np.round(centers / (_FINE * extent(centers))), axis=0, return_index=True)[1]
    centers, values = centers[np.sort(keep)], values[np.sort(keep)]
    step = float(np.median(np.linalg.norm(np.diff(centers, axis=0), axis=1)))
    origin = centers.mean(axis=0)
    field = RBFInterpolator(
        (centers - origin) / step, values, kernel="multiquadric", epsilon=0.5, degree=0
    )

    def along(jets: Jets) -> Floats:
        form = forms(jets)
        first = jets.u / form.a[:, None]
        second = np.cross(form.normal, first)
        found = field((jets.x - origin) / step)
        whole = np.empty((len(found), 3, 3))
        for k, (i, j) in enumerate(zip(one, two, strict=True)):
            whole[:, i, j] = whole[:, j, i] = found[:, k]
        p, q, r = (
            np.einsum("nx,nxy,ny->n", a, whole, b)
            for a, b in ((first, first), (first, second), (second, second))
        )
        angle = 0.5 * np.arctan2(2 * q, p - r)
        return form.parameter(np.stack([np.cos(angle), np.sin(angle)], axis=1))

    return along


def _beyond(surface: SplineSurface, found: Nearest, limit: float) -> NDArray[np.bool_]:
    """(n,) whose nearest points lie on a side of the rectangle, because they lie beyond it."""
    u0, u1, v0, v1 = surface.domain
    low, high = np.array([u0, v0]), np.array([u1, v1])
    on_side = ((found.uv <= low) | (found.uv >= high)).any(axis=1)
    return np.asarray(on_side & (found.distance > limit))


def _even(points: Floats, count: int) -> Floats:
    """(count, 3) points at equal distances along a polyline."""
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    s = np.concatenate([[0.0], np.cumsum(lengths)])
    at = np.linspace(0.0, s[-1], count)
    return np.stack([np.interp(at, s, points[:, k]) for k in range(3)], axis=1)

"""Analytic surfaces as splines: a function interpolated once, and then forgotten."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import make_interp_spline

from ddgfab.errors import InputError
from ddgfab.mesh import Floats
from ddgfab.surfaces.spline import SplineSurface

_DEGREE: Final = 5
SAMPLES: Final = 80
"""Samples a side by default: the ellipsoid of the tests is met to 1e-10."""


def interpolated(
    function: Callable[[Floats, Floats], ArrayLike],
    domain: tuple[float, float, float, float],
    samples: tuple[int, int] = (SAMPLES, SAMPLES),
    trim: Sequence[ArrayLike] | None = None,
    *,
    name: str = "surface",
) -> SplineSurface:
    """Quintic tensor spline through samples of a surface.

    Parameters
    ----------
    function : of u (m, n) and v (m, n), gives points (m, n, 3)
    domain : least u, greatest u, least v, greatest v
    samples : along u, along v; 6 or more

    Raises
    ------
    InputError
        A domain without area, too few samples, values of another shape or not finite.
    """
    u0, u1, v0, v1 = domain
    if not (np.isfinite(domain).all() and u1 > u0 and v1 > v0):
        raise InputError(f"{name}: domain {u0:g} to {u1:g}, {v0:g} to {v1:g} has no area")
    if min(samples) <= _DEGREE:
        raise InputError(f"{name}: {min(samples)} samples a side; {_DEGREE + 1} are needed")
    u, v = np.linspace(u0, u1, samples[0]), np.linspace(v0, v1, samples[1])
    values = np.asarray(function(*np.meshgrid(u, v, indexing="ij")), dtype=np.float64)
    if values.shape != (*samples, 3):
        raise InputError(f"{name}: values have shape {values.shape}; expected {(*samples, 3)}")
    bad = np.argwhere(~np.isfinite(values).all(axis=2))
    if len(bad):
        i, j = bad[0]
        raise InputError(f"{name}: the value at u = {u[i]:.6g}, v = {v[j]:.6g} is not finite")
    # axes are moved by hand: both interpolations run along the first one
    along = make_interp_spline(u, values, k=_DEGREE)
    across = make_interp_spline(v, np.moveaxis(along.c, 0, 1), k=_DEGREE)
    control = np.moveaxis(across.c, 0, 1)
    return SplineSurface(control, (along.t, across.t), (_DEGREE, _DEGREE), None, trim, name=name)

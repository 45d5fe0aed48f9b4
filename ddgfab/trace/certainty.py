"""How much lines of curvature mean: their turn under an error of the surface, their unrest.

Anisotropy says nothing on saddles, where it is 1 everywhere, also at umbilics. What counts is the
difference of the curvatures against the error of the surface: a movement w = e u v / r^2 on a
square of side 2 r turns principal directions by atan(2 e / (r^2 (k1 - k2))) / 2.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from ddgfab.errors import DegenerateError
from ddgfab.mesh import Floats
from ddgfab.surfaces.principal import Principal, lifted
from ddgfab.trace.samples import SIDE, Samples

ERROR: Final = 1e-3
"""Error of the surface that lines are judged by, as a part of the spacing."""
UNCERTAIN_DEG: Final = 22.5
"""Lines that turn by more [deg] under that error are uncertain; 45 is the most."""
_RESTLESS_DEG: Final = 45.0
"""Directions that turn by more from one cell of a net to the next make no net."""
_SHARE: Final = 0.2
"""Part of a surface on which they may."""


def turn_by_error(found: Principal, spacing: float) -> Floats:
    """(n,) angle [rad] by which lines turn where the surface is out by `ERROR` spacings.

    The error is a twist of the cell of that size; 45 deg at umbilics.
    """
    twist = 4 * ERROR / spacing
    return np.asarray(0.5 * np.arctan2(2 * twist, 2 * np.hypot(*found.deviator.T)))


def turn_by_cell(samples: Samples, spacing: float) -> Floats:
    """(n,) angle [rad] between the directions at samples inside and those a spacing further.

    Of both ways of the grid the greater one; 90 deg at most. Samples whose neighbors lie outside
    are left out. Errors of directions that do not add up along the way, as those of a fit to
    noisy points, count once.
    """
    first = lifted(samples.jets, samples.principal.first).reshape(SIDE, SIDE, 3)
    x = samples.jets.x.reshape(SIDE, SIDE, 3)
    inside = samples.inside.reshape(SIDE, SIDE)
    turned = np.full((SIDE, SIDE), np.nan)
    for axis in (0, 1):
        direction: Floats = np.moveaxis(first, axis, 0)
        point: Floats = np.moveaxis(x, axis, 0)
        known = np.moveaxis(inside, axis, 0)
        here: Floats = np.moveaxis(turned, axis, 0)
        both = known[:-1] & known[1:]
        if not both.any():
            continue
        step = float(np.median(np.linalg.norm(np.diff(point, axis=0), axis=-1)[both]))
        apart = int(np.clip(round(spacing / step), 1, SIDE // 2))
        cos = np.abs(np.einsum("ijx,ijx->ij", direction[:-apart], direction[apart:]))
        length = np.linalg.norm(point[apart:] - point[:-apart], axis=-1)
        angle = np.arccos(np.clip(cos, 0.0, 1.0)) * np.minimum(1.0, spacing / length)
        angle[~(known[:-apart] & known[apart:])] = np.nan
        here[:-apart] = np.fmax(here[:-apart], angle)
    return np.asarray(turned[np.isfinite(turned)])


def check_rest(samples: Samples, spacing: float) -> None:
    """Raise where directions turn so much from cell to cell that lines mean nothing.

    Raises
    ------
    DegenerateError
        Noise, or waves much shorter than the spacing; names the part of the surface.
    """
    turn = turn_by_cell(samples, spacing)
    part = float((turn > np.radians(_RESTLESS_DEG)).mean()) if len(turn) else 0.0
    if part > _SHARE:
        raise DegenerateError(
            f"{samples.surface.name}: principal directions turn by more than {_RESTLESS_DEG:g} deg "
            f"over a spacing of {spacing:g} on {100 * part:.0f} % of the surface (limit "
            f"{100 * _SHARE:g} %): noise, or waves shorter than the cells\nsmooth the surface, "
            "choose a smaller spacing, or give directions: --along X,Y,Z (plane sections)"
        )

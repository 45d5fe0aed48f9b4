"""Fields of two families of directions on a surface: principal, or conjugate to a given one.

Source: do Carmo, Differential Geometry of Curves and Surfaces, 3.3.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.mesh import Floats, unit
from ddgfab.surfaces.principal import forms, principal
from ddgfab.surfaces.spline import Jets, SplineSurface

LEAST_ANGLE_DEG: Final = 15.0
"""Conjugate families that meet at a smaller angle [deg] make no usable cells."""


class Field(ABC):
    """Two directions at each point of a surface."""

    surface: SplineSurface

    @abstractmethod
    def directions(self, jets: Jets, family: int) -> Floats:
        """(n, 2) parameter directions of family 0 or 1, of unit length on the surface."""


class PrincipalField(Field):
    """The principal directions; family 0 is that of the larger curvature."""

    def __init__(self, surface: SplineSurface) -> None:
        self.surface = surface

    def directions(self, jets: Jets, family: int) -> Floats:
        """(n, 2) parameter directions of unit length on the surface."""
        found = principal(jets)
        return found.second if family else found.first


class ConjugateField(Field):
    """A given direction, and the one conjugate to it: cells are planar to third order.

    Parameters
    ----------
    along : gives (n, 2) parameter directions of family 0 for the jets of n points
    """

    def __init__(self, surface: SplineSurface, along: Callable[[Jets], Floats]) -> None:
        self.surface = surface
        self._along = along

    def directions(self, jets: Jets, family: int) -> Floats:
        """(n, 2) parameter directions of unit length on the surface."""
        given = self._along(jets)
        if family:
            low, mid, high = forms(jets).second
            one = low * given[:, 0] + mid * given[:, 1]
            two = mid * given[:, 0] + high * given[:, 1]
            given = np.stack([-two, one], axis=1)
        length = np.linalg.norm(given[:, :1] * jets.u + given[:, 1:] * jets.v, axis=1)
        return np.asarray(given / np.maximum(length, np.finfo(float).tiny)[:, None])


@checked
def plane_sections(normal: ArrayLike) -> Callable[[Jets], Floats]:
    """Directions of the sections with parallel planes of a normal (3,).

    Raises
    ------
    InputError
        A normal of length zero.
    """
    across = np.asarray(normal, dtype=np.float64)
    if across.shape != (3,) or not np.linalg.norm(across) > 0:
        raise InputError(f"normal {across.tolist()} of the planes: three numbers, not all 0")
    across = unit(across)
    return lambda jets: np.stack([-(jets.v @ across), jets.u @ across], axis=1)


@checked
def turned(angle: float) -> Callable[[Jets], Floats]:
    """Principal directions of the larger curvature turned by an angle [rad]."""

    def along(jets: Jets) -> Floats:
        found = principal(jets)
        return np.asarray(np.cos(angle) * found.first + np.sin(angle) * found.second)

    return along


def sines(field: Field, jets: Jets) -> Floats:
    """(n,) sines of the angles at which the families meet."""
    form = forms(jets)
    one, two = (form.frame(field.directions(jets, family)) for family in (0, 1))
    return np.asarray(np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]))

"""Angles in K-nets as numbers: about a normal, modulo 2 pi, between 0 and pi."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked, vectors
from ddgfab.errors import InputError
from ddgfab.mesh import Floats
from ddgfab.tolerances import RELATIVE_DEGENERATE


@checked
def oriented_angle(normal: Floats, a: Floats, b: Floats) -> Floats:
    """(...) angle from a to b about a normal [rad], in (-pi, pi]; vectors (..., 3).

    Raises
    ------
    InputError
        Vectors without three finite coordinates, or whose shapes do not go together.

    Source: mathematics.md 3.5, 11b.
    """
    normal, a, b = vectors(normal=normal, a=a, b=b)
    sine = np.einsum("...i,...i->...", normal, np.cross(a, b))
    return np.asarray(np.arctan2(sine, np.einsum("...i,...i->...", a, b)))


def modulo(angles: ArrayLike) -> Floats:
    """Angles modulo 2 pi in [-pi, pi) [rad]."""
    return np.asarray(np.remainder(np.asarray(angles) + np.pi, 2 * np.pi) - np.pi)


def refuse_angles(values: Floats, what: str) -> None:
    """Raise `InputError` at the first of (n,) angles outside (0, pi): an edge of no length.

    `what` names it, with {} for its index.
    """
    inside = (values > 0) & (values < np.pi)
    bad = ~(np.sin(np.where(inside, values, 0.0)) > RELATIVE_DEGENERATE)
    if bad.any():
        at = int(np.argmax(bad))
        raise InputError(
            f"{what.format(at)} is {values[at]:g}; angles between 0 and pi are needed "
            "(at these an edge has no length)"
        )

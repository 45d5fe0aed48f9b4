"""Trimming loops from sampled edges: straight rows thinned, ends joined, sides of patches met."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from ddgfab.mesh import Floats

CURVE_POINTS: Final = 96
"""Points of a curved trimming edge."""

_STRAIGHT: Final = 1e-9
"""A trimming edge is straight when it leaves its chord by less, relative to its length."""

_ON_SIDE: Final = 1e-7
"""Points this near to a side of the patch, as a part of its width, lie on it."""


def closed_loop(parts: Sequence[Floats], domain: Sequence[tuple[float, float]]) -> Floats:
    """(m, 2) one loop of the parameters of edges in order, the first point not repeated."""
    loop = np.concatenate([part[:-1] for part in parts])
    low, high = np.array(domain).T
    near = _ON_SIDE * (high - low)
    loop = np.where(np.abs(loop - low) < near, low, loop)
    return np.where(np.abs(loop - high) < near, high, loop)


def thinned(points: Floats) -> Floats:
    """Both ends of a straight row of points; all points of a curved one."""
    chord = points[-1] - points[0]
    length = float(np.linalg.norm(chord))
    gap = points - points[0]
    off = np.abs(gap[:, 0] * chord[1] - gap[:, 1] * chord[0])
    return points[[0, -1]] if length > 0 and off.max() <= _STRAIGHT * length**2 else points

"""Where generated roofs stand, and the plane arcs that they are drawn with."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.errors import DegenerateError
from ddgfab.mesh import Floats
from ddgfab.tolerances import RELATIVE_DEGENERATE


def grounded(points: Floats) -> Floats:
    """(..., 3) points moved so that the lowest is at z = 0 and the mean above the origin."""
    flat = points.reshape(-1, 3)
    return np.asarray(points - [*flat[:, :2].mean(axis=0), flat[:, 2].min()])


def arc_angles(rise_deg: float, count: int) -> Floats:
    """(count + 1,) tangent angles [rad] of a symmetric arch that begins at a slope [deg]."""
    return np.radians(np.linspace(rise_deg, -rise_deg, count + 1))


def chord_arc(start: ArrayLike, end: ArrayLike, bulge: float, count: int) -> Floats:
    """(count + 1, 2) points of a circular arc, equal chords.

    Parameters
    ----------
    start, end : (2,)
    bulge : height of the arc over the straight line, to its right, as a part of its length; 0:
        straight, 0.5: half a circle
    count : number of chords

    Raises
    ------
    DegenerateError
        Start and end are one point.

    Source: half the angle of the arc is 2 atan(2 bulge) (chord and height).
    """
    a, b = np.asarray(start, dtype=np.float64), np.asarray(end, dtype=np.float64)
    length = float(np.hypot(*(b - a)))
    if length <= RELATIVE_DEGENERATE * max(float(np.hypot(*a)), float(np.hypot(*b))):
        raise DegenerateError("the arc has no length: its ends are one point")
    half = 2.0 * np.arctan(2.0 * bulge)
    angle = np.linspace(-half, half, count + 1)
    middle = 0.5 * (angle[1:] + angle[:-1]) + np.arctan2(b[1] - a[1], b[0] - a[0])
    edges = np.stack([np.cos(middle), np.sin(middle)], axis=1)
    reach = float(edges.sum(axis=0) @ (b - a)) / length
    points = np.concatenate([np.zeros((1, 2)), np.cumsum(edges, axis=0)]) * (length / reach)
    return np.asarray(a + points)


def checked_forward(net: Floats) -> Floats:
    """The net itself, (M + 1, N + 1, 3), when opposite sides of every quad run the same way.

    Raises
    ------
    DegenerateError
        A quad that folds over or has a side without length; names it, the sides and the cosine.
    """
    for axis in (0, 1):
        sides = np.diff(net, axis=axis)
        first, second = (sides[:, :-1], sides[:, 1:]) if axis == 0 else (sides[:-1], sides[1:])
        lengths = np.linalg.norm(first, axis=-1) * np.linalg.norm(second, axis=-1)
        along = np.einsum("ijk,ijk->ij", first, second)
        bad = np.argwhere(along <= FOLDED * lengths)
        if len(bad):
            cell = int(bad[0, 0]), int(bad[0, 1])
            cosine = along[cell] / lengths[cell] if lengths[cell] > 0 else 0.0
            raise DegenerateError(
                f"panel {cell} folds over: its two sides in direction {axis} run apart "
                f"(cosine {cosine:.3f}, limit {FOLDED:g})\n"
                "make bends wider or the section narrower",
                cell=cell,
            )
    return net


FOLDED = 0.0
"""Cosine of the angle between opposite sides of a quad from which on it counts as folded."""

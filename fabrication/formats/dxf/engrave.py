"""Where the number of a plate is engraved, and which way is up: open lines, never text."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from ddgfab.mesh import Floats
from fabrication.drawings.strokes import Stroke, arrow, strokes, width_of
from fabrication.solids.plate import Plate
from fabrication.solids.section import segments
from fabrication.specs import Loop

HEIGHTS: Final = (10.0, 8.0, 6.0, 5.0, 4.0, 3.0)
"""Heights of letters [mm], of which the largest is taken that fits."""

AWAY: Final = 0.6
"""From letters to edges and holes, in heights of letters."""

PLACES: Final = 24
"""So many places are tried along a plate, and across."""


def engraved(flat: Plate, text: str) -> list[Stroke]:
    """The number along the longest edge, near its start, and an arrow upwards where up is known.

    Returns
    -------
    Lines in the frame of the plate [mm]; none where letters of 3 mm do not fit.
    """
    along = _along(flat.loops[0])
    turn = np.array([along, (-along[1], along[0])])  # to the frame of the text
    for height in HEIGHTS:
        corners = [_sampled(loop, 0.5 * height) @ turn.T for loop in flat.loops]
        wide = width_of(text, height)
        whole = wide + (1.8 * height if flat.up is not None else 0.0)
        at = _place(corners, whole, height)
        if at is None:
            continue
        lower = at - np.array([0.5 * whole, 0.5 * height])
        out = [(lower + line) @ turn for line in strokes(text, height)]
        if flat.up is not None:
            middle = lower + np.array([wide + 1.3 * height, 0.5 * height])
            way = turn @ np.array(flat.up)
            spin = np.array([(way[0], way[1]), (-way[1], way[0])])
            out += [(middle + (line - (0.5 * height, 0.0)) @ spin) @ turn for line in arrow(height)]
        return out
    return []


def _along(loop: Loop) -> Floats:
    """Unit direction of the longest line of the outline, to the right or upwards."""
    lines = [(s.u1 - s.u0, s.v1 - s.v0) for s in segments(loop) if not s.turn]
    u, v = max(lines, key=lambda way: round(math.hypot(*way), 6), default=(1.0, 0.0))
    length = math.hypot(u, v)
    sign = -1.0 if (u < -1e-9 * length or (abs(u) <= 1e-9 * length and v < 0.0)) else 1.0
    return np.array([sign * u / length, sign * v / length])


def _sampled(loop: Loop, step: float) -> Floats:
    """(n, 2) points along a loop, no further apart than a step [mm]."""
    out = []
    for s in segments(loop):
        length = abs(s.turn) * s.radius if s.turn else math.hypot(s.u1 - s.u0, s.v1 - s.v0)
        u, v, _, _ = s.points(np.linspace(0.0, 1.0, max(1, math.ceil(length / step)) + 1)[:-1])
        out.append(np.column_stack([u, v]))
    return np.concatenate(out)


def _place(loops: Sequence[Floats], width: float, height: float) -> Floats | None:
    """The middle of a rectangle that no loop enters, nearest to the start of the plate."""
    outer, points = loops[0], np.concatenate(loops)
    half = np.array([0.5 * width + AWAY * height, (0.5 + AWAY) * height])
    low, high = outer.min(axis=0) + half, outer.max(axis=0) - half
    if (low > high).any():
        return None
    grid = [np.linspace(a, b, PLACES) for a, b in zip(low, high, strict=True)]
    middle = 0.5 * (low[1] + high[1])
    for x in grid[0]:
        near = points[np.abs(points[:, 0] - x) <= half[0]]
        for y in sorted(grid[1], key=lambda y: (abs(y - middle), y)):
            free = not (np.abs(near[:, 1] - y) <= half[1]).any()
            if free and _inside(outer, x, y):
                return np.array([x, y])
    return None


def _inside(outline: Floats, x: float, y: float) -> bool:
    """Whether a point is within a closed line."""
    after = np.roll(outline, -1, axis=0)
    above = (outline[:, 1] > y) != (after[:, 1] > y)
    a, b = outline[above], after[above]
    cross = a[:, 0] + (y - a[:, 1]) * (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1])
    return bool(np.count_nonzero(cross > x) % 2)

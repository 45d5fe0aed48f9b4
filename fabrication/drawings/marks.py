"""What dimensions and notes are drawn with: arrowheads, dots, and the distances of ISO 129-1."""

from __future__ import annotations

import math
from typing import Final

from fabrication.drawings.sheet import Fill, Point

ARROW: Final = 2.5
"""Length of an arrowhead [mm]."""

NARROW: Final = 0.4
"""Half of its width [mm]."""

FIRST: Final = 8.0
"""From the outline to the first dimension line [mm]."""

NEXT: Final = 6.5
"""From one dimension line to the next [mm]."""

ROWS: Final = 7
"""So many dimension lines are tried."""

FOOT: Final = 1.0
"""From the outline to the extension line [mm]."""

OVER: Final = 1.5
"""How far an extension line reaches beyond the dimension line [mm]."""

ABOVE: Final = 1.1
"""From a dimension line to the text over it [mm]."""

MM_PLACES: Final = 1
DEG_PLACES: Final = 2


def arrow(tip: Point, ux: float, uy: float) -> Fill:
    """An arrowhead whose tip is at a point, pointing along a unit direction."""
    x, y = tip
    bx, by = x - ARROW * ux, y - ARROW * uy
    return Fill((tip, (bx - NARROW * uy, by + NARROW * ux), (bx + NARROW * uy, by - NARROW * ux)))


def dot(point: Point) -> Fill:
    """A small disc."""
    turns = (math.pi / 6.0 * k for k in range(12))
    return Fill(tuple((point[0] + 0.5 * math.cos(t), point[1] + 0.5 * math.sin(t)) for t in turns))


def readable(angle: float) -> float:
    """The angle [rad] of a text along a direction, to be read from below or from the right."""
    angle = math.remainder(angle, 2.0 * math.pi)
    if angle <= -0.5 * math.pi + 1e-6:
        return angle + math.pi
    return angle - math.pi if angle > 0.5 * math.pi + 1e-6 else angle

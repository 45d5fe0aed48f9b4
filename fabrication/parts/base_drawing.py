"""What the sheet of a base plate shows: plate and anchors in plan, the post upright."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from fabrication.boundary import Vec
from fabrication.drawings.lengths import Length
from fabrication.drawings.notes import Note
from fabrication.drawings.running import Running
from fabrication.drawings.views import Drawing, Measure, View

if TYPE_CHECKING:
    from fabrication.parts.base import BaseShape

X: Final[Vec] = (1.0, 0.0, 0.0)
Y: Final[Vec] = (0.0, 1.0, 0.0)
Z: Final[Vec] = (0.0, 0.0, 1.0)


def base_drawing(shape: BaseShape) -> Drawing:
    """The post in the plane in which its end leans, so that its cut is seen in true size."""
    w, t, r, c = 0.5 * shape.width, shape.thickness, shape.radius, shape.spread
    along: Vec = (math.cos(shape.azimuth), math.sin(shape.azimuth), 0.0)
    right = tuple(r * a for a in along)
    fall = r * math.tan(shape.lean)
    low: Vec = (right[0], right[1], shape.length - fall)
    high: Vec = (-right[0], -right[1], shape.length + fall)
    foot: Vec = (right[0], right[1], 0.0)
    upright: list[Measure] = [
        Length("post_low_mm", foot, low, "up", "right"),
        Length("post_high_mm", (-right[0], -right[1], 0.0), high, "up", "left"),
        Length("post_diameter_mm", (-right[0], -right[1], 0.0), foot, "across", "below", "Ø"),
    ]
    plan: list[Measure] = [
        Length("width_mm", (-w, -w, 0.0), (w, -w, 0.0), "across", "below", first=1),
        Running((-w, -w, 0.0), tuple(("anchor", (x, -c, 0.0)) for x in (-c, c)), "across", "above"),
        Running((-w, -w, 0.0), tuple(("anchor", (c, y, 0.0)) for y in (-c, c)), "up", "right"),
    ]
    radius = 0.5 * shape.diameter
    edges: tuple[Vec, Vec] = ((c, c - radius, 0.0), (c, c + radius, 0.0))
    plan.append(
        Note(
        f"4× Ø{shape.diameter:g}", edges[1], "anchor_mm", shape.diameter, (0.6, 1.0, 0.0),
        across=edges,
    ))  # fmt: skip
    upright.append(Length("plate_mm", (w, 0.0, -t), (w, 0.0, 0.0), "up", "right"))
    notes = (
        f"The end of the post leans by {math.degrees(shape.lean):.2f}° towards "
        f"{math.degrees(shape.azimuth) % 360.0:.2f}° about its axis, counterclockwise from the "
        "x axis of the plan; it is shown in that plane.",
    )
    return Drawing(
        (
            View("in the plane of the cut", along, Z, tuple(upright), breaks=False),
            View("from above", X, Y, tuple(plan), row=-1, hidden=False),
        ),
        notes=notes,
    )

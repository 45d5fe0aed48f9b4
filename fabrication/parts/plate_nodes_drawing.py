"""What the sheets of nodes cut from plate show: stars of plates, and spools of two discs."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

from fabrication.boundary import Vec
from fabrication.drawings.lengths import Length
from fabrication.drawings.notes import Note
from fabrication.drawings.running import Azimuths, Running
from fabrication.drawings.views import Drawing, Measure
from fabrication.parts.node.drawing import (
    ENDS,
    NOTE,
    arms_of,
    diameter,
    heights,
    marked,
    node_views,
)

if TYPE_CHECKING:
    from fabrication.parts.spool import SpoolShape
    from fabrication.parts.star import StarShape

STAR_COLUMNS: Final = (
    *ENDS,
    "beam_{k}",
    "azimuth_{k}_deg",
    "elevation_{k}_deg",
    "plate_{k}_first_mm",
    "plate_{k}_first_up_mm",
    "plate_{k}_second_mm",
    "plate_{k}_second_up_mm",
)
SPOOL_COLUMNS: Final = (
    *ENDS,
    "beam_{k}",
    "azimuth_{k}_deg",
    "elevation_{k}_deg",
    "disc_holes_{k}_mm",
)
"""Columns of the schedule of nodes that the sheets list."""


def star_drawing(shape: StarShape, about: Mapping[str, Any]) -> Drawing:
    """Plates in plan; the plate of the first arm with its holes from the axis and the bottom."""
    half, far = 0.5 * shape.thickness, shape.length
    z0, z1 = shape.z0, shape.z1
    arms = arms_of(shape.azimuths, about, far)
    plan: list[Measure] = [
        Azimuths((0.0, 0.0, z1), arms, far),
        Length("plate_mm", (far, -half, z1), (far, half, z1), "up", "right"),
        Length("plate_length_mm", (0.0, 0.0, z1), (far, -half, z1), "across", "below"),
        *marked(shape.mark, z1),
    ]
    for name, radius, angle in shape.circles():
        plan.append(diameter(name, radius, z1, angle))
    own = [hole for hole in shape.holes if hole.arm == 0]
    holes: tuple[tuple[str, Vec], ...] = tuple(("hole", (h.distance, -half, h.z)) for h in own)
    front: list[Measure] = [*heights(z0, z1, far)]
    if holes:
        front.append(Running((0.0, -half, z0), holes, "across", "below"))
        front.append(Running((0.0, -half, z0), holes, "up", "left"))
        x, y, z = holes[0][1]
        r = 0.5 * shape.diameter
        edges = (x, y, z - r), (x, y, z + r)
        label = f"{len(shape.holes)}× Ø{shape.diameter:g}"
        front.append(
            Note(label, edges[1], "plate_hole_mm", shape.diameter, (0.5, 0.0, 1.0), across=edges)
        )
    notes = (NOTE, "The front shows the plate of arm 1; the holes of the others are in the list.")
    return node_views(plan, front, STAR_COLUMNS, notes)


def spool_drawing(shape: SpoolShape, about: Mapping[str, Any]) -> Drawing:
    """A disc in plan with the holes of its first strip; thickness of discs and core upright."""
    half, far, z1 = 0.5 * shape.width, shape.length, shape.z1
    plan: list[Measure] = [
        Azimuths((0.0, 0.0, z1), arms_of(shape.azimuths, about, far), math.hypot(far, half)),
        Running(
            (0.0, 0.0, z1),
            (
                *(("hole", (step, -half, z1)) for step in shape.steps),
                ("disc_length_mm", (far, -half, z1)),
            ),
            "across",
            "below",
        ),
        Length("disc_width_mm", (far, -half, z1), (far, half, z1), "up", "right"),
        *marked(shape.mark, z1),
    ]
    r, step = 0.5 * shape.diameter, shape.steps[0]
    edges = (step, -r, z1), (step, r, z1)
    label = f"{len(shape.steps) * len(shape.azimuths)}× Ø{shape.diameter:g}, both discs"
    plan.append(
        Note(label, edges[1], "disc_hole_mm", shape.diameter, (0.3, 1.0, 0.0), across=edges)
    )
    z0, t, core = shape.z0, shape.thickness, shape.core
    front: list[Measure] = [
        *heights(z0, z1, far),
        Length("disc_mm", (far, -half, z1 - t), (far, -half, z1), "up", "left"),
        Length(
            "core_diameter_mm", (-core, 0.0, z0 + t), (core, 0.0, z0 + t), "across", "below", "Ø"
        ),
    ]
    return node_views(plan, front, SPOOL_COLUMNS, (NOTE, "Two discs, alike, on a round core."))

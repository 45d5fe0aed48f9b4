"""The schedule of base plates: plates with their posts, and where they stand."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from fabrication.formats.tables import Legend
from fabrication.gridshell.detailing.gridshell import Gridshell
from fabrication.gridshell.schedules.common import MARK, NUMBER, Masses, Row, instances_of
from fabrication.parts.base import BASE
from fabrication.specs import Family

LEGEND: Final = Legend(
    title="Base plates",
    about="a base plate with its post: where it stands on the ground, and under which node",
    meanings={
        "mark": MARK,
        "number": NUMBER,
        "node": "node that its post is welded to",
        "x_mm": "middle of the plate, in the coordinates of the assembly",
        "y_mm": "middle of the plate, in the coordinates of the assembly",
        "ground_mm": "height of the ground there, the underside of the plate",
        "bearing_deg": "direction of the x axis of the part, counterclockwise from the x axis of "
        "the assembly, looking from above; two sides of the plate are parallel to it",
        "plate_width_mm": "side of the square plate",
        "plate_mm": "its thickness",
        "anchor_hole_mm": "diameter of its four holes",
        "anchors_apart_mm": "from hole to hole along the sides; they are symmetric to the middle",
        "post_diameter_mm": "diameter of the post",
        "post_length_mm": "length of its axis, from the top of the plate to the bottom of the node",
        "post_mitre_deg": "angle between the post's end and a square one: the end is square to the "
        "axis of the node",
        "post_azimuth_deg": "where the post is shortest, counterclockwise from the x axis of the "
        "part, looking from above",
        "mass_kg": "mass of plate and post",
    },
    totals=("mass_kg",),
)


def base_rows(gridshell: Gridshell, families: Sequence[Family], masses: Masses) -> list[Row]:
    """Rows of the schedule of base plates, by vertex, as the shared shapes have them."""
    pieces = {base.mark: base for base in gridshell.bases}
    rows = {}
    for family, instance in instances_of(families, BASE):
        base, placed = pieces[instance.mark], instance.placement
        rows[base.mark] = {
            "mark": base.mark,
            "number": family.number,
            "node": base.node,
            "x_mm": float(placed[0, 3]),
            "y_mm": float(placed[1, 3]),
            "ground_mm": base.ground,
            "bearing_deg": float(np.degrees(np.arctan2(placed[1, 0], placed[0, 0])) % 360.0),
            **family.shape.dimensions(),
            "mass_kg": masses[family.number],
        }
    return [rows[base.mark] for base in gridshell.bases]

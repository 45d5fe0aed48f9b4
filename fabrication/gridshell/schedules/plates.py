"""The list of plates: what is cut from plate for nodes and for the ends of beams."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

from fabrication.formats.tables import Legend
from fabrication.gridshell.schedules.common import Row
from fabrication.parts.panel import M2_PER_MM2
from fabrication.solids.plate import Blank, FromPlate
from fabrication.specs import Family
from fabrication.standards import density, mass_kg

LEGEND: Final = Legend(
    title="Plates",
    about="rectangles of plate that end plates, base plates, discs and plates of stars are of",
    meanings={
        "use": "what is cut from it; outlines and holes are in the lists of beams, nodes and bases",
        "material": "what it is made of: grade and treatment as the project states them",
        "thickness_mm": "thickness of the plate",
        "width_mm": "smaller side of the least rectangle round the piece",
        "height_mm": "larger side of that rectangle",
        "quantity": "how many",
        "rectangles_m2": "area of these rectangles: plate to buy without nesting",
        "mass_kg": "mass of these rectangles",
        "marks": "the beams and nodes that they belong to",
    },
    totals=("quantity", "rectangles_m2", "mass_kg"),
    unprinted=("marks",),
)

DIGITS: Final = 1
"""Sides that agree to so many decimals [mm] are one row."""


def plate_rows(families: Sequence[Family], material: Callable[[Family], str]) -> list[Row]:
    """A row a size of plate, thick ones first; none where nothing is cut from plate."""
    found: dict[tuple[str, Blank], list[str]] = {}
    for family in families:
        if not isinstance(family.shape, FromPlate):
            continue
        marks = [instance.mark for instance in family.instances]
        for blank in family.shape.blanks():
            sides = round(blank.width, DIGITS), round(blank.height, DIGITS)
            key = (material(family), Blank(blank.use, blank.thickness, *sides))
            found.setdefault(key, []).extend(marks)
    rows = []
    for (made_of, blank), marks in sorted(found.items()):
        area = len(marks) * blank.width * blank.height
        rows.append(
            {
                "use": blank.use,
                "material": made_of,
                "thickness_mm": blank.thickness,
                "width_mm": blank.width,
                "height_mm": blank.height,
                "quantity": len(marks),
                "rectangles_m2": area * M2_PER_MM2,
                "mass_kg": mass_kg(area * blank.thickness, density("steel")),
                "marks": " ".join(dict.fromkeys(marks)),
            }
        )
    return rows

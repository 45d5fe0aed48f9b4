"""The parts list of a gridshell, and its panes by size."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

from fabrication.formats.tables import Legend
from fabrication.gridshell.schedules.common import NUMBER, Described, Masses, Row
from fabrication.gridshell.schedules.panels import SIZE_STEP_MM, rounded_up, size_class
from fabrication.parts.panel import M2_PER_MM2, PANEL
from fabrication.specs import Family, FromStock, Shape

BOM: Final = Legend(
    title="Parts list",
    about="a part number: what it is, how many, and their mass",
    meanings={
        "number": NUMBER,
        "role": "what the part is in the structure",
        "quantity": "how many pieces there are, rejected ones included",
        "description": "beams and nodes of bars: the bar and the length to saw; panes: least "
        "rectangle x thickness; others: their dimensions [mm]",
        "material": "what it is made of: grade and treatment as the project states them",
        "unit_mass_kg": "mass of one piece",
        "mass_kg": "mass of all pieces",
        "marks": "the pieces of this number",
    },
    totals=("quantity", "mass_kg"),
    unprinted=("marks",),
)

SIZES: Final = Legend(
    title="Panels by size",
    about="panes whose least rectangles are of one size class, the largest first",
    meanings={
        "size_class": "least rectangle that holds the panes, both sides rounded up to whole "
        f"{SIZE_STEP_MM:g} mm",
        "width_mm": "smaller side of that rectangle",
        "height_mm": "larger side of that rectangle",
        "thickness_mm": "thickness of the panes",
        "quantity": "how many panes",
        "part_numbers": "how many of them differ",
        "area_m2": "area of the outer surfaces of all these panes",
        "rectangles_m2": "area of as many rectangles of the class: glass to buy without nesting",
        "mass_kg": "mass of all these panes",
        "marks": "the panes",
    },
    totals=("quantity", "area_m2", "rectangles_m2", "mass_kg"),
    unprinted=("marks",),
)


def bom_rows(
    families: Sequence[Family], masses: Masses, material: Callable[[Family], str]
) -> list[Row]:
    """A row a part number; `material` names what its pieces are made of."""
    return [
        {
            "number": family.number,
            "role": family.role,
            "quantity": len(family.instances),
            "description": described(family.shape),
            "material": material(family),
            "unit_mass_kg": masses[family.number],
            "mass_kg": masses[family.number] * len(family.instances),
            "marks": marks(family),
        }
        for family in families
    ]


def marks(family: Family) -> str:
    """The marks of a family's pieces."""
    return " ".join(instance.mark for instance in family.instances)


def described(shape: Shape) -> str:
    """A part in a few words: the bar it is sawn from, or the dimensions it has."""
    if isinstance(shape, Described):
        return shape.described()
    if isinstance(shape, FromStock):
        bar, length = shape.stock()
        return f"{bar}, {length:.1f} long"
    dimensions = shape.dimensions()
    if "designation" in dimensions:
        return str(dimensions["designation"])
    sizes = ("width_mm", "height_mm", "thickness_mm")
    if all(name in dimensions for name in sizes):
        return " x ".join(f"{dimensions[name]:.1f}" for name in sizes)
    return ", ".join(
        f"{name.removesuffix('_mm').replace('_', ' ')} {value:.1f}"
        for name, value in dimensions.items()
        if name.endswith("_mm") and isinstance(value, float)
    )


def size_rows(families: Sequence[Family], masses: Masses) -> list[Row]:
    """A row a size class of panes, the largest first."""
    found: dict[tuple[float, float, float], list[Family]] = {}
    for family in families:
        if family.kind.role == PANEL.role:
            sides = family.shape.dimensions()
            key = (
                rounded_up(sides["width_mm"]),
                rounded_up(sides["height_mm"]),
                round(sides["thickness_mm"], 3),
            )
            found.setdefault(key, []).append(family)
    rows = []
    for (width, height, thickness), own in sorted(found.items(), reverse=True):
        count = sum(len(family.instances) for family in own)
        areas = (f.shape.dimensions()["area_m2"] * len(f.instances) for f in own)
        rows.append(
            {
                "size_class": size_class({"width_mm": width, "height_mm": height}),
                "width_mm": width,
                "height_mm": height,
                "thickness_mm": thickness,
                "quantity": count,
                "part_numbers": len(own),
                "area_m2": sum(areas),
                "rectangles_m2": count * width * height * M2_PER_MM2,
                "mass_kg": sum(masses[f.number] * len(f.instances) for f in own),
                "marks": " ".join(marks(family) for family in own),
            }
        )
    return rows

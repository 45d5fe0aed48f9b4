"""What the columns of a kit's schedules mean, and how signs and sides go."""

from __future__ import annotations

from typing import Final

from fabrication.formats.tables import Legend

CONVENTIONS: Final = (
    "A link runs from its start, the first hinge of its bar, to its end. Twists turn the axis at "
    "the start into that at the end about the direction from start to end: positive is "
    "right-handed.",
    "Angles at a hinge are counted about its axis, counterclockwise as seen against it, from the "
    "hinge's bar of the lowest number, in the design pose.",
    "Parts are put on a pin from its head upwards, along the axis of the hinge; order and heights "
    "are in the sheet Assembly. Up is along the axis.",
    "Masses are those of solid parts: prints with infill weigh less.",
)
"""How signs, sides and counts go."""

NUMBER: Final = "part number: congruent pieces, with one file"

BOM: Final = Legend(
    title="Bill of materials",
    about="a part number: what it is, how many, and where its pieces go",
    meanings={
        "number": NUMBER,
        "role": "what the part is in the linkage",
        "count": "how many pieces there are, rejected ones included",
        "material": "what it is made of",
        "length_mm": "links: from hinge to hinge; pins: over all",
        "twist_deg": "angle between the axes at both ends of a link, positive for a right hand",
        "hand": "sense of the twist: right or left",
        "diameter_mm": "of the eyes of links; of pins, rings and caps",
        "bore_mm": "diameter of the bore, in links that at the start",
        "height_mm": "of the eyes of links; of rings, caps and coupons",
        "label": "text on the part",
        "mass_g": "mass of one piece",
        "total_g": "mass of all pieces",
        "between": "links: from which hinge to which, start first; others: the hinge they are on",
        "marks": "the pieces of this number",
        "length_exact_mm": "length of a link with all digits, to make the linkage again",
        "twist_exact_deg": "twist of a link with all digits",
    },
    totals=("count", "total_g"),
    unprinted=("length_exact_mm", "twist_exact_deg"),
)

LINKS: Final = Legend(
    title="Links",
    about="a link: its hinges, levels, and angles in the design pose",
    meanings={
        "mark": "piece mark: one piece of the linkage",
        "number": NUMBER,
        "bar": "bar of the mechanism, counted from 0",
        "strip": "strip of bars that keep their level together",
        "direction": "direction of the net that the bar runs along",
        "hinge_start": "hinge at the start, counted from 0",
        "hinge_end": "hinge at the end",
        "pin_start": "pin at the start",
        "pin_end": "pin at the end",
        "level_start": "level along the pin at the start, upwards",
        "level_end": "level along the pin at the end",
        "label_side": "up: the side with the label is up along the axes; down: it is below",
        "label_towards": "pin at the end to which the label reads",
        "length_mm": "from hinge to hinge",
        "twist_deg": "angle between the axes at both ends, positive for a right hand",
        "hand": "sense of the twist: right or left",
        "angle_start_deg": "direction of the link about the axis at its start, in the design pose",
        "angle_end_deg": "direction of the link about the axis at its end, in the design pose",
        "angle_start_exact_deg": "the angle at the start with all digits",
        "angle_end_exact_deg": "the angle at the end with all digits",
    },
    unprinted=("angle_start_exact_deg", "angle_end_exact_deg"),
)

HINGES: Final = Legend(
    title="Hinges",
    about="a hinge: its pin, what is on it from the bottom up, and where it is",
    meanings={
        "hinge": "hinge of the mechanism, counted from 0",
        "pin": "mark of its pin",
        "number": "part number of the pin",
        "bars": "how many links are on it",
        "stack": "marks of all that is on the pin, from the bottom up",
        "diameter_mm": "of the pin",
        "length_mm": "of the pin, over all",
        "x_mm": "position in the design pose, in the coordinates of the assembly",
        "y_mm": "position in the design pose, in the coordinates of the assembly",
        "z_mm": "position in the design pose, in the coordinates of the assembly",
        "axis_x": "unit vector of the axis, upwards",
        "axis_y": "unit vector of the axis, upwards",
        "axis_z": "unit vector of the axis, upwards",
    },
)

ASSEMBLY: Final = Legend(
    title="Assembly, in this order",
    about="a part in the order in which it is put on: pin by pin, each from its head upwards",
    meanings={
        "step": "in this order",
        "pin_order": "place of the pin in the order of pins",
        "hinge": "hinge of the mechanism, counted from 0",
        "pin": "mark of the pin",
        "order": "place on this pin, from its head",
        "part": "mark of the part that is put on",
        "number": NUMBER,
        "role": "what the part is in the linkage",
        "level": "level of a link along this pin, upwards",
        "label_side": "up: the side with the label is up along the axis; down: it is below",
        "from_mm": "where the part begins along the axis, from the hinge",
        "to_mm": "where it ends",
    },
)

RODS: Final = Legend(
    title="Cut list of rods",
    about="a rod of stock, and the metal pins that come out of it",
    meanings={
        "diameter_mm": "of the rod",
        "stock_mm": "length of the rod as it is bought; empty: none is long enough",
        "quantity": "how many pins come out of it",
        "used_mm": "lengths of these pins",
        "rest_mm": "what is left of the rod after its cuts and the trim of both ends",
        "cuts": "mark and length [mm] of each pin, the longest first",
        "marks": "the pins",
    },
    totals=("quantity", "stock_mm", "used_mm", "rest_mm"),
    unprinted=("marks",),
)

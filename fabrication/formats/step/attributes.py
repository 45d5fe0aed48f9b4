"""User-defined attributes of products and instances, as CAD programs list and search them.

CAx-IF, Recommended Practices for User Defined Attributes. OCCT finds an attribute by the name of
its property definition, and only where it has a general property of its own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final, Literal, TypeAlias

import numpy as np

from fabrication.formats.step.entities import FILE_CONTEXT, LENGTH_UNIT, MASS_UNIT
from fabrication.formats.step.text import quoted, real

Measure: TypeAlias = Literal["text", "length", "mass"]
"""What a value is: text, millimeters or kilograms."""

Attribute: TypeAlias = tuple[str, str | float, Measure]
"""Key, value, and what the value is."""

MARK: Final = "mark"
"""Key of the mark of an instance; in part files that of the marks of all pieces."""

LONGEST: Final = 1200
"""Most characters of a text, "..." at its end where there were more.

OCCT's reader refuses files with strings of 16384 bytes, and a character may take 12."""

IDS: Final = 6
"""How many ids an attribute takes."""

_ENTITIES: Final = (
    "#%d=PROPERTY_DEFINITION(%s,'user defined attribute',%s);\n"
    "#%d=GENERAL_PROPERTY('',%s,'user defined attribute');\n"
    "#%d=GENERAL_PROPERTY_ASSOCIATION('user defined attribute','',#%d,#%d);\n"
    "#%d=PROPERTY_DEFINITION_REPRESENTATION(#%d,#%d);\n"
    f"#%d=REPRESENTATION('user defined attribute',(#%d),{FILE_CONTEXT});\n"
    "#%d=%s;\n"
)
_ITEMS: Final[Mapping[Measure, str]] = {
    "text": "DESCRIPTIVE_REPRESENTATION_ITEM(%s,%s)",
    "length": f"MEASURE_REPRESENTATION_ITEM(%s,LENGTH_MEASURE(%s),{LENGTH_UNIT})",
    "mass": f"MEASURE_REPRESENTATION_ITEM(%s,MASS_MEASURE(%s),{MASS_UNIT})",
}


def marks_text(marks: Sequence[str]) -> str:
    """Marks with spaces between; of many those that fit, and how many more there are."""
    room = LONGEST - len(f" and {len(marks)} more")
    ends = np.cumsum([len(mark) + 1 for mark in marks]) - 1
    shown = int(np.searchsorted(ends, room, side="right"))
    if shown >= len(marks):
        return " ".join(marks)
    return f"{' '.join(marks[:shown])} and {len(marks) - shown} more"


def attribute_text(first: int, of: str, attribute: Attribute) -> str:
    """The entities of an attribute; ids count from `first`.

    Parameters
    ----------
    of : id of a product definition or of a usage occurrence
    """
    name, value, measure = attribute
    key = quoted(name)
    if isinstance(value, str):
        text = value if len(value) <= LONGEST else f"{value[: LONGEST - 4]} ..."
        item = _ITEMS[measure] % (key, quoted(text))
    else:
        item = _ITEMS[measure] % (key, real(value))
    definition, general, association, use, representation, last = range(first, first + IDS)
    return _ENTITIES % (
        *(definition, key, of),
        *(general, key),
        *(association, general, definition),
        *(use, definition, representation),
        *(representation, last),
        *(last, item),
    )

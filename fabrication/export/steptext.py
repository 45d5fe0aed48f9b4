"""What OCCT's STEP text needs afterwards: stable ids, a right unit of density, colours in order."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Final

from ddgfab.errors import KernelError

# OCCT gives the unit of density as g^3 cm^2; these find the two exponents to mend (g cm^-3).
_GRAM: Final = re.compile(rb"(DERIVED_UNIT_ELEMENT\(#(\d+),)3\.(\);\s+#\2 = \( MASS_UNIT)")
_CENTIMETRE: Final = re.compile(
    rb"(DERIVED_UNIT_ELEMENT\(#(\d+),)2\.(\);\s+#\2 = \( LENGTH_UNIT\(\) NAMED_UNIT\(\*\)"
    rb"\s+SI_UNIT\(\.CENTI\.)"
)
_OCCURRENCE: Final = re.compile(rb"(NEXT_ASSEMBLY_USAGE_OCCURRENCE\(')[^']*'")
_LAYER: Final = re.compile(rb"= PRESENTATION_LAYER_ASSIGNMENT\('(\w+)',[^(]*\(([#\d,\s]+)\)")
_BREP: Final = re.compile(
    rb"= ADVANCED_BREP_SHAPE_REPRESENTATION\('[^']*',\s*\(([#\d,\s]+)\),\s*#(\d+)\s*\)"
)
_ID: Final = re.compile(rb"#(\d+)")
STYLE_IDS: Final = 9
"""How many ids a style takes."""
_END: Final = b"ENDSEC;\nEND-ISO-10303-21;"


def renumbered(text: bytes) -> bytes:
    """Component ids from 1 in file order: OCCT takes them from a counter of the whole process."""
    count = 0

    def number(match: re.Match[bytes]) -> bytes:
        nonlocal count
        count += 1
        return b"%s%d'" % (match.group(1), count)

    return _OCCURRENCE.sub(number, text)


def mended_density(text: bytes) -> bytes:
    """Densities in g cm^-3 with the exponents that say so."""
    return _CENTIMETRE.sub(rb"\g<1>-3.\3", _GRAM.sub(rb"\g<1>1.\3", text))


def coloured(text: bytes, colours: Mapping[str, tuple[float, float, float]]) -> bytes:
    """The text with every solid of a layer styled in that layer's sRGB colour (0..1).

    OCCT writes styles in the order of memory addresses, eleven entities a solid; here they come in
    file order, one style a layer.

    Raises
    ------
    KernelError
        The text is not laid out as OCCT does, or a solid is on no layer.
    """
    head, end, tail = text.rpartition(_END)
    if not end:
        raise KernelError("unexpected STEP text from OCCT: the data section has no end")
    contexts: dict[int, int] = {}  # of each item of a solid's representation, in file order
    for match in _BREP.finditer(head):
        contexts |= {int(item): int(match.group(2)) for item in _ID.findall(match.group(1))}
    layers = {
        int(solid): match.group(1).decode()
        for match in _LAYER.finditer(head)
        for solid in _ID.findall(match.group(2))
    }
    following = 1 + int(_ID.findall(head, head.rfind(b"\n#"))[0])
    lines: list[str] = []
    styles: dict[str, int] = {}
    for solid in sorted(layers):
        layer = layers[solid]
        if solid not in contexts or layer not in colours:
            raise KernelError(f"unexpected STEP text from OCCT: solid #{solid} on layer {layer}")
        if layer not in styles:
            styles[layer] = following + len(lines)
            lines += style(styles[layer], colours[layer])
        styled = following + len(lines)
        lines += [
            f"#{styled} = STYLED_ITEM('color',(#{styles[layer]}),#{solid});",
            f"#{styled + 1} = MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',"
            f"(#{styled}),#{contexts[solid]});",
        ]
    return head + "".join(line + "\n" for line in lines).encode("ascii") + end + tail


def style(first: int, colour: tuple[float, float, float]) -> list[str]:
    """A presentation style of surfaces and curves in one colour; ids count from `first`."""
    red, green, blue = (f"{value:.6f}" for value in colour)
    return [
        f"#{first} = PRESENTATION_STYLE_ASSIGNMENT((#{first + 1},#{first + 7}));",
        f"#{first + 1} = SURFACE_STYLE_USAGE(.BOTH.,#{first + 2});",
        f"#{first + 2} = SURFACE_SIDE_STYLE('',(#{first + 3}));",
        f"#{first + 3} = SURFACE_STYLE_FILL_AREA(#{first + 4});",
        f"#{first + 4} = FILL_AREA_STYLE('',(#{first + 5}));",
        f"#{first + 5} = FILL_AREA_STYLE_COLOUR('',#{first + 6});",
        f"#{first + 6} = COLOUR_RGB('',{red},{green},{blue});",
        f"#{first + 7} = CURVE_STYLE('',#{first + 8},POSITIVE_LENGTH_MEASURE(0.1),#{first + 6});",
        f"#{first + 8} = DRAUGHTING_PRE_DEFINED_CURVE_FONT('continuous');",
    ]


def encoded(text: str) -> str:
    r"""Text in the 7-bit alphabet of ISO 10303-21, the rest as \X2\....\X0\ (UTF-16)."""
    return "".join(
        c if " " <= c <= "~" else f"\\X2\\{c.encode('utf-16-be').hex().upper()}\\X0\\" for c in text
    )


def quoted(text: str) -> str:
    """Text as a STEP string, with its apostrophes."""
    return "'" + encoded(text.replace("\\", "\\\\").replace("'", "''")) + "'"


def real(value: float) -> str:
    """A number as a STEP real of 15 digits, with the point that it needs."""
    mantissa, exponent, power = f"{value:.15G}".partition("E")
    return mantissa + ("" if "." in mantissa else ".") + exponent + power

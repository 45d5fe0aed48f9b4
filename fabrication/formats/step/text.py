"""Bits of STEP text: strings, numbers, styles."""

from __future__ import annotations

import re
from typing import Final

_OTHER: Final = re.compile(r"[^ -~]+")
STYLE_IDS: Final = 9
"""How many ids a style takes."""


def style(first: int, color: tuple[float, float, float]) -> list[str]:
    """A presentation style of surfaces and curves in one color; ids count from `first`."""
    red, green, blue = (f"{value:.6f}" for value in color)
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
    return _OTHER.sub(
        lambda run: f"\\X2\\{run.group().encode('utf-16-be').hex().upper()}\\X0\\", text
    )


def quoted(text: str) -> str:
    """Text as a STEP string, with its apostrophes."""
    return "'" + encoded(text.replace("\\", "\\\\").replace("'", "''")) + "'"


def real(value: float) -> str:
    """A number as a STEP real of 15 digits, with the point that it needs."""
    mantissa, exponent, power = f"{value:.15G}".partition("E")
    return mantissa + ("" if "." in mantissa else ".") + exponent + power

"""Bits of STEP text: strings, numbers, styles."""

from __future__ import annotations

import re
from typing import Final

_CONTROL: Final = re.compile(r"[\x00-\x1f\x7f-\x9f\u2028\u2029]+")
_WIDE: Final = re.compile("([\x80-\uffff]+)|([\U00010000-\U0010ffff]+)")
_HALF: Final = re.compile("[\ud800-\udfff]")

HEADER_STRING: Final = 256
"""Most characters of a string in a header (ISO 10303-21, clause 8.2)."""

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


def plain(text: str) -> str:
    """Text without control characters: a run of them is one space, halves of surrogates U+FFFD."""
    return _HALF.sub("\ufffd", _CONTROL.sub(" ", text))


def encoded(text: str) -> str:
    r"""Text in the 7-bit alphabet of ISO 10303-21 (clause 6.4.3).

    Characters up to U+FFFF stand as \X2\....\X0\, four digits each; those above, which \X2\ does
    not have, as \X4\........\X0\, eight digits each. Control characters go (see `plain`).
    """

    def coded(run: re.Match[str]) -> str:
        name, form = ("X2", "utf-16-be") if run[1] else ("X4", "utf-32-be")
        return f"\\{name}\\{run[0].encode(form).hex().upper()}\\X0\\"

    return _WIDE.sub(coded, plain(text))


def quoted(text: str) -> str:
    """Text as a STEP string, with its apostrophes."""
    escaped = text.replace("\\", "\\\\").replace("'", "''")
    if not (escaped.isascii() and escaped.isprintable()):
        escaped = encoded(escaped)
    return f"'{escaped}'"


def header_text(text: str) -> str:
    """Text as a string of a header, cut to the length that one may have."""
    return quoted(plain(text)[:HEADER_STRING])


def header_list(text: str) -> str:
    """Text as a list of such strings, as many as it needs."""
    whole = plain(text)
    step = HEADER_STRING
    rows = [whole[i : i + step] for i in range(0, len(whole), step)] or [""]
    return f"({','.join(map(quoted, rows))})"


def real(value: float) -> str:
    """A number as a STEP real of 15 digits, with the point that it needs."""
    mantissa, exponent, power = f"{value:.15G}".partition("E")
    return mantissa + ("" if "." in mantissa else ".") + exponent + power

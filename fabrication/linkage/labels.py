"""Labels of links: the number of the part, as large as the bar allows."""

from __future__ import annotations

from typing import Final

from fabrication.linkage.settings import LinkageSettings
from fabrication.parts.link import LinkShape
from fabrication.parts.link.frame import label_room
from fabrication.solids.text import ROWS, Label, text_size

HEIGHT: Final = 4.0
"""Height [mm] of letters where there is room: larger ones are no easier to read."""


def short_number(number: str) -> str:
    """What is written on a part: "L3" on part number "LP-003"."""
    prefix, _, count = number.partition("-")
    return f"{prefix[0]}{int(count)}"


def label_for(shape: LinkShape, text: str, settings: LinkageSettings) -> Label | None:
    """The largest label that fits the upper side of a link's bar, or None where none is legible.

    Letters beside each other along the bar are preferred; where the bar is too narrow for full
    height, they stand one below the other, which makes them larger.
    """
    if settings.label == "none":
        return None
    depth = settings.label_depth if settings.label == "engraved" else -settings.label_depth
    long, wide = label_room(shape, max(0.0, -depth))
    best: Label | None = None
    for stacked in (False, True):
        across, up = text_size(text, stacked=stacked)
        along, beside = (up, across) if stacked else (across, up)
        unit = min(HEIGHT / ROWS, long / along, wide / beside)
        if unit >= settings.printer.stroke and (best is None or unit > best.unit):
            best = Label(text, unit, depth, stacked)
    return best

"""Units of length: what files state of themselves, and the one rule for what a number means."""

from __future__ import annotations

import math
import re
from typing import Final, Literal, get_args

from ddgfab.arguments import checked
from ddgfab.errors import InputError

Unit = Literal["mm", "cm", "m", "in", "ft"]

FACTORS: Final[dict[str, float]] = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "ft": 304.8}
"""Millimetres in one of each unit."""

_NAMES: Final = {
    **{name: name for name in get_args(Unit)},
    **{f"{stem}{end}": "mm" for stem in ("millimet",) for end in ("re", "res", "er", "ers")},
    **{f"{stem}{end}": "cm" for stem in ("centimet",) for end in ("re", "res", "er", "ers")},
    **{f"{stem}{end}": "m" for stem in ("met",) for end in ("re", "res", "er", "ers")},
    "inch": "in",
    "inches": "in",
    "foot": "ft",
    "feet": "ft",
}
_STATED = re.compile(r"\bunits?\b\s*(?:[:=]|are\b|in\b)?\s*['\"]?([A-Za-z]+)", re.IGNORECASE)


def stated_unit(comment: str) -> str | None:
    """The unit that a comment names ("units: mm", "File units = meters"), or None."""
    found = _STATED.search(comment)
    return _NAMES.get(found[1].lower()) if found else None


SHORTEST_MEDIAN_MM: Final = 20.0
"""A median edge below this [mm] means that a mesh is in another unit; no gridshell has it."""

LONGEST_MEDIAN_MM: Final = 20_000.0
"""So does a median edge above this [mm]."""


@checked
def unlikely_size(median_mm: float) -> str:
    """What is unlikely of a mesh whose median edge is so long [mm], or an empty text."""
    if SHORTEST_MEDIAN_MM <= median_mm <= LONGEST_MEDIAN_MM:
        return ""
    end = f"under {SHORTEST_MEDIAN_MM:g} mm"
    if median_mm > LONGEST_MEDIAN_MM:
        end = f"over {LONGEST_MEDIAN_MM / 1000:g} m"
    length = f"{median_mm:.3g} mm" if median_mm < 1e5 else f"{median_mm / 1000:.6g} m"
    return f"the median edge is {length} long; no gridshell has edges {end}"


USUAL_MM: Final = 1500.0
"""Edge of a usual gridshell [mm]."""


@checked
def likely_setting(
    median_mm: float, factor: float, scale: float = 1.0, stated: str | None = None
) -> tuple[str, str | float]:
    """The setting, "units" or "scale", that makes an unlikely size a likely one, and its value.

    Parameters
    ----------
    median_mm : median edge [mm], by the settings as they are
    factor : millimetres for one unit of the file, by these settings
    scale : the scale in it
    stated : unit that the file states, which no setting may contradict
    """
    for name, value in (("median_mm", median_mm), ("factor", factor), ("scale", scale)):
        if not 0 < value < math.inf:
            raise InputError(f"{name} {value}: a positive number is needed")
    own = median_mm / factor * scale
    if stated is None:
        for unit in ("m", "mm", "cm"):
            if not unlikely_size(own * FACTORS[unit]):
                return "units", unit
    power = round(math.log10(USUAL_MM / median_mm))
    return "scale", float(f"{scale * 10.0**power:.6g}")


@checked
def to_millimetres(units: str | None, scale: float, stated: str | None, file: str | None) -> float:
    """Millimetres for one unit of a file: the rule that all commands share.

    The unit is the one asked for; where none is, the one that the file states; where it states
    none, the millimetre. `scale` multiplies the coordinates before that.

    Raises
    ------
    InputError
        An unknown unit, or one that the file contradicts.
    """
    if units is not None and units not in FACTORS:
        raise InputError(f'unit "{units}" is unknown; one of {", ".join(FACTORS)}')
    if units is not None and stated is not None and units != stated:
        raise InputError(
            f'its comment says "units: {stated}", the settings say units = "{units}"\n'
            f"leave units out (--units, [project] units), or correct the file's comment",
            file=file,
        )
    return scale * FACTORS[units or stated or "mm"]

"""Spline surfaces of a STEP file that no kernel can use, found in its text.

The CAD kernel leaves such faces out, or sorts their knots, without a word.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise
from typing import Final

from ddgfab.errors import InputError, clipped

_WORD: Final = "B_SPLINE_SURFACE_WITH_KNOTS"
_KNOTS: Final = re.compile(r"\(([^()]*)\),\(([^()]*)\),\.\w+\.\)")
_WEIGHTS: Final = re.compile(r"RATIONAL_B_SPLINE_SURFACE\(\((.*?)\)\)(?:\)|$)")


def check_spline_surfaces(text: str, file: str) -> None:
    """Refuse a STEP file with spline surfaces whose knots or weights are out of order.

    Parameters
    ----------
    text : the whole file

    Raises
    ------
    InputError
        Knots that are not in ascending order, a weight that is not positive; names the entity, the
        parameter or the control point, and the value.

    Source: ISO 10303-42, b_spline_surface_with_knots, rational_b_spline_surface.
    """
    for name, entity in _entities(text):
        where = f"surface {name}"
        knots = _KNOTS.search(entity)
        for axis, row in zip("uv", knots.groups() if knots else (), strict=False):
            for number, (before, after) in enumerate(pairwise(_numbers(row)), 1):
                if not after > before:
                    raise InputError(
                        f"{where}: knots along {axis} are not in ascending order: knot {number} is "
                        f"{after:g} after {before:g}\n{_REMEDY}",
                        file=file,
                    )
        weights = _WEIGHTS.search(entity)
        rows = weights[1].split("),(") if weights else ()
        for i, row in enumerate(rows):
            for j, weight in enumerate(_numbers(row.strip("()"))):
                if not weight > 0:
                    raise InputError(
                        f"{where}: weight {weight:g} of control point ({i}, {j}) is not positive\n"
                        f"{_REMEDY}",
                        file=file,
                    )


_REMEDY: Final = "export the surface anew, or rebuild it in the program it came from"


def _entities(text: str) -> Iterator[tuple[str, str]]:
    """Number and text without blanks of each spline surface."""
    at = text.find(_WORD)
    while at >= 0:
        start, end = text.rfind(";", 0, at) + 1, text.find(";", at)
        end = len(text) if end < 0 else end
        name, _, body = "".join(text[start:end].split()).partition("=")
        yield clipped(name), body[max(body.find(_WORD), 0) :]
        at = text.find(_WORD, end)


def _numbers(row: str) -> list[float]:
    """Numbers of a list; those that are none are the kernel's to refuse."""
    try:
        return [float(part) for part in row.split(",") if part]
    except ValueError:
        return []

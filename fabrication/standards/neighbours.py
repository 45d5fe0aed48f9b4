"""Profiles that may have been meant: sides in another order, a missing wall, near sizes."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Callable, Sequence
from itertools import combinations
from typing import Final

from ddgfab.suggest import nearest
from fabrication.standards.data import table

COUNT: Final = 4
"""At most so many are named."""

SAME_STEP: Final = 1.6
"""Sizes with one side further than this factor away are not near."""

_BETWEEN: Final = re.compile(r"(?<=\d)\s*(?:mm)?\s*[x*×/]\s*(?=\d)", re.IGNORECASE)
_NUMBER: Final = r"\d+(?:\.\d+)?"
_FORM: Final = re.compile(rf"\s*([A-Za-z]+)[\s:.-]*({_NUMBER}(?:x{_NUMBER})*)x?\s*(?:mm)?\s*")
_LONGEST: Final = 80  # characters of a text that is looked at
_MOST_SIZES: Final = 6  # of a designation that are compared: all ways to leave some out are tried
_ALIASES: Final = {
    "RRO": "RHS",
    "RECT": "RHS",
    "SQ": "SHS",
    "QRO": "SHS",
    "FLAT": "FL",
    "FLA": "FL",
    "TEE": "T",
}


def understood(text: str) -> tuple[str, list[float]] | None:
    """Family and sizes [mm] of a text that is nearly a designation: other signs, spaces, names."""
    plain = _BETWEEN.sub("x", text[:_LONGEST].replace(",", "."))
    match = _FORM.fullmatch(plain)
    if match is None:
        return None
    family = match[1].upper()
    family = _ALIASES.get(family, family)
    if family not in table("profiles"):
        return None
    return family, [float(size) for size in match[2].split("x")]


def written(family: str, sizes: Sequence[float]) -> str:
    """The designation of a family and sizes [mm]."""
    return f"{family} {'x'.join(f'{size:g}' for size in sizes)}"


def near_profiles(text: str, valid: Callable[[str], bool]) -> list[str]:
    """Designations near to what was written, the most likely first.

    Parameters
    ----------
    valid : whether a designation that no list holds makes a section
    """
    families = table("profiles")
    found = understood(text)
    if found is None:
        names = [name for rule in families.values() for name in rule["common"]]
        return nearest(text, names) or ["FL 60x8", "RHS 120x60x5", "T 60x60x7"]
    family, sizes = found[0], found[1][:_MOST_SIZES]
    meant = [written(family, sizes)] if len(sizes) == len(families[family]["dimensions"]) else []
    if family == "SHS" and len(sizes) == 3:
        # A square section written with both sides; with two sides that differ it is none.
        family, sizes = ("SHS", sizes[1:]) if sizes[0] == sizes[1] else ("RHS", sizes)
        meant = [written(family, sizes)]
    ranked = sorted(
        (-_equal(sizes, _sizes(name)), _away(sizes, _sizes(name)), name)
        for name in families[family]["common"]
    )
    close = [name for equal, away, name in ranked if equal < -1 or away <= math.log(SAME_STEP)]
    listed = [*(name for name in meant if name != text.strip() and valid(name)), *close]
    return list(dict.fromkeys(listed or [name for _, _, name in ranked]))[:COUNT]


def missing_sizes(family: str, sizes: Sequence[float]) -> str:
    """Which sizes a designation lacks, as text; empty where it has as many as it should."""
    labels = table("profiles")[family]["dimensions"]
    if len(sizes) >= len(labels):
        return ""
    return f" ({' and '.join(labels[len(sizes) :])} missing)"


def _sizes(name: str) -> list[float]:
    return [float(size) for size in name.split(" ")[1].split("x")]


def _equal(given: Sequence[float], known: Sequence[float]) -> int:
    """How many sizes are the same, in whatever order."""
    return (Counter(given) & Counter(known)).total()


def _away(given: Sequence[float], known: Sequence[float]) -> float:
    """The greatest ratio of sizes (logarithm) in any order, over all ways to leave some out."""
    few, many = sorted((sorted(given), sorted(known)), key=len)
    return min(
        max(abs(math.log(max(a, 1e-9) / max(b, 1e-9))) for a, b in zip(few, chosen, strict=True))
        for chosen in combinations(many, len(few))
    )

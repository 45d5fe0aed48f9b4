"""Lettering: how wide texts are, in Helvetica, which every reader of PDF has.

Heights are those of capital letters, as ISO 3098 counts them. Widths are those of Adobe's font
metrics, in thousandths of the size of the font.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Final

CAPITAL: Final = 0.718
"""Height of a capital letter, as a part of the size of the font."""

BELOW: Final = 0.207 / CAPITAL
"""How far letters such as g reach below the line, in heights."""

LEAST: Final = 2.5
"""Least height of a text [mm]."""

OTHER: Final = 600
"""Width of a character that the font has not."""

ELLIPSIS: Final = "..."

_PLAIN: Final = (
    "278 278 355 556 556 889 667 191 333 333 389 584 278 333 278 278 556 556 556 556 556 556 "
    "556 556 556 556 278 278 584 584 584 556 1015 667 667 722 722 667 611 778 722 278 500 667 "
    "556 833 722 778 667 778 722 667 611 722 667 944 667 667 611 278 278 278 469 556 333 556 "
    "556 500 556 556 278 556 556 222 222 500 222 833 556 556 556 556 333 500 278 556 500 722 "
    "500 500 500 334 260 334 584 "
)
_BOLD: Final = (
    "278 333 474 556 556 889 722 238 333 333 389 584 278 333 278 278 556 556 556 556 556 556 "
    "556 556 556 556 333 333 584 584 584 611 975 722 722 722 722 667 611 778 722 278 556 722 "
    "611 833 722 778 667 778 722 667 611 722 667 944 667 667 611 333 278 333 584 556 333 556 "
    "611 556 611 556 333 611 611 278 278 556 278 889 611 611 611 611 389 556 333 611 556 778 "
    "556 556 500 389 280 389 584 "
)
_PLAIN_LATIN: Final = (
    "278 333 556 556 556 556 260 556 333 737 370 556 584 333 737 333 400 584 333 333 333 556 "
    "537 278 333 333 365 556 834 834 834 611 667 667 667 667 667 667 1000 722 667 667 667 667 "
    "278 278 278 278 722 722 778 778 778 778 778 584 778 722 722 722 722 667 667 611 556 556 "
    "556 556 556 556 889 500 556 556 556 556 278 278 278 278 556 556 556 556 556 556 556 584 "
    "611 556 556 556 556 500 556 500 "
)
_BOLD_LATIN: Final = (
    "278 333 556 556 556 556 280 556 333 737 370 556 584 333 737 333 400 584 333 333 333 611 "
    "556 278 333 333 365 556 834 834 834 611 722 722 722 722 722 722 1000 722 667 667 667 667 "
    "278 278 278 278 722 722 778 778 778 778 778 584 778 722 722 722 722 667 667 611 556 556 "
    "556 556 556 556 889 556 556 556 556 556 278 278 278 278 611 611 611 611 611 611 611 584 "
    "611 611 611 611 611 556 611 556 "
)


def _widths(ascii_widths: str, latin: str) -> dict[str, int]:
    found = {chr(32 + k): int(width) for k, width in enumerate(ascii_widths.split())}
    found |= {chr(160 + k): int(width) for k, width in enumerate(latin.split())}
    return found


_WIDTHS: Final = {False: _widths(_PLAIN, _PLAIN_LATIN), True: _widths(_BOLD, _BOLD_LATIN)}


@lru_cache(maxsize=4096)
def text_width(text: str, height: float, bold: bool = False) -> float:
    """Width [mm] of a text whose capital letters are so high [mm].

    >>> round(text_width("B-0012", 2.5), 2)
    11.22
    """
    known = _WIDTHS[bold]
    return sum(known.get(character, OTHER) for character in text) * height / CAPITAL / 1000.0


def clip(text: str, width: float, height: float, bold: bool = False) -> str:
    """The text, or as much of its beginning as is no wider [mm], with three dots.

    >>> clip("Canopy over the station yard", 30.0, 2.5)
    'Canopy over the...'
    """
    if text_width(text, height, bold) <= width:
        return text
    dots = text_width(ELLIPSIS, height, bold)
    known, most = _WIDTHS[bold], (width - dots) * 1000.0 * CAPITAL / height
    used = 0
    for count, character in enumerate(text):
        used += known.get(character, OTHER)
        if used > most:
            return text[:count].rstrip() + ELLIPSIS
    return text


def wrap(text: str, width: float, height: float) -> list[str]:
    """The words of a text on lines that are no wider [mm]; longer words are cut in two."""
    lines: list[str] = []
    for word in text.split():
        while text_width(word, height) > width:
            cut = max(1, len(clip(word, width, height)) - len(ELLIPSIS))
            lines.append(word[:cut])
            word = word[cut:]
        joined = f"{lines[-1]} {word}" if lines else word
        if lines and text_width(joined, height) <= width:
            lines[-1] = joined
        elif word:
            lines.append(word)
    return lines

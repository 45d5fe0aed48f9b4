"""DXF of sheets: the same items as in the PDF, a layer a pen; the sheets of a subject in a row."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import Final
from unicodedata import combining, normalize

from fabrication.drawings.dxf_file import Layer, template
from fabrication.drawings.sheet import DASHES, WIDTHS, Arc, Fill, Path, Pen, Sheet, Text

LAYERS: Final = tuple(
    Layer(pen.upper(), 7, round(100.0 * width), tuple(DASHES.get(pen, ())))
    for pen, width in WIDTHS.items()
)
"""Layers of the pens."""

BETWEEN: Final = 20.0
"""Room [mm] between two sheets."""

STYLES: Final = {False: "TEXT", True: "BOLD"}
"""Text styles, plain and bold; their fonts are as wide as those of the PDF."""

FONTS: Final = (("TEXT", "arial.ttf"), ("BOLD", "arialbd.ttf"))

ANSI: Final = "cp1252"
"""Python's name of ANSI_1252, the code page of R12 files."""

UNKNOWN: Final = "?"
"""Stands for a character that the code page has not."""

FIRST_HANDLE: Final = 0x1000


def sheets_dxf(sheets: Iterable[Sheet], release: str = "R2010") -> str:
    """Sheets beside each other, 1:1 in millimeters of paper, as DXF of a release, R2010 or R12."""
    before, after, owner = template(release, LAYERS, FONTS)
    writer = _Entities(owner, release)
    x = 0.0
    for sheet in sheets:
        for item in sheet.drawn():
            item.moved(x, 0.0).write(writer)
        x += sheet.paper.width + BETWEEN
    seed = f"{writer.handle:X}"
    return before.replace("$SEED$", seed) + "\n".join(writer.lines) + "\n" + after


def encoding(release: str) -> str:
    """How files of a release are encoded: R12 by the code page that its header names."""
    return ANSI if release == "R12" else "utf-8"


def ansi(character: str) -> str:
    """A character as R12 can have it: itself, its letter without accents, or `UNKNOWN`.

    >>> ansi("ü"), ansi("ř"), ansi("中")
    ('ü', 'r', '?')
    """
    for text in (character, "".join(c for c in normalize("NFKD", character) if not combining(c))):
        if text and not _lost(text):
            return text
    return UNKNOWN


def _lost(text: str) -> bool:
    try:
        text.encode(ANSI)
    except UnicodeEncodeError:
        return True
    return False


class _Entities:
    """Entities as lines of text; see `fabrication.drawings.sheet.Writer`."""

    def __init__(self, owner: str, release: str) -> None:
        self.lines: list[str] = []
        self.handle = FIRST_HANDLE
        self._owner, self._old = owner, release == "R12"

    def _begin(self, kind: str, pen: Pen, subclass: str) -> None:
        head = [f"  0\n{kind}\n  5\n{self.handle:X}"]
        self.handle += 1
        if not self._old:
            head.append(f"330\n{self._owner}\n100\nAcDbEntity")
        head.append(f"  8\n{pen.upper()}")
        if not self._old:
            head.append(f"100\n{subclass}")
        self.lines += head

    def path(self, path: Path) -> None:
        """Lines, one by one in the old release."""
        points = path.stroke_points(1.0)
        if len(points) == 2 or self._old:
            for (a, b), (c, d) in pairwise(points):
                self._begin("LINE", path.pen, "AcDbLine")
                self.lines.append(
                    f" 10\n{a:.4f}\n 20\n{b:.4f}\n 30\n0.0\n 11\n{c:.4f}\n 21\n{d:.4f}\n 31\n0.0"
                )
            return
        self._begin("LWPOLYLINE", path.pen, "AcDbPolyline")
        self.lines.append(f" 90\n{len(path.points)}\n 70\n{int(path.closed)}")
        self.lines += [f" 10\n{x:.4f}\n 20\n{y:.4f}" for x, y in path.points]

    def arc(self, arc: Arc) -> None:
        """A circle or an arc."""
        (x, y), radius = arc.center, arc.radius
        self._begin("CIRCLE" if arc.full else "ARC", arc.pen, "AcDbCircle")
        self.lines.append(f" 10\n{x:.4f}\n 20\n{y:.4f}\n 30\n0.0\n 40\n{radius:.4f}")
        if not arc.full:
            start, end = (math.degrees(angle) % 360.0 for angle in (arc.start, arc.end))
            if not self._old:
                self.lines.append("100\nAcDbArc")
            self.lines.append(f" 50\n{start:.6f}\n 51\n{end:.6f}")

    def fill(self, fill: Fill) -> None:
        """Triangles from the first corner."""
        first, *rest = fill.points
        for one, two in pairwise(rest):
            self._begin("SOLID", "thin", "AcDbTrace")
            for code, (x, y) in zip((10, 11, 12, 13), (first, one, two, two), strict=True):
                self.lines.append(f" {code}\n{x:.4f}\n {code + 10}\n{y:.4f}\n {code + 20}\n0.0")

    def text(self, text: Text) -> None:
        """A line of text from its left end."""
        if not text.text:
            return
        left = {"left": 0.0, "center": 0.5, "right": 1.0}[text.anchor] * text.width
        c, s = math.cos(text.angle), math.sin(text.angle)
        x, y = text.at[0] - left * c, text.at[1] - left * s
        self._begin("TEXT", "text", "AcDbText")
        self.lines.append(
            f" 10\n{x:.4f}\n 20\n{y:.4f}\n 30\n0.0\n 40\n{text.height:.4f}\n"
            f"  1\n{''.join(self._characters(text.text))}\n"
            f" 50\n{math.degrees(text.angle) % 360.0:.6f}\n  7\n{STYLES[text.bold]}"
        )
        if not self._old:
            self.lines.append("100\nAcDbText")

    def _characters(self, text: str) -> Iterator[str]:
        """Characters as DXF has them: special ones as codes, in the old release all but ASCII."""
        codes = {"^": "^ ", "%": "%%%", "\n": " ", "\r": " "}
        old = {"°": "%%d", "Ø": "%%c"}
        for character in text:
            if character in codes:
                yield codes[character]
            elif self._old and ord(character) > 126:
                yield old.get(character) or ansi(character)
            else:
                yield character

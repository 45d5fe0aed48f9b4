"""PDF: sheets as pages, written by reportlab; page contents are made once for several files."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path as FilePath
from typing import Any, Final

from fabrication.drawings.lettering import CAPITAL
from fabrication.drawings.sheet import DASHES, WIDTHS, Arc, Fill, Paper, Path, Pen, Sheet, Text

POINTS: Final = 72.0 / 25.4
"""Points in a millimeter."""

FONTS: Final = {False: "Helvetica", True: "Helvetica-Bold"}
OTHER_FONT: Final = "DejaVuSans"
"""For characters that the fonts of every reader have not."""

UNKNOWN: Final = "?"
"""Stands for a character that no font has."""

_KAPPA: Final = 4.0 / 3.0


@dataclass(frozen=True)
class Page:
    """A sheet as drawing operators, and the texts whose characters need another font."""

    paper: Paper
    title: str
    group: str
    content: str
    others: tuple[Text, ...]


class _Content:
    """Drawing operators in millimeters; see `fabrication.drawings.sheet.Writer`."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.others: list[Text] = []
        self._pen: Pen | None = None

    def _use(self, pen: Pen) -> None:
        if pen != self._pen:
            dashes = " ".join(f"{dash:g}" for dash in DASHES.get(pen, ()))
            self.lines.append(f"{WIDTHS[pen]:g} w [{dashes}] 0 d")
            self._pen = pen

    def path(self, path: Path) -> None:
        """Straight lines."""
        self._use(path.pen)
        first, *rest = path.points
        ways = " ".join(f"{x:.3f} {y:.3f} l" for x, y in rest)
        end = "s" if path.closed else "S"
        self.lines.append(f"{first[0]:.3f} {first[1]:.3f} m {ways} {end}")

    def arc(self, arc: Arc) -> None:
        """An arc, as Bezier curves of at most a quarter turn."""
        self._use(arc.pen)
        count = max(1, math.ceil((arc.end - arc.start) / (0.5 * math.pi) - 1e-9))
        turn = (arc.end - arc.start) / count
        reach = arc.radius * _KAPPA * math.tan(turn / 4.0)
        x, y = arc.at(arc.start)
        words = [f"{x:.3f} {y:.3f} m"]
        for k in range(count):
            a, b = arc.start + k * turn, arc.start + (k + 1) * turn
            (x0, y0), (x3, y3) = arc.at(a), arc.at(b)
            words.append(
                f"{x0 - reach * math.sin(a):.3f} {y0 + reach * math.cos(a):.3f} "
                f"{x3 + reach * math.sin(b):.3f} {y3 - reach * math.cos(b):.3f} "
                f"{x3:.3f} {y3:.3f} c"
            )
        self.lines.append(" ".join(words) + " S")

    def fill(self, fill: Fill) -> None:
        """A polygon in black."""
        (x, y), *rest = fill.points
        ways = " ".join(f"{a:.3f} {b:.3f} l" for a, b in rest)
        self.lines.append(f"{x:.3f} {y:.3f} m {ways} f")

    def text(self, text: Text) -> None:
        """A line of text."""
        quoted = _quoted(text.text)
        if quoted is None:
            self.others.append(text)
            return
        size = text.height / CAPITAL
        left = {"left": 0.0, "center": 0.5, "right": 1.0}[text.anchor] * text.width
        c, s = math.cos(text.angle), math.sin(text.angle)
        x, y = text.at[0] - left * c, text.at[1] - left * s
        font = "/F2" if text.bold else "/F1"
        matrix = f"1 0 0 1 {x:.3f} {y:.3f}"
        if text.angle:
            matrix = f"{c:.5f} {s:.5f} {-s:.5f} {c:.5f} {x:.3f} {y:.3f}"
        self.lines.append(f"BT {font} {size:.3f} Tf {matrix} Tm ({quoted}) Tj ET")


@lru_cache(maxsize=8192)
def _quoted(text: str) -> str | None:
    """A text as a string of PDF in the encoding of the fonts; None where it has not all of it."""
    try:
        data = text.encode("cp1252")
    except UnicodeEncodeError:
        return None
    return "".join(
        chr(byte) if 32 <= byte < 127 and byte not in b"()\\" else f"\\{byte:03o}" for byte in data
    )


def page_of(sheet: Sheet, group: str = "") -> Page:
    """A sheet as a page; `group` is the heading of its bookmark."""
    content = _Content()
    for item in sheet.drawn():
        item.write(content)
    return Page(sheet.paper, sheet.title, group, "\n".join(content.lines), tuple(content.others))


def pdf_bytes(pages: Sequence[Page], title: str, author: str = "", subject: str = "") -> bytes:
    """Pages as a PDF with bookmarks; the same pages give the same bytes."""
    from reportlab import rl_config
    from reportlab.pdfgen.canvas import Canvas

    rl_config.useA85 = 0  # streams as bytes: a fifth smaller, and much faster
    stream = io.BytesIO()
    canvas = Canvas(stream, pageCompression=1, invariant=1)
    canvas.setTitle(title)
    canvas.setAuthor(author)
    canvas.setSubject(subject)
    canvas.setCreator("ddgfab")
    named = _fonts(canvas)
    group = ""
    for k, page in enumerate(pages):
        canvas.setPageSize((page.paper.width * POINTS, page.paper.height * POINTS))
        canvas.addLiteral(f"{POINTS:.6f} 0 0 {POINTS:.6f} 0 0 cm 1 J 1 j")
        canvas.addLiteral(named(page.content))
        for text in page.others:
            _other(canvas, text)
        key = f"p{k}"
        canvas.bookmarkPage(key)
        if page.group and page.group != group:
            canvas.addOutlineEntry(page.group, key, 0, closed=True)
            group = page.group
        canvas.addOutlineEntry(page.title, key, 1 if page.group else 0)
        canvas.showPage()
    canvas.save()
    return stream.getvalue()


def _fonts(canvas: Any) -> Callable[[str], str]:
    """Both fonts made known to a file; what puts their names in it into a page's content."""
    inside = []
    for name in FONTS.values():
        canvas.setFont(name, 10.0)
        inside.append(canvas._doc.getInternalFontName(name))
    if inside == ["F1", "F2"]:
        return lambda content: content

    def renamed(content: str) -> str:
        plain, bold = inside
        return content.replace("BT /F1 ", f"BT /{plain} ").replace("BT /F2 ", f"BT /{bold} ")

    return renamed


def _other(canvas: Any, text: Text) -> None:
    """A text of characters that need another font: embedded where there is one."""
    font = _other_font()
    shown = "".join(UNKNOWN if c in missing(text.text) else c for c in text.text)
    size = text.height / CAPITAL
    if font != FONTS[False]:
        size *= min(1.0, text.width / max(canvas.stringWidth(shown, font, size), 1e-9))
    canvas.saveState()
    canvas.translate(*text.at)
    canvas.rotate(math.degrees(text.angle))
    canvas.setFont(font, size)
    {
        "left": canvas.drawString,
        "center": canvas.drawCentredString,
        "right": canvas.drawRightString,
    }[text.anchor](0, 0, shown)
    canvas.restoreState()


@lru_cache(maxsize=8192)
def missing(text: str) -> frozenset[str]:
    """The characters of a text that no font has: `UNKNOWN` is printed for them."""
    from reportlab.pdfbase import pdfmetrics

    if _quoted(text) is not None:
        return frozenset()
    font = _other_font()
    if font == FONTS[False]:
        return frozenset(c for c in text if _quoted(c) is None)
    known = pdfmetrics.getFont(font).face.charToGlyph
    return frozenset(c for c in text if ord(c) not in known)


@lru_cache(maxsize=1)
def _other_font() -> str:
    """A font of most alphabets, where matplotlib brings it."""
    from reportlab.pdfbase import pdfmetrics
    from reportlab.pdfbase.ttfonts import TTFError, TTFont

    spec = find_spec("matplotlib")
    if spec is None or spec.origin is None:
        return FONTS[False]
    file = FilePath(spec.origin).parent / "mpl-data" / "fonts" / "ttf" / f"{OTHER_FONT}.ttf"
    try:
        pdfmetrics.registerFont(TTFont(OTHER_FONT, str(file)))
    except (TTFError, OSError):
        return FONTS[False]
    return OTHER_FONT


def write_pages(sheets: Iterable[tuple[Sheet, str]]) -> list[Page]:
    """Sheets with their groups as pages."""
    return [page_of(sheet, group) for sheet, group in sheets]

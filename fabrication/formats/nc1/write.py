"""DSTV NC as text: Standard description for steel structure pieces, 7th edition (July 1998).

Faces: v is the front (our y least), o the top, u the bottom, h behind. x runs from the lowest x of
the bar, y of v and h upwards from the lower edge, y of o and u across, from the front. Cut angles
of the header are those of the cuts' lines in the front view against the upright, counterclockwise;
the contours, which have priority, say the same.
"""

from __future__ import annotations

import math
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from fabrication.solids.sawn import SawnBar, Section

MOST: Final = 40
"""Most characters of a text that is marked."""

LETTERS: Final = 10
"""Height of the marked number [mm]."""

FROM_END: Final = 60.0
"""How far [mm] from the start of the bar the number is marked."""


@dataclass(frozen=True)
class Order:
    """What the header says beside measures: order, drawing, piece, steel, how many, [kg/m3]."""

    order: str
    drawing: str
    piece: str
    steel: str
    quantity: int
    density: float


def nc1_text(bar: SawnBar, section: Section, order: Order) -> str:
    """The file of a bar."""
    first = min(_x(bar.start, z) for z in _heights(bar, section))
    lines = ["ST", *_header(bar, section, order), *_contours(bar, section, first)]
    lines += _holes(bar, section, first)
    at = max(_x(bar.start, z) for z in _heights(bar, section)) - first + FROM_END
    middle = 0.5 * bar.profile.depth
    lines += ["SI", f"  v{at:11.2f}u{middle:10.2f} {0.0:.2f} {LETTERS} {plain(order.piece)}", "EN"]
    return "".join(f"{line}\r\n" for line in lines)


def plain(text: str) -> str:
    """Text in ASCII on one line: accents go, what is left over is a question mark."""
    flat = unicodedata.normalize("NFKD", text)
    kept = "".join(c for c in flat if not unicodedata.combining(c))
    shown = "".join(c if " " <= c <= "~" else "?" for c in kept)
    return shown[:MOST].strip() or "-"


def _header(bar: SawnBar, section: Section, order: Order) -> Iterator[str]:
    heights = _heights(bar, section)
    length = max(_x(bar.end, z) for z in heights) - min(_x(bar.start, z) for z in heights)
    texts = (order.order, order.drawing, "1", order.piece, order.steel)
    yield from (f"  {plain(text)}" for text in texts)
    yield f"  {order.quantity}"
    yield f"  {plain(bar.profile.name)}"
    yield f"  {section.code}"
    sizes = [
        *(bar.profile.depth, bar.profile.width, section.flange, section.web, section.radius),
        *(order.density * section.area * 1e-6, section.outline * 1e-3),
    ]
    if section.code == "B":  # by the square meter
        by_area = order.density * section.web * 1e-3
        sizes = [bar.profile.depth, 0.0, 0.0, section.web, 0.0, by_area, 2.0]
    angles = [-math.degrees(math.atan(slope)) for _, slope in (bar.start, bar.end)]
    values = (length, *sizes)
    yield from (f"  {value:11.2f}" for value in values[:6])
    yield from (f"  {value:11.3f}" for value in (*values[6:], *angles, 0.0, 0.0))
    yield from ("  ",) * 4


def _contours(bar: SawnBar, section: Section, first: float) -> Iterator[str]:
    """The outline of every face, counterclockwise, its first point again at its end."""
    low, high = _heights(bar, section)
    corners = (
        (_x(bar.start, low) - first, 0.0),
        (_x(bar.end, low) - first, 0.0),
        (_x(bar.end, high) - first, bar.profile.depth),
        (_x(bar.start, high) - first, bar.profile.depth),
    )
    yield from _contour("v", corners)
    if section.code == "B":
        return
    if section.code == "M":
        yield from _contour("h", corners)
        yield from _contour("u", _flange(corners[0][0], corners[1][0], bar.profile.width))
    yield from _contour("o", _flange(corners[3][0], corners[2][0], bar.profile.width))


def _flange(start: float, end: float, width: float) -> tuple[tuple[float, float], ...]:
    return ((start, 0.0), (end, 0.0), (end, width), (start, width))


def _contour(face: str, corners: tuple[tuple[float, float], ...]) -> Iterator[str]:
    yield "AK"
    for k, (x, y) in enumerate((*corners, corners[0])):
        name, reference = (face, "u") if k == 0 else (" ", " ")
        yield f"  {name}{x + 0.0:11.2f}{reference}{y:10.2f}{0.0:10.2f}"


def _holes(bar: SawnBar, section: Section, first: float) -> Iterator[str]:
    """Round holes through the bar: of a hollow section in both walls."""
    faces = ("v", "h") if section.code == "M" else ("v",)
    rows = [
        f"  {face}{x - first:11.2f}u{z - section.low:10.2f}{diameter:10.2f}{0.0:10.2f}"
        for face in faces
        for x, z, diameter in bar.holes
    ]
    if rows:
        yield "BO"
        yield from rows


def _heights(bar: SawnBar, section: Section) -> tuple[float, float]:
    return section.low, section.low + bar.profile.depth


def _x(cut: tuple[float, float], z: float) -> float:
    return cut[0] + cut[1] * z

"""DSTV NC: a file for saw and drill of every part number that is a sawn bar."""

from __future__ import annotations

import math
from collections import Counter
from pathlib import Path
from typing import Final

from ddgfab.errors import InputError
from fabrication.formats.base import KG_PER_MM3, Format, Part, Provenance
from fabrication.formats.nc1.read import Nc1, read_nc1
from fabrication.formats.nc1.write import Order, nc1_text
from fabrication.formats.report import FileReport
from fabrication.solids.sawn import OfBar, SawnBar, Section, section_of
from fabrication.specs import Check, Family

VOLUME: Final = 2e-4
"""How far the volume that a file states may be from that of the bar, relative to it: coordinates
have two decimals, weights three."""


class DstvNc(Format):
    """DSTV NC1: header with cuts, contours AK, holes BO, number SI."""

    name = "nc1"
    suffixes = (".nc1", ".nc")
    parts = True

    def takes(self, family: Family) -> bool:
        """Whether the part, or the bar in it, needs a saw and a drill only."""
        return _bar_of(family) is not None

    def write_part(self, path: Path, part: Part, about: Provenance) -> None:
        """The bar; plates that are welded to it are not in the file."""
        found = _bar_of(part.family)
        assert found is not None
        order = Order(
            about.title.number or about.project,
            part.number,
            part.number,
            part.material.category or part.material.name,
            len(part.family.instances),
            part.material.density,
        )
        path.write_text(nc1_text(*found, order), "ascii", newline="")

    def check_part(self, path: Path, part: Part) -> list[Check]:
        """Read back: number, quantity, holes, and the volume between the cuts."""
        found = _bar_of(part.family)
        try:
            read = read_nc1(path)
        except InputError as error:
            return [Check("nc1 readable", False, str(error))]
        assert found is not None
        bar, section = found
        holes = len(bar.holes) * (2 if section.code == "M" else 1)
        try:
            off = abs(stated_volume(read, part.material.density) / bar.volume - 1.0)
        except InputError as error:
            return [Check("nc1 readable", False, str(error))]
        number, pieces = read.header["piece"], int(read.header["quantity"])
        marked = [text for _, _, _, text in read.marks]
        return [
            Check("nc1 readable", True),
            Check("nc1 number", marked == [number], str(number), part.number),
            Check("nc1 pieces", pieces == len(part.family.instances), float(pieces)),
            Check("nc1 holes", len(read.holes) == holes, float(len(read.holes)), float(holes)),
            Check("nc1 volume", off <= VOLUME, off, VOLUME),
        ]

    def inspect(self, path: Path) -> FileReport:
        """Profile, length and what is in it."""
        read = read_nc1(path)
        faces = Counter(contour[0][0] for contour in read.contours)
        contours = ", ".join(f"{count} on {face}" for face, count in sorted(faces.items()))
        text = (
            f"{read.header['quantity']} of {read.header['profile']}, "
            f"{read.value('length'):g} mm, contours {contours or 'none'}, {len(read.holes)} holes"
        )
        return FileReport(str(path), "DSTV NC", text, ())


FORMAT: Final = DstvNc()


def stated_volume(read: Nc1, density: float) -> float:
    """Volume [mm3] of the bar that a file states: a mean length times the section, less holes.

    Raises
    ------
    InputError
        The file is none of a bar that this program writes: names what is missing.
    """
    code, depth = read.header["code"], read.value("height")
    fronts = [contour for contour in read.contours if contour[0][0] == "v"]
    corners = [(x, y) for _, x, y, _ in fronts[0][:-1]] if len(fronts) == 1 else []
    if not depth > 0 or len(corners) < 3 or (code != "B" and len(corners) != 4):
        raise InputError("the height or the contour on face v is not that of a bar")
    if not all(numbers for _, _, _, numbers in read.holes):
        raise InputError("a hole has no diameter")
    sides = zip(corners, corners[1:] + corners[:1], strict=True)
    twice = sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in sides)
    drilled = sum(0.25 * math.pi * numbers[0] ** 2 for _, _, _, numbers in read.holes)
    if code == "B":
        return (0.5 * twice - drilled) * read.value("web")
    if code == "T":
        depth = 2.0 * _middle_of_tee(read)
    (low, *_, high), (_, end_low, end_high, _) = corners, corners
    part = 0.5 * depth / read.value("height")
    begin = low[0] + part * (high[0] - low[0])
    end = end_low[0] + part * (end_high[0] - end_low[0])
    area = read.value("weight") / density / KG_PER_MM3 * 1e-3
    return area * (end - begin) - drilled * read.value("web")


def _middle_of_tee(read: Nc1) -> float:
    """Height [mm] of the center of a tee's section over its lower edge, by its measures."""
    depth, width = read.value("height"), read.value("flange_width")
    flange, web, root = read.value("flange"), read.value("web"), read.value("radius")
    corner = (1.0 - 0.25 * math.pi) * root**2
    away = (10.0 - 3.0 * math.pi) / (12.0 - 3.0 * math.pi) * root  # of its center from its sides
    parts = (
        (web * (depth - flange), 0.5 * (depth - flange)),
        (width * flange, depth - 0.5 * flange),
        (2.0 * corner, depth - flange - away),
    )
    area = sum(area for area, _ in parts)
    if not area > 0:
        raise InputError("the measures of the tee are not those of a section")
    return sum(area * at for area, at in parts) / area


def _bar_of(family: Family) -> tuple[SawnBar, Section] | None:
    """The bar of a part number and its section."""
    bar = family.shape.sawn() if isinstance(family.shape, OfBar) else None
    section = None if bar is None else section_of(bar.profile)
    return None if bar is None or section is None else (bar, section)

"""DXF: what is cut from plate or glass, 1:1 in mm; a file a part number, one of nesting."""

from __future__ import annotations

import math
from contextlib import suppress
from pathlib import Path
from typing import Final
from weakref import WeakKeyDictionary

import numpy as np

from ddgfab.errors import DdgError, InputError, clipped
from fabrication.formats.base import Contents, Format, Part, Provenance, Whole
from fabrication.formats.dxf.engrave import engraved
from fabrication.formats.dxf.nested import nested_lines
from fabrication.formats.dxf.read import Polyline, read_dxf
from fabrication.formats.dxf.write import (
    CUT,
    DETAIL,
    ENGRAVE,
    MARK,
    NESTED_LAYERS,
    dxf_text,
    lines_text,
)
from fabrication.formats.nested import NESTING, stock_sheets
from fabrication.formats.report import FileReport
from fabrication.solids import boundary_of
from fabrication.solids.plate import OfPlates, Plate, plate
from fabrication.solids.section import section_area
from fabrication.specs import Check, Family, Loop

NESTED: Final = f"{NESTING}.dxf"
"""File of the glass on its sheets of stock."""

PLACED: Final = 1e-6
"""How far [mm] a corner may be from where the part has it, at 1 m."""

_plates: WeakKeyDictionary[Family, Plate | None] = WeakKeyDictionary()


class Dxf(Format):
    """DXF: closed polylines with bulges, outline and holes, of parts that are plates."""

    name = "dxf"
    suffixes = (".dxf",)
    parts = True
    needs = {"ezdxf": "ezdxf"}  # noqa: RUF012
    libraries = ("ezdxf",)
    options = {"release": ("R2010", "R12")}  # noqa: RUF012

    def takes(self, family: Family) -> bool:
        """Whether the part is cut from plate or glass."""
        return _plate_of(family) is not None

    def write_part(self, path: Path, part: Part, about: Provenance) -> None:
        """Outline and holes on CUT, the number on ENGRAVE or MARK, a smaller face on DETAIL."""
        flat = _plate_of(part.family)
        assert flat is not None
        layer = MARK if part.kind.finish == "glass" else ENGRAVE
        lines = engraved(flat, part.number)
        text = dxf_text(flat, self.option(about, "release"), lines, layer)
        path.write_text(text, "ascii", newline="\r\n")

    def check_part(self, path: Path, part: Part) -> list[Check]:
        """Read back: the part's outlines, closed; area times thickness gives its volume."""
        flat = _plate_of(part.family)
        try:
            every = read_dxf(path)
        except InputError as error:
            return [Check("dxf readable", False, str(error))]
        assert flat is not None
        drawn = [one for one in every if one.layer not in (ENGRAVE, MARK)]
        marks = [one for one in every if one.layer in (ENGRAVE, MARK)]
        size = np.abs(flat.loops[0].points).max()
        sound = all(not one.closed and np.abs(one.loop.points).max() < size for one in marks)
        wanted = [(CUT, loop) for loop in flat.loops] + [(DETAIL, loop) for loop in flat.other]
        checks = [
            Check("dxf readable", True),
            Check("dxf marks", sound, float(len(marks))),
            Check("dxf outlines", len(drawn) == len(wanted), float(len(drawn)), float(len(wanted))),
        ]
        if len(drawn) == len(wanted):
            away = max(_away(have, *want) for have, want in zip(drawn, wanted, strict=True))
            size = max(float(np.abs(loop.points).max()) for loop in flat.loops)
            limit = PLACED * max(1.0, size / 1000.0)
            checks.append(Check("dxf corners_mm", away <= limit, away, limit))
        if not flat.other:
            area = section_area([one.loop for one in drawn if one.layer == CUT])
            found = area * flat.thickness * flat.count + flat.rest
            volume = part.properties.volume
            off = abs(found - volume) / volume
            checks.append(Check("dxf volume", off <= PLACED, off, PLACED))
        return checks

    def whole_files(self, contents: Contents) -> list[str]:
        """Glass on stock, where panes are nested."""
        return [NESTED] if NESTING in contents.tables else []

    def write_whole(self, folder: Path, whole: Whole) -> list[str]:
        """All sheets of stock with their panes, 1:1."""
        if NESTING in (whole.tables or {}):
            drawn = nested_lines(stock_sheets(whole))
            text = lines_text(drawn, self.option(whole.about, "release"), NESTED_LAYERS)
            (folder / NESTED).write_text(text, "ascii", newline="\r\n")
        return []

    def check_whole(self, folder: Path, whole: Whole) -> list[Check]:
        """Read back: every line of the sheets of stock is there, those to be cut are closed."""
        if NESTING not in (whole.tables or {}):
            return []
        try:
            found = read_dxf(folder / NESTED)
        except InputError as error:
            return [Check("dxf of nesting readable", False, str(error))]
        have = [(one.layer, len(one.loop.points), one.closed) for one in found]
        lines = nested_lines(stock_sheets(whole))
        want = [(layer, len(loop.points), closed) for layer, loop, closed in lines]
        return [Check("dxf of nesting complete", have == want, float(len(have)), float(len(want)))]

    def inspect(self, path: Path) -> FileReport:
        """Closed polylines by layer; open ones on CUT are a problem."""
        drawn = read_dxf(path)
        problems = [
            f"polyline {k} on {CUT} is open"
            for k, one in enumerate(drawn, start=1)
            if one.layer == CUT and not one.closed
        ]
        layers = ", ".join(
            f"{sum(one.layer == layer for one in drawn)} on {clipped(layer)}"
            for layer in sorted({one.layer for one in drawn})
        )
        count = f"{len(drawn)} polyline{'s' if len(drawn) != 1 else ''}"
        contents = f"{count} ({layers})" if drawn else "no polylines"
        return FileReport(str(path), "DXF", contents, tuple(problems))


FORMAT: Final = Dxf()


def _away(have: Polyline, layer: str, loop: Loop) -> float:
    """Greatest distance [mm] of corners, and difference of bulges; infinite where it is another."""
    if have.layer != layer or not have.closed or len(have.loop.points) != len(loop.points):
        return math.inf
    corners = float(np.abs(have.loop.points - loop.points).max())
    return max(corners, float(np.abs(have.loop.bulges - loop.bulges).max()))


def _plate_of(family: Family) -> Plate | None:
    """The plate that a part number is, found once."""
    if family not in _plates and isinstance(family.shape, OfPlates):
        _plates[family] = family.shape.plate()
    elif family not in _plates:
        boundary = None
        if family.kind.ifc != "IfcMechanicalFastener":  # bought, not cut
            with suppress(DdgError):  # an impossible shape is named where it is made
                boundary = boundary_of(family.shape)
        sheet = family.kind.form == "sheet"
        _plates[family] = None if boundary is None else plate(boundary, bevelled=sheet)
    return _plates[family]

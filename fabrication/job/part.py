"""One part number at a time: mesh, volumes, files, read back. Runs in any process."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from ddgfab.errors import DdgError
from fabrication.checks.crossing import crossings
from fabrication.checks.mesh import check_mesh
from fabrication.formats.base import Format, Material, Part, Provenance
from fabrication.solids import realise, second_volume_of
from fabrication.specs import Check, Family

VOLUME_RELATIVE: Final = 1e-9
"""How far the closed forms of a volume may differ: from the boundary, and from the numbers."""

PARTS: Final = "parts"
"""Folder, inside the output folder, of the parts: a folder a format, named by it."""


@dataclass(frozen=True)
class Shop:
    """What all parts of a job share: folder of the job, formats that write parts, chord [mm]."""

    folder: Path
    formats: tuple[Format, ...]
    about: Provenance
    chord: float

    def files(self, family: Family) -> list[tuple[Format, Path]]:
        """The files of a part number, in the formats that take it."""
        return [
            (format, self.folder / PARTS / format.name / f"{family.number}{format.suffixes[0]}")
            for format in self.formats
            if format.takes(family)
        ]


@dataclass(frozen=True, eq=False)
class Made:
    """A part number made: the part, its checks so far, seconds by step."""

    part: Part
    checks: tuple[Check, ...]
    seconds: dict[str, float]


def make_parts(orders: Sequence[tuple[Family, Material]], shop: Shop) -> list[Made]:
    """Make a batch of part numbers; see `make_part`."""
    return [make_part(family, material, shop) for family, material in orders]


def make_part(family: Family, material: Material, shop: Shop) -> Made:
    """Mesh, its checks, and the files of one part number.

    The CAD kernel is loaded only where the shape has no exact boundary.

    Raises
    ------
    DdgError
        The part cannot be made at all; the message begins with its number.
    """
    begin = time.perf_counter()
    try:
        made = realise(family.shape, shop.chord, solid=False)
    except DdgError as error:
        raise type(error)(f"{family.number}: {error}") from error
    built = time.perf_counter()
    volume, again = made.properties.volume, second_volume_of(family.shape)
    deviation = abs(again - volume) / volume if volume > 0 else math.inf
    checks = [
        Check("volume two ways", deviation <= VOLUME_RELATIVE, deviation, VOLUME_RELATIVE),
        *check_mesh(
            made.mesh,
            volume=volume,
            area=made.properties.area,
            chord=shop.chord,
            genus=made.genus,
            self_crossing=False,  # read back, with the file
        ),
    ]
    checked = time.perf_counter()
    part = Part.of(family, made, material)
    for format, path in shop.files(part.family):
        format.write_part(path, part, shop.about)
    seconds = {
        "part build": built - begin,
        "part check": checked - built,
        "part write": time.perf_counter() - checked,
    }
    return Made(part, tuple(checks), seconds)


def read_back(parts: Sequence[Part], shop: Shop) -> tuple[dict[str, list[Check]], float]:
    """Read files back and look closer at the meshes: checks by number, and the seconds it took."""
    begin = time.perf_counter()
    found: dict[str, list[Check]] = {}
    for part in parts:
        crossing = float(len(crossings(part.mesh)))
        found[part.number] = [Check("mesh crossings", crossing == 0, crossing, 0.0)]
        for format, path in shop.files(part.family):
            found[part.number] += format.check_part(path, part)
        part.release()
    return found, time.perf_counter() - begin

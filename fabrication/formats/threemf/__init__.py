"""3MF: parts as named, colored meshes, and the print plates of what is printed."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Final

from fabrication.formats.base import Contents, Format, Part, Provenance, Standing, Whole
from fabrication.formats.solids import SolidsReport, mesh_report
from fabrication.formats.threemf.bores import bore_walls
from fabrication.formats.threemf.read import Content3MF, check_threemf, read_threemf
from fabrication.formats.threemf.write import Body3MF, Item3MF, threemf_bytes, write_threemf
from fabrication.specs import Check

__all__ = [
    "FORMAT",
    "Body3MF",
    "Content3MF",
    "Item3MF",
    "ThreeMF",
    "check_threemf",
    "read_threemf",
    "threemf_bytes",
    "write_threemf",
]

PLATES: Final = "plates"
"""Folder of the print plates."""


def plate_file(place: int) -> str:
    """Path of a print plate below the output folder; plates count from 1."""
    return f"{PLATES}/plate_{place}.3mf"


class ThreeMF(Format):
    """3MF: a file a part number, and plates/plate_1.3mf, ... where the product is printed.

    Pieces that failed are on no plate.
    """

    name = "3mf"
    suffixes = (".3mf",)
    parts = True
    by_default = "printed"
    needs_to_check = {"lib3mf": "lib3mf"}  # noqa: RUF012
    libraries = ("lib3mf",)

    def write_part(self, path: Path, part: Part, about: Provenance) -> None:
        """One object."""
        body = Body3MF(part.number, part.mesh, part.kind.color)
        path.write_bytes(threemf_bytes([body], title=part.number))

    def check_part(self, path: Path, part: Part) -> list[Check]:
        """Read back and compared; see `check_threemf`."""
        return check_threemf(path, [(part.number, part.mesh, 1)])

    def whole_files(self, contents: Contents) -> list[str]:
        """The print plates."""
        return [plate_file(place) for place in range(1, contents.plates + 1)]

    def write_whole(self, folder: Path, whole: Whole) -> list[str]:
        """The print plates: an object a part number, an item a piece; no support in bores."""
        for path, used, plate in self._plates(folder, whole):
            if not plate:
                path.unlink(missing_ok=True)
                continue
            path.parent.mkdir(parents=True, exist_ok=True)
            parts = [whole.parts[number] for number in used]
            bodies = [_printed(part) for part in parts]
            items = [Item3MF(used.index(number), mark, at) for number, mark, at in plate]
            path.write_bytes(threemf_bytes(bodies, items, path.stem))
        return []

    def check_whole(self, folder: Path, whole: Whole) -> list[Check]:
        """The plates read back and compared."""
        checks = []
        for path, used, plate in self._plates(folder, whole):
            if not plate:
                continue
            counts = [sum(number == other for other, _, _ in plate) for number in used]
            expected = [
                (number, whole.parts[number].mesh, count)
                for number, count in zip(used, counts, strict=True)
            ]
            checks += [
                Check(f"{path.stem} {c.name}", c.passed, c.value, c.limit)
                for c in check_threemf(path, expected)
            ]
        return checks

    def _plates(
        self, folder: Path, whole: Whole
    ) -> Iterator[tuple[Path, list[str], list[Standing]]]:
        """Path of each plate, its part numbers in their order, and what stands on it."""
        for place, standing in enumerate(whole.plates, 1):
            plate = [piece for piece in standing if piece[1] not in whole.failed]
            used = list(dict.fromkeys(number for number, _, _ in plate))
            yield folder / plate_file(place), used, plate

    def inspect(self, path: Path) -> SolidsReport:
        """Its meshes, and what they share where the build places them."""
        content = read_threemf(path)
        found = [
            (body.name, placed, body.mesh)
            for body, placed in zip(content.bodies, content.placed, strict=True)
        ]
        return mesh_report(path, "3MF", content.unit, found, content.items)


def _printed(part: Part) -> Body3MF:
    """A part for a print plate, the walls of its bores marked."""
    boundary = part.boundary
    walls = None if boundary is None else bore_walls(boundary, part.mesh)
    return Body3MF(part.number, part.mesh, part.kind.color, walls)


FORMAT: Final = ThreeMF()

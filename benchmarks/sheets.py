"""Sheets and cut files: processor seconds of all sheets, DXF of sheets and DXF of plates.

    python benchmarks/sheets.py [PROJECT OR MESH]

Without an argument the built-in canopy. Everything in one process; parts are made before.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from fabrication import design
from fabrication.formats.base import Part, Whole
from fabrication.formats.registry import find
from fabrication.formats.sheets import sheets_of_whole
from fabrication.solids import realise


def made(source: str | None) -> Whole:
    """A structure with its parts, without files."""
    product = design(source).product()
    parts = {
        family.number: Part.of(
            family,
            realise(family.shape, product.chord, solid=False),
            product.material(family),
        )
        for family in product.families
    }
    tables = product.schedules({number: part.mass for number, part in parts.items()})
    rows = {name: table.rows for name, table in tables.items()}
    return Whole(product.about(), parts, product.placed, product.shown, tables=rows)


def timed(name: str, work: Callable[[], object]) -> None:
    """Print the processor seconds of some work."""
    begin = time.process_time()
    work()
    print(f"{name:28s} {time.process_time() - begin:6.2f} s")


def main() -> None:
    """Measure and print."""
    whole = made(sys.argv[1] if len(sys.argv) > 1 else None)
    print(f"{len(whole.parts)} part numbers")
    sheets, dxf = find("sheets"), find("dxf")

    def adds() -> None:
        total = 0
        for k in range(10_000_000):
            total += k

    timed("10 million additions", adds)
    with tempfile.TemporaryDirectory() as folder:
        timed("sheets as data", lambda: list(sheets_of_whole(whole)))
        timed("sheets, all PDF", lambda: sheets.write_whole(Path(folder), whole))
        both = replace(whole, about=replace(whole.about, options={"sheets": {"dxf": "R2010"}}))
        timed("the same, and as DXF", lambda: sheets.write_whole(Path(folder), both))

        def plates() -> None:
            for part in whole.parts.values():
                if dxf.takes(part.family):
                    dxf.write_part(Path(folder) / f"{part.number}.dxf", part, whole.about)

        timed("DXF of plates, 1:1", plates)


if __name__ == "__main__":
    main()

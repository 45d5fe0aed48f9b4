"""Sheets as PDF: overviews, erection, and a dimensioned drawing of every part number.

A file a group, and one of all.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Final

from fabrication.drawings.dxf import ansi, encoding, sheets_dxf
from fabrication.drawings.pdf import Page, missing, page_of, pdf_bytes
from fabrication.drawings.sheet import Sheet
from fabrication.formats.base import Contents, Format, Whole
from fabrication.formats.nested import NESTING
from fabrication.formats.sheets.nesting import GLASS_ON_STOCK, nesting_sheets
from fabrication.formats.sheets.overview import (
    ERECTION,
    OVERVIEW,
    erection_sheets,
    overview_sheets,
)
from fabrication.formats.sheets.parts import is_drawn, sheets_of_parts
from fabrication.specs import Check, Family

SHEETS: Final = "sheets"
"""Folder of the sheets."""

PLANS: Final = (OVERVIEW, ERECTION, GLASS_ON_STOCK)
"""Groups of sheets that are not about one part number."""

SHOWN: Final = 5
"""So many characters are named that a file cannot show."""

ALL: Final = "all"
"""Name of the file of all sheets."""


class Sheets(Format):
    """Sheets of parts as PDF: sheets/ROLE.pdf and sheets/all.pdf."""

    name = "sheets"
    suffixes = (".pdf",)
    needs = {"reportlab": "reportlab"}  # noqa: RUF012
    libraries = ("reportlab", "ezdxf")
    options = {"dxf": ("none", "R2010", "R12")}  # noqa: RUF012

    def whole_files(self, contents: Contents) -> list[str]:
        """A file a group of sheets, and one of all."""
        names = [*groups(contents.families, contents.tables), ALL]
        dxf: list[str] = []
        if self.option(contents.about, "dxf") != "none":
            dxf = [name for name in names if name in map(str.lower, PLANS)]
            dxf += [family.number for family in contents.families if is_drawn(family)]
        return [*map(path_of, names), *map(dxf_of, dxf)]

    def write_whole(self, folder: Path, whole: Whole) -> list[str]:
        """Every page is made once, and goes into two files; DXF where the project wants it."""
        (folder / SHEETS).mkdir(exist_ok=True)
        pages: dict[str, list[Page]] = {}
        release = self.option(whole.about, "dxf")
        drawn: dict[str, list[Sheet]] = {}
        for group, sheet in sheets_of_whole(whole):
            pages.setdefault(group, []).append(page_of(sheet, group))
            if release != "none":
                drawn.setdefault(group.lower() if group in PLANS else sheet.subject, []).append(
                    sheet
                )
        for subject, sheets in drawn.items():
            path = folder / dxf_of(subject)
            path.parent.mkdir(exist_ok=True)
            text = sheets_dxf(sheets, release)
            path.write_text(text, encoding(release), newline="\r\n")
        title = whole.about.title
        for group, own in pages.items():
            data = pdf_bytes(own, f"{title.title}: {group}", title.author, title.number)
            (folder / path_of(group.lower())).write_bytes(data)
        every = [page for own in pages.values() for page in own]
        data = pdf_bytes(every, title.title, title.author, title.number)
        (folder / path_of(ALL)).write_bytes(data)
        return list(_unprinted(every, drawn if release == "R12" else {}))

    def check_whole(self, folder: Path, whole: Whole) -> list[Check]:
        """That the files are there and end as PDF does."""
        families = [part.family for part in whole.parts.values()]
        checks = []
        for name in [*groups(families, list(whole.tables or ())), ALL]:
            checks.append(Check(f"sheets {name} complete", is_complete(folder / path_of(name))))
        return checks


FORMAT: Final = Sheets()


def _unprinted(pages: Sequence[Page], drawn: Mapping[str, Sequence[Sheet]]) -> Iterator[str]:
    """Which characters the files do not show."""
    lost: dict[str, set[str]] = {"PDF": set(), "DXF of R12": set()}
    for page in pages:
        for text in page.others:
            lost["PDF"] |= missing(text.text)
            if drawn:
                lost["DXF of R12"] |= {c for c in text.text if ansi(c) == "?" != c}
    for what, characters in lost.items():
        if characters:
            shown = sorted(characters)[:SHOWN]
            names = ", ".join(f"{c} (U+{ord(c):04X})" for c in shown)
            more = f" and {len(characters) - SHOWN} more" if len(characters) > SHOWN else ""
            yield f'sheets as {what}: no letters for {names}{more}, shown as "?"'


def is_complete(path: Path) -> bool:
    """Whether a file is there, begins as PDF does, and ends as it does."""
    if not path.is_file():
        return False
    with path.open("rb") as stream:
        begin = stream.read(5)
        stream.seek(max(0, path.stat().st_size - 64))
        return begin == b"%PDF-" and stream.read().rstrip().endswith(b"%%EOF")


def path_of(name: str) -> str:
    """Path below the output folder of a file of sheets."""
    return f"{SHEETS}/{name.replace(' ', '-')}.pdf"


def dxf_of(name: str) -> str:
    """Path below the output folder of the sheets of a part number, or of plans, as DXF."""
    return f"{SHEETS}/dxf/{name}.dxf"


def groups(families: Sequence[Family], tables: Sequence[str]) -> list[str]:
    """Names of the files of sheets, in order: overviews of what is built, and groups of parts."""
    found: list[str] = []
    if has_plans(families):
        found.append(OVERVIEW.lower())
        if {"beams", "nodes"} <= set(tables):
            found.append(ERECTION.lower())
    if NESTING in tables:
        found.append(GLASS_ON_STOCK.lower())
    found += [family.kind.title.lower() for family in families if is_drawn(family)]
    return list(dict.fromkeys(found))


def has_plans(families: Sequence[Family]) -> bool:
    """Whether a structure is of bars or sheets, which plans show."""
    return any(family.kind.form in ("bar", "sheet") for family in families)


def sheets_of_whole(whole: Whole) -> Iterator[tuple[str, Sheet]]:
    """Group and sheet: overviews, erection, and every part number."""
    if has_plans([part.family for part in whole.parts.values()]):
        yield from overview_sheets(whole)
        if {"beams", "nodes"} <= set(whole.tables or ()):
            yield from erection_sheets(whole)
    if NESTING in (whole.tables or {}):
        yield from nesting_sheets(whole)
    yield from sheets_of_parts(whole)

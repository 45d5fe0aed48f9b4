"""Sheets: dimensioned drawings of every part number, as PDF; a file a role and one of all."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

from fabrication.drawings.pdf import Page, page_of, pdf_bytes
from fabrication.formats.base import Contents, Format, Whole
from fabrication.formats.sheets.parts import is_drawn, sheets_of_parts
from fabrication.specs import Check, Family

SHEETS: Final = "sheets"
"""Folder of the sheets."""

ALL: Final = "all"
"""Name of the file of all sheets."""


class Sheets(Format):
    """Sheets of parts as PDF: sheets/ROLE.pdf and sheets/all.pdf."""

    name = "sheets"
    suffixes = (".pdf",)
    needs = {"reportlab": "reportlab"}  # noqa: RUF012
    libraries = ("reportlab",)

    def whole_files(self, contents: Contents) -> list[str]:
        """A file a group of parts, and one of all."""
        return [path_of(name) for name in [*groups(contents.families), ALL]]

    def write_whole(self, folder: Path, whole: Whole) -> list[str]:
        """Every page is made once, and goes into two files."""
        (folder / SHEETS).mkdir(exist_ok=True)
        pages: dict[str, list[Page]] = {}
        for group, sheet in sheets_of_parts(whole):
            pages.setdefault(group, []).append(page_of(sheet, group))
        title = whole.about.title
        for group, own in pages.items():
            data = pdf_bytes(own, f"{title.title}: {group}", title.author, title.number)
            (folder / path_of(group.lower())).write_bytes(data)
        every = [page for own in pages.values() for page in own]
        data = pdf_bytes(every, title.title, title.author, title.number)
        (folder / path_of(ALL)).write_bytes(data)
        return []

    def check_whole(self, folder: Path, whole: Whole) -> list[Check]:
        """That the files are there and end as PDF does."""
        families = [part.family for part in whole.parts.values()]
        checks = []
        for name in [*groups(families), ALL]:
            data = (folder / path_of(name)).read_bytes()
            complete = data.startswith(b"%PDF-") and data.rstrip().endswith(b"%%EOF")
            checks.append(Check(f"sheets {name} complete", complete))
        return checks


FORMAT: Final = Sheets()


def path_of(name: str) -> str:
    """Path below the output folder of a file of sheets."""
    return f"{SHEETS}/{name}.pdf"


def groups(families: Sequence[Family]) -> list[str]:
    """Names of the files of parts: their groups, in order."""

    def titles() -> Iterator[str]:
        yield from (family.kind.title.lower() for family in families if is_drawn(family))

    return list(dict.fromkeys(titles()))

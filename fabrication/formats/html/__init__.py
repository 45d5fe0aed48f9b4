"""HTML: report.html, the model, its checks and its schedules in one file that needs no network."""

from __future__ import annotations

import html
import json
import re
from importlib.resources import files
from pathlib import Path
from typing import Any, Final

from ddgfab.io.atomic import atomic_path
from fabrication.formats.base import Contents, Format, Whole
from fabrication.formats.html.model import model_of, packed, pieces_of
from fabrication.formats.html.page import Subject
from fabrication.formats.html.tables import tables_of
from fabrication.specs import Check

REPORT: Final = "report.html"
"""Name of the file."""

SCRIPTS: Final = ("model", "view", "draw", "panel", "tables", "paper", "start")
"""Parts of the program of the page, in order."""

DATA: Final = re.compile(r'<script id="(\w+)" type="text/plain">([^<]*)</script>')
"""Where the page holds its data."""


class Html(Format):
    """HTML: report.html.

    Parameters
    ----------
    subject : what the product tells of itself
    """

    name = "html"
    suffixes = (".html",)
    report = True
    by_default = "always"

    def __init__(self, subject: Subject | None = None) -> None:
        self.subject = subject or Subject()

    def whole_files(self, contents: Contents) -> list[str]:
        """report.html."""
        return [REPORT]

    def write_whole(self, folder: Path, whole: Whole) -> list[str]:
        """See `page_html`."""
        text = page_html(whole, self.subject, folder)
        with atomic_path(folder / REPORT) as temporary:
            temporary.write_bytes(text.encode("utf-8"))
        return []

    def check_whole(self, folder: Path, whole: Whole) -> list[Check]:
        """Read back: every piece once, as many rows as schedules have, and a line a problem."""
        text = (folder / REPORT).read_text(encoding="utf-8")
        content = json.loads(page_data(text)["content"])
        marks = sorted(i.mark for family in whole.shown for i in family.instances)
        rows = sum(map(len, (whole.tables or {}).values()))
        found = sum(len(table["rows"]) for table in content["tables"])
        lines = text.count('<li class="bad">')
        return [
            Check("html pieces", sorted(piece[0] for piece in content["pieces"]) == marks),
            Check("html rows", found == rows, float(found), float(rows)),
            Check("html problems", lines == len(whole.problems), float(lines), len(whole.problems)),
        ]


FORMAT: Final = Html()


def page_html(whole: Whole, subject: Subject, folder: Path) -> str:
    """One HTML file with everything in it: program, model and schedules, compressed.

    Parameters
    ----------
    whole : with its problems and checks
    folder : whose part files the page links to
    """
    data, numbers = model_of(whole, subject, folder)
    places = pieces_of(whole.shown)
    data["tables"] = tables_of(whole, subject, places)
    data["steps"] = [
        {
            "title": step.title,
            "group": step.group,
            "pieces": [places[m] for m in step.marks if m in places],
        }
        for step in subject.steps(whole)
    ]
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":"))
    fields = {
        "title": html.escape(subject.title or whole.about.project),
        "lead": html.escape(subject.lead),
        "facts": _facts(whole, subject),
        "problems": "".join(
            f'<li class="bad">FAILED {html.escape(p)}</li>' for p in whole.problems
        ),
        "notes": "".join(f"<li>{html.escape(note)}</li>" for note in subject.notes),
        "state": state(whole),
        "style": asset("page.css"),
        "three": asset("three.js"),
        "content": packed(text.encode("utf-8")),
        "numbers": packed(numbers),
        "program": "\n".join(asset(f"{name}.js") for name in SCRIPTS),
    }
    return re.sub(r"\{\{(\w+)\}\}", lambda found: fields[found[1]], asset("page.html"))


def page_data(text: str) -> dict[str, bytes]:
    """The data of a page, by name: content (JSON) and numbers."""
    import base64
    import zlib

    return {name: zlib.decompress(base64.b64decode(data)) for name, data in DATA.findall(text)}


def state(whole: Whole) -> str:
    """Whether all checks passed, as a sentence."""
    failed = len(whole.failed)
    if not whole.problems:
        return "all checks passed"
    pieces = f"; {failed} piece{'s' if failed > 1 else ''} rejected" if failed else ""
    return f"{len(whole.problems)} problem{'s' if len(whole.problems) > 1 else ''}{pieces}"


def _facts(whole: Whole, subject: Subject) -> str:
    """Names and values: title block, the product's own, and totals by kind."""
    title = whole.about.title
    known: list[tuple[str, Any]] = [
        ("project", title.title or whole.about.project),
        ("number", title.number),
        ("revision", title.revision),
        ("date", title.date),
        ("client", title.client),
        ("author", title.author),
        *subject.facts,
        *_totals(whole),
        *(("coordinates", remark) for remark in whole.about.remarks),
    ]
    return "".join(
        f"<dt>{html.escape(name)}</dt><dd>{html.escape(str(value))}</dd>"
        for name, value in known
        if value
    )


def _totals(whole: Whole) -> list[tuple[str, str]]:
    """Pieces, part numbers and mass of each kind."""
    found: dict[str, tuple[int, int, float]] = {}
    for family in whole.families:
        pieces, numbers, mass = found.get(family.kind.title, (0, 0, 0.0))
        count = len(family.instances)
        mass += count * whole.parts[family.number].mass
        found[family.kind.title] = (pieces + count, numbers + 1, mass)
    return [
        (
            name.lower(),
            f"{pieces} of {numbers} part number{'s' if numbers > 1 else ''}, "
            + (f"{mass:,.1f} kg" if mass >= 1.0 else f"{1000 * mass:.1f} g"),
        )
        for name, (pieces, numbers, mass) in found.items()
    ]


def asset(name: str) -> str:
    """A file of the page's program."""
    return files(__package__).joinpath("assets", name).read_text(encoding="utf-8")

"""report.html: the mechanism under a slider, its range and its schedules, in one file offline."""

from __future__ import annotations

import base64
import html
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Any, Final

import numpy as np

from ddgfab.errors import OutputError
from ddgfab.io.atomic import atomic_path
from ddgfab.mesh import Floats
from fabrication.formats.base import Contents, Format, Whole
from fabrication.formats.tables import decimals
from fabrication.specs import Check, TriangleMesh
from fabrication.table import Table

REPORT: Final = "report.html"
"""Name of the file."""

AIR: Final = 0.03
"""Room left around the moving model, as a part of its size."""


EXACT: Final = "_exact"
"""Columns whose names hold this are for machines; the page leaves them out."""


@dataclass(frozen=True, eq=False)
class MovingPiece:
    """A piece that moves: positions of its body and group, the text shown on hover, its mark."""

    body: int
    group: int
    text: str
    mark: str = ""


@dataclass(frozen=True)
class Group:
    """Pieces that are shown and hidden together: name and color (sRGB, 0 to 1)."""

    name: str
    color: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class ContactNote:
    """A contact in a pose: position among the poses, point (3,) [mm], text."""

    pose: int
    at: Floats
    text: str


@dataclass(frozen=True, eq=False)
class MovingScene:
    """A mechanism as the page shows it.

    bodies : meshes [mm], each once
    pieces : what moves
    motions : (T, n, 4, 4) placements of the n pieces in T poses
    driver, values_deg : name of the parameter, and its values (T,)
    design : position of the design pose among the poses
    """

    bodies: Sequence[TriangleMesh]
    groups: Sequence[Group]
    pieces: Sequence[MovingPiece]
    motions: Floats
    driver: str
    values_deg: Floats
    design: int
    touches: Sequence[ContactNote] = ()


@dataclass(frozen=True, eq=False)
class Page:
    """Title, a sentence below it, facts (name, value), notes, and tables by heading."""

    title: str
    lead: str
    facts: Sequence[tuple[str, str]]
    notes: Sequence[str]
    problems: Sequence[str]
    tables: Mapping[str, Table]


class Html(Format):
    """HTML: report.html, the scene under a slider beside facts, problems and schedules.

    Parameters
    ----------
    page : makes the page of schedules by name and of lines that name what failed
    """

    name = "html"
    suffixes = (".html",)
    report = True
    needs = {"plotly": "plotly"}  # noqa: RUF012
    libraries = ("plotly",)

    def __init__(
        self, scene: MovingScene, page: Callable[[Mapping[str, Table], Sequence[str]], Page]
    ) -> None:
        self.scene, self.page = scene, page

    def whole_files(self, contents: Contents) -> list[str]:
        """report.html."""
        return [REPORT]

    def write_whole(self, folder: Path, whole: Whole) -> list[str]:
        """See `page_html`."""
        tables = {
            name: Table(rows, name, whole.legends.get(name))
            for name, rows in (whole.tables or {}).items()
        }
        write_page(folder / REPORT, self.page(tables, whole.problems), self.scene)
        return []

    def check_whole(self, folder: Path, whole: Whole) -> list[Check]:
        """Read back: a heading and as many rows as schedules have, and a line a problem."""
        text = (folder / REPORT).read_text(encoding="utf-8")
        rows = sum(len(table) + 1 for table in (whole.tables or {}).values())
        found, lines = text.count("<tr>"), text.count('<p class="bad">')
        return [
            Check("html rows", found == rows, float(found), float(rows)),
            Check("html problems", lines == len(whole.problems), float(lines), len(whole.problems)),
        ]


def write_page(path: Path, page: Page, scene: MovingScene) -> None:
    """Write the page (atomically); see `page_html`.

    Raises
    ------
    OutputError
        The file cannot be written, or plotly is not installed.
    """
    text = page_html(page, scene)
    with atomic_path(path) as temporary:
        temporary.write_bytes(text.encode("utf-8"))


def page_html(page: Page, scene: MovingScene) -> str:
    """One HTML file with everything in it: meshes once, a placement a piece and pose, plotly.

    Raises
    ------
    OutputError
        plotly is not installed.
    """
    try:
        from plotly.offline import get_plotlyjs
    except ImportError as error:
        raise OutputError(f"report.html needs plotly: pip install plotly ({error})") from error
    template = Template(files(__package__).joinpath("page.html").read_text(encoding="utf-8"))
    return template.substitute(
        title=html.escape(page.title),
        lead=html.escape(page.lead),
        driver=html.escape(scene.driver),
        sections=_sections(page),
        plotly=get_plotlyjs(),
        # A "<" inside the data could end the element that holds it.
        scene=json.dumps(_scene(scene), ensure_ascii=False).replace("<", "\\u003c"),
    )


def _scene(scene: MovingScene) -> dict[str, Any]:
    """The scene as JSON; arrays of numbers as base64 of little-endian single precision."""
    return {
        "bodies": [
            {
                "points": _base64(body.vertices.astype("<f4")),
                "triangles": _base64(body.triangles.astype("<u4")),
            }
            for body in scene.bodies
        ],
        "groups": [{"name": group.name, "color": _css(group.color)} for group in scene.groups],
        "instances": [
            {"body": piece.body, "group": piece.group, "text": piece.text} for piece in scene.pieces
        ],
        "motions": _base64(scene.motions[:, :, :3].astype("<f4")),
        "driver": scene.driver,
        "values": np.round(scene.values_deg, 4).tolist(),
        "design": scene.design,
        "start": scene.design,
        "range": _range(scene).tolist(),
        "contacts": [
            {"pose": touch.pose, "at": np.round(touch.at, 3).tolist(), "text": touch.text}
            for touch in scene.touches
        ],
    }


def _range(scene: MovingScene) -> Floats:
    """(3, 2) box [mm] in which the model stays in all poses, with some air."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    corners = [
        np.stack(np.meshgrid(*zip(*_box(body), strict=True), indexing="ij"), -1).reshape(-1, 3)
        for body in scene.bodies
    ]
    for n, piece in enumerate(scene.pieces):
        turn, shift = scene.motions[:, n, :3, :3], scene.motions[:, n, :3, 3]
        points = np.einsum("tij,kj->tki", turn, corners[piece.body]) + shift[:, None]
        low = np.minimum(low, points.min(axis=(0, 1)))
        high = np.maximum(high, points.max(axis=(0, 1)))
    air = AIR * float((high - low).max())
    return np.asarray(np.round(np.stack([low - air, high + air], axis=1), 2), dtype=np.float64)


def _box(body: TriangleMesh) -> tuple[Floats, Floats]:
    return body.vertices.min(axis=0), body.vertices.max(axis=0)


def _base64(values: np.ndarray[Any, Any]) -> str:
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode("ascii")


def _css(color: tuple[float, float, float]) -> str:
    return "#" + "".join(f"{round(255 * channel):02x}" for channel in color)


# --- tables --------------------------------------------------------------------------------------
def _sections(page: Page) -> str:
    """Facts, problems, notes and tables."""
    facts = "".join(
        f"<dt>{html.escape(name)}</dt><dd>{html.escape(value)}</dd>" for name, value in page.facts
    )
    parts = [f'<h2>Motion</h2><div class="card"><dl>{facts}</dl></div>']
    remarks = [f'<p class="bad">{html.escape(problem)}</p>' for problem in page.problems]
    remarks += [f"<p>{html.escape(note)}</p>" for note in page.notes]
    if remarks:
        parts.append(f'<h2>Notes</h2><div class="card">{"".join(remarks)}</div>')
    for heading, table in page.tables.items():
        parts.append(f"<h2>{html.escape(heading)}</h2>{_table(table)}")
    return "\n".join(parts)


def _table(table: Table) -> str:
    columns = [name for name in table.columns if EXACT not in name]
    head = "".join(
        f"<th{_side(table, name)}>{html.escape(name.replace('_', ' '))}</th>" for name in columns
    )
    body = "".join(
        "<tr>" + "".join(_cell(row.get(name), name) for name in columns) + "</tr>" for row in table
    )
    return (
        f'<div class="card scroll"><table><thead><tr>{head}</tr></thead>'
        f"<tbody>{body}</tbody></table></div>"
    )


def _side(table: Table, column: str) -> str:
    """Headings of numbers stand above them, on the right."""
    numbers = (
        bool(isinstance(v, int | float) and not isinstance(v, bool)) for v in table.column(column)
    )
    return ' class="n"' if any(numbers) else ""


def _cell(value: Any, column: str) -> str:
    if value is None:
        return "<td></td>"
    if isinstance(value, bool):
        return f"<td>{'yes' if value else 'no'}</td>"
    if isinstance(value, float):
        places = min(decimals(column), 3)
        return f'<td class="n">{round(value, places) + 0.0:.{places}f}</td>'
    if isinstance(value, int):
        return f'<td class="n">{value}</td>'
    return f"<td>{html.escape(str(value))}</td>"

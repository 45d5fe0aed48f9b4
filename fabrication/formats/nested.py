"""Parts where they lie on sheets of stock: what the list "nesting" says, as outlines."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fabrication.formats.base import Part, Whole
from fabrication.solids.plate import plate
from fabrication.specs import Loop

NESTING: Final = "nesting"
"""Name of the list, and of the files that are made of it."""


LEVEL: Final = 1e-6
"""Corners of a face are at one height within this [mm]."""

Outlines: TypeAlias = tuple[tuple[Loop, ...], tuple[Loop, ...]]
"""Of the larger face, and of the other one where that differs."""


@dataclass(frozen=True, eq=False)
class Lying:
    """A part on a sheet: its mark, the outlines of its larger face and of the other one [mm]."""

    mark: str
    loops: tuple[Loop, ...]
    other: tuple[Loop, ...]


@dataclass(frozen=True, eq=False)
class StockSheet:
    """A sheet of stock with its parts.

    title : glass and number of the sheet, "pane 1, 12 mm, sheet 3 of 42"
    width, height : of the stock [mm]
    fill : area of the parts, of that of the stock
    """

    title: str
    width: float
    height: float
    fill: float
    parts: tuple[Lying, ...]


def stock_sheets(whole: Whole) -> list[StockSheet]:
    """The sheets of stock in order; parts that failed are not on them."""
    tables = whole.tables or {}
    rows, glass = tables.get(NESTING, ()), tables.get("glass", ())
    stock = {(row["pane"], row["ply_mm"]): row for row in glass}
    outlines: dict[str, Outlines] = {}
    for family in whole.families:
        part = whole.parts.get(family.number)
        if part is not None and family.kind.form == "sheet":
            own = _outlines(part)
            outlines.update({instance.mark: own for instance in family.instances})
    found: dict[tuple[int, float, int], list[Lying]] = {}
    for row in rows:
        if row["sheet"] is None:
            continue
        lying = found.setdefault((row["pane"], row["ply_mm"], row["sheet"]), [])
        if row["mark"] in outlines and row["mark"] not in whole.failed:
            angle, at = math.radians(row["turn_deg"]), (row["origin_x_mm"], row["origin_y_mm"])
            loops, other = (_moved(loops, angle, at) for loops in outlines[row["mark"]])
            lying.append(Lying(row["mark"], loops, other))
    sheets = []
    for (pane, ply, number), lying in found.items():
        about = stock[pane, ply]
        width, height = float(about["stock_width_mm"]), float(about["stock_height_mm"])
        area = sum(abs(_area(part.loops[0])) for part in lying)
        title = f"pane {pane}, {ply:g} mm, sheet {number} of {about['sheets']}"
        sheets.append(StockSheet(title, width, height, area / (width * height), tuple(lying)))
    return sheets


def _outlines(part: Part) -> Outlines:
    """Outlines of the larger face of a part and of the other one, in its own frame.

    Rounded corners of bevelled panes are ellipses: their outlines are those of the mesh.
    """
    boundary = part.boundary
    flat = None if boundary is None else plate(boundary, bevelled=True)
    if flat is not None:
        return flat.loops, flat.other
    vertices, triangles = part.mesh.vertices, part.mesh.triangles
    both = []
    for level in (vertices[:, 2].min(), vertices[:, 2].max()):
        at = (np.abs(vertices[triangles, 2] - level) < LEVEL).all(axis=1)
        points = vertices[_border(triangles[at])][:, :2]
        both.append(Loop(points, np.zeros(len(points))))
    both.sort(key=lambda loop: -abs(_area(loop)))
    return (both[0],), (both[1],)


def _border(triangles: NDArray[np.int64]) -> list[int]:
    """The corners round a face without holes, in order; its triangles are turned alike."""
    pairs = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2).tolist()
    known = {(a, b) for a, b in pairs}
    after = {a: b for a, b in pairs if (b, a) not in known}
    first = min(after)
    found = [first]
    while after[found[-1]] != first:
        found.append(after[found[-1]])
    low = found.index(min(found))
    return found[low:] + found[:low]


def _moved(loops: Sequence[Loop], angle: float, at: tuple[float, float]) -> tuple[Loop, ...]:
    """Loops turned about the origin, then moved."""
    c, s = math.cos(angle), math.sin(angle)
    turn = np.array([[c, s], [-s, c]])
    return tuple(Loop(loop.points @ turn + np.array(at), loop.bulges) for loop in loops)


def _area(loop: Loop) -> float:
    """Area [mm2] by its corners."""
    x, y = loop.points.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))

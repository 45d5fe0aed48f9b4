"""Glass on stock: how many sheets the panes are cut from, by ply, and where each ply lies."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from ddgfab.errors import ProjectError
from ddgfab.mesh import Floats
from fabrication.formats.tables import Legend
from fabrication.gridshell.part_settings import PanelSettings
from fabrication.gridshell.pieces import Panel
from fabrication.gridshell.project import Project
from fabrication.gridshell.schedules.common import Row
from fabrication.nesting import Nested, Nesting, SheetStock, least_sheets, nest
from fabrication.parts.panel import M2_PER_MM2, PANEL, PanelShape
from fabrication.solids.polygon import least_rectangle_turn
from fabrication.specs import Family
from fabrication.standards.glass import build_up

GLASS: Final = Legend(
    title="Glass to buy",
    about="sheets of stock for the plies of one pane of the build-up: an estimate",
    meanings={
        "pane": "which pane of the build-up, the outermost is 1",
        "ply_mm": "thickness of the glass",
        "plies": "how many plies of this thickness the pane has",
        "stock_width_mm": "larger side of a sheet of stock",
        "stock_height_mm": "smaller side of it",
        "sheets": "how many sheets the plies are nested on",
        "least_sheets": "no nesting needs fewer: area of the rectangles with their gaps, or plies "
        "of which no two fit on a sheet",
        "quantity": "how many plies are cut from them",
        "area_m2": "area of these plies, that of the panes' outer surfaces",
        "rectangles_m2": "area of the least rectangles round them",
        "bought_m2": "area of all these sheets",
        "fill_percent": "area of the plies, of what is bought",
        "larger": "plies that are larger than a sheet of stock less its trim: they are not in the "
        "other columns",
        "basis": "what the numbers are worth",
        "marks": "the panes",
    },
    totals=("sheets", "quantity", "area_m2", "rectangles_m2", "bought_m2"),
    unprinted=("marks",),
)

NESTING: Final = Legend(
    title="Glass on stock",
    about="a ply on a sheet of stock; the sheets can be cut from edge to edge (guillotine)",
    meanings={
        "pane": "which pane of the build-up, the outermost is 1",
        "ply_mm": "thickness of the glass",
        "sheet": "number of the sheet of stock, of this pane and thickness; empty: the ply is "
        "larger than the stock",
        "mark": "piece mark of the pane",
        "x_mm": "from the left edge of the sheet to the least rectangle round the ply",
        "y_mm": "from the lower edge of the sheet to that rectangle",
        "width_mm": "of the rectangle along the larger side of the sheet",
        "height_mm": "of the rectangle along the smaller side",
        "turn_deg": "angle by which the part in its own frame (that of its STEP and DXF) is "
        "turned counterclockwise to lie so, seen from outside",
        "origin_x_mm": "where the origin of the part's own frame is then, from the left edge of "
        "the sheet",
        "origin_y_mm": "the same from the lower edge",
    },
)

ESTIMATE: Final = "estimate: rectangles nested for guillotine cuts by a heuristic; no cutting plan"

Ply = tuple[int, float]
"""Number of a pane of the build-up, and thickness [mm] of a ply."""


def plies_of(panel: PanelSettings) -> dict[Ply, int]:
    """How many plies of which thickness a pane has, from the outside inwards."""
    if not panel.build_up:
        return {(1, panel.thickness_mm): 1}
    panes = enumerate(build_up(panel.build_up).panes, 1)
    return dict(Counter((number, ply) for number, pane in panes for ply in pane.plies))


def glass_rows(families: Sequence[Family], project: Project) -> tuple[list[Row], list[Row]]:
    """Rows of the glass to buy, and of every ply on its sheet; none without panes."""
    pieces = [
        (instance.mark, family.shape.dimensions(), *_lying(family.shape))
        for family in families
        if family.role == PANEL.role and isinstance(family.shape, PanelShape)
        for instance in family.instances
    ]
    pieces.sort(key=lambda piece: piece[0])
    if not pieces:
        return [], []
    stock = project.stock.sheet()
    known: dict[int, Nesting] = {}
    bought: list[Row] = []
    placed: list[Row] = []
    for (pane, thickness), count in plies_of(project.panel).items():
        own = pieces * count
        sizes = [
            (piece[1]["height_mm"], piece[1]["width_mm"]) for piece in own
        ]  # the larger one along x
        if count not in known:
            known[count] = nest(sizes, stock)
        found = known[count]
        ply = {"pane": pane, "ply_mm": thickness}
        for number, sheet in enumerate(found.sheets, 1):
            for place in sheet:
                mark, _, turn, corners = own[place.piece]
                wide, high = sizes[place.piece][:: -1 if place.turned else 1]
                angle = math.degrees(-turn) + (90.0 if place.turned else 0.0)
                at = {"x_mm": place.x, "y_mm": place.y, "width_mm": wide, "height_mm": high}
                origin = _origin(corners, math.radians(angle), place)
                where = {"sheet": number, "mark": mark, **at, "turn_deg": angle, **origin}
                placed.append({**ply, **where})
        for k in found.left:
            size = {"width_mm": sizes[k][0], "height_mm": sizes[k][1], "turn_deg": None}
            none = {"sheet": None, "mark": own[k][0], "x_mm": None, "y_mm": None}
            placed.append({**ply, **none, **size, "origin_x_mm": None, "origin_y_mm": None})
        cut = [place.piece for sheet in found.sheets for place in sheet]
        area = math.fsum(own[k][1]["area_m2"] for k in cut)
        total = len(found.sheets) * stock.width * stock.height * M2_PER_MM2
        bought.append(
            {
                **ply,
                "plies": count,
                "stock_width_mm": stock.width,
                "stock_height_mm": stock.height,
                "sheets": len(found.sheets),
                "least_sheets": least_sheets(sizes, stock),
                "quantity": len(cut),
                "area_m2": area,
                "rectangles_m2": math.fsum(math.prod(sizes[k]) for k in cut) * M2_PER_MM2,
                "bought_m2": total,
                "fill_percent": 100.0 * area / total if total else 0.0,
                "larger": len(found.left),
                "basis": ESTIMATE,
                "marks": " ".join(piece[0] for piece in pieces),
            }
        )
    return bought, placed


def _lying(shape: PanelShape) -> tuple[float, Floats]:
    """Angle [rad] of the larger side of the least rectangle, and (n, 2) corners of both faces."""
    corners = np.concatenate([shape.inner, shape.outer])
    return float(least_rectangle_turn(corners)), corners


def _origin(corners: Floats, angle: float, place: Nested) -> Row:
    """Where the origin of a turned part is, so that its least corner is at a place."""
    c, s = math.cos(angle), math.sin(angle)
    low = (corners @ np.array([[c, s], [-s, c]])).min(axis=0)
    return {"origin_x_mm": place.x - float(low[0]), "origin_y_mm": place.y - float(low[1])}


def beyond_glass(panels: Sequence[Panel], project: Project) -> Iterator[str]:
    """A note where panes are larger than the largest stock.

    Raises
    ------
    ProjectError
        The project sets its stock of glass, and a pane is larger; names it, its size and the limit.
    """
    stock = project.stock.sheet()
    sizes = [(panel.mark, panel.shape.dimensions()) for panel in panels]
    large = [
        (mark, d["width_mm"], d["height_mm"])
        for mark, d in sizes
        if not stock.takes(d["width_mm"], d["height_mm"])
    ]
    if not large:
        return
    mark, small, long = max(large, key=lambda one: (one[1] * one[2], one[0]))
    wide, high = stock.land
    text = (
        f"{mark} takes {small:.1f} x {long:.1f} mm of glass; sheets of {stock.height:g} x "
        f"{stock.width:g} mm less [stock] glass_trim_mm = {stock.trim:g} at each edge have "
        f"{high:g} x {wide:g} mm ({len(large)} of {len(panels)} panes are larger)"
    )
    if not project.stock.glass_is_set:
        yield f"{text}: the estimate of glass leaves them out"
        return
    raise ProjectError(
        f"{text}\n{_advice(large, stock)}", file=None if project.file is None else str(project.file)
    )


def _advice(large: Sequence[tuple[str, float, float]], stock: SheetStock) -> str:
    """The least sheet, in steps of 10 mm, from which all panes can be cut."""
    wide = max(stock.height, max(small for _, small, _ in large) + 2.0 * stock.trim)
    long = max(stock.width, max(long for _, _, long in large) + 2.0 * stock.trim)
    size = ", ".join(f"{math.ceil(side / 10.0) * 10}" for side in (wide, long))
    return f'Cut them from larger sheets (--set "stock.glass_mm=[{size}]") or trim less'

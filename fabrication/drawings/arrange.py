"""Views side by side in first-angle projection, at the largest scale of the series that fits."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np

from fabrication.boundary import Boundary
from fabrication.drawings.placing import GAP, Break, PlacedView, Projected
from fabrication.drawings.projection import Solid, view_axes
from fabrication.drawings.sheet import Point, Rectangle
from fabrication.drawings.views import View
from fabrication.specs import TriangleMesh

SCALES: Final = tuple(
    sorted(
        [n * 10.0**k for k in range(0, 2) for n in (1.0, 2.0, 5.0)]
        + [1.0 / (n * 10.0**k) for k in range(0, 5) for n in (2.0, 5.0, 10.0)],
        reverse=True,
    )
)
"""Scales of ISO 5455, from 50:1 to 1:100000."""

LARGEST: Final = 5.0
"""No part is drawn larger than 5:1."""

BETWEEN: Final = 9.0
"""Room [mm] between views, for the title below each."""

ROOM: Final = 24.0
"""Room [mm] that dimensions take beside a view at least: scales that leave less are not tried."""


def scale_text(scale: float) -> str:
    """A scale as it is written.

    >>> scale_text(0.2), scale_text(5.0), scale_text(1.0)
    ('1:5', '5:1', '1:1')
    """
    return f"{scale:g}:1" if scale > 1.0 else f"1:{round(1.0 / scale):g}"


@dataclass(frozen=True, eq=False)
class Arranged:
    """Views at one scale with where each goes: the shift of its origin, and its rectangle."""

    scale: float
    views: tuple[PlacedView, ...]
    shifts: tuple[Point, ...]
    width: float
    height: float


def project(
    views: Sequence[View], boundary: Boundary | None, mesh: TriangleMesh
) -> list[Projected]:
    """The views of a part, before they have a scale."""
    found = []
    solid = Solid(boundary, mesh)
    for view in views:
        axes = view_axes(view.right, view.up)
        curves = solid.seen(axes, math.inf if view.near is None else view.near)
        flat = mesh.vertices @ axes[:2].T
        if view.near is not None and curves:
            flat = np.concatenate([curve.points for curve in curves])
        low, high = flat.min(axis=0).tolist(), flat.max(axis=0).tolist()
        found.append(Projected(view, axes, curves, (low[0], low[1]), (high[0], high[1])))
    return found


def extent_of(view: Projected) -> float:
    """The smaller of its width and height [mm], in the part's own size."""
    return min(view.high[0] - view.low[0], view.high[1] - view.low[1])


def arrange(projected: Sequence[Projected], width: float, height: float) -> Arranged | None:
    """The views at the largest scale at which they fit into so much room [mm]; None at none."""
    for scale in SCALES:
        if scale > LARGEST:
            continue
        cut = _break(projected, scale, width)
        if not _may_fit(projected, scale, cut, width, height):
            continue
        views = tuple(_filled(one, scale, cut) for one in projected)
        arranged = _grid(scale, views)
        if arranged.width <= width and arranged.height <= height:
            return arranged
    return None


def _filled(projected: Projected, scale: float, cut: Break | None) -> PlacedView:
    view = PlacedView(projected, scale, cut if projected.view.breaks else None)
    view.center_lines()
    for measure in projected.view.measures:
        measure.place(view)
    view.add_title()
    return view


def _may_fit(
    projected: Sequence[Projected], scale: float, cut: Break | None, width: float, height: float
) -> bool:
    """Whether the bare views leave room for dimensions."""
    columns: dict[int, float] = {}
    rows: dict[int, float] = {}
    for one in projected:
        view = one.view
        wide = (one.high[0] - one.low[0]) * scale
        if cut is not None and view.breaks:
            wide -= (cut.last - cut.first) * scale - GAP
        columns[view.column] = max(columns.get(view.column, 0.0), wide)
        rows[view.row] = max(rows.get(view.row, 0.0), (one.high[1] - one.low[1]) * scale)
    wide = sum(columns.values()) + (len(columns) - 1) * BETWEEN + ROOM
    return wide <= width and sum(rows.values()) + (len(rows) - 1) * BETWEEN + ROOM <= height


def _break(projected: Sequence[Projected], scale: float, width: float) -> Break | None:
    """The middle of a long part, where it is too long for its views to fit at a scale."""
    long = [one for one in projected if one.view.breaks]
    if not long:
        return None
    low, high = min(one.low[0] for one in long), max(one.high[0] for one in long)
    beside = {one.view.column: one.high[0] - one.low[0] for one in projected if one not in long}
    rest = width - 2.0 * ROOM - sum(wide * scale + BETWEEN + ROOM for wide in beside.values())
    if (high - low) * scale <= rest:
        return None
    ends = np.concatenate([c.points[[0, -1], 0] for one in long for c in one.curves])
    places = np.unique(np.round(ends, 6)).tolist()
    first, last = max(pairwise(places), key=lambda pair: pair[1] - pair[0])
    deep = max(one.high[1] - one.low[1] for one in long)
    margin = min(0.5 * deep + 2.0 / scale, 0.45 * (last - first))
    return Break(first + margin, last - margin)


def _anchor(view: PlacedView) -> Point:
    """What is in line with the other views: the origin, of a local view its middle."""
    if view.view.near is None:
        return (0.0, 0.0)
    return (0.5 * (view.low[0] + view.high[0]), 0.5 * (view.low[1] + view.high[1]))


def _grid(scale: float, views: Sequence[PlacedView]) -> Arranged:
    """Views in columns and rows; origins of one column are above each other, of one row level."""
    anchors = [_anchor(view) for view in views]
    boxes = []
    for view, (ax, ay) in zip(views, anchors, strict=True):
        (x0, y0), (x1, y1) = view.whole
        boxes.append((view.view, x0 - ax, y0 - ay, x1 - ax, y1 - ay))
    x_of: dict[int, float] = {}
    x = 0.0
    for column in sorted({view.view.column for view in views}):
        own = [box for box in boxes if box[0].column == column]
        left, right = min(box[1] for box in own), max(box[3] for box in own)
        x_of[column] = x - left
        x += right - left + BETWEEN
    y_of: dict[int, float] = {}
    y = 0.0
    for row in sorted({view.view.row for view in views}, reverse=True):
        own = [box for box in boxes if box[0].row == row]
        low, high = min(box[2] for box in own), max(box[4] for box in own)
        y_of[row] = y - high
        y -= high - low + BETWEEN
    shifts = tuple(
        (x_of[view.view.column] - ax, y_of[view.view.row] - ay)
        for view, (ax, ay) in zip(views, anchors, strict=True)
    )
    return Arranged(scale, tuple(views), shifts, x - BETWEEN, -y - BETWEEN)


def into(arranged: Arranged, area: Rectangle) -> Iterator[tuple[PlacedView, Point]]:
    """Every view with the shift that brings all of them into the middle of a rectangle."""
    x = area.x0 + 0.5 * (area.width - arranged.width)
    y = area.y1 - 0.5 * (area.height - arranged.height)
    for view, (dx, dy) in zip(arranged.views, arranged.shifts, strict=True):
        yield view, (x + dx, y + dy)

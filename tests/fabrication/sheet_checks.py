"""What every sheet must keep, measured on its own data by another route than it is made by."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from fabrication.drawings.lettering import LEAST
from fabrication.drawings.sheet import Dimension, Item, Sheet, Text, frame_of
from fabrication.formats.base import Part, Whole
from fabrication.job.product import HasProduct
from fabrication.solids import realise

STEP = 0.2
"""Lines are followed by points so far apart [mm]."""


def corners(text: Text) -> np.ndarray:
    return np.array(text.box())


def inside(points: np.ndarray, quad: np.ndarray, margin: float = 0.0) -> np.ndarray:
    """Which points are inside a counterclockwise quadrilateral by more than a margin."""
    ahead = np.roll(quad, -1, axis=0) - quad
    ahead = ahead / np.linalg.norm(ahead, axis=1)[:, None]
    away = points[:, None] - quad[None]
    return (ahead[:, 0] * away[..., 1] - ahead[:, 1] * away[..., 0] > margin).all(axis=1)


def grid(quad: np.ndarray) -> np.ndarray:
    """Points all over a parallelogram."""
    a, b = np.meshgrid(np.linspace(0, 1, 41), np.linspace(0, 1, 9))
    u, v = quad[1] - quad[0], quad[3] - quad[0]
    return quad[0] + a.reshape(-1, 1) * u + b.reshape(-1, 1) * v


def followed(item: Item) -> np.ndarray:
    """Points along a line."""
    ends = np.array(item.stroke_points(0.05))
    if len(ends) < 2:
        return np.empty((0, 2))
    found = []
    for p, q in pairwise(ends):
        count = max(2, math.ceil(np.linalg.norm(q - p) / STEP))
        found.append(p + np.linspace(0, 1, count)[:, None] * (q - p))
    return np.concatenate(found)


def overlapping(sheet: Sheet) -> list[str]:
    """Texts that lie on each other, or on an edge of the part."""
    found = []
    texts = [text for text in sheet.texts() if text.text.strip()]
    boxes = [corners(text) for text in texts]
    if not boxes:
        return found
    low, high = np.min(boxes, axis=1), np.max(boxes, axis=1)
    near = ((low[:, None] <= high[None]) & (low[None] <= high[:, None])).all(axis=2)
    for m, n in zip(*np.nonzero(np.triu(near, 1)), strict=True):
        if (
            inside(grid(boxes[m]), boxes[n], 0.05).any()
            or inside(grid(boxes[n]), boxes[m], 0.05).any()
        ):
            found.append(f"{texts[m].text!r} lies on {texts[n].text!r}")
    edges = [followed(item) for item in sheet.outlines]
    if edges:
        points = np.concatenate(edges)
        points = points[np.argsort(points[:, 0], kind="stable")]
        for text, box in zip(texts, boxes, strict=True):
            first, last = np.searchsorted(points[:, 0], [box[:, 0].min(), box[:, 0].max()])
            if inside(points[first:last], box, 0.05).any():
                found.append(f"{text.text!r} lies on the outline")
    return found


def faults(sheet: Sheet) -> list[str]:
    """All that is wrong with a sheet."""
    frame = frame_of(sheet.paper)
    found = overlapping(sheet)
    for item in sheet.drawn():
        marks = all(
            not frame.contains(point, -1e-9) for point in item.extent()
        )  # the centering marks are outside, and touch the frame
        if not marks and not all(frame.contains(point) for point in item.extent()):
            found.append(f"{item} leaves the frame")
    found += [f"{t.text!r} is {t.height} mm high" for t in sheet.texts() if t.height < LEAST]
    return found


def measured(sheet: Sheet, dimension: Dimension) -> float | None:
    """The value of a dimension by the distance of its feet on paper; None where they do not say."""
    feet = np.array(dimension.feet)
    if not dimension.true or len(feet) < 2:
        return None
    if len(feet) == 3:
        a, b = feet[1] - feet[0], feet[2] - feet[0]
        angle = math.degrees(math.atan2(abs(a[0] * b[1] - a[1] * b[0]), a @ b))
        return 360.0 - angle if dimension.value > 180.0 else angle
    scale = next(
        view.scale
        for view in sheet.views
        if all(
            view.low[0] - 1e-6 <= x <= view.high[0] + 1e-6
            and view.low[1] - 1e-6 <= y <= view.high[1] + 1e-6
            for x, y in feet
        )
    )
    return float(np.linalg.norm(feet[1] - feet[0])) / scale


def whole_of(made: HasProduct, role: str = "") -> Whole:
    """A structure as its job would have it, without the job."""
    product = made.product()
    parts = {
        family.number: Part.of(
            family,
            realise(family.shape, product.chord, solid=False),
            product.material(family),
        )
        for family in product.families
        if role in ("", family.role)
    }
    tables = product.schedules({number: part.mass for number, part in parts.items()} or {})
    rows = {name: table.rows for name, table in tables.items()}
    return Whole(product.about(), parts, product.placed, product.shown, tables=rows)

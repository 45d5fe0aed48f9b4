"""What the sheet of a pane shows: all sides, diagonals and angles, seen from outside."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from fabrication.boundary import Vec
from fabrication.drawings.angles import Angle
from fabrication.drawings.lengths import Length
from fabrication.drawings.notes import Label, Note
from fabrication.drawings.views import Drawing, Measure, View
from fabrication.solids.polygon import side_vectors, turns

if TYPE_CHECKING:
    from fabrication.parts.panel import PanelShape

COLUMNS: Final = (
    "edge_{k}_mm",
    "angle_{k}_deg",
    "edge_work_{k}",
    "bevel_{k}_deg",
    "step_{k}_mm",
)
"""Columns of the schedule of panels that the sheet lists by side."""

_TRIANGLE: Final = 3
_QUAD: Final = 4


def panel_drawing(shape: PanelShape) -> Drawing:
    """The outer surface from outside, side 1 at the bottom, and the pane from its left."""
    corners = shape.outer
    ahead = side_vectors(corners)
    lengths = np.linalg.norm(ahead, axis=1)
    along = ahead / lengths[:, None]
    right: Vec = (float(along[0, 0]), float(along[0, 1]), 0.0)
    up: Vec = (-right[1], right[0], 0.0)
    at: list[Vec] = [(x, y, shape.thickness) for x, y in corners.tolist()]
    measures: list[Measure] = [*_sides(at), *_corners(at), *_diagonals(at)]
    measures += _angles(at, along.tolist(), np.degrees(np.pi - turns(corners)).tolist())
    measures.append(Note("piece mark", at[0], toward=(-up[0], -up[1], 0.0)))
    notes = [
        "The piece mark goes on the outside, at corner 1. Sides, diagonals and angles are those "
        "of the outer surface, to the sharp corners."
    ]
    if shape.corner_radius:
        notes.append(f"All corners are rounded with R {shape.corner_radius:g} mm.")
    thick = _thickness(shape, right)
    return Drawing(
        (
            View("seen from outside", right, up, tuple(measures), hidden=False),
            View("from the left", (0.0, 0.0, 1.0), up, (thick,), column=1, hidden=False),
        ),
        columns=COLUMNS,
        notes=tuple(notes),
    )


def _thickness(shape: PanelShape, right: Vec) -> Length:
    """From the inner to the outer surface, at the corner that is highest on paper."""
    across = np.array([-right[1], right[0]])
    top = int(np.argmax(shape.outer @ across))
    x, y = shape.outer[top].tolist()
    return Length("thickness_mm", (x, y, 0.0), (x, y, shape.thickness), "across", "above")


def _corners(at: list[Vec]) -> list[Measure]:
    """Numbers of the corners, outside."""
    middle = np.mean(np.array(at), axis=0)
    return [
        Label(str(k), point, tuple((np.array(point) - middle).tolist()), bold=True, height=3.5)
        for k, point in enumerate(at, 1)
    ]


def _sides(at: list[Vec]) -> list[Measure]:
    """Lengths of all sides."""
    n = len(at)
    return [Length(f"edge_{k + 1}_mm", at[k], at[(k + 1) % n]) for k in range(n)]


def _diagonals(at: list[Vec]) -> list[Measure]:
    """Both of a quad; of more sides those from corner 1."""
    if len(at) == _TRIANGLE:
        return []
    if len(at) == _QUAD:
        return [
            Length("diagonal_13_mm", at[0], at[2], side="on"),
            Length("diagonal_24_mm", at[1], at[3], side="on"),
        ]
    pairs = [("diagonal_13_mm", 2)]
    pairs += [(f"diagonal_to_{k + 1}_mm", k) for k in range(3, len(at) - 1)]
    return [Length(name, at[0], at[k], side="on") for name, k in pairs]


def _angles(at: list[Vec], along: list[list[float]], values: list[float]) -> list[Measure]:
    """The inner angle at every corner."""
    found: list[Measure] = []
    for k, (point, value) in enumerate(zip(at, values, strict=True)):
        (ax, ay), (bx, by) = along[k], along[k - 1]
        found.append(Angle(f"angle_{k + 1}_deg", point, (ax, ay, 0.0), (-bx, -by, 0.0), value))
    return found

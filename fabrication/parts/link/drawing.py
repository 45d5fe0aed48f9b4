"""What the sheet of a link shows: both hinge axes, the twist between them, eyes and bar."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

from fabrication.boundary import Vec
from fabrication.drawings.angles import Angle
from fabrication.drawings.lengths import Length, Side
from fabrication.drawings.notes import Note, Ray
from fabrication.drawings.views import Drawing, Measure, View
from fabrication.parts.link.frame import Eye, bar_frame, eyes_of
from fabrication.solids.builder import add

if TYPE_CHECKING:
    from fabrication.parts.link.shape import LinkShape

COLUMNS: Final = (
    "hinge_start", "hinge_end", "pin_start", "pin_end", "level_start", "level_end",
    "label_side", "label_towards", "hand",
)  # fmt: skip
"""Columns of the schedule of links that the sheet lists."""

X: Final[Vec] = (1.0, 0.0, 0.0)
Y: Final[Vec] = (0.0, 1.0, 0.0)
Z: Final[Vec] = (0.0, 0.0, 1.0)

SMALL: Final = 0.05
"""Offsets of less [mm] are not shown."""


def link_drawing(shape: LinkShape) -> Drawing:
    """From the side and above across both axes, and along the bar, where the twist is seen."""
    eyes = eyes_of(shape)
    views = (
        View("front", X, Z, tuple(_front(shape, eyes)), hidden=False),
        View("from above", X, Y, tuple(_above(shape, eyes)), row=-1, hidden=False),
        View(
            "from the left", (0.0, -1.0, 0.0), Z, tuple(_along(shape, eyes)), column=1, hidden=False
        ),
    )
    hand = "right" if shape.twist > 0.0 else "left"
    notes = [
        f"Hand: {hand}. The length is that of the common perpendicular of both axes; the twist is "
        "positive where the far axis is turned counterclockwise as it is seen coming near."
    ]
    if shape.label is not None:
        notes.append(f'The label "{shape.label.text}" is on the upper side of the bar.')
    return Drawing(views, columns=COLUMNS, notes=tuple(notes))


def _front(shape: LinkShape, eyes: tuple[Eye, Eye]) -> Iterator[Measure]:
    """The first eye in true size, the distance of the axes, and where the eyes are on them."""
    half, r = 0.5 * shape.eye_height, 0.5 * shape.eye_diameter
    low, high = shape.start - half, shape.start + half
    yield Length("length_mm", (0.0, 0.0, 0.0), (shape.length, 0.0, 0.0), "across", "below")
    yield Length("height_mm", (-r, 0.0, low), (-r, 0.0, high), "up", "left")
    if abs(shape.start) > SMALL:
        yield Length("start_mm", (-r, 0.0, 0.0), (-r, 0.0, shape.start), "up", "left", first=1)
    yield Length("diameter_mm", (-r, 0.0, high), (r, 0.0, high), "across", "above", "Ø")
    for eye in eyes:
        yield Ray(add(eye.middle, eye.axis, -half), eye.axis, 2.0 * half)


def _above(shape: LinkShape, eyes: tuple[Eye, Eye]) -> Iterator[Measure]:
    """Both bores, and the bar's width."""
    top = shape.start + 0.5 * shape.eye_height
    r = 0.5 * shape.bores[0]
    edges = (0.0, -r, top), (0.0, r, top)
    yield Note(
        f"Ø{shape.bores[0]:g}", edges[1], "bore_mm", shape.bores[0], (-0.6, 1.0, 0.0), across=edges
    )
    if abs(shape.bores[1] - shape.bores[0]) > 1e-9:
        end = add(eyes[1].middle, eyes[1].axis, 0.5 * shape.eye_height)
        yield Note(f"Ø{shape.bores[1]:g}", end, "end_bore_mm", shape.bores[1], (0.6, 1.0, 0.0))
    frame = bar_frame(shape, eyes)
    span = math.dist(eyes[0].exit, eyes[1].exit)
    middle = add(frame.origin, frame.along, 0.4 * span)
    size = f"bar {shape.bar_width:g} x {shape.bar_height:g}"
    if shape.bevel:
        size += f", corners {shape.bevel:g} x 45°"
    yield Note(size, middle, toward=(0.4, -1.0, 0.0), dotted=True)
    if shape.label is not None:
        place = add(frame.origin, frame.along, 0.5 * span)
        yield Note("label", place, toward=(0.3, 1.0, 0.0), dotted=True)


def _along(shape: LinkShape, eyes: tuple[Eye, Eye]) -> Iterator[Measure]:
    """The twist: both axes as seen along their common perpendicular, the near one upright."""
    del eyes
    reach = 0.5 * shape.eye_height + max(abs(shape.start), abs(shape.end))
    axis: Vec = (0.0, -math.sin(shape.twist), math.cos(shape.twist))
    for way in (Z, axis):
        yield Ray((0.0, 0.0, 0.0), way, reach, 10.0)
    yield Angle(
        "twist_deg", (0.0, 0.0, 0.0), Z, axis, math.degrees(shape.twist), signed=True, least=reach
    )
    side: Side = "right" if shape.twist > 0.0 else "left"
    if abs(shape.end) > SMALL:
        end = (0.0, axis[1] * shape.end, axis[2] * shape.end)
        yield Length("end_mm", (0.0, 0.0, 0.0), end, "along", side)

"""What the sheet of a beam shows: lengths, mitres with their sign, and holes from the start."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from fabrication.boundary import Vec
from fabrication.drawings.angles import Angle
from fabrication.drawings.lengths import Length, Side
from fabrication.drawings.notes import Note
from fabrication.drawings.views import Drawing, Measure, View
from fabrication.parts.beam.congruence import fibre_ends
from fabrication.parts.beam.end_plate import bar_of
from fabrication.standards.profiles import z_range

if TYPE_CHECKING:
    from fabrication.parts.beam.shape import BeamShape, EndCut

COLUMNS: Final = (
    "profile",
    "length_axis_mm",
    *(
        name.format(end=end)
        for end in ("start", "end")
        for name in (
            "node_{end}",
            "offset_{end}_mm",
            "roll_{end}_deg",
            "hole_{end}_up_mm",
            "opening_{end}_mm",
            "opening_{end}_height_mm",
            "slots_{end}_middle_mm",
            "slots_{end}_apart_mm",
            "bolts_{end}_hole_mm",
            "bolts_{end}_recess_mm",
            "bolts_{end}_grip_mm",
        )
    ),
    "slot_width_mm",
    "slot_depth_mm",
    "panel_left",
    "panel_right",
    "weld_mm",
)
"""Columns of the schedule of beams that the sheet lists."""

FLAT: Final = 5e-3
"""A mitre of less [deg] is a square cut: it would be written as 0.00."""

SHOWN: Final = 0.05
"""Lengths that differ by less [mm] are written alike."""


@dataclass(frozen=True)
class BeamEnd:
    """An end of a beam, with the directions of its cut.

    outward : the way out of the bar along x
    inwards, up : unit vectors into the bar, square to the cut, and upwards in it
    """

    name: str
    cut: EndCut
    outward: float

    @property
    def stretch(self) -> float:
        """Length along the cut for a unit of height."""
        return math.hypot(1.0, self.cut.slope)

    @property
    def inwards(self) -> Vec:
        """Into the bar, square to the cut."""
        n = self.stretch
        return (-self.outward / n, 0.0, self.outward * self.cut.slope / n)

    @property
    def up(self) -> Vec:
        """Upwards in the cut."""
        n = self.stretch
        return (self.cut.slope / n, 0.0, 1.0 / n)

    @property
    def side(self) -> Side:
        """Of the front view, on which the end is."""
        return "left" if self.outward < 0.0 else "right"

    @property
    def mitre(self) -> float:
        """Between a square cut and the cut [deg], positive where the beam is longer at the top."""
        return self.outward * math.degrees(math.atan(self.cut.slope))

    def at(self, z: float, depth: float = 0.0, rise: float = 0.0, y: float = 0.0) -> Vec:
        """From where the cut is at a height: a depth inwards, a rise along the cut, and across."""
        (a, _, b), (c, _, d) = self.inwards, self.up
        x = self.cut.x + self.cut.slope * z
        return (x + depth * a + rise * c, y, z + depth * b + rise * d)


def beam_drawing(shape: BeamShape) -> Drawing:
    """The right side as the front, from above, and both ends, square to their cuts."""
    from fabrication.parts.beam.end_drawing import depths, end_view, stations

    low, high = z_range(shape.profile)
    ends = (BeamEnd("start", shape.start, -1.0), BeamEnd("end", shape.end, 1.0))
    special = any(end.cut.stud or end.cut.plate for end in ends)
    front = [*_lengths(shape, low, high), *stations(shape, ends, low)]
    front += [measure for end in ends for measure in (*_mitres(end, low, high), *depths(end))]
    depth, reach = high - low, shape.end.x - shape.start.x
    at = shape.start.x + min(abs(shape.start.slope) * depth + 0.5 * depth, 0.3 * reach)
    mark = (at, 0.0, 0.3 * low + 0.7 * high)
    front.append(Note("piece mark", mark, dotted=True))
    skews = [measure for end in ends for measure in _skew(shape, end, high)]
    right: Vec = (1.0, 0.0, 0.0)
    views = [
        View("right side", right, (0.0, 0.0, 1.0), tuple(front), breaks=True),
        View("from above", right, (0.0, 1.0, 0.0), tuple(skews), row=-1, breaks=True),
    ]
    shown = ends if special else ends[:1]
    views += [end_view(shape, end, low, high) for end in shown]
    return Drawing(tuple(views), columns=COLUMNS, notes=tuple(_notes(shape)))


def _notes(shape: BeamShape) -> Iterator[str]:
    yield (
        "The start is on the left. Mitres are positive where the beam is longer at the top. "
        "Places along the beam are measured from the long point of its start."
    )
    if shape.is_skew:
        yield "Skews are positive where the beam is longer on its left."
    coped = [cut.radius for cut in (shape.start, shape.end) if cut.radius is not None]
    if coped:
        yield (
            f"Coped ends fit a cylinder of R {coped[0]:g} mm; its axis leans by the mitre. Lengths "
            "at top and bottom are those in the middle of the width."
        )


def _lengths(shape: BeamShape, low: float, high: float) -> Iterator[Measure]:
    """At the top and at the bottom where they differ, and over all, between long points."""
    edges: tuple[tuple[str, float, Side], ...] = (("top", high, "above"), ("bottom", low, "below"))
    top, bottom = (
        Length(
            f"length_{name}_mm",
            (shape.start.x + shape.start.slope * z, 0.0, z),
            (shape.end.x + shape.end.slope * z, 0.0, z),
            "across",
            side,
        )
        for name, z, side in edges
    )
    start, end = fibre_ends(bar_of(shape))
    first, last = float(start.min()), float(end.max())
    both = [length.end[0] - length.start[0] for length in (top, bottom)]
    plated = shape.start.plate is not None or shape.end.plate is not None
    if plated or max(both) - min(both) > SHOWN:
        yield top
        yield bottom
    if not plated and (max(both) - min(both) <= SHOWN or last - first - max(both) > SHOWN):
        z0 = high if shape.start.slope < 0.0 else low
        z1 = high if shape.end.slope > 0.0 else low
        yield Length("length_cut_mm", (first, 0.0, z0), (last, 0.0, z1), "across", "below")


def _mitres(end: BeamEnd, low: float, high: float) -> Iterator[Measure]:
    """The angle between a square cut and the cut, at its foot."""
    value, out = end.mitre, (end.outward, 0.0, 0.0)
    name = f"mitre_{end.name}_deg"
    if abs(value) < FLAT:
        yield Note("90°", end.at(high), name, 0.0, (end.outward, 0.0, 0.8))
        return
    yield Angle(
        name, end.at(low), (0.0, 0.0, 1.0), end.up, value,
        signed=True, beside=out, least=(high - low) * end.stretch,
    )  # fmt: skip


def _skew(shape: BeamShape, end: BeamEnd, high: float) -> Iterator[Measure]:
    """The same as seen from above, where the cut is skew."""
    half, skew = 0.5 * shape.profile.width, end.cut.skew
    value = end.outward * math.degrees(math.atan(skew))
    if abs(value) < FLAT:
        return
    n = math.hypot(1.0, skew)
    x, _, z = end.at(high)
    yield Angle(
        f"skew_{end.name}_deg", (x - skew * half, -half, z), (0.0, 1.0, 0.0),
        (skew / n, 1.0 / n, 0.0), value,
        signed=True, beside=(end.outward, 0.0, 0.0), least=2.0 * half * n,
    )  # fmt: skip

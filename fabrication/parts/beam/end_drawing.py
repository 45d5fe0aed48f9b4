"""What the sheet of a beam shows of its ends: holes, slots, plates, and each end from outside."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

from fabrication.boundary import Vec
from fabrication.drawings.lengths import Length
from fabrication.drawings.notes import Note
from fabrication.drawings.running import Running
from fabrication.drawings.views import Measure, View
from fabrication.parts.beam.congruence import fibre_ends
from fabrication.parts.beam.drawing import BeamEnd

if TYPE_CHECKING:
    from fabrication.parts.beam.shape import BeamShape


def stations(shape: BeamShape, ends: Sequence[BeamEnd], low: float) -> Iterator[Measure]:
    """Places of holes and bolts along the beam from its long point, and above its bottom."""
    origin: Vec = (float(fibre_ends(shape)[0].min()), 0.0, low)
    middle = 0.5 * (shape.start.x + shape.end.x)
    along: list[Vec] = [(hole.x, 0.0, hole.z) for hole in shape.holes]
    for end in ends:
        own = [("hole", place) for place in along if end.outward * (place[0] - middle) > 0.0]
        if end.cut.comb is not None:
            along += [end.at(end.cut.comb.z, step) for step in end.cut.comb.steps]
        if own:
            yield Running(end.at(low), tuple(own), "up", end.side)
    if along:
        yield Running(origin, tuple(("hole", place) for place in along), "across", "above", 1)
    for diameter in sorted({hole.diameter for hole in shape.holes}):
        same = [hole for hole in shape.holes if hole.diameter == diameter]
        x, z, r = same[0].x, same[0].z, 0.5 * diameter
        edges: tuple[Vec, Vec] = ((x, 0.0, z - r), (x, 0.0, z + r))
        yield Note(
            diameters(len(same), diameter), edges[1], "hole_mm", diameter, (0.4, 0.0, 1.0),
            across=edges,
        )  # fmt: skip


def diameters(count: int, diameter: float) -> str:
    """Holes as drawings write them.

    >>> diameters(4, 13.5), diameters(1, 10.0)
    ('4× Ø13.5', 'Ø10')
    """
    return f"{count}× Ø{diameter:g}" if count > 1 else f"Ø{diameter:g}"


def depths(end: BeamEnd) -> Iterator[Measure]:
    """Thickness of a plate, depth and height of slots: square to the cut and along it."""
    cut, name = end.cut, end.name
    stud, plate, comb = cut.stud, cut.plate, cut.comb
    if stud is not None:
        edge = 0.5 * stud.height
        near, far = end.at(stud.z, 0.0, edge), end.at(stud.z, stud.plate, edge)
        yield Length(f"plate_{name}_mm", near, far, "along", "above", "t ")
    if plate is not None:
        edge = 0.5 * plate.height
        near, far = end.at(plate.z, 0.0, edge), end.at(plate.z, plate.thickness, edge)
        yield Length(f"plate_{name}_mm", near, far, "along", "above", "t ")
    if comb is not None:
        (a, b), (c, d) = comb.slots
        near, far = end.at(comb.z, 0.0, c), end.at(comb.z, comb.depth, c)
        yield Length(f"slots_{name}_depth_mm", near, far, "along", "below")
        ends = end.at(comb.z, 0.0, c), end.at(comb.z, 0.0, d)
        yield Length(f"slots_{name}_width_mm", *ends, "along", end.side)
        middles = end.at(comb.z, 0.0, 0.5 * (a + b)), end.at(comb.z, 0.0, 0.5 * (c + d))
        yield Length(f"slots_{name}_apart_mm", *middles, "along", end.side, first=1)


def end_view(shape: BeamShape, end: BeamEnd, low: float, high: float) -> View:
    """An end from outside; square to its cut where a plate or a stud is in it."""
    cut, right = end.cut, (0.0, end.outward, 0.0)
    side = "left" if end.outward < 0.0 else "right"
    near: float | None
    if cut.plate is not None:
        title, up = f"the {end.name}, square to its cut", end.up
        near = 1.5 * cut.plate.thickness
        measures: Iterable[Measure] = _plate(end)
    elif cut.stud is not None:
        title, up = f"the {end.name}, square to its cut", end.up
        near = 0.5 * cut.stud.plate
        measures = [*_profile(shape, end, low, high, upright=False), _stud(end)]
    else:
        title, up, near = f"from the {side}", (0.0, 0.0, 1.0), None
        measures = [*_profile(shape, end, low, high, upright=True), *_slot(end, low)]
    special = near is not None  # views of their own below; else, in first angle, from the left
    column, row = (int(end.outward > 0.0), -2) if special else (1, 0)
    return View(title, right, up, tuple(measures), column, row, hidden=False, near=near)


def _profile(
    shape: BeamShape, end: BeamEnd, low: float, high: float, *, upright: bool
) -> Iterator[Measure]:
    """Width and depth of the bar."""
    half = 0.5 * shape.profile.width
    yield Length("width", end.at(low, y=-half), end.at(low, y=half), "across", "below")
    if upright:
        yield Length("depth", end.at(low, y=half), end.at(high, y=half), "up", "left")


def _slot(end: BeamEnd, low: float) -> Iterator[Measure]:
    """Width of a slot that is open at top and bottom."""
    if end.cut.slot is not None:
        half = 0.5 * end.cut.slot.width
        yield Length("slot_width_mm", end.at(low, y=-half), end.at(low, y=half), "across", "above")


def _stud(end: BeamEnd) -> Measure:
    """Diameter of the hole in the cut."""
    stud = end.cut.stud
    assert stud is not None
    r = 0.5 * stud.diameter
    edges = end.at(stud.z, y=-r), end.at(stud.z, y=r)
    name = f"hole_{end.name}_diameter_mm"
    toward = (0.0, end.outward, 0.3)
    return Note(diameters(1, stud.diameter), edges[end.outward > 0.0], name, stud.diameter, toward,
                across=edges)  # fmt: skip


def _plate(end: BeamEnd) -> Iterator[Measure]:
    """Width and height of an end plate, and its holes from its lower left corner."""
    plate, name = end.cut.plate, end.name
    assert plate is not None

    def at(y: float, rise: float) -> Vec:
        return end.at(plate.z, 0.0, rise, y * end.outward)

    y, w, r = 0.5 * plate.width, 0.5 * plate.height, 0.5 * plate.diameter
    yield Length(f"plate_{name}_width_mm", at(-y, -w), at(y, -w), "across", "below", first=1)
    yield Length(f"plate_{name}_height_mm", at(-y, -w), at(-y, w), "up", "left", first=1)
    holes = [("hole", at(across * end.outward, rise)) for across, rise in plate.holes]
    yield Running(at(-y, -w), tuple(holes), "across", "above")
    yield Running(at(-y, -w), tuple(holes), "up", "right")
    across = max(hole[0] for hole in plate.holes)
    rise = max(hole[1] for hole in plate.holes)
    edges = at(across, rise - r), at(across, rise + r)
    label = diameters(len(plate.holes), plate.diameter)
    yield Note(label, edges[1], f"hole_{name}_diameter_mm", plate.diameter, end.up, across=edges)
    if plate.vent:
        r = 0.5 * plate.vent
        edges = at(0.0, -r), at(0.0, r)
        toward = (0.0, 0.4 * end.outward, -1.0)
        yield Note(f"vent Ø{plate.vent:g}", edges[0], "vent_mm", plate.vent, toward, across=edges)

"""What the sheets of nodes show: the plan with its arms from the mark, and the node upright."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

from fabrication.boundary import Vec
from fabrication.drawings.lengths import Length
from fabrication.drawings.notes import Note
from fabrication.drawings.running import Arm, Azimuths
from fabrication.drawings.views import Drawing, Measure, View, shown

if TYPE_CHECKING:
    from fabrication.parts.node.shape import NodeShape, ReferenceMark

ENDS: Final = ("above_mm", "below_mm", "mark_radius_mm")
"""Columns of all nodes: from the vertex to both ends, negative where it is beyond; the mark."""

COLUMNS: Final = (
    *ENDS,
    "beam_{k}",
    "azimuth_{k}_deg",
    "elevation_{k}_deg",
    "seat_{k}_mm",
    "seat_depth_{k}_mm",
    "seat_width_{k}_mm",
    "hole_{k}_mm",
    "hole_{k}_diameter_mm",
    "hole_{k}_depth_mm",
    "hole_{k}_count",
    "hole_{k}_across_mm",
    "hole_{k}_along_mm",
)
"""Columns of the schedule of nodes that the sheet lists."""

X: Final[Vec] = (1.0, 0.0, 0.0)
Y: Final[Vec] = (0.0, 1.0, 0.0)
Z: Final[Vec] = (0.0, 0.0, 1.0)

NOTE: Final = (
    "Azimuths run counterclockwise from the blind hole that marks the first arm, as seen from "
    "outside. The plan is the top end, which points outwards; z = 0 is the vertex of the net."
)


def node_drawing(shape: NodeShape, about: Mapping[str, Any]) -> Drawing:
    """A cylinder or tube: plan with azimuths and seats, and its height."""
    directions = [seat.azimuth for seat in shape.seats] + [hole.azimuth for hole in shape.holes]
    angles = sorted({round(azimuth, 9) for azimuth in directions})
    if not angles:
        angles = azimuths_of(about)
    distance = {round(seat.azimuth, 9): seat.distance for seat in shape.seats}
    arms = arms_of(angles, about, shape.radius, distance)
    r, z0, z1 = shape.radius, shape.z0, shape.z1
    plan: list[Measure] = [Azimuths((0.0, 0.0, z1), arms, r)] if arms else []
    plan += [diameter("diameter_mm", r, z1, math.radians(215.0))]
    if shape.bore:
        plan.append(diameter("bore_mm", shape.bore, z1, math.radians(305.0)))
    plan += marked(shape.mark, z1)
    front: list[Measure] = [*heights(z0, z1, r), *_levels(shape)]
    notes = [NOTE]
    if distance:
        notes.append("s: from the axis to the flat of the arm, which is parallel to the axis.")
    return node_views(plan, front, COLUMNS, notes)


def node_views(
    plan: Sequence[Measure], front: Sequence[Measure], columns: Sequence[str], notes: Sequence[str]
) -> Drawing:
    """The node upright, and below it its plan."""
    return Drawing(
        (
            View("front", X, Z, tuple(front)),
            View("from above (outside)", X, Y, tuple(plan), row=-1, hidden=False),
        ),
        columns=tuple(columns),
        notes=tuple(notes),
    )


def azimuths_of(about: Mapping[str, Any]) -> list[float]:
    """Directions of the arms [rad] in the schedule, where all pieces have them."""
    found = []
    for k in range(1, len(about) + 1):
        value = about.get(f"azimuth_{k}_deg")
        if value is None:
            break
        found.append(math.radians(value))
    return found


def arms_of(
    angles: Sequence[float],
    about: Mapping[str, Any],
    reach: float,
    seats: Mapping[float, float] | None = None,
) -> tuple[Arm, ...]:
    """Arms at azimuths [rad]: number, azimuth, distance of the seat, elevation of the beam."""
    arms = []
    for k, angle in enumerate(angles, 1):
        more: list[tuple[str, float, str, float | None]] = []
        seat = (seats or {}).get(angle)
        if seat is not None:
            more.append((f"seat_{k}_mm", seat, f"s {shown(seat, 1)}", seat))
        rise = about.get(f"elevation_{k}_deg")
        if rise is not None:
            text = f"elev. {'+' if round(rise, 2) > 0.0 else ''}{shown(rise, 2)}°"
            more.append((f"elevation_{k}_deg", rise, text, None))
        arms.append(Arm(f"azimuth_{k}_deg", f"{k}:", angle, reach, tuple(more)))
    return tuple(arms)


def diameter(name: str, radius: float, z: float, angle: float) -> Note:
    """A diameter with a line to its circle about the axis, at an angle [rad]."""
    way = (math.cos(angle), math.sin(angle), 0.0)
    edges = (-radius * way[0], -radius * way[1], z), (radius * way[0], radius * way[1], z)
    return Note(f"Ø{2.0 * radius:g}", edges[1], name, 2.0 * radius, way, across=edges)


def marked(mark: ReferenceMark | None, z: float) -> Iterator[Measure]:
    """The blind hole that azimuths are counted from, and the piece mark."""
    if mark is not None:
        at = (mark.x, 0.0, z)
        yield Length("mark_radius_mm", (0.0, 0.0, z), at, "across", "below", first=0)
        text = f"mark Ø{mark.diameter:g}, {mark.depth:g} deep"
        yield Note(text, at, toward=(0.6, -1.0, 0.0), dotted=True)
        yield Note(
            "piece mark", (-0.4 * mark.x, 0.3 * mark.x, z), toward=(-1.0, 0.6, 0.0), dotted=True
        )


def heights(z0: float, z1: float, reach: float) -> Iterator[Measure]:
    """Over all, and from the vertex to both ends."""
    yield Length("height_mm", (reach, 0.0, z0), (reach, 0.0, z1), "up", "right", first=1)
    if z0 < -1e-6 < 1e-6 < z1:
        yield Length("above_mm", (reach, 0.0, 0.0), (reach, 0.0, z1), "up", "right")
        yield Length("below_mm", (reach, 0.0, z0), (reach, 0.0, 0.0), "up", "right")


def _levels(shape: NodeShape) -> Iterator[Measure]:
    """Heights of the holes above the bottom end, in front of the axis."""
    from fabrication.drawings.running import Running

    first = [hole for hole in shape.holes if abs(hole.azimuth - shape.holes[0].azimuth) < 1e-9]
    points = tuple(("hole", (shape.radius, 0.0, hole.z)) for hole in first)
    if points:
        yield Running((shape.radius, 0.0, shape.z0), points, "up", "left")

"""Nodes: a cylinder or tube with seats and holes; the record, and what it is to the rest."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Protocol, Self, TypeVar, runtime_checkable

from fabrication.boundary import Boundary, Cut
from fabrication.parts.node.boundary import node_geometry
from fabrication.parts.node.congruence import node_key, node_variants
from fabrication.parts.node.drills import SAME_AZIMUTH
from fabrication.parts.node.volume import node_volume
from fabrication.specs import Kind
from fabrication.variants import Variants

if TYPE_CHECKING:
    from fabrication.drawings.views import Drawing

NODE: Final = Kind(
    role="node",
    mark="N",
    prefix="NP",
    title="Nodes",
    color=(0.80, 0.42, 0.16),
    finish="bright",
    form="joint",
)

NEAR: Final = 0.1
"""Greatest difference of the azimuths [rad] of an arm and its seat: far less than between arms."""


@dataclass(frozen=True)
class Seat:
    """A flat milled along the whole height: plane at `distance` [mm] from the axis.

    azimuth [rad] about the axis from the reference; width [mm] is the width of the flat.
    """

    azimuth: float
    distance: float
    width: float


@dataclass(frozen=True)
class RadialHole:
    """A round hole parallel to a radius of the node, at height z [mm].

    depth [mm] is measured from the seat (or from the cylinder where there is none);
    None: through the wall into the bore. across [mm]: from the radius at `azimuth`
    counterclockwise to the axis of the hole; 0: it points to the node axis.
    """

    azimuth: float
    z: float
    diameter: float
    depth: float | None
    across: float = 0.0


_F = TypeVar("_F", Seat, RadialHole)


@dataclass(frozen=True)
class ReferenceMark:
    """A small blind hole in the top face at azimuth 0, at radius x [mm]: where azimuths start."""

    x: float
    diameter: float
    depth: float


@dataclass(frozen=True, eq=False)
class NodeShape:
    """A cylinder about z from z0 to z1 [mm], the vertex at the origin.

    bore : inner RADIUS [mm] of a tube; 0 means solid.

    Azimuth 0 is the x axis, the direction of the first arm.
    """

    radius: float
    bore: float
    z0: float
    z1: float
    seats: tuple[Seat, ...] = ()
    holes: tuple[RadialHole, ...] = ()
    mark: ReferenceMark | None = None

    def key(self) -> Hashable:
        """Radius, bore, mark, seats and drills."""
        return node_key(self)

    @classmethod
    def variants(cls, shapes: Sequence[Self]) -> Variants:
        """Beginning at each of their arms."""
        return node_variants(shapes)

    def geometry(self) -> Boundary | Cut:
        """Exact but for radial holes into the bore or in the round surface, which are cut."""
        return node_geometry(self)

    def second_volume(self) -> float:
        """Circle less the seats' segments and the bore, less the holes."""
        return node_volume(self)

    def drawing(self, about: Mapping[str, Any]) -> Drawing:
        """What its sheet shows."""
        from fabrication.parts.node.drawing import node_drawing

        return node_drawing(self, about)

    def dimensions(self) -> dict[str, Any]:
        """Diameter and height."""
        return {"diameter_mm": 2 * self.radius, "height_mm": self.z1 - self.z0}

    def details(self) -> dict[str, Any]:
        """Wall of a tube; where its ends and the mark are."""
        wall = {"wall_mm": self.radius - self.bore} if self.bore else {}
        return {**wall, **ends_of(self)}

    def arm(self, azimuth: float | None) -> dict[str, Any]:
        """Seat and hole of the arm in a direction [rad]; None in every column where none is."""
        found: dict[str, Any] = {}
        if self.seats:
            seat = _nearest(self.seats, azimuth)
            found["seat_{k}_mm"] = seat.distance if seat else None
            found["seat_depth_{k}_mm"] = self.radius - seat.distance if seat else None
            found["seat_width_{k}_mm"] = seat.width if seat else None
        if self.holes:
            own = _all_near(self.holes, azimuth)
            hole = own[0] if own else None
            found["hole_{k}_mm"] = hole.z - self.z0 if hole else None
            found["hole_{k}_diameter_mm"] = hole.diameter if hole else None
            found["hole_{k}_depth_mm"] = hole.depth if hole else None
            if any(hole.across for hole in self.holes):
                levels, ys = [h.z for h in own], [h.across for h in own]
                found["hole_{k}_mm"] = min(levels) - self.z0 if own else None
                found["hole_{k}_count"] = len(own) if own else None
                found["hole_{k}_across_mm"] = max(ys) - min(ys) if own else None
                found["hole_{k}_along_mm"] = max(levels) - min(levels) if own else None
        return found

    def stock(self) -> tuple[str, float]:
        """Name of the bar that it is sawn from, and the length to saw [mm]."""
        name = f"round {2 * self.radius:g}"
        if self.bore:
            name = f"tube {2 * self.radius:g}x{self.radius - self.bore:g}"
        return name, self.z1 - self.z0


@runtime_checkable
class Upright(Protocol):
    """A node that stands about z, with a mark in its top end."""

    @property
    def z0(self) -> float:
        """Its bottom."""
        ...

    @property
    def z1(self) -> float:
        """Its top."""
        ...

    @property
    def mark(self) -> ReferenceMark | None:
        """The mark in its top."""
        ...


def ends_of(shape: Upright) -> dict[str, Any]:
    """From the vertex to both ends, and the mark, as schedules list them."""
    found = {"above_mm": shape.z1, "below_mm": -shape.z0}
    if (mark := shape.mark) is not None:
        found["mark_radius_mm"] = mark.x
        found["mark_diameter_mm"], found["mark_depth_mm"] = mark.diameter, mark.depth
    return found


def _nearest(features: Sequence[_F], azimuth: float | None) -> _F | None:
    """The seat or hole in a direction; None where there is none within a family's tolerance."""
    if azimuth is None:
        return None
    best = min(features, key=lambda feature: abs(turn_between(feature.azimuth, azimuth)))
    return best if abs(turn_between(best.azimuth, azimuth)) <= NEAR else None


def _all_near(holes: Sequence[RadialHole], azimuth: float | None) -> list[RadialHole]:
    """The holes of the arm in a direction."""
    best = _nearest(holes, azimuth)
    if best is None:
        return []
    return [h for h in holes if abs(turn_between(h.azimuth, best.azimuth)) <= SAME_AZIMUTH]


def turn_between(one: float, other: float) -> float:
    """From one azimuth to another [rad], at most half a turn either way."""
    return math.remainder(other - one, 2.0 * math.pi)

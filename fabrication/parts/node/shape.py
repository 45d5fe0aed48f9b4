"""Nodes: a cylinder or tube with seats and holes; the record, and what it is to the rest."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import Any, Final, Self

from fabrication.boundary import Boundary, Cut
from fabrication.parts.node.boundary import node_geometry
from fabrication.parts.node.congruence import node_key, node_variants
from fabrication.parts.node.volume import node_volume
from fabrication.specs import Kind
from fabrication.variants import Variants

NODE: Final = Kind(
    role="node",
    mark="N",
    prefix="NP",
    title="Nodes",
    color=(0.80, 0.42, 0.16),
    finish="bright",
    form="joint",
)


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
    """A round hole towards the node axis, perpendicular to it, at height z [mm].

    depth [mm] is measured from the seat (or from the cylinder where there is none);
    None: through the wall into the bore.
    """

    azimuth: float
    z: float
    diameter: float
    depth: float | None


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

    def dimensions(self) -> dict[str, Any]:
        """Diameter and height."""
        return {"diameter_mm": 2 * self.radius, "height_mm": self.z1 - self.z0}

"""Rings about a pin: spacers, and with a floor caps."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Self

from ddgfab.errors import DetailError
from fabrication.boundary import Boundary, Vec
from fabrication.solids.builder import BoundaryBuilder
from fabrication.solids.drum import drum
from fabrication.specs import Kind
from fabrication.variants import Variants, key_of

if TYPE_CHECKING:
    from fabrication.drawings.views import Drawing

CAP: Final = Kind(
    role="cap",
    mark="C",
    prefix="CP",
    title="Caps",
    color=(0.90, 0.62, 0.15),
)

SPACER: Final = Kind(
    role="spacer",
    mark="S",
    prefix="SP",
    title="Spacers",
    color=(0.86, 0.84, 0.78),
)

X: Final[Vec] = (1.0, 0.0, 0.0)
UP: Final[Vec] = (0.0, 0.0, 1.0)
DOWN: Final[Vec] = (0.0, 0.0, -1.0)


@dataclass(frozen=True)
class RingShape:
    """A ring about z, from z = 0 to height; a floor closes its upper end and makes it a cap.

    floor : thickness [mm] of the closed end, 0 for a ring that is open at both ends
    """

    diameter: float
    bore: float
    height: float
    floor: float = 0.0

    def key(self) -> Hashable:
        """All dimensions."""
        return tuple(map(key_of, (self.diameter, self.bore, self.height, self.floor)))

    @classmethod
    def variants(cls, shapes: Sequence[Self]) -> Variants:
        """Those of one key are equal."""
        return Variants.equal(len(shapes))

    def geometry(self) -> Boundary:
        """Always exact."""
        return ring_boundary(self)

    def second_volume(self) -> float:
        """Sum of cylinders."""
        return ring_volume(self)

    def drawing(self, about: Mapping[str, Any]) -> Drawing:
        """What its sheet shows."""
        from fabrication.parts.turned_drawing import ring_drawing

        return ring_drawing(self)

    def dimensions(self) -> dict[str, Any]:
        """Diameter, bore and height."""
        return {"diameter_mm": self.diameter, "bore_mm": self.bore, "height_mm": self.height}


def ring_boundary(shape: RingShape) -> Boundary:
    """Exact boundary of a ring or cap.

    Raises
    ------
    DetailError
        A bore that leaves no wall, or a floor that leaves no bore.
    """
    if not 0.0 < shape.bore < shape.diameter:
        raise DetailError(
            f"a ring of {shape.diameter:.6g} mm leaves no wall around a bore of {shape.bore:.6g} mm"
        )
    if not 0.0 <= shape.floor < shape.height:
        raise DetailError(
            f"a ring {shape.height:.6g} mm high leaves no bore under a floor of "
            f"{shape.floor:.6g} mm"
        )
    builder = BoundaryBuilder()
    bottom: Vec = (0.0, 0.0, 0.0)
    top: Vec = (0.0, 0.0, shape.height)
    low, high = drum(builder, bottom, top, X, shape.diameter / 2.0)
    if shape.floor > 0.0:
        end = (0.0, 0.0, shape.height - shape.floor)
        builder.plane(DOWN, [low, builder.blind_hole(bottom, end, X, shape.bore / 2.0)])
        builder.plane(UP, [high])
    else:
        near, far = builder.round_hole(bottom, top, X, shape.bore / 2.0)
        builder.plane(DOWN, [low, near])
        builder.plane(UP, [high, far])
    return builder.build()


def ring_volume(shape: RingShape) -> float:
    """Volume [mm3] of a ring or cap, from its numbers."""
    bored = shape.bore**2 * (shape.height - shape.floor)
    return 0.25 * math.pi * (shape.diameter**2 * shape.height - bored)

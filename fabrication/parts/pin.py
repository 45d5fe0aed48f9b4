"""Pins: a round pin with or without a head."""

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

PIN: Final = Kind(
    role="pin",
    mark="H",
    prefix="HP",
    title="Pins",
    color=(0.62, 0.64, 0.67),
)

X: Final[Vec] = (1.0, 0.0, 0.0)
UP: Final[Vec] = (0.0, 0.0, 1.0)
DOWN: Final[Vec] = (0.0, 0.0, -1.0)


@dataclass(frozen=True)
class PinShape:
    """A round pin along z, from z = 0 to its length; its head, if any, is below z = 0.

    Without a head (0 mm) it is a length of metal rod.
    """

    diameter: float
    length: float
    head_diameter: float = 0.0
    head_height: float = 0.0

    def key(self) -> Hashable:
        """All dimensions."""
        return tuple(
            map(key_of, (self.diameter, self.length, self.head_diameter, self.head_height))
        )

    @classmethod
    def variants(cls, shapes: Sequence[Self]) -> Variants:
        """Those of one key are equal."""
        return Variants.equal(len(shapes))

    def geometry(self) -> Boundary:
        """Always exact."""
        return pin_boundary(self)

    def second_volume(self) -> float:
        """Sum of cylinders."""
        return pin_volume(self)

    def drawing(self, about: Mapping[str, Any]) -> Drawing:
        """What its sheet shows."""
        from fabrication.parts.turned_drawing import pin_drawing

        return pin_drawing(self)

    def dimensions(self) -> dict[str, Any]:
        """Length and diameter."""
        return {"length_mm": self.length, "diameter_mm": self.diameter}


def pin_boundary(shape: PinShape) -> Boundary:
    """Exact boundary of a pin.

    Raises
    ------
    DetailError
        A size that is not positive, or a head that is no wider than the pin.
    """
    if shape.diameter <= 0.0 or shape.length <= 0.0:
        raise DetailError(
            f"a pin of {shape.diameter:.6g} mm and length {shape.length:.6g} mm is not a solid"
        )
    headed = shape.head_height > 0.0
    if headed and shape.head_diameter <= shape.diameter:
        raise DetailError(
            f"the pin's head of {shape.head_diameter:.6g} mm is no wider than its shaft of "
            f"{shape.diameter:.6g} mm"
        )
    builder = BoundaryBuilder()
    foot, tip = drum(builder, (0.0, 0.0, 0.0), (0.0, 0.0, shape.length), X, shape.diameter / 2.0)
    if headed:
        under = (0.0, 0.0, -shape.head_height)
        low, high = drum(builder, under, (0.0, 0.0, 0.0), X, shape.head_diameter / 2.0)
        builder.plane(DOWN, [low])
        builder.plane(UP, [high, foot])
    else:
        builder.plane(DOWN, [foot])
    builder.plane(UP, [tip])
    return builder.build()


def pin_volume(shape: PinShape) -> float:
    """Volume [mm3] of a pin, from its numbers."""
    shaft = shape.diameter**2 * shape.length
    return 0.25 * math.pi * (shaft + shape.head_diameter**2 * shape.head_height)

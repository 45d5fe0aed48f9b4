"""Fasteners: hexagon bolts, studs, nuts and washers, without their threads.

Each has its axis along z. A bolt's head stands on z = 0 and its shank runs to z = length; nuts,
washers and studs run from z = 0 upwards.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal, Self, TypeAlias

import numpy as np

from ddgfab.errors import DetailError
from fabrication.boundary import Boundary, Vec
from fabrication.solids.builder import BoundaryBuilder
from fabrication.solids.section import segments
from fabrication.solids.sweep import End, sweep, walls
from fabrication.specs import Kind, Loop
from fabrication.standards.fasteners import Fastener
from fabrication.variants import Variants, key_of

FASTENER: Final = Kind(
    role="fastener",
    mark="F",
    prefix="FP",
    title="Fasteners",
    color=(0.72, 0.74, 0.76),
    finish="bright",
    ifc="IfcMechanicalFastener",
)

FastenerKind: TypeAlias = Literal["bolt", "stud", "nut", "washer"]

STANDARDS: Final[dict[FastenerKind, str]] = {
    "stud": "DIN 976-1",
    "nut": "ISO 4032",
    "washer": "ISO 7089",
}
"""Standards of what has one; a bolt's depends on whether it has a shank."""

WIDE: Final = "ISO 7094"
"""Standard of extra large washers."""

SIDES: Final = 6


@dataclass(frozen=True)
class FastenerShape:
    """A bolt, stud, nut or washer.

    designation : as it is ordered, "ISO 4017 M12x45"
    flats : width across flats of a head or nut; 0 without
    head : height of a bolt's head; 0 without
    outside, inside : diameters of a washer, or 0; inside also of a nut
    diameter : of shank or stud; 0 without
    length : of the shank, stud, or height of nut and washer
    """

    kind: FastenerKind
    designation: str
    flats: float
    head: float
    outside: float
    inside: float
    diameter: float
    length: float

    def key(self) -> Hashable:
        """All dimensions."""
        sizes = (
            self.flats, self.head, self.outside, self.inside, self.diameter, self.length,
        )  # fmt: skip
        return (self.designation, *map(key_of, sizes))

    @classmethod
    def variants(cls, shapes: Sequence[Self]) -> Variants:
        """Equal: the key holds all dimensions."""
        return Variants.equal(len(shapes))

    def geometry(self) -> Boundary:
        """Exact boundary.

        Raises
        ------
        DetailError
            Dimensions that make no fastener.
        """
        builder = BoundaryBuilder()
        if not self.length > 0.0 or self.inside >= max(self.flats, self.outside, 1e-9) > 1e-9:
            raise DetailError(f"{self.designation} is not a fastener")
        start, end = End(0.0, 0.0, None, -1.0), End(self.length, 0.0, None, 1.0)
        if self.kind == "bolt":
            shank = segments(_circle(self.diameter))
            foot, tip = walls(builder, _frame, shank, start, end, {})
            end.face(builder, _frame, [tip])
            sweep(
                builder,
                _frame,
                [segments(_hexagon(self.flats))],
                End(-self.head, 0.0, None, -1.0),
                End(0.0, 0.0, None, 1.0),
                {},
                [foot],
            )
            return builder.build()
        sweep(builder, _frame, [*map(segments, self._section())], start, end, {})
        return builder.build()

    def _section(self) -> list[Loop]:
        """Outline across the axis, and the hole."""
        if self.kind == "stud":
            return [_circle(self.diameter)]
        outer = _hexagon(self.flats) if self.kind == "nut" else _circle(self.outside)
        return [outer, _circle(self.inside, hole=True)]

    def second_volume(self) -> float:
        """Areas by their formulas, times their heights."""
        hexagon = 0.5 * math.sqrt(3.0) * self.flats**2
        ring = 0.25 * math.pi * (self.outside**2 - self.inside**2)
        shank = 0.25 * math.pi * self.diameter**2
        if self.kind == "bolt":
            return hexagon * self.head + shank * self.length
        return (hexagon + ring + shank) * self.length

    def dimensions(self) -> dict[str, Any]:
        """Designation and length."""
        return {"designation": self.designation, "length_mm": self.length}


def bolt(size: Fastener, length: float, *, shank: bool = False) -> FastenerShape:
    """A hexagon bolt threaded up to the head, or with a shank."""
    standard = "ISO 4014" if shank else "ISO 4017"
    name = f"{standard} {size.size}x{length:g}"
    return FastenerShape("bolt", name, size.flats, size.head, 0.0, 0.0, size.diameter, length)


def stud(size: Fastener, length: float) -> FastenerShape:
    """A stud threaded over its length."""
    name = f"{STANDARDS['stud']} {size.size}x{length:g}"
    return FastenerShape("stud", name, 0.0, 0.0, 0.0, 0.0, size.diameter, length)


def nut(size: Fastener) -> FastenerShape:
    """A hexagon nut."""
    name = f"{STANDARDS['nut']} {size.size}"
    return FastenerShape("nut", name, size.flats, 0.0, 0.0, size.diameter, 0.0, size.nut)


def washer(size: Fastener, *, wide: bool = False) -> FastenerShape:
    """A plain washer, or an extra large one."""
    inside, outside, thickness = size.wide if wide else size.washer
    name = f"{WIDE if wide else STANDARDS['washer']} {size.diameter:g}"
    return FastenerShape("washer", name, 0.0, 0.0, outside, inside, 0.0, thickness)


def _frame(u: float, v: float, w: float) -> Vec:
    return (u, v, w)


def _circle(diameter: float, *, hole: bool = False) -> Loop:
    r, turn = 0.5 * diameter, -1.0 if hole else 1.0
    return Loop(np.array([(r, 0.0), (-r, 0.0)]), np.array([turn, turn]))


def _hexagon(flats: float) -> Loop:
    r = flats / math.sqrt(3.0)
    turns = np.arange(SIDES) * (2.0 * math.pi / SIDES)
    return Loop(np.column_stack([r * np.cos(turns), r * np.sin(turns)]), np.zeros(SIDES))

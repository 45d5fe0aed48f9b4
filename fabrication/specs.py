"""The waist of the hourglass: every part as plain numbers, before any CAD.

A *shape* is what a shop makes, in a frame of its own: any frozen record with the methods of
`Shape`. A *kind* is what part numbers, groups, layers and colors go by. A *piece* is one part of a
structure: its mark, kind, shape and placement, and what its product knows of it. Congruent pieces
share a shape through `fabrication.families`. Each kind with its shapes is one room of
`fabrication.parts`; nothing else lists the kinds there are. Millimetres and radians.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, Protocol, Self, TypeAlias, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from ddgfab.mesh import Floats
from fabrication.boundary import Boundary, Cut
from fabrication.variants import Variants

Placement: TypeAlias = NDArray[np.float64]  # (4, 4) rigid motion from the part's frame to the world
Role: TypeAlias = str  # what a part is in its structure; every `Kind` names one
Color: TypeAlias = tuple[float, float, float]  # sRGB, 0..1
Finish: TypeAlias = Literal["matte", "bright", "glass", "plastic"]
Form: TypeAlias = Literal["joint", "bar", "sheet", "block"]
IfcClass: TypeAlias = Literal[
    "IfcMember", "IfcPlate", "IfcDiscreteAccessory", "IfcMechanicalFastener"
]


@dataclass(frozen=True)
class Kind:
    """What part numbers, groups, layers and colors of parts go by.

    role : what such a part is in the structure, a singular noun; names its material and clearances
    mark : begins the marks of its pieces: "B" for B-0001
    prefix : begins its part numbers: "BP" for BP-001; no two kinds of a structure share it
    title : of its group in assemblies; in capitals that of its layer
    color : in files
    finish : how light falls on it in models and pictures
    shown : its color in pictures where that is another one
    form : how pictures draw it: joints, at which bars and sheets meet, are dots from far and have
        the close-up; bars are lines from far; blocks are drawn as they are
    """

    role: Role
    mark: str
    prefix: str
    title: str
    color: Color
    finish: Finish = "plastic"
    shown: Color | None = None
    form: Form = "block"
    ifc: IfcClass = "IfcDiscreteAccessory"

    @property
    def layer(self) -> str:
        """Name of its layer in CAD files."""
        return self.title.upper()

    def mark_of(self, index: int) -> str:
        """The mark of its piece at an edge, vertex, face, bar or hinge."""
        return f"{self.mark}-{index:04d}"


class Shape(Protocol):
    """What a shop makes, in a frame of its own: a frozen record of plain numbers.

    The numbers of pieces that are congruent may differ within a tolerance; `key` is what must
    agree exactly, and `variants` gives the points by which the rest is compared.
    """

    def key(self) -> Hashable:
        """What must agree for two shapes of one class to be congruent, however they are turned."""
        ...

    @classmethod
    def variants(cls, shapes: Sequence[Self]) -> Variants:
        """Shapes of one key in the frames that a congruence may bring upon each other.

        `Variants.equal` is enough where the key holds all dimensions.
        """
        ...

    def geometry(self) -> Boundary | Cut:
        """Exact boundary in the shape's frame; a cut where that needs other curves.

        Raises
        ------
        DetailError
            The shape is impossible: value, limit and what helps are named.
        """
        ...

    def second_volume(self) -> float:
        """Volume [mm3] from the shape's numbers, independent of `geometry`; trusts the shape."""
        ...

    def dimensions(self) -> Mapping[str, Any]:
        """What schedules list, by column: names end in their units."""
        ...


@runtime_checkable
class FromStock(Protocol):
    """A shape that is sawn from a bar."""

    def stock(self) -> tuple[str, float]:
        """Name of the bar, and the length to saw [mm]."""
        ...


class Piece(Protocol):
    """One part of a structure; products have records of their own for them."""

    @property
    def mark(self) -> str:
        """Its name, once in the structure."""
        ...

    @property
    def kind(self) -> Kind:
        """What its part number, group and color go by."""
        ...

    @property
    def shape(self) -> Shape:
        """What is made."""
        ...

    @property
    def placement(self) -> Placement:
        """(4, 4) from the shape's frame to the world."""
        ...

    @property
    def checks(self) -> tuple[Check, ...]:
        """Its limits, measured where it was detailed."""
        ...


@dataclass(frozen=True, eq=False)
class Loop:
    """A closed plane curve of lines and circular arcs.

    points : (k, 2) corners; counterclockwise for an outer loop, clockwise for a hole.
    bulges : (k,) of the segment from point i to point i + 1: tan(angle / 4), positive when the arc
        turns counterclockwise (as in DXF), 0 for a line. No arc exceeds a half circle.
    """

    points: Floats
    bulges: Floats


@dataclass(frozen=True, eq=False)
class Profile:
    """Cross-section of a beam in its (y, z) plane: y across, z up; origin = the datum.

    The first loop is the outside, the others are holes. width and depth [mm] bound it.
    """

    name: str
    loops: tuple[Loop, ...]
    width: float
    depth: float


@dataclass(frozen=True)
class Check:
    """One check of one part: what was measured against which limit.

    other : mark of the second piece where the check is between two; each of them has such a check
    """

    name: str
    passed: bool
    value: float | str | None = None
    limit: float | str | None = None
    other: str | None = None


@dataclass(frozen=True)
class Mate:
    """Holes that a bolt goes through.

    mark : of the bolt
    point, axis : of the bolt's axis, where the assembly has it [mm]; the axis is a unit vector
    span : from where to where along it, from the point [mm], the holes must agree
    holes : marks of pieces, and the diameters [mm] of their holes
    """

    mark: str
    point: tuple[float, ...]
    axis: tuple[float, ...]
    span: tuple[float, float]
    holes: tuple[tuple[str, float], ...]


def rejected(pieces: Iterable[Piece]) -> frozenset[str]:
    """Marks of the pieces beyond a limit."""
    return frozenset(p.mark for p in pieces if not all(check.passed for check in p.checks))


@dataclass(frozen=True)
class Properties:
    """Volume [mm3], surface area [mm2] and centroid [mm] of a solid."""

    volume: float
    area: float
    centroid: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class TriangleMesh:
    """vertices (n, 3) float64 [mm] and triangles (m, 3) int64, outward counterclockwise."""

    vertices: Floats
    triangles: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Instance:
    """A piece as an instance of a part number: its mark and where the number's shape goes."""

    mark: str
    placement: Placement


@dataclass(frozen=True, eq=False)
class Family:
    """Congruent pieces under one part number; the shape is made once, the first instance's own.

    deviation [mm]: the greatest distance of a member's corner from where this shape puts it.
    """

    number: str
    kind: Kind
    shape: Shape
    instances: tuple[Instance, ...]
    deviation: float

    @property
    def role(self) -> Role:
        """What its pieces are in the structure."""
        return self.kind.role

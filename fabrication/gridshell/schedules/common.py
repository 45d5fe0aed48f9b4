"""What the schedules of a gridshell share: rows, masses, and where a piece's own frame lies."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final, Protocol, TypeAlias, runtime_checkable

import numpy as np

from ddgfab.mesh import Floats
from fabrication.gridshell.pieces import Beam, Node, Panel
from fabrication.gridshell.project import Project
from fabrication.parts.base import BASE
from fabrication.parts.beam import BEAM
from fabrication.parts.fastener import FASTENER
from fabrication.parts.node import NODE
from fabrication.parts.panel import PANEL
from fabrication.specs import Family, FromStock, Instance, Kind, Shape
from fabrication.standards import mass_kg
from fabrication.standards.fasteners import steel_density

Row: TypeAlias = dict[str, Any]
Masses: TypeAlias = Mapping[str, float]

MARK: Final = "piece mark, on the part and in the assembly: one piece of the structure"
NUMBER: Final = (
    "part number, and that of its drawing: pieces of one number are congruent, with one STEP file"
)


def family_masses(families: Sequence[Family], project: Project) -> dict[str, float]:
    """Mass [kg] of one instance of each part number: closed-form volume times density.

    Raises
    ------
    DetailError
        A shape that cannot be made.
    """
    from fabrication.solids import volume_of

    density = {
        BEAM.role: project.beam.density,
        NODE.role: project.node.density,
        BASE.role: project.node.density,
        PANEL.role: project.panel.density,
        FASTENER.role: steel_density(),
    }
    return {
        family.number: mass_kg(volume_of(family.shape), density[family.role]) for family in families
    }


@runtime_checkable
class Detailed(Protocol):
    """A shape that has more for the list of its kind than its dimensions."""

    def details(self) -> Mapping[str, Any]:
        """Values by column; names end in their units."""
        ...


@runtime_checkable
class WithArms(Protocol):
    """The shape of a node that has something for each of its arms."""

    def arm(self, azimuth: float | None) -> Mapping[str, Any]:
        """Values of the arm in a direction [rad] from the mark, by column with {k} for its number.

        None in every column where there is no arm.
        """
        ...


@runtime_checkable
class Described(Protocol):
    """A shape that is made of several things, which it names."""

    def described(self) -> str:
        """What they are, in a few words."""
        ...


@runtime_checkable
class WithBars(Protocol):
    """A shape with pieces that are sawn from bars, and others."""

    def bars(self) -> Sequence[tuple[str, float]]:
        """Names of the bars, and the lengths to saw [mm]."""
        ...


def bars_of(shape: Shape) -> Sequence[tuple[str, float]]:
    """Names of the bars that a part is made of, and the lengths to saw [mm]."""
    if isinstance(shape, FromStock):
        return [shape.stock()]
    return shape.bars() if isinstance(shape, WithBars) else []


def details_of(shape: Shape) -> Mapping[str, Any]:
    """What a shape has for the list of its kind, beside its dimensions."""
    return shape.details() if isinstance(shape, Detailed) else {}


def instances_of(families: Sequence[Family], kind: Kind) -> Iterator[tuple[Family, Instance]]:
    """Part numbers of a kind with each of their pieces."""
    for family in families:
        if family.kind.role == kind.role:
            for instance in family.instances:
                yield family, instance


def relative_frame(piece: Beam | Node | Panel, instance: Instance) -> Floats:
    """(4, 4) from the frame of the family's shape to the piece's own frame."""
    own, placed = piece.placement, instance.placement
    relative = np.eye(4)
    relative[:3, :3] = own[:3, :3].T @ placed[:3, :3]
    relative[:3, 3] = own[:3, :3].T @ (placed[:3, 3] - own[:3, 3])
    return relative

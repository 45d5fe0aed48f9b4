"""What a kind of connection is: what beam ends and nodes get, and which fasteners join them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Final

from ddgfab.mesh import Floats
from fabrication.parts.beam import CombEnd, PlateEnd, StrapEnd, StudEnd
from fabrication.parts.fastener import FastenerShape
from fabrication.specs import Profile
from fabrication.standards import plates
from fabrication.standards.fasteners import Fastener

if TYPE_CHECKING:
    from fabrication.gridshell.detailing.nodes.base import Joints, NodeSize
    from fabrication.gridshell.project import Project

BOLTED: Final = ("bolt", "bolt_class", "grade", "plate_mm", "fasteners")
"""Keys of [connection] that all bolted kinds have."""

THICKEST: Final = 2.0
"""Plates that the project does not name are up to so many bolt diameters thick."""


def usual_plates(size: Fastener) -> tuple[float, ...]:
    """Thicknesses [mm] for a plate that the project does not name, the usual one first.

    Those kept in stock, from the diameter of the bolt.
    """
    least, most = size.diameter, THICKEST * size.diameter
    return tuple(t for t in plates() if least <= t <= most)


def usual_plate(size: Fastener) -> float:
    """Thickness [mm] of a plate that the project does not name."""
    return usual_plates(size)[0]


@dataclass(frozen=True)
class Drilling:
    """Radial holes of nodes, tapped.

    size : of the thread, "M12"
    diameter : of the hole [mm]
    least, usual : depth of the hole [mm] that is needed, and that is taken where there is room
    thread : length of complete thread [mm] that is needed where the hole goes through a wall
    across : greatest distance of a hole's axis from the radius that it is parallel to
    """

    size: str
    diameter: float
    least: float
    usual: float
    thread: float
    across: float = 0.0

    @property
    def reach(self) -> float:
        """Greatest distance [mm] of a hole from the radius."""
        return self.across + 0.5 * self.diameter


@dataclass(frozen=True)
class Tongue:
    """Plates of nodes between cheeks of beams [mm]; distances along an arm begin at the cut.

    thickness, slot : of the plate, and from cheek to cheek
    length, depth : where the plate ends, and what the cheeks have between them
    steps : of the holes
    hole, edge : their diameter, and their least distance from the edge of the plate
    nut : how far nuts reach from their axis towards the node, and from the middle of the plate
    straps : the cheeks, where they are not what a slot leaves of the bar
    """

    thickness: float
    slot: float
    length: float
    depth: float
    steps: tuple[float, ...]
    hole: float
    edge: float
    nut: tuple[float, float]
    straps: StrapEnd | None = None


@dataclass(frozen=True)
class Discs:
    """Discs of nodes in slots across beams [mm]; distances along an arm begin at the beam's cut.

    thickness : of each disc
    width : of the strip of a disc that lies in an arm
    length : where the discs end
    steps, hole : of the holes, and their diameter
    """

    thickness: float
    width: float
    length: float
    steps: tuple[float, ...]
    hole: float


@dataclass(frozen=True)
class Mounted:
    """A fastener of a connection and where it sits on the axis.

    at : of its origin on the axis of the bolt, from the bolt's point [mm]
    towards : +1 where its z axis points along that axis, -1 against it
    """

    shape: FastenerShape
    at: float
    towards: int


@dataclass(frozen=True, eq=False)
class Joined:
    """What the connections of a project have in common, as they fit its nodes [mm].

    Attributes
    ----------
    kind : of the connection
    end, plate : what the beams' ends get
    places : (y, w) of the holes of an arm: across it counterclockwise about the node, and up along
        the node axis, from the middle of the end face
    cover : height that the node must have about the middle of each end face
    hole, depth : diameter and depth of a radial hole for each arm; no hole, or through the wall
    mounted : the fasteners of an arm, from the node outwards
    beam_hole : diameter of the hole in the beam's end
    thread : length of thread in the node that is complete
    grip : what the fastener clamps, from the seat to the head or nut
    end_length : what a beam's end takes of its length
    tongue : plates of nodes in slots of beams
    comb, offsets : slots for discs, and (E, 2) how far their middle is above that of each end face
    levels : (V,) height of the middle between the discs of each node along its axis
    weld : throat thickness of the weld, of the beam to the node or of its plate; None: no weld
    """

    kind: str
    end: StudEnd | None = None
    hole: float | None = None
    depth: float | None = None
    mounted: tuple[Mounted, ...] = ()
    beam_hole: float | None = None
    thread: float | None = None
    grip: float | None = None
    plate: PlateEnd | None = None
    places: tuple[tuple[float, float], ...] = ((0.0, 0.0),)
    cover: float = 0.0
    end_length: float = 0.0
    weld: float | None = None
    tongue: Tongue | None = None
    comb: CombEnd | None = None
    offsets: Floats | None = None
    levels: Floats | None = None


@dataclass(frozen=True)
class Connection(ABC):
    """A kind of connection.

    Attributes
    ----------
    keys : keys of [connection] that not all kinds have
    summary : what it is, for the order
    nodes : kinds of nodes that it needs, whose plates it joins; empty: all but those for others
    """

    keys: ClassVar[Sequence[str]] = ()
    summary: ClassVar[str] = ""
    nodes: ClassVar[Sequence[str]] = ()

    @classmethod
    @abstractmethod
    def of(cls, project: Project) -> Connection:
        """The one of a project."""

    def drilling(self, profile: Profile) -> Drilling | None:
        """The radial holes that nodes must have room for."""
        return None

    def of_size(self, size: Fastener) -> Connection:
        """The same with fasteners of another size, where it has such."""
        return self

    def arm_width(self, profile: Profile) -> float:
        """Width [mm] that the connection needs of the seat of an arm."""
        return 0.0

    def tongue(self, profile: Profile) -> Tongue | None:
        """The plates that nodes must have; None: no tongues."""
        return None

    def discs(self, profile: Profile) -> Discs | None:
        """The discs that nodes must have; None: no discs."""
        return None

    def check(self, joints: Joints) -> None:  # noqa: B027 - nothing to check is the usual case
        """Look at what needs no nodes: profile, end cuts.

        Raises
        ------
        DetailError
            The profile or the ends of the beams do not take it; names node and beam, the value,
            the limit, and the nearest choice that does.
        """

    @abstractmethod
    def fit(self, joints: Joints, size: NodeSize) -> Joined:
        """The connection at nodes of a size.

        Raises
        ------
        DetailError
            It does not fit; names node and beam, the value, the limit, and what does.
        """

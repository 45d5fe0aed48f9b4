"""Pieces of a gridshell: beams, nodes and panels with where they belong in the mesh.

Millimetres and radians. What is made of them is in `fabrication.parts`.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from ddgfab.mesh import Floats
from fabrication.gridshell.detailing.connections.base import Joined, Mounted
from fabrication.parts.base import BASE, BaseShape
from fabrication.parts.beam import BEAM
from fabrication.parts.fastener import FASTENER, FastenerShape
from fabrication.parts.node import NODE
from fabrication.parts.panel import PANEL, PanelShape
from fabrication.specs import Check, Kind, Placement, Shape


@dataclass(frozen=True)
class Arm:
    """A beam as a node sees it: angles [rad] about the node axis and above its normal plane."""

    edge: int
    beam: str
    azimuth: float
    elevation: float


@dataclass(frozen=True)
class Side:
    """A side of a panel: its mesh edge and the panel beyond it (None at the boundary).

    dihedral [rad]: angle between the neighbours' planes, 0 when they are flush, positive when the
    edge is convex seen from outside; 0 at the boundary.
    """

    edge: int
    neighbour: str | None
    dihedral: float


@dataclass(frozen=True, eq=False)
class Beam:
    """One beam: edge id, its vertices, left and right panels' marks; torsion [rad] of its edge.

    roll : angle [rad] about the beam's x axis from its z axis to the node axis, at start and end;
        0 without torsion, otherwise half of it to either side
    offsets : from the node axes to the cuts, along the datum of the profile [mm], at start and end
    joined : how it is joined at start and end; None where nothing is known of it
    """

    mark: str
    edge: int
    vertices: tuple[int, int]
    nodes: tuple[str, str]
    panels: tuple[str | None, str | None]
    length_axis: float
    torsion: float
    shape: Shape
    placement: Placement
    kind: Kind = field(default=BEAM, init=False)
    checks: tuple[Check, ...] = ()
    roll: tuple[float, float] = (0.0, 0.0)
    offsets: tuple[float, float] = (0.0, 0.0)
    joined: tuple[Joined, Joined] | None = None


@dataclass(frozen=True, eq=False)
class Node:
    """One node: vertex id, position and unit axis, arms counterclockwise from the marked one."""

    mark: str
    vertex: int
    position: Floats
    axis: Floats
    lean: float
    arms: tuple[Arm, ...]
    shape: Shape
    placement: Placement
    kind: Kind = NODE
    checks: tuple[Check, ...] = ()


@dataclass(frozen=True, eq=False)
class Panel:
    """One panel: face id, planarity [mm, greatest corner distance; %, diagonals], its sides."""

    mark: str
    face: int
    planarity_mm: float
    planarity_percent: float
    planarity_class: str
    sides: tuple[Side, ...]
    shape: PanelShape
    placement: Placement
    kind: Kind = field(default=PANEL, init=False)
    checks: tuple[Check, ...] = ()


@dataclass(frozen=True, eq=False)
class Bolt:
    """A bolt or stud with its nut and washers, and the holes that it goes through.

    mark : its name, "J-0000"
    node, beam : marks of what it joins
    end : 0 at the start of the mesh edge, 1 at its end
    point, axis : (3,) a point of its axis [mm], and its unit direction: where it meets the seat of
        the node, outwards, or the middle of a tongue, counterclockwise about the node
    mounted : the fasteners, along the axis
    holes : marks and diameters [mm] of the holes on the axis
    span : from where to where along the axis, from the point [mm], there are holes
    grip, thread : what it clamps, and the complete thread in the node [mm], None without
    depth : of its hole in the node [mm], None: through
    size : of its thread, "M12"
    """

    mark: str
    node: str
    beam: str
    end: int
    point: Floats
    axis: Floats
    mounted: tuple[Mounted, ...]
    holes: tuple[tuple[str, float], ...]
    span: tuple[float, float]
    grip: float
    thread: float | None
    depth: float | None
    size: str

    def named(self, mark: str) -> Bolt:
        """The same with a mark."""
        return replace(self, mark=mark)


@dataclass(frozen=True, eq=False)
class Base:
    """A base plate under a node: the node's mark and vertex, and the height of the ground [mm]."""

    mark: str
    node: str
    vertex: int
    ground: float
    shape: BaseShape
    placement: Placement
    kind: Kind = field(default=BASE, init=False)
    checks: tuple[Check, ...] = ()


@dataclass(frozen=True, eq=False)
class Anchor:
    """An anchor in the ground, and the base plate that it holds.

    point, axis : (3,) where its axis meets the ground [mm], and its direction, upwards
    mounted : rod, washer and nut, along the axis
    hole, through : diameter of its hole, and thickness of the plate [mm]
    depth : of the rod in the ground [mm]
    """

    mark: str
    base: str
    node: str
    point: Floats
    axis: Floats
    mounted: tuple[Mounted, ...]
    hole: float
    through: float
    depth: float


@dataclass(frozen=True, eq=False)
class FastenerPiece:
    """A fastener as a part of the structure: the mark of its bolt or anchor, and where it sits."""

    mark: str
    bolt: str
    shape: FastenerShape
    placement: Placement
    kind: Kind = field(default=FASTENER, init=False)
    checks: tuple[Check, ...] = ()

"""The waist of the hourglass: every part as plain numbers, before any CAD.

A *shape* is what a shop makes, in a frame of its own; a *piece* (`Beam`, `Node`, `Panel`; `Link`,
`Pin`, `Fitting`) is one part of the structure: its mark, where it belongs in the mesh or mechanism,
its shape and its placement. Millimetres and radians. Congruent pieces share a shape through
`fabrication.families`. The shapes of linkages are in `fabrication.linkspecs`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ddgfab.mesh import Floats
from fabrication.linkspecs import CouponShape, LinkShape, PinShape, RingShape

Role = Literal["beam", "node", "panel", "link", "pin", "cap", "spacer", "coupon"]
Placement: TypeAlias = NDArray[np.float64]  # (4, 4) rigid motion from the part's frame to the world


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
class EndCut:
    """How a beam ends, in the beam's frame; without torsion the node axis lies in its plane y = 0.

    x : where the cut meets the x axis [mm]
    slope, skew : a flat cut is the plane (x + slope z + skew y, y, z), parallel to the node axis;
        without torsion the axis runs along (slope, 0, 1) and skew is 0: a single mitre. A compound
        angle only where an axis leaves the plane y = 0 and is not perpendicular to the beam
    radius : None for a flat cut; else the radius [mm] of the coping cylinder, whose axis lies that
        far (perpendicularly) beyond x; its skew is 0
    """

    x: float
    slope: float
    radius: float | None = None
    skew: float = 0.0


@dataclass(frozen=True)
class CrossHole:
    """A round hole through the whole beam along y, centred at (x, z) [mm]."""

    x: float
    z: float
    diameter: float


@dataclass(frozen=True, eq=False)
class BeamShape:
    """A profile swept along x between two cuts. Frame: x start to end, y across, z up in pi(e)."""

    profile: Profile
    start: EndCut
    end: EndCut
    holes: tuple[CrossHole, ...] = ()


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


@dataclass(frozen=True, eq=False)
class PanelShape:
    """A pane between z = 0 (inner, polygon `inner`) and z = thickness (outer, polygon `outer`).

    inner, outer : (n, 2) corners before rounding, counterclockwise; equal for square sides; for
        mitred sides corresponding sides are parallel, so every side face is plane.
    corner_radius : radius [mm] of the cylinders that round the corners; 0 for sharp ones.
    """

    thickness: float
    inner: Floats
    outer: Floats
    corner_radius: float = 0.0


LinkageShape: TypeAlias = LinkShape | PinShape | RingShape | CouponShape
Shape: TypeAlias = BeamShape | NodeShape | PanelShape | LinkageShape


@dataclass(frozen=True)
class Check:
    """One check of one part: what was measured against which limit."""

    name: str
    passed: bool
    value: float | str | None = None
    limit: float | str | None = None


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
    """

    mark: str
    edge: int
    vertices: tuple[int, int]
    nodes: tuple[str, str]
    panels: tuple[str | None, str | None]
    length_axis: float
    torsion: float
    shape: BeamShape
    placement: Placement
    role: Role = field(default="beam", init=False)
    checks: tuple[Check, ...] = ()
    roll: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Node:
    """One node: vertex id, position and unit axis, arms counterclockwise from the marked one."""

    mark: str
    vertex: int
    position: Floats
    axis: Floats
    lean: float
    arms: tuple[Arm, ...]
    shape: NodeShape
    placement: Placement
    role: Role = field(default="node", init=False)
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
    role: Role = field(default="panel", init=False)
    checks: tuple[Check, ...] = ()


@dataclass(frozen=True, eq=False)
class Link:
    """One bar of a linkage: bar id, its hinges and their pins' marks, strip and direction.

    levels : of its eyes in the stacks at its two hinges, counted from 0 against the axes
    """

    mark: str
    bar: int
    hinges: tuple[int, int]
    pins: tuple[str, str]
    strip: int
    direction: int
    levels: tuple[int, int]
    shape: LinkShape
    placement: Placement
    role: Role = field(default="link", init=False)
    checks: tuple[Check, ...] = ()


@dataclass(frozen=True, eq=False)
class Pin:
    """The pin of one hinge: hinge id, position [mm] and unit axis in the design pose.

    hinge : None for the test pin of the coupon
    """

    mark: str
    hinge: int | None
    position: Floats
    axis: Floats
    shape: PinShape
    placement: Placement
    role: Role = field(default="pin", init=False)
    checks: tuple[Check, ...] = ()


@dataclass(frozen=True, eq=False)
class Fitting:
    """What else a kit holds: a cap or spacer on the pin of a hinge, or the clearance coupon.

    hinge : None for the coupon
    """

    mark: str
    role: Role
    hinge: int | None
    shape: RingShape | CouponShape
    placement: Placement
    checks: tuple[Check, ...] = ()


Piece: TypeAlias = Beam | Node | Panel | Link | Pin | Fitting


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
    """Congruent pieces under one part number; the shape is made once.

    deviation [mm]: the greatest distance of a member's corner from where this shape puts it.
    """

    number: str
    role: Role
    shape: Shape
    instances: tuple[Instance, ...]
    deviation: float

"""What a kind of node is: it sizes all nodes of a project, and gives the shape of each."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Final, Self

import numpy as np
from numpy.typing import NDArray

from ddgfab.errors import DetailError
from ddgfab.mesh import Floats, Ints
from fabrication.gridshell.detailing.connections.base import Connection, Drilling, Joined
from fabrication.gridshell.detailing.frames import Arms, EdgeFrames
from fabrication.gridshell.detailing.sections import Sections
from fabrication.gridshell.project import Project
from fabrication.parts.node import NODE
from fabrication.specs import Kind, Profile, Shape


@dataclass(frozen=True, eq=False)
class Joints:
    """Where beams meet at all nodes.

    arms : of all nodes that are sized together
    width : of the strip beside the line to the node axis that every arm needs [mm], `arm_width`
    profile : of the beams that are looked at; others may end at the same nodes
    connection : how beams are joined to the nodes
    sections : profiles of all beams
    own : (E, 2) which ends have the profile
    """

    frames: EdgeFrames
    arms: Arms
    width: float
    profile: Profile
    project: Project
    connection: Connection
    sections: Sections
    own: NDArray[np.bool_]

    @property
    def levels(self) -> tuple[Floats, Floats]:
        """Lowest and highest z (A,) [mm] of each arm's beam above its edge."""
        shift = self.project.beam.eccentricity_mm
        edge = self.arms.edge
        return self.sections.low[edge] + shift, self.sections.high[edge] + shift

    def only(self, arms: Ints) -> Joints:
        """These, with some of the arms alone."""
        return replace(self, arms=self.arms.only(arms))

    @property
    def rolled(self) -> bool:
        """Whether torsion rolls beams, so that they need wider seats."""
        return self.width > max(self.profile.width, self.connection.arm_width(self.profile))

    def ends(self, edges: Ints, ends: Ints) -> list[int]:
        """The nodes at some ends (0 or 1) of some edges."""
        node = np.zeros((len(self.frames.length), 2), dtype=np.int64)
        node[self.arms.edge, self.arms.end] = self.arms.node
        return [int(v) for v in node[edges, ends]]


MARK: Final = (3.0, 1.0)
"""Diameter and depth [mm] of the reference mark of nodes that are cut from plate."""

SLACK: Final = 1e-6
"""A distance [mm] may fall short by this, so that noise adds no step."""


def require_auto(project: Project) -> None:
    """Raise `DetailError` where the project names the size of nodes that beams and bolts size."""
    if project.node.diameter_mm != "auto":
        raise DetailError(
            f'the size of nodes of kind "{project.node.kind}" follows from beams and bolts\n'
            "leave [node] diameter_mm out"
        )


@dataclass(frozen=True)
class NodeSize(ABC):
    """Dimensions that all nodes share [mm]; each kind of node is a subclass.

    Attributes
    ----------
    radius : of the circle about the axis beyond which no node reaches
    seat : distance from the axis at which the beams are joined
    cut : distance of the beams' cuts from the axis
    width : of the strip beside the line to the axis that an arm needs
    needed : least radius that the arms allow
    forced_by : vertex of the node that needs it
    keys : keys of [node] that other kinds do not have
    kind : what part numbers, layers and colors of its nodes go by; its role is "node"
    summary : what it is made of, for the order
    welded : whether fillet welds of [connection] weld_mm hold it together
    only_with : the one kind of connection that it is for; empty: all that name no other nodes
    """

    radius: float
    seat: float
    cut: float
    width: float
    needed: float
    forced_by: int

    keys: ClassVar[tuple[str, ...]] = ()
    kind: ClassVar[Kind] = NODE
    summary: ClassVar[str] = ""
    welded: ClassVar[bool] = False
    only_with: ClassVar[str] = ""

    @classmethod
    def joined_by(cls, connection: Connection, profile: Profile) -> type[NodeSize]:
        """What nodes of this kind are with a connection: this class, unless that needs another."""
        return cls

    @classmethod
    @abstractmethod
    def fit(cls, joints: Joints) -> Self:
        """The size of the project, or the least that fits at every node.

        Raises
        ------
        DetailError
            None fits, or the project asks for what this kind does not have; names the nodes.
        """

    def hole_room(self, joints: Joints, drilling: Drilling) -> tuple[Floats, bool]:
        """Room (A,) [mm] for the radial hole of each arm, and whether it goes through a wall.

        Raises
        ------
        DetailError
            This kind of node has no radial holes, or there is too little room: names node and beam.
        """
        raise DetailError(
            f'nodes of [node] kind = "{joints.project.node.kind}" have no radial holes, as '
            f'[connection] kind = "{joints.project.connection.kind}" needs them'
        )

    def post(self, clearance: float) -> tuple[float, float]:
        """Least and greatest radius [mm] that the end of a post at the bottom of a node may have.

        Within the beams' cuts it meets no beam.
        """
        return 0.0, self.cut - clearance

    def ends(self, joints: Joints, bottom: Floats, top: Floats) -> tuple[Floats, Floats]:
        """Bottom and top (V,) [mm] of the nodes; given those that cover the ends of all arms."""
        return bottom, top

    @abstractmethod
    def shapes(
        self,
        joints: Joints,
        joined: Sequence[Joined],
        bottom: Floats,
        top: Floats,
        middle: Floats,
    ) -> Sequence[Shape]:
        """Shapes of the nodes that have arms, by vertex, in the frame of `placements`.

        The origin is the vertex, z the node axis, x the direction of the first arm.

        Parameters
        ----------
        joined : what the connection of each arm gives the node
        bottom, top : (V,) ends of the nodes along their axes, from `node_ends`
        middle : (A,) height of the middle of each arm's end face, from `end_heights`

        Raises
        ------
        DetailError
            A node cannot be made; names it.
        """

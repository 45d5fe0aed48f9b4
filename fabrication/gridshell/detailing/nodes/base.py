"""What a kind of node is: it sizes all nodes of a project, and gives the shape of each."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

from ddgfab.mesh import Floats
from fabrication.gridshell.detailing.frames import Arms, EdgeFrames
from fabrication.gridshell.project import Project
from fabrication.parts.node import NODE
from fabrication.specs import Kind, Profile, Shape


@dataclass(frozen=True, eq=False)
class Joints:
    """Where beams meet at all nodes.

    width : of the strip beside the line to the node axis that every arm needs [mm], `arm_width`
    """

    frames: EdgeFrames
    arms: Arms
    width: float
    profile: Profile
    project: Project


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
    """

    radius: float
    seat: float
    cut: float
    width: float
    needed: float
    forced_by: int

    keys: ClassVar[tuple[str, ...]] = ()
    kind: ClassVar[Kind] = NODE

    @classmethod
    @abstractmethod
    def fit(cls, joints: Joints) -> Self:
        """The size of the project, or the least that fits at every node.

        Raises
        ------
        DetailError
            None fits, or the project asks for what this kind does not have; names the nodes.
        """

    @abstractmethod
    def shapes(
        self, joints: Joints, bottom: Floats, top: Floats, middle: Floats
    ) -> Sequence[Shape]:
        """Shapes of the nodes that have arms, by vertex, in the frame of `placements`.

        The origin is the vertex, z the node axis, x the direction of the first arm.

        Parameters
        ----------
        bottom, top : (V,) ends of the nodes along their axes, from `node_ends`
        middle : (A,) height of the middle of each arm's end face, from `end_heights`

        Raises
        ------
        DetailError
            A node cannot be made; names it.
        """

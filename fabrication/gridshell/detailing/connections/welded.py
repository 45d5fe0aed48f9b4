"""Welded connections: the end of the beam on the seat of the node, no holes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Self

from fabrication.gridshell.detailing.connections.base import Connection, Joined

if TYPE_CHECKING:
    from fabrication.gridshell.detailing.nodes.base import Joints, NodeSize
    from fabrication.gridshell.project import Project


@dataclass(frozen=True)
class Welded(Connection):
    """A fillet weld round the end of the beam; its size is in the schedule."""

    summary: ClassVar[str] = "ends of the beams on the seats of the nodes, fillet welds all round"

    @classmethod
    def of(cls, project: Project) -> Self:
        """The one of a project."""
        return cls()

    def fit(self, joints: Joints, size: NodeSize) -> Joined:
        """Nothing is drilled."""
        return Joined("welded", weld=joints.project.connection.weld_mm)

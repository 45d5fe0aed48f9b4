"""The bolts of a gridshell: one for each arm of each node, and their fasteners as pieces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from ddgfab.mesh import Floats, Mesh
from fabrication.gridshell.detailing.connections.base import Joined
from fabrication.gridshell.detailing.frames import beam_mark, node_mark
from fabrication.gridshell.pieces import Bolt, FastenerPiece
from fabrication.parts.fastener import FASTENER

if TYPE_CHECKING:
    from fabrication.gridshell.detailing.nodes.base import Joints, NodeSize

MARK: Final = "J"
"""Begins the marks of bolts: J-0000."""


def bolt_specs(
    mesh: Mesh, axes: Floats, joints: Joints, size: NodeSize, joined: Joined, middle: Floats
) -> tuple[Bolt, ...]:
    """A bolt for every arm, node by node, counterclockwise; none where nothing is bolted.

    Parameters
    ----------
    axes : (V, 3) unit node axes
    middle : (A,) height of the middle of each arm's end face along the node axis [mm]
    """
    if joined.hole is None or joined.beam_hole is None:
        return ()
    assert joined.grip is not None
    assert joined.thread is not None
    arms = joints.arms
    axis = axes[arms.node]
    side = np.cross(axis, arms.x_axis[arms.node])
    cos, sin = np.cos(arms.azimuth)[:, None], np.sin(arms.azimuth)[:, None]
    radial = cos * arms.x_axis[arms.node] + sin * side
    points = mesh.vertices[arms.node] + middle[:, None] * axis + size.seat * radial
    return tuple(
        Bolt(
            f"{MARK}-{k:04d}",
            node_mark(node),
            beam_mark(edge),
            end,
            points[k],
            radial[k],
            joined.mounted,
            ((node_mark(node), joined.hole), (beam_mark(edge), joined.beam_hole)),
            joined.grip,
            joined.thread,
        )
        for k, (node, edge, end) in enumerate(
            zip(arms.node.tolist(), arms.edge.tolist(), arms.end.tolist(), strict=True)
        )
    )


def fastener_pieces(bolts: Sequence[Bolt]) -> tuple[FastenerPiece, ...]:
    """Studs, bolts, nuts and washers where they sit, from the nodes outwards."""
    pieces: list[FastenerPiece] = []
    for bolt in bolts:
        for mounted in bolt.mounted:
            placement = np.eye(4)
            z = mounted.towards * bolt.axis
            small = np.eye(3)[int(np.abs(z).argmin())]
            x = np.cross(small, z)
            x /= np.linalg.norm(x)
            placement[:3, 0], placement[:3, 1], placement[:3, 2] = x, np.cross(z, x), z
            placement[:3, 3] = bolt.point + mounted.at * bolt.axis
            placement.setflags(write=False)
            mark = FASTENER.mark_of(len(pieces))
            pieces.append(FastenerPiece(mark, bolt.mark, mounted.shape, placement))
    return tuple(pieces)

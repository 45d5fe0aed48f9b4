"""The bolts of a gridshell, arm by arm of each node, and their fasteners as pieces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from ddgfab.mesh import Floats, Ints, Mesh
from fabrication.gridshell.detailing.connections.base import Joined
from fabrication.gridshell.detailing.frames import beam_mark, node_mark
from fabrication.gridshell.pieces import Anchor, Bolt, FastenerPiece
from fabrication.parts.fastener import FASTENER

if TYPE_CHECKING:
    from fabrication.gridshell.detailing.nodes.base import Joints, NodeSize

MARK: Final = "J"
"""Begins the marks of bolts: J-0000."""


def bolt_specs(
    mesh: Mesh,
    axes: Floats,
    joints: Joints,
    size: NodeSize,
    joined: Joined,
    middle: Floats,
    own: Ints,
) -> list[tuple[int, Bolt]]:
    """The bolts of some arms with the number of their arm; none where nothing is bolted.

    Parameters
    ----------
    axes : (V, 3) unit node axes
    middle : (A,) height of the middle of each arm's end face along the node axis [mm]
    own : the arms that are joined so
    """
    if joined.beam_hole is None or joined.grip is None:
        return []
    arms = joints.arms
    axis = axes[arms.node]
    side = np.cross(axis, arms.x_axis[arms.node])
    cos, sin = np.cos(arms.azimuth)[:, None], np.sin(arms.azimuth)[:, None]
    radial = cos * arms.x_axis[arms.node] + sin * side
    # (bolts, A): distances from the node axis, heights along it; directions of the bolts
    across: Floats = np.zeros((1, 1))
    if joined.levels is not None and joined.comb is not None:
        steps = np.array(joined.comb.steps)[:, None]
        rho = np.broadcast_to(size.cut + steps, (len(steps), len(radial)))
        node_hole, along = joined.hole, axis
        heights = np.broadcast_to(joined.levels[arms.node], rho.shape)
        span = (-0.5 * joined.grip, 0.5 * joined.grip)
    elif joined.tongue is None:
        assert joined.thread is not None
        across, up = np.array(joined.places).T[:, :, None]
        rho, node_hole = np.full((len(up), len(radial)), size.seat), joined.hole
        heights, along = middle + up, radial
        span = (-joined.thread, joined.grip)
    else:
        slope = joints.frames.slope[arms.edge, arms.end] * (1 - 2 * arms.end)
        steps = np.array(joined.tongue.steps)[:, None]
        rho = np.broadcast_to(size.cut + steps, (len(steps), len(radial)))
        node_hole = joined.tongue.hole
        heights, along = middle + slope * steps, np.cross(axis, radial)
        half = 0.5 * joints.profile.width
        span = (-half, half)
    assert node_hole is not None
    origin = mesh.vertices[arms.node]
    points = origin + heights[..., None] * axis + rho[..., None] * radial
    points = points + across[..., None] * np.cross(axis, radial)
    bolts: list[tuple[int, Bolt]] = []
    for k in own.tolist():
        node, edge, end = int(arms.node[k]), int(arms.edge[k]), int(arms.end[k])
        marks = node_mark(node), beam_mark(edge)
        holes = ((marks[0], node_hole), (marks[1], joined.beam_hole))
        for point in points[:, k]:
            bolts.append(
                (
                    k,
                    Bolt(
                        "",
                        *marks,
                        end,
                        point,
                        along[k],
                        joined.mounted,
                        holes,
                        span,
                        joined.grip,
                        joined.thread,
                        joined.depth,
                        joints.project.connection.bolt,
                    ),
                )
            )
    return bolts


def fastener_pieces(bolts: Sequence[Bolt | Anchor]) -> tuple[FastenerPiece, ...]:
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

"""Nodes as pieces: every vertex that faces use, with its place, arms, shape and limits."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ddgfab.measures import lean
from ddgfab.mesh import Floats, Mesh
from fabrication.gridshell.detailing.connections.base import Joined
from fabrication.gridshell.detailing.frames import beam_mark, node_mark
from fabrication.gridshell.detailing.nodes.base import Joints, NodeSize
from fabrication.gridshell.pieces import Arm, Node
from fabrication.specs import Check


def node_specs(
    mesh: Mesh,
    axes: Floats,
    joints: Joints,
    size: NodeSize,
    joined: Sequence[Joined],
    ends: tuple[Floats, Floats],
    middle: Floats,
) -> tuple[Node, ...]:
    """A node for every vertex that faces use.

    Parameters
    ----------
    axes : (V, 3) unit node axes
    joined : what the connection of each arm gives the node
    ends : bottom and top (V,) along them [mm], from `node_ends`
    middle : (A,) height of the middle of each arm's end face [mm], from `end_heights`

    Raises
    ------
    DetailError
        A node cannot be made; see the kind of node.
    """
    arms, project = joints.arms, joints.project
    shapes = size.shapes(joints, joined, ends[0], ends[1], middle)
    leans = lean(mesh, axes).tolist()
    least = project.checks.min_angle_deg
    closest = np.degrees(arms.gap).tolist()
    limit = project.support.lean_limit_deg
    placements = np.zeros((mesh.n_vertices, 4, 4))
    placements[:, :3, 0], placements[:, :3, 2] = arms.x_axis, axes
    placements[:, :3, 1] = np.cross(axes, arms.x_axis)
    placements[:, :3, 3], placements[:, 3, 3] = mesh.vertices, 1.0
    placements.setflags(write=False)
    azimuths, elevations = arms.azimuth.tolist(), arms.elevation.tolist()
    edges, starts = arms.edge.tolist(), arms.start.tolist()
    used = np.flatnonzero(np.diff(arms.start)).tolist()
    nodes = []
    for v, shape in zip(used, shapes, strict=True):
        own = range(starts[v], starts[v + 1])
        degrees, angle = float(np.degrees(leans[v])), min(closest[k] for k in own)
        nodes.append(
            Node(
                mark=node_mark(v),
                vertex=v,
                position=mesh.vertices[v],
                axis=axes[v],
                lean=leans[v],
                arms=tuple(
                    Arm(edges[k], beam_mark(edges[k]), azimuths[k], elevations[k]) for k in own
                ),
                shape=shape,
                placement=placements[v],
                kind=size.kind,
                checks=(
                    Check("lean_deg", degrees <= limit, degrees, limit),
                    Check("least_angle_deg", angle >= least, angle, least),
                ),
            )
        )
    return tuple(nodes)

"""What messages about nodes say of the arms that force them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from fabrication.gridshell.detailing.arm_room import arm_width, least_radii
from fabrication.gridshell.detailing.frames import Arms, beam_mark, node_mark
from fabrication.gridshell.detailing.nodes.base import Joints
from fabrication.standards import node_diameters
from fabrication.standards.fasteners import fastener, fasteners
from fabrication.standards.profiles import z_range

if TYPE_CHECKING:
    from fabrication.gridshell.detailing.nodes.round import Cylinder


def middle(joints: Joints) -> str:
    """What helps beside a narrower profile where torsion rolls it about an edge off its middle."""
    centered = -0.5 * sum(z_range(joints.profile))
    if not joints.rolled:
        return ""
    if joints.project.beam.eccentricity_mm == centered:
        return ""
    return f", [beam] eccentricity_mm = {centered:g}"


def rolled(joints: Joints) -> str:
    """Why seats are wider than the profile."""
    if not joints.rolled:
        return ""
    return f" at their ends ({joints.profile.name} rolled by torsion)"


def forced(arms: Arms, k: int) -> str:
    """An arm and the next one, with their node and angle."""
    other = int(arms.following()[k])
    return (
        f"node {node_mark(arms.node[k])} has beams {beam_mark(arms.edge[k])} and "
        f"{beam_mark(arms.edge[other])} at {np.degrees(arms.gap[k]):.1f} deg"
    )


def smaller(kind: type[Cylinder], joints: Joints) -> str:
    """What helps beside a narrower profile where bolts make the seats wide, or need depth."""
    drilling, node = joints.connection.drilling(joints.profile), joints.project.node
    if drilling is None:
        return ""
    given = node.diameter_mm
    series = sorted(node.series_mm) or list(node_diameters(kind.series))
    bare = arm_width(joints.frames, joints.profile, joints.project)
    for size in reversed(fasteners()):
        if size.diameter >= fastener(drilling.size).diameter:
            continue
        other = joints.connection.of_size(size)
        width = max(bare, other.arm_width(joints.profile))
        trial = replace(joints, connection=other, width=width)
        needed = float(least_radii(joints.arms, width, node.arm_clearance_mm).max())
        sizes = (kind._of(d, needed, 0, trial) for d in (series if given == "auto" else [given]))
        if any(not found.misfit(trial) for found in sizes):
            return f'[connection] bolt = "{size.size}"'
    wall = " with a thicker [node] wall_mm" * (kind.series == "tube")
    return f"a smaller [connection] bolt{wall}"

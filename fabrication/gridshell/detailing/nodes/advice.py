"""What messages about nodes say of the arms that force them."""

from __future__ import annotations

import numpy as np

from fabrication.gridshell.detailing.frames import Arms, beam_mark, node_mark
from fabrication.gridshell.detailing.nodes.base import Joints
from fabrication.standards.profiles import z_range


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

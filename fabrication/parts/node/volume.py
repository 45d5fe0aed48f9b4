"""Volume of a node by a second route: circular segments and the integrals of its holes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from ddgfab.mesh import Floats
from fabrication.parts.node.drills import Drill, drills
from fabrication.solids.section import gauss

if TYPE_CHECKING:
    from fabrication.parts.node.shape import NodeShape

NODES: Final = 96
"""Nodes of the quadrature; the integrands have square roots that end near the range."""


def drill_volume(shape: NodeShape, drill: Drill) -> float:
    """Volume [mm3] that a radial hole takes, over its disc with y = r sin(theta) across."""
    r = drill.hole.diameter / 2.0
    s, weight = gauss(NODES)
    theta = (s - 0.5) * math.pi
    across = drill.hole.across + r * np.sin(theta)
    outer: float | Floats = (
        np.sqrt(shape.radius**2 - across**2)
        if drill.seat is None
        else shape.seats[drill.seat].distance
    )
    inner = np.sqrt(shape.bore**2 - across**2) if drill.bottom is None else drill.bottom
    return float(np.sum(weight * math.pi * 2.0 * (r * np.cos(theta)) ** 2 * (outer - inner)))


def node_volume(shape: NodeShape) -> float:
    """Volume [mm3] of a node: circle less the seats' segments and the bore, less the holes."""
    area = math.pi * (shape.radius**2 - shape.bore**2)
    for seat in shape.seats:
        half = math.acos(seat.distance / shape.radius)
        area -= shape.radius**2 * (half - 0.5 * math.sin(2.0 * half))
    total = area * (shape.z1 - shape.z0)
    total -= sum(drill_volume(shape, drill) for drill in drills(shape))
    if shape.mark is not None:
        total -= math.pi * shape.mark.diameter**2 / 4.0 * shape.mark.depth
    return total

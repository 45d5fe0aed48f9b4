"""Volumes by a second route, straight from the shape and without its boundary.

A beam is the integral of its length over its profile, a node is circular segments, a panel a
prismatoid. The tests hold these against the divergence theorem; shapes without an exact boundary
have no other volume that does without the kernel.
"""

from __future__ import annotations

import math

import numpy as np

from ddgfab.mesh import Floats
from fabrication.solids.beam import ends_of, hole_walls
from fabrication.solids.node import Drill, drills
from fabrication.solids.section import gauss, integrate, segments
from fabrication.solids.sweep import End
from fabrication.specs import BeamShape, NodeShape, PanelShape

NODES = 96
"""Nodes of the quadrature; the integrands have square roots that end near the range."""


def _length_antiderivative(end: End, u: Floats, v: Floats) -> Floats:
    """Integral over u of the height at which a sweep ends."""
    flat = np.asarray(u * (end.at + end.slope * v + 0.5 * end.skew * u))
    if end.radius is None:
        return flat
    r = end.radius
    root = 0.5 * (u * np.sqrt(r * r - u * u) + r * r * np.arcsin(u / r))
    return np.asarray(flat + end.outward * end.stretch * (r * u - root))


def beam_volume(shape: BeamShape) -> float:
    """Volume [mm3] of a beam: length integrated over the profile, less the holes in its walls."""
    start, end = ends_of(shape)
    total = integrate(
        shape.profile.loops,
        lambda u, v: _length_antiderivative(end, u, v) - _length_antiderivative(start, u, v),
        NODES,
    )
    loops = [segments(loop) for loop in shape.profile.loops]
    for hole in shape.holes:
        faces = [y for _, y in hole_walls(shape, hole, loops)]
        through = sum(faces[1::2]) - sum(faces[::2])
        total -= math.pi * hole.diameter**2 / 4.0 * through
    return total


def drill_volume(shape: NodeShape, drill: Drill) -> float:
    """Volume [mm3] that a radial hole takes, over its disc with y = r sin(theta) across."""
    r = drill.hole.diameter / 2.0
    s, weight = gauss(NODES)
    theta = (s - 0.5) * math.pi
    across = r * np.sin(theta)
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


def polygon_area(polygon: Floats) -> float:
    """Signed area of an (n, 2) polygon, positive counterclockwise."""
    after = np.roll(polygon, -1, axis=0)
    return 0.5 * float(np.sum(polygon[:, 0] * after[:, 1] - polygon[:, 1] * after[:, 0]))


def panel_volume(shape: PanelShape) -> float:
    """Volume [mm3] of a panel: prismatoid (Simpson is exact), less what rounding its corners takes.

    Each rounding takes r^2 (tan(turn / 2) - turn / 2) across the corner line, all along it.
    """
    middle = 0.5 * (shape.inner + shape.outer)
    areas = [polygon_area(polygon) for polygon in (shape.inner, middle, shape.outer)]
    total = shape.thickness / 6.0 * (areas[0] + 4.0 * areas[1] + areas[2])
    if shape.corner_radius > 0.0:
        along = np.roll(shape.inner, -1, axis=0) - shape.inner
        sides = np.column_stack([along, np.zeros(len(along))])
        lines = np.column_stack([shape.outer - shape.inner, np.full(len(along), shape.thickness)])
        normals = np.cross(sides, lines)
        before = np.roll(normals, 1, axis=0)
        length = np.linalg.norm(lines, axis=1)
        sine = np.sum(np.cross(before, normals) * lines, axis=1) / length
        turn = np.arctan2(sine, np.sum(before * normals, axis=1))
        taken = np.tan(turn / 2.0) - turn / 2.0
        total -= shape.corner_radius**2 * float(np.sum(taken * length))
    return total

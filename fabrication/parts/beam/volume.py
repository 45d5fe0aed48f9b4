"""Volume of a beam by a second route: the integral of its length over its profile."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from ddgfab.mesh import Floats
from fabrication.parts.beam.boundary import ends_of, hole_walls, opening_sides
from fabrication.parts.beam.comb import comb_volume
from fabrication.parts.beam.end_plate import bar_of, plate_volume
from fabrication.parts.beam.slot import slot_volume, strips
from fabrication.parts.beam.straps import straps_volume
from fabrication.parts.beam.stud import inner_end, lower_wall, opening_area
from fabrication.solids.section import integrate, segments
from fabrication.solids.sweep import End
from fabrication.specs import Loop

if TYPE_CHECKING:
    from fabrication.parts.beam.shape import BeamShape

NODES: Final = 96
"""Nodes of the quadrature; the integrands have square roots that end near the range."""


def _length_antiderivative(end: End, u: Floats, v: Floats) -> Floats:
    """Integral over u of the height at which a sweep ends."""
    flat = np.asarray(u * (end.at + end.slope * v + 0.5 * end.skew * u))
    if end.radius is None:
        return flat
    r = end.radius
    root = 0.5 * (u * np.sqrt(r * r - u * u) + r * r * np.arcsin(u / r))
    return np.asarray(flat + end.outward * end.stretch * (r * u - root))


def _between(loops: Sequence[Loop], start: End, end: End) -> float:
    """Volume [mm3] within loops between two ends; negative for holes, which run clockwise."""
    return integrate(
        loops,
        lambda u, v: _length_antiderivative(end, u, v) - _length_antiderivative(start, u, v),
        NODES,
    )


def beam_volume(shape: BeamShape) -> float:
    """Volume [mm3] of a beam: length integrated over the profile, less holes and openings."""
    start, end = ends_of(bar_of(shape))
    total = _between(shape.profile.loops[:1], start, end)
    loops = [segments(loop) for loop in shape.profile.loops]
    for cut, outward in ((shape.start, -1.0), (shape.end, 1.0)):
        if cut.stud is None:
            continue
        total -= math.pi * cut.stud.diameter**2 / 4.0 * cut.stud.plate
        if len(loops) > 1:
            outer, inner = lower_wall(loops, shape.profile.name)
            through = loops[1][inner].v0 - loops[0][outer].v0
            start, end = (
                (inner_end(cut, outward), end) if outward < 0 else (start, inner_end(cut, outward))
            )
        else:
            (_, right), (_, left) = opening_sides(shape, cut, outward, loops)
            through = left - right
        total -= opening_area(cut, hollow=len(loops) > 1) * through
    total -= comb_volume(shape) if shape.start.comb or shape.end.comb else 0.0
    total += sum(
        plate_volume(cut.plate) for cut in (shape.start, shape.end) if cut.plate is not None
    )
    if len(loops) > 1:
        total += _between(shape.profile.loops[1:], start, end)
    if shape.start.straps is not None or shape.end.straps is not None:
        return total + straps_volume(shape)
    if shape.start.slot is not None or shape.end.slot is not None:
        for hole in shape.holes:
            through = sum(y1 - y0 for y0, y1 in strips(shape, hole))
            total -= math.pi * hole.diameter**2 / 4.0 * through
        return total - slot_volume(shape)
    for hole in shape.holes:
        faces = [y for _, y in hole_walls(shape, hole, loops)]
        through = sum(faces[1::2]) - sum(faces[::2])
        total -= math.pi * hole.diameter**2 / 4.0 * through
    return total

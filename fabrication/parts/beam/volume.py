"""Volume of a beam by a second route: the integral of its length over its profile."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from ddgfab.mesh import Floats
from fabrication.parts.beam.boundary import ends_of, hole_walls
from fabrication.solids.section import integrate, segments
from fabrication.solids.sweep import End

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

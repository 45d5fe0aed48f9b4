"""Circular nets from a torus: patches of Dupin cyclides, all of whose lines are circles."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from ddgfab.errors import DegenerateError
from ddgfab.forms.generators import About, generator
from ddgfab.forms.placing import checked_forward, grounded
from ddgfab.forms.rotational import rotational_net
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Floats, Mesh
from ddgfab.transforms.moebius import invert


@generator("circular")
def cyclide_roof(
    panels_along: Annotated[int, About("panels along the ridge", 1, 1000)] = 14,
    panels_across: Annotated[int, About("panels across it", 1, 1000)] = 6,
    length_mm: Annotated[float, About("length of the ridge in plan before widening", 1e-3)] = 21000,
    radius_mm: Annotated[float, About("radius of the arches half way", 1e-3)] = 6000.0,
    turn_deg: Annotated[float, About("turn of the ridge in plan", -300, 300)] = 70.0,
    arch_deg: Annotated[float, About("part of the full circle that is covered", 5, 300)] = 100.0,
    widening: Annotated[
        float, About("how much larger panels are at the wide end than at the narrow one", 0.1, 10)
    ] = 1.8,
) -> Mesh:
    """Horn-shaped vault whose ribs and long lines are all circles, a piece of a Dupin cyclide.

    An arched piece of a torus under one inversion, which keeps circles: a circular net, so it has
    a parallel one at a constant distance of vertices.

    Raises
    ------
    ParameterError
        A parameter of the wrong type or beyond its limits.
    DegenerateError
        No turn at all (the torus becomes a cylinder), or a turn so sharp that the tube reaches
        the axis of the torus; names the radii or the panel.

    Source: Dupin cyclides are the images of tori under inversions; mathematics.md 2.6, 2.7.
    """
    turn = np.radians(turn_deg)
    if turn == 0.0:
        raise DegenerateError("turn_deg = 0 makes the torus a cylinder; take 0.01 or more")
    ring = length_mm / abs(turn)
    inside = ring - radius_mm * np.sin(min(0.5 * np.radians(arch_deg), 0.5 * np.pi))
    if inside <= 0.0:
        raise DegenerateError(
            f"the ridge turns with a radius of {ring:.6g} mm, and the arch reaches "
            f"{ring - inside:.6g} mm to its inside: beyond the axis of the turn\n"
            "take less turn_deg or arch_deg, a smaller radius_mm or more length_mm"
        )
    # The arch runs from the outside inwards, so that normals point up.
    angle = np.radians(np.linspace(90.0 - 0.5 * arch_deg, 90.0 + 0.5 * arch_deg, panels_across + 1))
    meridian = np.stack([ring + radius_mm * np.cos(angle), radius_mm * np.sin(angle)], axis=1)
    way = np.linspace(-0.5, 0.5, panels_along + 1)
    net = rotational_net(meridian, abs(turn) * way)
    return grid_mesh(grounded(checked_forward(_widened(net, ring, length_mm, widening))))


def _widened(net: Floats, ring: float, length: float, widening: float) -> Floats:
    """Inversion about a point on the ground behind the narrow end, mirrored back."""
    if widening == 1.0:
        return net
    # Scale goes with 1 / distance^2; the ridge's middle (at x = ring) keeps its size.
    ratio = np.sqrt(max(widening, 1.0 / widening))
    near = length / (ratio - 1.0)
    side = np.sign(widening - 1.0)
    center = np.array([ring, side * (near + 0.5 * length), 0.0])
    image = invert(net, center, near + 0.5 * length)
    return np.asarray((image - [0.0, center[1], 0.0]) * [1.0, -1.0, 1.0])

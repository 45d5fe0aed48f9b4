"""The built-in example: a station canopy, S-shaped in plan, arched, wider at one end.

A discrete Monge surface (plane profile carried along a spine by reflections) under an inversion
that makes one end wider than the other. Both steps keep quads circular and normals by reflection
torsion-free, so the canopy is exact: planar panels, circular, torsion zero to rounding.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from ddgfab.forms.generators import About, generator
from ddgfab.forms.monge_surface import level_start, monge, profile_polyline
from ddgfab.forms.placing import checked_forward, grounded
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Floats, Mesh
from ddgfab.transforms.moebius import invert


@generator("canopy")
def canopy(
    panels_along: Annotated[int, About("panels along the spine", 1, 1000)] = 28,
    panels_across: Annotated[int, About("panels across it", 1, 1000)] = 11,
    panel_mm: Annotated[
        float,
        About(
            "side of a panel on the spine at mid-length; others are smaller on the inside of bends "
            "and at the narrow end",
            1e-3,
        ),
    ] = 1400.0,
    *,
    bend_deg: Annotated[float, About("swing of the spine to either side, as an S", -59, 59)] = 16.0,
    rise_deg: Annotated[
        float, About("slope at which the spine climbs at one end and falls at the other", -59, 59)
    ] = 11.0,
    wall_deg: Annotated[float, About("slope at the low eave; 90: like a wall", -120, 120)] = 62.0,
    fall_deg: Annotated[float, About("slope behind the crest, downwards", -120, 120)] = 26.0,
    eave_deg: Annotated[
        float, About("slope at the far eave; positive: turned up like a wing", -120, 120)
    ] = 2.0,
    turn: Annotated[
        float, About("where across the roof the upward arc begins, from 0 to 1", 0.01, 0.99)
    ] = 0.7,
    flare: Annotated[
        float, About("how much larger panels are at the wide end than at the narrow", 0.1, 10)
    ] = 1.6,
) -> Mesh:
    """Station canopy, S-shaped in plan, arched, wider at one end; a circular net (the example).

    Raises
    ------
    ParameterError
        A parameter of the wrong type or beyond its limits.
    DegenerateError
        A bend so sharp that a panel folds over; names it.

    Source: monge surfaces by reflection and vertex normals, mathematics.md 2.7; Moebius invariance
    of circular nets, Bobenko and Suris, Discrete Differential Geometry, 3.1.
    """
    net = canopy_net(
        panels_along,
        panels_across,
        panel_mm,
        slopes_deg=(wall_deg, -fall_deg, eave_deg),
        spine_deg=(bend_deg, rise_deg),
        turn=turn,
        flare=flare,
    )
    return grid_mesh(grounded(checked_forward(net)))


def canopy_net(
    panels_along: int,
    panels_across: int,
    panel_mm: float,
    *,
    slopes_deg: tuple[float, float, float],
    spine_deg: tuple[float, float],
    turn: float,
    flare: float,
) -> Floats:
    """(M + 1, N + 1, 3) circular net of a canopy; parameters as in `canopy`.

    `slopes_deg` are those of the cross-section at its low eave, where it turns, and at its far
    eave; `spine_deg` are the spine's bend and rise.
    """
    # Slopes linear along the way make two arcs that meet with one tangent.
    way = np.linspace(0.0, 1.0, panels_across + 1)
    slope = np.interp(way, [0.0, turn, 1.0], np.radians(slopes_deg))
    across = profile_polyline(slope, np.full(panels_across, panel_mm))
    across -= [0.5 * (across[0, 0] + across[-1, 0]), across[0, 1]]
    bend, rise = np.radians(spine_deg)
    tangents = _spine_tangents(panels_along, bend, rise)
    steps = np.full(panels_along, panel_mm)
    net = monge(across, tangents, steps, level_start(tangents, steps))
    return _flared(net, panels_along * panel_mm, flare)


def _spine_tangents(count: int, bend: float, rise: float) -> Floats:
    """(count + 1, 3) tangents of an S in plan that rises and falls."""
    way = np.linspace(0.0, 1.0, count + 1)
    yaw, pitch = bend * np.cos(2 * np.pi * way), rise * np.cos(np.pi * way)
    return np.stack(
        [np.cos(pitch) * np.cos(yaw), np.cos(pitch) * np.sin(yaw), np.sin(pitch)], axis=1
    )


def _flared(net: Floats, length: float, flare: float) -> Floats:
    """Inversion on the ground behind one end, mirrored back; scale 1 at half the length."""
    if flare == 1.0:
        return net
    # Scale goes with 1 / distance^2, from the start (distance d) to the end (d + length).
    distance = length / (np.sqrt(flare) - 1.0)
    image = invert(net, [-distance, 0.0, 0.0], abs(distance + 0.5 * length))
    return np.asarray(image * [-1.0, 1.0, 1.0])

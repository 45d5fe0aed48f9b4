"""The built-in example: a station canopy, S-shaped in plan, arched, wider at one end.

A discrete Monge surface (plane profile carried along a spine by reflections) under an inversion
that makes one end wider than the other. Both steps keep quads circular and normals by reflection
torsion-free, so the canopy is exact: planar panels, circular, torsion zero to rounding.
"""

from __future__ import annotations

import numpy as np

from ddgfab.errors import InputError
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.nets.grid import grid_mesh
from ddgfab.nets.monge import monge, profile_polyline
from ddgfab.transforms.moebius import invert


def canopy(
    panels_along: int = 28,
    panels_across: int = 11,
    panel_mm: float = 1400.0,
    *,
    bend_deg: float = 16.0,
    rise_deg: float = 11.0,
    wall_deg: float = 62.0,
    fall_deg: float = 26.0,
    eave_deg: float = 2.0,
    turn: float = 0.7,
    flare: float = 1.6,
) -> Mesh:
    """Circular quad mesh of a station canopy [mm], z up, normals up, lowest corner at z = 0.

    Parameters
    ----------
    panels_along, panels_across : number of panels along the spine and across it
    panel_mm : side of a panel on the spine at mid-length [mm]; others are smaller on the inside
        of bends and at the narrow end, larger on the outside and at the wide end
    bend_deg : how far the spine swings to either side, as in an S; 0: straight
    rise_deg : slope at which the spine climbs at one end and falls at the other; 0: level
    wall_deg : how steeply the roof begins at its low eave (90: like a wall)
    fall_deg : how steeply it falls again behind its crest
    eave_deg : slope at the far eave; positive: turned up like the tip of a wing
    turn : where across the roof the fall is steepest and the upward arc begins, 0..1
    flare : how much larger panels are at the wide end than at the narrow end; 1: not at all

    Raises
    ------
    InputError
        Fewer than one panel, a size or flare that is not positive, a turn outside 0..1, or a
        spine that climbs or swings by 60 degrees or more.

    Source: monge surfaces by reflection and vertex normals, maths.md 2.7; Moebius invariance of
    circular nets, Bobenko and Suris, Discrete Differential Geometry, 3.1.
    """
    if min(panels_along, panels_across) < 1 or not panel_mm > 0:
        raise InputError(
            f"a canopy of {panels_along} x {panels_across} panels of {panel_mm:g} mm: "
            "at least one panel each way and a positive size are needed"
        )
    if not (0 < turn < 1 and flare > 0):
        raise InputError(f"turn {turn:g} must lie between 0 and 1, flare {flare:g} above 0")
    if not max(abs(bend_deg), abs(rise_deg)) < _STEEPEST_DEG:
        raise InputError(
            f"bend {bend_deg:g} and rise {rise_deg:g} deg: limit {_STEEPEST_DEG:g} deg"
        )
    # Slopes linear along the way make two arcs that meet with one tangent.
    way = np.linspace(0.0, 1.0, panels_across + 1)
    slope = np.interp(way, [0.0, turn, 1.0], np.radians([wall_deg, -fall_deg, eave_deg]))
    across = profile_polyline(slope, np.full(panels_across, panel_mm))
    across -= [0.5 * (across[0, 0] + across[-1, 0]), across[0, 1]]
    tangents = _spine_tangents(panels_along, np.radians(bend_deg), np.radians(rise_deg))
    steps = np.full(panels_along, panel_mm)
    net = monge(across, tangents, steps, _level(tangents, steps))
    net = _flared(net, panels_along * panel_mm, flare)
    net -= [*net.reshape(-1, 3)[:, :2].mean(axis=0), net[..., 2].min()]
    return grid_mesh(net)


_STEEPEST_DEG = 60.0
"""Slope of the spine [deg] from which a canopy is no longer one."""


def _spine_tangents(count: int, bend: float, rise: float) -> Floats:
    """(count + 1, 3) tangents of an S in plan that rises and falls."""
    way = np.linspace(0.0, 1.0, count + 1)
    yaw, pitch = bend * np.cos(2 * np.pi * way), rise * np.cos(np.pi * way)
    return np.stack(
        [np.cos(pitch) * np.cos(yaw), np.cos(pitch) * np.sin(yaw), np.sin(pitch)], axis=1
    )


def _level(tangents: Floats, steps: Floats) -> Floats:
    """Upward direction at the start for which the profiles' roll is as far left as right.

    A rotation-minimising frame rolls where a spine both climbs and bends.
    """
    left = unit(np.cross([0.0, 0.0, 1.0], tangents[0]))
    up = np.cross(tangents[0], left)
    bar = monge([[0.0, 0.0], [1.0, 0.0]], tangents, steps, up)
    roll = np.arcsin(bar[:, 1, 2] - bar[:, 0, 2])
    middle = 0.5 * (roll.min() + roll.max())
    return np.asarray(np.cos(middle) * up + np.sin(middle) * left)


def _flared(net: Floats, length: float, flare: float) -> Floats:
    """Inversion on the ground behind one end, mirrored back; scale 1 at half the length."""
    if flare == 1.0:
        return net
    # Scale goes with 1 / distance^2, from the start (distance d) to the end (d + length).
    distance = length / (np.sqrt(flare) - 1.0)
    image = invert(net, [-distance, 0.0, 0.0], abs(distance + 0.5 * length))
    return np.asarray(image * [-1.0, 1.0, 1.0])

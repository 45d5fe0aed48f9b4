"""Generators of K-nets from their boundary: any turns, and the two straight lines of Amsler."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from ddgfab.forms.generators import About, generator
from ddgfab.forms.knet_sheets import crossing_lines, levelled, roof
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Mesh
from ddgfab.nets.knet.net import knet


@generator("knet", support="normals")
def knet_roof(
    panels_along: Annotated[int, About("panels along the first boundary", 1, 1000)] = 14,
    panels_across: Annotated[int, About("panels along the second", 1, 1000)] = 10,
    bar_mm: Annotated[
        float, About("length of the bars along the first, node to node", 1e-3)
    ] = 1200.0,
    twist_deg: Annotated[float, About("twist of these bars", 0.1, 80)] = 8.0,
    across_twist_deg: Annotated[
        float, About("twist of the bars across; equal twists: equal bars", 0.1, 80)
    ] = 8.0,
    corner_deg: Annotated[
        float, About("angle of the two boundaries at their corner", 1, 179)
    ] = 70.0,
    bend_along_deg: Annotated[
        float, About("how far the first boundary bends within the surface", -720, 720)
    ] = 40.0,
    bend_across_deg: Annotated[
        float, About("how far the second boundary bends within the surface", -720, 720)
    ] = -30.0,
) -> Mesh:
    """Saddle roof of two kinds of bars, of constant curvature: the K-net from two of its edges.

    Both boundaries are freely chosen; bars of one direction all have one length and one twist.

    Raises
    ------
    ParameterError
        A parameter of the wrong type or beyond its limits.
    DegenerateError
        A net that folds up; names the cell.

    Source: `ddgfab.nets.knet.net.knet`; mathematics.md 3.5.
    """
    deltas = [
        np.full(panels_along, np.radians(twist_deg)),
        np.full(panels_across, np.radians(across_twist_deg)),
    ]
    turns = [
        np.full(n - 1, np.radians(bend) / max(n - 1, 1))
        for n, bend in ((panels_along, bend_along_deg), (panels_across, bend_across_deg))
    ]
    r = bar_mm / np.sin(deltas[0][0])
    net = knet(deltas, turns, np.radians(corner_deg), r=float(r))
    return roof(levelled(grid_mesh(net.points)))


@generator("amsler", support="normals")
def amsler_roof(
    panels_along: Annotated[
        int, About("panels from the crossing along either half line", 1, 500)
    ] = 7,
    panels_across: Annotated[
        int, About("panels from the crossing along the other line", 1, 500)
    ] = 7,
    bar_mm: Annotated[float, About("length of every bar, node to node", 1e-3)] = 1200.0,
    twist_deg: Annotated[
        float, About("twist of every bar: the angle between the normals at its ends", 0.1, 80)
    ] = 9.0,
    crossing_deg: Annotated[float, About("angle of the two straight lines", 1, 179)] = 90.0,
) -> Mesh:
    """Star of equal bars through two straight lines, of constant curvature: Amsler's surface.

    Raises
    ------
    ParameterError
        A parameter of the wrong type or beyond its limits.
    DegenerateError
        A net that folds up; names the cell.

    Source: `ddgfab.nets.knet.amsler_net.amsler`, one for each quadrant; mathematics.md 3.14.
    """
    delta = np.radians(twist_deg)
    points = crossing_lines(
        (panels_along, panels_across), delta, np.radians(crossing_deg), bar_mm / np.sin(delta)
    )
    return roof(grid_mesh(points))

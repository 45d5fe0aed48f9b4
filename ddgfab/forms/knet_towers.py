"""Generators of K-nets about an axis: crab nets, pseudosphere, Dini, breather, Kuen.

All bars of such a net have one length and, up to hand, one twist. Node axes are the normals.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from ddgfab.errors import DegenerateError
from ddgfab.forms.generators import About, generator
from ddgfab.forms.knet_sheets import band_mesh, levelled, ring_mesh, roof, round_tower
from ddgfab.mesh import Mesh
from ddgfab.nets.knet.breather_net import breather
from ddgfab.nets.knet.crab import crab_net
from ddgfab.nets.knet.dini_net import dini, pseudosphere
from ddgfab.nets.knet.kuen_net import kuen

BAR_TEXT = "length of every bar, node to node"
TWIST_TEXT = "twist of every bar: the angle between the normals at its ends"


@generator("crab", support="normals")
def crab_tower(
    panels_around: Annotated[int, About("panels in a ring", 3, 2000)] = 16,
    rings: Annotated[int, About("staggered rings of panels from base to top", 2, 1000)] = 9,
    bar_mm: Annotated[float, About(BAR_TEXT, 1e-3)] = 1200.0,
    twist_deg: Annotated[float, About(TWIST_TEXT, 0.1, 80)] = 14.0,
    slope_deg: Annotated[
        float, About("slope of the surface at its base; 90: upright, less: leaning in", -90, 180)
    ] = 62.0,
) -> Mesh:
    """Round tower of equal bars like a crab trap or a basket: the rotational K-net.

    Its nodes stand on rings, turned by half a panel from ring to ring. A net of strings of one
    mesh size that is pulled at both ends hangs in this form.

    Raises
    ------
    ParameterError
        A parameter of the wrong type or beyond its limits.
    DegenerateError
        Values that no such net has, or one that closes in a cone point; says which ring.

    Source: `ddgfab.nets.knet.crab.crab_net`; mathematics.md 3.13.
    """
    delta, slope, turn = np.radians(twist_deg), np.radians(slope_deg), np.pi / panels_around
    least = np.degrees(np.arccos(np.hypot(np.cos(slope), np.sin(slope) * np.cos(turn))))
    if twist_deg < least:
        raise DegenerateError(
            f"twist_deg = {twist_deg:g} is too little: {panels_around} panels around at a slope of "
            f"{slope_deg:g} deg twist their bars by {least:.4g} deg or more\n"
            "take a larger twist_deg, more panels around, or another slope_deg"
        )
    net = crab_net(panels_around, delta, slope, rings + 2, r=bar_mm / np.sin(delta))
    passed = net.cone_rings
    if len(passed) or net.radii[0] <= 0:
        ring = int(passed[0]) if len(passed) else 0
        raise DegenerateError(
            f"ring {ring} has radius {net.radii[ring]:.3g} mm: the tower closes in a cone point\n"
            "take fewer rings, more panels around, or another slope"
        )
    return round_tower(net.mesh())


@generator("pseudosphere", support="normals")
def pseudosphere_tower(
    panels_around: Annotated[
        int, About("panels in a ring; every bar twists by 180 deg over it", 5, 2000)
    ] = 18,
    rings: Annotated[int, About("staggered rings of panels from base to top", 2, 1000)] = 9,
    bar_mm: Annotated[float, About(BAR_TEXT, 1e-3)] = 1200.0,
    base_ring: Annotated[
        int, About("ring of nodes at the base, counted from the rim of the pseudosphere", 1, 1000)
    ] = 2,
) -> Mesh:
    """Trumpet of equal bars and constant curvature: the discrete pseudosphere.

    Raises
    ------
    ParameterError
        A parameter of the wrong type or beyond its limits.

    Source: `ddgfab.nets.knet.dini_net.pseudosphere`; mathematics.md 3.9.
    """
    alpha = np.pi / panels_around
    r = bar_mm / np.sin(alpha)
    column = pseudosphere((1, rings + 1), alpha, offset=float(base_ring), r=r).points[0]
    radii = np.hypot(column[:, 0], column[:, 1])
    return round_tower(ring_mesh(radii, -column[:, 2], panels_around))


@generator("dini", support="normals")
def dini_ramp(
    panels_along: Annotated[int, About("panels of a row along the spiral", 2, 2000)] = 26,
    rows: Annotated[int, About("staggered rows of panels across it", 2, 400)] = 9,
    bar_mm: Annotated[float, About("length of the longer bars, node to node", 1e-3)] = 1200.0,
    twist_deg: Annotated[float, About("twist of the longer bars", 0.1, 60)] = 10.0,
    pitch_deg: Annotated[
        float, About("how steep the spiral climbs; 0: the pseudosphere; sign: its hand", -80, 80)
    ] = 12.0,
    base_line: Annotated[
        int, About("line of nodes at its foot, counted from the rim of the surface", 1, 1000)
    ] = 2,
) -> Mesh:
    """Spiral of bars of two lengths, of constant curvature: Dini's surface, a winding pseudosphere.

    The normal angles of both directions are chosen so that one step along each carries the net
    into itself by a screw: tan(beta / 2) = tan(sigma / 2)^2 tan(alpha / 2).

    Raises
    ------
    ParameterError
        A parameter of the wrong type or beyond its limits.

    Source: `ddgfab.nets.knet.dini_net.dini`; mathematics.md 3.9 with A B = 1.
    """
    sigma = np.radians(90.0 - pitch_deg)
    ratio = np.tan(0.5 * sigma) ** 2
    half = np.tan(0.5 * np.radians(twist_deg))
    alpha = 2.0 * np.arctan(half * min(1.0, 1.0 / ratio))
    beta = 2.0 * np.arctan(half * min(1.0, ratio))
    last = base_line + rows + 1
    cells = (panels_along + 1, panels_along + 1 + last)
    net = dini(
        np.full(cells[0], alpha),
        np.full(cells[1], beta),
        sigma,
        r=bar_mm / np.sin(max(alpha, beta)),
    )
    points = net.points * [1.0, -1.0, -1.0]  # a half-turn: the wide side down
    return round_tower(band_mesh(points, (base_line, last), (last, 2 * panels_along + last)))


@generator("breather", support="normals")
def breather_sheet(
    panels_along: Annotated[int, About("panels of a row, along the waves", 2, 2000)] = 11,
    rows: Annotated[int, About("staggered rows of panels across them", 2, 400)] = 19,
    bar_mm: Annotated[float, About(BAR_TEXT, 1e-3)] = 1200.0,
    twist_deg: Annotated[float, About(TWIST_TEXT, 0.1, 60)] = 9.0,
    waves: Annotated[float, About("waves in a turn about the axis", 0.05, 0.99)] = 0.8,
    phase_deg: Annotated[
        float, About("where on the wave the middle is; 90: between two folds, 0: on one", -360, 360)
    ] = 90.0,
) -> Mesh:
    """Saddle of equal bars that swings about its middle, of constant curvature: the breather.

    A piece between two folds can be built; longer ones hold folds, sharp edges where bars meet at
    small angles.

    Raises
    ------
    ParameterError
        A parameter of the wrong type or beyond its limits.

    Source: `ddgfab.nets.knet.breather_net.breather`; mathematics.md 3.12.
    """
    delta, side = np.radians(twist_deg), (rows + 2) // 2
    tau = float(np.arctanh(waves))
    sigma = 0.5 * np.pi + 1j * tau
    step = np.angle(np.cos(0.5 * (sigma + delta)) / np.cos(0.5 * (sigma - delta)))
    phase = np.radians(phase_deg) - (side + panels_along) * step
    angles = np.full(panels_along + side, delta)
    net = breather(angles, angles, tau, t0=complex(np.exp(1j * phase)), r=bar_mm / np.sin(delta))
    band = (-side, rows + 1 - side), (side, side + 2 * panels_along)
    return roof(levelled(band_mesh(net.points, *band)))


@generator("kuen", support="normals")
def kuen_tower(
    panels_along: Annotated[int, About("panels of a row, round the axis", 2, 2000)] = 16,
    rows: Annotated[int, About("staggered rows of panels from bottom to top", 2, 400)] = 17,
    bar_mm: Annotated[float, About(BAR_TEXT, 1e-3)] = 1200.0,
    twist_deg: Annotated[float, About(TWIST_TEXT, 0.1, 60)] = 9.0,
    first_row: Annotated[
        int,
        About(
            "row at which it begins, counted from the fold along the axis; negative: with it",
            -1000,
            1000,
        ),
    ] = 20,
) -> Mesh:
    """Hourglass of equal bars, open at one side, of constant curvature: Kuen's surface.

    The piece beyond its folds can be built; the whole surface (first_row = -60, 60 panels along, 33
    rows) crosses folds and itself.

    Raises
    ------
    ParameterError
        A parameter of the wrong type or beyond its limits.

    Source: `ddgfab.nets.knet.kuen_net.kuen`; mathematics.md 3.12 with tau -> 0.
    """
    delta, side = np.radians(twist_deg), (rows + 2) // 2
    angles = np.full(panels_along + side, delta)
    shift = (side - first_row) * np.tan(delta)
    net = kuen(angles, angles, shift=float(shift), r=bar_mm / np.sin(delta))
    band = (-side, rows + 1 - side), (side, side + 2 * panels_along)
    return round_tower(band_mesh(net.points, *band))

"""Canal surfaces: tubes of varying radius along a curve, as exact circular nets.

A row of spheres stands along the spine; neighbours meet in circles. Circles k and k + 1 lie on
sphere k, so an inversion swaps them. Two pairs of inverse points always lie on one circle, so
carrying points from circle to circle by these inversions makes every quad circular.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError
from ddgfab.forms.generators import About, generator
from ddgfab.forms.monge_surface import profile_polyline
from ddgfab.forms.placing import checked_forward, grounded
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.quads import finite
from ddgfab.tolerances import RELATIVE_DEGENERATE


@checked
def canal_circles(centers: ArrayLike, radii: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """Centers (K - 1, 3), radii (K - 1,) and unit normals (K - 1, 3) of the circles of a canal.

    Circle k is where spheres k and k + 1 meet.

    Parameters
    ----------
    centers : (K, 3) of the spheres
    radii : (K,)

    Raises
    ------
    InputError
        Fewer than two spheres, shapes that do not match, or numbers that are not finite.
    DegenerateError
        Neighbouring spheres that do not cross; names both, their distance and its limits.

    Source: envelope of spheres (Monge); the radical plane of two spheres.
    """
    m, r = np.asarray(centers, dtype=np.float64), np.asarray(radii, dtype=np.float64)
    if m.ndim != 2 or m.shape[1] != 3 or len(m) < 2 or r.shape != m.shape[:1]:
        raise InputError(f"centers {m.shape} and radii {r.shape}: (K, 3) and (K,), K > 1, needed")
    finite(m, "centers")
    finite(r, "radii")
    step = np.diff(m, axis=0)
    distance = np.linalg.norm(step, axis=1)
    low, high = np.abs(np.diff(r)), r[1:] + r[:-1]
    margin = RELATIVE_DEGENERATE * high
    bad = np.flatnonzero((distance <= low + margin) | (distance >= high - margin))
    if len(bad):
        k = bad[0]
        raise DegenerateError(
            f"spheres {k} and {k + 1} of the canal do not cross: their centers are "
            f"{distance[k]:.6g} apart, limits {low[k]:.6g} to {high[k]:.6g} "
            "(difference and sum of their radii)"
        )
    along = 0.5 * (distance + (r[:-1] ** 2 - r[1:] ** 2) / distance)
    normal = step / distance[:, None]
    return m[:-1] + along[:, None] * normal, np.sqrt(r[:-1] ** 2 - along**2), normal


@checked
def canal_net(
    centers: ArrayLike, radii: ArrayLike, angles: ArrayLike, up: ArrayLike = (0.0, 0.0, 1.0)
) -> Floats:
    """(K - 1, N + 1, 3) circular net on the canal surface of K spheres.

    Line i is on circle i (see `canal_circles`); the first line has its points at the angles given,
    the others are their images.

    Parameters
    ----------
    centers, radii : (K, 3) and (K,) of the spheres
    angles : (N + 1,) [rad] on the first circle, from the right-hand side upwards, seen along the
        spine
    up : (3,) upward direction at the first circle; what is along the spine is dropped

    Raises
    ------
    DegenerateError
        Spheres that do not cross, an upward direction along the spine, a spine that turns back;
        names the sphere.

    Source: inversions swapping cospherical circles; Bobenko, Suris, Discrete Differential
    Geometry, 3.1; mathematics.md 2.1.
    """
    m, r = np.asarray(centers, dtype=np.float64), np.asarray(radii, dtype=np.float64)
    middle, radius, normal = canal_circles(m, r)
    right = np.cross(normal[0], np.asarray(up, dtype=np.float64))
    if np.linalg.norm(right) <= RELATIVE_DEGENERATE:
        raise DegenerateError("the upward direction runs along the spine at its start")
    right = unit(right)
    angle = np.asarray(angles, dtype=np.float64)[:, None]
    arc = np.cos(angle) * right + np.sin(angle) * np.cross(right, normal[0])
    net = np.empty((len(middle), len(arc), 3))
    net[0] = middle[0] + radius[0] * arc
    for k in range(1, len(middle)):
        net[k] = _swapped(net[k - 1], m[k], r[k], normal[k - 1], normal[k], middle, k)
    return net


def _swapped(
    points: Floats, center: Floats, radius: float, first: Floats, second: Floats, on: Floats, k: int
) -> Floats:
    """Points of circle k - 1 carried to circle k by the inversion that swaps them on sphere k.

    A circle <a, y> = h of the unit sphere is the vector (a, h) / sqrt(1 - h^2) of Lorentz length
    one; the inversion is the reflection in the sum of both vectors.
    """
    rows = []
    for axis, middle in ((first, on[k - 1]), (second, on[k])):
        height = float(axis @ (middle - center)) / radius
        rows.append(np.append(axis, height) / np.sqrt(1.0 - height**2))
    mirror = rows[0] + rows[1]
    square = float(mirror[:3] @ mirror[:3] - mirror[3] ** 2)
    if square <= RELATIVE_DEGENERATE:
        raise DegenerateError(
            f"the spine turns back at sphere {k}: no inversion swaps its two circles "
            f"({square:.1e}, limit {RELATIVE_DEGENERATE:g})"
        )
    y = (points - center) / radius
    strength = 2.0 * (y @ mirror[:3] - mirror[3]) / square
    image = (y - strength[:, None] * mirror[:3]) / (1.0 - strength * mirror[3])[:, None]
    return np.asarray(center + radius * unit(image))


@generator("canal")
def canal_roof(
    panels_along: Annotated[int, About("panels along the spine", 1, 1000)] = 18,
    panels_across: Annotated[int, About("panels across it", 1, 1000)] = 7,
    length_mm: Annotated[float, About("length of the spine", 1e-3)] = 27000.0,
    start_radius_mm: Annotated[float, About("radius of the tube at its start", 1e-3)] = 6500.0,
    middle_radius_mm: Annotated[float, About("radius half way", 1e-3)] = 5000.0,
    end_radius_mm: Annotated[float, About("radius at its end", 1e-3)] = 8500.0,
    turn_deg: Annotated[float, About("turn of the spine in plan", -180, 180)] = 50.0,
    climb_deg: Annotated[
        float, About("slope of the spine at its start, falling at its end", -40, 40)
    ] = 0.0,
    arch_deg: Annotated[float, About("part of the full circle that is covered", 5, 300)] = 105.0,
) -> Mesh:
    """Vault cut from a tube whose radius changes along a bent spine; ribs are circles; circular.

    The radius follows the parabola through its three values; a spine that turns and climbs is a
    space curve.

    Raises
    ------
    ParameterError
        A parameter of the wrong type or beyond its limits.
    DegenerateError
        Spheres that do not cross (radii that change faster than the spine goes on, or panels
        longer than the tube is wide), or a bend sharper than the tube; names sphere or panel.

    Source: `canal_net`.
    """
    count = panels_along + 2  # spheres; circles are between them
    way = (np.arange(count) - 0.5) / panels_along
    yaw = np.radians(turn_deg) * (np.arange(count) - 0.5 * (count - 1)) / panels_along
    pitch = np.radians(climb_deg) * np.cos(np.pi * np.clip(way, 0.0, 1.0))
    ground = profile_polyline(yaw, np.full(count - 1, length_mm / panels_along))
    steps = np.diff(ground, axis=0)
    slope = np.tan(0.5 * (pitch[1:] + pitch[:-1]))
    rise = np.concatenate([[0.0], np.cumsum(slope * np.linalg.norm(steps, axis=1))])
    centers = np.concatenate([ground, rise[:, None]], axis=1)
    a, b, c = start_radius_mm, middle_radius_mm, end_radius_mm
    radii = a * (1 - way) * (1 - 2 * way) + 4 * b * way * (1 - way) + c * way * (2 * way - 1)
    bad = np.flatnonzero(radii <= 0)
    if len(bad):
        raise DegenerateError(
            f"the tube closes: the radius at sphere {bad[0]} is {radii[bad[0]]:.3g} mm\n"
            "bring start_radius_mm, middle_radius_mm and end_radius_mm nearer to each other"
        )
    half = 0.5 * np.radians(arch_deg)
    angles = np.linspace(0.5 * np.pi - half, 0.5 * np.pi + half, panels_across + 1)
    return grid_mesh(grounded(checked_forward(canal_net(centers, radii, angles))))

"""Rotational nets: a meridian turned about the z axis."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError
from ddgfab.forms.generators import About, generator
from ddgfab.forms.placing import chord_arc
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Floats, Mesh
from ddgfab.tolerances import RELATIVE_DEGENERATE

FULL_TURN_DEG = 360.0


@checked
def rotational_net(meridian: ArrayLike, azimuths: ArrayLike) -> Floats:
    """(M + 1, N + 1, 3) net of a meridian at azimuths about the z axis.

    Its quads are isosceles trapezoids, hence circular, whatever the azimuths; it is conical too
    when they have one constant step.

    Parameters
    ----------
    meridian : (N + 1, 2) radius and height of its points
    azimuths : (M + 1,) [rad]

    Raises
    ------
    InputError
        A meridian or azimuths of the wrong shape.
    DegenerateError
        A point on the axis, or azimuths that do not move on; names the point or the step.

    Source: mathematics.md 2.6 (circular), 2.9 (conical for a constant step).
    """
    m, angle = np.asarray(meridian, dtype=np.float64), np.asarray(azimuths, dtype=np.float64)
    if m.ndim != 2 or m.shape[1] != 2 or len(m) < 2 or angle.ndim != 1 or len(angle) < 2:
        raise InputError(
            f"meridian {m.shape} and azimuths {angle.shape}: (2 or more, 2) and (2 or more,) needed"
        )
    size = float(m[:, 0].max())
    low = np.flatnonzero(m[:, 0] <= RELATIVE_DEGENERATE * size)
    if len(low):
        raise DegenerateError(
            f"meridian point {low[0]} has radius {m[low[0], 0]:.3g}: its quads close up at the "
            "axis; a positive radius is needed"
        )
    still = np.flatnonzero(np.abs(np.diff(angle)) <= RELATIVE_DEGENERATE)
    if len(still):
        raise DegenerateError(f"azimuth step {still[0]} is zero")
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    net = np.empty((len(angle), len(m), 3))
    net[..., :2] = ring[:, None] * m[None, :, :1]
    net[..., 2] = m[:, 1]
    return net


@generator("rotational")
def rotational_dome(
    panels_around: Annotated[int, About("panels in a ring", 3, 2000)] = 24,
    rings: Annotated[int, About("rings of panels from base to top", 1, 1000)] = 6,
    base_radius_mm: Annotated[float, About("radius at the base", 1e-3)] = 7000.0,
    top_radius_mm: Annotated[float, About("radius of the opening at the top", 1e-3)] = 1500.0,
    height_mm: Annotated[float, About("height of the top over the base")] = 4000.0,
    bulge: Annotated[
        float, About("arch of the meridian over its chord; 0: a cone, negative: a tent", -0.5, 0.5)
    ] = 0.16,
    sweep_deg: Annotated[float, About("how far round; 360: closed", 1, FULL_TURN_DEG)] = 360.0,
) -> Mesh:
    """Dome, cone or tent of revolution with a round opening at its top; circular and conical.

    The meridian is an arc of equal chords, the azimuth step constant; panels are isosceles
    trapezoids, congruent all round a ring.

    Raises
    ------
    ParameterError
        A parameter of the wrong type or beyond its limits.
    DegenerateError
        A bulge that carries the meridian across the axis; names the point.

    Source: `rotational_net`.
    """
    meridian = chord_arc((base_radius_mm, 0.0), (top_radius_mm, height_mm), bulge, rings)
    closed = sweep_deg == FULL_TURN_DEG
    azimuths = np.radians(np.linspace(0.0, sweep_deg, panels_around + 1))
    net = rotational_net(meridian, azimuths)
    net[..., 2] -= meridian[:, 1].min()
    return grid_mesh(net[:-1] if closed else net, closed=(closed, False))

"""Moulding surfaces: a plane profile whose plane stays vertical and rolls along a plane path."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked, of_shape
from ddgfab.forms.generators import About, generator
from ddgfab.forms.monge_surface import monge, profile_polyline
from ddgfab.forms.placing import checked_forward, grounded
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Floats, Mesh
from ddgfab.quads import finite


@checked
def moulding_net(profile: ArrayLike, directions: ArrayLike, steps: ArrayLike) -> Floats:
    """(M + 1, N + 1, 3) net of a profile carried along a path in the ground plane.

    All profiles are congruent, in vertical planes; all lines along are horizontal. Panels are
    isosceles trapezoids with horizontal parallel sides: a circular net.

    Parameters
    ----------
    profile : (N + 1, 2) distance to the left of the path, and height
    directions : (M + 1,) azimuths [rad] of the path's tangents at its points
    steps : (M,) lengths of its steps; step k runs along the mean of directions k and k + 1

    Raises
    ------
    InputError
        Shapes that do not fit, numbers that are not finite; names the argument.
    DegenerateError
        Opposite directions in a row; names the step.

    Source: `monge` with a horizontal spine; mathematics.md 2.7.
    """
    angle = of_shape(directions, (None,), "directions")
    finite(angle, "directions")
    tangents = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=1)
    return monge(profile, tangents, steps, (0.0, 0.0, 1.0))


@generator("moulding")
def moulding_roof(
    panels_along: Annotated[int, About("panels along the path", 1, 1000)] = 18,
    panels_across: Annotated[int, About("panels across it", 1, 1000)] = 7,
    panel_mm: Annotated[float, About("side of a panel on the path", 1e-3)] = 1500.0,
    swing_deg: Annotated[float, About("turn of the path to either side", -85, 85)] = 28.0,
    bends: Annotated[float, About("bends of the path: 1 an arc, 2 an S", 0, 9)] = 2.0,
    wall_deg: Annotated[float, About("slope of the roof at its left eave", -89, 89)] = 55.0,
    eave_deg: Annotated[float, About("slope down at its right eave", -89, 89)] = 15.0,
) -> Mesh:
    """Vault of one cross-section along a path that bends in plan; ribs congruent, circular net.

    Raises
    ------
    ParameterError
        A parameter of the wrong type or beyond its limits.
    DegenerateError
        A bend so sharp that the profile crosses itself on its inside; names the panel.

    Source: `moulding_net`.
    """
    slope = np.radians(np.linspace(wall_deg, -eave_deg, panels_across + 1))
    profile = profile_polyline(slope, np.full(panels_across, panel_mm))
    profile = np.stack([-profile[:, 0], profile[:, 1]], axis=1)[::-1]
    profile[:, 0] -= profile[:, 0].mean()
    way = np.linspace(0.0, 1.0, panels_along + 1)
    turn = np.radians(swing_deg) * np.cos(np.pi * bends * way)
    net = moulding_net(profile, turn, np.full(panels_along, panel_mm))
    return grid_mesh(grounded(checked_forward(net)))

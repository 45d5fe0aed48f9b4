"""Discrete Monge (moulding) surfaces: a plane profile carried along a spine by reflections.

Each profile is the mirror image of the one before, in the plane that halves the way between them.
So all edges along one step are parallel, the quads are isosceles trapezoids, hence circular, and
axes that lie in the profile's plane stay in it and are torsion-free (Monge's surfaces swept by a
rotation-minimising plane; double reflection: Wang, Juettler, Zheng, Liu 2008; mathematics.md 2.7,
10.3).
"""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked, of_shape
from ddgfab.errors import DegenerateError, InputError
from ddgfab.forms.generators import About, generator
from ddgfab.forms.placing import arc_angles, checked_forward, grounded
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.quads import finite
from ddgfab.tolerances import RELATIVE_DEGENERATE


@checked
def profile_polyline(angles: ArrayLike, steps: ArrayLike) -> Floats:
    """(N + 1, 2) plane polyline of given tangent angles at its vertices.

    Edge j runs along the mean of its two angles, so the perpendiculars at its ends are mirror
    images in its bisector: they are exact normals in the sense of `circular.vertex_normals`.

    Parameters
    ----------
    angles : (N + 1,) [rad] of the tangents at the vertices
    steps : (N,) lengths of the edges

    Raises
    ------
    InputError
        Shapes that do not fit, numbers that are not finite; names the argument.
    """
    phi = _finite(angles, (None,), "angles")
    length = _finite(steps, (max(len(phi) - 1, 0),), "steps")
    if not len(phi):
        raise InputError("angles has shape (0,); one angle at each vertex is needed")
    middle = 0.5 * (phi[1:] + phi[:-1])
    edges = length[:, None] * np.stack([np.cos(middle), np.sin(middle)], axis=1)
    return np.concatenate([np.zeros((1, 2)), np.cumsum(edges, axis=0)])


@checked
def monge(profile: ArrayLike, tangents: ArrayLike, steps: ArrayLike, up: ArrayLike) -> Floats:
    """(M + 1, N + 1, 3) net of a plane profile carried along a spine.

    The spine starts at the origin and is given by its tangents; step k runs along the mean of the
    tangents at its ends. Profile k stands at spine point k, perpendicular to tangent k.

    Parameters
    ----------
    profile : (N + 1, 2) coordinates to the left of the tangent and upwards, from the spine
    tangents : (M + 1, 3) unit tangents of the spine at its points
    steps : (M,) distances between spine points
    up : (3,) upward direction at the start; what is along the tangent is dropped

    Raises
    ------
    InputError
        Shapes that do not fit, numbers that are not finite; names the argument.
    DegenerateError
        A tangent of no length, `up` along the first tangent, or opposite tangents in a row;
        names the step.
    """
    shape = _finite(profile, (None, 2), "profile")
    along = _finite(tangents, (None, 3), "tangents")
    length = _finite(steps, (max(len(along) - 1, 0),), "steps")
    upward = _finite(up, (3,), "up")
    if not len(along):
        raise InputError("tangents has shape (0, 3); a tangent at each spine point is needed")
    still = np.flatnonzero(np.linalg.norm(along, axis=1) == 0)
    if len(still):
        raise DegenerateError(f"tangent {still[0]} of the spine has no length")
    along = unit(along)
    ways = along[1:] + along[:-1]
    bad = np.flatnonzero(np.linalg.norm(ways, axis=1) <= RELATIVE_DEGENERATE)
    if len(bad):
        raise DegenerateError(f"spine step {bad[0]} turns back: its two tangents are opposite")
    left = np.cross(upward, along[0])
    if np.linalg.norm(left) <= RELATIVE_DEGENERATE:
        raise DegenerateError("the upward direction runs along the spine at its start")
    left = unit(left)
    frame = np.stack([left, np.cross(along[0], left)])  # rows: left, up
    net = np.empty((len(along), len(shape), 3))
    point = np.zeros(3)
    net[0] = shape @ frame
    for k, way in enumerate(unit(ways)):
        point = point + length[k] * way
        frame = frame - 2.0 * np.outer(frame @ way, way)
        net[k + 1] = point + shape @ frame
    return net


@generator("monge")
def monge_roof(
    panels_along: Annotated[int, About("panels along the spine", 1, 1000)] = 16,
    panels_across: Annotated[int, About("panels across it", 1, 1000)] = 6,
    panel_mm: Annotated[float, About("side of a panel on the spine", 1e-3)] = 1500.0,
    turn_deg: Annotated[float, About("turn of the spine in plan", -330, 330)] = 110.0,
    climb_deg: Annotated[float, About("slope of the spine at its start", -45, 45)] = 18.0,
    end_climb_deg: Annotated[float, About("slope of the spine at its end", -45, 45)] = 2.0,
    arch_deg: Annotated[float, About("slope of the cross-section at its eaves", -85, 85)] = 42.0,
) -> Mesh:
    """Vault of one cross-section along a spine that bends and climbs at once, like over a ramp.

    The cross-section's plane stays perpendicular to the spine and does not roll about it; all ribs
    are congruent, and the net is circular.

    Raises
    ------
    ParameterError
        A parameter of the wrong type or beyond its limits.
    DegenerateError
        A bend so sharp that the profile crosses itself on its inside; names the panel.

    Source: `monge`.
    """
    steps = np.full(panels_along, panel_mm)
    profile = profile_polyline(
        arc_angles(arch_deg, panels_across), np.full(panels_across, panel_mm)
    )
    profile -= [profile[:, 0].mean(), profile[:, 1].max()]
    yaw = np.radians(np.linspace(-0.5 * turn_deg, 0.5 * turn_deg, panels_along + 1))
    pitch = np.radians(np.linspace(climb_deg, end_climb_deg, panels_along + 1))
    tangents = np.stack(
        [np.cos(pitch) * np.cos(yaw), np.cos(pitch) * np.sin(yaw), np.sin(pitch)], axis=1
    )
    net = monge(profile, tangents, steps, level_start(tangents, steps))
    return grid_mesh(grounded(checked_forward(net)))


def _finite(value: ArrayLike, shape: tuple[int | None, ...], name: str) -> Floats:
    """An array of a shape; entries beyond all lengths are refused as those that are not finite."""
    array = of_shape(value, shape, name)
    finite(array, name)
    return array


def level_start(tangents: Floats, steps: Floats) -> Floats:
    """(3,) upward direction at the start of a spine for which profiles roll as far left as right.

    A plane that does not roll about a spine that both climbs and bends rolls against the horizon.
    """
    left = unit(np.cross([0.0, 0.0, 1.0], tangents[0]))
    up = np.cross(tangents[0], left)
    bar = monge([[0.0, 0.0], [1.0, 0.0]], tangents, steps, up)
    roll = np.arcsin(bar[:, 1, 2] - bar[:, 0, 2])
    middle = 0.5 * (roll.min() + roll.max())
    return np.asarray(np.cos(middle) * up + np.sin(middle) * left)

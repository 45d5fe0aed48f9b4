"""Translation nets: one curve moved along another, so that all quads are parallelograms."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError
from ddgfab.forms.generators import About, generator
from ddgfab.forms.monge_surface import profile_polyline
from ddgfab.forms.placing import arc_angles, grounded
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Floats, Mesh
from ddgfab.tolerances import RELATIVE_DEGENERATE


@checked
def translation_net(first: ArrayLike, second: ArrayLike) -> Floats:
    """(M + 1, N + 1, 3) net x_ij = p_i + q_j - q_0 of two polylines.

    Its quads are parallelograms, hence planar; all its coefficients as a conjugate net are 0, and
    every mesh parallel to it is again a translation net.

    Parameters
    ----------
    first : (M + 1, 3) polyline p, which the net contains
    second : (N + 1, 3) polyline q along which it is moved

    Raises
    ------
    InputError
        A polyline of the wrong shape or with fewer than two points.
    DegenerateError
        Parallel edges of the two; names the quad and the sine of the angle.

    Source: Glymph, Shelden, Ceccato, Mussel, Schober 2004 (the Hippo house of J. Schlaich);
    mathematics.md 8.1.
    """
    p, q = np.asarray(first, dtype=np.float64), np.asarray(second, dtype=np.float64)
    for name, curve in (("first", p), ("second", q)):
        if curve.ndim != 2 or curve.shape[1] != 3 or len(curve) < 2:
            raise InputError(f"the {name} curve has shape {curve.shape}; (2 or more, 3) is needed")
    e, f = np.diff(p, axis=0)[:, None], np.diff(q, axis=0)[None]
    area = np.linalg.norm(np.cross(e, f), axis=-1)
    sides = np.linalg.norm(e, axis=-1) * np.linalg.norm(f, axis=-1)
    flat = np.argwhere(area <= RELATIVE_DEGENERATE * sides)
    if len(flat):
        cell = int(flat[0, 0]), int(flat[0, 1])
        sine = area[cell] / sides[cell] if sides[cell] > 0 else 0.0
        raise DegenerateError(
            f"quad {cell}: the edges of the two curves are parallel (sine {sine:.1e}, "
            f"limit {RELATIVE_DEGENERATE:g})",
            cell=cell,
        )
    return np.asarray(p[:, None] + (q - q[0])[None])


@generator("translation")
def translation_roof(
    panels_along: Annotated[int, About("panels along the roof", 1, 1000)] = 14,
    panels_across: Annotated[int, About("panels across it", 1, 1000)] = 8,
    panel_along_mm: Annotated[float, About("length of every edge along", 1e-3)] = 1500.0,
    panel_across_mm: Annotated[float, About("length of every edge across", 1e-3)] = 1500.0,
    slope_along_deg: Annotated[float, About("steepest slope along", -60, 60)] = 24.0,
    slope_across_deg: Annotated[float, About("slope at the long eaves", -60, 60)] = 28.0,
    domes: Annotated[int, About("domes in a row", 1, 9)] = 2,
) -> Mesh:
    """Roof of rhombic panes, an arch moved along a wavy ridge, as over the Hippo house in Berlin.

    Two profile curves in perpendicular vertical planes: an arch across, and along it the ridge
    that climbs and falls once for every dome. All beams of a direction have exactly one length.

    Raises
    ------
    ParameterError
        A parameter of the wrong type or beyond its limits.

    Source: `translation_net`.
    """
    waves = np.cos(np.pi * (2 * domes - 1) * np.linspace(0.0, 1.0, panels_along + 1))
    ridge = profile_polyline(
        np.radians(slope_along_deg) * waves, np.full(panels_along, panel_along_mm)
    )
    arch = profile_polyline(
        arc_angles(slope_across_deg, panels_across), np.full(panels_across, panel_across_mm)
    )
    flat = np.zeros(len(ridge)), np.zeros(len(arch))
    net = translation_net(
        np.stack([ridge[:, 0], flat[0], ridge[:, 1]], axis=1),
        np.stack([flat[1], arch[:, 0], arch[:, 1]], axis=1),
    )
    return grid_mesh(grounded(net))

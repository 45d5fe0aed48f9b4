"""How far the normals of a surface turn about edges: what lines that are not principal cost.

Node axes of beams without torsion cannot all be normals of the surface: along a line with geodesic
torsion t_g the plane of a beam turns about it by the integral of t_g, or its axes lean by as much.
Along principal lines t_g = 0. Source: do Carmo, Differential Geometry of Curves and Surfaces, 3.2.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.mesh import Floats, Ints
from ddgfab.surfaces.principal import forms
from ddgfab.surfaces.spline import Jets, SplineSurface
from ddgfab.trace.field import Field
from ddgfab.trace.lines import Line

TOLD_DEG: Final = 1.0
"""Edges about which normals turn by more [deg] are worth another surface, see `dilemma`."""
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(4)


def geodesic_torsion(jets: Jets, directions: Floats) -> Floats:
    """(n,) geodesic torsion II(t, n x t) of lines in parameter directions (n, 2), in 1 / length.

    Equal to half of the difference of the principal curvatures times sin of twice the angle to a
    principal direction, up to sign.
    """
    form = forms(jets)
    way = form.frame(directions)
    one, two = (way / np.linalg.norm(way, axis=1)[:, None]).T
    return np.asarray(form.q * (one**2 - two**2) + (form.r - form.p) * one * two)


@checked
def edge_twist(surface: SplineSurface, uv: ArrayLike, edges: ArrayLike) -> Floats:
    """Angles [rad] by which the normals of a surface turn about edges from end to end, signed.

    Parameters
    ----------
    uv : (V, 2) parameters of vertices on the surface
    edges : (e, 2) ids of their ends; the edge is the straight way in the parameter plane, which
        gives the same as the line up to third order
    """
    at = np.asarray(uv, dtype=np.float64)
    ends: Ints = np.asarray(edges, dtype=np.int64)
    way = at[ends[:, 1]] - at[ends[:, 0]]
    total = np.zeros(len(ends))
    for node, weight in zip(0.5 + 0.5 * _NODES, 0.5 * _WEIGHTS, strict=True):
        jets = surface.jets(at[ends[:, 0]] + node * way)
        speed = np.linalg.norm(way[:, :1] * jets.u + way[:, 1:] * jets.v, axis=1)
        total += weight * speed * geodesic_torsion(jets, way)
    return total


def line_twist(field: Field, family: int, line: Line) -> Floats:
    """(n,) the same along a traced line, from its first point to each of its points [rad]."""
    step = np.diff(line.s)
    total = np.zeros(len(step))
    for node, weight in zip(0.5 + 0.5 * _NODES, 0.5 * _WEIGHTS, strict=True):
        jets = field.surface.jets(line.at(line.s[:-1] + node * step))
        total += weight * step * geodesic_torsion(jets, field.directions(jets, family))
    return np.concatenate([[0.0], np.cumsum(total)])

"""Volume, area and centroid of a boundary in closed form, by the divergence theorem.

A face is x = base + v d with d constant: on a plane base = o + u X, on a cylinder of radius r
base = o + r (cos u X + sin u Y) and d its axis, so its normal does not depend on v. Integrals of
polynomials in x over the face become line integrals around its loops (Green), in which v has been
integrated by hand. Along lines they are polynomials, along arcs trigonometric polynomials: Gauss
quadrature gives both exactly, and to rounding with more nodes where cylinders cross.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from fabrication.boundary import Boundary, cross_rows
from fabrication.solids.section import GAUSS_NODES, gauss
from fabrication.specs import Properties

CROSSING_NODES: Final = 64
"""Nodes of the quadrature along edges of boundaries with curves where cylinders cross."""


def properties(boundary: Boundary) -> Properties:
    """Volume [mm3], area [mm2] and centroid [mm] of the solid within a boundary."""
    # Curves where cylinders cross are no polynomials of sines: more nodes give them to rounding.
    s, weight = gauss(CROSSING_NODES if boundary.arc_crosses.any() else GAUSS_NODES)
    middle = 0.5 * (boundary.points.min(axis=0) + boundary.points.max(axis=0))
    # Points and derivatives along every edge, from the middle of the part (no cancellation).
    edge = boundary.coedge_edge
    on_arc = boundary.edge_arc >= 0
    first, last = boundary.points[boundary.edges[:, 0]], boundary.points[boundary.edges[:, 1]]
    step = np.repeat((last - first)[:, None], len(s), axis=1)
    point = (first - middle)[:, None] + s[:, None] * step
    arc = boundary.edge_arc[on_arc]
    start, end = boundary.arc_range[arc].T[:, :, None]
    on, rate = boundary.arc_motion(arc, start + s * (end - start))
    point[on_arc], step[on_arc] = on - middle, (end - start)[..., None] * rate
    point, step = point[edge], step[edge]

    face = boundary.coedge_face
    round_face = boundary.face_cylinder[face]
    sign = boundary.face_sign[face]
    axis, xdir = boundary.face_axis[face], boundary.face_xdir[face]
    # v runs along d: the axis of a cylinder, the second direction of a plane.
    d = np.where(round_face[:, None], axis, cross_rows(axis, xdir))
    origin = boundary.face_origin[face] - middle
    away = point - origin[:, None]
    v = np.einsum("cgi,ci->cg", away, d)
    base = point - v[..., None] * d[:, None]
    across = np.where(round_face[:, None], cross_rows(axis, xdir), 0.0)
    radius = np.where(round_face, boundary.face_radius[face], 1.0)
    x, y = np.einsum("cgi,ci->cg", away, xdir), np.einsum("cgi,ci->cg", away, across)
    dx, dy = np.einsum("cgi,ci->cg", step, xdir), np.einsum("cgi,ci->cg", step, across)
    # dq is the arc length across d: r du on cylinders, du on planes. The loop runs
    # counterclockwise in (q, v) seen from outside where d, q and the normal make a right hand.
    dq = np.where(round_face[:, None], (x * dy - y * dx) / radius[:, None], dx)
    along = -(sign * np.where(boundary.coedges < 0, -1.0, 1.0))[:, None] * weight * dq
    normal = np.where(
        round_face[:, None, None],
        (sign / radius)[:, None, None]
        * (x[..., None] * xdir[:, None] + y[..., None] * across[:, None]),
        axis[:, None],
    )
    area = float(np.sum(along * v))
    volume = float(np.sum(along * v * np.sum(base * normal, axis=-1))) / 3.0
    # d is perpendicular to the normal: x . n = base . n. For the centroid, x_i^2 n_i integrated.
    vd = v[..., None] * d[:, None]
    squares = base * base + base * vd + vd * vd / 3.0
    moment = np.einsum("cg,cgi->i", along * v, squares * normal) / 2.0
    center = middle + moment / volume
    return Properties(volume, area, (float(center[0]), float(center[1]), float(center[2])))

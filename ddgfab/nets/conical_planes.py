"""Conical nets of oriented planes in any number of directions: Q-nets on the Blaschke cylinder.

An oriented plane <n, x> = d, |n| = 1, is the point (n, d) of R^4, on the cylinder |n| = 1. Four
planes touch one cone of revolution just when their points lie in one plane of R^4, so a conical net
is a conjugate net of R^4 whose points lie on this quadric. Seven of the eight points of a cube of a
conjugate net on a quadric put the eighth on it too; therefore conical nets evolve as conjugate nets
do, consistently in four and more directions.
Source: Bobenko, Suris, Discrete Differential Geometry, 3.4, 3.5; mathematics.md 2.11.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked, of_shape
from ddgfab.errors import InputError
from ddgfab.mesh import Floats
from ddgfab.nets.axes import vertex_normals
from ddgfab.nets.blaschke import frame_of, on_cylinder, unit_planes, with_distance
from ddgfab.nets.circular import angle_rule
from ddgfab.nets.conical import best_normal, face_normals
from ddgfab.nets.conjugate import coeffs_kernel, planarity
from ddgfab.nets.cubes import cube_point, evolve_nd
from ddgfab.quads import Place, edge_frame, measure, net_points, pairs, sweep
from ddgfab.tolerances import NET_INPUT, RELATIVE_DEGENERATE


# --- planes --------------------------------------------------------------------------------------
@checked
def net_planes(points: ArrayLike) -> Floats:
    """(M, N, 4) planes (n, d) of the quads of a net, with the normals of `face_normals`.

    Parameters
    ----------
    points : (M + 1, N + 1, 3) net with planar quads

    Raises
    ------
    InputError, DegenerateError
        As `face_normals`.
    """
    normals = face_normals(points)
    x = np.asarray(points, dtype=np.float64)
    middle = 0.25 * (x[1:, 1:] + x[1:, :-1] + x[:-1, 1:] + x[:-1, :-1])
    return with_distance(normals, middle)


@checked
def contact_planes(points: ArrayLike, first: ArrayLike | None = None) -> Floats:
    """(n1, ..., nd, 4) planes through the points of a circular net across its vertex normals.

    A conical net with one plane at every point: circular net and conical net together are a net of
    contact elements (principal curvature lines).

    Parameters
    ----------
    points : (n1, ..., nd, 3) circular net
    first : (3,) normal at the first point; by default `best_normal` of the first two directions

    Raises
    ------
    InputError, DegenerateError
        As `vertex_normals`.

    Source: mathematics.md 2.7, 2.8.
    """
    x = net_points(points, 3)
    start = best_normal(x.reshape(*x.shape[:2], -1, 3)[:, :, 0]) if first is None else first
    return with_distance(vertex_normals(x, start), x)


@checked
def contact_points(planes: ArrayLike, first: ArrayLike) -> Floats:
    """(n1, ..., nd, 3) circular net with one point in each plane of a conical net.

    The reflection that takes one plane to the next, <n_k - n, x> = d_k - d, takes the point of one
    to that of the other; between parallel planes it is the shift along the normal.

    Parameters
    ----------
    planes : (n1, ..., nd, 4) conical net, see `evolve_conical`
    first : (3,) point in the first plane (what is off it is dropped): a two-parameter family

    Raises
    ------
    InputError
        Planes of another shape, normals that are not unit.

    Source: Pottmann, Wallner 2008; mathematics.md 2.10.
    """
    p = unit_planes(planes, NET_INPUT)
    start = np.asarray(first, dtype=np.float64)
    if start.shape != (3,) or not np.isfinite(start).all():
        raise InputError(f"first point {start.tolist()}: three finite numbers are needed")
    d = p.ndim - 1
    # About the first point: far from the origin the distances of the planes lose digits.
    n = p[..., :3]
    height = p[..., 3] - n @ start
    points = np.zeros(n.shape)
    points[(0,) * d] = height[(0,) * d] * n[(0,) * d]
    for axis in range(d):
        for step in range(1, p.shape[axis]):
            here = (slice(None),) * axis + (step,) + (0,) * (d - axis - 1)
            back = (slice(None),) * axis + (step - 1,) + (0,) * (d - axis - 1)
            points[here] = _mirrored(points[back], n[back], height[back], n[here], height[here])
    return np.asarray(points + start)


def _mirrored(x: Floats, n: Floats, d: Floats, n_k: Floats, d_k: Floats) -> Floats:
    """The point x of the plane (n, d) in the plane (n_k, d_k)."""
    m = n_k - n
    square = np.sum(m * m, axis=-1)
    parallel = square <= RELATIVE_DEGENERATE**2
    gap = np.sum(m * x, axis=-1) - (d_k - d)
    factor = 2.0 * gap / np.where(parallel, 1.0, square)
    moved = np.where(parallel[..., None], (d_k - d)[..., None] * n, -factor[..., None] * m)
    return np.asarray(x + moved)


@checked
def plane_meets(planes: ArrayLike, axes: tuple[int, int] = (0, 1)) -> Floats:
    """Points where the four planes of each quad of two directions meet: apices of the cones.

    Parameters
    ----------
    planes : (n1, ..., nd, 4) conical net; of other nets, the meet of the first three planes
    axes : the two directions

    Returns
    -------
    points : the shape of `planes`, one less in the two directions, with 3 coordinates. In the
        layers of the two directions these are conical nets of points.

    Raises
    ------
    InputError
        Planes of another shape, normals that are not unit.
    DegenerateError
        Parallel planes, planes along one line; names the quad.

    Source: mathematics.md 2.11.
    """
    scaled, frame = on_cylinder(unit_planes(planes, NET_INPUT))

    def kernel(p: Floats, p1: Floats, p2: Floats, p12: Floats, place: Place) -> Floats:
        a, b = p1 - p, p2 - p
        edges = edge_frame(a[:3], b[:3], place, "its planes are parallel or hold one line")
        # Rows n and an orthonormal pair across it: a system that is well conditioned.
        rows = np.stack([p[:3], edges.e, edges.w])
        along = a[3] / edges.length
        right = np.stack([p[3], along, (b[3] - edges.along * along) / edges.across])
        system, values = np.moveaxis(rows, (0, 1), (-2, -1)), np.moveaxis(right, 0, -1)
        return np.moveaxis(np.linalg.solve(system, values[..., None])[..., 0], -1, 0)

    return frame.center + frame.size * measure(scaled, axes, kernel, dim=4)


@checked
def plane_residuals(planes: ArrayLike) -> dict[str, float]:
    """How far a net of planes is from conical; all zero on a conical net.

    "unit": greatest ||n| - 1|. "planarity": greatest distance of the diagonals of a quad of points
    (n, d) over their mean length, over all pairs of directions; d is measured from the point
    nearest to all planes, in units of the greatest distance, so that motions and scalings change
    nothing.

    Source: mathematics.md 2.11.
    """
    p = unit_planes(planes, np.inf)
    off = np.abs(np.linalg.norm(p[..., :3], axis=-1) - 1.0).max()
    scaled = on_cylinder(p)[0]
    flat = [np.abs(planarity(scaled, pair)).max(initial=0.0) for pair in pairs(scaled)]
    return {"unit": float(off), "planarity": float(max(flat))}


# --- one cube ------------------------------------------------------------------------------------
@checked
def conical_plane(
    p: ArrayLike,
    p1: ArrayLike,
    p2: ArrayLike,
    p3: ArrayLike,
    p12: ArrayLike,
    p13: ArrayLike,
    p23: ArrayLike,
    tolerance: float = NET_INPUT,
) -> Floats:
    """(4,) eighth plane of a cube of a conical net: it touches the cones of three further quads.

    All eight planes touch one oriented sphere, where the four planes p, p1, p2, p3 touch just one.

    Parameters
    ----------
    p, p1, p2, p3, p12, p13, p23 : (4,) planes (n, d) whose quads at p are conical
    tolerance : relative, on these

    Raises
    ------
    InputError
        Planes of another shape, normals that are not unit.
    DegenerateError
        As `cubes.cube_point`, for the points (n, d) of R^4.

    Source: mathematics.md 2.11.
    """
    names = ("p", "p1", "p2", "p3", "p12", "p13", "p23")
    planes = zip((p, p1, p2, p3, p12, p13, p23), names, strict=True)
    given = np.stack([of_shape(plane, (4,), name) for plane, name in planes])
    scaled, frame = on_cylinder(unit_planes(given[:, None], tolerance))
    x, x1, x2, x3, x12, x13, x23 = scaled[:, 0]
    return frame.back(cube_point(x, x1, x2, x3, x12, x13, x23, tolerance))


# --- evolution -----------------------------------------------------------------------------------
@checked
def evolve_conical(
    surfaces: Mapping[tuple[int, int], ArrayLike],
    *,
    verify: bool = False,
    tolerance: float = NET_INPUT,
) -> Floats:
    """(n1, ..., nd, 4) conical net of planes from its conical coordinate surfaces, d > 2.

    Parameters
    ----------
    surfaces : by pairs (k, l), k < l < d: (n_k, n_l, 4) conical nets of planes (n, d) with common
        axes; `net_planes` and `contact_planes` make some
    verify : as in `cubes.evolve_nd`; also whether the normals made are unit, to the tolerance
    tolerance : relative, on the planarity of the quads of points (n, d) and on unit normals

    Raises
    ------
    InputError
        A missing surface, shapes that do not fit, surfaces with different axes, normals that are
        not unit.
    DegenerateError
        A surface that is not conical, and as `cubes.evolve_nd`; names the quad or plane.

    Source: Bobenko, Suris, 3.4; mathematics.md 2.11.
    """
    given = {
        pair: unit_planes(surface, tolerance, f"surface {pair}: ")
        for pair, surface in surfaces.items()
    }
    frame = frame_of([p.reshape(-1, 4) for p in given.values()])
    scaled = {pair: frame.scaled(p) for pair, p in given.items()}
    net = evolve_nd(scaled, verify=verify, tolerance=tolerance)
    if verify:
        off = np.abs(np.linalg.norm(net[..., :3], axis=-1) - 1.0)
        Place(name="plane").refuse(
            off > tolerance, f"its normal is not unit, limit {tolerance:g}", off
        )
    return frame.back(net)


@checked
def evolve_conical_by_angles(
    lines: Sequence[ArrayLike],
    angles: Mapping[tuple[int, int], ArrayLike],
    *,
    verify: bool = False,
) -> Floats:
    """(n1, ..., nd, 4) conical net from d > 1 sequences of planes and angles of its Gauss image.

    The normals of a conical net are a circular net on the unit sphere; one angle of each of its
    quads fixes the normal, and the cone the distance of the plane.

    Parameters
    ----------
    lines : d sequences of planes (n_k, 4) that begin with the same one
    angles : by pairs (k, l), k < l: (n_k - 1, n_l - 1) or number [rad], of the quads of normals,
        see `evolve_by_angles`
    verify : as in `evolve_conical`

    Raises
    ------
    InputError
        Shapes that do not fit, sequences with different first planes, normals that are not unit.
    DegenerateError
        Parallel neighbouring planes, and as `evolve_by_angles` and `evolve_conical`.

    Source: mathematics.md 2.3, 2.11.
    """
    wanted = list(combinations(range(len(lines)), 2))
    if not wanted or sorted(angles) != wanted:
        raise InputError(f"angles for directions {sorted(angles)}; {wanted} are needed")
    given = [
        unit_planes(np.asarray(line)[:, None], NET_INPUT, f"line {k}: ")[:, 0]
        for k, line in enumerate(lines)
    ]
    frame = frame_of(given)
    scaled = [frame.scaled(p) for p in given]
    surfaces = {
        (k, m): sweep(scaled[k], scaled[m], (angles[k, m],), _angle_plane) for k, m in wanted
    }
    net = surfaces[0, 1] if len(lines) == 2 else evolve_nd(surfaces, verify=verify)
    return frame.back(net)


def _angle_plane(p: Floats, p1: Floats, p2: Floats, theta: Floats, place: Place) -> Floats:
    n, n1, n2 = p[:3], p1[:3], p2[:3]
    fourth = angle_rule(n, n1, n2, theta, place)
    first, second = coeffs_kernel(n, n1, n2, fourth, place)
    distance = p[3] + (1.0 + first) * (p1[3] - p[3]) + (1.0 + second) * (p2[3] - p[3])
    return np.concatenate([fourth, distance[None]])

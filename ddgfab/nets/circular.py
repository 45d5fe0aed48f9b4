"""Circular nets: every quad has a circumcircle; measures, and evolution in two directions.

Source: Bobenko, Suris, Discrete Differential Geometry, 3.1; mathematics.md 2.1-2.3. For three and
more
directions see `miquel`, for cross-ratios `crossratio`, for the circles' axes and the normals at
the vertices `axes`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.mesh import Floats
from ddgfab.nets.conjugate import conjugate_residuals
from ddgfab.quads import Place, columns, cross, dot, edge_frame, measure, norm, pairs, sweep
from ddgfab.tolerances import RELATIVE_DEGENERATE

_COLLINEAR = "three corners lie on a line: their edges are parallel"


# --- circles -------------------------------------------------------------------------------------
@checked
def circumcircle(p: ArrayLike, q: ArrayLike, r: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """Center (..., 3), radius (...) and unit normal (..., 3) of the circle through three points.

    Parameters
    ----------
    p, q, r : (..., 3); the normal is on the side of (q - p) x (r - p)

    Raises
    ------
    DegenerateError
        Three points on a line; names their index.

    Examples
    --------
    >>> center, radius, normal = circumcircle([1.0, 0, 0], [0.0, 1, 0], [-1.0, 0, 0])
    >>> float(radius), normal
    (1.0, array([0., 0., 1.]))

    Source: mathematics.md 2.1.
    """
    first, second, third = columns(p, q, r)
    if len(first) != 3:
        raise InputError(f"circles need points in R^3; these have {len(first)} coordinates")
    frame = edge_frame(second - first, third - first, Place(name="circle"), _COLLINEAR)
    half, up = _center(frame.length, frame.along, frame.across)
    center = first + half * frame.e + up * frame.w
    normal = cross(frame.e, frame.w)
    return np.moveaxis(center, 0, -1), np.hypot(half, up), np.moveaxis(normal, 0, -1)


def _center(length: Floats, along: Floats, across: Floats) -> tuple[Floats, Floats]:
    """Plane coordinates of the circumcenter of (0, 0), (length, 0), (along, across)."""
    half = 0.5 * length
    return half, (along * (along - length) + across**2) / (2.0 * across)


@checked
def circularity(points: ArrayLike, axes: tuple[int, int] = (0, 1)) -> Floats:
    """Distance of the fourth point of each quad from the circle of the others, by radius.

    The larger of the distances from its sphere and from its plane. Zero for all quads: a circular
    net (mathematics.md 2.1).

    Parameters
    ----------
    points : (n1, ..., nd, dim)
    axes : the two directions of the quads

    Raises
    ------
    DegenerateError
        Three corners of a quad on a line; names the quad.
    """
    return measure(points, axes, circularity_kernel)


def circularity_kernel(x: Floats, x1: Floats, x2: Floats, x12: Floats, place: Place) -> Floats:
    """`circularity` with components first."""
    frame = edge_frame(x1 - x, x2 - x, place, _COLLINEAR)
    half, up = _center(frame.length, frame.along, frame.across)
    radius = np.hypot(half, up)
    fourth = x12 - x
    right, high = dot(fourth, frame.e), dot(fourth, frame.w)
    off_plane = norm(fourth - right * frame.e - high * frame.w)
    off_circle = np.hypot(right - half, high - up)
    off_sphere = np.abs(np.hypot(off_circle, off_plane) - radius)
    return np.asarray(np.maximum(off_sphere, off_plane) / radius)


@checked
def circular_residuals(points: ArrayLike) -> dict[str, float]:
    """Greatest planarity and circularity over the quads of all pairs of directions."""
    worst = max(float(circularity(points, p).max(initial=0.0)) for p in pairs(points))
    return {**conjugate_residuals(points), "circularity": worst}


# --- angles ---------------------------------------------------------------------------------------
@checked
def interior_angles(points: ArrayLike, axes: tuple[int, int] = (0, 1)) -> Floats:
    """Angle [rad] of each quad at x_k, from x - x_k towards the side of x_l.

    The data of `evolve_by_angles`; between -pi and pi, positive for convex quads.

    Of quads that are not quite circular, the mean of this angle and of pi less the opposite one:
    with it the net evolved from a sampled patch of curvature lines is off by the square of the
    mesh size, with the angle at x_k alone by its first power (measured on an ellipsoid).

    Raises
    ------
    DegenerateError
        Three corners of a quad on a line; names the quad.
    """

    def kernel(x: Floats, x1: Floats, x2: Floats, x12: Floats, place: Place) -> Floats:
        angles = []
        for here, opposite in ((x1, x2), (x2, x1)):
            frame = edge_frame(x - here, opposite - x, place, _COLLINEAR)
            fourth = x12 - here
            angles.append(np.arctan2(dot(fourth, frame.w), dot(fourth, frame.e)))
        # The two add up to a multiple of pi on a circle, also where the quad crosses itself.
        defect = angles[0] + angles[1]
        return np.asarray(angles[0] - 0.5 * (defect - np.pi * np.round(defect / np.pi)))

    return measure(points, axes, kernel)


@checked
def angle_sum_defect(points: ArrayLike, axes: tuple[int, int] = (0, 1)) -> Floats:
    """|angle at x + angle at x_kl - angle at x_k - angle at x_l| / 2 [rad] of each quad (2.6).

    Zero for convex circular quads, whose opposite angles add up to pi.
    """

    def angle(a: Floats, b: Floats) -> Floats:
        # Kahan's form: exact for small and for large angles.
        p, q = a / norm(a), b / norm(b)
        return np.asarray(2.0 * np.arctan2(norm(p - q), norm(p + q)))

    def kernel(x: Floats, x1: Floats, x2: Floats, x12: Floats, place: Place) -> Floats:
        sides = [x1 - x, x12 - x1, x2 - x12, x - x2]
        for side in sides:
            place.refuse(norm(side) == 0, "an edge has no length")
        at = [angle(-sides[k - 1], sides[k]) for k in range(4)]
        return np.asarray(0.5 * np.abs(at[0] + at[2] - at[1] - at[3]))

    return measure(points, axes, kernel)


# --- the fourth point ----------------------------------------------------------------------------
@checked
def fourth_by_t(
    x: ArrayLike, x1: ArrayLike, x2: ArrayLike, t: ArrayLike, *, convex: bool = False
) -> Floats:
    """(..., dim) fourth point x + inv((1 - t) inv(x1 - x) + t inv(x2 - x)), inv(v) = v / |v|^2.

    The cross-ratio q(x, x1, x12, x2) is -(1 - t) / t, so t = 1 / (1 - q). 0 < t < 1: convex.

    Parameters
    ----------
    x, x1, x2 : (..., dim)
    t : (...)
    convex : whether to refuse t outside 0..1

    Raises
    ------
    DegenerateError
        Corners on a line, t = 0 or 1 (the fourth point falls on x1 or x2), and with `convex`
        t outside 0..1; names the index.

    Source: mathematics.md 2.3 (i).
    """
    p, p1, p2, data = columns(x, x1, x2, np.asarray(t, dtype=np.float64)[..., None])
    return np.moveaxis(_t_rule(p, p1, p2, data[0], Place(), convex), 0, -1)


def _t_rule(
    x: Floats, x1: Floats, x2: Floats, t: Floats, place: Place, convex: bool = False
) -> Floats:
    a, b = x1 - x, x2 - x
    edge_frame(a, b, place, _COLLINEAR)
    t = np.broadcast_to(t, a.shape[1:])
    if convex:
        place.refuse((t <= 0) | (t >= 1), "t must lie between 0 and 1 for a convex quad", t)
    place.refuse(np.abs(t) <= RELATIVE_DEGENERATE, "t = 0 puts the fourth point on x_1", t)
    place.refuse(np.abs(1 - t) <= RELATIVE_DEGENERATE, "t = 1 puts the fourth point on x_2", 1 - t)
    first, second = (1 - t) * a / dot(a, a), t * b / dot(b, b)
    image = first + second  # not zero: a and b are not parallel
    return np.asarray(x + image / dot(image, image))


@checked
def fourth_by_angle(
    x: ArrayLike, x1: ArrayLike, x2: ArrayLike, angle: ArrayLike, *, convex: bool = False
) -> Floats:
    """(..., dim) fourth point of a circular quad with a given angle at x1; pi - angle at x2.

    Parameters
    ----------
    x, x1, x2 : (..., dim)
    angle : (...) [rad] at x1 from x - x1 towards the side of x2
    convex : whether to refuse angles that do not give a convex quad

    Raises
    ------
    DegenerateError
        Corners on a line, a fourth point that falls on x1 or x2, and with `convex` an angle that
        gives a quad which is not; names the index.

    Source: mathematics.md 2.3 (ii).
    """
    p, p1, p2, data = columns(x, x1, x2, np.asarray(angle, dtype=np.float64)[..., None])
    return np.moveaxis(angle_rule(p, p1, p2, data[0], Place(), convex), 0, -1)


def angle_rule(
    x: Floats, x1: Floats, x2: Floats, theta: Floats, place: Place, convex: bool = False
) -> Floats:
    """`fourth_by_angle` with components first."""
    frame = edge_frame(x - x1, x2 - x, place, _COLLINEAR)
    theta = np.broadcast_to(theta, x.shape[1:])
    cos, sin = np.cos(theta), np.sin(theta)
    a, p, q = frame.length, frame.along, frame.across
    # x1 is the origin, x = (a, 0), x2 = (a + p, q): the chord from x1 in direction (cos, sin).
    chord = a * cos + (p * (a + p) + q * q) / q * sin
    side = (a + p) * sin - q * cos  # its sign: on which side of the line x1 x2
    reach = np.hypot(a + p, q)
    place.refuse(
        np.abs(side) <= RELATIVE_DEGENERATE * reach, "the fourth point falls on x_2: angle", theta
    )
    place.refuse(
        np.abs(chord) <= RELATIVE_DEGENERATE * a, "the fourth point falls on x_1: angle", theta
    )
    if convex:
        place.refuse(~(chord * side > 0), "the quad is not convex: angle at x_1 [rad]", theta)
    return np.asarray(x1 + chord * (cos * frame.e + sin * frame.w))


# --- evolution -----------------------------------------------------------------------------------
@checked
def evolve_by_angles(
    first: ArrayLike, second: ArrayLike, angles: ArrayLike, *, convex: bool = False
) -> Floats:
    """(M + 1, N + 1, dim) circular net from two polylines and the angles of its quads.

    Well-posed: the way to make circular nets. `interior_angles` gives the angles back.

    Parameters
    ----------
    first, second : (M + 1, dim), (N + 1, dim) polylines from one point
    angles : (M, N) or number [rad], at x_1 from x - x_1 towards the side of x_2
    convex : whether to refuse quads that are not convex

    Raises
    ------
    InputError
        Shapes that do not fit, polylines with different first points.
    DegenerateError
        As `fourth_by_angle`; names the cell.

    Source: mathematics.md 2.3.
    """

    def rule(x: Floats, x1: Floats, x2: Floats, theta: Floats, place: Place) -> Floats:
        return angle_rule(x, x1, x2, theta, place, convex)

    return sweep(first, second, (angles,), rule)


@checked
def evolve_by_cross_ratio(
    first: ArrayLike, second: ArrayLike, ratios: ArrayLike, *, convex: bool = False
) -> Floats:
    """(M + 1, N + 1, dim) circular net from two polylines and its real cross-ratios.

    Warning: this is ill-posed, like the Cauchy problem of an elliptic equation. Small changes of
    the polylines grow with every cell, and refining the sampling of a smooth surface makes the
    result worse (measured on a patch of an ellipsoid: errors .02, .25, .36 for 4, 8, 16 cells a
    side, where angles leave .0015, .0004, .0001). Beyond a few cells use `evolve_by_angles`.

    Parameters
    ----------
    first, second : (M + 1, dim), (N + 1, dim) polylines from one point
    ratios : (M, N) or number, q(x, x_1, x_12, x_2) of each quad; negative: convex
    convex : whether to refuse quads that are not convex, t = 1 / (1 - q) outside 0..1

    Raises
    ------
    InputError
        Shapes that do not fit, polylines with different first points.
    DegenerateError
        q = 1, and as `fourth_by_t`; names the cell.

    Source: mathematics.md 2.2, 2.3.
    """

    def rule(x: Floats, x1: Floats, x2: Floats, q: Floats, place: Place) -> Floats:
        below = np.broadcast_to(1.0 - q, x.shape[1:])
        place.refuse(
            np.abs(below) <= RELATIVE_DEGENERATE, "cross-ratio 1 belongs to no quad: 1 - q", below
        )
        return _t_rule(x, x1, x2, 1.0 / below, place, convex)

    return sweep(first, second, (ratios,), rule)

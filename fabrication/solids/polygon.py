"""Plane polygons: least rectangle, area with rounded corners, turning angles."""

from __future__ import annotations

import numpy as np

from ddgfab.mesh import Floats, unit


def side_vectors(points: Floats) -> Floats:
    """(..., n, 2) from each corner to the next."""
    vectors: Floats = np.roll(points, -1, axis=-2) - points
    return vectors


def turns(points: Floats) -> Floats:
    """(..., n) exterior angle [rad] at each corner, positive where the polygon is convex."""
    ahead = side_vectors(points)
    back = np.roll(ahead, 1, axis=-2)
    cross = back[..., 0] * ahead[..., 1] - back[..., 1] * ahead[..., 0]
    angles: Floats = np.arctan2(cross, np.sum(back * ahead, axis=-1))
    return angles


def area(points: Floats, corner_radius: float = 0.0) -> Floats:
    """(...,) area [mm2] of (..., n, 2) polygons whose corners are rounded.

    A rounded corner of exterior angle t gives up r^2 (tan(t/2) - t/2), and wins it where t < 0.
    """
    ahead = np.roll(points, -1, axis=-2)
    twice = points[..., 0] * ahead[..., 1] - points[..., 1] * ahead[..., 0]
    half = 0.5 * turns(points)
    lost = corner_radius**2 * (np.tan(half) - half)
    total: Floats = np.sum(0.5 * twice - lost, axis=-1)
    return total


def least_rectangle(points: Floats) -> Floats:
    """(..., 2) smaller and larger side [mm] of the rectangle of least area round (..., n, 2)."""
    sides, _ = _least(points)
    return np.sort(sides, axis=-1)


def least_rectangle_turn(points: Floats) -> Floats:
    """(...,) angle [rad], within half a turn, of the larger side of the least rectangle.

    Turned back by it, points (..., n, 2) fill a rectangle whose larger side lies along x.
    """
    sides, along = _least(points)
    quarter = np.where(sides[..., 0] < sides[..., 1], 0.5 * np.pi, 0.0)
    angle: Floats = np.arctan2(along[..., 1], along[..., 0]) + quarter
    return np.mod(angle + 0.5 * np.pi, np.pi) - 0.5 * np.pi


def _least(points: Floats) -> tuple[Floats, Floats]:
    """(..., 2) sides [mm] of the least rectangle, and (..., 2) the direction of the first.

    One side of it lies along a side of the convex hull, so the directions of all pairs suffice.
    """
    first, second = np.triu_indices(points.shape[-2], 1)
    along = unit(points[..., second, :] - points[..., first, :])
    across = np.stack([-along[..., 1], along[..., 0]], axis=-1)
    lengths = np.ptp(np.einsum("...pi,...ni->...pn", along, points), axis=-1)
    widths = np.ptp(np.einsum("...pi,...ni->...pn", across, points), axis=-1)
    coincident = ~along.any(axis=-1)
    best = np.argmin(np.where(coincident, np.inf, lengths * widths), axis=-1)[..., None]
    sides = np.concatenate(
        [np.take_along_axis(lengths, best, -1), np.take_along_axis(widths, best, -1)], axis=-1
    )
    return sides, np.take_along_axis(along, best[..., None], -2)[..., 0, :]

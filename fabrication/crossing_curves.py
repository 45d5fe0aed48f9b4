"""Where two cylinders cross: a circle of one, moved along its axis onto the other.

A point of the curve is center + cos(t) a + sin(t) b + h(t) d, where d is the unit axis of the first
cylinder, whose angle is t, and h one of the two roots of a quadratic: the distances along d from
the circle to the second cylinder.
"""

from __future__ import annotations

import numpy as np

from ddgfab.mesh import Floats

Onto = Floats
"""(n, 7): a point of the second cylinder's axis, its unit direction, and its radius [mm] with the
sign of the root; radius 0: the circle stays where it is."""


def heights(center: Floats, a: Floats, b: Floats, onto: Onto, t: Floats) -> tuple[Floats, Floats]:
    """Distances h (n, m) [mm] along unit axes d of circles (n, 3), and their rates by angle.

    Parameters
    ----------
    center, a, b : (n, 3) of the circles; d is a x b / |a x b|
    t : (n, m) angles [rad]
    """
    d = _axes(a, b)
    axis, radius = onto[:, 3:6], onto[:, 6, None]
    cos, sin = np.cos(t)[..., None], np.sin(t)[..., None]
    away = (center - onto[:, :3])[:, None] + cos * a[:, None] + sin * b[:, None]
    rate = cos * b[:, None] - sin * a[:, None]

    def across(vectors: Floats) -> Floats:
        along = np.einsum("nmi,ni->nm", vectors, axis)
        return np.asarray(vectors - along[..., None] * axis[:, None])

    away, rate, way = across(away), across(rate), across(d[:, None])[:, 0]
    square = np.einsum("ni,ni->n", way, way)[:, None]
    half, half_rate = np.einsum("nmi,ni->nm", away, way), np.einsum("nmi,ni->nm", rate, way)
    rest = np.einsum("nmi,nmi->nm", away, away) - radius * radius
    rest_rate = 2.0 * np.einsum("nmi,nmi->nm", away, rate)
    root = np.sqrt(np.maximum(half * half - square * rest, 0.0))
    h = (np.sign(radius) * root - half) / square
    slope = -(half_rate * h + 0.5 * rest_rate) / (square * h + half)
    return np.asarray(h), np.asarray(slope)


def circle_angles(
    center: Floats, a: Floats, b: Floats, points: Floats, along: Floats
) -> tuple[Floats, Floats]:
    """Angles t (n, 2) of the two points where lines meet the cylinders of circles.

    Parameters
    ----------
    center, a, b : (n, 3) of the circles
    points, along : (n, 3) of lines that are not parallel to the cylinders' axes

    Returns
    -------
    The angles [rad], and how far the points are along the lines. A line that passes a cylinder by
    touches it.
    """
    d = _axes(a, b)
    away = points - center
    away = away - np.einsum("ni,ni->n", away, d)[:, None] * d
    way = along - np.einsum("ni,ni->n", along, d)[:, None] * d
    square = np.einsum("ni,ni->n", way, way)
    half = np.einsum("ni,ni->n", away, way)
    rest = np.einsum("ni,ni->n", away, away) - np.einsum("ni,ni->n", a, a)
    root = np.sqrt(np.maximum(half * half - square * rest, 0.0))
    steps = np.stack([-half - root, root - half], axis=1) / square[:, None]
    at = away[:, None] + steps[..., None] * way[:, None]
    angle = np.arctan2(np.einsum("nki,ni->nk", at, b), np.einsum("nki,ni->nk", at, a))
    return np.asarray(angle), steps


def _axes(a: Floats, b: Floats) -> Floats:
    """Unit axes of circles."""
    cross = np.cross(a, b)
    return np.asarray(cross / np.sqrt(np.einsum("ni,ni->n", cross, cross))[:, None])

"""Centring on contact points: the Lorentz boost after which points on the sphere have mean zero."""

from __future__ import annotations

from typing import Final

import numpy as np

from ddgfab.errors import DegenerateError
from ddgfab.mesh import Floats

MAX_BOOSTS: Final = 200
"""Newton steps of the centring; 5 to 10 are usual."""

CENTERED: Final = 1e-14
"""Contact points are centered when their mean is nearer to zero than this (sphere of radius 1)."""

CENTERED_LOOSE: Final = 1e-11
"""Where rounding lets the mean shrink no more, it is accepted below this."""

FASTEST: Final = 0.9
"""Greatest velocity of one boost."""


def boost(velocity: Floats) -> Floats:
    """(4, 4) Lorentz boost with a velocity (3,) of length below 1.

    A point t of the sphere, as (t, 1) up to scale, goes to
    (t_perp + g (<t, e> - |W|) e) / (g (1 - <t, W>)), g = 1 / sqrt(1 - |W|^2), W = |W| e.
    """
    square = float(velocity @ velocity)
    gamma = 1.0 / np.sqrt(1.0 - square)
    matrix = np.eye(4)
    if square > 0:
        matrix[:3, :3] += (gamma - 1.0) * np.outer(velocity, velocity) / square
    matrix[:3, 3] = matrix[3, :3] = -gamma * velocity
    matrix[3, 3] = gamma
    return matrix


def centring(points: Floats) -> tuple[Floats, float]:
    """(4, 4) Lorentz transformation that moves the mean of points to zero, and the mean left.

    Newton's method for the conformal center of mass: (I - mean t t^T) W = mean t, then a boost
    with velocity W. The boost is unique where less than half of the points coincide.

    Parameters
    ----------
    points : (N, 4) points of the light cone: a multiple of (t, 1) for each point t of the sphere

    Raises
    ------
    DegenerateError
        The points cannot be centered.

    Source: Springborn, A unique representation of polyhedral types (2005); mathematics.md 7.1.
    """
    total, best, left = np.eye(4), np.eye(4), np.inf
    for _ in range(MAX_BOOSTS):
        moved = points @ total.T
        if not moved[:, 3].min() > 0:
            break  # the boosts ran away: most points coincide
        t = moved[:, :3] / moved[:, 3:]
        mean = t.mean(axis=0)
        size = float(np.linalg.norm(mean))
        if size >= left and left < CENTERED_LOOSE:
            break  # rounding
        if size < left:
            best, left = total, size
        if size < CENTERED:
            break
        velocity = np.linalg.solve(np.eye(3) - t.T @ t / len(t), mean)
        speed = float(np.linalg.norm(velocity))
        total = boost(velocity * min(1.0, FASTEST / speed)) @ total
    if left >= CENTERED_LOOSE:
        raise DegenerateError(
            f"the contact points cannot be centered: their mean stays {left:.1e} off the center of "
            f"the sphere (limit {CENTERED_LOOSE:g})"
        )
    return best, left

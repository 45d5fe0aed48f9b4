"""Frames of bars and their exact derivatives.

Source: mathematics.md 11 (boss frames); complex-step differentiation.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from ddgfab.linkages.cauchy import Numbers, dots
from ddgfab.mesh import Floats, Ints

COMPLEX_STEP = 1e-30
"""Imaginary part of the parameter in exact derivatives; its square vanishes beside one."""


class Placed(Protocol):
    """Something that places hinges, analytic in its parameter."""

    def place(self, ts: Numbers) -> tuple[Numbers, Numbers]:
        """Points and unit axes, (T, V, 3) each."""


def bar_frames(points: Numbers, axes: Numbers, bars: Ints) -> Numbers:
    """(..., E, 4, 4) frames of bars: x along the bar, z along the axis of its first hinge.

    Analytic in points and axes (..., V, 3).
    """
    start, end = points[..., bars[:, 0], :], points[..., bars[:, 1], :]
    x = end - start
    x = x / np.sqrt(dots(x, x))
    z = axes[..., bars[:, 0], :]
    frames = np.zeros((*x.shape[:-1], 4, 4), dtype=x.dtype)
    frames[..., :3, 0], frames[..., :3, 1], frames[..., :3, 2] = x, np.cross(z, x), z
    frames[..., :3, 3], frames[..., 3, 3] = start, 1.0
    return frames


def frames_and_rates(placed: Placed, ts: Floats, bars: Ints) -> tuple[Floats, Floats]:
    """(T, E, 4, 4) frames of bars and their derivatives by t, exact by the complex step."""
    points, axes = placed.place(ts + 1j * COMPLEX_STEP)
    frames = bar_frames(points, axes, bars)
    return frames.real.copy(), frames.imag / COMPLEX_STEP


def angular_velocity(frames: Floats, rates: Floats) -> Floats:
    """(..., 3) angular velocity of frames (..., 4, 4) with derivatives `rates`."""
    skew = rates[..., :3, :3] @ np.swapaxes(frames[..., :3, :3], -1, -2)
    return np.stack([skew[..., 2, 1], skew[..., 0, 2], skew[..., 1, 0]], axis=-1)

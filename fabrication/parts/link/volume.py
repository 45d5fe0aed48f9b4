"""Volume of a link by a second route: the bar's length integrated over its section."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from ddgfab.mesh import Floats
from fabrication.parts.link.frame import Eye, bar_sides, eyes_of
from fabrication.solids.section import gauss
from fabrication.solids.text import label_volume

if TYPE_CHECKING:
    from fabrication.parts.link.shape import LinkShape

NODES: Final = 48
"""Nodes of the quadrature across each strip of the bar's section."""


def link_volume(shape: LinkShape) -> float:
    """Volume [mm3] of a link from its numbers.

    Eyes less bores, the bar's length integrated over its section, less the label's dots.
    """
    eyes = eyes_of(shape)
    frame = bar_sides(shape, eyes)[0]
    base = [np.array(vec) for vec in (frame.origin, frame.along, frame.across, frame.up)]
    s, weight = gauss(NODES)
    w, h, b = shape.bar_width / 2.0, shape.bar_height / 2.0, shape.bevel
    total = 0.0
    for left, right in ((-w, b - w), (b - w, w - b), (w - b, w)):
        if right <= left:
            continue
        y = left + s * (right - left)
        reach = h - np.maximum(0.0, np.abs(y) - (w - b))
        z = reach[:, None] * (2.0 * s - 1.0)
        foot = base[0] + y[:, None, None] * base[2] + z[..., None] * base[3]
        length = _crossing(eyes[1], foot, base[1], -1.0) - _crossing(eyes[0], foot, base[1], 1.0)
        area = (right - left) * weight[:, None] * 2.0 * reach[:, None] * weight
        total += float(np.sum(area * length))
    for bore in shape.bores:
        total += 0.25 * math.pi * (shape.eye_diameter**2 - bore**2) * shape.eye_height
    return total - label_volume(shape.label)


def _crossing(eye: Eye, foot: Floats, along: Floats, sign: float) -> Floats:
    """How far along their direction lines from `foot` (..., 3) leave or enter an eye."""
    axis = np.array(eye.axis)
    away = foot - np.array(eye.middle)
    p = away - (away @ axis)[..., None] * axis
    q = along - (along @ axis) * axis
    a, b, c = q @ q, p @ q, np.sum(p * p, axis=-1) - eye.radius**2
    return np.asarray((sign * np.sqrt(b * b - a * c) - b) / a)

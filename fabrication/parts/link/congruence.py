"""What makes two links congruent; the text of a label never distinguishes two parts."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from ddgfab.mesh import Floats
from fabrication.variants import Variants, key_of

if TYPE_CHECKING:
    from fabrication.parts.link.shape import LinkShape

TURNS: Final[Floats] = np.array([[1, 1, 1, 1], [1, -1, -1, 1], [-1, -1, 1, 1], [-1, 1, -1, 1.0]])
"""Diagonals of the half turns that carry a link to one of the same length and twist: none, about
the bar, about the mean of the axes (end for end), about what is perpendicular to both."""

CORNERS: Final = ((0, 1, 2, 3), (1, 0, 3, 2), (2, 3, 0, 1), (3, 2, 1, 0))
"""Where those turns carry the start's upper and lower and the end's upper and lower point."""


def link_key(shape: LinkShape) -> tuple[float, ...]:
    """What must agree exactly for two links to be congruent."""
    bores = sorted(map(key_of, shape.bores))
    section = map(key_of, (shape.bar_width, shape.bar_height, shape.bevel))
    eye = map(key_of, (shape.eye_diameter, shape.eye_height))
    return (*bores, *section, *eye)


def link_key_of(shape: LinkShape) -> Hashable:
    """Equal for links that one part number serves, by rounding: a quick count of part numbers."""
    start, end = key_of(shape.start), key_of(shape.end)
    turned = ((start, end), (end, start), (-start, -end), (-end, -start))
    return (*link_key(shape), key_of(shape.length), key_of(shape.twist), max(turned))


def link_variants(shapes: Sequence[LinkShape]) -> Variants:
    """Links of one key, turned in the four ways that keep length and twist.

    The canonical frame has its origin in the middle between the hinges, x along the bar and z
    along the mean of the axes. Characteristic points are the ends of both eyes on their axes. A
    link with two different bores is turned end for end only onto one that has them so.
    """
    half, twist, start, end, height = np.array(
        [(s.length / 2, s.twist / 2, s.start, s.end, s.eye_height / 2) for s in shapes]
    ).T
    sine, cosine, zero = np.sin(twist), np.cos(twist), np.zeros(len(shapes))
    points = np.stack(
        [
            np.stack([-half, sine * at, cosine * at], axis=-1)
            for at in (start + height, start - height)
        ]
        + [
            np.stack([half, -sine * at, cosine * at], axis=-1)
            for at in (end + height, end - height)
        ],
        axis=1,
    )
    motion = np.zeros((len(shapes), 4, 4))
    motion[:, 0, 0] = motion[:, 3, 3] = 1.0
    motion[:, 1, 1] = motion[:, 2, 2] = cosine
    motion[:, 1, 2], motion[:, 2, 1] = sine, -sine
    motion[:, 0, 3] = -half
    # Bores in the order of the first point: where they differ, a far point keeps the ends apart.
    first = np.array([[s.bores[0] - s.bores[1] for s in shapes], zero, zero]).T[:, None]
    turned = [
        np.concatenate(
            [points[:, corners, :] * turn[:3], first * (1.0 if turn[0] > 0.0 else -1.0)], axis=1
        )
        for corners, turn in zip(CORNERS, TURNS, strict=True)
    ]
    motions = TURNS[None, :, :, None] * motion[:, None]
    return Variants(np.stack(turned, axis=1), motions)

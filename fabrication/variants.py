"""Pieces in canonical frames: what clustering compares, and the rounding of what must agree."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from ddgfab.mesh import Floats

DECIMALS: Final = 6
"""Discrete dimensions (diameters, thicknesses) agree when equal to this many decimals of a mm."""


@dataclass(frozen=True, eq=False)
class Variants:
    """Pieces of one key in the frames of their variants.

    points : (N, m, P, d) characteristic points [mm]
    motions : (N, m, 4, 4) from the shape's frame to the canonical frame of a variant
    """

    points: Floats
    motions: Floats

    @classmethod
    def about_z(cls, points: Floats, turn: Floats, shift: Floats) -> Variants:
        """Variants whose canonical coordinates of a point p are rotate(p - shift, -turn) about z.

        turn is (N, m) [rad], shift (N, m, 3) [mm].
        """
        motions = np.zeros((*turn.shape, 4, 4))
        motions[..., 0, 0] = motions[..., 1, 1] = np.cos(turn)
        motions[..., 0, 1] = np.sin(turn)
        motions[..., 1, 0] = -motions[..., 0, 1]
        motions[..., 2, 2] = motions[..., 3, 3] = 1.0
        motions[..., :3, 3] = -np.einsum("...ij,...j->...i", motions[..., :3, :3], shift)
        return cls(points, motions)

    @classmethod
    def equal(cls, count: int) -> Variants:
        """Variants of so many equal shapes: their key holds all dimensions."""
        motions = np.broadcast_to(np.eye(4), (count, 1, 4, 4))
        return cls(np.zeros((count, 1, 1, 1)), motions)

    def frame(self, piece: int, variant: int) -> Floats:
        """(4, 4) motion from the shape's frame to the canonical frame of a variant."""
        return np.asarray(self.motions[piece, variant])


def key_of(value: float | None) -> float:
    """A discrete dimension as it is compared; -1 for None."""
    return -1.0 if value is None else round(value, DECIMALS)

"""Which of many bodies can share a volume at all: a test of all pairs needs to cut only these."""

from __future__ import annotations

from collections.abc import Sequence

import manifold3d
import numpy as np


def near_pairs(bodies: Sequence[manifold3d.Manifold]) -> list[tuple[int, int]]:
    """Places of the pairs whose boxes along the axes meet; others have no common point."""
    boxes = np.array([body.bounding_box() for body in bodies])
    low, high = boxes[:, :3], boxes[:, 3:]
    meet = (low[:, None] <= high[None]).all(axis=-1)
    first, second = np.nonzero(np.triu(meet & meet.T, 1))
    return list(zip(first.tolist(), second.tolist(), strict=True))

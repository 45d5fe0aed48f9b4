"""Bars and isograms of a linkage on a box of Z^d."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ddgfab.mesh import Ints


@dataclass(frozen=True, eq=False)
class Grid:
    """Bars and isograms of a box: hinge ids row by row.

    bars (E, 2) by direction, then by vertex; directions, strips (E,); cells (F, 4) around isograms;
    planes (F, 2) directions of each isogram
    """

    bars: Ints
    directions: Ints
    strips: Ints
    cells: Ints
    planes: Ints

    @staticmethod
    def build(shape: tuple[int, ...]) -> Grid:
        """Of a box with so many vertices in each direction."""
        d = len(shape)
        ids = np.arange(int(np.prod(shape))).reshape(shape)

        def part(steps: dict[int, slice]) -> Ints:
            return ids[tuple(steps.get(a, slice(None)) for a in range(d))]

        low, high = slice(None, -1), slice(1, None)
        bars, directions, strips = [], [], []
        first = 0
        for k in range(d):
            start, end = part({k: low}), part({k: high})
            bars.append(np.stack([start.ravel(), end.ravel()], axis=1))
            directions.append(np.full(start.size, k))
            strips.append(first + np.indices(start.shape)[k].ravel())
            first += shape[k] - 1
        cells, planes = [], []
        for k, other in combinations(range(d), 2):
            corners = [
                part({k: a, other: b})
                for a, b in ((low, low), (high, low), (high, high), (low, high))
            ]
            cells.append(np.stack([c.ravel() for c in corners], axis=1))
            planes.append(np.tile([k, other], (corners[0].size, 1)))
        return Grid(*map(np.concatenate, (bars, directions, strips, cells, planes)))

"""Samples of a trimmed surface: one grid for umbilics, for placing lines and for the checks.

Grid lines are moved by irrational parts of a cell: the umbilics of symmetric designs lie on round
parameters, where they would be missed.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ddgfab.mesh import Floats, extent
from ddgfab.surfaces.principal import Principal, principal
from ddgfab.surfaces.spline import Jets, SplineSurface

SIDE: Final = 60
_SHIFT: Final = (0.382, 0.732)


@dataclass(frozen=True, eq=False)
class Samples:
    """A grid of SIDE x SIDE parameters over the box of the trim.

    Attributes
    ----------
    uv : (SIDE, SIDE, 2); cell : (2,) its steps
    """

    surface: SplineSurface
    uv: Floats
    cell: Floats

    @staticmethod
    def of(surface: SplineSurface) -> Samples:
        """The samples of a surface."""
        u0, u1, v0, v1 = surface.trim.box
        cell = np.array([u1 - u0, v1 - v0]) / (SIDE + 1)
        steps = np.arange(SIDE)
        grid = np.meshgrid(
            u0 + (steps + _SHIFT[0]) * cell[0], v0 + (steps + _SHIFT[1]) * cell[1], indexing="ij"
        )
        return Samples(surface, np.stack(grid, axis=-1), cell)

    @cached_property
    def jets(self) -> Jets:
        """Of all samples, row after row."""
        return self.surface.jets(self.uv.reshape(-1, 2))

    @cached_property
    def principal(self) -> Principal:
        """Of all samples, row after row."""
        return principal(self.jets)

    @cached_property
    def inside(self) -> NDArray[np.bool_]:
        """(SIDE * SIDE,) which lie inside the trim."""
        return self.surface.trim.inside(self.uv.reshape(-1, 2))

    @cached_property
    def points(self) -> Floats:
        """(n, 3) points inside the trim."""
        return self.jets.x[self.inside]

    @cached_property
    def parameters(self) -> Floats:
        """(n, 2) parameters inside the trim."""
        return self.uv.reshape(-1, 2)[self.inside]

    @cached_property
    def diameter(self) -> float:
        """Size of the trimmed surface."""
        return extent(self.points)

    def rim(self, step: float) -> Floats:
        """(n, 3) points along the trimming curves, at most about `step` apart."""
        trim = self.surface.trim
        ways = np.linspace(0, 1, 33)[None, :, None]
        fine = trim.starts[:, None] + ways * (trim.ends - trim.starts)[:, None]
        coarse = self.surface.points(fine.reshape(-1, 2)).reshape((*fine.shape[:2], 3))
        lengths = np.linalg.norm(np.diff(coarse, axis=1), axis=2).sum(axis=1)
        out = [
            a + np.linspace(0, 1, count, endpoint=False)[:, None] * (b - a)
            for a, b, count in zip(
                trim.starts,
                trim.ends,
                np.maximum(1, np.ceil(lengths / step).astype(int)),
                strict=True,
            )
        ]
        return self.surface.points(np.concatenate(out))

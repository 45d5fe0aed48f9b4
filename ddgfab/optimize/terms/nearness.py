"""Near a surface and near its boundary: distances whose nearest points are found anew each step.

`at` gives a term with the nearest points and the normals of a state, as linear residuals: what a
Gauss-Newton step uses, and what its line search is measured by.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from ddgfab.mesh import Floats, Ints
from ddgfab.optimize.surface import RimCurve, SmoothSurface
from ddgfab.optimize.terms.base import LinearTerm


@dataclass(frozen=True, eq=False, kw_only=True)
class NearSurface:
    """A row a vertex: its distance from a smooth surface, along the normal; sliding is free.

    Attributes
    ----------
    vertices : (n,) ids
    """

    surface: SmoothSurface
    vertices: Ints
    weight: float = 1.0
    name: str = "surface"

    def at(self, x: Floats) -> LinearTerm:
        """The term with nearest points and normals of the unknowns x."""
        foot, normal = self.surface.closest(_points(x, self.vertices))
        return LinearTerm(
            name=self.name,
            matrix=_rows(normal, self.vertices, len(x)),
            target=np.einsum("nx,nx->n", foot, normal),
            weight=self.weight,
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class NearRim:
    """Three rows a vertex: its distance from a curve, across the curve; gliding along is free."""

    curve: RimCurve
    vertices: Ints
    weight: float = 1.0
    name: str = "boundary"

    def at(self, x: Floats) -> LinearTerm:
        """The term with nearest points and tangents of the unknowns x."""
        foot, along = self.curve.closest(_points(x, self.vertices))
        across = np.eye(3) - along[:, :, None] * along[:, None, :]
        return LinearTerm(
            name=self.name,
            matrix=_rows(across.reshape(-1, 3), np.repeat(self.vertices, 3), len(x)),
            target=np.einsum("nij,nj->ni", across, foot).ravel(),
            weight=self.weight,
        )


def _points(x: Floats, vertices: Ints) -> Floats:
    return np.asarray(x[3 * vertices[:, None] + np.arange(3)])


def _rows(values: Floats, vertices: Ints, columns: int) -> csr_array:
    """(n, columns) matrix with three numbers a row, at a vertex."""
    index = (3 * vertices[:, None] + np.arange(3)).ravel()
    starts = np.arange(0, len(index) + 1, 3)
    return csr_array((values.ravel(), index, starts), shape=(len(vertices), columns))

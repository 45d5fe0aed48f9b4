"""Pieces near the shapes of their clusters, which are unknown as well."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ddgfab.mesh import Floats, unit
from ddgfab.optimize.repetition import Clusters, Pieces
from ddgfab.optimize.terms.base import LocalTerm


@dataclass(frozen=True, eq=False, kw_only=True)
class ShapeDistances(LocalTerm):
    """Distance of two corners minus that of their cluster's shape, which is unknown as well."""

    def values(self, local: Floats) -> Floats:
        """(m,) residuals."""
        return np.asarray(np.linalg.norm(local[:, 3:6] - local[:, :3], axis=1) - local[:, 6])

    def gradients(self, local: Floats) -> Floats:
        """(m, 7)."""
        way = unit(local[:, 3:6] - local[:, :3])
        return np.concatenate([-way, way, np.full((len(way), 1), -1.0)], axis=1)


def near_shapes(
    group: Pieces, clusters: Clusters, first: int, away: Floats, width: float
) -> ShapeDistances:
    """Distances near those of the clusters; pieces further off than `width` weigh little.

    first : unknown where the block of the clusters' shapes begins
    """
    weight = width**2 / (width**2 + away**2)  # its square is that of Geman and McClure
    ends = group.corners[:, group.pairs].reshape(-1, 2)
    corners = (3 * ends[..., None] + np.arange(3)).reshape(len(ends), -1)
    shapes = first + clusters.cluster[:, None] * clusters.shapes.shape[1] + clusters.places
    return ShapeDistances(
        name="family shapes",
        index=np.concatenate([corners, shapes.reshape(-1, 1)], axis=1),
        factor=np.repeat(weight, len(group.pairs)),
    )

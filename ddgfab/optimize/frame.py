"""The frame of an optimisation: mean edge one, center at the origin, whatever unit a mesh has."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ddgfab.errors import InputError
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.problem import mean_edge


@dataclass(frozen=True, eq=False)
class Frame:
    """Origin and unit of an optimisation, of the mesh it begins with.

    Attributes
    ----------
    mesh : the mesh in its own unit
    center : (3,) mean of the corners of its faces
    unit : its mean edge
    """

    mesh: Mesh
    center: Floats
    unit: float

    @staticmethod
    def of(mesh: Mesh) -> Frame:
        """The frame of a mesh."""
        return Frame(mesh, mesh.vertices[mesh.corners].mean(axis=0), mean_edge(mesh))

    def inside(self, other: Mesh) -> Mesh:
        """A mesh of the same unit, in the frame."""
        return other.with_vertices((other.vertices - self.center) / self.unit)

    def outside(self, start: Floats, found: Floats) -> Mesh:
        """The mesh with (V, 3) vertices found in the frame; those that did not move keep each bit.

        Parameters
        ----------
        start : (V, 3) vertices in the frame at the beginning
        """
        moved = (found != start).any(axis=1)
        points = np.where(moved[:, None], found * self.unit + self.center, self.mesh.vertices)
        return self.mesh.with_vertices(points)


def element_ids(given: Sequence[int] | Ints, limit: int, noun: str) -> Ints:
    """Ids, each once, in order.

    Raises
    ------
    InputError
        An id out of range.
    """
    ids = np.unique(np.asarray(given, dtype=np.int64))
    if len(ids) and not 0 <= ids[0] <= ids[-1] < limit:
        bad = ids[0] if ids[0] < 0 else ids[-1]
        raise InputError(f"{noun} {bad}; ids run from 0 to {limit - 1}")
    return ids

"""Vertices on curves and surfaces: gliding boundaries, closeness to a reference surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ddgfab.arguments import checked
from ddgfab.mesh import Floats, Ints, Mesh, unit
from ddgfab.optimize.problem import mean_edge
from ddgfab.optimize.terms.base import LocalTerm
from ddgfab.optimize.terms.closest import SegmentTree, TriangleTree, triangulated

_STRAIGHT = 1e-9
"""A point nearer to a surface than this part of the mean edge lies on it."""

_CORNER = np.radians(30.0)
"""The boundary has a corner where it turns by more than this [rad]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class OnCurve(LocalTerm):
    """Two rows a vertex: its distance from the nearest segment of a curve, across the segment."""

    curve: SegmentTree

    def values(self, local: Floats) -> Floats:
        """(2n,) residuals."""
        foot, across = self._frames(local)
        return np.asarray(np.einsum("nx,nx->n", local - foot, across))

    def gradients(self, local: Floats) -> Floats:
        """(2n, 3): the direction across, the same for both ends of a segment."""
        return self._frames(local)[1]

    def _frames(self, local: Floats) -> tuple[Floats, Floats]:
        points = local[::2]
        foot, ways = self.curve.closest(points)
        helper = np.zeros_like(ways)
        helper[np.arange(len(ways)), np.abs(ways).argmin(axis=1)] = 1.0
        first = unit(np.cross(ways, helper))
        across = np.stack([first, np.cross(ways, first)], axis=1)
        return np.repeat(foot, 2, axis=0), across.reshape(-1, 3)


@checked
def on_curve(
    mesh: Mesh,
    vertices: Sequence[int] | Ints,
    segments: Floats,
    *,
    weight: float = 1.0,
    hard: bool = True,
) -> OnCurve:
    """Vertices that may glide along a curve of (s, 2, 3) segments; residuals in mean edges."""
    ids = np.asarray(vertices, dtype=np.int64)
    return OnCurve(
        name="curve",
        index=np.repeat(3 * ids[:, None] + np.arange(3), 2, axis=0),
        factor=1.0 / mean_edge(mesh),
        weight=weight,
        hard=hard,
        of="vertex",
        elements=np.repeat(ids, 2),
        curve=SegmentTree(segments),
    )


@checked
def boundary_glide(mesh: Mesh, vertices: Sequence[int] | Ints) -> tuple[tuple[OnCurve, ...], Ints]:
    """Boundary vertices that glide along the boundary as it is, and its corners, to be fixed.

    Corners are where the boundary turns by more than 30 deg.
    """
    ids = np.asarray(vertices, dtype=np.int64)
    rim = mesh.edges[mesh.boundary_edge]
    along = unit(mesh.vertices[rim[:, 1]] - mesh.vertices[rim[:, 0]])
    total = np.zeros_like(mesh.vertices)
    np.add.at(total, rim.ravel(), np.repeat(along, 2, axis=0))
    # |sum of two unit directions| = 2 cos(half the turn)
    corner = np.linalg.norm(total[ids], axis=1) < 2 * np.cos(_CORNER / 2)
    if corner.all():
        return (), ids
    return (on_curve(mesh, ids[~corner], mesh.vertices[rim]),), ids[corner]


@dataclass(frozen=True, eq=False, kw_only=True)
class OnSurface(LocalTerm):
    """A row a vertex: its distance from a surface; sliding along it costs nothing."""

    surface: TriangleTree
    near: float

    def values(self, local: Floats) -> Floats:
        """(n,) residuals."""
        foot, normal = self._feet(local)
        return np.asarray(np.einsum("nx,nx->n", local - foot, normal))

    def gradients(self, local: Floats) -> Floats:
        """(n, 3): the normal, or the direction to the nearest point of an edge or vertex."""
        return self._feet(local)[1]

    def _feet(self, local: Floats) -> tuple[Floats, Floats]:
        foot, normal = self.surface.closest(local)
        away = local - foot
        far = np.linalg.norm(away, axis=1)
        side = np.where(np.einsum("nx,nx->n", away, normal) < 0, -1.0, 1.0)
        return foot, np.where((far > self.near)[:, None], unit(away) * side[:, None], normal)


@checked
def on_surface(
    mesh: Mesh,
    reference: Mesh,
    vertices: Sequence[int] | Ints | None = None,
    *,
    weight: float = 1.0,
    hard: bool = False,
) -> OnSurface:
    """Vertices near a reference surface, free to slide along it; residuals in mean edges.

    Parameters
    ----------
    reference : any mesh; its polygons are cut into triangles
    vertices : ids, all by default

    Source: the distance of the nearest point of all triangles; its gradient is the normal there.
    """
    ids = np.flatnonzero(mesh.valences > 0) if vertices is None else np.asarray(vertices)
    size = mean_edge(mesh)
    return OnSurface(
        name="surface",
        index=3 * ids[:, None].astype(np.int64) + np.arange(3),
        factor=1.0 / size,
        weight=weight,
        hard=hard,
        of="vertex",
        elements=ids,
        surface=TriangleTree(triangulated(reference)),
        near=_STRAIGHT * size,
    )

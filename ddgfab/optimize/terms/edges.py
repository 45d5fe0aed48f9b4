"""Lengths: equal or bounded edges, edges that keep their length, opposite sides equal, panel sizes.

All residuals are relative lengths, so that they have no unit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.mesh import Floats, Ints, Mesh, unit
from ddgfab.optimize.problem import mean_edge
from ddgfab.optimize.terms.base import LocalTerm
from ddgfab.optimize.terms.planarity import polygon_corners

_QUAD = 4


def _unknowns(vertices: Ints) -> Ints:
    """(m, 3k) unknowns of (m, k) vertices."""
    index: Ints = (3 * vertices[..., None] + np.arange(3)).reshape(len(vertices), -1)
    return index


def _chosen(ids: Sequence[int] | Ints | None, count: int) -> Ints:
    return np.arange(count) if ids is None else np.asarray(ids, dtype=np.int64)


@dataclass(frozen=True, eq=False, kw_only=True)
class Lengths(LocalTerm):
    """Distance of two points minus a target; beyond bounds only, where they differ.

    Attributes
    ----------
    low, high : (m,) or numbers; equal for a target, apart for bounds within which nothing is asked
    """

    low: Floats | float
    high: Floats | float

    def values(self, local: Floats) -> Floats:
        """(m,) lengths above the upper bound, or below the lower one as negative numbers."""
        length = np.linalg.norm(local[:, 3:] - local[:, :3], axis=1)
        return np.asarray(length - np.clip(length, self.low, self.high))

    def gradients(self, local: Floats) -> Floats:
        """(m, 6): the unit direction, zero within bounds."""
        way = local[:, 3:] - local[:, :3]
        length = np.linalg.norm(way, axis=1)
        inside = (length > self.low) & (length < self.high)
        slope = np.where(inside[:, None], 0.0, unit(way))
        return np.concatenate([-slope, slope], axis=1)


@checked
def edge_lengths(
    mesh: Mesh,
    *,
    target: float | Floats | None = None,
    low: float | None = None,
    high: float | None = None,
    edges: Sequence[int] | Ints | None = None,
    weight: float = 1.0,
    hard: bool = False,
) -> Lengths:
    """Edges of a length, or within bounds, in the unit of the mesh.

    Parameters
    ----------
    target : a length, or one for each edge chosen; the mean of them by default (equal edges).
        For a Chebyshev net that keeps its edges: ``mesh.edge_lengths``
    low, high : bounds instead of a target; one of them is enough
    edges : ids, all by default

    Raises
    ------
    InputError
        A target and bounds, bounds the wrong way round, lengths that are not positive.
    """
    ids = _chosen(edges, mesh.n_edges)
    least: Floats | float
    most: Floats | float
    if low is not None or high is not None:
        if target is not None:
            raise InputError("edges have either a target length or bounds, not both")
        least, most = low or 0.0, np.inf if high is None else high
    else:
        aim = mesh.edge_lengths[ids].mean() if target is None else target
        least = most = np.broadcast_to(np.asarray(aim, dtype=np.float64), len(ids))
    if np.min(least) < 0 or not np.min(most) > 0 or np.any(np.asarray(most) < least):
        raise InputError(f"edge lengths from {np.min(least):g} to {np.max(most):g} do not exist")
    return Lengths(
        name="edge length",
        index=_unknowns(mesh.edges[ids]),
        factor=1.0 / mean_edge(mesh),
        weight=weight,
        hard=hard,
        of="edge",
        elements=ids,
        low=least,
        high=most,
    )


@checked
def edge_stretch(mesh: Mesh, most: float, *, weight: float = 1.0) -> Lengths:
    """Edges that become longer or shorter by a factor of `most` at most; relative to their length.

    Raises
    ------
    InputError
        A factor below one.
    """
    if not most >= 1:
        raise InputError(f"edges may stretch by a factor of one or more, not {most:g}")
    length: Floats = np.maximum(mesh.edge_lengths, np.finfo(float).tiny)
    return Lengths(
        name="edge stretch",
        index=_unknowns(mesh.edges),
        factor=1.0 / length,
        weight=weight,
        of="edge",
        elements=np.arange(mesh.n_edges),
        low=length / most,
        high=length * most,
    )


@checked
def edge_bounds(mesh: Mesh, high: Floats, *, weight: float = 1.0) -> Lengths:
    """Edges no longer than (E,) bounds of their own, in the unit of the mesh; may be infinite."""
    ids = np.flatnonzero(np.isfinite(high))
    return Lengths(
        name="edge length",
        index=_unknowns(mesh.edges[ids]),
        factor=1.0 / mean_edge(mesh),
        weight=weight,
        of="edge",
        elements=ids,
        low=0.0,
        high=high[ids],
    )


@checked
def panel_size(
    mesh: Mesh,
    limit: float,
    *,
    faces: Sequence[int] | Ints | None = None,
    weight: float = 1.0,
    hard: bool = False,
) -> Lengths:
    """No two corners of a face further apart than a limit, in the unit of the mesh.

    So every panel fits into a circle of 1.155 times the limit (Jung's theorem).

    Raises
    ------
    InputError
        A limit that is not positive.
    """
    if not limit > 0:
        raise InputError(f"panels no larger than {limit:g} do not exist")
    wanted = np.zeros(mesh.n_faces, dtype=bool)
    wanted[_chosen(faces, mesh.n_faces)] = True
    pairs, owner = [], []
    for size in np.unique(mesh.face_sizes[wanted]).tolist():
        ids, corners = polygon_corners(mesh, size)
        ids, corners = ids[wanted[ids]], corners[wanted[ids]]
        a, b = np.triu_indices(size, 1)
        pairs.append(np.stack([corners[:, a], corners[:, b]], axis=2).reshape(-1, 2))
        owner.append(np.repeat(ids, len(a)))
    return Lengths(
        name="panel size",
        index=_unknowns(np.concatenate(pairs)),
        factor=1.0 / mean_edge(mesh),
        weight=weight,
        hard=hard,
        of="face",
        elements=np.concatenate(owner),
        low=0.0,
        high=limit,
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class SideDifferences(LocalTerm):
    """|b - a| - |d - c| of four points: make with `opposite_sides`."""

    def values(self, local: Floats) -> Floats:
        """(m,) residuals."""
        first, second = local[:, 3:6] - local[:, :3], local[:, 9:] - local[:, 6:9]
        return np.asarray(np.linalg.norm(first, axis=1) - np.linalg.norm(second, axis=1))

    def gradients(self, local: Floats) -> Floats:
        """(m, 12): unit directions."""
        first = unit(local[:, 3:6] - local[:, :3])
        second = unit(local[:, 9:] - local[:, 6:9])
        return np.concatenate([-first, first, second, -second], axis=1)


@checked
def opposite_sides(mesh: Mesh, *, weight: float = 1.0, hard: bool = False) -> SideDifferences:
    """Chebyshev nets: opposite sides of every quad are equal; two rows a quad, in mean edges.

    Raises
    ------
    InputError
        No quads.

    Source: mathematics.md 3.6, 3.10.
    """
    ids, corners = polygon_corners(mesh, _QUAD)
    if not len(ids):
        raise InputError("opposite sides are those of quads, and the mesh has none")
    pairs = np.concatenate([corners[:, [0, 1, 3, 2]], corners[:, [1, 2, 0, 3]]])
    return SideDifferences(
        name="opposite sides",
        index=_unknowns(pairs),
        factor=1.0 / mean_edge(mesh),
        weight=weight,
        hard=hard,
        of="face",
        elements=np.concatenate([ids, ids]),
    )

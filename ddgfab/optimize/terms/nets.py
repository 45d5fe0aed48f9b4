"""Conditions on nets: plane vertex stars (A-nets, K-nets), orthogonality, angle limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.problem import mean_edge
from ddgfab.optimize.terms.base import LocalTerm
from ddgfab.optimize.terms.planarity import polygon_corners

_QUAD = 4


@dataclass(frozen=True, eq=False, kw_only=True)
class StarVolumes(LocalTerm):
    """det(b - a, c - a, d - a) of four points; make with `plane_stars`."""

    def values(self, local: Floats) -> Floats:
        """(m,) residuals: six times the volume of the tetrahedron."""
        b, c, d = self._ways(local)
        return np.asarray(np.einsum("mx,mx->m", np.cross(b, c), d))

    def gradients(self, local: Floats) -> Floats:
        """(m, 12): cross products of the other two ways."""
        b, c, d = self._ways(local)
        slope = [np.cross(c, d), np.cross(d, b), np.cross(b, c)]
        return np.concatenate([-(slope[0] + slope[1] + slope[2]), *slope], axis=1)

    @staticmethod
    def _ways(local: Floats) -> tuple[Floats, Floats, Floats]:
        a = local[:, :3]
        return local[:, 3:6] - a, local[:, 6:9] - a, local[:, 9:] - a


@checked
def plane_stars(
    mesh: Mesh,
    vertices: Sequence[int] | Ints | None = None,
    *,
    weight: float = 1.0,
    hard: bool = True,
) -> StarVolumes:
    """Every vertex lies in a plane with its neighbours: an A-net, along asymptotic lines.

    With `opposite_sides`, or edges that keep their lengths: a K-net. A vertex of valence n gets
    n - 2 rows, one for three edges in a row each; residuals are parts of mean edge cubed.

    Raises
    ------
    InputError
        No vertex of valence 3 or more among those chosen.

    Source: mathematics.md 3.1, 3.5; Bobenko, Suris, Discrete Differential Geometry, 2.4.
    """
    chosen = np.zeros(mesh.n_vertices, dtype=bool)
    chosen[slice(None) if vertices is None else np.asarray(vertices, dtype=np.int64)] = True
    points, owner = [], []
    for valence in np.unique(mesh.valences[chosen & (mesh.valences > 2)]).tolist():
        ids = np.flatnonzero(chosen & (mesh.valences == valence))
        edges = mesh.edges[mesh.star_edges[mesh.star_start[ids, None] + np.arange(valence)]]
        ends = np.where(edges[..., 0] == ids[:, None], edges[..., 1], edges[..., 0])
        for start in range(valence - 2):
            points.append(np.concatenate([ids[:, None], ends[:, start : start + 3]], axis=1))
            owner.append(ids)
    if not points:
        raise InputError("no vertex of valence 3 or more: every star is plane already")
    four = np.concatenate(points)
    return StarVolumes(
        name="plane stars",
        index=(3 * four[..., None] + np.arange(3)).reshape(len(four), -1),
        factor=mean_edge(mesh) ** -3,
        weight=weight,
        hard=hard,
        of="vertex",
        elements=np.concatenate(owner),
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class Crossings(LocalTerm):
    """Cosine of the angle between the medians of quads; make with `orthogonality`."""

    def values(self, local: Floats) -> Floats:
        """(m,) cosines."""
        return self._parts(local)[0]

    def gradients(self, local: Floats) -> Floats:
        """(m, 12) derivatives."""
        cosine, (first, second), (one, two) = self._parts(local)
        by_first = (second - cosine[:, None] * first) / one[:, None]
        by_second = (first - cosine[:, None] * second) / two[:, None]
        signs = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) / 2
        return np.concatenate([s * by_first + t * by_second for s, t in signs], axis=1)

    @staticmethod
    def _parts(local: Floats) -> tuple[Floats, tuple[Floats, Floats], tuple[Floats, Floats]]:
        a, b, c, d = local.reshape(-1, _QUAD, 3).transpose(1, 0, 2)
        first, second = (b + c - a - d) / 2, (c + d - a - b) / 2
        one, two = np.linalg.norm(first, axis=1), np.linalg.norm(second, axis=1)
        first, second = first / one[:, None], second / two[:, None]
        return np.einsum("mx,mx->m", first, second), (first, second), (one, two)


@checked
def orthogonality(mesh: Mesh, *, weight: float = 1.0, hard: bool = False) -> Crossings:
    """Nets whose two directions cross at right angles: medians of every quad are orthogonal.

    Raises
    ------
    InputError
        No quads.
    """
    ids, corners = polygon_corners(mesh, _QUAD)
    if not len(ids):
        raise InputError("orthogonality is asked of quads, and the mesh has none")
    return Crossings(
        name="orthogonality",
        index=(3 * corners[..., None] + np.arange(3)).reshape(len(ids), -1),
        weight=weight,
        hard=hard,
        of="face",
        elements=ids,
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class CornerLimits(LocalTerm):
    """Cosine of an angle beyond its bounds; make with `corner_angle_limits`.

    Attributes
    ----------
    low, high : bounds of the cosine
    """

    low: float
    high: float

    def values(self, local: Floats) -> Floats:
        """(m,) cosines beyond the bounds, 0 within."""
        cosine = self._parts(local)[0]
        return np.asarray(cosine - np.clip(cosine, self.low, self.high))

    def gradients(self, local: Floats) -> Floats:
        """(m, 9) derivatives by apex, first and second point, zero within bounds."""
        cosine, first, second, one, two = self._parts(local)
        by_first = (second - cosine[:, None] * first) / one[:, None]
        by_second = (first - cosine[:, None] * second) / two[:, None]
        slope = np.concatenate([-by_first - by_second, by_first, by_second], axis=1)
        inside = (cosine > self.low) & (cosine < self.high)
        return np.where(inside[:, None], 0.0, slope)

    @staticmethod
    def _parts(local: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        first, second = local[:, 3:6] - local[:, :3], local[:, 6:] - local[:, :3]
        one, two = np.linalg.norm(first, axis=1), np.linalg.norm(second, axis=1)
        first, second = first / one[:, None], second / two[:, None]
        return np.einsum("mx,mx->m", first, second), first, second, one, two


@checked
def corner_angle_limits(
    mesh: Mesh, low: float, high: float, *, weight: float = 1.0, hard: bool = False
) -> CornerLimits:
    """Angles between edges that follow each other round a node, within bounds [rad].

    These are the corner angles of the faces: what a node has room for, and what glass allows.

    Raises
    ------
    InputError
        Not 0 <= low < high <= pi.
    """
    if not 0 <= low < high <= np.pi:
        raise InputError(f"corner angles from {low:g} to {high:g} rad; 0 <= low < high <= pi")
    triples = np.stack(
        [mesh.corners, mesh.corners[mesh.corner_next], mesh.corners[mesh.corner_previous]], axis=1
    )
    return CornerLimits(
        name="corner angles",
        index=(3 * triples[..., None] + np.arange(3)).reshape(len(triples), -1),
        weight=weight,
        hard=hard,
        of="face",
        elements=mesh.corner_face,
        low=float(np.cos(high)),
        high=float(np.cos(low)),
    )

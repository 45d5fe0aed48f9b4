"""Sums of angles at corners: circular faces, conical vertices of valence four.

All angles lie between 0 and pi, as angles between two vectors do; faces are planar by another term.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ddgfab.arguments import checked
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.terms.base import LocalTerm
from ddgfab.optimize.terms.planarity import polygon_corners

_QUAD = 4
_ALTERNATE = np.array([0.5, -0.5, 0.5, -0.5])


@dataclass(frozen=True, eq=False, kw_only=True)
class AngleSums(LocalTerm):
    """sum_i s_i angle_i - total; make with `circularity_terms` or `conicality_terms`.

    Attributes
    ----------
    signs : (k,) factors s of the k angles of each row; the unknowns of a row are the points
        (apex, first, second) of one angle after the other
    total : (m,) or a number [rad]
    """

    signs: Floats
    total: Floats | float = 0.0

    def values(self, local: Floats) -> Floats:
        """(m,) residuals [rad]."""
        first, second = self._arms(local)
        sine = np.linalg.norm(np.cross(first, second), axis=-1)
        angle = np.arctan2(sine, np.einsum("mkx,mkx->mk", first, second))
        return np.asarray(angle @ self.signs - self.total)

    def gradients(self, local: Floats) -> Floats:
        """(m, 9k) derivatives; an angle grows as an arm turns away from the other one."""
        first, second = self._arms(local)
        turned = np.cross(first, second)
        with np.errstate(invalid="ignore", divide="ignore"):
            axis = turned / np.linalg.norm(turned, axis=-1, keepdims=True)
        axis = np.nan_to_num(axis)  # straight or closed angles have no derivative: 0 is one of many
        by_first = np.cross(first, axis) / np.einsum("mkx,mkx->mk", first, first)[..., None]
        by_second = np.cross(axis, second) / np.einsum("mkx,mkx->mk", second, second)[..., None]
        slope = np.stack([-by_first - by_second, by_first, by_second], axis=2)
        slope *= self.signs[:, None, None]
        return np.asarray(slope.reshape(len(local), -1))

    def _arms(self, local: Floats) -> tuple[Floats, Floats]:
        points = local.reshape(len(local), -1, 3, 3)
        return points[:, :, 1] - points[:, :, 0], points[:, :, 2] - points[:, :, 0]


def _unknowns(triples: Ints) -> Ints:
    """(m, 9k) unknowns of (m, k, 3) vertex ids (apex, first, second)."""
    index: Ints = (3 * triples[..., None] + np.arange(3)).reshape(len(triples), -1)
    return index


@checked
def circularity_terms(
    mesh: Mesh,
    faces: Sequence[int] | Ints | None = None,
    *,
    weight: float = 1.0,
    hard: bool = True,
) -> tuple[AngleSums, ...]:
    """Corners of faces on circles: half the difference of sums of opposite angles [rad].

    Faces with k corners get k - 3 rows, for four corners in a row each. Use together with
    `planarity_terms`.

    Source: theorem of inscribed angles; Bobenko, Suris, Discrete Differential Geometry, 3.1.
    """
    chosen = np.zeros(mesh.n_faces, dtype=bool)
    chosen[slice(None) if faces is None else np.asarray(faces, dtype=np.int64)] = True
    quads, owner = [], []
    for size in np.unique(mesh.face_sizes[chosen & (mesh.face_sizes > 3)]).tolist():
        ids, corners = polygon_corners(mesh, size)
        ids, corners = ids[chosen[ids]], corners[chosen[ids]]
        for start in range(size - 3):
            quads.append(corners[:, start : start + _QUAD])
            owner.append(ids)
    if not quads:
        return ()
    quad = np.concatenate(quads)
    triples = np.stack([quad, np.roll(quad, -1, axis=1), np.roll(quad, 1, axis=1)], axis=2)
    return (
        AngleSums(
            name="circularity",
            index=_unknowns(triples),
            weight=weight,
            hard=hard,
            signs=_ALTERNATE,
            of="face",
            elements=np.concatenate(owner),
        ),
    )


@checked
def conicality_terms(
    mesh: Mesh,
    vertices: Sequence[int] | Ints | None = None,
    *,
    weight: float = 1.0,
    hard: bool = True,
) -> tuple[AngleSums, ...]:
    """Faces round inner vertices of valence 4 touch a cone: half the difference of angle sums.

    Three planar faces always touch one; vertices of higher valence: `cone_terms`. Use together
    with `planarity_terms`.

    Source: Wang, Wallner, Liu 2007, theorem on angle sums; mathematics.md 2.9.
    """
    chosen = np.zeros(mesh.n_vertices, dtype=bool)
    chosen[slice(None) if vertices is None else np.asarray(vertices, dtype=np.int64)] = True
    ids = np.flatnonzero(chosen & ~mesh.boundary_vertex & (mesh.valences == _QUAD))
    if not len(ids):
        return ()
    edges = mesh.edges[mesh.star_edges[mesh.star_start[ids, None] + np.arange(_QUAD)]]
    ends = np.where(edges[..., 0] == ids[:, None], edges[..., 1], edges[..., 0])
    apex = np.broadcast_to(ids[:, None], ends.shape)
    triples = np.stack([apex, ends, np.roll(ends, -1, axis=1)], axis=2)
    return (
        AngleSums(
            name="conicality",
            index=_unknowns(triples),
            weight=weight,
            hard=hard,
            signs=_ALTERNATE,
            of="vertex",
            elements=ids,
        ),
    )

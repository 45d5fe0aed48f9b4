"""Cones at vertices of any valence: the unit normals of the faces round a vertex lie in a plane."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.terms.base import LocalTerm
from ddgfab.optimize.terms.planarity import vector_areas

_LEAST = 5
_FACES = 4


@dataclass(frozen=True, eq=False, kw_only=True)
class Cones(LocalTerm):
    """det(n1 - n0, n2 - n0, n3 - n0) of the unit normals of four faces; make with `cone_terms`."""

    def values(self, local: Floats) -> Floats:
        """(m,) residuals: height of the fourth normal above the plane of the others."""
        normals = self._normals(local)[0]
        a, b, c = (normals[:, k] - normals[:, 0] for k in (1, 2, 3))
        return np.asarray(np.einsum("mx,mx->m", np.cross(a, b), c))

    def gradients(self, local: Floats) -> Floats:
        """(m, 12k) derivatives by the corners of the four faces."""
        normals, lengths, points = self._normals(local)
        a, b, c = (normals[:, k] - normals[:, 0] for k in (1, 2, 3))
        slope = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)
        slope = np.concatenate([-slope.sum(axis=1, keepdims=True), slope], axis=1)
        slope -= np.einsum("mfx,mfx->mf", slope, normals)[..., None] * normals
        slope /= 2 * lengths[..., None]
        across = np.roll(points, -1, axis=2) - np.roll(points, 1, axis=2)
        return np.asarray(np.cross(across, slope[:, :, None]).reshape(len(local), -1))

    def _normals(self, local: Floats) -> tuple[Floats, Floats, Floats]:
        points = local.reshape(len(local), _FACES, -1, 3)
        areas = vector_areas(points.reshape(len(local) * _FACES, -1, 3)).reshape(-1, _FACES, 3)
        lengths = np.linalg.norm(areas, axis=2)
        return areas / lengths[..., None], lengths, points


def cone_terms(
    mesh: Mesh,
    vertices: Sequence[int] | Ints | None = None,
    *,
    weight: float = 1.0,
    hard: bool = True,
) -> tuple[Cones, ...]:
    """Faces round inner vertices of valence 5 or more touch a cone.

    Residuals: a unit normal's height above the plane of three others [rad, for small ones]. Use
    together with `planarity_terms`, and `conicality_terms` for valence 4.

    Source: Wang, Wallner, Liu 2007; maths.md 2.9 (a).
    """
    chosen = np.zeros(mesh.n_vertices, dtype=bool)
    chosen[slice(None) if vertices is None else np.asarray(vertices, dtype=np.int64)] = True
    ids = np.flatnonzero(chosen & ~mesh.boundary_vertex & (mesh.valences >= _LEAST))
    sets, owner = [], []
    for vertex in ids.tolist():
        faces = mesh.star(vertex)[1]
        # The first normals lie as far apart as they can, so that they span a good plane.
        base = np.array([0, len(faces) // 3, 2 * len(faces) // 3])
        for last in np.setdiff1d(np.arange(len(faces)), base).tolist():
            sets.append(faces[[*base, last]])
            owner.append(vertex)
    if not sets:
        return ()
    face = np.stack(sets)
    # Smaller faces repeat their last corner: that changes no vector area.
    width = int(mesh.face_sizes[face].max())
    steps = np.minimum(np.arange(width), mesh.face_sizes[face][..., None] - 1)
    corners = mesh.corners[mesh.face_start[face][..., None] + steps]
    normals = mesh.face_normals[face]
    a, b = normals[:, 1] - normals[:, 0], normals[:, 2] - normals[:, 0]
    spread = np.linalg.norm(np.cross(a, b), axis=1)
    return (
        Cones(
            name="cones",
            index=(3 * corners[..., None] + np.arange(3)).reshape(len(face), -1),
            factor=1.0 / np.maximum(spread, _FLAT),
            weight=weight,
            hard=hard,
            of="vertex",
            elements=np.array(owner),
        ),
    )


_FLAT = 1e-4
"""Normals spread over less than this area [rad^2] count as spread over it: flat vertices."""

"""Cones at vertices of any valence: the unit normals of the faces round a vertex lie in a plane.

The normals are corners of a polygon on the unit sphere, and it is planar just when the faces touch
a cone of revolution: the residuals are those of `planarity` for this polygon.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ddgfab.arguments import checked
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.terms.base import LocalTerm
from ddgfab.optimize.terms.planarity import flatness, flatness_slope, possible_heights, vector_areas

_LEAST = 5


@dataclass(frozen=True, eq=False, kw_only=True)
class Cones(LocalTerm):
    """<A, sum_i B_i n_i> / |A| for the unit normals n_i round a vertex; make with `cone_terms`.

    Attributes
    ----------
    basis : (m, k) the rows B, for k faces; the unknowns of a row are the corners of one face after
        the other
    """

    basis: Floats

    def values(self, local: Floats) -> Floats:
        """(m,) residuals: heights of the normals across their plane [rad]."""
        return flatness(self._normals(local)[0], self.basis)

    def gradients(self, local: Floats) -> Floats:
        """(m, 3 * corners) derivatives by the corners of the faces."""
        normals, lengths, points = self._normals(local)
        slope = flatness_slope(normals, self.basis)
        slope -= np.einsum("mfx,mfx->mf", slope, normals)[..., None] * normals
        slope /= 2 * lengths[..., None]
        across = np.roll(points, -1, axis=2) - np.roll(points, 1, axis=2)
        return np.asarray(np.cross(across, slope[:, :, None]).reshape(len(local), -1))

    def _normals(self, local: Floats) -> tuple[Floats, Floats, Floats]:
        rows, faces = self.basis.shape
        points = local.reshape(rows, faces, -1, 3)
        areas = vector_areas(points.reshape(rows * faces, -1, 3)).reshape(rows, faces, 3)
        lengths = np.linalg.norm(areas, axis=2)
        return areas / lengths[..., None], lengths, points


@checked
def cone_terms(
    mesh: Mesh,
    vertices: Sequence[int] | Ints | None = None,
    *,
    weight: float = 1.0,
    hard: bool = True,
) -> tuple[Cones, ...]:
    """Faces round inner vertices of valence 5 or more touch a cone: a term for each valence.

    Residuals are heights of unit normals across the plane through them [rad]. Use together with
    `planarity_terms`, and with `conicality_terms` for valence 4.

    Source: Wang, Wallner, Liu 2007; mathematics.md 2.9 (a).
    """
    chosen = np.zeros(mesh.n_vertices, dtype=bool)
    chosen[slice(None) if vertices is None else np.asarray(vertices, dtype=np.int64)] = True
    chosen &= ~mesh.boundary_vertex & (mesh.valences >= _LEAST)
    terms = []
    for valence in np.unique(mesh.valences[chosen]).tolist():
        ids = np.flatnonzero(chosen & (mesh.valences == valence))
        faces = mesh.star_faces[mesh.star_start[ids, None] + np.arange(valence)]
        # Smaller faces repeat their last corner: that changes no vector area.
        width = int(mesh.face_sizes[faces].max())
        steps = np.minimum(np.arange(width), mesh.face_sizes[faces][..., None] - 1)
        corners = mesh.corners[mesh.face_start[faces][..., None] + steps]
        index = (3 * corners[..., None] + np.arange(3)).reshape(len(ids), -1)
        terms.append(
            Cones(
                name="cones",
                index=np.repeat(index, valence - 3, axis=0),
                weight=weight,
                hard=hard,
                of="vertex",
                elements=np.repeat(ids, valence - 3),
                basis=possible_heights(mesh.face_normals[faces]).reshape(-1, valence),
            )
        )
    return tuple(terms)

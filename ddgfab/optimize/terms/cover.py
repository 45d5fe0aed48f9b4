"""A surface near the mesh: distances the other way, so that no part of it is left bare.

`NearSurface` keeps vertices near the surface; a mesh that slides off a tip or a flank stays near
it all the same. Here points of the surface ask for the mesh: each row is the distance of such a
point from its nearest point of the mesh as it is now, along the normal of the surface.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.sparse import csr_array, diags_array

from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.surface import barycentric, beyond, fans
from ddgfab.optimize.terms.base import LinearTerm
from ddgfab.optimize.terms.closest import TriangleTree

_MOST: Final = 4
"""Points for each vertex: more cost time and say nothing new."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Covered:
    """A row for each point of a surface; make with `covered`.

    Attributes
    ----------
    mesh : the mesh that moves, for its faces
    points, normals : (n, 3) of the surface
    """

    mesh: Mesh
    points: Floats
    normals: Floats
    weight: float = 1.0
    name: str = "cover"

    def at(self, x: Floats) -> LinearTerm:
        """The term with the nearest points of the mesh of the unknowns x."""
        mesh = self.mesh
        count, size = len(self.points), mesh.n_vertices
        tree = TriangleTree(fans(mesh.with_vertices(x[: 3 * size].reshape(-1, 3))))
        foot, corner = tree.nearest(self.points)
        part, row = barycentric(foot, tree.shapes[corner]), np.arange(count)
        share = csr_array(
            (
                part[:, 1:].ravel(),
                (
                    np.repeat(row, 2),
                    mesh.corners[np.stack([corner, mesh.corner_next[corner]], axis=1)].ravel(),
                ),
            ),
            shape=(count, size),
        )
        middle = csr_array(
            (1.0 / mesh.face_sizes[mesh.corner_face], (mesh.corner_face, mesh.corners)),
            shape=(mesh.n_faces, size),
        )
        share = (share + diags_array(part[:, 0]) @ middle[mesh.corner_face[corner]]).tocoo()
        rows, columns = np.repeat(share.row, 3), 3 * share.col[:, None] + np.arange(3)
        values = share.data[:, None] * self.normals[share.row]
        return LinearTerm(
            name=self.name,
            matrix=csr_array((values.ravel(), (rows, columns.ravel())), shape=(count, len(x))),
            target=np.einsum("nx,nx->n", self.points, self.normals),
            weight=self.weight,
        )


def covered(mesh: Mesh, surface: Mesh | None = None, *, weight: float = 1.0) -> Covered:
    """The vertices of a surface, by default of the mesh as it is, near the mesh as it moves.

    However many they are, together they weigh as much as the vertices of the mesh would. Those off
    the boundary of the mesh do not ask for it: a surface may be larger.
    """
    used = np.flatnonzero(mesh.valences > 0)
    given, points = (mesh, used) if surface is None else (surface, _over(mesh, surface, len(used)))
    return Covered(
        mesh=mesh,
        points=given.vertices[points],
        normals=given.vertex_normals[points],
        weight=weight * len(used) / max(len(points), 1),
    )


def _over(mesh: Mesh, surface: Mesh, count: int) -> Ints:
    """Vertices of a surface over the mesh, at most about `_MOST` times the count."""
    there = np.flatnonzero(surface.valences > 0)
    there = there[~beyond(mesh, surface.vertices[there])]
    return np.asarray(there[:: max(1, len(there) // (_MOST * count))])

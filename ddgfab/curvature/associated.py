"""Associated families of minimal triangle meshes.

Source: Pinkall, Polthier 1993, section 4; Polthier 2002, Computational aspects of discrete minimal
surfaces; mathematics.md 8.4.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csc_array

from ddgfab.arguments import checked
from ddgfab.curvature.cotangent import area_gradient, triangles_of
from ddgfab.errors import DegenerateError, MeshError
from ddgfab.mesh import Floats, Ints, Mesh, extent
from ddgfab.symmetric import factored
from ddgfab.tolerances import NET_INPUT


@dataclass(frozen=True, eq=False)
class AssociatedFamily:
    """The associated family of a minimal triangle mesh, on the midpoints of its edges.

    points : (E, 3) midpoints of the mesh's edges; conjugate : (E, 3) those of the conjugate
        surface, the first at the origin; triangles : (F, 3) their ids, congruent for all angles
    closing : greatest gap between two triangles that share a midpoint, over the surface's size
    """

    points: Floats
    conjugate: Floats
    triangles: Ints
    closing: float

    def at(self, angle: float) -> Floats:
        """(E, 3) points cos(angle) x + sin(angle) x*; pi / 2 is the conjugate surface."""
        return np.asarray(np.cos(angle) * self.points + np.sin(angle) * self.conjugate)


@checked
def associated_family(mesh: Mesh, *, tolerance: float = NET_INPUT) -> AssociatedFamily:
    """Conjugate and associated surfaces: triangles of edge midpoints turned in their planes.

    Turned by a right angle, the triangles of midpoints fit together round every interior vertex
    exactly when the area is stationary there. The surfaces are nonconforming: triangles share
    midpoints of edges, not edges.

    Parameters
    ----------
    mesh : a disc of triangles, stationary (`minimize_area`)
    tolerance : on the gap between triangles that share a midpoint, in parts of the size; files of
        six digits need about 1e-5

    Raises
    ------
    MeshError
        A face that is not a triangle, several components, or a surface that is not simply connected
        (its conjugate has periods: cut it open).
    DegenerateError
        The mesh is not minimal, so the conjugate does not close; gives the gap.

    Source: Pinkall, Polthier 1993, section 4; Polthier 2002.
    """
    ids = triangles_of(mesh)
    if mesh.components.max() > 0:
        raise MeshError("the mesh has several components: take one at a time")
    euler = int((mesh.valences > 0).sum()) - mesh.n_edges + mesh.n_faces
    if euler != 1:
        raise MeshError(
            f"the mesh has Euler characteristic {euler}, a disc has 1: its conjugate surface has "
            "periods; cut it open"
        )
    sides = mesh.corner_edge.reshape(-1, 3)
    middles = mesh.vertices[mesh.edges].mean(axis=1)
    steps = np.roll(middles[sides], -1, axis=1) - middles[sides]
    turned = np.cross(mesh.face_normals[:, None], steps)
    conjugate = _integrate(mesh.n_edges, sides, turned)
    gap = np.roll(conjugate[sides], -1, axis=1) - conjugate[sides] - turned
    size = extent(conjugate)
    closing = float(np.linalg.norm(gap, axis=-1).max()) / size
    if not closing <= tolerance:
        inner = np.where(mesh.boundary_vertex, 0.0, np.linalg.norm(area_gradient(mesh), axis=1))
        worst = int(inner.argmax())
        raise DegenerateError(
            f"the conjugate surface does not close: gap {closing:.2g} of its size (limit "
            f"{tolerance:g}); the area is not stationary, gradient {inner[worst]:.2g} at vertex "
            f"{worst} of the {len(ids)} triangles: minimize_area first"
        )
    return AssociatedFamily(middles, conjugate, sides, closing)


def _integrate(count: int, sides: Ints, steps: Floats) -> Floats:
    """Points whose differences along the triangles' sides are nearest to the steps."""
    start, end = sides.ravel(), np.roll(sides, -1, axis=1).ravel()
    rows = np.arange(len(start))
    ones = np.ones(len(start))
    values = np.concatenate([ones, -ones])
    places = (np.concatenate([rows, rows]), np.concatenate([end, start]))
    difference = csc_array(coo_array((values, places), shape=(len(start), count)))
    rest = difference[:, 1:]  # the first point is the origin
    out = np.zeros((count, 3))
    out[1:] = factored(rest.T @ rest).solve(rest.T @ steps.reshape(-1, 3))
    return out

"""Oriented and mixed areas of the faces of parallel meshes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import MeshError
from ddgfab.mesh import Floats, Mesh


@checked
def oriented_areas(mesh: Mesh, vertices: ArrayLike | None = None) -> Floats:
    """(F,) areas A(f) = 1/2 sum <n, v_i x v_(i+1)> in the planes with the mesh's face normals.

    Negative where the face of the other vertices runs the other way round.

    Parameters
    ----------
    vertices : (V, 3) of a parallel mesh; the mesh's own by default

    Raises
    ------
    MeshError
        Vertices of the wrong shape.

    Source: mathematics.md 8.1; Bobenko, Pottmann, Wallner 2010.
    """
    other = mesh if vertices is None else mesh.with_vertices(vertices)
    return np.asarray(np.einsum("fx,fx->f", mesh.face_normals, other.vector_areas))


@checked
def mixed_areas(mesh: Mesh, first: ArrayLike, second: ArrayLike) -> Floats:
    """(F,) mixed areas A(f, g) = (A(f + g) - A(f) - A(g)) / 2 of two meshes parallel to a mesh.

    Symmetric and bilinear, with A(f, f) = A(f), so A(f + t g) = A(f) + 2 t A(f, g) + t^2 A(g)
    (Steiner). Computed as 1/4 sum <n, v_i x w_(i+1) + w_i x v_(i+1)>: the difference of areas
    above loses digits where the meshes differ in size.

    Parameters
    ----------
    first, second : (V, 3) vertices of meshes parallel to `mesh`, whose normals orient the planes

    Raises
    ------
    MeshError
        Vertices of the wrong shape.

    Source: mathematics.md 8.1.
    """
    a, b = np.asarray(first, dtype=np.float64), np.asarray(second, dtype=np.float64)
    if a.shape != b.shape or a.shape != mesh.vertices.shape:
        raise MeshError(
            f"vertices have shapes {a.shape} and {b.shape}; {mesh.vertices.shape} twice is needed"
        )
    begin = mesh.face_start[:-1]
    here, after = mesh.corners, mesh.corners[mesh.corner_next]
    root = mesh.corners[begin][mesh.corner_face]
    products = np.cross(a[here] - a[root], b[after] - b[root])
    products += np.cross(b[here] - b[root], a[after] - a[root])
    sums = np.add.reduceat(products, begin, axis=0)
    return np.asarray(0.25 * np.einsum("fx,fx->f", mesh.face_normals, sums))

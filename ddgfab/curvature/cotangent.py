"""The area of triangle meshes: its gradient, mean curvature vectors, angle defects.

grad_i A = 1/2 sum_j (cot a_ij + cot b_ij)(x_i - x_j), with the angles opposite to edge ij.
Source: Pinkall, Polthier 1993, Computing discrete minimal surfaces and their conjugates;
mathematics.md 8.4.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import coo_array, csr_array

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, MeshError
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.quads import finite
from ddgfab.tolerances import RELATIVE_DEGENERATE


def triangles_of(mesh: Mesh) -> Ints:
    """(F, 3) vertex ids of a triangle mesh.

    Raises
    ------
    MeshError
        A face with more corners; names it.
    """
    odd = np.flatnonzero(mesh.face_sizes != 3)
    if len(odd):
        raise MeshError(
            f"face {odd[0]} has {mesh.face_sizes[odd[0]]} corners: a triangle mesh is needed; cut "
            "faces by diagonals (ddgfab.curvature.triangulate)"
        )
    return mesh.corners.reshape(-1, 3)


@checked
def triangulate(mesh: Mesh, *, alternate: bool = False) -> Mesh:
    """Triangle mesh: every face cut by the diagonals from its first corner.

    Parameters
    ----------
    alternate : cut quads 0, 2, ... from their first and 1, 3, ... from their second corner
    """
    cut: list[Ints] = []
    for number, face in enumerate(mesh.faces):
        turned = np.roll(face, -1) if alternate and number % 2 else face
        cut += [turned[[0, k, k + 1]] for k in range(1, len(turned) - 1)]
    return Mesh.build(mesh.vertices, cut)


def corner_cotangents(mesh: Mesh, vertices: ArrayLike | None = None) -> Floats:
    """(F, 3) cotangents of the angles of the triangles, corner by corner.

    Parameters
    ----------
    vertices : (V, 3) instead of the mesh's own

    Raises
    ------
    InputError
        Vertices that are not finite, or beyond all measure.
    MeshError
        A face that is not a triangle, vertices of another shape.
    DegenerateError
        A triangle without area; names it.

    Source: mathematics.md 8.4.
    """
    ids = triangles_of(mesh)
    p = (mesh if vertices is None else mesh.with_vertices(vertices)).vertices[ids]
    finite(p, "triangles")
    left, right = np.roll(p, -1, axis=1) - p, np.roll(p, -2, axis=1) - p
    double = np.linalg.norm(np.cross(left, right), axis=-1)
    size = (np.einsum("fki,fki->fk", left, left)).max(axis=1)
    flat = np.flatnonzero(~(double[:, 0] > RELATIVE_DEGENERATE * size))
    if len(flat):
        a, b, c = ids[flat[0]]
        raise DegenerateError(
            f"triangle {flat[0]} ({a}, {b}, {c}) has area {0.5 * double[flat[0], 0]:.3g}: its "
            "angles have no cotangents"
        )
    return np.asarray(np.einsum("fki,fki->fk", left, right) / double)


@checked
def cotangent_laplacian(mesh: Mesh, vertices: ArrayLike | None = None) -> csr_array:
    """(V, V) symmetric matrix L with (L x)_i = 1/2 sum_j (cot a_ij + cot b_ij)(x_i - x_j).

    L applied to the vertices is the gradient of the area; positive semidefinite.

    Raises
    ------
    MeshError, DegenerateError
        As `corner_cotangents`.

    Source: mathematics.md 8.4.
    """
    ids = triangles_of(mesh)
    half = 0.5 * corner_cotangents(mesh, vertices)
    i, j = np.roll(ids, -1, axis=1), np.roll(ids, -2, axis=1)  # the side opposite to each corner
    rows = np.concatenate([i, j, i, j], axis=None)
    columns = np.concatenate([j, i, i, j], axis=None)
    values = np.concatenate([-half, -half, half, half], axis=None)
    size = (mesh.n_vertices, mesh.n_vertices)
    return csr_array(coo_array((values, (rows, columns)), shape=size))


@checked
def area_gradient(mesh: Mesh) -> Floats:
    """(V, 3) gradient of the area by the vertices; zero inside a discrete minimal surface.

    Source: mathematics.md 8.4.
    """
    return np.asarray(cotangent_laplacian(mesh) @ mesh.vertices)


@checked
def mixed_vertex_areas(mesh: Mesh) -> Floats:
    """(V,) part of the triangles' area that belongs to each vertex; 0 without triangles.

    Voronoi parts of triangles without an obtuse angle; of obtuse ones half goes to the obtuse
    corner and a quarter to the others.

    Source: Meyer, Desbrun, Schroeder, Barr 2003, 3.3.
    """
    ids = triangles_of(mesh)
    cotangent = corner_cotangents(mesh)
    p = mesh.vertices[ids]
    opposite = np.roll(p, -2, axis=1) - np.roll(p, -1, axis=1)
    square = np.einsum("fki,fki->fk", opposite, opposite) * cotangent
    # Both sides that meet at a corner give it an eighth of cot(opposite angle) |side|^2.
    part = 0.125 * (np.roll(square, -1, axis=1) + np.roll(square, -2, axis=1))
    obtuse = cotangent < 0
    share = np.where(obtuse, 0.5, 0.25) * mesh.face_areas[:, None]
    part = np.where(obtuse.any(axis=1, keepdims=True), share, part)
    area = np.zeros(mesh.n_vertices)
    np.add.at(area, ids, part)
    return area


@checked
def mean_curvature_vectors(mesh: Mesh) -> Floats:
    """(V, 3) grad_i A / A_i with `mixed_vertex_areas`: -2 H times the unit normal.

    On a sphere of radius R they point outward with length 2 / R. At boundary vertices they hold
    the boundary's pull too and are not curvature.

    Source: mathematics.md 8.4; Meyer, Desbrun, Schroeder, Barr 2003.
    """
    area = mixed_vertex_areas(mesh)
    gradient = area_gradient(mesh)
    used = area > 0
    out = np.zeros_like(gradient)
    out[used] = gradient[used] / area[used, None]
    return out


@checked
def cotangent_mean_curvature(mesh: Mesh) -> Floats:
    """(V,) mean curvature with the sign of `steiner_curvatures`; nan at the boundary.

    Source: mathematics.md 8.4.
    """
    h = -0.5 * np.einsum("vi,vi->v", mean_curvature_vectors(mesh), mesh.vertex_normals)
    return np.where(mesh.boundary_vertex, np.nan, h)


@checked
def angle_defects(mesh: Mesh) -> Floats:
    """(V,) 2 pi (pi at the boundary) less the angles of the triangles [rad]; 0 without triangles.

    Their sum is 2 pi times the Euler characteristic (Gauss and Bonnet).

    Source: Bobenko, Suris; mathematics.md 8.4.
    """
    angle = np.arctan2(1.0, corner_cotangents(mesh))
    total = np.zeros(mesh.n_vertices)
    np.add.at(total, triangles_of(mesh), angle)
    full = np.where(mesh.boundary_vertex, np.pi, 2 * np.pi)
    return np.where(mesh.valences > 0, full - total, 0.0)

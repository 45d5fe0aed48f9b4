"""Triangle meshes: every torsion-free structure is central (Prop. 5.2), a_v = v - z."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked, of_shape
from ddgfab.errors import SupportError
from ddgfab.io.pairs import paired_in_order
from ddgfab.measures import torsion
from ddgfab.mesh import Floats, Mesh
from ddgfab.support.structure import SupportStructure
from ddgfab.tolerances import LEAN_LIMIT_DEG, RELATIVE_DEGENERATE


@checked
def best_center(mesh: Mesh) -> Floats | None:
    """(3,) the point nearest to all vertex normal lines (least squares), None if at infinity.

    Solves sum (I - n n^T)(v - z) = 0; the matrix is singular when all normals are parallel.
    """
    used = mesh.valences > 0
    normals, points = mesh.vertex_normals[used], mesh.vertices[used]
    origin = points.mean(axis=0)
    across = np.eye(3) - np.einsum("vi,vj->vij", normals, normals)
    matrix = across.mean(axis=0)
    if np.linalg.eigvalsh(matrix)[0] < RELATIVE_DEGENERATE:
        return None
    right = np.einsum("vij,vj->i", across, points - origin) / len(points)
    return np.asarray(origin + np.linalg.solve(matrix, right))


@checked
def central(mesh: Mesh, center: ArrayLike | None = None) -> SupportStructure:
    """Central structure: all axes pass through one point z, on the side of the normals.

    Torsion-free on every mesh, as the plane through an edge and z holds both axes. On triangle
    meshes there are no others (Pottmann, Liu, Wallner, Bobenko, Wang 2007; Prop. 5.2,
    mathematics.md 10.5). With the best center at infinity all axes are parallel.

    Parameters
    ----------
    center : (3,); the point nearest to all vertex normals by default

    Raises
    ------
    SupportError
        The center is a vertex.
    """
    z = best_center(mesh) if center is None else of_shape(center, (3,), "center")
    used = mesh.valences > 0
    axes = (
        np.broadcast_to(mesh.vertex_normals.sum(axis=0), mesh.vertices.shape)
        if z is None
        else mesh.vertices - z
    )
    length = np.linalg.norm(axes, axis=1)
    at = np.flatnonzero(used & (length <= RELATIVE_DEGENERATE * mesh.diameter))
    if len(at):
        raise SupportError(f"vertex {at[0]} lies in the center of the structure: move the center")
    outward = np.einsum("vx,vx->", axes / np.where(used, length, 1.0)[:, None], mesh.vertex_normals)
    return SupportStructure.of(
        mesh, np.where(used[:, None], np.copysign(1.0, outward) * axes, 0.0), "central"
    )


def central_lean_deg(mesh: Mesh) -> float:
    """Greatest lean [deg] of the central structure; 180 where there is none."""
    try:
        return central(mesh).lean_deg_max
    except SupportError:
        return 180.0


def refuse_triangles(mesh: Mesh) -> SupportError:
    """The error that says Prop. 5.2, with the torsion of the vertex normals and the way out."""
    angles = np.degrees(torsion(mesh, mesh.vertex_normals))
    worst, lean = int(angles.argmax()), central_lean_deg(mesh)
    way = f'take the central structure with [support] kind = "central" (lean up to {lean:.0f} deg)'
    if lean > LEAN_LIMIT_DEG:
        way = (
            f"those lean by up to {lean:.0f} deg here (limit {LEAN_LIMIT_DEG:g}): take the vertex "
            'normals with [support] kind = "normals", whose beams twist'
        )
    quads = "use a quad mesh"
    if paired_in_order(mesh):
        quads = "take the quads that its triangles were cut from, [net] quads = true (--quads)"
    return SupportError(
        "a triangle mesh has no torsion-free node axes but those through one center (Prop. 5.2)\n"
        f"its vertex normals have torsion {angles[worst]:.2f} deg at edge {worst} "
        f"(mean {angles.mean():.2f} deg)\n"
        f"{way}, or {quads}"
    )


@checked
def incircle_axes(mesh: Mesh) -> tuple[Floats, Floats]:
    """Centers (F, 3) and unit axes (F, 3) of the incircles of a triangle mesh.

    On a CP mesh, where the incircles of neighbours touch, axes of neighbours lie in one plane:
    they are a torsion-free structure of the hexagonal dual mesh through the centers.

    Raises
    ------
    SupportError
        A face that is not a triangle, or one without area; names it.

    Source: Schiftner, Hoebinger, Wallner, Pottmann 2009; mathematics.md 10.6, 10.11.
    """
    other = np.flatnonzero(mesh.face_sizes != 3)
    if len(other):
        raise SupportError(f"face {other[0]} has {mesh.face_sizes[other[0]]} corners; 3 needed")
    flat = np.flatnonzero(mesh.face_areas <= RELATIVE_DEGENERATE * mesh.diameter**2)
    if len(flat):
        raise SupportError(f"face {flat[0]} has no area ({mesh.face_areas[flat[0]]:.1e})")
    corners = mesh.vertices[mesh.corners].reshape(-1, 3, 3)
    opposite = np.linalg.norm(np.roll(corners, -1, axis=1) - np.roll(corners, 1, axis=1), axis=2)
    centers = np.einsum("fk,fkx->fx", opposite, corners) / opposite.sum(axis=1)[:, None]
    return centers, mesh.face_normals

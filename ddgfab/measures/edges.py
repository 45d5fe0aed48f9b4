"""Measures on edges and node axes: torsion, lean, dihedral angles, equal opposite edges."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import MeshError
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.tolerances import RELATIVE_DEGENERATE


def _axes(mesh: Mesh, axes: ArrayLike) -> Floats:
    """Unit axes (V, 3); wrong shapes and coordinates that are not finite are refused."""
    given = np.asarray(axes, dtype=np.float64)
    if given.shape != mesh.vertices.shape:
        raise MeshError(f"axes have shape {given.shape}; expected {mesh.vertices.shape}")
    bad = np.flatnonzero(~np.isfinite(given).all(axis=1))
    if len(bad):
        raise MeshError(f"the axis of vertex {bad[0]} is not finite")
    return unit(given)


@checked
def torsion(mesh: Mesh, axes: ArrayLike) -> Floats:
    """Torsion of each edge: angle between the planes through the edge and its two node axes.

    Axes are lines without direction, so the angle is folded to 0..pi/2. Zero means that one plane
    holds the edge and both axes, det(e, a_i, a_j) = 0. An axis along its edge (or a zero axis)
    spans no plane with it: such an edge counts as pi/2, which no limit lets pass.

    Parameters
    ----------
    axes : (V, 3), of any length

    Returns
    -------
    (E,) [rad]

    Raises
    ------
    MeshError
        Axes of the wrong shape, or not finite.

    Source: support structures, Def. 5.1 (Pottmann, Liu, Wallner, Bobenko, Wang 2007);
    mathematics.md 10.2 `twist`. With unit e, (e x a) x (e x b) = e det(e, a, b).
    """
    lines = _axes(mesh, axes)
    along = unit(mesh.edge_vectors)
    first = np.cross(along, lines[mesh.edges[:, 0]])
    second = np.cross(along, lines[mesh.edges[:, 1]])
    sine = np.abs(np.einsum("ij,ij->i", along, np.cross(first, second)))
    angle = np.arctan2(sine, np.abs(np.einsum("ij,ij->i", first, second)))
    least = np.minimum(np.linalg.norm(first, axis=1), np.linalg.norm(second, axis=1))
    return np.where(least > RELATIVE_DEGENERATE, angle, np.pi / 2)


@checked
def lean(mesh: Mesh, axes: ArrayLike) -> Floats:
    """Angle between each node axis and the vertex normal.

    Parameters
    ----------
    axes : (V, 3), of any length, pointing outwards (an axis that points inwards leans above pi/2)

    Returns
    -------
    (V,) [rad], 0..pi; 0 at a vertex that no face uses

    Raises
    ------
    MeshError
        Axes of the wrong shape, or not finite.
    """
    lines, normals = _axes(mesh, axes), mesh.vertex_normals
    sine = np.linalg.norm(np.cross(lines, normals), axis=1)
    angle: Floats = np.arctan2(sine, np.einsum("ij,ij->i", lines, normals))
    return angle


@checked
def dihedral_angles(mesh: Mesh) -> Floats:
    """Signed angle between the normals of the two faces at each edge.

    Positive where the surface is convex seen from outside (the side normals point to), so a
    cube has pi/2 at all edges; 0 where flat, and at boundary edges.

    Returns
    -------
    (E,) [rad], -pi..pi
    """
    inner = ~mesh.boundary_edge
    left, right = mesh.face_normals[mesh.edge_faces[inner]].transpose(1, 0, 2)
    along = unit(mesh.edge_vectors[inner])
    # On a convex edge the normal turns about the edge from the left face to the right one.
    sine = np.einsum("ij,ij->i", along, np.cross(left, right))
    angle = np.zeros(mesh.n_edges)
    angle[inner] = np.arctan2(sine, np.einsum("ij,ij->i", left, right))
    return angle

"""What an optimised mesh stays near to: a smooth surface over a mesh, and its boundary curve."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.optimize.terms.closest import SegmentTree, TriangleTree

_ON: Final = 1e-6
"""Parts of a triangle, or of the mean edge, up to which a point is on a side."""
_LIFT: Final = 0.6
"""How far nearest points are lifted from the flat triangles towards the Phong surface, 0 to 1."""


def fans(mesh: Mesh) -> Floats:
    """(C, 3, 3) triangles of the faces of a mesh, fans round their centroids.

    Unlike fans round a corner they do not depend on where a face begins.
    """
    sizes = mesh.face_sizes[:, None]
    centers = np.add.reduceat(mesh.vertices[mesh.corners], mesh.face_start[:-1]) / sizes
    ends = mesh.vertices[mesh.corners], mesh.vertices[mesh.corners[mesh.corner_next]]
    return np.stack([centers[mesh.corner_face], *ends], axis=1)


def beyond(mesh: Mesh, points: Floats) -> NDArray[np.bool_]:
    """(n,) which points lie off the boundary of a mesh: those nearest to it, but not on it."""
    if not mesh.boundary_edge.any():
        return np.zeros(len(points), dtype=bool)
    tree = TriangleTree(fans(mesh))
    foot, corner = tree.nearest(points)
    part = barycentric(foot, tree.shapes[corner])
    on_edge = mesh.boundary_edge[mesh.corner_edge[corner]] & (part[:, 0] < _ON)
    ends = mesh.corners[np.stack([corner, mesh.corner_next[corner]], axis=1)]
    at_end = (mesh.boundary_vertex[ends] & (part[:, 1:] > 1 - _ON)).any(axis=1)
    away = np.linalg.norm(points - foot, axis=1) > _ON * mesh.edge_lengths.mean()
    return np.asarray((on_edge | at_end) & away)


class SmoothSurface:
    """The smooth surface that a mesh stands for: Phong tessellation of its fans.

    Nearest points are found on the triangles and lifted towards the surface that the vertex
    normals describe; normals are interpolated. Flat triangles with their jumping normals would
    make every step rattle.

    Source: Boubekeur, Alexa, Phong Tessellation, 2008.
    """

    def __init__(self, mesh: Mesh) -> None:
        corners = mesh.vertex_normals[mesh.corners]
        centers = unit(np.add.reduceat(corners, mesh.face_start[:-1]))
        self._tree = TriangleTree(fans(mesh))
        self._normals = np.stack(
            [centers[mesh.corner_face], corners, corners[mesh.corner_next]], axis=1
        )

    def closest(self, points: Floats) -> tuple[Floats, Floats]:
        """(n, 3) nearest points, lifted, and (n, 3) unit normals there."""
        foot, triangle = self._tree.nearest(points)
        corners, normals = self._tree.shapes[triangle], self._normals[triangle]
        part = barycentric(foot, corners)
        normal = unit(np.einsum("nk,nkx->nx", part, normals))
        height = np.einsum("nkx,nkx->nk", corners - foot[:, None], normals)
        lifted = foot + _LIFT * np.einsum("nk,nk,nkx->nx", part, height, normals)
        return lifted, normal

    def distance(self, points: Floats) -> Floats:
        """(n,) distances from the triangles themselves."""
        far: Floats = np.linalg.norm(points - self._tree.nearest(points)[0], axis=1)
        return far


def barycentric(points: Floats, triangles: Floats) -> Floats:
    """(n, 3) barycentric coordinates of points in triangles (n, 3, 3); areas may vanish."""
    a, b, c = triangles.transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    square = np.maximum(np.einsum("nx,nx->n", normal, normal), np.finfo(float).tiny)
    second = np.einsum("nx,nx->n", np.cross(points - a, c - a), normal) / square
    third = np.einsum("nx,nx->n", np.cross(b - a, points - a), normal) / square
    return np.stack([1 - second - third, second, third], axis=1)


class RimCurve:
    """The boundary of a mesh as a curve with tangents that turn steadily along its segments."""

    def __init__(self, mesh: Mesh) -> None:
        ends = mesh.edges[mesh.boundary_edge]
        along = unit(mesh.vertices[ends[:, 1]] - mesh.vertices[ends[:, 0]])
        total = np.zeros_like(mesh.vertices)
        np.add.at(total, ends.ravel(), np.repeat(along, 2, axis=0))
        self._tree = SegmentTree(mesh.vertices[ends])
        self._tangents = unit(total)[ends]

    def closest(self, points: Floats) -> tuple[Floats, Floats]:
        """(n, 3) nearest points of the curve, (n, 3) unit tangents there."""
        foot, segment = self._tree.nearest(points)
        start, end = self._tree.shapes[segment].transpose(1, 0, 2)
        square = np.maximum(np.einsum("nx,nx->n", end - start, end - start), np.finfo(float).tiny)
        part = (np.einsum("nx,nx->n", foot - start, end - start) / square)[:, None]
        first, last = self._tangents[segment].transpose(1, 0, 2)
        return foot, unit((1 - part) * first + part * last)

"""Nearest points of many segments or triangles: trees of their centres, exact whatever their sizes.

A candidate can only be nearer than the best one known if its centre is nearer than that distance
plus the largest radius; candidates are asked for until none of the rest can be.
"""

from __future__ import annotations

import numpy as np

from ddgfab.errors import InputError
from ddgfab.mesh import Floats, Ints, Mesh, unit

_CANDIDATES = 8
"""Candidates asked for at first; twice as many where they do not settle it."""


class _Tree:
    """What segments and triangles share."""

    def __init__(self, shapes: Floats) -> None:
        if not len(shapes):
            raise InputError("no segments or triangles to be near to")
        self.shapes = shapes
        centres = shapes.mean(axis=1)
        self._radius = float(np.linalg.norm(shapes - centres[:, None], axis=2).max())
        from scipy.spatial import cKDTree  # heavy: only where it is needed

        self._tree = cKDTree(centres)

    def feet(self, points: Floats, which: Ints) -> Floats:
        """(n, k, 3) nearest points of shapes (n, k) to points (n, 3)."""
        raise NotImplementedError

    def nearest(self, points: Floats) -> tuple[Floats, Ints]:
        """(n, 3) nearest points, (n,) the shapes they lie on."""
        foot, shape = np.empty_like(points), np.zeros(len(points), dtype=np.int64)
        open_, count = np.arange(len(points)), _CANDIDATES
        while len(open_):
            count = min(count, len(self.shapes))
            far, which = self._tree.query(points[open_], k=count)
            far, which = far.reshape(-1, count), which.reshape(-1, count)
            feet = self.feet(points[open_], which)
            distance = np.linalg.norm(feet - points[open_, None], axis=2)
            best = distance.argmin(axis=1)
            rows = np.arange(len(open_))
            foot[open_], shape[open_] = feet[rows, best], which[rows, best]
            settled = (far[:, -1] >= distance[rows, best] + self._radius) | (
                count == len(self.shapes)
            )
            open_, count = open_[~settled], 2 * count
        return foot, shape


class SegmentTree(_Tree):
    """(s, 2, 3) segments."""

    def feet(self, points: Floats, which: Ints) -> Floats:
        """(n, k, 3) nearest points of segments (n, k)."""
        start, way = self.shapes[which, 0], self.shapes[which, 1] - self.shapes[which, 0]
        square = np.maximum(np.einsum("nkx,nkx->nk", way, way), np.finfo(float).tiny)
        part = np.einsum("nkx,nkx->nk", points[:, None] - start, way) / square
        return np.asarray(start + np.clip(part, 0.0, 1.0)[..., None] * way)

    def closest(self, points: Floats) -> tuple[Floats, Floats]:
        """(n, 3) nearest points on the lines of the nearest segments, (n, 3) unit directions."""
        shape = self.nearest(points)[1]
        start = self.shapes[shape, 0]
        ways = unit(self.shapes[shape, 1] - start)
        part = np.einsum("nx,nx->n", points - start, ways)
        return start + part[:, None] * ways, ways


class TriangleTree(_Tree):
    """(t, 3, 3) triangles."""

    def feet(self, points: Floats, which: Ints) -> Floats:
        """(n, k, 3) nearest points of triangles (n, k): inside, or on one of the sides."""
        corners = self.shapes[which]
        a, b, c = corners[..., 0, :], corners[..., 1, :], corners[..., 2, :]
        p = np.broadcast_to(points[:, None], a.shape)
        normal = np.cross(b - a, c - a)
        square = np.maximum(np.einsum("nkx,nkx->nk", normal, normal), np.finfo(float).tiny)
        inside = np.ones(square.shape, dtype=bool)
        best, least = a, np.full(square.shape, np.inf)
        for start, end in ((a, b), (b, c), (c, a)):
            way = end - start
            turn = np.einsum("nkx,nkx->nk", np.cross(way, p - start), normal)
            inside &= turn >= 0
            length = np.maximum(np.einsum("nkx,nkx->nk", way, way), np.finfo(float).tiny)
            part = np.clip(np.einsum("nkx,nkx->nk", p - start, way) / length, 0.0, 1.0)
            foot = start + part[..., None] * way
            far = np.linalg.norm(p - foot, axis=-1)
            best = np.where((far < least)[..., None], foot, best)
            least = np.minimum(far, least)
        height = np.einsum("nkx,nkx->nk", p - a, normal) / square
        return np.where(inside[..., None], p - height[..., None] * normal, best)

    def closest(self, points: Floats) -> tuple[Floats, Floats]:
        """(n, 3) nearest points, (n, 3) unit normals of their triangles."""
        foot, shape = self.nearest(points)
        a, b, c = self.shapes[shape].transpose(1, 0, 2)
        return foot, unit(np.cross(b - a, c - a))


def triangulated(mesh: Mesh) -> Floats:
    """(t, 3, 3) triangles of the faces of a mesh, fans round their first corners."""
    first = mesh.corners[mesh.face_start[:-1]][mesh.corner_face]
    second, third = mesh.corners, mesh.corners[mesh.corner_next]
    keep = (second != first) & (third != first)
    return np.asarray(mesh.vertices[np.stack([first, second, third], axis=1)[keep]])

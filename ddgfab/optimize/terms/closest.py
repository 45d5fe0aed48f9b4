"""Nearest points of many segments or triangles: trees of their centers, exact whatever their sizes.

A shape can only be nearer than the best one known if its center is nearer than that distance plus
its radius. Shapes of about the same radius have a tree of their own, so that few large ones among
many small ones cost nothing, and only candidates that can still be nearer are computed.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ddgfab.errors import InputError
from ddgfab.mesh import Floats, Ints, Mesh, unit

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

_CANDIDATES = 8
"""Candidates asked for at first; twice as many where they do not settle it."""
_FIRST = 2
"""Candidates computed before the others are compared with them."""
_CLASSES = 12
"""Classes of radii, each up to twice the one before; smaller shapes all belong to the first."""
_THIN = 1e-12
"""Triangles whose squared sine at the first corner is below this are their sides."""


@dataclass(frozen=True, eq=False)
class _Class:
    """Shapes of about the same radius: ids, the tree of their centers, their greatest radius."""

    ids: Ints
    tree: cKDTree
    radius: float


class _Tree(ABC):
    """What segments and triangles share."""

    def __init__(self, shapes: Floats) -> None:
        if not len(shapes):
            raise InputError("no segments or triangles to be near to")
        from scipy.spatial import cKDTree  # heavy: only where it is needed

        self.shapes = shapes
        centers = shapes.mean(axis=1)
        self._radii: Floats = np.linalg.norm(shapes - centers[:, None], axis=2).max(axis=1)
        largest = max(float(self._radii.max()), np.finfo(float).tiny)
        kind = np.floor(np.log2(np.maximum(self._radii / largest, 0.5 ** (_CLASSES + 1))))
        kind = np.maximum(kind, 1 - _CLASSES)
        self._classes = []
        for one in np.unique(kind).tolist():
            ids = np.flatnonzero(kind == one)
            self._classes.append(_Class(ids, cKDTree(centers[ids]), float(self._radii[ids].max())))
        self._classes.sort(key=lambda c: -len(c.ids))

    @abstractmethod
    def feet(self, points: Floats, which: Ints) -> Floats:
        """(n, 3) nearest points of shapes (n,) to points (n, 3)."""

    def nearest(self, points: Floats) -> tuple[Floats, Ints]:
        """(n, 3) nearest points, (n,) the shapes they lie on."""
        foot, shape = np.empty_like(points), np.zeros(len(points), dtype=np.int64)
        least = np.full(len(points), np.inf)
        for one in self._classes:
            self._search(one, points, foot, shape, least)
        return foot, shape

    def _search(
        self, one: _Class, points: Floats, foot: Floats, shape: Ints, least: Floats
    ) -> None:
        """Improve the nearest points known by those of a class, in place."""
        rest, done, count = np.arange(len(points)), 0, _CANDIDATES
        while len(rest):
            count = min(count, len(one.ids))
            far, found = one.tree.query(points[rest], k=count)
            far, which = far.reshape(-1, count), one.ids[found.reshape(-1, count)]
            for first, last in ((done, done + _FIRST), (done + _FIRST, count)):
                low = far[:, first:last] - self._radii[which[:, first:last]]
                row, column = np.nonzero(low < least[rest, None])
                at = rest[row]
                candidate = which[row, first + column]
                feet = self.feet(points[at], candidate)
                away = np.linalg.norm(feet - points[at], axis=1)
                head = _first_least(at, away)  # the nearest of each point
                head = head[away[head] < least[at[head]]]
                foot[at[head]], shape[at[head]] = feet[head], candidate[head]
                least[at[head]] = away[head]
            open_ = far[:, -1] < least[rest] + one.radius
            if count == len(one.ids):
                break
            rest, done, count = rest[open_], count, 2 * count


def _first_least(group: Ints, values: Floats) -> Ints:
    """For each group, equal numbers in a row, where its least value is; the first of equals."""
    start = np.flatnonzero(np.diff(group, prepend=-1) > 0)
    if not len(start):
        return start
    least = np.minimum.reduceat(values, start)
    sizes = np.diff(start, append=len(group))
    hits = np.flatnonzero(values == np.repeat(least, sizes))
    return hits[np.diff(group[hits], prepend=-1) > 0]


class SegmentTree(_Tree):
    """(s, 2, 3) segments."""

    def feet(self, points: Floats, which: Ints) -> Floats:
        """(n, 3) nearest points of segments (n,)."""
        start, way = self.shapes[which, 0], self.shapes[which, 1] - self.shapes[which, 0]
        square = np.maximum(np.einsum("nx,nx->n", way, way), np.finfo(float).tiny)
        part = np.einsum("nx,nx->n", points - start, way) / square
        return np.asarray(start + np.clip(part, 0.0, 1.0)[:, None] * way)

    def closest(self, points: Floats) -> tuple[Floats, Floats]:
        """(n, 3) nearest points on the lines of the nearest segments, (n, 3) unit directions."""
        shape = self.nearest(points)[1]
        start = self.shapes[shape, 0]
        ways = unit(self.shapes[shape, 1] - start)
        part = np.einsum("nx,nx->n", points - start, ways)
        return start + part[:, None] * ways, ways


class TriangleTree(_Tree):
    """(t, 3, 3) triangles."""

    def __init__(self, shapes: Floats) -> None:
        super().__init__(shapes)
        first, second = shapes[:, 1] - shapes[:, 0], shapes[:, 2] - shapes[:, 0]
        self._sides = np.stack([first, second], axis=1)
        self._products = np.stack(
            [np.einsum("tx,tx->t", p, q) for p, q in ((first,) * 2, (first, second), (second,) * 2)]
        )

    def feet(self, points: Floats, which: Ints) -> Floats:
        """(n, 3) nearest points of triangles (n,): inside, or on one of the sides.

        In coordinates (v, w) along two sides: the foot of the perpendicular where it lies inside,
        otherwise the least of the feet on the three sides.
        """
        start, sides = self.shapes[which, 0], self._sides[which]
        aa, ab, bb = self._products[:, which]
        a, b = np.einsum("nkx,nx->kn", sides, points - start)
        tiny = np.finfo(float).tiny
        square = aa * bb - ab * ab
        flat = square > _THIN * aa * bb
        square = np.where(flat, square, 1.0)
        v, w = (bb * a - ab * b) / square, (aa * b - ab * a) / square
        inside = flat & (v >= 0) & (w >= 0) & (v + w <= 1)
        one = np.clip(a / np.maximum(aa, tiny), 0.0, 1.0)
        two = np.clip(b / np.maximum(bb, tiny), 0.0, 1.0)
        third = np.clip((b - a + aa - ab) / np.maximum(aa - 2 * ab + bb, tiny), 0.0, 1.0)
        on_sides = np.stack(
            [
                one * (one * aa - 2 * a),
                two * (two * bb - 2 * b),
                (1 - third) * ((1 - third) * aa + 2 * third * ab - 2 * a)
                + third * (third * bb - 2 * b),
            ]
        )
        side = on_sides.argmin(axis=0)
        v = np.where(inside, v, np.choose(side, [one, 0.0, 1 - third]))
        w = np.where(inside, w, np.choose(side, [0.0, two, third]))
        return np.asarray(start + v[:, None] * sides[:, 0] + w[:, None] * sides[:, 1])

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

"""Boundary -> watertight triangle mesh, within a chord tolerance.

Every arc belongs to one cylinder face, which decides where it is sampled: at a grid of angles that
holds the angles of all the face's vertices. Between neighbouring angles the face is then a stack of
plane trapezoids. Plane faces are triangulated polygons with holes over the same points. A curve
where two cylinders cross belongs to both: the grids of the two have each other's angles on it.

Most cylinder faces have four sides, two arcs between two lines: these are sampled and cut into
triangles all at once. The others, where arcs meet or lie side by side, are done one by one.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from itertools import pairwise
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ddgfab.mesh import Floats, Ints
from fabrication.boundary import Boundary, cross_rows
from fabrication.solids.crossings import SAME_ANGLE, rise, share_angles
from fabrication.solids.flat_faces import flat_triangles
from fabrication.specs import TriangleMesh

CHORD = 0.05
"""Default greatest distance [mm] of the mesh from the exact surface."""

MAX_STEP = math.pi / 4.0
"""Greatest angle [rad] between neighbouring generator lines, however small the cylinder."""

SIDES: Final = 4
"""Of the faces between two arcs and two lines."""

Bools: TypeAlias = NDArray[np.bool_]

Crossing: TypeAlias = tuple[float, int]
"""Where something crosses a generator line: height [mm] along the axis, and the point's id."""


def tessellate(boundary: Boundary, chord: float = CHORD) -> TriangleMesh:
    """Watertight, outward triangles between shared vertices on the boundary.

    Parameters
    ----------
    boundary : a closed boundary whose arcs each belong to one plane and one cylinder face, or to
        two cylinder faces that cross there
    chord : greatest distance [mm] of the mesh from the exact surface
    """
    chains = _Chains(boundary)
    points: Floats = boundary.points
    found: list[Ints] = []
    if boundary.face_cylinder.any():
        arcs = _Arcs(boundary, chord)
        points, found = arcs.sampled(chains)
    found.append(flat_triangles(boundary, points, chains.ring))
    return TriangleMesh(points, np.concatenate(found))


class _Chains:
    """The ids of the points along every edge: its ends, and in between numbers in a row."""

    def __init__(self, boundary: Boundary) -> None:
        self.ends = boundary.edges
        self.inner = np.zeros(len(boundary.edges), dtype=np.int64)
        self.first = np.zeros(len(boundary.edges), dtype=np.int64)

    def at(self, edge: Ints, along: Ints) -> Ints:
        """Ids of the points number `along` of edges: 0 for the start, inner + 1 for the end."""
        found = self.first[edge] + along - 1
        ends = self.ends[edge]
        found = np.where(along == 0, ends[:, 0], found)
        return np.where(along == self.inner[edge] + 1, ends[:, 1], found)

    def ring(self, coedges: Ints) -> tuple[Ints, Ints]:
        """Ids along coedges without the last point of each, and how many each has."""
        back = coedges < 0
        edge = np.where(back, ~coedges, coedges)
        count = self.inner[edge] + 1
        along, which = _counted(count)
        along = np.where(back[which], count[which] - along, along)
        return self.at(edge[which], along), count

    def whole(self, edge: int, forward: bool) -> list[int]:
        """All ids of one edge."""
        start, end = self.ends[edge].tolist()
        first = int(self.first[edge])
        ids = [start, *range(first, first + int(self.inner[edge])), end]
        return ids if forward else ids[::-1]


class _Arcs:
    """The arcs of all cylinder faces, face after face, seen from the axes of their faces.

    edge, row, face : of each arc (n,)
    angles : (n, 2) of its ends about the axis [rad]
    step : (n,) greatest angle between generator lines of its face
    second : (n,) whether it is a curve where cylinders cross, and the face is on the other one
    pair : (m, 2) arcs of the faces of four sides
    single : arcs that are in no such face
    """

    def __init__(self, boundary: Boundary, chord: float) -> None:
        b = self.boundary = boundary
        on = np.flatnonzero(b.face_cylinder[b.coedge_face] & (b.edge_arc[b.coedge_edge] >= 0))
        self.edge, self.face = b.coedge_edge[on], b.coedge_face[on]
        self.row = b.edge_arc[self.edge]
        axis, xdir = b.face_axis[self.face], b.face_xdir[self.face]
        ydir = cross_rows(axis, xdir)
        ends = b.points[b.edges[self.edge]] - b.face_origin[self.face][:, None]
        x = np.einsum("nki,ni->nk", ends, xdir)
        y = np.einsum("nki,ni->nk", ends, ydir)
        self.angles = np.arctan2(y, x) % (2.0 * math.pi)
        self.heights = np.einsum("nki,ni->nk", ends, axis)
        self.second = np.zeros(len(on), dtype=np.bool_)
        crossing = np.flatnonzero(b.arc_crosses[self.row])
        own = cross_rows(b.arc_a[self.row[crossing]], b.arc_b[self.row[crossing]])
        tilt = np.abs(np.einsum("ni,ni->n", own, axis[crossing]))
        self.second[crossing] = tilt < (1.0 - SAME_ANGLE) * np.linalg.norm(own, axis=1)
        first = ~self.second
        size = np.zeros(b.n_faces)
        np.maximum.at(size, self.face[first], _curvature(b, self.row[first]))
        turn = 1.0 - chord / size[self.face]
        self.step = np.minimum(MAX_STEP, 2.0 * np.arccos(np.maximum(0.0, turn)))
        four = self._four_sided()
        self.pair = np.flatnonzero(four).reshape(-1, 2)
        self.single = np.flatnonzero(~four)

    def _four_sided(self) -> Bools:
        """Whether each arc is one of two between the same two generator lines, alone there."""
        b = self.boundary
        arcs = np.bincount(self.face, minlength=b.n_faces)
        sides = np.bincount(b.coedge_face, minlength=b.n_faces)
        loops = np.bincount(b.loop_face, minlength=b.n_faces)
        four = ((2 * arcs == SIDES) & (sides == SIDES) & (loops == 1))[self.face]
        first = np.flatnonzero(four)[::2]
        spans = np.sort(self.angles, axis=1)
        apart = np.abs(spans[first] - spans[first + 1]).max(axis=1, initial=0.0)
        shared = b.edges[self.edge[first]][:, :, None] == b.edges[self.edge[first + 1]][:, None]
        bad = first[(apart > SAME_ANGLE) | shared.any(axis=(1, 2))]
        four[bad] = four[bad + 1] = False
        four &= ~np.isin(self.face, self.face[b.arc_crosses[self.row]])
        return np.asarray(four)

    def sampled(self, chains: _Chains) -> tuple[Floats, list[Ints]]:
        """The points of the mesh, and the triangles of the cylinder faces."""
        b, (one, two) = self.boundary, self.pair.T
        span = np.abs(self.angles[one, 1] - self.angles[one, 0])
        parts = np.ceil(span / self.step[one]).astype(np.int64)
        counts = np.zeros(len(self.edge), dtype=np.int64)
        counts[one] = counts[two] = parts - 1
        grids = self._grids()
        for single, grid in grids.items():
            counts[single] = len(grid)
        kept = ~self.second
        chains.inner[self.edge[kept]] = counts[kept]
        chains.first[self.edge[kept]] = (len(b.points) + np.cumsum(counts) - counts)[kept]
        k, arc = _counted(counts)
        start, end = b.arc_range[self.row].T
        t = start[arc] + (end - start)[arc] * (k + 1) / (counts[arc] + 1)
        at = np.cumsum(counts) - counts
        for single, grid in grids.items():
            t[at[single] : at[single] + len(grid)] = start[single] + np.array(grid)
        inner = b.arc_points(self.row[arc], t[:, None])[:, 0]
        points = np.concatenate([b.points, inner])
        return points, [self._strips(chains, parts), *self._stacks(chains, points)]

    def _grids(self) -> dict[int, list[float]]:
        """Angles [rad] from the start of each single arc to where it is sampled in between."""
        found: dict[int, list[float]] = {}
        self._lines: dict[int, list[float]] = {}
        for face, arcs in self._single_faces():
            angles = self.angles[arcs].ravel().tolist()
            self._lines[face] = _grid(sorted(angles), float(self.step[arcs[0]]))
        if self.second.any():
            share_angles(self.boundary, self, self._lines)
        for face, arcs in self._single_faces():
            grid = self._lines[face]
            for arc, (a0, a1) in zip(arcs, self.angles[arcs].tolist(), strict=True):
                if self.second[arc]:
                    continue
                i, j = _place(grid, a0), _place(grid, a1)
                inner = grid[i + 1 : j] if i < j else grid[j + 1 : i][::-1]
                found[arc] = [abs(angle - a0) for angle in inner]
        return found

    def _single_faces(self) -> list[tuple[int, list[int]]]:
        """The faces that are done one by one, and their arcs."""
        found: dict[int, list[int]] = {}
        for face, arc in zip(self.face[self.single].tolist(), self.single.tolist(), strict=True):
            found.setdefault(face, []).append(arc)
        return list(found.items())

    def _strips(self, chains: _Chains, parts: Ints) -> Ints:
        """Triangles of the faces of four sides: two between neighbouring generator lines."""
        one, two = self.pair.T
        # Arcs between the same generator lines do not cross: their means tell which is lower.
        upper = self.heights[one].sum(axis=1) > self.heights[two].sum(axis=1)
        k, face = _counted(parts)

        def ids(arcs: Ints) -> tuple[Ints, Ints]:
            rising = self.angles[arcs, 0] < self.angles[arcs, 1]
            edge, up = self.edge[arcs][face], rising[face]
            return (
                chains.at(edge, np.where(up, k, parts[face] - k)),
                chains.at(edge, np.where(up, k + 1, parts[face] - k - 1)),
            )

        low0, low1 = ids(np.where(upper, two, one))
        high0, high1 = ids(np.where(upper, one, two))
        outward = (self.boundary.face_sign[self.face[one]] > 0.0)[face][:, None]
        lower = np.where(
            outward, np.stack([low0, low1, high0], 1), np.stack([low0, high0, low1], 1)
        )
        higher = np.where(
            outward, np.stack([high0, low1, high1], 1), np.stack([high0, high1, low1], 1)
        )
        return np.concatenate([lower, higher])

    def _stacks(self, chains: _Chains, points: Floats) -> list[Ints]:
        """Triangles of the other faces, slab by slab between generator lines."""
        b = self.boundary
        triangles: list[tuple[int, int, int]] = []
        for face, arcs in self._single_faces():
            grid = self._lines[face]
            columns: list[list[Crossing]] = [[] for _ in grid]
            slabs: list[list[tuple[Crossing, Crossing]]] = [[] for _ in grid]
            for arc, (a0, a1) in zip(arcs, self.angles[arcs].tolist(), strict=True):
                i, j = _place(grid, a0), _place(grid, a1)
                first = min(i, j)
                chain = chains.whole(int(self.edge[arc]), i < j)
                heights = (points[chain] @ b.face_axis[face]).tolist()
                marks = list(zip(heights, chain, strict=True))
                for k, mark in enumerate(marks):
                    columns[first + k].append(mark)
                for k, pair in enumerate(pairwise(marks)):
                    slabs[first + k].append(pair)
            # A point that two arcs share counts once, though rounding may give it two heights.
            ordered = [list(dict.fromkeys(point for _, point in sorted(c))) for c in columns]
            outward = bool(b.face_sign[face] > 0.0)
            for k, slab in enumerate(slabs):
                slab.sort(key=lambda pair: pair[0][0] + pair[1][0])
                for low, high in zip(slab[::2], slab[1::2], strict=True):
                    left = _between(ordered[k], low[0][1], high[0][1])
                    right = _between(ordered[k + 1], low[1][1], high[1][1])
                    triangles += _strip(left, right, outward)
        return [np.array(triangles, dtype=np.int64)] if triangles else []


def _counted(counts: Ints) -> tuple[Ints, Ints]:
    """0, 1, ... up to each count, one after the other, and which count each belongs to.

    >>> [found.tolist() for found in _counted(np.array([2, 0, 3]))]
    [[0, 1, 0, 1, 2], [0, 0, 2, 2, 2]]
    """
    which = np.repeat(np.arange(len(counts)), counts)
    return np.arange(len(which)) - (np.cumsum(counts) - counts)[which], which


def _curvature(boundary: Boundary, rows: Ints) -> Floats:
    """(n,) greatest second derivative [mm/rad2] along some arcs.

    For circles it is the radius, for ellipses half the length only where they turn.
    """
    first, last = boundary.arc_range[rows].T
    quarter = 0.5 * math.pi
    inner = (np.ceil(first / quarter)[:, None] + np.arange(3)) * quarter
    t = np.column_stack([first, last, np.minimum(inner, last[:, None])])
    a, b = boundary.arc_a[rows], boundary.arc_b[rows]
    aa, bb = np.einsum("ni,ni->n", a, a)[:, None], np.einsum("ni,ni->n", b, b)[:, None]
    squares = np.cos(t) ** 2 * aa + np.sin(t) ** 2 * bb  # a and b are perpendicular
    crossing = np.flatnonzero(boundary.arc_crosses[rows])
    if len(crossing):
        squares[crossing] += rise(boundary, rows[crossing])[:, None] ** 2
    return np.asarray(np.sqrt(squares.max(axis=1)))


def _grid(angles: list[float], step: float) -> list[float]:
    """Sorted angles without repeats, and between them as many more as keep to the step."""
    grid: list[float] = []
    for angle in angles:
        if grid and angle - grid[-1] <= SAME_ANGLE:
            continue
        if grid:
            last, parts = grid[-1], math.ceil((angle - grid[-1]) / step)
            grid += [last + (angle - last) * part / parts for part in range(1, parts)]
        grid.append(angle)
    return grid


def _place(grid: list[float], angle: float) -> int:
    """Where an angle is in its grid."""
    return bisect_left(grid, angle - SAME_ANGLE)


def _between(column: list[int], low: int, high: int) -> list[int]:
    """The points of a generator line from one to another, upwards."""
    return column[column.index(low) : column.index(high) + 1]


def _strip(left: list[int], right: list[int], outward: bool) -> list[tuple[int, int, int]]:
    """Triangles between points of two neighbouring generator lines, both upwards."""
    out = []
    i = j = 0
    while i + 1 < len(left) or j + 1 < len(right):
        # Any order is valid between parallel lines; even steps keep the triangles fat.
        go_left = j + 1 == len(right) or (
            i + 1 < len(left) and (i + 1) * len(right) <= (j + 1) * len(left)
        )
        if go_left:
            out.append((left[i], right[j], left[i + 1]))
            i += 1
        else:
            out.append((left[i], right[j], right[j + 1]))
            j += 1
    return out if outward else [(a, c, b) for a, b, c in out]

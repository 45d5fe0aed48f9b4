"""Boundary -> watertight triangle mesh, within a chord tolerance.

Every arc belongs to one cylinder face, which decides where it is sampled: at a grid of angles that
holds the angles of all the face's vertices. Between neighbouring angles the face is then a stack of
plane trapezoids. Plane faces are triangulated polygons with holes over the same points.
"""

from __future__ import annotations

import math
from typing import Final, TypeAlias

import numpy as np

from ddgfab.mesh import Floats, Ints
from fabrication.boundary import Boundary, cross_rows
from fabrication.specs import TriangleMesh

CHORD = 0.05
"""Default greatest distance [mm] of the mesh from the exact surface."""

SAME_ANGLE = 1e-9
"""Angles [rad] on a cylinder face nearer than this are one generator line."""

MAX_STEP = math.pi / 4.0
"""Greatest angle [rad] between neighbouring generator lines, however small the cylinder."""

QUAD = 4
"""Polygons of so few corners are fanned out when they are convex."""

SLIVER: Final = 1e-6
"""A triangle lower than this part of its longest side has its three corners in line."""

Crossing: TypeAlias = tuple[float, int]
"""Where something crosses a generator line: height [mm] along the axis, and the point's id."""


def tessellate(boundary: Boundary, chord: float = CHORD) -> TriangleMesh:
    """Watertight, outward triangles between shared vertices on the boundary.

    Parameters
    ----------
    boundary : a closed boundary whose arcs each belong to one plane and one cylinder face
    chord : greatest distance [mm] of the mesh from the exact surface
    """
    sampler = _Sampler(boundary, chord)
    faces = list(
        enumerate(zip(boundary.face_cylinder.tolist(), boundary.face_loops(), strict=True))
    )
    for face, (curved, loops) in faces:
        if curved:
            sampler.cylinder(face, loops)
    points = np.concatenate(sampler.points)
    for face, (curved, loops) in faces:
        if not curved:
            sampler.plane(face, loops, points)
    return TriangleMesh(points, np.array(sampler.triangles, dtype=np.int64))


class _Sampler:
    """Points of the mesh, the ids of the points along every edge, and the triangles so far."""

    def __init__(self, boundary: Boundary, chord: float) -> None:
        self.boundary = boundary
        self.chord = chord
        self.ydir = cross_rows(boundary.face_axis, boundary.face_xdir)
        self.points: list[Floats] = [boundary.points]
        self.count = len(boundary.points)
        self.chains: list[list[int]] = boundary.edges.tolist()
        self.triangles: list[tuple[int, int, int]] = []

    def cylinder(self, face: int, loops: list[list[int]]) -> None:
        """Sample the arcs of a cylinder face and triangulate it, slab by slab."""
        b = self.boundary
        origin, axis, xdir = b.face_origin[face], b.face_axis[face], b.face_xdir[face]
        ydir = self.ydir[face]
        edges = np.array([e if e >= 0 else ~e for loop in loops for e in loop])
        arcs = edges[b.edge_arc[edges] >= 0]
        rows = b.edge_arc[arcs]
        ends = b.points[b.edges[arcs]] - origin
        angles = np.arctan2(ends @ ydir, ends @ xdir) % (2.0 * math.pi)
        size = _curvature(b, rows)
        grid = _grid(angles, min(MAX_STEP, 2.0 * math.acos(max(0.0, 1.0 - self.chord / size))))
        columns: list[list[Crossing]] = [[] for _ in grid]
        slabs: list[list[tuple[Crossing, Crossing]]] = [[] for _ in grid]
        places = np.searchsorted(grid, angles - SAME_ANGLE).tolist()
        for edge, row, angle, (i, j) in zip(
            arcs.tolist(), rows.tolist(), angles, places, strict=True
        ):
            first, last = min(i, j), max(i, j)
            inner = grid[first + 1 : last] if i < j else grid[first + 1 : last][::-1]
            t = b.arc_range[row, 0] + np.abs(inner - angle[0])
            self._sample(edge, b.arc_points(np.array([row]), t[None])[0])
            chain = self.chains[edge] if i < j else self.chains[edge][::-1]
            heights = self._positions(edge, i < j) @ axis
            marks = list(zip(heights.tolist(), chain, strict=True))
            for k, mark in enumerate(marks):
                columns[first + k].append(mark)
            for k in range(last - first):
                slabs[first + k].append((marks[k], marks[k + 1]))
        # A point that two arcs share counts once, though rounding may give it two heights.
        ordered = [list(dict.fromkeys(point for _, point in sorted(c))) for c in columns]
        outward = bool(b.face_sign[face] > 0.0)
        for k, slab in enumerate(slabs):
            slab.sort(key=lambda pair: pair[0][0] + pair[1][0])
            for low, high in zip(slab[::2], slab[1::2], strict=True):
                left = _between(ordered[k], low[0][1], high[0][1])
                right = _between(ordered[k + 1], low[1][1], high[1][1])
                self.triangles += _strip(left, right, outward)

    def _sample(self, edge: int, points: Floats) -> None:
        """Put points between the ends of an edge."""
        start, end = self.chains[edge]
        self.chains[edge] = [start, *range(self.count, self.count + len(points)), end]
        self.points.append(points)
        self.count += len(points)

    def _positions(self, edge: int, forward: bool) -> Floats:
        """The points along the edge that was sampled last."""
        first, last = self.boundary.points[self.boundary.edges[edge]]
        points = np.vstack([first, self.points[-1], last])
        return points if forward else points[::-1]

    def plane(self, face: int, loops: list[list[int]], points: Floats) -> None:
        """Triangulate a plane face over the points along its edges."""
        rings = []
        for loop in loops:
            ring: list[int] = []
            for coedge in loop:
                chain = self.chains[coedge] if coedge >= 0 else self.chains[~coedge][::-1]
                ring += chain[:-1]
            rings.append(ring)
        plane = np.array([self.boundary.face_xdir[face], self.ydir[face]]).T
        flat = [points[ring] @ plane for ring in rings]
        if len(rings) == 1 and len(rings[0]) <= QUAD and _convex(flat[0]):
            a, b, c, *rest = rings[0]
            self.triangles += [(a, b, c), *((a, c, d) for d in rest)]
            return
        import manifold3d

        ids = np.concatenate([np.array(ring) for ring in rings])
        found = np.asarray(manifold3d.triangulate(flat)).tolist()
        self.triangles += [
            (int(ids[i]), int(ids[j]), int(ids[k]))
            for i, j, k in _without_slivers(found, np.concatenate(flat))
        ]


def _curvature(boundary: Boundary, rows: Ints) -> float:
    """Greatest second derivative [mm/rad2] along some arcs.

    For circles it is the radius, for ellipses half the length only where they turn.
    """
    first, last = boundary.arc_range[rows].T
    quarter = 0.5 * math.pi
    inner = (np.ceil(first / quarter)[:, None] + np.arange(3)) * quarter
    t = np.column_stack([first, last, np.minimum(inner, last[:, None])])
    away = boundary.arc_points(rows, t) - boundary.arc_center[rows][:, None]
    return float(np.linalg.norm(away, axis=-1).max())


def _grid(angles: Floats, step: float) -> Floats:
    """Sorted angles without repeats, and between them as many more as keep to the step."""
    grid: list[float] = []
    for angle in sorted(angles.ravel().tolist()):
        if grid and angle - grid[-1] <= SAME_ANGLE:
            continue
        if grid:
            last, parts = grid[-1], math.ceil((angle - grid[-1]) / step)
            grid += [last + (angle - last) * part / parts for part in range(1, parts)]
        grid.append(angle)
    return np.array(grid)


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


def _without_slivers(triangles: list[list[int]], points: Floats) -> list[list[int]]:
    """The same polygon without triangles whose corners are in line.

    Such triangles lie between the letters of a row: each gives its longest side to the other
    diagonal of the two triangles there.
    """

    def longest(triangle: list[int]) -> tuple[list[int], bool]:
        """The triangle beginning with its longest side, and whether it has no height."""
        corners = points[triangle]
        sides = np.roll(corners, -1, axis=0) - corners
        square = np.einsum("ij,ij->i", sides, sides)
        k = int(square.argmax())
        area = abs(sides[0, 0] * sides[1, 1] - sides[0, 1] * sides[1, 0])
        return triangle[k:] + triangle[:k], bool(area <= SLIVER * square[k])

    corners = points[np.array(triangles)]
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    doubled = np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])
    reach = np.maximum(np.sum(one**2, axis=1), np.sum(two**2, axis=1))
    todo = np.flatnonzero(doubled <= 2.0 * SLIVER * reach).tolist()
    if not todo:
        return triangles
    owner = {(t[k - 1], t[k]): n for n, t in enumerate(triangles) for k in range(3)}
    for _ in range(len(triangles) ** 2):
        if not todo:
            break
        here = todo.pop()
        (a, b, c), flat = longest(triangles[here])
        there = owner.get((b, a))
        if not flat or there is None:
            continue
        del owner[a, b], owner[b, a]
        d = next(corner for corner in triangles[there] if corner not in (a, b))
        triangles[here], triangles[there] = [a, d, c], [d, b, c]
        for number in (here, there):
            t = triangles[number]
            owner |= {(t[k - 1], t[k]): number for k in range(3)}
            todo.append(number)
    return triangles


def _convex(ring: Floats) -> bool:
    """Whether a small polygon turns left at every corner."""
    corners = ring.tolist()
    return all(
        (x1 - x0) * (y2 - y1) > (y1 - y0) * (x2 - x1)
        for (x0, y0), (x1, y1), (x2, y2) in zip(
            corners, corners[1:] + corners[:1], corners[2:] + corners[:2], strict=True
        )
    )

"""Boundary -> watertight triangle mesh, within a chord tolerance.

Every arc belongs to one cylinder face, which decides where it is sampled: at a grid of angles that
holds the angles of all the face's vertices. Between neighbouring angles the face is then a stack of
plane trapezoids. Plane faces are triangulated polygons with holes over the same points.
"""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np

from ddgfab.mesh import Floats
from fabrication.solids.boundary import Boundary, cross_rows
from fabrication.specs import TriangleMesh

CHORD = 0.05
"""Default greatest distance [mm] of the mesh from the exact surface."""

SAME_ANGLE = 1e-9
"""Angles [rad] on a cylinder face nearer than this are one generator line."""

MAX_STEP = math.pi / 4.0
"""Greatest angle [rad] between neighbouring generator lines, however small the cylinder."""

QUAD = 4
"""Polygons of so few corners are fanned out when they are convex."""

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
        axes = np.concatenate([b.arc_a[rows], b.arc_b[rows]])
        size = math.sqrt(float(np.max(np.sum(axes * axes, axis=1))))
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
        self.triangles += [
            (i, j, k) for i, j, k in ids[np.asarray(manifold3d.triangulate(flat))].tolist()
        ]


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


def _convex(ring: Floats) -> bool:
    """Whether a small polygon turns left at every corner."""
    corners = ring.tolist()
    return all(
        (x1 - x0) * (y2 - y1) > (y1 - y0) * (x2 - x1)
        for (x0, y0), (x1, y1), (x2, y2) in zip(
            corners, corners[1:] + corners[:1], corners[2:] + corners[:2], strict=True
        )
    )

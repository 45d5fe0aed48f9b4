"""BoundaryBuilder: draws a `Boundary` point by point, edge by edge, face by face.

Works on tuples of floats: a part has some dozens of vertices, for which arrays cost more.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Final, TypeAlias

import numpy as np

from fabrication.boundary import Boundary, Vec
from fabrication.crossing_curves import heights

Coedges: TypeAlias = list[int]

Onto: TypeAlias = tuple[Vec, Vec, float]
"""A point of a cylinder's axis, its unit direction, and its radius with a sign."""

NOWHERE: Final[Onto] = ((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0.0)
"""No cylinder."""


def add(p: Vec, q: Vec, factor: float = 1.0) -> Vec:
    """p + factor q."""
    return (p[0] + factor * q[0], p[1] + factor * q[1], p[2] + factor * q[2])


def scale(p: Vec, factor: float) -> Vec:
    """Factor times p."""
    return (p[0] * factor, p[1] * factor, p[2] * factor)


def dot(p: Vec, q: Vec) -> float:
    """Scalar product."""
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]


def cross(p: Vec, q: Vec) -> Vec:
    """Vector product."""
    return (
        p[1] * q[2] - p[2] * q[1],
        p[2] * q[0] - p[0] * q[2],
        p[0] * q[1] - p[1] * q[0],
    )


def normalized(p: Vec) -> Vec:
    """P divided by its length."""
    return scale(p, 1.0 / math.sqrt(dot(p, p)))


def opposite(loop: Sequence[int]) -> Coedges:
    """A loop of coedges run the other way."""
    return [~coedge for coedge in reversed(loop)]


def principal_axes(a: Vec, b: Vec) -> tuple[Vec, Vec, float]:
    """Axes of the ellipse cos(t) a + sin(t) b with any conjugate half-diameters a, b.

    Returns half-axes (major first), and the angle phi by which parameters shift: the point at t
    of the given diameters stands at t - phi of the axes.
    """
    phi = 0.5 * math.atan2(2.0 * dot(a, b), dot(a, a) - dot(b, b))
    c, s = math.cos(phi), math.sin(phi)
    return add(scale(a, c), b, s), add(scale(b, c), a, -s), phi


class BoundaryBuilder:
    """Collects points, edges and faces of a boundary; `build` turns them into arrays."""

    def __init__(self) -> None:
        self._points: list[Vec] = []
        self._edges: list[tuple[int, int]] = []
        self._edge_arc: list[int] = []
        self._lines: dict[tuple[int, int], int] = {}
        self._arcs: list[tuple[Vec, Vec, Vec, float, float, Onto]] = []
        self._faces: list[tuple[bool, Vec, Vec, Vec, float, float]] = []
        self._loops: list[tuple[int, Sequence[int]]] = []

    def point(self, position: Vec) -> int:
        """A new vertex; its id."""
        self._points.append(position)
        return len(self._points) - 1

    def position(self, point: int) -> Vec:
        """Where a vertex is."""
        return self._points[point]

    def line(self, start: int, end: int) -> int:
        """Coedge of the line between two vertices; the same edge when it was drawn before."""
        key = (start, end)
        if key in self._lines:
            return self._lines[key]
        edge = self._edge(start, end, -1)
        self._lines[key] = edge
        self._lines[end, start] = ~edge
        return edge

    def arc(
        self,
        ends: tuple[int, int],
        center: Vec,
        a: Vec,
        b: Vec,
        t0: float,
        t1: float,
        onto: Onto = NOWHERE,
    ) -> int:
        """Coedge of the arc center + cos(t) a + sin(t) b from t0 to t1; t may fall.

        onto : a point of the axis, the unit axis and the radius of a cylinder that the circle is
            moved onto along its axis a x b, +-radius for the farther or nearer place; 0: none
        """
        if t1 < t0:
            b, t0, t1 = scale(b, -1.0), -t0, -t1
            onto = (*onto[:2], 0.0 - onto[2])
        self._arcs.append((center, a, b, t0, t1, onto))
        return self._edge(*ends, len(self._arcs) - 1)

    def _edge(self, start: int, end: int, arc: int) -> int:
        self._edges.append((start, end))
        self._edge_arc.append(arc)
        return len(self._edges) - 1

    def plane(self, normal: Vec, loops: Iterable[Sequence[int]]) -> None:
        """A plane face with a unit outward normal through the first vertex of its first loop."""
        small = min(range(3), key=lambda k: abs(normal[k]))
        other = (float(small == 0), float(small == 1), float(small == 2))
        loops = list(loops)
        origin = self._points[self._start(loops[0][0])]
        self._face((False, origin, normal, normalized(cross(other, normal)), 0.0, 1.0), loops)

    def cylinder(
        self,
        origin: Vec,
        axis: Vec,
        middle: Vec,
        radius: float,
        sign: float,
        loops: Iterable[Sequence[int]],
    ) -> None:
        """A cylinder face around a unit axis; middle: unit vector from the axis to its middle."""
        self._face((True, origin, axis, scale(middle, -1.0), radius, sign), loops)

    def _start(self, coedge: int) -> int:
        return self._edges[coedge][0] if coedge >= 0 else self._edges[~coedge][1]

    def _face(
        self, face: tuple[bool, Vec, Vec, Vec, float, float], loops: Iterable[Sequence[int]]
    ) -> None:
        self._loops.extend((len(self._faces), loop) for loop in loops)
        self._faces.append(face)

    def round_hole(self, near: Vec, far: Vec, xdir: Vec, radius: float) -> tuple[Coedges, Coedges]:
        """Wall of a round hole from `near` to `far`: two half cylinders split at +-xdir.

        Returns the loops that the faces at the near and the far end get as holes; the far loop is
        the outer loop of the bottom when the hole is blind. xdir is perpendicular to the axis.
        """
        axis = normalized(add(far, near, -1.0))
        side = cross(axis, xdir)
        a, b = scale(xdir, radius), scale(side, radius)
        rims = []
        for center in (near, far):
            right, left = self.point(add(center, a)), self.point(add(center, a, -1.0))
            rims.append(
                (
                    right,
                    left,
                    self.arc((right, left), center, a, b, 0.0, math.pi),
                    self.arc((left, right), center, a, b, math.pi, 2.0 * math.pi),
                )
            )
        (right0, left0, upper0, lower0), (right1, left1, upper1, lower1) = rims
        right, left = self.line(right0, right1), self.line(left0, left1)
        self.cylinder(near, axis, side, radius, -1.0, [[right, upper1, ~left, ~upper0]])
        self.cylinder(
            near, axis, scale(side, -1.0), radius, -1.0, [[left, lower1, ~right, ~lower0]]
        )
        return [upper0, lower0], [~lower1, ~upper1]

    def blind_hole(self, mouth: Vec, bottom: Vec, xdir: Vec, radius: float) -> Coedges:
        """A round hole with a flat bottom; returns the loop that the face at its mouth gets."""
        near, far = self.round_hole(mouth, bottom, xdir, radius)
        self.plane(normalized(add(mouth, bottom, -1.0)), [far])
        return near

    def hole_into(
        self, near: Vec, axis: Vec, xdir: Vec, radius: float, onto: Onto
    ) -> tuple[Coedges, Coedges]:
        """Wall of a round hole from `near` along a unit axis to where it meets a cylinder first.

        Returns the loops that the faces at `near` and in the cylinder get as holes. The curve in
        the cylinder has four edges, each with one end at +-xdir. xdir is perpendicular to the axis.
        """
        side = cross(axis, xdir)
        a, b = scale(xdir, radius), scale(side, radius)
        right, left = self.point(add(near, a)), self.point(add(near, a, -1.0))
        upper = self.arc((right, left), near, a, b, 0.0, math.pi)
        lower = self.arc((left, right), near, a, b, math.pi, 2.0 * math.pi)
        first = (onto[0], onto[1], -onto[2])
        angles = [0.5 * math.pi * k for k in range(5)]
        deep = heights(
            np.array([near]), np.array([a]), np.array([b]),
            np.array([[*first[0], *first[1], first[2]]]), np.array([angles[:4]]),
        )[0][0].tolist()  # fmt: skip
        ways = (a, b, scale(a, -1.0), scale(b, -1.0))
        corners = [
            self.point(add(add(near, way), axis, h)) for way, h in zip(ways, deep, strict=True)
        ]
        quarters = [
            self.arc(
                (corners[k], corners[(k + 1) % 4]), near, a, b, angles[k], angles[k + 1], first
            )
            for k in range(4)
        ]
        up, down = self.line(right, corners[0]), self.line(left, corners[2])
        self.cylinder(near, axis, side, radius, -1.0, [[up, *quarters[:2], ~down, ~upper]])
        self.cylinder(
            near, axis, scale(side, -1.0), radius, -1.0, [[down, *quarters[2:], ~up, ~lower]]
        )
        return [upper, lower], opposite(quarters)

    def build(self) -> Boundary:
        """The arrays."""
        arcs = np.array(
            [(*c, *a, *b, t0, t1, *p, *e, r) for c, a, b, t0, t1, (p, e, r) in self._arcs],
            dtype=np.float64,
        ).reshape(-1, 18)
        faces = np.array([(*o, *n, *x, r, s) for _, o, n, x, r, s in self._faces])
        sizes = [len(loop) for _, loop in self._loops]
        return Boundary(
            points=np.array(self._points),
            edges=np.array(self._edges),
            edge_arc=np.array(self._edge_arc),
            arc_center=arcs[:, :3],
            arc_a=arcs[:, 3:6],
            arc_b=arcs[:, 6:9],
            arc_range=arcs[:, 9:11],
            arc_onto=arcs[:, 11:],
            face_cylinder=np.array([face[0] for face in self._faces]),
            face_origin=faces[:, :3],
            face_axis=faces[:, 3:6],
            face_xdir=faces[:, 6:9],
            face_radius=faces[:, 9],
            face_sign=faces[:, 10],
            loop_face=np.array([face for face, _ in self._loops]),
            loop_start=np.concatenate([[0], np.cumsum(sizes)]),
            coedges=np.array([coedge for _, loop in self._loops for coedge in loop]),
        )

"""Boundary: the exact surface of a part as plain arrays; Cut: a boundary less some cylinders.

Faces are planes and cylinders; edges are lines, arcs of circles or ellipses, and curves where two
cylinders cross. The kernel solid, the triangle mesh, the closed-form volume (and STEP text) are all
made from this one description.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ddgfab.errors import DegenerateError
from ddgfab.mesh import Floats, Ints
from fabrication.crossing_curves import heights

Vec: TypeAlias = tuple[float, float, float]

ON_SURFACE = 1e-9
"""How far [mm] an edge may be from the surfaces and vertices it belongs to, for a part of 1 m.

Larger parts get as much more as their coordinates are larger: it is a limit on rounding. The
kernel refuses plane faces whose vertices are 1e-6 mm off."""

ON_SURFACE_AT = 1000.0
"""The size [mm] of a part that `ON_SURFACE` is stated for."""


_YZX = [1, 2, 0]
_ZXY = [2, 0, 1]


def cross_rows(a: Floats, b: Floats) -> Floats:
    """Vector products of the rows of (n, 3) arrays, several times faster than numpy's on few."""
    return a[:, _YZX] * b[:, _ZXY] - a[:, _ZXY] * b[:, _YZX]


@dataclass(frozen=True, eq=False, repr=False)
class Boundary:
    """The closed, outward oriented boundary of one solid; make one with `BoundaryBuilder`.

    A coedge is an edge used by a loop: ``e`` along the edge, ``~e`` (that is -1 - e) against it.
    Loops keep the face on their left, seen from outside; a face's outer loop comes first.

    Attributes
    ----------
    points : (P, 3) vertices [mm]
    edges : (E, 2) point ids, start and end
    edge_arc : (E,) -1 for a line, else the row of its arc
    arc_center, arc_a, arc_b : (A, 3) of p(t) = center + cos(t) a + sin(t) b, a perpendicular to b
    arc_range : (A, 2) first and last parameter [rad], increasing, at most half a turn apart
    arc_onto : (A, 7) the cylinder that a circle is moved onto along its axis (`crossing_curves`):
        a point of the axis, its unit direction, the radius with the sign of the root; 0: none
    face_cylinder : (F,) whether the face is part of a cylinder
    face_origin : (F, 3) a point of the plane, or of the cylinder's axis
    face_axis : (F, 3) unit outward normal of the plane, or direction of the cylinder's axis
    face_xdir : (F, 3) unit, perpendicular to face_axis: where a cylinder's angle is zero, chosen
        opposite to the middle of the face, so that the face never meets the seam
    face_radius : (F,) radius [mm] of the cylinder, 0 for a plane
    face_sign : (F,) +1 where the outward normal points away from the axis, -1 towards it; 1 for
        planes
    loop_face : (L,) face of each loop, in order of the faces
    loop_start : (L + 1,) first coedge of each loop
    coedges : (C,) the loops' coedges, loop after loop
    """

    points: Floats
    edges: Ints
    edge_arc: Ints
    arc_center: Floats
    arc_a: Floats
    arc_b: Floats
    arc_range: Floats
    arc_onto: Floats
    face_cylinder: NDArray[np.bool_]
    face_origin: Floats
    face_axis: Floats
    face_xdir: Floats
    face_radius: Floats
    face_sign: Floats
    loop_face: Ints
    loop_start: Ints
    coedges: Ints

    def __repr__(self) -> str:
        round_faces = int(self.face_cylinder.sum())
        return (
            f"Boundary({len(self.face_radius) - round_faces} plane and {round_faces} cylinder "
            f"faces, {len(self.edges)} edges, genus {self.genus})"
        )

    @property
    def n_faces(self) -> int:
        """Number of faces."""
        return len(self.face_radius)

    @cached_property
    def coedge_face(self) -> Ints:
        """(C,) face of each coedge."""
        return np.repeat(self.loop_face, np.diff(self.loop_start))

    @cached_property
    def coedge_edge(self) -> Ints:
        """(C,) edge of each coedge."""
        return np.where(self.coedges < 0, ~self.coedges, self.coedges)

    def face_loops(self) -> list[list[list[int]]]:
        """Coedges of each loop of each face, as lists."""
        loops: list[list[list[int]]] = [[] for _ in range(self.n_faces)]
        start, coedges = self.loop_start.tolist(), self.coedges.tolist()
        for loop, face in enumerate(self.loop_face.tolist()):
            loops[face].append(coedges[start[loop] : start[loop + 1]])
        return loops

    @property
    def genus(self) -> int:
        """Number of handles, from V - E + F - (inner loops) = 2 - 2 genus."""
        inner = len(self.loop_face) - self.n_faces
        return (2 - (len(self.points) - len(self.edges) + self.n_faces - inner)) // 2

    @cached_property
    def arc_crosses(self) -> NDArray[np.bool_]:
        """(A,) whether an arc is a curve where two cylinders cross."""
        return np.asarray(self.arc_onto[:, 6] != 0.0)

    def arc_points(self, arcs: Ints, t: Floats) -> Floats:
        """Points of some arcs (n,) at parameters t (n, m) [rad], as (n, m, 3)."""
        return self.arc_motion(arcs, t)[0]

    def arc_motion(self, arcs: Ints, t: Floats) -> tuple[Floats, Floats]:
        """Points of some arcs (n,) at parameters t (n, m) [rad], and their rates, as (n, m, 3)."""
        cos, sin = np.cos(t)[..., None], np.sin(t)[..., None]
        a, b = self.arc_a[arcs][:, None], self.arc_b[arcs][:, None]
        points = self.arc_center[arcs][:, None] + cos * a + sin * b
        rates = cos * b - sin * a
        moved = np.flatnonzero(self.arc_crosses[arcs])
        if len(moved):
            own = arcs[moved]
            one, two = self.arc_a[own], self.arc_b[own]
            h, rate = heights(self.arc_center[own], one, two, self.arc_onto[own], t[moved])
            axis = cross_rows(one, two)
            axis /= np.sqrt(np.einsum("ai,ai->a", axis, axis))[:, None]
            points[moved] += h[..., None] * axis[:, None]
            rates[moved] += rate[..., None] * axis[:, None]
        return points, rates

    def edge_points(self, s: Floats) -> Floats:
        """Points of all edges at the parts s (m,) of their parameter range 0..1, as (E, m, 3)."""
        ends = self.points[self.edges]
        out = ends[:, :1] + s[None, :, None] * (ends[:, 1:] - ends[:, :1])
        arcs = self.edge_arc[self.edge_arc >= 0]
        first, last = self.arc_range[arcs].T[:, :, None]
        out[self.edge_arc >= 0] = self.arc_points(arcs, first + s * (last - first))
        return np.asarray(out)

    def transformed(self, placement: Floats) -> Boundary:
        """The boundary moved by a rigid motion (4, 4)."""
        turn, shift = placement[:3, :3], placement[:3, 3]
        return Boundary(
            self.points @ turn.T + shift,
            self.edges,
            self.edge_arc,
            self.arc_center @ turn.T + shift,
            self.arc_a @ turn.T,
            self.arc_b @ turn.T,
            self.arc_range,
            np.hstack(
                [
                    self.arc_onto[:, :3] @ turn.T + shift,
                    self.arc_onto[:, 3:6] @ turn.T,
                    self.arc_onto[:, 6:],
                ]
            ),
            self.face_cylinder,
            self.face_origin @ turn.T + shift,
            self.face_axis @ turn.T,
            self.face_xdir @ turn.T,
            self.face_radius,
            self.face_sign,
            self.loop_face,
            self.loop_start,
            self.coedges,
        )

    def major_first(self) -> Boundary:
        """The same boundary with the longer half-axis of every arc as its a."""
        swap = np.einsum("ai,ai->a", self.arc_b, self.arc_b) > np.einsum(
            "ai,ai->a", self.arc_a, self.arc_a
        )
        swap &= ~self.arc_crosses
        if not swap.any():
            return self
        pick = swap[:, None]
        return replace(
            self,
            arc_a=np.where(pick, self.arc_b, self.arc_a),
            arc_b=np.where(pick, -self.arc_a, self.arc_b),
            arc_range=np.where(pick, self.arc_range - np.pi / 2.0, self.arc_range),
        )

    # --- what makes it a boundary ------------------------------------------------------------
    def surface_distance(self) -> Floats:
        """(C,) greatest distance [mm] of each coedge's edge from the surface of its face."""
        points = self.edge_points(np.linspace(0.0, 1.0, 9))[self.coedge_edge]
        face = self.coedge_face
        away = points - self.face_origin[face][:, None]
        axis = self.face_axis[face][:, None]
        along = np.sum(away * axis, axis=-1)
        radial = np.linalg.norm(away - along[..., None] * axis, axis=-1)
        off = np.where(
            self.face_cylinder[face][:, None], radial - self.face_radius[face][:, None], along
        )
        return np.asarray(np.abs(off).max(axis=1))

    def validate(self) -> None:
        """Raise `DegenerateError` where this is not the boundary of one solid.

        Every loop closes, every edge is used once each way, every arc ends at its vertices, every
        edge lies on the surfaces of both its faces, and the faces are connected.
        """
        start, end = np.where((self.coedges < 0)[:, None], self.edges[self.coedge_edge][:, ::-1],
                              self.edges[self.coedge_edge]).T  # fmt: skip
        following = np.arange(1, len(self.coedges) + 1)
        following[self.loop_start[1:] - 1] = self.loop_start[:-1]
        gap = np.flatnonzero(end != start[following])
        if len(gap):
            raise DegenerateError(f"a loop of face {self.coedge_face[gap[0]]} does not close")
        n = len(self.edges)
        uses = np.bincount(self.coedge_edge + n * (self.coedges < 0), minlength=2 * n)
        bad = np.flatnonzero(uses != 1)
        if len(bad):
            raise DegenerateError(
                f"edge {bad[0] % n} is used {uses[bad[0]]} times "
                f"{'against' if bad[0] >= n else 'along'} its direction instead of once"
            )
        limit = ON_SURFACE * max(1.0, float(np.abs(self.points).max()) / ON_SURFACE_AT)
        off = np.abs(self.edge_points(np.array([0.0, 1.0])) - self.points[self.edges]).max((1, 2))
        if off.max() > limit:
            raise DegenerateError(
                f"edge {off.argmax()} misses its vertices by {off.max():.2g} mm; limit {limit:.2g}"
            )
        off = self.surface_distance()
        if off.max() > limit:
            worst = int(off.argmax())
            raise DegenerateError(
                f"edge {self.coedge_edge[worst]} is {off[worst]:.2g} mm off the surface of face "
                f"{self.coedge_face[worst]}; limit {limit:.2g}"
            )
        seen, stack = {0}, [0]
        neighbours: list[set[int]] = [set() for _ in range(self.n_faces)]
        order = np.argsort(self.coedge_edge, kind="stable")
        for one, two in self.coedge_face[order].reshape(-1, 2).tolist():
            neighbours[one].add(two)
            neighbours[two].add(one)
        while stack:
            fresh = neighbours[stack.pop()] - seen
            seen |= fresh
            stack.extend(fresh)
        if len(seen) < self.n_faces:
            raise DegenerateError(f"only {len(seen)} of {self.n_faces} faces are connected")


@dataclass(frozen=True)
class Tool:
    """A solid cylinder to be cut away: its foot, axis, a direction across, radius, height [mm]."""

    foot: Vec
    axis: Vec
    xdir: Vec
    radius: float
    height: float


@dataclass(frozen=True, eq=False)
class Cut:
    """A part whose boundary has other curves than lines, circles and ellipses.

    blank : exact boundary of the part before the cut
    tools : the cylinders that the CAD kernel cuts from it, all in one operation
    genus : number of handles of what is left
    """

    blank: Boundary
    tools: tuple[Tool, ...]
    genus: int

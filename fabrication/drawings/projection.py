"""Projection: what of a part is seen along a direction, and what is hidden behind it.

Edges come from the exact boundary, with the outlines of its cylinders; where a shape has none, from
the creases of its mesh. They are cut where they cross on paper; a piece is hidden when a triangle
of the mesh lies before its middle. Of a convex part the sides that face the viewer are seen.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ddgfab.mesh import Floats, Ints
from fabrication.boundary import Boundary, Vec, cross_rows
from fabrication.drawings.crossings import crossings
from fabrication.drawings.polylines import Polylines, Span
from fabrication.specs import TriangleMesh

STEP: Final = math.pi / 16.0
"""Arcs are followed by chords of this angle [rad]; those seen as circles are drawn as such."""

BEHIND: Final = 0.2
"""How far [mm] a triangle must lie before a line to hide it: more than the chord of the mesh."""

CREASE: Final = math.cos(math.radians(20.0))
"""Triangles that meet at more than this angle have an edge between them."""

SMOOTH: Final = 1.0 - 1e-9
"""Faces whose normals agree by this much at their edge have no edge to be drawn."""

EDGE_ON: Final = 1e-6
"""A face whose normal leans towards the viewer by less is seen edge-on."""

SHORT: Final = 1e-6
"""A line shorter than this [mm] on paper of the part's own size is a point."""


@dataclass(frozen=True, eq=False)
class Curve:
    """A piece of an edge as seen: points (n, 2) [mm], and its circle where it is seen as an arc.

    circle : center, radius, and first and last angle [rad], counterclockwise
    """

    points: Floats
    visible: bool
    circle: tuple[float, float, float, float, float] | None = None


def view_axes(right: Vec, up: Vec) -> Floats:
    """(3, 3) rows: right, up, and towards the viewer."""
    (a, b, c), (d, e, f) = right, up
    return np.array([right, up, (b * f - c * e, c * d - a * f, a * e - b * d)])


class Solid:
    """A part to be seen from several sides: what does not depend on the direction is found once."""

    def __init__(self, boundary: Boundary | None, mesh: TriangleMesh) -> None:
        self.boundary, self.mesh = boundary, mesh

    def seen(self, axes: Floats, near: float = math.inf) -> tuple[Curve, ...]:
        """The edges of the part as seen along a direction, in the part's own size [mm].

        Parameters
        ----------
        axes : (3, 3) of `view_axes`
        near : edges whose middles are farther behind the foremost point [mm] are left out
        """
        toward = axes[2]
        boundary = self.boundary
        if boundary is None:
            lines = Polylines.straight(_creases(self.mesh, toward)).turned(axes)
            arcs = np.full(lines.count, -1)
        else:
            facing = self._normals @ toward
            drawn = np.flatnonzero(self._sharp | (np.abs(facing) < EDGE_ON).any(axis=1))
            lines = self._lines.chosen(drawn)
            arcs = boundary.edge_arc[drawn]
            outlines = self._outlines(toward)
            if len(outlines):
                lines = lines.joined(Polylines.straight(outlines))
                arcs = np.concatenate([arcs, np.full(len(outlines), -1)])
            lines = lines.turned(axes)
            if self._convex and near == math.inf:
                visible = self._faced(drawn, facing, toward)
                if visible is not None:
                    visible = np.concatenate([visible, np.ones(len(outlines), dtype=bool)])
                    spans = lines.whole()
                    return self._curves(lines, arcs, spans, visible[spans.line], axes)
        spans = lines.cut(crossings(lines))
        middles = lines.at(spans.line, spans.first + 0.47 * (spans.last - spans.first))
        if near < math.inf:
            kept = np.flatnonzero(middles[:, 2] >= lines.points[:, 2].max() - near)
            spans, middles = spans.chosen(kept), middles[kept]
        return self._curves(lines, arcs, spans, ~_hidden(middles, self.mesh, axes), axes)

    # --- what does not depend on the direction -----------------------------------------------
    @cached_property
    def _lines(self) -> Polylines:
        """Every edge of the boundary, arcs by chords."""
        boundary = self.boundary
        assert boundary is not None
        ends = boundary.points[boundary.edges]
        counts = np.full(len(ends), 2)
        first, last = boundary.arc_range.T
        arcs = boundary.edge_arc
        is_arc = arcs >= 0
        if is_arc.any():
            steps = np.maximum(2, np.ceil((last - first) / STEP - 1e-9).astype(np.int64))
            counts[is_arc] = steps[arcs[is_arc]] + 1
        start = np.concatenate([[0], np.cumsum(counts)])
        points = np.empty((start[-1], 3))
        points[start[:-1]], points[start[1:] - 1] = ends[:, 0], ends[:, 1]
        if is_arc.any():
            edge = np.repeat(np.flatnonzero(is_arc), counts[is_arc])
            at = np.arange(len(edge)) - np.repeat(
                np.cumsum(counts[is_arc]) - counts[is_arc], counts[is_arc]
            )
            arc = arcs[edge]
            t = first[arc] + at / (counts[edge] - 1) * (last[arc] - first[arc])
            points[start[edge] + at] = boundary.arc_points(arc, t[:, None])[:, 0]
        return Polylines(points, start)

    @cached_property
    def _faces(self) -> Ints:
        """(E, 2) both faces of every edge."""
        assert self.boundary is not None
        order = np.argsort(self.boundary.coedge_edge, kind="stable")
        return self.boundary.coedge_face[order].reshape(-1, 2)

    def _normal(self, face: Ints, points: Floats) -> Floats:
        """Outward normals of faces at points."""
        boundary = self.boundary
        assert boundary is not None
        normals = boundary.face_axis[face].copy()
        round_ = boundary.face_cylinder[face]
        if round_.any():
            own = face[round_]
            away = points[round_] - boundary.face_origin[own]
            axis = boundary.face_axis[own]
            away -= np.sum(away * axis, axis=1)[:, None] * axis
            away *= (boundary.face_sign[own] / np.linalg.norm(away, axis=1))[:, None]
            normals[round_] = away
        return normals

    @cached_property
    def _normals(self) -> Floats:
        """(E, 2, 3) normals of both faces in the middle of every edge."""
        middles = self._lines.at(np.arange(len(self._faces)), np.full(len(self._faces), 0.5))
        both = [self._normal(self._faces[:, k], middles) for k in (0, 1)]
        return np.stack(both, axis=1)

    @cached_property
    def _sharp(self) -> NDArray[np.bool_]:
        """(E,) whether the faces of an edge do not go over into each other."""
        return np.asarray(np.sum(self._normals[:, 0] * self._normals[:, 1], axis=1) < SMOOTH)

    @cached_property
    def _convex(self) -> bool:
        """Whether all of the part lies behind each of its faces."""
        boundary = self.boundary
        assert boundary is not None
        if len(boundary.loop_face) > boundary.n_faces or (boundary.face_sign < 0.0).any():
            return False
        flat = ~boundary.face_cylinder
        normals, points = boundary.face_axis[flat], self._lines.points
        before = points @ normals.T - np.sum(boundary.face_origin[flat] * normals, axis=1)
        return bool(before.max() < 1e-6)

    # --- what does ---------------------------------------------------------------------------
    def _faced(self, drawn: Ints, facing: Floats, toward: Floats) -> NDArray[np.bool_] | None:
        """Which edges of a convex part are seen; None where an arc is seen in part."""
        boundary = self.boundary
        assert boundary is not None
        own = facing[drawn]
        edge_on = np.abs(own) <= EDGE_ON
        visible = np.asarray((own > EDGE_ON).any(axis=1) | edge_on.all(axis=1))
        bent = np.flatnonzero(boundary.edge_arc[drawn] >= 0)
        if len(bent):
            flat = own[bent][~boundary.face_cylinder[self._faces[drawn[bent]]]]
            if len(flat) != len(bent) or (np.abs(flat) < EDGE_ON).any():
                return None
            behind = boundary.edge_arc[drawn[bent[flat < 0.0]]]
            for half in (boundary.arc_a, boundary.arc_b):
                if (np.abs(half[behind] @ toward) > EDGE_ON).any():
                    return None
        return visible

    def _outlines(self, toward: Floats) -> Floats:
        """(n, 2, 3) where the cylinders turn away from the viewer: lines along their axes."""
        boundary = self.boundary
        assert boundary is not None
        round_ = np.flatnonzero(boundary.face_cylinder)
        if not len(round_):
            return np.empty((0, 2, 3))
        across = cross_rows(boundary.face_axis[round_], np.tile(toward, (len(round_), 1)))
        size = np.linalg.norm(across, axis=1)
        found = []
        for face, way, long in zip(round_.tolist(), across, size.tolist(), strict=True):
            if long < SHORT:
                continue
            axis, origin = boundary.face_axis[face], boundary.face_origin[face]
            points, joins = self._border(face)
            for normal in (way / long, -way / long):
                foot = origin + boundary.face_radius[face] * normal
                for low, high in _generators(points - origin, joins, axis, normal):
                    found.append((foot + low * axis, foot + high * axis))
        return np.array(found).reshape(-1, 2, 3)

    def _border(self, face: int) -> tuple[Floats, NDArray[np.bool_]]:
        """Points along the edges of a face, and whether each goes on to the next."""
        assert self.boundary is not None
        edges = self.boundary.coedge_edge[self.boundary.coedge_face == face]
        lines = self._lines.chosen(edges)
        joins = np.ones(len(lines.points), dtype=bool)
        joins[lines.start[1:] - 1] = False
        return lines.points, joins[:-1]

    def _curves(
        self, lines: Polylines, arcs: Ints, spans: Span, visible: NDArray[np.bool_], axes: Floats
    ) -> tuple[Curve, ...]:
        """Pieces of lines as curves: each place on paper once, pieces that follow as one."""
        spans, visible = lines.once(spans, visible)
        curves = []
        for line, first, last, is_seen in spans.runs(visible):
            circle, arc = None, int(arcs[line])
            if arc >= 0 and self.boundary is not None and not self.boundary.arc_crosses[arc]:
                circle = _circle(self.boundary, arc, axes, first, last)
            curves.append(Curve(lines.part(line, first, last)[:, :2], is_seen, circle))
        return tuple(curves)


def _generators(
    away: Floats, joins: NDArray[np.bool_], axis: Floats, normal: Floats
) -> Sequence[tuple[float, float]]:
    """From where to where along its axis a cylinder has the line in a direction from the axis.

    away : (n, 3) points of its border, from a point of the axis
    joins : (n - 1,) whether a point goes on to the next
    """
    other = np.cross(axis, normal)
    side, ahead, along = away @ other, away @ normal, away @ axis
    meets = np.flatnonzero(joins & ((side[:-1] > 0.0) != (side[1:] > 0.0)))
    if not len(meets):
        return []
    s = side[meets] / (side[meets] - side[meets + 1])
    front = ahead[meets] + s * (ahead[meets + 1] - ahead[meets]) > 0.0
    heights = np.sort((along[meets] + s * (along[meets + 1] - along[meets]))[front]).tolist()
    return list(zip(heights[::2], heights[1::2], strict=False))


def _circle(
    boundary: Boundary, arc: int, axes: Floats, first: float, last: float
) -> tuple[float, float, float, float, float] | None:
    """Circle of a piece of an arc, from one part of it to another; None where it is an ellipse."""
    vectors = np.array([boundary.arc_center[arc], boundary.arc_a[arc], boundary.arc_b[arc]])
    (x, y), (a, c), (b, d) = (vectors @ axes[:2].T).tolist()
    radius = math.hypot(a, c)
    if abs(radius - math.hypot(b, d)) > SHORT or abs(a * b + c * d) > SHORT * radius:
        return None
    begin, end = boundary.arc_range[arc].tolist()
    turned = math.atan2(c, a)
    sense = 1.0 if a * d - c * b > 0.0 else -1.0
    angles = sorted(turned + sense * (begin + s * (end - begin)) for s in (first, last))
    return (x, y, radius, angles[0], angles[1])


def _creases(mesh: TriangleMesh, toward: Floats) -> Floats:
    """(n, 2, 3) edges of a mesh that are sharp, or where it turns away from the viewer."""
    corners = mesh.vertices[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    pairs = np.sort(mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    order = np.lexsort(pairs.T)
    edges = pairs[order][::2]
    one, two = (np.repeat(np.arange(len(corners)), 3)[order].reshape(-1, 2)).T
    facing = normals @ toward
    sharp = np.sum(normals[one] * normals[two], axis=1) < CREASE
    turning = (facing[one] > 0.0) != (facing[two] > 0.0)
    return np.asarray(mesh.vertices[edges[sharp | turning]])


def _hidden(middles: Floats, mesh: TriangleMesh, axes: Floats) -> NDArray[np.bool_]:
    """Which points (n, 3) lie behind the part."""
    corners = (mesh.vertices @ axes.T)[mesh.triangles]
    one, two, three = corners[:, 0], corners[:, 1], corners[:, 2]
    double = (two[:, 0] - one[:, 0]) * (three[:, 1] - one[:, 1])
    double -= (two[:, 1] - one[:, 1]) * (three[:, 0] - one[:, 0])
    corners = corners[double > SHORT]
    double = double[double > SHORT]
    low, high = corners.min(axis=1), corners.max(axis=1)
    x, y, z = middles.T[:, :, None]
    near = (x >= low[:, 0]) & (x <= high[:, 0]) & (y >= low[:, 1]) & (y <= high[:, 1])
    near &= z < high[:, 2] - BEHIND
    point, triangle = np.nonzero(near)
    p = middles[point]
    a, b, c = (corners[triangle, k] for k in range(3))

    def weight(q: Floats, r: Floats) -> Floats:
        return np.asarray(
            (r[:, 0] - q[:, 0]) * (p[:, 1] - q[:, 1]) - (r[:, 1] - q[:, 1]) * (p[:, 0] - q[:, 0])
        )

    first, second = weight(b, c) / double[triangle], weight(c, a) / double[triangle]
    third = 1.0 - first - second
    depth = first * a[:, 2] + second * b[:, 2] + third * c[:, 2]
    inside = (first > 0.0) & (second > 0.0) & (third > 0.0) & (depth > p[:, 2] + BEHIND)
    hidden = np.zeros(len(middles), dtype=bool)
    hidden[point[inside]] = True
    return hidden

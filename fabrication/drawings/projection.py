"""Projection: what of a part is seen along a direction, and what is hidden behind it.

Edges come from the exact boundary, with the outlines of its cylinders; where a shape has none, from
the creases of its mesh. They are cut where they cross on paper; a piece is hidden when a triangle
of the mesh lies before its middle.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ddgfab.mesh import Floats
from fabrication.boundary import Boundary, Vec
from fabrication.specs import TriangleMesh

_Piece: TypeAlias = tuple[int, float, float]
"""A line, and from which to which part of its parameter 0..1."""

STEP: Final = math.pi / 16.0
"""Arcs are followed by chords of this angle [rad]; those seen as circles are drawn as such."""

BEHIND: Final = 0.2
"""How far [mm] a triangle must lie before a line to hide it: more than the chord of the mesh."""

CREASE: Final = math.cos(math.radians(20.0))
"""Triangles that meet at more than this angle have an edge between them."""

SHORT: Final = 1e-6
"""A line shorter than this [mm] on paper of the part's own size is a point."""

SAME: Final = 1e-3
"""Lines whose ends are nearer than this [mm] are one line."""


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
    u, v = np.array(right), np.array(up)
    return np.array([u, v, np.cross(u, v)])


def seen(boundary: Boundary | None, mesh: TriangleMesh, axes: Floats) -> tuple[Curve, ...]:
    """The edges of a part as seen along a direction, in the part's own size [mm]."""
    if boundary is None:
        lines = list(_creases(mesh, axes))
        arcs: list[int] = [-1] * len(lines)
    else:
        lines, arcs = _edges(boundary, axes)
        lines += _outlines(boundary, axes)
        arcs += [-1] * (len(lines) - len(arcs))
    flat = [(line, arc) for line, arc in zip(lines, arcs, strict=True) if _long(line)]
    pieces: list[_Piece] = []
    for edge, cuts in enumerate(_crossings([line for line, _ in flat])):
        at = [0.0, *sorted(cuts), 1.0]
        pieces += [(edge, a, b) for a, b in pairwise(at) if b - a > SHORT]
    middles = [_part(flat[edge][0], a + 0.47 * (b - a), b)[0] for edge, a, b in pieces]
    hidden = _hidden(np.array(middles).reshape(-1, 3), mesh, axes)
    curves = []
    for (edge, first, last), visible in _runs(_once(pieces, flat, hidden)):
        line, arc = flat[edge]
        circle = None
        if arc >= 0 and boundary is not None:
            circle = _circle(boundary, arc, axes, first, last)
        curves.append(Curve(_part(line, first, last)[:, :2], visible, circle))
    return tuple(curves)


def _once(
    pieces: Sequence[_Piece], lines: Sequence[tuple[Floats, int]], hidden: NDArray[np.bool_]
) -> Iterator[tuple[_Piece, bool]]:
    """Pieces and whether they are visible; of those in one place on paper one, a visible one."""
    taken: dict[tuple[int, ...], int] = {}
    for k in np.argsort(hidden, kind="stable").tolist():
        edge, first, last = pieces[k]
        points = _part(lines[edge][0], first, last)[:, :2]
        ends = sorted([points[0].tolist(), points[-1].tolist()])
        middle = points[len(points) // 2].tolist() if len(points) > 2 else ends[0]
        taken.setdefault(tuple(round(x / SAME) for end in (*ends, middle) for x in end), k)
    for k in sorted(taken.values()):
        yield pieces[k], not hidden[k]


def _runs(pieces: Iterator[tuple[_Piece, bool]]) -> Iterator[tuple[_Piece, bool]]:
    """Pieces of one edge that follow each other and are both visible, or both hidden, as one."""
    held: tuple[_Piece, bool] | None = None
    for piece, visible in pieces:
        if held is not None:
            (edge, first, last), before = held
            if edge == piece[0] and before == visible and abs(piece[1] - last) < SHORT:
                held = ((edge, first, piece[2]), visible)
                continue
            yield held
        held = (piece, visible)
    if held is not None:
        yield held


def _long(line: Floats) -> bool:
    """Whether a line is seen as more than a point."""
    return bool(np.abs(np.ptp(line[:, :2], axis=0)).max() > SHORT)


def _edges(boundary: Boundary, axes: Floats) -> tuple[list[Floats], list[int]]:
    """Every edge as points (n, 3) in the axes of the view, and its arc, -1 for a line."""
    ends = boundary.points[boundary.edges] @ axes.T
    lines: list[Floats] = []
    arcs: list[int] = boundary.edge_arc.tolist()
    center, a, b = (x @ axes.T for x in (boundary.arc_center, boundary.arc_a, boundary.arc_b))
    for edge, arc in enumerate(arcs):
        if arc < 0:
            lines.append(ends[edge])
            continue
        first, last = boundary.arc_range[arc]
        t = np.linspace(first, last, max(2, math.ceil((last - first) / STEP)) + 1)[:, None]
        lines.append(center[arc] + np.cos(t) * a[arc] + np.sin(t) * b[arc])
    return lines, arcs


def _circle(
    boundary: Boundary, arc: int, axes: Floats, first: float, last: float
) -> tuple[float, float, float, float, float] | None:
    """Circle of a piece of an arc, from one part of it to another; None where it is an ellipse."""
    center = axes[:2] @ boundary.arc_center[arc]
    a, b = axes[:2] @ boundary.arc_a[arc], axes[:2] @ boundary.arc_b[arc]
    radius = float(np.hypot(*a))
    if abs(radius - np.hypot(*b)) > SHORT or abs(a @ b) > SHORT * radius:
        return None
    begin, end = boundary.arc_range[arc]
    turned = math.atan2(a[1], a[0])
    sense = 1.0 if a[0] * b[1] - a[1] * b[0] > 0.0 else -1.0
    angles = sorted(turned + sense * (begin + s * (end - begin)) for s in (first, last))
    return (float(center[0]), float(center[1]), radius, angles[0], angles[1])


def _outlines(boundary: Boundary, axes: Floats) -> list[Floats]:
    """Where the cylinders turn away from the viewer: lines along their axes, (2, 3) each."""
    found = []
    for face in np.flatnonzero(boundary.face_cylinder).tolist():
        axis = boundary.face_axis[face]
        across = np.cross(axis, axes[2])
        size = float(np.linalg.norm(across))
        if size < SHORT:
            continue
        for normal in (across / size, -across / size):
            for low, high in _generators(boundary, face, normal):
                foot = boundary.face_origin[face] + boundary.face_radius[face] * normal
                found.append(np.array([foot + low * axis, foot + high * axis]) @ axes.T)
    return found


def _generators(boundary: Boundary, face: int, normal: Floats) -> Iterator[tuple[float, float]]:
    """From where to where along its axis a cylinder has the line in a direction from the axis."""
    axis, origin = boundary.face_axis[face], boundary.face_origin[face]
    other = np.cross(axis, normal)
    heights: list[float] = []
    for coedge in np.flatnonzero(boundary.coedge_face == face).tolist():
        edge = int(boundary.coedge_edge[coedge])
        arc = int(boundary.edge_arc[edge])
        if arc < 0:
            points = boundary.points[boundary.edges[edge]]
        else:
            first, last = boundary.arc_range[arc]
            t = np.linspace(first, last, max(2, math.ceil((last - first) / STEP)) + 1)[None]
            points = boundary.arc_points(np.array([arc]), t)[0]
        away = points - origin
        side, ahead, along = away @ other, away @ normal, away @ axis
        for k in range(len(points) - 1):
            if (side[k] > 0.0) != (side[k + 1] > 0.0):
                s = side[k] / (side[k] - side[k + 1])
                if ahead[k] + s * (ahead[k + 1] - ahead[k]) > 0.0:
                    heights.append(float(along[k] + s * (along[k + 1] - along[k])))
    heights.sort()
    yield from zip(heights[::2], heights[1::2], strict=False)


def _creases(mesh: TriangleMesh, axes: Floats) -> Iterator[Floats]:
    """Edges of a mesh that are sharp, or where it turns away from the viewer."""
    corners = mesh.vertices[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    pairs = np.sort(mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    order = np.lexsort(pairs.T)
    edges = pairs[order][::2]
    one, two = (np.repeat(np.arange(len(corners)), 3)[order].reshape(-1, 2)).T
    towards = normals @ axes[2]
    sharp = np.sum(normals[one] * normals[two], axis=1) < CREASE
    turning = (towards[one] > 0.0) != (towards[two] > 0.0)
    yield from mesh.vertices[edges[sharp | turning]] @ axes.T


def _crossings(lines: list[Floats]) -> list[list[float]]:
    """For every line, the parts 0..1 of its length in parameter where others cross it."""
    counts = np.array([len(line) - 1 for line in lines], dtype=np.int64)
    if not len(counts):
        return []
    owner = np.repeat(np.arange(len(lines)), counts)
    place = np.concatenate([np.arange(n) for n in counts])
    start = np.concatenate([line[:-1, :2] for line in lines])
    way = np.concatenate([np.diff(line[:, :2], axis=0) for line in lines])
    between = start[None, :, :] - start[:, None, :]
    turn = way[:, None, 0] * way[None, :, 1] - way[:, None, 1] * way[None, :, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        s = (between[..., 0] * way[None, :, 1] - between[..., 1] * way[None, :, 0]) / turn
        t = (between[..., 0] * way[:, None, 1] - between[..., 1] * way[:, None, 0]) / turn
    slack = 1e-7
    inside = (s > slack) & (s < 1.0 - slack) & (t > -slack) & (t < 1.0 + slack)
    inside &= owner[:, None] != owner[None, :]
    found: list[list[float]] = [[] for _ in lines]
    for i, j in zip(*np.nonzero(inside), strict=True):
        found[owner[i]].append(float(place[i] + s[i, j]) / float(counts[owner[i]]))
    return found


def _part(line: Floats, first: float, last: float) -> Floats:
    """A line between two parts of its parameter."""
    n = len(line) - 1
    inner = [k for k in range(1, n) if first + 1e-9 < k / n < last - 1e-9]
    parts = np.array([first, *(k / n for k in inner), last]) * n
    low = np.minimum(parts.astype(np.int64), n - 1)
    rest = (parts - low)[:, None]
    return np.asarray(line[low] * (1.0 - rest) + line[low + 1] * rest)


def _hidden(middle: Floats, mesh: TriangleMesh, axes: Floats) -> NDArray[np.bool_]:
    """Which points (n, 3) lie behind the part."""
    corners = (mesh.vertices @ axes.T)[mesh.triangles]
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    double = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    front = double > SHORT
    a, b, c, double = a[front], b[front], c[front], double[front]

    def weight(p: Floats, q: Floats) -> Floats:
        ahead = q - p
        x = middle[:, None, 0] - p[None, :, 0]
        y = middle[:, None, 1] - p[None, :, 1]
        return np.asarray((ahead[None, :, 0] * y - ahead[None, :, 1] * x) / double[None])

    first, second = weight(b, c), weight(c, a)
    third = 1.0 - first - second
    inside = (first > 0.0) & (second > 0.0) & (third > 0.0)
    depth = first * a[None, :, 2] + second * b[None, :, 2] + third * c[None, :, 2]
    return np.asarray((inside & (depth > middle[:, None, 2] + BEHIND)).any(axis=1))

"""Prisms: whether a boundary is a plane section swept along a line between two planes.

Bars with mitred ends and panes with square edges are. Models that others read, and files for
cutting, state them as a section and a length instead of as faces.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from ddgfab.mesh import Floats
from fabrication.boundary import Boundary, cross_rows
from fabrication.solids.section import segments
from fabrication.specs import Loop

ALONG: Final = 1e-10
"""A face is a side when the angle between it and the sweep is below this [rad]."""

SAME: Final = 1e-12
"""Directions are one when the cosine of their angle is nearer to 1."""

STRAIGHT: Final = 1e-7
"""A cap is perpendicular to the sweep when it departs by less [mm] over the section."""

ROUND: Final = 1e-6
"""How far [mm] the two half-axes of an arc may differ, seen along the sweep."""


@dataclass(frozen=True, eq=False)
class Cap:
    """An end of a prism: the plane w = height + slope . (u, v) of its frame [mm]."""

    height: float
    slope: tuple[float, float]

    @property
    def straight(self) -> bool:
        """Whether it is perpendicular to the sweep."""
        return self.slope == (0.0, 0.0)

    def at(self, u: float, v: float) -> float:
        """w [mm] above a point of the section."""
        return self.height + self.slope[0] * u + self.slope[1] * v


@dataclass(frozen=True, eq=False)
class Prism:
    """A section swept along w from one plane to another.

    Attributes
    ----------
    frame : (4, 4) from (u, v, w) to the part's frame; u, v and w are perpendicular, right-handed
    loops : of the section in (u, v); the first is the outer one, counterclockwise, the others are
        holes, clockwise
    low, high : where it begins and ends
    span : least and greatest w [mm]
    """

    frame: Floats
    loops: tuple[Loop, ...]
    low: Cap
    high: Cap
    span: tuple[float, float]

    @property
    def length(self) -> float:
        """From the least to the greatest w [mm]."""
        return self.span[1] - self.span[0]


def prism(boundary: Boundary, along: Literal["longest", "shortest"] = "longest") -> Prism | None:
    """The boundary as a prism, or None where it is none.

    Parameters
    ----------
    along : which one is taken where there are several, as for a box: that of the greatest length
        (bars), or of the least (sheets)
    """
    found = [p for d in _directions(boundary) if (p := _swept(boundary, d)) is not None]
    if not found:
        return None
    best = (max if along == "longest" else min)(p.length for p in found)
    # Lengths that differ by rounding alone must not choose.
    return next(p for p in found if abs(p.length - best) <= ROUND)


def _directions(boundary: Boundary) -> Iterator[Floats]:
    """Unit directions along which all faces but two may be swept, opposite ones alike.

    Candidates are straight edges and axes of cylinders.
    """
    lines = boundary.edges[boundary.edge_arc < 0]
    ways = boundary.points[lines[:, 1]] - boundary.points[lines[:, 0]]
    ways = np.vstack([ways, boundary.face_axis[boundary.face_cylinder]])
    ways /= np.sqrt(np.einsum("wi,wi->w", ways, ways))[:, None]
    tilt = np.abs(ways @ boundary.face_axis.T)
    side = np.where(boundary.face_cylinder, 1.0 - tilt <= ALONG, tilt <= ALONG)
    seen: list[Floats] = []
    for way in ways[(~side).sum(axis=1) == 2]:
        if not any(abs(abs(way @ other) - 1.0) < SAME for other in seen):
            seen.append(way)
            largest = int(np.argmax(np.abs(way) > 0.5))
            yield way if way[largest] > 0.0 else -way


def _swept(boundary: Boundary, way: Floats) -> Prism | None:
    """The boundary as a prism along a unit direction."""
    tilt = boundary.face_axis @ way
    across = boundary.face_axis - tilt[:, None] * way
    across = np.sqrt(np.einsum("fi,fi->f", across, across))
    side = np.where(boundary.face_cylinder, across, np.abs(tilt)) <= ALONG
    caps = np.flatnonzero(~side)
    if len(caps) != 2 or boundary.face_cylinder[caps].any() or tilt[caps].prod() >= 0.0:
        return None
    low, high = sorted(caps.tolist(), key=lambda face: float(tilt[face]))
    on_cap = np.zeros(len(boundary.edges), bool)
    on_cap[boundary.coedge_edge[~side[boundary.coedge_face]]] = True
    if (boundary.edge_arc[~on_cap] >= 0).any():
        return None
    frame = frame_along(way)
    loops = seen_loops(boundary, high, frame)
    if loops is None:
        return None
    wide = float(np.ptp(np.vstack([loop.points for loop in loops]), axis=0).max())
    begin, end = (_cap(boundary, face, frame, wide) for face in (low, high))
    least = min(begin.at(u, v) for u, v in _extremes(loops[0], begin.slope))
    greatest = max(end.at(u, v) for u, v in _extremes(loops[0], end.slope))
    return Prism(frame, loops, begin, end, (least, greatest))


def frame_along(way: Floats) -> Floats:
    """(4, 4): w along the direction; u along the coordinate axis that follows it, as far as can be.

    Its origin is the part's own, so that a section keeps its place about the axis of a bar.
    """
    after = (int(np.argmax(np.abs(way))) + 1) % 3
    u = np.eye(3)[after] - way[after] * way
    u /= math.sqrt(u @ u)
    frame = np.eye(4)
    frame[:3, 0], frame[:3, 1], frame[:3, 2] = u, cross_rows(way[None], u[None])[0], way
    return frame


def seen_loops(boundary: Boundary, cap: int, frame: Floats) -> tuple[Loop, ...] | None:
    """The loops of a face in (u, v) of a frame; None where an arc is none, seen along its w."""
    u, v = frame[:3, 0], frame[:3, 1]
    out = []
    for loop in np.flatnonzero(boundary.loop_face == cap).tolist():
        points, bulges = [], []
        for coedge in boundary.coedges[boundary.loop_start[loop] : boundary.loop_start[loop + 1]]:
            edge = int(~coedge if coedge < 0 else coedge)
            start = boundary.points[boundary.edges[edge, 1 if coedge < 0 else 0]]
            points.append((float(start @ u), float(start @ v)))
            arc = int(boundary.edge_arc[edge])
            bulge = 0.0
            if arc >= 0:
                halves = np.array([boundary.arc_a[arc], boundary.arc_b[arc]]) @ np.array([u, v]).T
                radii = np.linalg.norm(halves, axis=1)
                if (
                    abs(radii[0] - radii[1]) > ROUND
                    or abs(halves[0] @ halves[1]) > ROUND * radii[0]
                ):
                    return None
                turn = float(np.ptp(boundary.arc_range[arc]))
                ahead = math.copysign(
                    1.0, halves[0, 0] * halves[1, 1] - halves[0, 1] * halves[1, 0]
                )
                bulge = math.tan(turn / 4.0) * ahead * (-1.0 if coedge < 0 else 1.0)
            bulges.append(bulge)
        out.append(Loop(np.array(points), np.array(bulges)))
    return tuple(out)


def _cap(boundary: Boundary, face: int, frame: Floats, wide: float) -> Cap:
    """The plane of a face over a section that is so wide [mm]."""
    normal = frame[:3, :3].T @ boundary.face_axis[face]
    height = float(boundary.face_axis[face] @ boundary.face_origin[face]) / float(normal[2])
    slope = (-normal[:2] / normal[2]).tolist()
    if math.hypot(*slope) * wide <= STRAIGHT:
        slope = [0.0, 0.0]
    return Cap(height, (slope[0], slope[1]))


def _extremes(loop: Loop, slope: tuple[float, float]) -> list[tuple[float, float]]:
    """Points of a loop among which a linear function of a slope is least and greatest."""
    points: list[tuple[float, float]] = []
    steep = math.hypot(*slope)
    for s in segments(loop):
        points.append((s.u0, s.v0))
        for sign in (1.0, -1.0) if s.turn and steep else ():
            angle = math.atan2(sign * slope[1], sign * slope[0])
            past = (angle - s.first) * math.copysign(1.0, s.turn) % (2.0 * math.pi)
            if past < abs(s.turn):
                points.append(
                    (
                        s.center[0] + s.radius * math.cos(angle),
                        s.center[1] + s.radius * math.sin(angle),
                    )
                )
    return points

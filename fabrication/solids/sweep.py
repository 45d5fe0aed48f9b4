"""Sweep: a plane section swept along a straight line between two ends, each flat or coped.

Section coordinates are (u, v), the sweep runs along w; `Frame` says which axes of the part these
are. Beams sweep (y, z) along x, nodes (x, y) along z.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from fabrication.boundary import Vec
from fabrication.solids.builder import (
    BoundaryBuilder,
    Coedges,
    add,
    opposite,
    principal_axes,
    scale,
)
from fabrication.solids.section import Segment

Frame: TypeAlias = Callable[[float, float, float], Vec]

GENERATOR = 1e-9
"""A section line whose u changes by less than this part of its length runs along the coping
cylinder: what that misplaces is below rounding."""


@dataclass(frozen=True)
class End:
    """One end of a sweep: a plane, or a cylinder that touches it along u = 0.

    The plane is w = at + slope v + skew u.

    radius : of the coping cylinder, whose axis lies that far beyond the plane; None: flat.
    outward : +1 for the end the sweep runs to, -1 for the one it starts from.
    skew : 0 for a coped end
    """

    at: float
    slope: float
    radius: float | None
    outward: float
    skew: float = 0.0

    @property
    def stretch(self) -> float:
        """Length of the vector (1, -slope, -skew): the end's inclination."""
        return math.hypot(1.0, self.slope, self.skew)

    def height(self, u: float, v: float) -> float:
        """The w at which the section's point (u, v) ends."""
        w = self.at + self.slope * v + self.skew * u
        if self.radius is None:
            return w
        reach = self.radius - math.sqrt(self.radius * self.radius - u * u)
        return w + self.outward * self.stretch * reach

    def edge(
        self, builder: BoundaryBuilder, frame: Frame, segment: Segment, ends: tuple[int, int]
    ) -> int:
        """Coedge that this end cuts from the face swept by a segment."""
        if segment.turn != 0.0:
            drawn = self._flat_arc if self.radius is None else self._coped_arc
            return drawn(builder, frame, segment, ends)
        du, dv = segment.u1 - segment.u0, segment.v1 - segment.v0
        if self.radius is None or abs(du) <= GENERATOR * math.hypot(du, dv):
            return builder.line(*ends)
        # Plane of the swept line with the cylinder: u = radius sin(theta), v = v_axis + m u.
        m, n = dv / du, self.stretch
        v_axis = segment.v0 - m * segment.u0
        w_axis = self.at + self.slope * v_axis + self.outward * n * self.radius
        a = frame(0.0, 0.0, -self.outward * n * self.radius)
        b = frame(self.radius, m * self.radius, self.slope * m * self.radius)
        a, b, phi = principal_axes(a, b)
        t0 = math.asin(segment.u0 / self.radius) - phi
        t1 = math.asin(segment.u1 / self.radius) - phi
        return builder.arc(ends, frame(0.0, v_axis, w_axis), a, b, t0, t1)

    def _flat_arc(
        self, builder: BoundaryBuilder, frame: Frame, segment: Segment, ends: tuple[int, int]
    ) -> int:
        (cu, cv), r = segment.center, segment.radius
        a, b = frame(r, 0.0, r * self.skew), frame(0.0, r, r * self.slope)
        phi = 0.0
        if self.skew != 0.0:  # otherwise they are perpendicular as they are
            a, b, phi = principal_axes(a, b)
        center = frame(cu, cv, self.at + self.slope * cv + self.skew * cu)
        first = segment.first - phi
        return builder.arc(ends, center, a, b, first, first + segment.turn)

    def _coped_arc(
        self, builder: BoundaryBuilder, frame: Frame, segment: Segment, ends: tuple[int, int]
    ) -> int:
        """Where the round face swept by an arc meets the coping cylinder first."""
        (cu, cv), r = segment.center, segment.radius
        origin, axis, radius = self.cylinder(frame)
        onto = (origin, axis, -self.outward * radius)
        a, b, center = frame(r, 0.0, 0.0), frame(0.0, r, 0.0), frame(cu, cv, 0.0)
        last = segment.first + segment.turn
        return builder.arc(ends, center, a, b, segment.first, last, onto)

    def cylinder(self, frame: Frame) -> tuple[Vec, Vec, float]:
        """A point of the axis, the unit axis and the radius of the coping cylinder."""
        assert self.radius is not None
        normal = scale(frame(-self.skew, -self.slope, 1.0), self.outward / self.stretch)
        origin = add(frame(0.0, 0.0, self.at), normal, self.radius)
        return origin, scale(frame(0.0, 1.0, self.slope), 1.0 / self.stretch), self.radius

    def face(
        self,
        builder: BoundaryBuilder,
        frame: Frame,
        loops: Sequence[Sequence[int]],
        *,
        cavity: bool = False,
    ) -> None:
        """The face that closes this end, bounded by loops seen from outside.

        Where the sweep is a cavity of the part, the face looks into it; only flat ends do.
        """
        n = self.stretch
        normal = scale(frame(-self.skew, -self.slope, 1.0), self.outward / n)
        if self.radius is None:
            builder.plane(scale(normal, -1.0) if cavity else normal, loops)
            return
        origin, axis, radius = self.cylinder(frame)
        builder.cylinder(origin, axis, scale(normal, -1.0), radius, -1.0, loops)


def walls(
    builder: BoundaryBuilder,
    frame: Frame,
    loop: Sequence[Segment],
    start: End,
    end: End,
    holes: Mapping[int, Sequence[Coedges]],
) -> tuple[Coedges, Coedges]:
    """Side faces of a closed loop swept between two ends: of an outside, or of a hole (clockwise).

    Parameters
    ----------
    holes : loops in the face of segment k, by k

    Returns
    -------
    The loops that the faces at the start and at the end get, seen from outside.
    """
    axis = frame(0.0, 0.0, 1.0)
    lower = [builder.point(frame(s.u0, s.v0, start.height(s.u0, s.v0))) for s in loop]
    upper = [builder.point(frame(s.u0, s.v0, end.height(s.u0, s.v0))) for s in loop]
    rails = [builder.line(p, q) for p, q in zip(lower, upper, strict=True)]
    count = len(loop)
    first = [
        start.edge(builder, frame, s, (lower[k], lower[(k + 1) % count]))
        for k, s in enumerate(loop)
    ]
    last = [
        end.edge(builder, frame, s, (upper[k], upper[(k + 1) % count])) for k, s in enumerate(loop)
    ]
    for k, s in enumerate(loop):
        around = [first[k], rails[(k + 1) % count], ~last[k], ~rails[k]]
        inside = [around, *holes.get(k, ())]
        if s.turn == 0.0:
            length = math.hypot(s.u1 - s.u0, s.v1 - s.v0)
            normal = frame((s.v1 - s.v0) / length, (s.u0 - s.u1) / length, 0.0)
            builder.plane(normal, inside)
        else:
            middle = frame(math.cos(s.middle), math.sin(s.middle), 0.0)
            sign = 1.0 if s.turn > 0.0 else -1.0
            builder.cylinder(frame(*s.center, 0.0), axis, middle, s.radius, sign, inside)
    return opposite(first), last


def sweep(
    builder: BoundaryBuilder,
    frame: Frame,
    loops: Sequence[Sequence[Segment]],
    start: End,
    end: End,
    side_holes: Mapping[tuple[int, int], Sequence[Coedges]],
    end_holes: Sequence[Coedges] = (),
) -> None:
    """Faces of a section of closed loops swept between two ends.

    side_holes : loops in the face of segment k of loop i, by (i, k); end_holes: in the end's face.
    """
    first_loops: list[Coedges] = []
    last_loops: list[Coedges] = []
    for i, loop in enumerate(loops):
        own = {k: holes for (j, k), holes in side_holes.items() if j == i}
        first, last = walls(builder, frame, loop, start, end, own)
        first_loops.append(first)
        last_loops.append(last)
    start.face(builder, frame, first_loops)
    end.face(builder, frame, [*last_loops, *end_holes])

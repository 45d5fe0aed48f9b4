"""Sections: the lines and arcs of a plane loop, and integrals over what loops enclose."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ddgfab.mesh import Floats
from fabrication.specs import Loop

GAUSS_NODES = 16
"""Nodes of the quadrature along an arc of at most half a turn: exact to rounding for the
trigonometric polynomials that areas, volumes and centroids are made of."""


@lru_cache(maxsize=8)
def gauss(nodes: int) -> tuple[Floats, Floats]:
    """Nodes and weights of Gauss-Legendre quadrature on 0..1."""
    x, w = np.polynomial.legendre.leggauss(nodes)
    return (x + 1.0) / 2.0, w / 2.0


@dataclass(frozen=True)
class Segment:
    """A line or arc of a section from (u0, v0) to (u1, v1).

    turn [rad] is the angle of the arc, positive counterclockwise, 0 for a line; center, radius and
    first angle belong to the arc.
    """

    u0: float
    v0: float
    u1: float
    v1: float
    turn: float = 0.0
    center: tuple[float, float] = (0.0, 0.0)
    radius: float = 0.0
    first: float = 0.0

    @property
    def middle(self) -> float:
        """Angle [rad] of the middle of an arc, seen from its center."""
        return self.first + 0.5 * self.turn

    def bounds(self) -> tuple[float, float, float, float]:
        """Least u, greatest u, least v, greatest v."""
        us, vs = [self.u0, self.u1], [self.v0, self.v1]
        for quarter in range(4) if self.turn else ():
            angle = quarter * math.pi / 2.0
            past = (angle - self.first) * math.copysign(1.0, self.turn) % (2.0 * math.pi)
            if past < abs(self.turn):
                us.append(self.center[0] + self.radius * math.cos(angle))
                vs.append(self.center[1] + self.radius * math.sin(angle))
        return min(us), max(us), min(vs), max(vs)

    def points(self, s: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """u, v and their derivatives at the parts s (n,) of the segment."""
        if self.turn == 0.0:
            du, dv = self.u1 - self.u0, self.v1 - self.v0
            return self.u0 + s * du, self.v0 + s * dv, np.full_like(s, du), np.full_like(s, dv)
        angle = self.first + s * self.turn
        cos, sin = self.radius * np.cos(angle), self.radius * np.sin(angle)
        return self.center[0] + cos, self.center[1] + sin, -self.turn * sin, self.turn * cos


def segments(loop: Loop) -> list[Segment]:
    """The segments of a loop, the k-th from point k to the next."""
    points, bulges = loop.points.tolist(), loop.bulges.tolist()
    out = []
    for (u0, v0), (u1, v1), bulge in zip(points, points[1:] + points[:1], bulges, strict=True):
        if bulge == 0.0:
            out.append(Segment(u0, v0, u1, v1))
            continue
        # The center lies on the chord's bisector, (1 - bulge^2) / (4 bulge) of the chord to the
        # left of its middle.
        k = (1.0 - bulge * bulge) / (4.0 * bulge)
        cu = 0.5 * (u0 + u1) - k * (v1 - v0)
        cv = 0.5 * (v0 + v1) + k * (u1 - u0)
        out.append(
            Segment(
                u0,
                v0,
                u1,
                v1,
                4.0 * math.atan(bulge),
                (cu, cv),
                math.hypot(u0 - cu, v0 - cv),
                math.atan2(v0 - cv, u0 - cu),
            )
        )
    return out


def distance_to(loop: Sequence[Segment], u: float, v: float) -> float:
    """Distance [mm] of a point from the lines of a loop, its arcs counted as their chords."""
    least = math.inf
    for s in loop:
        du, dv = s.u1 - s.u0, s.v1 - s.v0
        square = du * du + dv * dv
        t = min(max(((u - s.u0) * du + (v - s.v0) * dv) / square, 0.0), 1.0)
        least = min(least, math.hypot(s.u0 + t * du - u, s.v0 + t * dv - v))
    return least


def integrate(
    loops: Sequence[Loop], antiderivative: Callable[[Floats, Floats], Floats], nodes: int
) -> float:
    """Integral of f(u, v) over what the loops enclose, from F with dF/du = f (Green's theorem)."""
    s, weight = gauss(nodes)
    total = 0.0
    for loop in loops:
        for segment in segments(loop):
            u, v, _, dv = segment.points(s)
            total += float(np.sum(weight * antiderivative(u, v) * dv))
    return total


def section_area(loops: Sequence[Loop]) -> float:
    """Area [mm2] of a section; holes are loops that run clockwise."""
    return integrate(loops, lambda u, v: u, GAUSS_NODES)

"""The same parts the way build123d's documentation suggests: sketch, extrude, cut, fillet, export.

The peer of the benchmarks: what a designer would write who has the numbers (our specs) and
build123d, and no other tool. It shares no code with `fabrication.solids`.
"""

from __future__ import annotations

import math
from typing import Any

import build123d as b3

from fabrication.parts.beam import BeamShape, EndCut
from fabrication.parts.node import NodeShape
from fabrication.parts.panel import PanelShape
from fabrication.specs import Loop, Shape


def outline(loop: Loop, plane: b3.Plane) -> Any:
    """A face from a loop of lines and bulges."""
    curves = []
    count = len(loop.points)
    for i in range(count):
        a, b = loop.points[i], loop.points[(i + 1) % count]
        bulge = float(loop.bulges[i])
        if bulge == 0.0:
            curves.append(b3.Line(tuple(a), tuple(b)))
        else:
            middle = (a + b) / 2 + bulge / 2 * (b - a)[::-1] * (1, -1)
            curves.append(b3.ThreePointArc(tuple(a), tuple(middle), tuple(b)))
    return plane * b3.make_face(curves)


def cut_end(body: Any, cut: EndCut, sign: float, height: float) -> Any:
    """Cut a beam at its start (sign -1) or end (+1)."""
    tilt = math.atan(cut.slope)
    if cut.radius is None:
        plane = b3.Plane((cut.x, 0, 0), x_dir=(0, 1, 0), z_dir=(math.cos(tilt), 0, -math.sin(tilt)))
        return b3.split(body, bisect_by=plane, keep=b3.Keep.BOTTOM if sign > 0 else b3.Keep.TOP)
    axis_x = cut.x + sign * cut.radius / math.cos(tilt)
    plane = b3.Plane((axis_x, 0, 0), x_dir=(0, 1, 0), z_dir=(math.sin(tilt), 0, math.cos(tilt)))
    return body - plane * b3.Cylinder(cut.radius, height)


def beam(shape: BeamShape) -> Any:
    """Extrude the profile, cut both ends, drill."""
    reach = 4 * (shape.profile.depth + shape.profile.width)
    x0, x1 = shape.start.x - reach, shape.end.x + reach
    if shape.start.radius is not None:
        x0 = shape.start.x - 0.9 * shape.start.radius
    if shape.end.radius is not None:
        x1 = shape.end.x + 0.9 * shape.end.radius
    plane = b3.Plane((x0, 0, 0), x_dir=(0, 1, 0), z_dir=(1, 0, 0))
    outer, *inner = shape.profile.loops
    face = outline(outer, plane)
    for loop in inner:
        face -= outline(Loop(loop.points, loop.bulges), plane)
    body = b3.extrude(face, amount=x1 - x0, dir=(1, 0, 0))
    body = cut_end(cut_end(body, shape.start, -1.0, reach), shape.end, 1.0, reach)
    for hole in shape.holes:
        drill = b3.Plane((hole.x, 0, hole.z), z_dir=(0, 1, 0))
        body -= drill * b3.Cylinder(hole.diameter / 2, 2 * shape.profile.width)
    return body


def node(shape: NodeShape) -> Any:
    """A cylinder, minus a bore, a box a seat, a cylinder a hole."""
    height, middle = shape.z1 - shape.z0, (shape.z0 + shape.z1) / 2
    body = b3.Pos(0, 0, middle) * b3.Cylinder(shape.radius, height)
    if shape.bore:
        body -= b3.Pos(0, 0, middle) * b3.Cylinder(shape.bore, 2 * height)
    for seat in shape.seats:
        turned = b3.Rot(0, 0, math.degrees(seat.azimuth))
        body -= (
            turned
            * b3.Pos(seat.distance + shape.radius / 2, 0, middle)
            * b3.Box(shape.radius, 2 * shape.radius, 2 * height)
        )
    for hole in shape.holes:
        seat_at = min(
            (s.distance for s in shape.seats if abs(s.azimuth - hole.azimuth) < 1e-9),
            default=shape.radius,
        )
        depth = hole.depth or seat_at - shape.bore
        plane = b3.Plane(
            (
                (seat_at - depth / 2 + 1) * math.cos(hole.azimuth),
                (seat_at - depth / 2 + 1) * math.sin(hole.azimuth),
                hole.z,
            ),
            z_dir=(math.cos(hole.azimuth), math.sin(hole.azimuth), 0),
        )
        body -= plane * b3.Cylinder(hole.diameter / 2, depth + 2)
    if shape.mark:
        body -= b3.Pos(shape.mark.x, 0, shape.z1) * b3.Cylinder(
            shape.mark.diameter / 2, 2 * shape.mark.depth
        )
    return body


def panel(shape: PanelShape) -> Any:
    """Extrude the polygon (or loft it, where mitred), round the corners."""
    inner = b3.make_face(b3.Polyline(*map(tuple, shape.inner), close=True))
    if abs(shape.inner - shape.outer).max() == 0.0:
        body = b3.extrude(inner, amount=shape.thickness)
    else:
        outer = b3.make_face(b3.Polyline(*map(tuple, shape.outer), close=True))
        body = b3.loft([inner, b3.Pos(0, 0, shape.thickness) * outer])
    if shape.corner_radius:
        slanted = [e for e in body.edges() if abs(e.center().Z - shape.thickness / 2) < 1e-3]
        body = b3.fillet(slanted, shape.corner_radius)
    return body


def solid(shape: Shape) -> Any:
    """A part of any kind."""
    if isinstance(shape, BeamShape):
        return beam(shape)
    return node(shape) if isinstance(shape, NodeShape) else panel(shape)

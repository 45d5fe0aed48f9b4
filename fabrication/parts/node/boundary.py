"""Nodes: a cylinder or tube with milled seats and drilled holes -> exact boundary."""

from __future__ import annotations

import math
from itertools import combinations
from typing import TYPE_CHECKING, Final

import numpy as np

from ddgfab.errors import DetailError
from fabrication.boundary import Boundary, Cut, Tool, Vec
from fabrication.parts.node.drills import (
    MAX_ARC,
    SAME_AZIMUTH,
    Drill,
    angle_apart,
    bore_face,
    bore_loop,
    bore_splits,
    drills,
)
from fabrication.solids.builder import BoundaryBuilder, Coedges, add
from fabrication.solids.section import segments
from fabrication.solids.sweep import End, sweep
from fabrication.specs import Loop

if TYPE_CHECKING:
    from fabrication.parts.node.shape import NodeShape, Seat

TOUCHING: Final = 1e-4
"""Seats with less of the circle [mm] between them, or overlapping by less, meet in an edge: an
arc so short is not a face."""

OVERLAP: Final = 1.0
"""How far [mm] the cylinder that drills a hole reaches beyond the node."""


def frame(u: float, v: float, w: float) -> Vec:
    """Section (x, y) and sweep z as a point of the node's frame."""
    return (u, v, w)


def half_angle(shape: NodeShape, seat: Seat) -> float:
    """Half the angle [rad] that a seat takes from the circle."""
    return math.acos(seat.distance / shape.radius)


def node_is_exact(shape: NodeShape) -> bool:
    """Whether every radial hole stands on a seat, and the bore has room between its holes."""
    return all(drill.exact for drill in drills(shape)) and bool(bore_splits(shape))


def seat_order(shape: NodeShape) -> list[int]:
    """The seats counterclockwise."""
    return sorted(range(len(shape.seats)), key=lambda k: shape.seats[k].azimuth % (2.0 * math.pi))


def node_section(shape: NodeShape) -> tuple[Loop, ...]:
    """Outline of the node across its axis, with the bore as a second loop.

    Raises
    ------
    DetailError
        A seat misses the cylinder or opens the bore; two seats cut each other; no wall is left.
    """
    if not 0.0 <= shape.bore < shape.radius or shape.z1 <= shape.z0:
        raise DetailError(
            f"a node of radius {shape.radius:.6g} mm from z = {shape.z0:.6g} to {shape.z1:.6g} mm "
            f"with a bore of radius {shape.bore:.6g} mm is not a solid"
        )
    for k, seat in enumerate(shape.seats):
        if not shape.bore < seat.distance < shape.radius:
            raise DetailError(
                f"seat {k} at {seat.distance:.6g} mm from the axis is outside the wall, "
                f"{shape.bore:.6g} to {shape.radius:.6g} mm: widen the node"
            )
    order = seat_order(shape)
    points: list[tuple[float, float]] = []
    bulges: list[float] = []

    def arc(first: float, turn: float) -> None:
        parts = math.ceil(turn / MAX_ARC)
        for part in range(parts):
            angle = first + turn * part / parts
            points.append((shape.radius * math.cos(angle), shape.radius * math.sin(angle)))
            bulges.append(math.tan(turn / parts / 4.0))

    if not order:
        arc(0.0, 2.0 * math.pi)
    for position, k in enumerate(order):
        seat, after = shape.seats[k], order[(position + 1) % len(order)]
        half = half_angle(shape, seat)
        points.append(_corner(shape, shape.seats[order[position - 1]], seat))
        bulges.append(0.0)
        gap = _gap(shape, seat, shape.seats[after])
        if gap < -TOUCHING / shape.radius:
            step = gap + half + half_angle(shape, shape.seats[after])
            raise DetailError(
                f"seats {k} and {after} cut each other: {math.degrees(step):.4g} deg apart, they "
                f"take {math.degrees(step - gap):.4g} deg of the circle; widen the node"
            )
        if gap > TOUCHING / shape.radius:
            arc(seat.azimuth + half, gap)
    outer = Loop(np.array(points), np.array(bulges))
    if shape.bore == 0.0:
        return (outer,)
    return outer, bore_loop(shape)


def _gap(shape: NodeShape, before: Seat, seat: Seat) -> float:
    """Angle [rad] of the circle left between a seat and the next one counterclockwise."""
    step = (seat.azimuth - before.azimuth) % (2.0 * math.pi)
    if before is seat:
        step = 2.0 * math.pi
    return step - half_angle(shape, before) - half_angle(shape, seat)


def _corner(shape: NodeShape, before: Seat, seat: Seat) -> tuple[float, float]:
    """Where a seat begins: on the circle, or in the line where it meets the seat before it."""
    if _gap(shape, before, seat) > TOUCHING / shape.radius:
        angle = seat.azimuth - half_angle(shape, seat)
        return shape.radius * math.cos(angle), shape.radius * math.sin(angle)
    (a, b), (c, d) = ((math.cos(s.azimuth), math.sin(s.azimuth)) for s in (before, seat))
    p, q = before.distance, seat.distance
    return (p * d - q * b) / (a * d - b * c), (a * q - c * p) / (a * d - b * c)


def check_holes(shape: NodeShape, found: list[Drill]) -> None:
    """Raise `DetailError` where a hole leaves its seat or the part, or meets another hole."""
    for k, drill in enumerate(found):
        hole, r = drill.hole, drill.hole.diameter / 2.0
        name = f"radial hole {k} of {hole.diameter:.6g} mm"
        if not (shape.z0 < hole.z - r and hole.z + r < shape.z1):
            raise DetailError(
                f"{name} at z = {hole.z:.6g} mm leaves the node, which reaches from "
                f"{shape.z0:.6g} to {shape.z1:.6g} mm"
            )
        if drill.seat is not None:
            seat = shape.seats[drill.seat]
            room = math.sqrt(shape.radius**2 - seat.distance**2)
        else:
            free = min(
                (angle_apart(hole.azimuth, s.azimuth) - half_angle(shape, s) for s in shape.seats),
                default=math.pi,
            )
            room = shape.radius * math.sin(min(max(free, 0.0), math.pi / 2.0))
        if r + abs(hole.across) >= room:
            raise DetailError(
                f"{name} is wider than the {2 * (room - abs(hole.across)):.6g} mm it has: widen "
                "the node"
            )
        if drill.bottom is None:
            if r + abs(hole.across) >= shape.bore:
                raise DetailError(
                    f"{name} goes through to a bore of {2 * shape.bore:.6g} mm, which must be "
                    f"wider than the hole"
                )
        elif drill.bottom <= shape.bore:
            raise DetailError(
                f"{name} reaches {drill.bottom:.6g} mm from the axis; it must stay outside the "
                f"bore's {shape.bore:.6g} mm: make it less deep, or through"
            )
        inner, _ = _strip(shape, drill)
        for j, seat in enumerate(shape.seats):
            apart = angle_apart(seat.azimuth, hole.azimuth)
            reach = inner * math.cos(apart) + (r + abs(hole.across)) * math.sin(apart)
            if j != drill.seat and reach >= seat.distance:
                raise DetailError(
                    f"{name} breaks out of seat {j}, {seat.distance:.6g} mm from the axis, where "
                    f"it reaches {reach:.6g} mm: make it less deep"
                )
    for (i, one), (j, two) in combinations(enumerate(found), 2):
        if _holes_meet(shape, one, two):
            raise DetailError(
                f"radial holes {i} and {j} run into each other: make them less deep, or move one"
            )
    _check_mark(shape, found)


def _strip(shape: NodeShape, drill: Drill) -> tuple[float, float]:
    """Where a hole ends inside, from the axis, and its radius."""
    r = drill.hole.diameter / 2.0
    far = r + abs(drill.hole.across)
    inner = math.sqrt(shape.bore**2 - far * far) if drill.bottom is None else drill.bottom
    return inner, r


def _holes_meet(shape: NodeShape, one: Drill, two: Drill) -> bool:
    """Whether two holes meet, by their silhouettes seen along the axis; errs towards yes."""
    (q1, r1), (q2, r2) = _strip(shape, one), _strip(shape, two)
    if abs(one.hole.z - two.hole.z) >= r1 + r2:
        return False
    apart = angle_apart(one.hole.azimuth, two.hole.azimuth)
    if apart <= SAME_AZIMUTH:
        between = one.hole.z - two.hole.z, one.hole.across - two.hole.across
        return math.hypot(*between) <= r1 + r2
    turn = math.sin(two.hole.azimuth - one.hole.azimuth)
    r1 += math.copysign(1.0, turn) * one.hole.across
    r2 -= math.copysign(1.0, turn) * two.hole.across
    # Both strips avoid the axis. Seen along the axis they are apart when the line through the
    # axis that halves their directions has one on each side: the inner corners decide.
    half = apart / 2.0
    clear_one = q1 * math.sin(half) - r1 * math.cos(half)
    clear_two = q2 * math.sin(half) - r2 * math.cos(half)
    return clear_one < 0.0 or clear_two < 0.0


def _check_mark(shape: NodeShape, found: list[Drill]) -> None:
    mark = shape.mark
    if mark is None:
        return
    r = mark.diameter / 2.0
    reach = min(
        [shape.radius - mark.x]
        + [s.distance - mark.x * math.cos(s.azimuth) for s in shape.seats]
        + ([mark.x - shape.bore] if shape.bore else [])
    )
    if r >= reach or not 0.0 < mark.depth < shape.z1 - shape.z0:
        raise DetailError(
            f"the reference mark of {mark.diameter:.6g} mm at x = {mark.x:.6g} mm, "
            f"{mark.depth:.6g} mm deep, leaves the top face: {2 * reach:.6g} mm are free there"
        )
    for k, drill in enumerate(found):
        inner, radius = _strip(shape, drill)
        along = mark.x * math.cos(drill.hole.azimuth)
        across = abs(mark.x * math.sin(drill.hole.azimuth) + drill.hole.across)
        below = drill.hole.z + radius < shape.z1 - mark.depth
        if not below and along + r >= inner and across < r + radius:
            raise DetailError(
                f"the reference mark runs into radial hole {k}: make it less than "
                f"{shape.z1 - drill.hole.z - radius:.6g} mm deep"
            )


def node_geometry(shape: NodeShape) -> Boundary | Cut:
    """Exact boundary of a node, or the cut that drills its other holes.

    Raises
    ------
    DetailError
        Seats, bore, holes or mark do not fit.
    """
    return node_boundary(shape) if node_is_exact(shape) else node_cut(shape)


def node_cut(shape: NodeShape) -> Cut:
    """A node without its holes into the bore or in its round surface, and their cylinders."""
    blank, found = node_boundary(shape, blank=True), drills(shape)
    tools = []
    for drill in found:
        if drill.exact:
            continue
        foot = 0.0 if drill.bottom is None else drill.bottom
        c, s = math.cos(drill.hole.azimuth), math.sin(drill.hole.azimuth)
        direction: Vec = (c, s, 0.0)
        side: Vec = (-s * drill.hole.across, c * drill.hole.across, drill.hole.z)
        origin = add(side, direction, foot)
        height = shape.radius + OVERLAP - foot
        tools.append(Tool(origin, direction, (0.0, 0.0, 1.0), drill.hole.diameter / 2, height))
    # A blind hole changes no handle; each hole into the bore adds one.
    through = sum(drill.bottom is None for drill in found)
    return Cut(blank, tuple(tools), blank.genus + through)


def node_boundary(shape: NodeShape, *, blank: bool = False) -> Boundary:
    """Exact boundary of a node; `blank` leaves out the holes that have no exact boundary.

    Raises
    ------
    DetailError
        Seats, bore, holes or mark do not fit.
    """
    section = [segments(loop) for loop in node_section(shape)]
    found = drills(shape)
    check_holes(shape, found)
    # The lines of the outline are the seats, in order of azimuth.
    flats = [k for k, segment in enumerate(section[0]) if segment.turn == 0.0]
    order = seat_order(shape)
    builder = BoundaryBuilder()
    side_holes: dict[tuple[int, int], list[Coedges]] = {}
    for drill in found:
        if drill.seat is None:
            if blank:
                continue
            raise DetailError("a hole in the round surface has no exact boundary")
        hole, seat = drill.hole, shape.seats[drill.seat]
        c, s = math.cos(seat.azimuth), math.sin(seat.azimuth)
        side: Vec = (-s * hole.across, c * hole.across, hole.z)
        mouth = add(side, (c, s, 0.0), seat.distance)
        flat, up, r = flats[order.index(drill.seat)], (0.0, 0.0, 1.0), hole.diameter / 2.0
        if drill.bottom is None:
            onto = ((0.0, 0.0, 0.0), up, shape.bore)
            loop, inner = builder.hole_into(mouth, (-c, -s, 0.0), up, r, onto)
            side_holes.setdefault((1, bore_face(section[1], hole)), []).append(inner)
        else:
            bottom = add(side, (c, s, 0.0), drill.bottom)
            loop = builder.blind_hole(mouth, bottom, up, r)
        side_holes.setdefault((0, flat), []).append(loop)
    top: list[Coedges] = []
    if shape.mark is not None:
        x, z = shape.mark.x, shape.z1
        top.append(
            builder.blind_hole(
                (x, 0.0, z),
                (x, 0.0, z - shape.mark.depth),
                (1.0, 0.0, 0.0),
                shape.mark.diameter / 2,
            )
        )
    start, end = End(shape.z0, 0.0, None, -1.0), End(shape.z1, 0.0, None, 1.0)
    sweep(builder, frame, section, start, end, side_holes, top)
    return builder.build()

"""Parts with connections the way build123d's documentation suggests; see `naive.py`."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import build123d as b3
import naive

from fabrication.parts.beam import BeamShape, EndCut
from fabrication.parts.beam.end_plate import bar_of
from fabrication.parts.node import NodeShape
from fabrication.parts.spool import SpoolShape
from fabrication.parts.star import StarShape
from fabrication.specs import Shape
from fabrication.standards.profiles import z_range


def at_cut(cut: EndCut, outward: float, z: float) -> b3.Plane:
    """A plane in the cut at a height: z inwards along the beam, y up along the cut."""
    n = math.hypot(1.0, cut.slope)
    inwards = (-outward / n, 0.0, outward * cut.slope / n)
    up = (cut.slope / n, 0.0, 1.0 / n)
    across = tuple(b3.Vector(*up).cross(b3.Vector(*inwards)))
    return b3.Plane((cut.x + cut.slope * z, 0.0, z), x_dir=across, z_dir=inwards)


def stud_end(body: Any, shape: BeamShape, cut: EndCut, outward: float) -> Any:
    """A hole through the end, and the window behind it, or a plate and a hand hole."""
    stud, plane = cut.stud, at_cut(cut, outward, cut.stud.z)
    low, high = z_range(shape.profile)
    wide = shape.profile.width
    if len(shape.profile.loops) > 1:
        square = b3.Plane((cut.x, 0, 0), x_dir=(0, 1, 0), z_dir=(1, 0, 0))
        inner = naive.outline(shape.profile.loops[1], square)
        body += b3.extrude(inner, amount=stud.plate, dir=(-outward, 0, 0))
        hand = b3.Pos(cut.x - outward * (stud.plate + 0.5 * stud.length + 5.0), 0, low)
        hole = b3.Box(stud.length, stud.height, 0.4 * (high - low))
        body -= hand * b3.fillet(hole.edges().filter_by(b3.Axis.Z), stud.corner)
    else:
        window = b3.Box(2 * wide, stud.height, stud.length)
        window = b3.fillet(window.edges().filter_by(b3.Axis.X), stud.corner)
        body -= plane * b3.Pos(0, 0, stud.plate + 0.5 * stud.length) * window
    return body - plane * b3.Cylinder(0.5 * stud.diameter, 4 * stud.plate)


def plate_end(body: Any, cut: EndCut, outward: float) -> Any:
    """A plate across the end, with its holes."""
    plate = cut.plate
    box = b3.Pos(0, 0, 0.5 * plate.thickness) * b3.Box(plate.width, plate.height, plate.thickness)
    for y, w in plate.holes:
        box -= b3.Pos(y, w, 0) * b3.Cylinder(0.5 * plate.diameter, 4 * plate.thickness)
    return body + at_cut(cut, outward, plate.z) * box


def comb_end(body: Any, shape: BeamShape, cut: EndCut, outward: float) -> Any:
    """Two slots from side to side, and bolts with recesses along the cut."""
    comb, wide = cut.comb, shape.profile.width
    plane = at_cut(cut, outward, comb.z)
    for low, high in comb.slots:
        slot = b3.Box(2 * wide, high - low, 2 * comb.depth)
        body -= plane * b3.Pos(0, 0.5 * (low + high), 0) * slot
    floors, far = comb.floors, 2 * shape.profile.depth
    for step in comb.steps:
        bolt = plane * b3.Pos(0, comb.offset, step) * b3.Rot(90, 0, 0)
        body -= bolt * b3.Cylinder(0.5 * comb.diameter, far)
        for floor, side in zip(floors, (-1.0, 1.0), strict=True):
            recess = plane * b3.Pos(0, floor + 0.5 * side * far, step) * b3.Rot(90, 0, 0)
            body -= recess * b3.Cylinder(0.5 * comb.recess, far)
    return body


def beam(shape: BeamShape) -> Any:
    """The bar, and then both ends."""
    plain = bar_of(shape)
    body = naive.beam(replace(plain, start=_bare(plain.start), end=_bare(plain.end)))
    for cut, outward in ((shape.start, -1.0), (shape.end, 1.0)):
        if cut.stud is not None:
            body = stud_end(body, shape, cut, outward)
        if cut.plate is not None:
            body = plate_end(body, cut, outward)
        if cut.comb is not None:
            body = comb_end(body, shape, cut, outward)
        if cut.slot is not None:
            low, high = z_range(shape.profile)
            slot = b3.Box(cut.slot.width, 4 * (high - low), 2 * cut.slot.depth)
            body -= at_cut(cut, outward, 0.5 * (low + high)) * slot
    return body


def _bare(cut: EndCut) -> EndCut:
    return EndCut(cut.x, cut.slope, cut.radius)


def node(shape: NodeShape) -> Any:
    """The node without holes, and each hole from its seat."""
    body = naive.node(replace(shape, holes=()))
    for hole in shape.holes:
        turns = [abs(math.remainder(s.azimuth - hole.azimuth, 2 * math.pi)) for s in shape.seats]
        seat = shape.seats[turns.index(min(turns))]
        depth = hole.depth or seat.distance - shape.bore
        turned = b3.Rot(0, 0, math.degrees(hole.azimuth))
        place = b3.Pos(seat.distance - 0.5 * depth + 1.0, hole.across, hole.z) * b3.Rot(0, 90, 0)
        body -= turned * place * b3.Cylinder(0.5 * hole.diameter, depth + 2.0)
    return body


def star(shape: StarShape) -> Any:
    """A box an arm, a cylinder a hole."""
    height, middle = shape.z1 - shape.z0, 0.5 * (shape.z0 + shape.z1)
    arms = []
    for azimuth in shape.azimuths:
        plate = b3.Box(shape.length, shape.thickness, height)
        arms.append(
            b3.Rot(0, 0, math.degrees(azimuth)) * b3.Pos(0.5 * shape.length, 0, middle) * plate
        )
    body = arms[0]
    for arm in arms[1:]:
        body += arm
    for hole in shape.holes:
        turned = b3.Rot(0, 0, math.degrees(shape.azimuths[hole.arm]))
        place = turned * b3.Pos(hole.distance, 0, hole.z) * b3.Rot(90, 0, 0)
        body -= place * b3.Cylinder(0.5 * shape.diameter, 4 * shape.thickness)
    mark = shape.mark
    return body - b3.Pos(mark.x, 0, shape.z1) * b3.Cylinder(0.5 * mark.diameter, 2 * mark.depth)


def spool(shape: SpoolShape) -> Any:
    """Two discs of strips with their holes, and the core between them."""
    t = shape.thickness
    body = None
    for low in (shape.z0, shape.z1 - t):
        disc = None
        for azimuth in shape.azimuths:
            strip = b3.Pos(0.5 * (shape.length - 0.5 * shape.width), 0, low + 0.5 * t) * b3.Box(
                shape.length + 0.5 * shape.width, shape.width, t
            )
            strip = b3.Rot(0, 0, math.degrees(azimuth)) * strip
            disc = strip if disc is None else disc + strip
        for azimuth in shape.azimuths:
            for step in shape.steps:
                place = b3.Rot(0, 0, math.degrees(azimuth)) * b3.Pos(step, 0, low)
                disc -= place * b3.Cylinder(0.5 * shape.diameter, 4 * t)
        body = disc if body is None else body + disc
    height = shape.z1 - shape.z0 - 2 * t
    body += b3.Pos(0, 0, 0.5 * (shape.z0 + shape.z1)) * b3.Cylinder(shape.core, height)
    mark = shape.mark
    return body - b3.Pos(mark.x, 0, shape.z1) * b3.Cylinder(0.5 * mark.diameter, 2 * mark.depth)


def solid(shape: Shape) -> Any:
    """A part of any kind."""
    if isinstance(shape, BeamShape):
        return beam(shape)
    if isinstance(shape, NodeShape):
        return node(shape)
    return star(shape) if isinstance(shape, StarShape) else spool(shape)

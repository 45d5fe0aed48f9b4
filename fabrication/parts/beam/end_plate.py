"""End plates of beams: a plate across a flat cut, wider and higher than the bar, with bolt holes.

The bar is welded to the plate and ends at its inner face. A hollow section has a round hole in the
middle of the plate, through which zinc and air leave it.
"""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ddgfab.errors import DetailError
from fabrication.boundary import Vec
from fabrication.parts.beam.straps import bar_end, strap_holes
from fabrication.parts.beam.stud import along
from fabrication.solids.builder import BoundaryBuilder, Coedges, add, scale
from fabrication.solids.section import Segment, distance_to
from fabrication.solids.sweep import End, Frame
from fabrication.variants import key_of

if TYPE_CHECKING:
    from fabrication.parts.beam.shape import BeamShape, EndCut, PlateEnd


def plate_key(plate: PlateEnd) -> Hashable:
    """What must agree exactly for two plates to be equal."""
    sizes = (plate.z, plate.width, plate.height, plate.thickness, plate.diameter, plate.vent)
    return (*map(key_of, sizes), tuple((key_of(y), key_of(w)) for y, w in plate.holes))


def bar_of(shape: BeamShape) -> BeamShape:
    """The bar between plates or straps, without them and the holes in straps."""

    def bare(cut: EndCut, outward: float) -> EndCut:
        if cut.straps is not None:
            return replace(cut, x=bar_end(cut, outward), straps=None)
        if cut.plate is None:
            return cut
        return replace(cut, x=inner_end(cut, outward).at, plate=None)

    others = [
        hole
        for cut, outward in ((shape.start, -1.0), (shape.end, 1.0))
        if cut.straps is not None
        for hole in strap_holes(shape, cut, outward)
    ]
    holes = tuple(hole for hole in shape.holes if hole not in others)
    return replace(shape, start=bare(shape.start, -1.0), end=bare(shape.end, 1.0), holes=holes)


def inner_end(cut: EndCut, outward: float) -> End:
    """The inner face of the plate, at which the bar ends; the cut itself without a plate."""
    thickness = 0.0 if cut.plate is None else cut.plate.thickness
    x = cut.x - outward * thickness * math.hypot(1.0, cut.slope)
    return End(x, cut.slope, None, outward)


def plate_volume(plate: PlateEnd) -> float:
    """Volume [mm3] of a plate less its holes."""
    holes = len(plate.holes) * plate.diameter**2 + plate.vent**2
    return plate.thickness * (plate.width * plate.height - 0.25 * math.pi * holes)


def plate_details(plate: PlateEnd, low: float, name: str) -> dict[str, Any]:
    """Columns of a schedule; name: "start" or "end", low: bottom of the profile [mm]."""
    ys, ws = ({key_of(hole[k]) for hole in plate.holes} for k in (0, 1))
    return {
        f"plate_{name}_mm": plate.thickness,
        f"plate_{name}_width_mm": plate.width,
        f"plate_{name}_height_mm": plate.height,
        f"hole_{name}_up_mm": plate.z - low,
        f"hole_{name}_diameter_mm": plate.diameter,
        f"hole_{name}_count": len(plate.holes),
        f"hole_{name}_across_mm": max(ys) - min(ys),
        f"hole_{name}_along_mm": max(ws) - min(ws),
        **({f"vent_{name}_mm": plate.vent} if plate.vent else {}),
    }


def plate_faces(
    builder: BoundaryBuilder,
    frame: Frame,
    cut: EndCut,
    outward: float,
    end: End,
    around: list[Coedges],
) -> None:
    """Faces of a plate whose inner face has the outlines of the bar, `around`, on it."""
    plate = cut.plate
    assert plate is not None
    (ix, iz), (ux, uz) = along(cut, outward)
    inwards: Vec = (ix, 0.0, iz)
    middle: Vec = (cut.x + cut.slope * plate.z, 0.0, plate.z)

    def at(y: float, w: float, depth: float) -> Vec:
        return add((middle[0] + w * ux, y, middle[2] + w * uz), inwards, depth)

    y, w, t = 0.5 * plate.width, 0.5 * plate.height, plate.thickness
    # counterclockwise seen from outside, looking along `inwards`
    corners = [(-y, -w), (y, -w), (y, w), (-y, w)]
    if outward < 0.0:
        corners.reverse()
    front = [builder.point(at(*corner, 0.0)) for corner in corners]
    back = [builder.point(at(*corner, t)) for corner in corners]
    count = len(corners)
    front_ring = [builder.line(front[k], front[(k + 1) % count]) for k in range(count)]
    back_ring = [builder.line(back[-k], back[-k - 1]) for k in range(count)]
    fronts, backs, cavity = [front_ring], [back_ring, around[0]], list(around[1:])
    holes = [(*hole, plate.diameter) for hole in plate.holes]
    for k, (v, u, diameter) in enumerate([*holes, (0.0, 0.0, plate.vent)]):
        if not diameter:
            continue
        mouth, inner = builder.round_hole(
            at(v, u, 0.0), at(v, u, t), (0.0, 1.0, 0.0), 0.5 * diameter
        )
        fronts.append(mouth)
        (cavity if k == len(holes) else backs).append(inner)
    normal = scale(inwards, -1.0)
    builder.plane(normal, fronts)
    builder.plane(inwards, backs)
    for k in range(count):
        j = (k + 1) % count
        side = add(builder.position(front[j]), builder.position(front[k]), -1.0)
        length = math.sqrt(sum(x * x for x in side))
        across: Vec = (
            (side[1] * normal[2] - side[2] * normal[1]) / length,
            (side[2] * normal[0] - side[0] * normal[2]) / length,
            (side[0] * normal[1] - side[1] * normal[0]) / length,
        )
        builder.plane(
            across,
            [
                [
                    builder.line(front[k], back[k]),
                    builder.line(back[k], back[j]),
                    builder.line(back[j], front[j]),
                    builder.line(front[j], front[k]),
                ]
            ],
        )
    if cavity:
        end.face(builder, frame, cavity, cavity=True)


def check_plates(shape: BeamShape, loops: list[list[Segment]]) -> None:
    """Raise `DetailError` where a plate does not fit its bar, or a hole the plate."""
    bounds = [s.bounds() for s in loops[0]]
    wide = max(max(-left, right) for left, right, _, _ in bounds)
    low, high = min(b[2] for b in bounds), max(b[3] for b in bounds)
    for name, cut, outward in (("start", shape.start, -1.0), ("end", shape.end, 1.0)):
        plate = cut.plate
        if plate is None:
            continue
        if cut.radius is not None or cut.skew != 0.0 or cut.stud is not None or cut.slot:
            raise DetailError(f"the {name} has a plate, but its cut is coped or skew")
        if len(loops) > 2 or (plate.vent > 0.0) != (len(loops) > 1):
            raise DetailError(
                f"the {name} of {shape.profile.name} has a plate; a hollow section has one hole "
                "in it, any other none"
            )
        n = math.hypot(1.0, cut.slope)
        shift = plate.thickness * outward * cut.slope
        reach = max(abs(n * (z - plate.z) - shift) for z in (low, high))
        if 2.0 * wide >= plate.width or 2.0 * reach >= plate.height:
            raise DetailError(
                f"the {name} has a plate of {plate.width:.6g} x {plate.height:.6g} mm, but the "
                f"bar takes {2.0 * wide:.6g} x {2.0 * reach:.6g} mm of it"
            )
        radius = 0.5 * plate.diameter
        for k, (y, w) in enumerate(plate.holes):
            edge = min(0.5 * plate.width - abs(y), 0.5 * plate.height - abs(w))
            z = plate.z + (w + shift) / n
            bar = distance_to(loops[0], y, z)
            inside = abs(y) < wide and low < z < high
            if edge <= radius or inside or bar * min(n, 1.0) <= radius:
                raise DetailError(
                    f"hole {k} of the plate at the {name} is {edge:.6g} mm from its edge and "
                    f"{0.0 if inside else bar:.6g} mm from the bar: both must be more than its "
                    f"radius, {radius:.6g} mm"
                )
            for other in plate.holes[:k]:
                if math.dist(other, (y, w)) <= plate.diameter:
                    raise DetailError(f"two holes of the plate at the {name} overlap")
        if plate.vent:
            room = distance_to(loops[1], 0.0, plate.z + shift / n)
            if room <= 0.5 * plate.vent:
                raise DetailError(
                    f"the hole of {plate.vent:.6g} mm in the middle of the plate at the {name} "
                    f"leaves the cavity, which has {room:.6g} mm about it"
                )


def vent_of(loops: list[list[Segment]]) -> float:
    """Diameter [mm] of the hole that opens a hollow section: a quarter of its inside's width."""
    bounds = [s.bounds() for s in loops[1]]
    wide = max(b[1] for b in bounds) - min(b[0] for b in bounds)
    high = max(b[3] for b in bounds) - min(b[2] for b in bounds)
    return 2.0 * round(0.125 * min(wide, high))

"""One table of shapes for all tests of fabrication.solids, each with its genus."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from fabrication.parts.beam import BeamShape, CrossHole, EndCut, SlotEnd, StudEnd
from fabrication.parts.coupon import CouponShape
from fabrication.parts.fastener import FastenerShape, bolt, nut, stud, washer
from fabrication.parts.link import LinkShape
from fabrication.parts.node import NodeShape, RadialHole, ReferenceMark, Seat
from fabrication.parts.panel import PanelShape
from fabrication.parts.pin import PinShape
from fabrication.parts.ring import RingShape
from fabrication.parts.star import StarShape, TongueHole
from fabrication.solids.text import Label
from fabrication.specs import Loop, Profile, Shape
from fabrication.standards.fasteners import fastener

QUARTER = math.tan(math.pi / 8)  # bulge of a quarter circle


def polygon_loop(points: list[tuple[float, float]]) -> Loop:
    return Loop(np.array(points, dtype=float), np.zeros(len(points)))


def rounded_rectangle(width: float, depth: float, radius: float, *, hole: bool = False) -> Loop:
    w, h, r = width / 2, depth / 2, radius
    points = [
        (-w + r, -h), (w - r, -h), (w, -h + r), (w, h - r),
        (w - r, h), (-w + r, h), (-w, h - r), (-w, -h + r),
    ]  # fmt: skip
    bulges = [0.0, QUARTER] * 4
    if hole:  # the same loop clockwise: segment k now runs from point k to the one before
        points = points[::-1]
        bulges = [-b for b in [*bulges[:-1][::-1], bulges[-1]]]
    return Loop(np.array(points), np.array(bulges))


FLAT = Profile(
    "FL 60x8", (polygon_loop([(-4, -30), (4, -30), (4, 30), (-4, 30)]),), width=8, depth=60
)
RHS = Profile(
    "RHS 120x60x5",
    (rounded_rectangle(60, 120, 10), rounded_rectangle(50, 110, 5, hole=True)),
    width=60,
    depth=120,
)
SHARP_RHS = Profile(
    "box 120x60x5",
    (
        polygon_loop([(-30, -60), (30, -60), (30, 60), (-30, 60)]),
        polygon_loop([(-25, -55), (-25, 55), (25, 55), (25, -55)]),
    ),
    width=60,
    depth=120,
)
T_BAR = Profile(
    "T 80",
    (
        polygon_loop(
            [(-4, -60), (4, -60), (4, 12), (40, 12), (40, 20), (-40, 20), (-40, 12), (-4, 12)]
        ),
    ),
    width=80,
    depth=80,
)
FREE = Profile(
    "free",
    (polygon_loop([(-10, -40), (12, -35), (25, 0), (8, 45), (-6, 45), (-3, 5), (-20, -5)]),),
    width=50,
    depth=100,
)


def beam(
    profile: Profile,
    start: float | None = None,
    end: float | None = None,
    slopes: tuple[float, float] = (0.12, -0.3),
    holes: tuple[CrossHole, ...] = (),
) -> BeamShape:
    return BeamShape(profile, EndCut(62.0, slopes[0], start), EndCut(1170.0, slopes[1], end), holes)


HOLES = (CrossHole(200.0, -5.0, 13.0), CrossHole(1000.0, -15.0, 9.0))

BEAMS: dict[str, tuple[BeamShape, int]] = {
    "bar square": (beam(FLAT, slopes=(0.0, 0.0)), 0),
    "bar mitred": (beam(FLAT), 0),
    "bar coped": (beam(FLAT, 50.0, 60.0), 0),
    "bar coped square": (beam(FLAT, 50.0, 60.0, slopes=(0.0, 0.0)), 0),
    "bar mixed holes": (beam(FLAT, None, 45.0, holes=HOLES), 2),
    "bar coped holes": (beam(FLAT, 45.0, 45.0, holes=HOLES), 2),
    "rhs mitred": (beam(RHS), 1),
    "rhs holes": (beam(RHS, holes=HOLES), 5),
    "box coped": (beam(SHARP_RHS, 60.0, 45.0), 1),
    "box coped holes": (beam(SHARP_RHS, 60.0, 31.0, holes=HOLES), 5),
    "tee mitred": (beam(T_BAR), 0),
    "tee coped": (beam(T_BAR, 55.0, 41.0, holes=HOLES), 2),
    "free flat": (beam(FREE), 0),
    "free coped": (beam(FREE, 26.0, 70.0), 0),
    "free mixed": (beam(FREE, 40.0, None, slopes=(0.5, 0.0)), 0),
}


def node(
    valence: int,
    *,
    bore: float = 0.0,
    holes: bool = False,
    mark: bool = False,
    through: bool = False,
    radius: float = 80.0,
) -> NodeShape:
    # Azimuths that are not regular, the first at the reference.
    azimuths = [2 * math.pi * k / valence + 0.07 * math.sin(3.0 * k) for k in range(valence)]
    seats = tuple(Seat(a, math.sqrt(radius**2 - 20.0**2), 40.0) for a in azimuths)
    drilled = tuple(
        RadialHole(a, 3.0 * (-1) ** k, 13.0, None if through else 18.0 + k)
        for k, a in enumerate(azimuths)
    )
    return NodeShape(
        radius,
        bore,
        -45.0,
        52.0,
        seats,
        drilled if holes else (),
        ReferenceMark(radius - 25.0, 4.0, 3.0) if mark else None,
    )


NODES: dict[str, tuple[NodeShape, int]] = {
    "cylinder": (NodeShape(60.0, 0.0, -40.0, 45.0), 0),
    "tube": (NodeShape(60.0, 50.0, -40.0, 45.0, mark=ReferenceMark(55.0, 3.0, 2.0)), 1),
    "one seat": (NodeShape(60.0, 20.0, -40.0, 45.0, (Seat(2.5, 55.0, 47.958),)), 1),
    "valence 3": (node(3), 0),
    "valence 3 bored": (node(3, bore=30.0, mark=True), 1),
    "valence 4 bored": (node(4, bore=30.0), 1),
    "valence 4 holes": (node(4, holes=True, mark=True), 0),
    "valence 5 holes": (node(5, bore=40.0, holes=True, mark=True), 1),
    "valence 6 holes": (node(6, bore=25.0, holes=True, mark=True), 1),
    "touching seats": (
        # Four seats whose flats take a quarter turn each: a square bar.
        NodeShape(
            50.0,
            0.0,
            0.0,
            80.0,
            tuple(Seat(k * math.pi / 2, 50.0 * math.cos(math.pi / 4), 70.7107) for k in range(4)),
        ),
        0,
    ),
}


def inset(polygon: np.ndarray, distances: list[float]) -> np.ndarray:
    """The polygon with side k moved inwards: corners by intersecting lines."""
    along = np.roll(polygon, -1, axis=0) - polygon
    inward = np.column_stack([-along[:, 1], along[:, 0]])
    inward /= np.linalg.norm(inward, axis=1)[:, None]
    level = np.sum(inward * polygon, axis=1) + np.array(distances)
    return np.array(
        [
            np.linalg.solve([inward[k - 1], inward[k]], [level[k - 1], level[k]])
            for k in range(len(polygon))
        ]
    )


TRI = np.array([(0.0, 0.0), (1400.0, 100.0), (500.0, 1200.0)])
QUAD = np.array([(-20.0, 0.0), (1500.0, 40.0), (1450.0, 900.0), (100.0, 1000.0)])
PENTA = np.array([(0.0, 0.0), (900.0, -80.0), (1300.0, 500.0), (600.0, 1100.0), (-100.0, 700.0)])
LSHAPE = np.array([(0, 0), (1000, 0), (1000, 400), (500, 420), (480, 1000), (0, 1000)], dtype=float)
IN_LINE = np.array([(0.0, 0.0), (500.0, 0.0), (1000.0, 0.0), (900.0, 800.0)])


def panel(
    polygon: np.ndarray, mitre: list[float] | None = None, radius: float = 0.0, t: float = 12.0
) -> PanelShape:
    return PanelShape(t, polygon, polygon if mitre is None else inset(polygon, mitre), radius)


PANELS: dict[str, tuple[PanelShape, int]] = {
    "tri square": (panel(TRI), 0),
    "tri mitred round": (panel(TRI, [3.0, -2.0, 5.0], 8.0), 0),
    "quad square": (panel(QUAD), 0),
    "quad round": (panel(QUAD, None, 20.0), 0),
    "quad mitred": (panel(QUAD, [3.0, 4.0, -2.0, 6.0]), 0),
    "quad mitred round": (panel(QUAD, [3.0, 4.0, -2.0, 6.0], 15.0, 30.0), 0),
    "penta mitred": (panel(PENTA, [1.0, 2.0, 3.0, 4.0, 5.0]), 0),
    "penta mitred round": (panel(PENTA, [1.0, 2.0, 3.0, 4.0, 5.0], 10.0), 0),
    "reflex round": (panel(LSHAPE, [2.0, -3.0, 4.0, 5.0, -1.0, 2.0], 25.0, 20.0), 0),
    "corner in line": (panel(IN_LINE, None, 10.0), 0),
}

# Seats that touch but for rounding, either way: the corner is where their planes meet.
for _name, _shift in (("a hair apart", 4e-7), ("a hair over", -4e-7)):
    NODES[f"seats {_name}"] = (
        NodeShape(
            50.0,
            12.0,
            0.0,
            80.0,
            tuple(
                Seat(k * math.pi / 2, 50.0 * math.cos(math.pi / 4 - _shift), 70.7) for k in range(4)
            ),
        ),
        1,
    )


def link(
    degrees: float,
    start: float = 0.0,
    end: float = 0.0,
    *,
    length: float = 100.0,
    label: Label | None = None,
    **other: float,
) -> LinkShape:
    sizes = {"bar_width": 5.0, "bar_height": 5.0, "bevel": 1.0, "eye_height": 6.0} | other
    eye, bores = sizes.pop("eye_diameter", 10.0), (3.4, sizes.pop("bore", 3.4))
    return LinkShape(
        length, math.radians(degrees), start, end, eye, bores=bores, label=label, **sizes
    )


LINKS: dict[str, tuple[LinkShape, int]] = {
    "straight": (link(0.0), 2),  # all but the bevels are parallel to the axes
    "bennett a": (link(40.0, -3.2, -3.2), 2),
    "bennett b": (link(70.0, 3.2, 3.2, length=146.2), 2),
    "left hand": (link(-70.0, 3.2, 3.2, length=146.2), 2),
    "short on level 3": (link(22.5, 9.6, 9.6, length=38.2683), 2),
    "slanted": (link(-22.5, -3.2, 6.4, length=60.0), 2),
    "right angle": (link(90.0), 2),  # bevels parallel to the axes
    "right angle off": (link(90.0, -3.2, -3.2), 2),
    "sharp section": (link(35.0, bar_width=4.0, bar_height=4.0, bevel=0.0), 2),
    "flat section": (link(-50.0, 3.2, 3.2, bar_width=6.0, bar_height=3.0, bevel=0.4), 2),
    "two bores": (link(30.0, bore=5.0), 2),
    "engraved": (link(40.0, 3.2, 3.2, label=Label("L1068", 0.5, 0.6)), 2),
    "engraved stacked": (link(-40.0, 3.2, 3.2, label=Label("L12", 0.8, 0.6, True)), 2),
    "embossed": (link(40.0, 3.2, 3.2, label=Label("L4.9-8", 0.5, -0.5)), 2),
    "embossed stacked": (link(10.0, label=Label("HCPT 0", 0.7, -0.5, True)), 2),
}
OTHERS: dict[str, tuple[PinShape | RingShape | CouponShape, int]] = {
    "rod": (PinShape(3.0, 21.2), 0),
    "pin with head": (PinShape(4.0, 17.2, 7.0, 2.0), 0),
    "spacer": (RingShape(10.0, 3.4, 6.0), 1),
    "cap": (RingShape(6.0, 3.1, 4.2, 1.2), 0),
    "coupon": (CouponShape((3.2, 3.3, 3.4), 7.0, 12.0, 6.0), 3),
    "coupon with labels": (
        CouponShape((3.2, 3.4), 8.0, 14.0, 6.0, (Label("10", 0.6, 0.6), Label("20", 0.6, 0.6))),
        2,
    ),
}

THICK = Profile(
    "FL 90x40", (polygon_loop([(-20, -90), (20, -90), (20, 0), (-20, 0)]),), width=40, depth=90
)
STUD = StudEnd(-45.0, 13.5, 15.0, 55.0, 39.6, 5.0)
STUD_RHS = StudEnd(0.0, 13.5, 15.0, 55.0, 36.0, 5.0)
M12 = fastener("M12")
SLOT = SlotEnd(16.0, 87.0)
SLOT_HOLES = (
    CrossHole(25.0, -45.0, 13.5),
    CrossHole(60.0, -45.0, 13.5),
    CrossHole(1000.0, -30.0, 9.0),
)


def star(*azimuths: float) -> StarShape:
    holes = tuple(
        TongueHole(k, far, -40.0 + k) for k in range(len(azimuths)) for far in (65.0, 95.0)
    )
    return StarShape(
        15.0, 120.0, -70.0, -10.0, azimuths, 13.5, holes, ReferenceMark(20.0, 3.0, 1.0)
    )


STUDS: dict[str, tuple[BeamShape | FastenerShape | StarShape, int]] = {
    "studs in a bar": (
        BeamShape(THICK, EndCut(0.0, 0.12, stud=STUD), EndCut(1100.0, -0.3, stud=STUD)),
        4,
    ),
    "stud and plain end": (
        BeamShape(THICK, EndCut(0.0, 0.0, stud=STUD), EndCut(1100.0, 0.2), HOLES[1:]),
        3,
    ),
    "studs in a tube": (
        BeamShape(RHS, EndCut(10.0, 0.2, stud=STUD_RHS), EndCut(900.0, 0.0, stud=STUD_RHS)),
        3,
    ),
    "plain end and stud in a tube": (
        BeamShape(RHS, EndCut(10.0, 0.2), EndCut(900.0, -0.1, stud=STUD_RHS)),
        2,
    ),
    "slots": (
        BeamShape(THICK, EndCut(0.0, 0.12, slot=SLOT), EndCut(1100.0, -0.3, slot=SLOT), SLOT_HOLES),
        5,
    ),
    "slot and plain end": (
        BeamShape(THICK, EndCut(0.0, 0.0, slot=SLOT), EndCut(1100.0, 0.2), SLOT_HOLES),
        5,
    ),
    "star of four": (star(0.0, 1.4, 3.0, 4.8), 8),
    "star of two": (star(0.0, 1.6), 4),
    "star in line": (star(0.0, 1.5, math.pi), 6),
    "star of six": (star(0.0, 1.0, 2.1, 3.2, 4.3, 5.3), 12),
    "bolt": (bolt(M12, 45.0), 0),
    "stud": (stud(M12, 55.0), 0),
    "nut": (nut(M12), 1),
    "washer": (washer(M12), 1),
}

CROSSED: dict[str, tuple[Shape, int]] = {
    "rhs coped": (beam(RHS, 62.0, 70.0), 1),
    "rhs mixed holes": (beam(RHS, None, 40.0, holes=HOLES), 5),
    "through on seats": (node(4, bore=50.0, holes=True, through=True), 5),
    "through in rows": (
        NodeShape(
            70.0, 46.0, -60.0, 50.0, (Seat(0.2, 62.0, 50.0), Seat(2.0, 62.0, 50.0)),
            tuple(RadialHole(a, z, 10.2, None, y)
                  for a in (0.2, 2.0) for z in (-30.0, 12.0) for y in (-15.0, 15.0)),
            ReferenceMark(54.0, 3.0, 2.0),
        ),
        9,
    ),
}  # fmt: skip
"""Shapes with curves where two cylinders cross."""

EXACT: dict[str, tuple[Shape, int]] = {
    **BEAMS,
    **NODES,
    **PANELS,
    **LINKS,
    **OTHERS,
    **STUDS,
    **CROSSED,
}

TUBE = NodeShape(60.0, 50.0, -40.0, 45.0)

CUT: dict[str, tuple[Shape, int]] = {
    "through tube": (replace(TUBE, holes=(RadialHole(0.4, 3.0, 14.0, None),)), 2),
    "blind on round": (replace(TUBE, bore=0.0, holes=(RadialHole(0.4, 3.0, 14.0, 20.0),)), 0),
}
"""Shapes without an exact boundary."""

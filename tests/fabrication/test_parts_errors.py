"""Shapes that cannot be made: each is refused with the numbers and what to do."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from parts_table import FLAT, FREE, QUAD, RHS, T_BAR, TUBE, beam, node, panel

from ddgfab.errors import DetailError
from fabrication.parts.beam import CrossHole, EndCut
from fabrication.parts.node import NodeShape, RadialHole, ReferenceMark, Seat
from fabrication.parts.panel import PanelShape
from fabrication.solids import boundary_of, volume_of
from fabrication.specs import Shape


def hole(x: float, z: float, d: float = 13.0) -> tuple[CrossHole, ...]:
    return (CrossHole(x, z, d),)


BORED = node(4, bore=30.0)
FLAT_NODE = node(4)

REFUSED: dict[str, tuple[Callable[[], Shape], str]] = {
    "cuts cross": (
        lambda: replace(beam(FLAT), end=EndCut(70.0, -0.5)),
        "cuts cross: the shortest fibre of profile FL 60x8 has length -10.6 mm",
    ),
    "cope too thin": (lambda: beam(FREE, 20.0), "reaches 25 mm from the middle"),
    "cope too thin for round corners": (lambda: beam(RHS, 30.0), "reaches 30 mm"),
    "hole over the edge": (lambda: beam(FLAT, holes=hole(200.0, 25.0)), "leaves the flat faces"),
    "hole misses": (lambda: beam(FLAT, holes=hole(200.0, 60.0)), "misses profile"),
    "hole in a flange": (lambda: beam(T_BAR, holes=hole(200.0, 16.0)), "leaves the flat faces"),
    "hole in a slanted side": (lambda: beam(FREE, holes=hole(200.0, 20.0)), "leaves the flat"),
    "hole in a round corner": (lambda: beam(RHS, holes=hole(200.0, 47.0)), "leaves the flat"),
    "hole at the start": (lambda: beam(FLAT, holes=hole(66.0, 0.0)), "from the cut at the start"),
    "hole at the mitred end": (
        # The end is at x = 1170 - 0.3 z: at z = 20 it is at 1164.
        lambda: beam(FLAT, holes=hole(1158.0, 20.0)),
        "5.74696 mm from the cut at the end",
    ),
    "hole outside": (lambda: beam(FLAT, holes=hole(1300.0, 0.0)), "from the cut at the end"),
    "holes overlap": (
        lambda: beam(FLAT, holes=hole(200.0, 0.0) + hole(212.0, 0.0)),
        "12 mm apart: they overlap",
    ),
    "hole in a coped round profile": (
        lambda: beam(RHS, 62.0, holes=hole(60.0, 0.0)),
        "from the cut at the start",
    ),
    "seat outside": (lambda: NodeShape(50.0, 0.0, 0.0, 80.0, (Seat(0.0, 51.0, 1.0),)), "seat 0"),
    "seat in the bore": (
        lambda: NodeShape(50.0, 30.0, 0.0, 80.0, (Seat(0.0, 29.0, 81.0),)),
        "outside the wall, 30 to 50 mm",
    ),
    "seats cut": (
        lambda: NodeShape(50.0, 0.0, 0.0, 80.0, (Seat(0.0, 40.0, 60.0), Seat(1.2, 40.0, 60.0))),
        "seats 0 and 1 cut each other",
    ),
    "bore too wide": (lambda: NodeShape(50.0, 50.0, 0.0, 80.0), "not a solid"),
    "no height": (lambda: NodeShape(50.0, 10.0, 80.0, 80.0), "not a solid"),
    "hole over the top": (
        lambda: replace(FLAT_NODE, holes=(RadialHole(0.0, 48.0, 13.0, 10.0),)),
        "radial hole 0 of 13 mm at z = 48 mm leaves the node",
    ),
    "hole wider than its seat": (
        lambda: replace(FLAT_NODE, holes=(RadialHole(0.0, 0.0, 41.0, 10.0),)),
        "wider than the 40 mm it has",
    ),
    "hole runs into a seat": (
        lambda: replace(FLAT_NODE, holes=(RadialHole(0.3, 0.0, 13.0, 10.0),)),
        "wider than the",
    ),
    "blind hole meets the bore": (
        lambda: replace(BORED, holes=(RadialHole(0.0, 0.0, 13.0, 60.0),)),
        "must stay outside the bore's 30 mm",
    ),
    "hole wider than the bore": (
        lambda: replace(TUBE, bore=6.0, holes=(RadialHole(0.0, 0.0, 13.0, None),)),
        "which must be wider than the hole",
    ),
    "through a solid node": (
        lambda: replace(FLAT_NODE, holes=(RadialHole(0.0, 0.0, 13.0, None),)),
        "bore of 0 mm",
    ),
    "neighbouring holes meet": (
        # Four holes of 13 mm meet when they come nearer to the axis than 6.5 / tan(45 deg).
        lambda: replace(
            node(4, radius=60.0),
            seats=tuple(Seat(k * math.pi / 2, 50.0, 66.33) for k in range(4)),
            holes=tuple(RadialHole(k * math.pi / 2, 0.0, 13.0, 44.0) for k in range(4)),
        ),
        "radial holes 0 and 1 run into each other",
    ),
    "mark outside": (
        lambda: replace(FLAT_NODE, mark=ReferenceMark(76.0, 5.0, 2.0)),
        "leaves the top face",
    ),
    "mark over the bore": (
        lambda: replace(BORED, mark=ReferenceMark(31.0, 5.0, 2.0)),
        "leaves the top face",
    ),
    "mark through": (
        lambda: replace(FLAT_NODE, mark=ReferenceMark(50.0, 5.0, 100.0)),
        "100 mm deep",
    ),
    "mark meets a hole": (
        lambda: replace(
            FLAT_NODE,
            holes=(RadialHole(0.0, 40.0, 13.0, 40.0),),
            mark=ReferenceMark(60.0, 5.0, 8.0),
        ),
        "runs into radial hole 0: make it less than 5.5 mm deep",
    ),
    "panel too small for its corners": (
        lambda: panel(np.array([(0, 0), (40.0, 0), (40.0, 30), (0, 30)]), None, 15.5),
        "side 1 of the panel is 30 mm long, 1 mm too short",
    ),
    "panel turned over": (lambda: panel(QUAD[::-1]), "runs clockwise"),
    "panel with a skew side": (
        lambda: PanelShape(10.0, QUAD, QUAD + np.array([[0, 0], [0, 1.0], [0, 0], [0, 0]])),
        "side 0 of the panel is not plane",
    ),
    "panel with a repeated corner": (lambda: panel(QUAD[[0, 1, 1, 2, 3]]), "side 1 of the panel"),
    "panel without thickness": (lambda: panel(QUAD, t=0.0), "thickness 0 mm is not a solid"),
    "panels of different corners": (lambda: PanelShape(10.0, QUAD, QUAD[:3]), "4 and 3 corners"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_is_refused_with_its_numbers(name: str) -> None:
    make, message = REFUSED[name]
    with pytest.raises(DetailError) as caught:
        volume_of(make())
    assert message in str(caught.value)
    assert str(caught.value).count("\n") <= 2


def test_holes_may_pass_on_different_heights() -> None:
    shape = replace(
        node(4, radius=60.0),
        seats=tuple(Seat(k * math.pi / 2, 50.0, 66.33) for k in range(4)),
        holes=tuple(RadialHole(k * math.pi / 2, 20.0 * (-1) ** k, 13.0, 44.0) for k in range(4)),
    )
    boundary = boundary_of(shape)
    assert boundary is not None
    boundary.validate()


def test_hole_near_a_round_corner_is_accepted() -> None:
    # The flat of RHS 120x60x5 with corners of 10 mm ends at z = 50.
    boundary = boundary_of(beam(RHS, holes=hole(200.0, 43.0)))
    assert boundary is not None
    boundary.validate()

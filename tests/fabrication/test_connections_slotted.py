"""Slotted connections: discs of nodes in slots across timber bars, bolts along the node axes."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bolted import off_axis
from connection_cases import CASES, STUD, bolted
from detailing_cases import Case, dome, grid, hexagons, vertical

from ddgfab.errors import DetailError
from fabrication import standards
from fabrication.families import families
from fabrication.gridshell.design import design
from fabrication.gridshell.detailing.gridshell import Gridshell
from fabrication.job.run import make
from fabrication.parts.beam import BeamShape, CombEnd, EndCut
from fabrication.parts.spool import SpoolShape
from fabrication.solids import realise
from fabrication.solids.section import section_area
from fabrication.standards.fasteners import fastener

SLOTTED = {"kind": "slotted"}
TIMBER = {"profile": "FL 200x100", "density": 420.0}


def timber(case: Case, **sections: Any) -> Gridshell:
    return bolted(
        case,
        **{"beam": TIMBER, "node": {"kind": "plates"}, "connection": SLOTTED, **sections},
    )


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("eccentricity", [0.0, 100.0])
def test_bolts_go_through_bar_and_discs(name: str, eccentricity: float) -> None:
    """Holes and slots of the bars, from their shapes, are where the discs and theirs are."""
    shell = timber(CASES[name](), beam={**TIMBER, "eccentricity_mm": eccentricity})
    beams = {beam.mark: beam for beam in shell.beams}
    nodes = {node.mark: node for node in shell.nodes}
    assert len(shell.bolts) == 4 * len(shell.beams)
    used = set()
    for bolt in shell.bolts:
        beam, node = beams[bolt.beam], nodes[bolt.node]
        cut = (beam.shape.start, beam.shape.end)[bolt.end]
        comb, outward = cut.comb, 2 * bolt.end - 1
        n = math.hypot(1.0, cut.slope)
        inwards = np.array([-outward, 0.0, outward * cut.slope]) / n
        up = np.array([cut.slope, 0.0, 1.0]) / n
        turn, shift = beam.placement[:3, :3], beam.placement[:3, 3]
        assert turn @ up == pytest.approx(bolt.axis, abs=1e-12)
        middle = np.array([cut.x + cut.slope * comb.z, 0.0, comb.z]) + comb.offset * up
        feet = [turn @ (middle + step * inwards) + shift for step in comb.steps]
        off = [float(np.linalg.norm(foot - bolt.point)) for foot in feet]
        assert min(off) < 1e-9  # also along the axis: the middle of the grip
        used.add((bolt.beam, bolt.end, off.index(min(off))))
        local = np.linalg.inv(node.placement) @ [*bolt.point, 1.0]
        shape = node.shape
        assert local[2] == pytest.approx(0.5 * (shape.z0 + shape.z1), abs=1e-9)
        away = [
            math.dist(local[:2], (step * math.cos(a), step * math.sin(a)))
            for a in shape.azimuths
            for step in shape.steps
        ]
        assert min(away) < 1e-9
        (low0, low1), (high0, high1) = comb.slots
        gap = 0.5 * (comb.width - shape.thickness)
        half = 0.5 * (shape.z1 - shape.z0)
        found = [w - comb.offset for w in (low0, low1, high0, high1)]
        t = shape.thickness
        assert found == pytest.approx([-half - gap, -half + t + gap, half - t - gap, half + gap])
        assert comb.depth >= shape.length - shell.size.cut + 2.0 - 1e-9
    assert len(used) == len(shell.bolts)


@pytest.mark.parametrize("size", ["M10", "M12", "M16"])
def test_distances(size: str) -> None:
    """EN 1995-1-1, table 8.4: a1 5 d, a3,t 7 d and 80 mm, a4 3 d; EN 1993-1-8 in the discs."""
    shell = timber(
        dome(),
        beam={"profile": "FL 300x120"},
        connection={**SLOTTED, "bolt": size},
        checks={"min_angle_deg": 10.0},
    )
    m, comb = fastener(size), shell.joined.comb
    assert comb is not None
    first, second = comb.steps
    assert second - first >= max(5.0 * m.diameter, comb.recess + m.diameter)
    assert first >= max(7.0 * m.diameter, 80.0)
    assert 3.0 * m.diameter <= 60.0
    for node in shell.nodes:  # holes of the discs, from their edges
        spool = node.shape
        assert min(spool.length - spool.steps[-1], 0.5 * spool.width) >= 1.2 * m.hole
        assert spool.width <= 120.0 - 2 * 5.0  # behind the sides of the bars
    outer = comb.slots[0][0] - comb.floors[0]
    middle = comb.slots[1][0] - comb.slots[0][1]
    assert min(outer, 0.5 * middle) >= 1.5 * m.diameter
    rod, ring, _, nut = shell.joined.mounted
    # EN 1995-1-1, 10.4.3: washers 3 d wide and 0.3 d thick, in a recess that takes them
    assert ring.shape.outside >= 3.0 * m.diameter
    assert ring.shape.length >= 0.3 * m.diameter
    assert comb.recess > ring.shape.outside
    assert comb.diameter <= m.diameter + 1.0
    assert rod.at - rod.shape.length <= nut.at - nut.shape.length - m.pitch
    # heads are below the wood: the top of a head from the lowest rim of its recess
    for beam in shell.beams:
        for cut, outward in ((beam.shape.start, -1.0), (beam.shape.end, 1.0)):
            n = math.hypot(1.0, cut.slope)
            for step in cut.comb.steps:
                rim = n * 150.0 - outward * cut.slope * step - 0.5 * comb.recess * abs(cut.slope)
                assert rim >= cut.comb.floors[1] + m.wide[2] + m.head - 1e-9


@pytest.mark.parametrize(
    ("sections", "words"),
    [
        (
            {"beam": {"profile": "FL 200x60"}},
            ["N-0000", "B-0000", "30.0 mm", "36.0", '"M10"', "72"],
        ),
        ({"beam": {"profile": "FL 100x100"}}, ["of FL 100x100", "94 mm", "a [beam] profile"]),
        ({"beam": {"profile": "RHS 200x100x6"}}, ["only flat bars"]),
        ({"beam": {**TIMBER, "end": "cope"}}, ['"slotted"', "flat ends"]),
        ({"node": {"kind": "cylinder"}}, ['needs [node] kind = "plates"', '"cylinder"']),
        ({"connection": STUD}, ['kind = "slotted"', '"stud"']),
        ({"node": {"kind": "plates", "diameter_mm": 300}}, ["leave [node] diameter_mm out"]),
        ({"connection": {**SLOTTED, "plate_mm": 40.0}}, ["slots of 41 mm", "a thinner"]),
        (
            {"connection": {**SLOTTED, "bolt": "M24"}},
            ["72 mm wide and 7.2", "85 and 6", '"M20"'],
        ),
    ],
)
def test_what_does_not_fit_is_named(sections: dict[str, Any], words: list[str]) -> None:
    with pytest.raises(DetailError) as caught:
        timber(dome(), **sections)
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_the_advice_works() -> None:
    with pytest.raises(DetailError) as caught:
        timber(dome(), beam={"profile": "FL 100x100"})
    deep = str(caught.value).split("profile ")[-1].split()[0]
    timber(dome(), beam={"profile": f"FL {deep}x100"})
    with pytest.raises(DetailError) as caught:
        timber(dome(), beam={"profile": "FL 200x60"})
    size = str(caught.value).split('bolt = "')[1].split('"')[0]
    wide = str(caught.value).split("profile ")[-1].split()[0]
    timber(dome(), beam={"profile": f"FL 200x{wide}"})
    timber(dome(), beam={"profile": "FL 200x60"}, connection={**SLOTTED, "bolt": size})


def test_nodes_turned_to_another_arm_are_one_number() -> None:
    shell = timber(vertical(grid(3, 3)))
    inner = {node.mark for node in shell.nodes if len(node.arms) == 4}
    found = families(shell.pieces, shell.family_tolerance)
    assert len([f for f in found if inner & {i.mark for i in f.instances}]) == 1
    assert len([f for f in found if f.role == "beam"]) == 1


COMB = CombEnd(-100.0, 4.0, 70.0, 12.0, 180.0, (84.0, 144.0), 13.0, 40.0, 140.0)


def bar(start: CombEnd | None, end: CombEnd | None, slope: float = 0.1) -> BeamShape:
    profile = standards.profile("FL 200x100")
    return BeamShape(profile, EndCut(0.0, slope, comb=start), EndCut(900.0, -1.5 * slope, comb=end))


@pytest.mark.parametrize("slope", [0.0, 0.12, -0.1])
def test_combs_are_exact(slope: float) -> None:
    """Boundary and second volume agree, and the genus: a bolt opens three handles."""
    for start, end, genus in ((COMB, COMB, 12), (None, COMB, 6), (COMB, None, 6)):
        shape = bar(start, end, slope)
        made = realise(shape, 0.01, solid=False)
        assert made.boundary is not None
        made.boundary.validate()
        assert made.genus == genus
        assert made.properties.volume == pytest.approx(shape.second_volume(), rel=1e-12)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"offset": 90.0}, "leaves the start"),
        ({"grip": 190.0}, "deep at its lowest rim"),
        ({"grip": 60.0}, "out of order"),
        ({"steps": (15.0,)}, "nearest face"),
        ({"steps": (84.0, 110.0)}, "recesses at the start overlap"),
        ({"steps": (84.0, 176.0)}, "leaves its slots"),
        ({"recess": 120.0}, "nearest face"),
    ],
)
def test_impossible_combs_are_errors(change: dict[str, Any], words: str) -> None:
    with pytest.raises(DetailError, match=words):
        bar(replace(COMB, **change), COMB).geometry()


def test_combs_that_meet_are_an_error() -> None:
    long = replace(COMB, depth=440.0)
    bar(long, long, 0.0).geometry()
    with pytest.raises(DetailError, match=r"take 920 mm of 900 mm"):
        bar(replace(COMB, depth=460.0), replace(COMB, depth=460.0), 0.0).geometry()


SPOOL = SpoolShape(200.0, 100.0, 10.0, 40.0, -45.0, 35.0, (0.0, 1.9, 4.0), (120.0, 170.0), 13.5)
AROUND = {
    "three": (0.0, 1.9, 4.0),
    "straight": (0.0, math.pi),
    "edge": (0.0, 0.5 * math.pi, math.pi),
    "corner": (0.0, 0.5 * math.pi),
    "sharp corner": (0.0, 0.9),
    "outwards": (0.0, 1.2, 2.4),
    "six": tuple(k * math.pi / 3.0 for k in range(6)),
}


@pytest.mark.parametrize("name", AROUND)
def test_discs_reach_into_the_arms_only(name: str) -> None:
    """Volume two ways, and every corner of the outline on a strip or in the middle."""
    shape = replace(SPOOL, azimuths=AROUND[name])
    made = realise(shape, 0.01, solid=False)
    assert made.boundary is not None
    made.boundary.validate()
    assert made.genus == 4 * len(shape.azimuths)
    assert made.properties.volume == pytest.approx(shape.second_volume(), rel=1e-12)
    outline, *holes = shape.plate().loops
    assert len(holes) == 2 * len(shape.azimuths)
    for x, y in outline.points:
        away = [
            (x * math.cos(a) + y * math.sin(a), abs(y * math.cos(a) - x * math.sin(a)))
            for a in shape.azimuths
        ]
        assert min(y for x, y in away if -50.1 < x < 200.1) < 50.0 + 1e-9
        assert math.hypot(x, y) >= 50.0 - 1e-9  # the core is within


def test_discs_turn_with_their_arms() -> None:
    """The closed form against a picture of the union of strips and the corner behind the axis."""
    shape = replace(SPOOL, azimuths=AROUND["outwards"])
    step = 0.5
    grid = np.arange(-205.0, 205.0, step) + 0.25
    x, y = np.meshgrid(grid, grid)
    inside = np.zeros_like(x, dtype=bool)
    for a in shape.azimuths:
        along, across = x * math.cos(a) + y * math.sin(a), y * math.cos(a) - x * math.sin(a)
        inside |= (along >= 0.0) & (along <= 200.0) & (abs(across) <= 50.0)
    area = step**2 * inside.sum()  # without the corner beyond a half turn
    gap = 2.0 * math.pi - 2.4
    beyond = 50.0**2 * (math.tan(0.5 * (gap - math.pi)))  # the corner between two strips' sides
    loops = shape.plate().loops
    assert section_area([loops[0]]) == pytest.approx(area + beyond, rel=1e-3)


def test_spools_are_exact_and_their_errors_named() -> None:
    for change, words in (
        ({"steps": (120.0, 195.0)}, "5 mm from the edge"),
        ({"steps": (45.0, 170.0)}, "or the core"),
        ({"steps": (120.0, 125.0)}, "overlap"),
        ({"azimuths": (0.0, 0.4, 3.0)}, "two arms at 22.9 deg"),
        ({"z1": -25.0}, "are no node"),
        ({"core": 50.0}, "are no node"),
        ({"width": 12.0, "core": 4.0}, "6 mm from the edge"),
    ):
        with pytest.raises(DetailError, match=words):
            replace(SPOOL, **change).geometry()


@pytest.mark.slow
def test_a_job_of_timber(tmp_path: Path) -> None:
    made = design(
        hexagons().mesh,
        beam=TIMBER,
        node={"kind": "plates"},
        panel={"kind": "none"},
        connection={**SLOTTED, "fasteners": True},
        output={"formats": ["step", "csv"]},
        checks={"verify": "sample"},
        axes=hexagons().axes,
    )
    result = make(made, tmp_path / "roof")
    assert result.exit_code == 0, result.problems
    found = off_axis(result.folder)
    assert len(found) == 120
    assert max(found.values()) < 0.01

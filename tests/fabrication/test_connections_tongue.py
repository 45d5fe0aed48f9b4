"""Bolted tongues: plates of star nodes in slots of flat bars, two bolts in double shear."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bolted import off_axis
from connection_cases import CASES, STUD, bolted
from detailing_cases import Case, dome, fan, grid, vertical
from roofs import barrel

from ddgfab.errors import DetailError
from fabrication import standards
from fabrication.families import families
from fabrication.gridshell.design import design
from fabrication.gridshell.detailing.connections.tongue import BoltedTongue
from fabrication.gridshell.detailing.gridshell import Gridshell
from fabrication.job.run import make
from fabrication.standards.fasteners import fastener

TONGUE = {"kind": "bolted_tongue"}
DEEP = {"profile": "FL 100x40"}


def starred(case: Case, **sections: Any) -> Gridshell:
    return bolted(
        case, **{"beam": DEEP, "node": {"kind": "star"}, "connection": TONGUE, **sections}
    )


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("eccentricity", [0.0, 30.0])
def test_bolts_go_through_cheeks_and_tongues(name: str, eccentricity: float) -> None:
    """Both holes of every bolt, from the shapes, lie on its axis across the plane of the beam."""
    shell = starred(CASES[name](), beam={**DEEP, "eccentricity_mm": eccentricity})
    beams = {beam.mark: beam for beam in shell.beams}
    nodes = {node.mark: node for node in shell.nodes}
    assert len(shell.bolts) == 4 * len(shell.beams)
    used: set[tuple[str, int]] = set()
    for bolt in shell.bolts:
        beam, node = beams[bolt.beam], nodes[bolt.node]
        assert abs(bolt.axis @ beam.placement[:3, 1]) == pytest.approx(1.0, abs=1e-9)
        at = np.linalg.inv(beam.placement) @ [*bolt.point, 1.0]
        off = [math.hypot(at[0] - h.x, at[2] - h.z) for h in beam.shape.holes]
        assert min(off) < 1e-9
        assert abs(at[1]) < 1e-9  # the middle of the tongue is that of the beam
        used.add((bolt.beam, off.index(min(off))))
        local = np.linalg.inv(node.placement) @ [*bolt.point, 1.0]
        arm = [a.beam for a in node.arms].index(bolt.beam)
        azimuth = node.shape.azimuths[arm]
        rho = local[0] * math.cos(azimuth) + local[1] * math.sin(azimuth)
        found = [
            math.hypot(rho - h.distance, local[2] - h.z) for h in node.shape.holes if h.arm == arm
        ]
        assert len(found) == 2
        assert min(found) < 1e-9
    assert len(used) == len(shell.bolts)  # every hole of every beam has its bolt


def test_distances_of_bolts_and_edges() -> None:
    """EN 1993-1-8, table 3.3: 1.2 hole diameters to edges and ends, 2.2 between bolts."""
    shell = starred(dome())
    tongue = shell.joined.tongue
    assert tongue is not None
    first, second = tongue.steps
    assert second - first >= 2.2 * 13.5
    assert min(first, tongue.length - second) >= 1.2 * 13.5
    assert (tongue.slot, tongue.depth) == (12.0 + 1.0, tongue.length + 2.0)
    for node in shell.nodes:
        for hole in node.shape.holes:
            assert min(node.shape.z1 - hole.z, hole.z - node.shape.z0) >= 1.2 * 13.5 - 1e-9
            assert hole.distance <= node.shape.length - 1.2 * 13.5
    bolt, *_, nut = shell.joined.mounted
    assert bolt.at + bolt.shape.length >= nut.at + nut.shape.length + 1.75  # a pitch beyond
    assert bolt.shape.designation == "ISO 4014 M12x60"
    # between head and nut: the bar, 40, and two washers; the rest of the bolt is beside the nut
    assert shell.joined.grip == 40.0 + 2 * 2.5
    assert tongue.nut == (12.0, 60.0 - 20.0 - 2.5)


def test_nuts_of_neighbours_keep_apart() -> None:
    """At 60 deg the nuts, not the beams, say how far the beams stay from the axis."""
    close = starred(fan(6, True))
    seat = math.sqrt(close.size.needed**2 - 20.0**2)  # where the beams alone would end
    assert close.size.cut > seat + 10.0
    tongue = close.joined.tongue
    assert tongue is not None
    rod, *_ = close.joined.mounted
    reach = rod.at + rod.shape.length
    nearest = close.size.cut + tongue.steps[0] - 12.0  # edge of the washer towards the node
    assert reach <= nearest * math.tan(math.radians(30.0)) + 1e-9


@pytest.mark.parametrize(
    ("sections", "words"),
    [
        ({"beam": {"profile": "FL 100x24"}}, ["cheeks of 5.5 mm", "6 mm each", "FL 35x25"]),
        ({"beam": {"profile": "FL 30x40"}}, ["15.0 mm from the edge", "16.2 mm", 'bolt = "M10"']),
        ({"beam": {"profile": "RHS 100x60x4"}}, ["only flat bars"]),
        ({"node": {"kind": "plates"}}, ['needs [node] kind = "star"', '"plates"']),
        ({"node": {"kind": "star", "diameter_mm": 60}}, ["leave [node] diameter_mm out"]),
        ({"connection": STUD}, ['kind = "star"', '"bolted_tongue"']),
        ({"beam": {**DEEP, "end": "cope"}}, ["flat ends"]),
        ({"beam": {"profile": "FL 200x150"}, "connection": {**TONGUE, "bolt": "M6"}}, ["M6 of"]),
    ],
)
def test_what_is_no_tongue_is_named(sections: dict[str, Any], words: list[str]) -> None:
    with pytest.raises(DetailError) as caught:
        starred(dome(), **sections)
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_stars_turned_to_another_plate_are_one_number() -> None:
    """Squares with vertical axes: all inner nodes are one star, however their arms are counted."""
    shell = starred(vertical(grid(3, 3)))
    inner = {node.mark for node in shell.nodes if len(node.arms) == 4}
    found = families(shell.pieces, shell.family_tolerance)
    own = [f for f in found if inner & {i.mark for i in f.instances}]
    assert len(own) == 1
    assert {i.mark for i in own[0].instances} == inner
    assert len({f.number for f in found if f.role == "beam"}) == 1


@pytest.mark.slow
def test_a_job_of_stars_and_tongues(tmp_path: Path) -> None:
    made = design(
        barrel(2, 2),
        beam=DEEP,
        node={"kind": "star"},
        connection={**TONGUE, "fasteners": True},
        output={"formats": ["step", "csv"]},
        checks={"verify": "sample"},
    )
    result = make(made, tmp_path / "roof")
    assert result.exit_code == 0, result.problems
    found = off_axis(result.folder)
    assert len(found) == 48
    assert max(found.values()) < 0.01


@pytest.mark.parametrize("size", ["M6", "M8", "M10", "M12", "M16", "M20", "M24"])
def test_a_wrench_on_one_bolt_of_a_tongue_clears_the_next(size: str) -> None:
    """Turned on one head, the wrench is nowhere nearer than the corners of the other head."""
    bolt = fastener(size)
    first, second = BoltedTongue(bolt, 10.0, 1.0).tongue(standards.profile("FL 60x8")).steps
    assert second - first >= 0.5 * (bolt.wrench + bolt.corners)
    assert second - first >= bolt.spacing

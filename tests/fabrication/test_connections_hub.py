"""Tongues on round nodes: plates welded to a cylinder or tube, in the planes of the beams."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bolted import off_axis
from connection_cases import CASES, bolted, worst_off_axis
from detailing_cases import Case, dome, fan, grid, vertical
from roofs import barrel

from ddgfab.errors import DetailError
from fabrication.checks.mesh import to_manifold
from fabrication.families import families
from fabrication.gridshell.design import design
from fabrication.gridshell.detailing.gridshell import Gridshell
from fabrication.gridshell.schedules import schedules
from fabrication.job.run import make
from fabrication.parts.hub import HubShape
from fabrication.parts.node import ReferenceMark
from fabrication.parts.star import TongueHole
from fabrication.solids import boundary_of, mesh_of, properties_of

TONGUE = {"kind": "bolted_tongue"}
DEEP = {"profile": "FL 100x40"}
AZIMUTHS = (0.0, 1.2, 3.0, 4.4)
HUB = HubShape(
    12.0, 150.0, -60.0, 5.0, AZIMUTHS, 13.5,
    tuple(TongueHole(k, far, -30.0 - k) for k in range(4) for far in (80.0, 120.0)),
    ReferenceMark(35.0, 3.0, 1.0), hub=40.0,
)  # fmt: skip


def hubbed(case: Case, kind: str = "cylinder", **sections: Any) -> Gridshell:
    return bolted(case, **{"beam": DEEP, "node": {"kind": kind}, "connection": TONGUE, **sections})


@pytest.mark.parametrize("bore", [0.0, 30.0])
@pytest.mark.parametrize("azimuths", [AZIMUTHS, (0.0, 0.9), (0.0, math.pi)])
def test_volume_two_ways_and_by_its_mesh(bore: float, azimuths: tuple[float, ...]) -> None:
    holes = tuple(hole for hole in HUB.holes if hole.arm < len(azimuths))
    shape = replace(HUB, azimuths=azimuths, bore=bore, holes=holes)
    boundary = boundary_of(shape)
    assert boundary is not None
    boundary.validate()
    assert boundary.genus == len(holes) + (bore > 0.0)
    found = properties_of(shape).volume
    assert found == pytest.approx(shape.second_volume(), rel=1e-12)
    assert to_manifold(mesh_of(shape, 0.002)).volume() == pytest.approx(found, rel=2e-4)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"bore": 40.0}, ["is not a node"]),
        ({"azimuths": (0.0, 0.29, 3.0, 4.4)}, ["16.62 deg meet outside the hub"]),
        ({"holes": (TongueHole(0, 46.0, -30.0),)}, ["6 mm from the edge"]),
    ],
)
def test_hubs_that_are_none(changes: dict[str, Any], words: list[str]) -> None:
    with pytest.raises(DetailError) as caught:
        boundary_of(replace(HUB, **changes))
    assert all(word in str(caught.value) for word in words), str(caught.value)


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("kind", ["cylinder", "tube"])
def test_both_holes_of_every_bolt_have_one_axis(name: str, kind: str) -> None:
    shell = hubbed(CASES[name](), kind)
    assert len(shell.bolts) == 4 * len(shell.beams)
    assert worst_off_axis(shell) < 1e-9
    for node in shell.nodes:
        assert isinstance(node.shape, HubShape)
        assert (node.shape.bore > 0.0) == (kind == "tube")


def test_beams_keep_off_the_welds_of_the_plates() -> None:
    """At a large given diameter the hub says how far the beams stay: radius, leg, clearance."""
    shell = hubbed(dome(), node={"diameter_mm": 160.0})
    assert shell.size.cut == math.ceil(80.0 + 4.0 * math.sqrt(2.0) + 0.5)
    wider = hubbed(dome(), node={"diameter_mm": 160.0}, connection={**TONGUE, "weld_mm": 8.0})
    assert wider.size.cut == math.ceil(80.0 + 8.0 * math.sqrt(2.0) + 0.5)


def test_welds_of_neighbours_do_not_meet() -> None:
    """Six plates at 60 deg: a plate with its two legs has its part of the circle."""
    shell = hubbed(fan(6, True), node={"min_diameter_mm": 0.0})
    node = shell.nodes[0].shape
    assert isinstance(node, HubShape)
    strip = 0.5 * node.thickness + 4.0 * math.sqrt(2.0)
    narrow = math.radians(60.0)
    assert node.hub >= strip / math.sin(0.5 * narrow)
    assert node.hub < strip / math.sin(0.5 * narrow) + 10.0


@pytest.mark.parametrize(
    ("sections", "words"),
    [
        ({"node": {"diameter_mm": 20.0}},
         ["node N-", "beams B-", "welds of 4 mm", "is 20", "take [node] diameter_mm ="]),
        ({"node": {"series_mm": [10.0, 12.0]}}, ["series ends at 12 mm"]),
        ({"node": {"kind": "tube", "diameter_mm": 60.0, "wall_mm": 30.0}}, ["a tube of 61.0 mm"]),
        ({"node": {"kind": "plates"}}, ['"star" or "cylinder" or "tube"', '"plates"']),
    ],
)  # fmt: skip
def test_what_is_no_hub_is_named(sections: dict[str, Any], words: list[str]) -> None:
    with pytest.raises(DetailError) as caught:
        hubbed(dome(), **sections)
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_hubs_turned_to_another_plate_are_one_number() -> None:
    shell = hubbed(vertical(grid(3, 3)))
    inner = {node.mark for node in shell.nodes if len(node.arms) == 4}
    found = {
        family.number
        for family in families(shell.nodes, 0.002)
        if any(instance.mark in inner for instance in family.instances)
    }
    assert len(found) == 1


def test_lists_name_bar_and_plates() -> None:
    shell = hubbed(dome(), "tube")
    tables = schedules(shell)
    node = next(row for row in tables["bom"] if row["role"] == "node")
    assert node["description"].startswith("tube ")
    assert " plates 12 x " in node["description"]
    row = tables["nodes"][0]
    assert row["hub_diameter_mm"] == 2.0 * shell.nodes[0].shape.hub
    assert row["plate_weld_mm"] == 4.0


def test_plates_lie_in_the_planes_of_the_beams() -> None:
    shell = hubbed(dome())
    beams = {beam.mark: beam for beam in shell.beams}
    for node in shell.nodes:
        for arm, azimuth in zip(node.arms, node.shape.azimuths, strict=True):
            along = node.placement[:3, :3] @ [math.cos(azimuth), math.sin(azimuth), 0.0]
            assert abs(beams[arm.beam].placement[:3, 1] @ along) < 1e-9
            assert abs(beams[arm.beam].placement[:3, 1] @ np.asarray(node.axis)) < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["cylinder", "tube"])
def test_a_job_with_hubs(kind: str, tmp_path: Path) -> None:
    made = design(
        barrel(2, 3),
        beam=DEEP,
        node={"kind": kind},
        connection={**TONGUE, "fasteners": True},
        output={"formats": ["step", "csv"]},
        checks={"verify": "sample"},
    )
    result = make(made, tmp_path / "roof")
    assert result.exit_code == 0, result.problems
    off = off_axis(tmp_path / "roof")
    assert len(off) == len(made.gridshell.bolts)
    assert max(off.values()) < 0.01

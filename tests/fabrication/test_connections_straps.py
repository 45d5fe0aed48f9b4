"""Doubled ends: straps on the sides of thin bars, a tongue of the node between them."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bolted import off_axis
from connection_cases import CASES, bolted, worst_off_axis
from detailing_cases import Case, dome
from roofs import barrel

from ddgfab.errors import DetailError
from fabrication.checks.mesh import to_manifold
from fabrication.gridshell.design import design
from fabrication.gridshell.detailing.gridshell import Gridshell
from fabrication.gridshell.schedules import schedules
from fabrication.job.run import make
from fabrication.parts.beam import BeamShape, CrossHole, EndCut, SlotEnd, StrapEnd
from fabrication.solids import boundary_of, mesh_of, properties_of
from fabrication.standards import profile

DOUBLED = {"kind": "bolted_tongue", "ends": "doubled"}
STRAPS = StrapEnd(8.0, 80.0, 75.0, 50.0)
BAR = profile("FL 100x12")


def strapped(case: Case, **sections: Any) -> Gridshell:
    sections = {
        "beam": {"profile": "FL 100x12"},
        "node": {"kind": "star"},
        "connection": DOUBLED,
        **sections,
    }
    return bolted(case, **sections)


def bar(first: float, last: float, *, both: bool = True) -> BeamShape:
    """A bar of 900 mm between straps; slopes of both cuts."""
    start = EndCut(0.0, first, straps=STRAPS if both else None)
    end = EndCut(900.0, last, straps=STRAPS)
    holes = [
        CrossHole(cut.x - 50.0 * cut.slope - way * step * math.hypot(1.0, cut.slope), -50.0, 13.5)
        for cut, way, steps in ((start, -1.0, (25.0, 55.0)), (end, 1.0, (55.0, 25.0)))
        for step in steps
        if cut.straps is not None
    ]
    return BeamShape(BAR, start, end, tuple(holes))


@pytest.mark.parametrize("both", [True, False])
@pytest.mark.parametrize("slopes", [(0.0, 0.0), (0.1, -0.2), (-0.3, 0.25)])
def test_volume_two_ways_and_by_its_mesh(slopes: tuple[float, float], both: bool) -> None:
    shape = bar(*slopes, both=both)
    boundary = boundary_of(shape)
    assert boundary is not None
    boundary.validate()
    assert boundary.genus == 2 * len(shape.holes)
    found = properties_of(shape).volume
    assert found == pytest.approx(shape.second_volume(), rel=1e-12)
    assert to_manifold(mesh_of(shape, 0.005)).volume() == pytest.approx(found, rel=1e-4)


def test_a_bar_and_four_boxes() -> None:
    """A third route: without slopes and holes the part is a bar and two boxes at each end."""
    shape = replace(bar(0.0, 0.0), holes=())
    boxes = 2 * 2 * 8.0 * 80.0 * 125.0
    assert properties_of(shape).volume == pytest.approx(750.0 * 1200.0 + boxes)
    assert shape.dimensions()["length_cut_mm"] == pytest.approx(750.0)


def test_the_bar_to_saw_has_no_holes() -> None:
    sawn = bar(0.1, -0.2).sawn()
    assert sawn is not None
    assert sawn.holes == ()
    assert sawn.volume == pytest.approx(bar(0.1, -0.2).dimensions()["length_cut_mm"] * 1200.0, 0.02)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"end": EndCut(200.0, 0.0, straps=STRAPS)}, ["straps of both ends meet", "-50"]),
        ({"end": EndCut(900.0, 0.0, straps=replace(STRAPS, height=100.0))}, ["100 mm high"]),
        ({"holes": (CrossHole(80.0, -50.0, 13.5),)}, ["from the edge of its straps"]),
        ({"holes": (CrossHole(25.0, -14.0, 13.5),)}, ["4 mm from the edge"]),
        ({"start": EndCut(0.0, 0.0, slot=SlotEnd(5.0, 60.0))}, ["coped, skew or has a hole"]),
    ],
)
def test_straps_that_do_not_fit(changes: dict[str, Any], words: list[str]) -> None:
    with pytest.raises(DetailError) as caught:
        boundary_of(replace(bar(0.0, 0.0), **changes))
    assert all(word in str(caught.value) for word in words), str(caught.value)


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("kind", ["star", "cylinder"])
def test_both_holes_of_every_bolt_have_one_axis(name: str, kind: str) -> None:
    shell = strapped(CASES[name](), node={"kind": kind})
    assert len(shell.bolts) == 4 * len(shell.beams)
    assert worst_off_axis(shell) < 1e-9


def test_sizes_of_straps_and_tongue() -> None:
    """Tongue of stock within 2 mm of the bar, straps of half of it, bolts through both."""
    shell = strapped(dome())
    tongue = shell.joined.tongue
    assert tongue is not None
    assert tongue.straps is not None
    assert (tongue.thickness, tongue.slot) == (10.0, 12.0)
    assert tongue.straps.thickness >= 0.5 * tongue.thickness
    # 100 less, above and below, the leg of a throat of 4 mm and 2 mm: 84.7, in steps of 5
    assert tongue.straps.height == 80.0
    assert 0.5 * tongue.straps.height >= 1.2 * 13.5
    assert tongue.straps.lap >= max(5.0 * tongue.straps.thickness, 30.0)
    assert shell.joined.weld == 4.0
    bolt, *_, nut = shell.joined.mounted
    assert shell.joined.grip == 12.0 + 2.0 * tongue.straps.thickness + 2.0 * 2.5
    assert bolt.at + bolt.shape.length >= nut.at + nut.shape.length + 1.75
    assert shell.size.width == 12.0 + 2.0 * tongue.straps.thickness


def test_straps_of_one_node_keep_apart() -> None:
    shell = strapped(dome())
    pieces = {beam.mark: beam for beam in shell.beams}
    node = max(shell.nodes, key=lambda n: len(n.arms))
    bodies = []
    for arm in node.arms:
        beam = pieces[arm.beam]
        motion = np.linalg.inv(node.placement) @ beam.placement
        bodies.append(to_manifold(mesh_of(beam.shape)).transform(motion[:3]))
    own = to_manifold(mesh_of(node.shape))
    for k, one in enumerate(bodies):
        assert one.min_gap(own, 5.0) >= 0.5 - 1e-6
        assert all((one ^ other).volume() == 0.0 for other in bodies[:k])


@pytest.mark.parametrize(
    ("sections", "words"),
    [
        ({"beam": {"profile": "FL 100x15"}},
         ["tongue of 12 mm", "13 to 14 mm", "plate_mm = 14", '"FL 100x14" or "FL 100x17"']),
        ({"connection": {**DOUBLED, "plate_mm": 12.0}}, ["it must be 10 to 11 mm"]),
        ({"beam": {"profile": "FL 40x12"}},
         ["the holes for M12 are 10.0 mm", "16.2", 'bolt = "M', '"FL 55x12"']),
        ({"beam": {"profile": "RHS 100x60x4"}}, ["only flat bars"]),
        ({"beam": {"profile": "FL 100x12",
                   "rules": [{"where": "boundary", "profile": "FL 100x10"}]}},
         ["have one thickness", "10 mm for FL 100x12", "8 mm for FL 100x10"]),
    ],
)  # fmt: skip
def test_what_does_not_go_between_straps(sections: dict[str, Any], words: list[str]) -> None:
    with pytest.raises(DetailError) as caught:
        strapped(dome(), **sections)
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_the_advised_bars_do() -> None:
    for name in ("FL 100x14", "FL 100x17", "FL 55x12"):
        strapped(dome(), beam={"profile": name})
    strapped(dome(), beam={"profile": "FL 100x15"}, connection={**DOUBLED, "plate_mm": 14.0})


def test_slots_and_straps_are_not_on_one_bar() -> None:
    connection = {**DOUBLED, "rules": [{"where": "boundary", "ends": "slotted"}]}
    with pytest.raises(DetailError, match=r"bolted_tongue between straps at its|cheeks"):
        strapped(dome(), connection=connection, beam={"profile": "FL 100x32"})


def test_lists_have_the_straps() -> None:
    tables = schedules(strapped(dome()))
    row = tables["beams"][0]
    assert row["straps_start_mm"] == row["straps_end_mm"] == 5.0
    assert row["weld_mm"] == 4.0
    assert row["straps_start_second_mm"] > row["straps_start_first_mm"] > 1.5 * 13.5
    assert "slot_width_mm" not in tables["beams"].columns


@pytest.mark.slow
def test_a_job_with_straps(tmp_path: Path) -> None:
    made = design(
        barrel(2, 3),
        beam={"profile": "FL 100x12"},
        node={"kind": "star"},
        connection={**DOUBLED, "fasteners": True},
        output={"formats": ["step", "nc1", "ifc", "csv"]},
        checks={"verify": "sample"},
    )
    result = make(made, tmp_path / "roof")
    assert result.exit_code == 0, result.problems
    off = off_axis(tmp_path / "roof")
    assert len(off) == len(made.gridshell.bolts)
    assert max(off.values()) < 0.01

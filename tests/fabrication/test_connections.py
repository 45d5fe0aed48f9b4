"""Connections: holes of beams and nodes on one axis, what fits, the lists of fasteners."""

from __future__ import annotations

import csv
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bolted import off_axis
from connection_cases import BAR, CASES, STUD, bolted
from detailing_cases import Case, central, dome, grid, vertical
from roofs import barrel

from ddgfab.errors import DetailError
from fabrication.checks.assembly import check_assembly
from fabrication.families import families
from fabrication.formats.step.whole import check_step_assembly
from fabrication.gridshell.bolt_lists import bolt_rows, fastener_rows, mates_of, mounted_pairs
from fabrication.gridshell.design import design
from fabrication.gridshell.detailing.connections.stud import CORNER
from fabrication.gridshell.detailing.gridshell import Gridshell
from fabrication.job.run import make
from fabrication.solids import mesh_of
from fabrication.specs import Mate
from fabrication.standards.fasteners import bolt_length, fastener, fasteners, stud_length


def hole_axes(shell: Gridshell) -> dict[str, list[tuple[np.ndarray, np.ndarray]]]:
    """By bolt: point and direction of its hole in the node and in the beam, from their shapes."""
    beams = {beam.mark: beam for beam in shell.beams}
    nodes = {node.mark: node for node in shell.nodes}
    found = {}
    for bolt in shell.bolts:
        node, beam = nodes[bolt.node], beams[bolt.beam]
        k = [arm.beam for arm in node.arms].index(bolt.beam)
        hole = node.shape.holes[k]
        radial = np.array([math.cos(hole.azimuth), math.sin(hole.azimuth), 0.0])
        cut = (beam.shape.start, beam.shape.end)[bolt.end]
        mouth = np.array([cut.x + cut.slope * cut.stud.z, 0.0, cut.stud.z])
        inwards = (1 - 2 * bolt.end) * np.array([1.0, 0.0, -cut.slope])
        pair = []
        for placement, point, direction in (
            (node.placement, np.array([0.0, 0.0, hole.z]), radial),
            (beam.placement, mouth, inwards / np.linalg.norm(inwards)),
        ):
            turn = placement[:3, :3]
            pair.append((turn @ point + placement[:3, 3], turn @ direction))
        found[bolt.mark] = pair
    return found


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("profile", ["FL 80x40", "RHS 100x60x4"])
@pytest.mark.parametrize("eccentricity", [0.0, 25.0])
def test_holes_of_mates_have_one_axis(name: str, profile: str, eccentricity: float) -> None:
    beam = {"profile": profile, "eccentricity_mm": eccentricity}
    shell = bolted(CASES[name](), beam=beam)
    found = hole_axes(shell)
    assert len(found) == sum(len(node.arms) for node in shell.nodes)
    for bolt in shell.bolts:
        (p, u), (q, v) = found[bolt.mark]
        assert u @ v == pytest.approx(1.0, abs=1e-12)
        assert np.linalg.norm(np.cross(q - p, u)) < 1e-9
        assert np.linalg.norm(np.cross(bolt.point - p, u)) < 1e-9
        # from the seat to the plate there is the clearance, and nothing else
        assert (q - bolt.point) @ u == pytest.approx(0.5)


def test_holes_turn_with_the_structure() -> None:
    case = dome()
    angle = 0.7
    turn = np.array(
        [
            [math.cos(angle), -math.sin(angle), 0],
            [math.sin(angle), math.cos(angle), 0],
            [0, 0, 1.0],
        ]
    )
    moved = Case(case.mesh.with_vertices(case.mesh.vertices @ turn.T + 7e3), case.axes @ turn.T)
    for one, two in zip(bolted(case).bolts, bolted(moved).bolts, strict=True):
        assert (one.node, one.beam) == (two.node, two.beam)
        assert np.allclose(turn @ one.point + 7e3, two.point)
        assert np.allclose(turn @ one.axis, two.axis)


def test_what_a_stud_is_made_of() -> None:
    """M12, plate 12: thread and run-out in the node, washer and nut behind the plate."""
    joined = bolted(dome()).joined
    assert joined.depth is not None
    assert joined.thread == joined.depth - 2 * 1.75
    assert 12.0 <= joined.thread <= 18.0
    assert joined.grip == 0.5 + 12.0 + 2.5
    rod, ring, nut = joined.mounted
    assert (rod.at, ring.at, nut.at) == (-joined.thread, 12.5, 15.0)
    least = joined.thread + joined.grip + 10.8 + 1.75  # one pitch beyond the nut
    assert rod.shape.length == stud_length(least)
    assert least <= rod.shape.length < least + 5.0
    assert joined.end is not None
    assert joined.end.length >= rod.shape.length + 2.5


def test_a_bolt_is_as_long_as_its_thread_allows() -> None:
    joined = bolted(dome(), connection={"kind": "stud", "fastener": "bolt"}).joined
    ring, bolt = joined.mounted
    assert (ring.towards, bolt.towards, bolt.at) == (1, -1, joined.grip)
    assert joined.grip is not None
    assert joined.thread is not None
    engaged = bolt.shape.length - joined.grip
    assert 12.0 <= engaged <= joined.thread
    assert bolt.shape.designation == f"ISO 4017 M12x{bolt.shape.length:g}"


@pytest.mark.parametrize(
    ("sections", "words"),
    [
        (
            {"beam": {"profile": "FL 80x12"}},
            ["N-0000, beam B-0000", "M12 is 6.0 mm from the edge", "16.2 mm", "EN 1993-1-8"],
        ),
        ({"beam": {"profile": "FL 80x24"}}, ['take [connection] bolt = "M8"']),
        ({"beam": {"profile": "FL 60x40"}}, ["39.6 mm high", "60 mm deep", 'bolt = "M']),
        ({"beam": {"profile": "RHS 80x40x4"}}, ["spanner of M12", "16.0 mm"]),
        ({"beam": {"profile": "T 80x80x9"}}, ["from the edge", "T 80x80x9"]),
        ({"beam": {**BAR, "end": "cope"}}, ['[beam] end = "cope"']),
        ({"connection": {"kind": "stud", "plate_mm": 300.0}}, ["the series has none", "plate_mm"]),
        (
            {"connection": {"kind": "stud", "bolt": "M6", "fastener": "bolt", "plate_mm": 60.0}},
            ["bolt M6", "the series has none"],
        ),
        ({"connection": {"kind": "stud", "thread_mm": 200.0}}, ["which needs", "series"]),
    ],
)
def test_what_does_not_fit_is_named(sections: dict[str, Any], words: list[str]) -> None:
    with pytest.raises(DetailError) as caught:
        bolted(dome(), **sections)
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_the_advice_works() -> None:
    """The bolt or bar that an error names passes."""
    for profile in ("FL 80x24", "FL 60x40"):
        with pytest.raises(DetailError) as caught:
            bolted(dome(), beam={"profile": profile})
        size = str(caught.value).split('bolt = "')[1].split('"')[0]
        bolted(dome(), beam={"profile": profile}, connection={"kind": "stud", "bolt": size})
    with pytest.raises(DetailError) as caught:
        bolted(dome(), beam={"profile": "FL 80x12"})
    bar = str(caught.value).split('profile = "')[1].split('"')[0]
    bolted(dome(), beam={"profile": bar})


def test_the_advised_bar_is_not_larger_than_need_be() -> None:
    """Four fifths of its depth do not do; from steep cuts too, where the opening shifts."""
    steep = central(grid(2, 2), (0.0, 0.0, -4000.0))
    for case in (dome(), steep):
        with pytest.raises(DetailError) as caught:
            bolted(case, beam={"profile": "FL 60x40"})
        deep, wide = str(caught.value).split('profile = "FL ')[1].split('"')[0].split("x")
        bolted(case, beam={"profile": f"FL {deep}x{max(float(wide), 40.0):g}"})
        with pytest.raises(DetailError, match=r"deep|opening"):
            bolted(case, beam={"profile": f"FL {0.8 * float(deep):.0f}x40"})


def test_what_a_stud_takes_of_a_beam() -> None:
    """Plate, opening and corner along the axis; seen along the beam, more by its slope.

    The opening is as high as a wrench w, so a cut of slope s moves its far end by w s.
    """
    flat = bolted(vertical(grid(2, 2))).joined
    assert flat.end is not None
    along = flat.end.plate + flat.end.length + CORNER
    assert flat.end_length == pytest.approx(along, abs=1e-9)
    case = central(grid(2, 2), (1500.0, 1500.0, -6000.0))
    shell = bolted(case)
    slope = max(
        abs(cut.slope) for beam in shell.beams for cut in (beam.shape.start, beam.shape.end)
    )
    wrench = fastener("M12").wrench
    taken = along * math.hypot(1.0, slope) + wrench * slope
    assert slope > 0.1
    assert shell.joined.end_length == pytest.approx(taken, rel=1e-9)


def test_twisted_beams_with_compound_cuts_are_refused() -> None:
    case = dome()
    axes = case.axes.copy()
    axes[8] += [0.0, 0.05, 0.0]
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    with pytest.raises(DetailError, match=r"B-\d+ has a compound cut.*\n.*welded"):
        bolted(Case(case.mesh, axes), checks={"torsion_deg": 5.0})


def test_short_beams_with_long_connections_are_named() -> None:
    with pytest.raises(DetailError, match=r"(?s)B-0000 between.*connections take"):
        bolted(vertical(grid(2, 2, side=180.0)))


def test_lists_count_every_fastener() -> None:
    shell = bolted(dome())
    rows = bolt_rows(shell, families(shell.pieces, shell.family_tolerance))
    assert len(rows) == len(shell.bolts) == 2 * len(shell.beams)
    counts = {row["kind"]: row["quantity"] for row in fastener_rows(shell)}
    assert counts == {"stud": len(rows), "nut": len(rows), "washer": len(rows)}
    made = bolted(dome(), connection={**STUD, "fasteners": True})
    assert len(made.fasteners) == 3 * len(rows)
    assert len({piece.mark for piece in made.pieces}) == len(made.pieces)
    assert not shell.fasteners
    assert bolted(dome(), connection={}).bolts == ()


def test_each_end_of_a_turned_beam_is_named_as_made() -> None:
    shell = bolted(vertical(grid(2, 2)))
    found = families(shell.pieces, shell.family_tolerance)
    rows = bolt_rows(shell, found)
    for beam in shell.beams:
        own = [row for row in rows if row["beam"] == beam.mark]
        assert {row["beam_end"] for row in own} == {"start", "end"}
        family, instance = next((f, i) for f in found for i in f.instances if i.mark == beam.mark)
        start = next(row for row in own if row["beam_end"] == "start")
        at = np.array([start[f"{c}_mm"] for c in "xyz"])
        local = np.linalg.inv(instance.placement) @ [*at, 1.0]
        assert abs(local[0]) < abs(local[0] - family.shape.end.x)


def test_a_pane_through_a_nut_is_a_clash_and_mates_are_none() -> None:
    made = design(
        barrel(2, 2),
        beam=BAR,
        connection={**STUD, "fasteners": True},
        panel={"offset_mm": -45.0},  # panes right through the nuts
    )
    shell = made.gridshell
    meshes = {family.number: mesh_of(family.shape) for family in made.families}
    pairs = mounted_pairs(shell)
    wanted: dict[tuple[str, str], float] = {}
    found = check_assembly(made.families, meshes, wanted, tolerance=0.1, mounted=pairs)
    hit = {
        (mark, check.other)
        for mark, checks in found.items()
        for check in checks
        if not check.passed and mark.startswith("F-")
    }
    assert hit
    assert all(other is not None and other.startswith("P-") for _, other in hit)
    without = check_assembly(made.families, meshes, wanted, tolerance=0.1)
    assert any(
        check.other and check.other[0] in "BN"
        for mark, checks in without.items()
        if mark.startswith("F-")
        for check in checks
        if not check.passed
    )


def test_standards() -> None:
    """ISO 4017 M12x45, ISO 4032 m = 10.8, EN 1993-1-8 table 3.3; all sizes grow together."""
    m12 = fastener("M12")
    assert (m12.flats, m12.head, m12.nut, m12.washer) == (18.0, 7.5, 10.8, (13.0, 24.0, 2.5))
    assert (m12.edge, m12.spacing) == pytest.approx((1.2 * 13.5, 2.2 * 13.5))
    assert m12.corners == pytest.approx(20.785, abs=1e-3)
    for one, two in zip(fasteners(), fasteners()[1:], strict=False):
        for name in ("diameter", "drill", "hole", "flats", "head", "nut"):
            assert getattr(one, name) < getattr(two, name)
        assert two.drill == pytest.approx(two.diameter - two.pitch, abs=0.06)  # ISO 2306
        assert two.diameter < two.washer[0] < two.washer[1]
    assert bolt_length(m12, "full", 30.0, 38.0) == 35.0
    assert bolt_length(m12, "full", 41.0, 44.0) is None
    assert bolt_length(m12, "shank", 30.0, 44.0) is None  # shanks from 50 mm
    assert stud_length(51.0) == 55.0


@pytest.fixture(scope="module")
def roof(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A whole job with studs as parts."""
    made = design(
        barrel(2, 2),
        beam=BAR,
        connection={**STUD, "fasteners": True},
        output={"formats": ["step", "csv"]},
        checks={"verify": "sample"},
    )
    result = make(made, tmp_path_factory.mktemp("bolted") / "roof")
    assert result.exit_code == 0, result.problems
    checks = {check["name"]: check for check in result.manifest["checks"]["failed"] or []}
    assert not checks
    return result.folder


@pytest.mark.slow
def test_every_bolt_has_its_two_holes_in_the_file(roof: Path) -> None:
    found = off_axis(roof)
    assert len(found) == 24  # 12 beams
    assert max(found.values()) < 0.01
    with (roof / "schedules" / "fasteners.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert [int(row["quantity"]) for row in rows] == [24, 24, 24]


@pytest.mark.slow
def test_holes_off_their_axis_are_found(roof: Path) -> None:
    """A bolt that is expected elsewhere, a hole that is not there: both fail the job's check."""
    made = design(barrel(2, 2), beam=BAR, connection={**STUD, "fasteners": True})
    mates = mates_of(made.gridshell.bolts)

    def checks(*wanted: Mate) -> dict[str, Any]:
        found = check_step_assembly(roof / "assembly.step", {}, (), wanted)
        return {
            check.name: check for check in found if "hole" in check.name or "coax" in check.name
        }

    good = checks(*mates)
    assert good["assembly holes"].passed
    assert good["assembly coaxial_mm"].value < 1e-6
    wide = replace(mates[3], holes=((mates[3].holes[0][0], 11.0), mates[3].holes[1]))
    missing = checks(wide)["assembly holes"]
    assert not missing.passed
    assert missing.value == f"{wide.mark} in {wide.holes[0][0]}"
    # the hole of another arm, 90 deg away, is not a hole of this bolt
    other = replace(mates[3], holes=(mates[3].holes[0], (mates[9].holes[1])))
    assert not checks(other)["assembly holes"].passed


def test_central_axes_and_deep_profiles_fit_too() -> None:
    shell = bolted(
        central(grid(2, 2), (1500.0, 1500.0, -6000.0)),
        beam={"profile": "FL 160x60"},
        connection={"kind": "stud", "bolt": "M20"},
    )
    assert shell.joined.hole == 17.5

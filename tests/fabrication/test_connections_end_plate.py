"""End plates: rows of bolts beside the bar, their holes in plate and node, what does not fit."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bolted import off_axis
from connection_cases import BAR, CASES, bolted
from detailing_cases import Case, dome, grid, vertical
from roofs import barrel

from ddgfab.errors import DetailError
from fabrication import standards
from fabrication.families import families
from fabrication.gridshell.design import design
from fabrication.gridshell.detailing.gridshell import Gridshell
from fabrication.job.run import make
from fabrication.parts.beam import BeamShape, EndCut, PlateEnd
from fabrication.parts.node import NodeShape, RadialHole, Seat
from fabrication.solids import realise
from fabrication.standards import plates
from fabrication.standards.fasteners import fastener
from fabrication.standards.profiles import z_range

PLATE = {"kind": "end_plate"}
FOUR = {"kind": "end_plate", "bolts": 4, "bolt": "M8"}
THIN = {"profile": "FL 80x12"}


def plated(case: Case, **sections: Any) -> Gridshell:
    return bolted(case, **{"beam": THIN, "connection": FOUR, **sections})


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("eccentricity", [0.0, 25.0])
def test_holes_of_plate_and_node_have_one_axis(name: str, eccentricity: float) -> None:
    """Both holes of every bolt, from the shapes alone."""
    shell = plated(CASES[name](), beam={**THIN, "eccentricity_mm": eccentricity})
    beams = {beam.mark: beam for beam in shell.beams}
    nodes = {node.mark: node for node in shell.nodes}
    assert len(shell.bolts) == 8 * len(shell.beams)
    used = set()
    for bolt in shell.bolts:
        beam, node = beams[bolt.beam], nodes[bolt.node]
        cut = (beam.shape.start, beam.shape.end)[bolt.end]
        n = math.hypot(1.0, cut.slope)
        inwards = (1 - 2 * bolt.end) * np.array([1.0, 0.0, -cut.slope]) / n
        up = np.array([cut.slope, 0.0, 1.0]) / n
        middle = np.array([cut.x + cut.slope * cut.plate.z, 0.0, cut.plate.z])
        mouths = [middle + [0.0, y, 0.0] + w * up for y, w in cut.plate.holes]
        turn, shift = beam.placement[:3, :3], beam.placement[:3, 3]
        assert (turn @ inwards) @ bolt.axis == pytest.approx(1.0, abs=1e-12)
        off = [
            np.linalg.norm(np.cross(turn @ mouth + shift - bolt.point, bolt.axis))
            for mouth in mouths
        ]
        assert min(off) < 1e-9
        used.add((bolt.beam, bolt.end, int(np.argmin(off))))
        local = np.linalg.inv(node.placement) @ [*bolt.point, 1.0]
        near = [
            math.dist(
                (hole.across, hole.z),
                (
                    local[1] * math.cos(hole.azimuth) - local[0] * math.sin(hole.azimuth),
                    local[2],
                ),
            )
            for hole in node.shape.holes
        ]
        assert min(near) < 1e-9
    assert len(used) == len(shell.bolts)


@pytest.mark.parametrize("size", ["M6", "M10", "M16"])
@pytest.mark.parametrize("profile", ["FL 150x12", "RHS 150x100x5", "T 120x120x13"])
def test_distances(size: str, profile: str) -> None:
    """EN 1993-1-8, table 3.3: e1, e2, p1, p2; spanners keep off the bar and the next head."""
    shell = bolted(
        dome(),
        beam={"profile": profile},
        connection={**FOUR, "bolt": size},
        node={"series_mm": [500.0]},
    )
    m, plate = fastener(size), shell.joined.plate
    assert plate is not None
    (left, low), (right, _), (_, high), _ = plate.holes
    half = 0.5 * standards.profile(profile).width
    e1, e2 = 0.5 * plate.height - high, 0.5 * plate.width - right
    assert min(e1, e2) >= 1.2 * m.hole - 1e-9
    assert high - low >= 2.2 * m.hole
    assert right - left >= 2.4 * m.hole
    assert right - half >= 1.1 * m.flats
    assert right - half >= 0.5 * m.washer[1] + 4.0 * math.sqrt(2.0)  # the weld's leg
    assert high - low >= 0.5 * (m.wrench + m.corners)
    assert e2 >= 0.5 * m.wrench - 1e-9  # no spanner over the neighbour's plate
    for node in shell.nodes:
        assert node.shape.z1 - node.shape.z0 >= plate.height


def test_holes_of_neighbours_keep_apart() -> None:
    """No two holes of a node come nearer than their radii, measured on their axes by points."""
    shell = plated(dome())
    depth = shell.joined.depth
    assert depth is not None
    along = np.linspace(0.0, depth, 60)
    for node in shell.nodes:
        axes = []
        for hole in node.shape.holes:
            c, s = math.cos(hole.azimuth), math.sin(hole.azimuth)
            rho = (shell.size.seat - along)[:, None]
            axes.append(rho * [c, s, 0.0] + [-s * hole.across, c * hole.across, hole.z])
        for k, one in enumerate(axes):
            for two in axes[:k]:
                gaps = np.linalg.norm(one[:, None] - two[None], axis=-1)
                assert gaps.min() > node.shape.holes[0].diameter


@pytest.mark.parametrize(
    ("sections", "words"),
    [
        (
            {"beam": {"profile": "FL 50x12"}, "connection": {**FOUR, "bolts": 6}},
            ["N-0000, beam B-0000", "3 rows of M8", "65 mm high", "3.3", "bolts = 4", '"M6"'],
        ),
        ({"beam": {**THIN, "end": "cope"}}, ["end_plate", '[beam] end = "cope"']),
        ({"connection": {**FOUR, "plate_mm": 300.0}}, ["the series has none", "plate_mm"]),
        ({"node": {"kind": "star"}}, ['kind = "star"', '"end_plate"']),
        ({"beam": {"profile": "FL 80x150"}}, ["the series ends at 250 mm", "[connection] bolt"]),
        (
            {"node": {"kind": "tube", "diameter_mm": 120.0, "wall_mm": 45.0}},
            ["N-0000", "B-0000", "23.9 mm from its middle", "15.0 mm", "25.9 mm are needed"],
        ),
        ({"node": {"diameter_mm": 88.0}}, ["too small for beams", "at least"]),
    ],
)
def test_what_does_not_fit_is_named(sections: dict[str, Any], words: list[str]) -> None:
    with pytest.raises(DetailError) as caught:
        plated(dome(), **sections)
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_the_advice_works() -> None:
    with pytest.raises(DetailError) as caught:
        plated(dome(), beam={"profile": "FL 60x12"}, connection={**FOUR, "bolts": 8})
    most = int(str(caught.value).split("bolts = ")[1].split()[0])
    assert most == 6
    plated(dome(), beam={"profile": "FL 60x12"}, connection={**FOUR, "bolts": most})
    odd = {**FOUR, "fastener": "bolt", "plate_mm": 12.0, "thread_mm": 7.9}
    with pytest.raises(DetailError, match=r"of 22\.0 to") as caught:
        plated(dome(), connection=odd)
    plate = float(str(caught.value).split("plate_mm = ")[1].split()[0])
    assert plate == 10.0
    plated(dome(), connection={**odd, "plate_mm": plate})
    assert plated(dome(), connection={**odd, "plate_mm": "auto"}).bolts
    with pytest.raises(DetailError, match=r'take .* fastener = "stud"'):
        plated(dome(), connection={**odd, "thread_mm": 8.0})
    plated(dome(), connection={**odd, "thread_mm": 8.0, "fastener": "stud"})


@pytest.mark.parametrize("thread", [10.0, 11.0, 12.0, "auto"])
@pytest.mark.parametrize("size", ["M8", "M10", "M12", "M14"])
def test_plates_are_of_thicknesses_kept_in_stock(size: str, thread: float | str) -> None:
    """Whatever thread is asked for: 10.5 mm is no plate that can be bought."""
    wanted = {**FOUR, "bolts": 2, "bolt": size, "fastener": "bolt", "thread_mm": thread}
    try:
        shell = plated(dome(), connection=wanted)
    except DetailError as error:
        assert "the series has none" in str(error)  # noqa: PT017 - some threads fit no bolt
        return
    plate = shell.joined.plate
    assert plate is not None
    assert plate.thickness in plates()
    assert plate.thickness >= fastener(size).diameter


def test_twisted_beams_are_refused() -> None:
    case = dome()
    axes = case.axes.copy()
    axes[8] += [0.0, 0.05, 0.0]
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    with pytest.raises(DetailError, match=r"B-\d+ has a compound cut.*an end plate.*\n.*welded"):
        plated(Case(case.mesh, axes), checks={"torsion_deg": 5.0})


def test_equal_beams_and_nodes_are_one_number() -> None:
    shell = plated(vertical(grid(3, 3)))
    found = families(shell.pieces, shell.family_tolerance)
    assert len([f for f in found if f.role == "beam"]) == 1
    inner = [node.mark for node in shell.nodes if len(node.arms) == 4]
    assert len({f.number for f in found for i in f.instances if i.mark in inner}) == 1


SQUARE = PlateEnd(-40.0, 100.0, 120.0, 10.0, ((-30.0, 0.0), (30.0, 20.0)), 13.0)


def beam(profile: str, plate: PlateEnd, slope: float = 0.1) -> BeamShape:
    low, high = z_range(standards.profile(profile))
    plate = replace(plate, z=0.5 * (low + high))
    return BeamShape(
        standards.profile(profile),
        EndCut(0.0, slope, plate=plate),
        EndCut(700.0, -2 * slope, plate=plate),
    )


@pytest.mark.parametrize("profile", ["FL 80x12", "RHS 100x40x4", "T 80x80x9"])
@pytest.mark.parametrize("slope", [0.0, 0.12, -0.2])
def test_plates_are_exact(profile: str, slope: float) -> None:
    """Boundary, mesh and second volume agree; a hollow bar is open at both plates."""
    hollow = profile.startswith("RHS")
    plate = replace(SQUARE, vent=12.0 if hollow else 0.0, width=140.0, height=150.0,
                    holes=((-60.0, 0.0), (60.0, 20.0)))  # fmt: skip
    shape = beam(profile, plate, slope)
    made = realise(shape, 0.005, solid=False)
    assert made.boundary is not None
    made.boundary.validate()
    assert made.genus == 4 + hollow
    assert made.properties.volume == pytest.approx(shape.second_volume(), rel=1e-12)
    bar = shape.dimensions()["length_cut_mm"]
    assert bar < 700.0 + abs(slope) * 320.0 - 20.0 + 10.0


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"width": 10.0}, "takes 12"),
        ({"height": 82.0}, "takes 12 x 8"),
        ({"holes": ((-46.0, 0.0),)}, "4 mm from its edge"),
        ({"holes": ((10.0, 0.0),)}, "4 mm from the bar"),
        ({"holes": ((0.0, 0.0),)}, "0 mm from the bar"),
        ({"holes": ((30.0, 0.0), (30.0, 12.0))}, "overlap"),
        ({"vent": 5.0}, "one hole"),
    ],
)
def test_impossible_plates_are_errors(change: dict[str, Any], words: str) -> None:
    with pytest.raises(DetailError, match=words):
        beam("FL 80x12", replace(SQUARE, **change)).geometry()


def test_holes_of_a_node_beside_its_radius() -> None:
    """Volume two ways; holes that meet beside the radius, and break out, are found."""

    def node(across: float, depth: float, azimuth: float = 1.2) -> NodeShape:
        seats = (Seat(0.0, 50.0, 60.0), Seat(azimuth, 50.0, 60.0))
        holes = tuple(
            RadialHole(s.azimuth, 0.0, 8.0, depth, y) for s in seats for y in (-across, across)
        )
        return NodeShape(math.hypot(50.0, 30.0), 0.0, -30.0, 30.0, seats, holes)

    good = realise(node(20.0, 12.0), solid=False)
    assert good.boundary is not None
    good.boundary.validate()
    assert good.properties.volume == pytest.approx(node(20.0, 12.0).second_volume(), rel=1e-12)
    # at 1.2 rad the strips that reach 24 mm from the radius meet 24 / tan(0.6) = 35.1 mm out
    node(20.0, 50.0 - 35.2).geometry()
    with pytest.raises(DetailError, match="run into each other"):
        node(20.0, 50.0 - 35.0).geometry()
    with pytest.raises(DetailError, match="run into each other"):
        node(3.9, 5.0).geometry()
    with pytest.raises(DetailError, match="wider than"):
        node(27.0, 5.0).geometry()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("profile", "node", "rod"),
    [("FL 80x12", {}, "stud"), ("FL 120x10", {"kind": "tube", "wall_mm": 25.0}, "bolt")],
)
def test_a_job_with_end_plates(
    tmp_path: Path, profile: str, node: dict[str, Any], rod: str
) -> None:
    made = design(
        barrel(2, 2),
        beam={"profile": profile},
        node=node,
        connection={**FOUR, "bolt": "M10", "fastener": rod, "fasteners": True},
        output={"formats": ["step", "csv"]},
        checks={"verify": "sample"},
    )
    result = make(made, tmp_path / "roof")
    assert result.exit_code == 0, result.problems
    found = off_axis(result.folder)
    assert len(found) == 96
    assert max(found.values()) < 0.01


def test_a_bar_as_wide_as_its_plate_still_has_two_bolts() -> None:
    shell = bolted(dome(), beam=BAR, connection={**PLATE, "bolt": "M8"})
    assert shell.joined.places == ((-34.5, 0.0), (34.5, 0.0))

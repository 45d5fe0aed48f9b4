"""K-nets in the main job: normals as node axes, rolled beams, compound cuts where axes lean."""

from __future__ import annotations

import math
import runpy
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from detailing_cases import Case, dome, grid, hexagons, placed, vertical

from ddgfab.errors import DetailError, SupportError
from ddgfab.forms.registry import generate
from ddgfab.measures import torsion
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.nets.knet import crab_net
from ddgfab.support import support_structure
from ddgfab.support.asymptotic import surface_normals
from fabrication import design, make
from fabrication.gridshell.design import Design
from fabrication.gridshell.detailing.gridshell import Gridshell
from fabrication.gridshell.pieces import Beam
from fabrication.standards.profiles import z_range

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
NO_GLASS: dict[str, object] = {"kind": "none"}


def twisted(case: Case, amount: float = 0.25) -> Case:
    """The case with its axes turned at random: torsion, and axes across no beam."""
    rng = np.random.default_rng(3)
    return Case(case.mesh, unit(case.axes + amount * rng.normal(size=case.axes.shape)))


def tower(**parameters: float) -> Case:
    mesh = generate("pseudosphere", {"panels_around": 12, "rings": 5} | parameters)
    return Case(mesh, surface_normals(mesh))


CASES: dict[str, Callable[[], Case]] = {
    "dome": lambda: twisted(dome()),
    "hexagons": lambda: twisted(hexagons()),
    "flat": lambda: twisted(vertical(grid(3, 2))),
    "K-net": tower,
}


def corners(beam: Beam, end: int) -> Floats:
    """World points of the bounding rectangle of an end face."""
    cut, section = (beam.shape.start, beam.shape.end)[end], beam.shape.profile
    points = [
        (cut.x + cut.slope * z + cut.skew * y, y, z)
        for z in z_range(section)
        for y in (-section.width / 2, section.width / 2)
    ]
    return placed(beam.placement, np.array(points))


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("eccentricity", [0.0, 30.0])
def test_ends_stand_on_their_seats(name: str, eccentricity: float) -> None:
    """The cut is parallel to the seat at the clearance, within its width and the node's height."""
    shell = CASES[name]().detail(beam={"eccentricity_mm": eccentricity}, panel=NO_GLASS)
    nodes = {node.vertex: node for node in shell.nodes}
    widest = 0.0
    for beam in shell.beams:
        for end in (0, 1):
            node = nodes[beam.vertices[end]]
            arm = [arm.beam for arm in node.arms].index(beam.mark)
            seat = node.shape.seats[arm]
            frame = node.placement[:3, :3]
            normal = frame @ [math.cos(seat.azimuth), math.sin(seat.azimuth), 0.0]
            face = corners(beam, end) - node.position
            assert face @ normal == pytest.approx(seat.distance + 0.5, abs=1e-9)
            across = np.abs(face @ np.cross(node.axis, normal)).max()
            assert across <= seat.width / 2 + 1e-9
            widest = max(widest, across / seat.width)
            height = face @ node.axis
            assert node.shape.z0 <= height.min() - 5 + 1e-6
            assert node.shape.z1 >= height.max() + 0.5 - 1e-6
            # the roll is the angle from the beam's z to the axis as seen along it
            y, z = beam.placement[:3, 1] @ node.axis, beam.placement[:3, 2] @ node.axis
            assert math.atan2(y, z) == pytest.approx(beam.roll[end], abs=1e-9)
    assert widest > 0.4  # no more than needed: half the seat is reached somewhere


@pytest.mark.parametrize("name", CASES)
def test_the_beam_halves_its_torsion(name: str) -> None:
    shell = CASES[name]().detail(panel=NO_GLASS)
    for beam in shell.beams:
        assert sum(beam.roll) == pytest.approx(0.0, abs=1e-9)
        assert abs(beam.roll[0] - beam.roll[1]) == pytest.approx(beam.torsion, abs=1e-9)
    assert max(beam.torsion for beam in shell.beams) > math.radians(5)


def test_cuts_of_a_knet_are_square_and_of_one_kind() -> None:
    shell = tower().detail(beam={"eccentricity_mm": 30.0}, panel=NO_GLASS)
    delta = math.pi / 12
    for beam in shell.beams:
        cuts = (beam.shape.start, beam.shape.end)
        assert [(cut.slope, cut.skew, cut.radius) for cut in cuts] == [(0.0, 0.0, None)] * 2
        assert beam.torsion == pytest.approx(delta, abs=1e-9)
        assert {round(abs(roll), 9) for roll in beam.roll} == {round(delta / 2, 9)}
    rows = design(
        Mesh.build(shell.mesh.vertices, shell.mesh.faces),
        support={"kind": "normals"},
        beam={"eccentricity_mm": 30.0},
        panel=NO_GLASS,
        checks={"torsion_deg": 16},
    ).beams
    assert {row["number"] for row in rows} == {"BP-001"}


def test_width_of_a_rolled_arm_by_hand() -> None:
    """FL 60x8 rolled by half of 15 deg: 8 cos + 2 reach sin, reach 60 hung or 30 centered."""
    cos, sin = math.cos(math.pi / 24), math.sin(math.pi / 24)
    hung = tower().detail(panel=NO_GLASS)
    centered = tower().detail(beam={"eccentricity_mm": 30.0}, panel=NO_GLASS)
    assert hung.size.width == pytest.approx(8 * cos + 120 * sin)
    assert centered.size.width == pytest.approx(8 * cos + 60 * sin)
    assert centered.size.radius < hung.size.radius


def test_little_torsion_changes_nothing() -> None:
    """Optimized axes keep up to 0.1 deg: cuts stay single mitres, seats as wide as the profile."""
    case = dome()
    noise = np.random.default_rng(5).normal(size=case.axes.shape)
    near = Case(case.mesh, unit(case.axes + 2e-4 * noise))
    assert 0.01 < np.degrees(torsion(near.mesh, near.axes).max()) < 0.1
    shell = near.detail(panel=NO_GLASS)
    assert all(beam.shape.start.skew == beam.shape.end.skew == 0.0 for beam in shell.beams)
    assert not any(any(beam.roll) for beam in shell.beams)
    assert shell.size.width == 8.0


def test_compound_angles_only_where_axes_lean_along_twisted_beams() -> None:
    shell = twisted(dome()).detail(panel=NO_GLASS)
    compound = [b for b in shell.beams if b.shape.start.skew and b.shape.start.slope]
    assert len(compound) > len(shell.beams) // 2


def test_schedule_tells_skew_and_roll_of_twisted_beams_only() -> None:
    extra = {"skew_start_deg", "skew_end_deg", "roll_start_deg", "roll_end_deg"}
    mesh = dome().mesh
    plain = design(mesh, support={"kind": "central"})
    assert not extra & set(plain.beams.columns)
    plan = design(EXAMPLES / "knet_crab.toml")
    assert extra <= set(plan.beams.columns)
    placements = {i.mark: i.placement for f in plan.families for i in f.instances}
    axes = {node.mark: node.axis for node in plan.gridshell.nodes}
    back = 0
    for row, beam in zip(plan.beams, plan.gridshell.beams, strict=True):
        frame = placements[row["mark"]][:3, :3]
        back += row["node_start"] != beam.nodes[0]
        for end in ("start", "end"):
            axis = frame.T @ axes[row[f"node_{end}"]]
            assert row[f"roll_{end}_deg"] == pytest.approx(
                math.degrees(math.atan2(axis[1], axis[2])), abs=1e-4
            )
            assert abs(row[f"skew_{end}_deg"]) < 1e-9
        assert row["torsion_deg"] == pytest.approx(15.0)
    assert 0 <= back < len(plan.beams)


def test_checks_of_torsion_fail_unless_the_limit_is_raised() -> None:
    shell = tower().detail(panel=NO_GLASS)
    assert {check.name for _, check in shell.failures()} == {"torsion_deg"}
    assert len(list(shell.failures())) == len(shell.beams)
    raised = tower().detail(panel=NO_GLASS, checks={"torsion_deg": 15.1})
    assert list(raised.failures()) == []


def test_what_torsion_forbids() -> None:
    with pytest.raises(DetailError, match=r"B-\d+ has torsion 15\.00 deg.*\n.*end = \"flat\""):
        tower().detail(beam={"end": "cope"}, panel=NO_GLASS)
    with pytest.raises(DetailError, match=r"30 mm from the middle.*\n.*eccentricity_mm = 30"):
        tower().detail(
            beam={"profile": "FL 60x20"},
            connection={"kind": "stud", "bolt": "M6"},
            panel=NO_GLASS,
        )
    with pytest.raises(DetailError, match=r"mm wide at their ends \(FL 60x8 rolled by torsion\)"):
        tower().detail(node={"diameter_mm": 24.0}, panel=NO_GLASS)
    case = tower()
    down = Case(
        case.mesh, np.where(np.arange(case.mesh.n_vertices)[:, None] == 30, -1, 1) * case.axes
    )
    with pytest.raises(DetailError, match="N-0030 at 180"):
        down.detail(panel=NO_GLASS)


# --- support -----------------------------------------------------------------------------------
def test_normals_of_a_knet_are_exact() -> None:
    net = crab_net(16, 0.25, 1.1, 9)
    mesh = net.mesh()
    found = surface_normals(mesh)
    assert np.abs(found - net.normals.reshape(-1, 3)).max() < 1e-12
    structure = support_structure(mesh, "normals")
    assert structure.kind == "normals"
    assert not structure.torsion_free
    assert structure.torsion_deg_max == pytest.approx(np.degrees(0.25), abs=1e-9)
    assert structure.torsion == pytest.approx(np.full(mesh.n_edges, 0.25))


def test_normals_of_other_nets_are_the_vertex_normals() -> None:
    mesh = dome().mesh
    assert np.array_equal(surface_normals(mesh), mesh.vertex_normals)


def test_auto_refuses_and_names_the_way_out() -> None:
    mesh = generate("amsler")
    with pytest.raises(SupportError, match=r'asymptotic lines.*kind = "normals"'):
        support_structure(mesh)


def test_kinds_of_knets_take_normals_unless_told_otherwise(tmp_path: Path) -> None:
    path = tmp_path / "p.toml"
    path.write_text('[net]\nkind = "amsler"\n[panel]\nkind = "none"\n')
    plan = design(path)
    assert plan.support.kind == "normals"
    assert "asymptotic lines" in plan.source.notes[0]
    said = design(path, support={"kind": "auto"})  # a default that is written out
    assert (said.support.kind, said.source.notes) == (plan.support.kind, plan.source.notes)
    with pytest.raises(SupportError, match="does not fit this net"):
        design(path, support={"kind": "edge"})
    other = design()
    assert other.support.kind != "normals"
    assert other.source.notes == ()


# --- whole jobs --------------------------------------------------------------------------------
def cleared(plan: Design) -> Gridshell:
    assert list(plan.gridshell.failures()) == []
    assert plan.gridshell.problems == ()
    return plan.gridshell


@pytest.mark.parametrize("name", ["knet_pseudosphere", "knet_crab"])
def test_examples_are_within_their_limits(name: str) -> None:
    plan = design(EXAMPLES / f"{name}.toml")
    shell = cleared(plan)
    assert shell.panels == ()
    assert len({f.number for f in plan.families if f.role == "beam"}) == 1
    assert 100 < len(shell.beams) < 400


def knet_file(path: Path) -> Design:
    return design(
        path,
        project={"median_edge_mm": 900.0},
        support={"kind": "normals"},
        beam={"eccentricity_mm": 30.0},
        panel=NO_GLASS,
        checks={"torsion_deg": 7.0, "verify": "sample"},
    )


def test_a_knet_from_a_file(mesh_file: Callable[[str], Path]) -> None:
    """Coordinates of six digits: cuts are square to within 1e-3, and one beam does for most."""
    plan = knet_file(mesh_file("knet1.obj"))
    shell = cleared(plan)
    assert len(shell.beams) == 840
    assert plan.support.torsion_deg_max == pytest.approx(6.5, abs=0.05)
    assert max(abs(b.shape.start.slope) for b in shell.beams) < 1e-3
    assert max(len(f.instances) for f in plan.families if f.role == "beam") > 400


@pytest.mark.slow
def test_the_job_of_a_knet_from_a_file(mesh_file: Callable[[str], Path], tmp_path: Path) -> None:
    result = make(knet_file(mesh_file("knet1.obj")), tmp_path / "out")
    assert result.exit_code == 0, result.problems


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["amsler", "breather", "crab", "dini", "knet", "kuen"])
def test_every_kind_goes_through(kind: str, tmp_path: Path) -> None:
    size = {
        "crab": {"rings": 3},
        "dini": {"panels_along": 4, "rows": 4},
        "knet": {"panels_along": 4, "panels_across": 3, "bend_along_deg": 10},
    }.get(kind)
    if size is None:
        size = {"panels_along": 3, "panels_across" if kind == "amsler" else "rows": 3}
    path = tmp_path / f"{kind}.toml"
    lines = [f'[net]\nkind = "{kind}"', *(f"{key} = {value}" for key, value in size.items())]
    lines += ['[beam]\neccentricity_mm = 30\n[panel]\nkind = "none"\n[checks]\ntorsion_deg = 14.1']
    path.write_text("\n".join(lines) + "\n")
    result = make(design(path), tmp_path / "out")
    assert result.exit_code == 0, result.problems
    assert result.manifest["support"]["kind"] == "normals"


@pytest.mark.slow
def test_beams_with_compound_angles_keep_their_clearances(tmp_path: Path) -> None:
    """A whole job with leaning, twisted axes: nothing touches, everything reads back."""
    case = twisted(dome(3, 3), 0.12)
    mesh = case.mesh
    moved = mesh.vertices + 300 * np.random.default_rng(2).normal(size=mesh.vertices.shape)
    rough = mesh.with_vertices(moved)
    plan = design(
        rough,
        support={"kind": "normals"},
        beam={"profile": "SHS 40x4", "eccentricity_mm": 20.0},
        panel=NO_GLASS,
        checks={"torsion_deg": 60, "min_angle_deg": 10},
    )
    assert max(abs(b.shape.start.skew) for b in plan.gridshell.beams) > 0.01
    result = make(plan, tmp_path / "out")
    assert result.exit_code == 0, result.problems


def test_the_example_program(capsys: pytest.CaptureFixture[str]) -> None:
    runpy.run_path(str(EXAMPLES / "08_knets.py"), run_name="__main__")
    lines = capsys.readouterr().out.splitlines()
    assert [float(line[28:35]) for line in lines[1:4]] == pytest.approx([2.0] * 3, abs=0.05)
    assert "K = -1 to" in lines[4]
    assert "320 bars of 1 part number and 176 nodes of 11" in lines[5]

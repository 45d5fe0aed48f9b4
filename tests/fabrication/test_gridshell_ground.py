"""Supports: base plates level on the ground, posts up to the nodes, anchors; rules for supports."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bolted import cylinders, placed_shapes
from detailing_cases import Case, dome, grid, placed, vertical
from roofs import barrel

from ddgfab.errors import DetailError, ProjectError
from ddgfab.io import Groups
from fabrication.checks.mesh import to_manifold
from fabrication.families import families
from fabrication.gridshell.design import design
from fabrication.gridshell.detailing.gridshell import Gridshell, detail
from fabrication.gridshell.load import make_project
from fabrication.gridshell.schedules import schedules
from fabrication.job.run import make
from fabrication.parts.base import BaseShape
from fabrication.solids import boundary_of, comparison_mesh, mesh_of, properties_of

SHAPE = BaseShape(150.0, 20.0, 50.0, 17.5, 19.0, 90.0, 0.6, 1.1)
NO_GLASS = {"kind": "none"}


def standing(case: Case, **sections: Any) -> Gridshell:
    return case.detail(
        **{
            "ground": {"where": "boundary"},
            "beam": {"profile": "FL 80x20"},
            "node": {"min_diameter_mm": 80.0},
            "panel": NO_GLASS,
            **sections,
        }
    )


@pytest.mark.parametrize("lean", [0.0, 0.6, 1.1])
def test_volume_two_ways_and_by_its_mesh(lean: float) -> None:
    shape = replace(SHAPE, lean=lean)
    boundary = boundary_of(shape)
    assert boundary is not None
    boundary.validate()
    assert boundary.genus == 4
    found = properties_of(shape)
    assert found.volume == pytest.approx(shape.second_volume(), rel=1e-12)
    body = to_manifold(mesh_of(shape, 0.005))
    assert body.volume() == pytest.approx(found.volume, rel=1e-3)
    plate = shape.plate()
    assert plate.rest == pytest.approx(math.pi * 19.0**2 * 90.0)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"spread": 67.0}, ["8 mm from the edge", "8.75"]),
        ({"spread": 15.0}, ["from the post"]),
        ({"length": 12.0}, ["-0.998", "short side"]),
    ],
)
def test_plates_that_are_none(changes: dict[str, float], words: list[str]) -> None:
    with pytest.raises(DetailError) as caught:
        boundary_of(replace(SHAPE, **changes))
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_plates_in_quarter_turns_are_one_family() -> None:
    """Turned by a quarter the same plate stands the same way; mirrored or longer it does not."""
    shell = standing(dome())
    piece = shell.bases[0]

    def number(**changes: float) -> int:
        other = replace(piece.shape, **changes)
        pair = (piece, replace(piece, mark="G-9999", shape=other))
        return len(families(pair, 0.01))

    quarter = piece.shape.azimuth + 0.5 * math.pi
    assert number(azimuth=quarter) == 1
    assert number(azimuth=-piece.shape.azimuth + 0.3) == 2
    assert number(length=piece.shape.length + 0.1) == 2
    assert number(diameter=13.5) == 2
    turned = replace(piece, mark="G-1", shape=replace(piece.shape, azimuth=quarter))
    (family,) = families((piece, turned), 0.01)
    own, shared = to_manifold(mesh_of(turned.shape)), to_manifold(mesh_of(family.shape))
    motion = np.linalg.inv(turned.placement) @ family.instances[1].placement
    assert (own ^ shared.transform(motion[:3])).volume() > 0.999 * own.volume()
    assert (own ^ shared).volume() < 0.998 * own.volume()


def test_plates_are_level_and_posts_meet_their_nodes() -> None:
    case = dome()
    shell = standing(case)
    rim = set(np.flatnonzero(case.mesh.boundary_vertex).tolist())
    assert {base.vertex for base in shell.bases} == rim
    nodes = {node.mark: node for node in shell.nodes}
    drops = set()
    for base in shell.bases:
        node = nodes[base.node]
        points = placed(base.placement, comparison_mesh(base.shape, 0.01).vertices)
        assert points[:, 2].min() == pytest.approx(base.ground, abs=1e-9)
        under = points[np.abs(points[:, 2] - base.ground) < 1e-9]
        assert np.ptp(under[:, 0]) * np.ptp(under[:, 1]) > base.shape.width**2 * 0.99
        # The rim of the post's end lies in the plane of the node's bottom, within its circle.
        local = placed(np.linalg.inv(node.placement), points)
        end = local[np.abs(local[:, 2] - node.shape.z0 + 0.5) < 1e-6]
        assert len(end) > 8
        assert np.hypot(end[:, 0], end[:, 1]).max() <= shell.size.seat + 1e-6
        assert local[:, 2].max() <= node.shape.z0 - 0.5 + 1e-6
        assert all(check.passed for check in base.checks)
        drops.add(round(case.mesh.vertices[base.vertex, 2] - base.ground, 6))
    assert len(drops) == 1
    assert drops.pop() % 5.0 == 0.0


def test_a_level_for_all_plates() -> None:
    case = dome()
    level = float(case.mesh.vertices[:, 2].min()) - 400.0
    shell = standing(case, ground={"where": "boundary", "level_mm": level})
    assert {base.ground for base in shell.bases} == {level}
    for base in shell.bases:
        assert base.placement[2, 3] == pytest.approx(level + base.shape.thickness)
    with pytest.raises(DetailError) as caught:
        standing(case, ground={"where": "boundary", "level_mm": level + 390.0})
    words = str(caught.value)
    assert "too high for the base plates of N-0" in words
    lower = float(words.split("take [ground] level_mm = ")[1].split()[0])
    standing(case, ground={"where": "boundary", "level_mm": lower})


def test_anchors_are_on_the_axes_of_their_holes() -> None:
    shell = standing(dome(), ground={"where": "boundary", "fasteners": True})
    assert len(shell.anchors) == 4 * len(shell.bases)
    bases = {base.mark: base for base in shell.bases}
    for anchor in shell.anchors:
        base = bases[anchor.base]
        place = np.linalg.inv(base.placement) @ np.array([*anchor.point, 1.0])
        assert min(math.dist(place[:2], hole) for hole in base.shape.places) < 1e-9
        assert place[2] == pytest.approx(-base.shape.thickness)
        assert anchor.depth >= 160.0
        # rod: from the ground up through plate, washer and nut, a pitch beyond
        rod = anchor.mounted[0]
        assert rod.shape.length == pytest.approx(anchor.depth + 20.0 + 3.0 + 14.8 + 2.0)
    tables = schedules(shell)
    assert {row["designation"]: row["quantity"] for row in tables["fasteners"]}[
        "ISO 4032 M16"
    ] == len(shell.anchors)
    assert len(tables["bases"]) == len(shell.bases)
    assert len(tables["anchors"]) == len(shell.anchors)


@pytest.mark.parametrize("kind", ["cylinder", "tube", "star", "plates"])
def test_every_kind_of_node_stands_on_a_post(kind: str) -> None:
    connection: dict[str, Any] = {
        "star": {"kind": "bolted_tongue", "bolt": "M12"},
        "plates": {"kind": "slotted", "bolt": "M16"},
    }.get(kind, {"kind": "stud"})
    profile = "FL 280x120" if kind == "plates" else "FL 80x50"
    node = {"kind": kind} | ({"diameter_mm": 139.7, "wall_mm": 20.0} if kind == "tube" else {})
    shell = standing(dome(), beam={"profile": profile}, node=node, connection=connection)
    pieces = {p.mark: p for p in (*shell.nodes, *shell.beams)}
    for base in shell.bases[:4]:
        foot = to_manifold(comparison_mesh(base.shape, 0.02))
        node_piece = pieces[base.node]
        for mark in (base.node, *(arm.beam for arm in node_piece.arms)):
            other = pieces[mark]
            motion = np.linalg.inv(base.placement) @ other.placement
            body = to_manifold(comparison_mesh(other.shape, 0.02)).transform(motion[:3])
            assert (foot ^ body).volume() < 1.0, mark
            if mark == base.node:  # half a mm apart: a little lower they would overlap
                motion[2, 3] -= 1.0
                lower = to_manifold(comparison_mesh(other.shape, 0.02)).transform(motion[:3])
                assert (foot ^ lower).volume() > 100.0


def test_rules_for_supports() -> None:
    case = dome()
    shell = standing(
        case,
        ground={"where": [0, 5], "kind": "none"},
        beam={"profile": "FL 60x20", "rules": [{"where": "supports", "profile": "FL 100x30"}]},
        node={"rules": [{"where": "supports", "diameter_mm": 140.0}]},
    )
    assert shell.bases == shell.anchors == ()
    assert {n.vertex for n in shell.nodes if n.shape.radius == 70.0} == {0, 5}
    for beam in shell.beams:
        stands = bool({0, 5} & set(beam.vertices))
        assert (beam.shape.profile.name == "FL 100x30") == stands


GROUPS = Groups.of({"feet": ([0, 2], [])})


@pytest.mark.parametrize(
    ("sections", "words"),
    [
        ({"node": {"rules": [{"where": "supports", "margin_mm": 9.0}]}},
         ["[[node]] rule 1", '[ground] names none', 'set [ground] where']),
        ({"beam": {"rules": [{"where": "supports", "profile": "FL 60x8"}]}},
         ["[[beam]] rule 1", "[ground] names none"]),
        ({"ground": {"where": "group:fet"}},
         ['[ground] where: the net has no group "fet"', "feet"]),
        ({"ground": {"where": [9]}}, ["[ground] where selects vertex 9", "0 to 8"]),
        ({"ground": {"where": []}}, ["[ground] where = [] selects no node"]),
        ({"ground": {"where": "boundary"},
          "node": {"rules": [{"where": "boundary", "margin_mm": 9.0},
                             {"where": "supports", "margin_mm": 8.0}]}},
         ['(where = "boundary") and 2 (where = "supports") both select node N-0000 and 7 more']),
        ({"ground": {"where": "group:feet", "post_mm": 90.0}},
         ["N-0000", "post_mm = 90 ", "takes 20.0 to", "take [ground] post_mm ="]),
        ({"ground": {"where": "group:feet"}, "node": {"min_diameter_mm": 0.0}},
         ["a post needs a diameter of 20.0 mm", '[[node]] where = "supports" with diameter_mm =']),
    ],
)  # fmt: skip
def test_what_does_not_stand(sections: dict[str, Any], words: list[str]) -> None:
    case = vertical(grid(2, 2))
    project = make_project({"panel": NO_GLASS, "beam": {"profile": "FL 60x8"}, **sections})
    with pytest.raises(DetailError) as caught:
        detail(case.mesh, case, project, GROUPS)
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_an_axis_that_lies_down_has_no_post() -> None:
    case = vertical(grid(2, 2))
    turn = np.array([[1.0, 0, 0], [0, 0, 1.0], [0, -1.0, 0]])
    upright = Case(case.mesh.with_vertices(case.mesh.vertices @ turn), case.axes @ turn)
    with pytest.raises(DetailError, match=r"more than 75 deg.*N-0000 \(90.0 deg\)"):
        standing(upright)


def test_only_the_lowest_of_a_place() -> None:
    case = dome()
    rim = np.flatnonzero(case.mesh.boundary_vertex)
    z = case.mesh.vertices[rim, 2]
    shell = standing(case, ground={"where": "boundary", "below_mm": 100.0})
    assert [base.vertex for base in shell.bases] == rim[z <= z.min() + 100.0].tolist()
    assert 0 < len(shell.bases) < len(rim)


def test_a_wrong_place_in_the_section() -> None:
    with pytest.raises(ProjectError, match=r'"bounday".*boundary'):
        make_project({"ground": {"where": "bounday"}})


@pytest.mark.slow
def test_a_job_with_base_plates(tmp_path: Path) -> None:
    """Parts, clearances, STEP read back; every anchor has its hole in the assembly, upright."""
    made = design(
        barrel(2, 3),
        beam={"profile": "FL 60x20"},
        ground={"where": "boundary", "fasteners": True},
        node={"min_diameter_mm": 60.0},
        output={"formats": ["step", "dxf", "csv"]},
        checks={"verify": "sample"},
    )
    result = make(made, tmp_path / "roof")
    assert result.exit_code == 0, result.problems
    shapes = dict(placed_shapes(tmp_path / "roof" / "assembly.step"))
    for anchor in made.gridshell.anchors:
        off = [
            np.hypot(*(point - anchor.point)[:2])
            for point, along, diameter in cylinders(shapes[anchor.base])
            if abs(diameter - anchor.hole) < 1e-6 and abs(abs(along[2]) - 1.0) < 1e-9
        ]
        assert min(off) < 0.01
    assert (tmp_path / "roof" / "parts" / "dxf" / "GP-001.dxf").exists()

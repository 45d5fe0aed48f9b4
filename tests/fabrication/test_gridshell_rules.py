"""Rules by place: profiles of beams at the boundary, or of some edges."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from detailing_cases import Case, dome, grid, vertical
from roofs import barrel
from test_connections import hole_axes

from ddgfab.errors import DetailError, ProjectError
from ddgfab.io import Groups
from fabrication.gridshell.design import design
from fabrication.gridshell.detailing.gridshell import Gridshell, detail
from fabrication.gridshell.load import load_project, make_project
from fabrication.gridshell.template import project_template
from fabrication.job.run import make
from fabrication.standards.profiles import z_range

NET = '[net]\nkind = "canopy"\n'
WIDE = "RHS 100x60x4"


def ruled(case: Case, *rules: dict[str, Any], **sections: Any) -> Gridshell:
    return case.detail(
        **{
            "beam": {"profile": "FL 60x20", "rules": list(rules)},
            "panel": {"kind": "none"},
            **sections,
        }
    )


def test_boundary_beams_have_their_own_profile() -> None:
    case = dome()
    shell = ruled(case, {"where": "boundary", "profile": WIDE})
    rim = {f"B-{e:04d}" for e in np.flatnonzero((case.mesh.edge_faces < 0).any(axis=1))}
    assert 0 < len(rim) < len(shell.beams)
    for beam in shell.beams:
        assert beam.shape.profile.name == (WIDE if beam.mark in rim else "FL 60x20")


def test_edges_by_number() -> None:
    shell = ruled(dome(), {"where": [3, 5, 5], "profile": WIDE})
    assert [b.edge for b in shell.beams if b.shape.profile.name == WIDE] == [3, 5]


@pytest.mark.parametrize("rules", [({"where": "boundary", "profile": WIDE},), ()])
def test_nodes_cover_the_ends_of_all_beams(rules: tuple[dict[str, Any], ...]) -> None:
    """Every corner of every cut lies between bottom and top of its node, on the seat's width."""
    shell = ruled(dome(), *rules)
    nodes = {node.mark: node for node in shell.nodes}
    for beam in shell.beams:
        profile = beam.shape.profile
        for end, cut in enumerate((beam.shape.start, beam.shape.end)):
            node = nodes[beam.nodes[end]]
            seat = node.shape.seats[[a.beam for a in node.arms].index(beam.mark)]
            for z in z_range(profile):
                point = np.array([cut.x + cut.slope * z, 0.0, z, 1.0])
                local = np.linalg.inv(node.placement) @ beam.placement @ point
                assert node.shape.z0 < local[2] < node.shape.z1
                assert np.hypot(local[0], local[1]) == pytest.approx(seat.distance + 0.5)
            assert profile.width <= seat.width


def test_a_rule_for_all_edges_is_that_profile_for_all() -> None:
    """A second route: the same shapes as with the profile in [beam]."""
    case = vertical(grid(2, 2))
    every = ruled(case, {"where": list(range(12)), "profile": WIDE})
    plain = case.detail(beam={"profile": WIDE}, panel={"kind": "none"})
    for one, two in zip(every.beams, plain.beams, strict=True):
        assert one.shape.key() == two.shape.key()
        assert one.shape.end.x == pytest.approx(two.shape.end.x)
    for one, two in zip(every.nodes, plain.nodes, strict=True):
        assert (one.shape.radius, one.shape.z0) == (two.shape.radius, two.shape.z0)


@pytest.mark.parametrize(
    ("rules", "words"),
    [
        ([{"where": [99], "profile": WIDE}], ["rule 1 selects edge 99", "0 to 11"]),
        ([{"where": [12], "profile": WIDE}], ["rule 1 selects edge 12", "0 to 11"]),
        ([{"where": [3, -1], "profile": WIDE}], ["rule 1 selects edge -1", "0 to 11"]),
        ([{"where": [], "profile": WIDE}], ["rule 1 (where = []) selects no beam"]),
        (
            [{"where": "boundary", "profile": WIDE}, {"where": [0], "profile": "FL 80x20"}],
            ['rules 1 (where = "boundary") and 2 (where = [0]) both select beam B-0000'],
        ),
    ],
)
def test_rules_that_select_nothing_or_twice(rules: list[dict[str, Any]], words: list[str]) -> None:
    with pytest.raises(DetailError) as caught:
        ruled(vertical(grid(2, 2)), *rules)
    assert all(word in str(caught.value) for word in words), str(caught.value)


@pytest.mark.parametrize("eccentricity", [0.0, 25.0])
def test_studs_of_two_profiles_stay_on_their_axes(eccentricity: float) -> None:
    """Every bolt on the axes of both its holes, also where two profiles meet at a node."""
    rules = [{"where": "boundary", "profile": "FL 100x50"}]
    shell = dome().detail(
        beam={"profile": "FL 80x40", "rules": rules, "eccentricity_mm": eccentricity},
        connection={"kind": "stud"},
        node={"rules": [{"where": "boundary", "diameter_mm": 150.0, "margin_mm": 12.0}]},
        panel={"kind": "none"},
    )
    ends = {(bolt.beam, bolt.end) for bolt in shell.bolts}
    assert len(ends) == len(shell.bolts) == 2 * len(shell.beams)
    assert [bolt.mark for bolt in shell.bolts[:2]] == ["J-0000", "J-0001"]
    assert [bolt.node for bolt in shell.bolts] == sorted(bolt.node for bolt in shell.bolts)
    found = hole_axes(shell)
    for bolt in shell.bolts:
        (p, u), (q, v) = found[bolt.mark]
        assert u @ v == pytest.approx(1.0, abs=1e-12)
        assert np.linalg.norm(np.cross(q - p, u)) < 1e-9
        assert np.linalg.norm(np.cross(bolt.point - p, u)) < 1e-9
        assert (q - bolt.point) @ u == pytest.approx(0.5)


def test_tongues_of_two_profiles() -> None:
    """The holes of every star are at the height of the middle of its own beam's depth."""
    rules = [{"where": "boundary", "profile": "FL 120x50"}]
    shell = dome().detail(
        beam={"profile": "FL 80x40", "rules": rules},
        node={"kind": "star"},
        connection={"kind": "bolted_tongue", "bolt": "M10"},
        panel={"kind": "none"},
    )
    beams = {beam.mark: beam for beam in shell.beams}
    nodes = {node.mark: node for node in shell.nodes}
    assert len(shell.bolts) == 4 * len(shell.beams)
    for bolt in shell.bolts:
        beam, node = beams[bolt.beam], nodes[bolt.node]
        place = np.linalg.inv(beam.placement) @ np.array([*bolt.point, 1.0])
        assert place[1] == pytest.approx(0.0, abs=1e-9)
        assert place[2] == pytest.approx(-0.5 * beam.shape.profile.depth)
        assert min(abs(place[0] - hole.x) for hole in beam.shape.holes) < 1e-9
        place = np.linalg.inv(node.placement) @ np.array([*bolt.point, 1.0])
        k = [arm.beam for arm in node.arms].index(bolt.beam)
        holes = [hole for hole in node.shape.holes if hole.arm == k]
        reach = np.hypot(place[0], place[1])
        assert min(abs(hole.distance - reach) + abs(hole.z - place[2]) for hole in holes) < 1e-9


def test_nodes_of_one_place() -> None:
    case = dome()
    rules = [
        {"where": "boundary", "kind": "tube", "diameter_mm": 101.6, "wall_mm": 10.0},
        {"where": [20], "margin_mm": 42.0},
    ]
    shell = case.detail(node={"rules": rules}, panel={"kind": "none"})
    plain = case.detail(panel={"kind": "none"})
    rim = set(np.flatnonzero(case.mesh.boundary_vertex).tolist())
    assert [node.vertex for node in shell.nodes] == list(range(case.mesh.n_vertices))
    for node, before in zip(shell.nodes, plain.nodes, strict=True):
        shape = node.shape
        if node.vertex in rim:
            assert (shape.radius, shape.bore) == (50.8, 40.8)
        else:
            assert (shape.radius, shape.bore) == (before.shape.radius, 0.0)
            lower = before.shape.z0 - shape.z0
            assert lower == (37.0 if node.vertex == 20 else 0.0)
    for beam, before in zip(shell.beams, plain.beams, strict=True):
        for end, vertex in enumerate(beam.vertices):
            assert (beam.offsets[end] > before.offsets[end] + 10) == (vertex in rim)
            if vertex not in rim:
                assert beam.offsets[end] == pytest.approx(before.offsets[end])
    assert shell.size.radius == plain.size.radius


def test_a_node_rule_for_all_is_that_node_for_all() -> None:
    case = dome()
    own = {"kind": "tube", "wall_mm": 9.0, "min_diameter_mm": 60.0}
    every = case.detail(node={"rules": [{"where": list(range(42)), **own}]})
    plain = case.detail(node=own)
    assert [repr(n.shape) for n in every.nodes] == [repr(n.shape) for n in plain.nodes]
    assert every.offset == plain.offset


GROUPS = Groups.of({"ridge": ([], [[0, 1], [1, 2]]), "feet": ([0, 2, 6], []), "far": ([], [])})


def test_groups_select_beams_and_nodes() -> None:
    case = vertical(grid(2, 2))
    project = make_project(
        {
            "beam": {"rules": [{"where": "group:ridge", "profile": WIDE}]},
            "node": {"rules": [{"where": "group:feet", "diameter_mm": 160.0}]},
            "panel": {"kind": "none"},
        }
    )
    shell = detail(case.mesh, case, project, GROUPS)
    wide = {tuple(sorted(beam.vertices)) for beam in shell.beams if beam.shape.profile.name == WIDE}
    assert wide == {(0, 1), (1, 2)}
    assert {n.vertex for n in shell.nodes if n.shape.radius == 80.0} == {0, 2, 6}


@pytest.mark.parametrize(
    ("groups", "sections", "words"),
    [
        (GROUPS, {"beam": {"rules": [{"where": "group:rigde", "profile": WIDE}]}},
         ['no group "rigde"; did you mean ridge?']),
        (Groups(), {"beam": {"rules": [{"where": "group:a", "profile": WIDE}]}},
         ["the net has no groups", "g NAME"]),
        (GROUPS, {"beam": {"rules": [{"where": "group:feet", "profile": WIDE}]}},
         ['where = "group:feet") selects no beam']),
        (GROUPS, {"node": {"rules": [{"where": "group:far", "margin_mm": 9.0}]}},
         ["selects no node"]),
        (GROUPS, {"node": {"rules": [{"where": [-1], "margin_mm": 9.0}]}},
         ["[[node]] rule 1 selects vertex -1", "0 to 8"]),
        (GROUPS, {"node": {"rules": [{"where": [9], "margin_mm": 9.0}]}},
         ["[[node]] rule 1 selects vertex 9", "0 to 8"]),
        (GROUPS, {"node": {"rules": [{"where": "boundary", "margin_mm": 9.0},
                                     {"where": "group:feet", "margin_mm": 8.0}]}},
         ['1 (where = "boundary") and 2 (where = "group:feet") both select node N-0000 and 2']),
        (GROUPS, {"node": {"rules": [{"where": [4], "diameter_mm": 10.0}]}}, ["N-0004", "10"]),
    ],
)  # fmt: skip
def test_places_that_are_not_there(
    groups: Groups, sections: dict[str, Any], words: list[str]
) -> None:
    case = vertical(grid(2, 2))
    with pytest.raises(DetailError) as caught:
        detail(case.mesh, case, make_project({"panel": {"kind": "none"}, **sections}), groups)
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_tables_in_a_file(tmp_path: Path) -> None:
    path = tmp_path / "roof.toml"
    path.write_text(
        NET
        + '[[beam]]\nprofile = "FL 60x20"\n'
        + f'[[beam]]\nwhere = "boundary"\nprofile = "{WIDE}"\n'
        + '[[beam]]\nwhere = [7]\nprofile = "FL 80x20"\n'
        + '[[node]]\nkind = "tube"\nwall_mm = 9\n'
        + '[[node]]\nwhere = "group:feet"\nkind = "cylinder"\nseries_mm = [90, 100]\n'
    )
    project = load_project(path)
    assert project.beam.profile == "FL 60x20"
    assert [(r.where, r.profile) for r in project.beam.rules] == [
        ("boundary", WIDE),
        ((7,), "FL 80x20"),
    ]
    changed = load_project(path, {"beam": {"profile": "FL 90x20"}})
    assert (changed.beam.profile, changed.beam.rules) == ("FL 90x20", project.beam.rules)
    assert project.settings["beam"]["rules"][0] == {"where": "boundary", "profile": WIDE}
    again = tmp_path / "again.toml"
    again.write_text(project_template(project), encoding="utf-8")
    assert load_project(again).beam == project.beam
    assert load_project(again).node == project.node
    own = project.node.under(project.node.rules[0])
    assert (own.kind, own.series_mm, own.rules) == ("cylinder", (90.0, 100.0), ())


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('[[beam]]\nprofile = "FL 60x8"\n[[beam]]\nprofile = "FL 80x8"\n', ["2 [[beam]] tables"]),
        ('[[beam]]\nwhere = "boundary"\nprofile = "IPE 80"\n', ["IPE 80", "near"]),
        ('[[beam]]\nwhere = "border"\nprofile = "FL 60x8"\n', ["border", "boundary"]),
        ("[[beam]]\nwhere = [1]\n", ["rule 1 needs profile"]),
        ("[[beam]]\nwhere = [1]\nprofle = 3\n", ["rule 1", "profle", "profile"]),
        ('[[beam]]\nwhere = "group:"\nprofile = "FL 60x8"\n', ["group:NAME"]),
        ('[[node]]\nwhere = "bounday"\nmargin_mm = 3\n', ["bounday", '"boundary"', "group:NAME"]),
        ("[[node]]\nwhere = [1]\n", ["rule 1 changes nothing"]),
        ("[[node]]\nwhere = [1]\nmargn_mm = 3\n", ["rule 1", "margn_mm", "margin_mm"]),
        ("[[node]]\nwhere = [1]\nmargin_mm = -3\n", ["rule 1", "margin_mm", "0"]),
        ('[[node]]\nwhere = [1]\nkind = "ball"\n', ["rule 1", "ball"]),
        ("[[node]]\nwhere = [1]\nwall_mm = 5\n", ["rule 1", "wall_mm is for kind"]),
        ("[[node]]\nmargin_mm = 3\n[[node]]\nmargin_mm = 4\n", ["2 [[node]] tables"]),
    ],
)
def test_bad_tables(text: str, words: list[str], tmp_path: Path) -> None:
    path = tmp_path / "roof.toml"
    path.write_text(NET + text)
    with pytest.raises(ProjectError) as caught:
        load_project(path)
    assert all(word in str(caught.value) for word in words), str(caught.value)


@pytest.mark.slow
def test_a_job_with_an_edge_beam(tmp_path: Path) -> None:
    """Parts, clearances, STEP read back: with edge beams deeper and wider than the others."""
    made = design(
        barrel(2, 3),
        beam={"profile": "FL 60x20", "rules": [{"where": "boundary", "profile": WIDE}]},
        output={"formats": ["step", "csv"]},
        checks={"verify": "sample"},
    )
    result = make(made, tmp_path / "roof")
    assert result.exit_code == 0, result.problems
    assert {row["profile"] for row in made.beams} == {"FL 60x20", WIDE}

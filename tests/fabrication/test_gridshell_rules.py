"""Rules by place: profiles of beams at the boundary, or of some edges."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from detailing_cases import Case, dome, grid, vertical
from roofs import barrel

from ddgfab.errors import DetailError, ProjectError
from fabrication.gridshell.design import design
from fabrication.gridshell.detailing.gridshell import Gridshell
from fabrication.gridshell.load import load_project
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
            ["rules 1 and 2 (where = [0]) both select beam B-0000"],
        ),
    ],
)
def test_rules_that_select_nothing_or_twice(rules: list[dict[str, Any]], words: list[str]) -> None:
    with pytest.raises(DetailError) as caught:
        ruled(vertical(grid(2, 2)), *rules)
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_bolted_beams_have_one_profile() -> None:
    with pytest.raises(DetailError, match=r'where = "boundary": with .* "stud" all beams have one'):
        ruled(dome(), {"where": "boundary", "profile": WIDE}, connection={"kind": "stud"})


def test_tables_in_a_file(tmp_path: Path) -> None:
    path = tmp_path / "roof.toml"
    path.write_text(
        NET
        + '[[beam]]\nprofile = "FL 60x20"\n'
        + f'[[beam]]\nwhere = "boundary"\nprofile = "{WIDE}"\n'
        + '[[beam]]\nwhere = [7]\nprofile = "FL 80x20"\n'
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


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('[[beam]]\nprofile = "FL 60x8"\n[[beam]]\nprofile = "FL 80x8"\n', ["2 [[beam]] tables"]),
        ('[[beam]]\nwhere = "boundary"\nprofile = "IPE 80"\n', ["IPE 80", "near"]),
        ('[[beam]]\nwhere = "border"\nprofile = "FL 60x8"\n', ["border", "boundary"]),
        ("[[beam]]\nwhere = [1]\n", ["rule 1 needs profile"]),
        ("[[beam]]\nwhere = [1]\nprofle = 3\n", ["rule 1", "profle", "profile"]),
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

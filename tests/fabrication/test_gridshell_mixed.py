"""Connections by place: several kinds in one structure, and what cannot be on one bar."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from bolted import off_axis
from connection_cases import worst_off_axis
from detailing_cases import Case, dome
from roofs import barrel

from ddgfab.errors import DetailError, ProjectError
from fabrication.gridshell.design import design
from fabrication.gridshell.detailing.gridshell import Gridshell
from fabrication.gridshell.load import load_project, make_project
from fabrication.gridshell.schedules import schedules
from fabrication.gridshell.template import project_template
from fabrication.job.run import make
from fabrication.solids import boundary_of, properties_of

RIM = {"where": "boundary"}
FIELD: dict[str, dict[str, Any]] = {
    "welded": {"kind": "welded"},
    "stud": {"kind": "stud"},
    "end_plate": {"kind": "end_plate"},
}


def mixed(case: Case, field: dict[str, Any], rim: dict[str, Any], **sections: Any) -> Gridshell:
    return case.detail(
        **{
            "beam": {"profile": "FL 80x40"},
            "connection": {**field, "rules": [{**RIM, **rim}]},
            "panel": {"kind": "none"},
            **sections,
        }
    )


@pytest.mark.parametrize("profile", ["FL 80x40", "RHS 100x60x5"])
@pytest.mark.parametrize(
    ("field", "rim"),
    [("welded", "stud"), ("stud", "welded"), ("end_plate", "stud"), ("stud", "end_plate")],
)
def test_two_kinds_on_one_bar(field: str, rim: str, profile: str) -> None:
    """Bolts on the axes of both holes; the volume two ways; each end as the rule of its node."""
    case = dome()
    shell = mixed(case, FIELD[field], FIELD[rim], beam={"profile": profile})
    on_rim = case.mesh.boundary_vertex
    for beam in shell.beams:
        assert beam.joined is not None
        for end, vertex in enumerate(beam.vertices):
            assert beam.joined[end].kind == (rim if on_rim[vertex] else field)
    both = [b for b in shell.beams if on_rim[list(b.vertices)].sum() == 1]
    assert both
    for beam in both[:3]:
        boundary = boundary_of(beam.shape)
        assert boundary is not None
        boundary.validate()
        volume = properties_of(beam.shape).volume
        assert volume == pytest.approx(beam.shape.second_volume(), rel=1e-9)
    assert len(shell.bolts) > 0
    assert worst_off_axis(shell) < 1e-9


def test_a_rule_for_all_nodes_is_that_connection_for_all() -> None:
    case = dome()
    every = {"where": list(range(42)), "kind": "stud", "bolt": "M10"}
    ruled = mixed(case, {}, every)
    plain = case.detail(
        beam={"profile": "FL 80x40"},
        connection={"kind": "stud", "bolt": "M10"},
        panel={"kind": "none"},
    )
    assert [repr(b.shape) for b in ruled.beams] == [repr(b.shape) for b in plain.beams]
    assert [repr(n.shape) for n in ruled.nodes] == [repr(n.shape) for n in plain.nodes]
    assert {bolt.size for bolt in ruled.bolts} == {"M10"}


def test_sizes_by_place_are_in_the_lists() -> None:
    shell = mixed(dome(), {"kind": "stud", "bolt": "M10"}, {"bolt": "M12"})
    tables = schedules(shell)
    rim = {n.mark for n in shell.nodes if shell.mesh.boundary_vertex[n.vertex]}
    for row in tables["bolts"]:
        assert row["size"] == ("M12" if row["node"] in rim else "M10")
        assert row["size"] in row["fastener"]
    parts = [row["parts"] for row in tables["order"] if row["setting"] == "connection.bolt"]
    assert sorted(parts) == ["connections", 'connections at "boundary"']


def test_the_list_of_beams_names_the_kind_of_each_end() -> None:
    case = dome()
    shell = mixed(case, {"kind": "welded"}, {"kind": "stud"})
    rim = case.mesh.boundary_vertex
    marks = {node.mark: bool(rim[node.vertex]) for node in shell.nodes}
    for row in schedules(shell)["beams"]:
        kinds = ["stud" if marks[row[f"node_{end}"]] else "welded" for end in ("start", "end")]
        same = kinds[0] == kinds[1]
        wanted = kinds[0] if same else f"{kinds[0]} at the start, {kinds[1]} at the end"
        assert row["connection"] == wanted
        assert (row.get("hole_start_diameter_mm") is not None) == (kinds[0] == "stud")


@pytest.mark.parametrize(
    ("field", "rim", "nodes", "words"),
    [
        ({"kind": "stud"}, {"kind": "bolted_tongue", "bolt": "M10"}, {"kind": "star"},
         ["beam B-", "stud at its", "bolted_tongue at its", '"welded" at the other']),
        ({"kind": "stud"}, {"where": "group:feet", "kind": "welded"}, {}, ["no groups"]),
        ({"kind": "stud"}, {"where": [], "kind": "welded"}, {},
         ["[[connection]] rule 1", "selects no node"]),
        ({"kind": "stud"}, {"where": "supports", "kind": "welded"}, {},
         ["[[connection]] rule 1", "[ground] names none"]),
        ({"kind": "welded"}, {"kind": "slotted"}, {}, ['needs [node] kind = "plates"']),
    ],
)  # fmt: skip
def test_what_does_not_go_together(
    field: dict[str, Any], rim: dict[str, Any], nodes: dict[str, Any], words: list[str]
) -> None:
    node = {"rules": [{**RIM, **nodes}]} if nodes else {}
    with pytest.raises(DetailError) as caught:
        mixed(dome(), field, rim, node=node)
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_two_rules_for_one_node() -> None:
    rules = [{**RIM, "kind": "stud"}, {"where": [0], "kind": "end_plate"}]
    with pytest.raises(DetailError, match=r"\[\[connection\]\] rules 1 .* both select node N-0000"):
        dome().detail(connection={"rules": rules}, panel={"kind": "none"})


@pytest.mark.parametrize(
    ("section", "words"),
    [
        ({"kind": "welded", "rules": [{"where": [1], "kind": "stud", "bolts": 4}]},
         ["rule 1", "bolts is for kind"]),
        ({"kind": "welded", "fasteners": True}, ["fasteners is for kind"]),
        ({"kind": "welded", "rules": [{"where": [1], "kind": "studs"}]}, ["rule 1", "studs"]),
    ],
)  # fmt: skip
def test_bad_sections(section: dict[str, Any], words: list[str]) -> None:
    with pytest.raises(ProjectError) as caught:
        make_project({"connection": section})
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_tables_of_connections_in_a_file(tmp_path: Path) -> None:
    path = tmp_path / "roof.toml"
    path.write_text(
        '[net]\nkind = "canopy"\n[[connection]]\nfasteners = true\n'
        '[[connection]]\nwhere = "boundary"\nkind = "stud"\nbolt = "M16"\n'
    )
    project = load_project(path)
    assert project.connection.kind == "welded"
    own = project.connection.of_rule(1)
    assert (own.kind, own.bolt, own.fasteners) == ("stud", "M16", True)
    again = tmp_path / "again.toml"
    again.write_text(project_template(project), encoding="utf-8")
    assert load_project(again).connection == project.connection
    path.write_text('[net]\nkind = "canopy"\n[[connection]]\nwhere = [1]\nbolt_class = "10.9"\n')
    with pytest.raises(ProjectError, match=r"rule 1.*bolt_class"):
        load_project(path)


@pytest.mark.slow
def test_a_job_with_two_kinds(tmp_path: Path) -> None:
    """Every bolt has its two holes on one axis in the assembly read back."""
    made = design(
        barrel(2, 3),
        beam={"profile": "RHS 100x60x5"},
        connection={"kind": "end_plate", "rules": [{**RIM, "kind": "stud"}]},
        output={"formats": ["step", "csv"]},
        checks={"verify": "sample"},
    )
    result = make(made, tmp_path / "roof")
    assert result.exit_code == 0, result.problems
    off = off_axis(tmp_path / "roof")
    assert len(off) == len(made.gridshell.bolts)
    assert max(off.values()) < 0.01

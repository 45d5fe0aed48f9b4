"""COMPAS JSON: read by our own reader, and by COMPAS where it is installed."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from roofs import barrel
from wholes import whole_of

from ddgfab.io import read_mesh
from fabrication.formats.base import Contents, Whole
from fabrication.gridshell.compas import NET
from fabrication.gridshell.design import Design, design
from fabrication.gridshell.load import make_project


@pytest.fixture(scope="module")
def roof() -> Design:
    return design(barrel(2, 3), project={"name": "Dach 'Nord' 東"})


@pytest.fixture(scope="module")
def whole(roof: Design) -> Whole:
    return whole_of(roof, frozenset({"B-0003", "P-0001"}))


@pytest.fixture(scope="module")
def written(roof: Design, whole: Whole, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("compas")
    made = roof.product().format("compas")
    assert made.whole_files(Contents(whole.about, whole.families, (), 0)) == [NET]
    assert made.write_whole(folder, whole) == []
    assert all(check.passed for check in made.check_whole(folder, whole))
    return folder / NET


def test_the_net_comes_back_and_every_piece_has_its_place(
    roof: Design, whole: Whole, written: Path
) -> None:
    found = read_mesh(written).mesh
    np.testing.assert_array_equal(found.vertices, roof.mesh.vertices)
    np.testing.assert_array_equal(found.corners, roof.mesh.corners)
    data = json.loads(written.read_text("utf-8"))["data"]
    rows = [*data["vertex"].values(), *data["edgedata"].values(), *data["facedata"].values()]
    stated = {row["mark"]: (row["number"], row["status"]) for row in rows}
    assert stated == {
        mark: (number, "rejected" if mark in whole.failed else "ok")
        for number, mark, _ in whole.standing()
    }


def test_a_net_that_changed_is_found(
    roof: Design, whole: Whole, written: Path, tmp_path: Path
) -> None:
    made = roof.product().format("compas")
    record = json.loads(written.read_text("utf-8"))
    record["data"]["vertex"]["4"]["z"] += 0.5
    (tmp_path / NET).write_text(json.dumps(record), "utf-8")
    failed = [check for check in made.check_whole(tmp_path, whole) if not check.passed]
    assert [(c.name, c.value) for c in failed] == [("compas positions_mm", pytest.approx(0.5))]
    record["data"]["face"]["0"].reverse()
    (tmp_path / NET).write_text(json.dumps(record), "utf-8")
    names = {check.name for check in made.check_whole(tmp_path, whole) if not check.passed}
    assert "compas net" in names or "compas readable" in names
    (tmp_path / NET).write_text("{}", "utf-8")
    assert [c.passed for c in made.check_whole(tmp_path, whole)] == [False]


def test_projects_know_the_format() -> None:
    project = make_project({"output": {"formats": ["csv", "compas"]}})
    assert project.output.formats == ("csv", "compas")


def test_compas_reads_it(roof: Design, written: Path) -> None:
    compas = pytest.importorskip("compas")
    mesh = compas.json_load(str(written))
    assert type(mesh).__name__ == "Mesh"
    assert mesh.is_valid()
    assert mesh.is_manifold()
    assert mesh.name == roof.project.name
    assert mesh.number_of_edges() == len(roof.gridshell.beams)
    for beam in roof.gridshell.beams:
        edge = tuple(int(v) for v in roof.mesh.edges[beam.edge])
        assert mesh.edge_attribute(edge, "mark") == beam.mark
    for node in roof.gridshell.nodes:
        assert mesh.vertex_attribute(node.vertex, "axis") == pytest.approx(list(node.axis))
    for panel in roof.gridshell.panels:
        assert mesh.face_attribute(panel.face, "mark") == panel.mark

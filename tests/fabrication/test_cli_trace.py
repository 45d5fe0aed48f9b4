"""`ddgfab trace`: from surfaces by name and from STEP faces to mesh files."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from ddgfab.io import read_mesh
from fabrication.cli import app
from fabrication.surfaces_in.cad import read_cad_surface


def run(*arguments: object) -> tuple[int, str]:
    result = CliRunner().invoke(app, ["trace", *map(str, arguments)])
    return result.exit_code, result.output


def height(x, y):
    return 3000 * (1 - 0.7 * (y / 8000) ** 2 - 0.2 * (x / 12000) ** 2) + 0.02 * x


@pytest.fixture(scope="module")
def roof(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A face through points of a known height, trimmed by an ellipse with a round hole."""
    import build123d

    x, y = np.meshgrid(np.linspace(-12e3, 12e3, 11), np.linspace(-8e3, 8e3, 9), indexing="ij")
    rows = np.stack([x, y, height(x, y)], axis=-1).tolist()
    face = build123d.Face.make_surface_from_array_of_points(
        [[build123d.Vector(*point) for point in row] for row in rows]
    )
    base = build123d.Plane.XY.offset(-3000)
    outer = build123d.extrude(base * build123d.Ellipse(10e3, 7e3), 12e3)
    hole = build123d.extrude(base * build123d.Pos(2000, 1000) * build123d.Circle(1500), 12e3)
    trimmed = face.intersect(outer - hole)[0]
    path = tmp_path_factory.mktemp("step") / "roof.step"
    build123d.export_step(trimmed, str(path))
    return path


@pytest.mark.slow
def test_step_face_is_read_with_its_trims(roof: Path) -> None:
    surface = read_cad_surface(roof)
    outer, hole = surface.trim.loops
    x, y, z = surface.points(outer).T
    assert np.abs((x / 10e3) ** 2 + (y / 7e3) ** 2 - 1).max() < 1e-5
    x, y, z = surface.points(hole).T
    assert np.abs(np.hypot(x - 2000, y - 1000) - 1500).max() < 0.1
    assert np.abs(z - height(x, y)).max() < 1.0  # the kernel fits its own spline


@pytest.mark.slow
def test_step_face_becomes_a_net_with_a_hole(roof: Path, tmp_path: Path) -> None:
    target = tmp_path / "net.obj"
    code, text = run(roof, "-o", target, "--spacing", 1200)
    assert code == 0, text
    mesh = read_mesh(target).mesh
    assert len(mesh.boundary_loops) == 2
    x, y, z = mesh.vertices.T
    assert np.abs(z - height(x, y)).max() < 1.0
    assert 0.8 * 1200 < np.median(mesh.edge_lengths) < 1.2 * 1200


def test_named_surface_with_parameters_and_report(tmp_path: Path) -> None:
    target = tmp_path / "net.obj"
    code, text = run(
        "saddle", "-o", target, "--spacing", 2000, "--set", "net.width_mm=12e3", "--json"
    )
    assert code == 0, text
    record = json.loads(text)
    mesh = read_mesh(target).mesh
    assert record["vertices"] == mesh.n_vertices
    assert np.ptp(mesh.vertices[:, 0]) == pytest.approx(12e3)
    assert record["planarity_percent"][1] < 0.01
    assert record["umbilics"] == []


def test_plane_sections_are_plane(tmp_path: Path) -> None:
    target = tmp_path / "net.obj"
    code, text = run("dome", "-o", target, "--along", "0,1,0", "--spacing", 2500)
    assert code == 0, text
    rows = np.unique(np.round(read_mesh(target).mesh.vertices[:, 1], 3))
    assert len(rows) < 12  # the dome is a translation surface


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["sadle"], "did you mean saddle"),
        (["saddle", "--set", "net.width=3"], "[net] width is unknown; did you mean width_mm"),
        (["saddle", "--set", "width_mm=3"], "such as net.width_mm=3"),
        (["saddle", "--set", "net.spacing_mm=-3"], "[net] spacing_mm = -3 must be greater than 0"),
        (["ellipsoid-cap", "--set", "net.semi_x_mm=1e-300"], "must lie between 0.001 and 1e+09"),
        (["saddle", "--set", "net.width_mm=1e300"], "must lie between 0.001 and 1e+09"),
        (["saddle", "--scale", "2"], "surfaces by name are in millimetres"),
        (["missing.step", "--set", "net.spacin_mm=3"], "did you mean spacing_mm"),
        (["saddle", "--spacing", "90000"], "spacing 90000"),
        (["missing.step"], "no such file"),
        (["roof.fbx"], 'unknown kind of surface file ".fbx"'),
        (["saddle", "--along", "1,2"], "expected three numbers"),
        (["saddle", "--along", "0,1,0", "--turn", "5"], "choose one"),
        ([], "which surface"),
    ],
)
def test_bad_input_is_named(arguments: list[str], message: str, tmp_path: Path) -> None:
    code, text = run(*arguments, "-o", tmp_path / "net.obj")
    assert code == 2
    assert message in text
    assert not list(tmp_path.iterdir())


def test_report_with_tags_and_picture_lie_beside_the_mesh(tmp_path: Path) -> None:
    target = tmp_path / "net.obj"
    code, text = run("saddle", "-o", target, "--spacing", 2500, "--through", "0,0,0")
    assert code == 0, text
    record = json.loads(target.with_suffix(".json").read_text())
    read = read_mesh(target)
    mesh = read.in_place
    tags = record["vertex_tags"]
    for name in ("inner", "rim", "corner"):  # groups of the file, for rules of projects
        ids = [v for v, tag in enumerate(tags) if tag == name or (name, tag) == ("rim", "corner")]
        assert read.groups.vertices_of(name).tolist() == ids
    assert len(read.groups.edges_of("rim")) == int(mesh.boundary_edge.sum())
    assert not read.notes
    assert len(tags) == mesh.n_vertices
    assert tags.count("corner") == 4
    assert sum(tag != "inner" for tag in tags) == int(mesh.boundary_vertex.sum())
    assert np.linalg.norm(mesh.vertices, axis=1).min() < 1.0  # a node where lines were asked for
    assert record["edges"]["principal_deg"][0] < 0.5
    assert target.with_suffix(".png").stat().st_size > 20_000
    code, text = run("saddle", "-o", target, "--through", "0,0")
    assert code == 2
    assert "--through 0,0: expected three numbers" in text

"""Edge offsets in the main job: Koebe ball and minimal surface as gridshells, files, circles."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from ddgfab.circles import Circles
from ddgfab.errors import ProjectError
from ddgfab.io import read_mesh, write_obj
from ddgfab.mesh import Floats
from ddgfab.nets import SIsothermic
from ddgfab.nets.koebe.solids import cube_cells
from ddgfab.offsets import classify_offset
from fabrication import design
from fabrication.cli import app
from fabrication.gridshell.design import Design
from fabrication.gridshell.load import load_project

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
NAMES = ("koebe_ball", "minimal_schwarz")
LIMIT = 1e-9


def run(*words: object) -> Result:
    return CliRunner().invoke(app, [str(word) for word in words])


def lower_nodes(plan: Design, depth: float) -> Floats:
    """Where the lower edges of beams of a depth meet each node axis, beam by beam: (E, 2, 3).

    A beam hangs in its plane below the mesh edge; its lower edge is `depth` away from it.
    """
    mesh, axes = plan.support.mesh, plan.support.axes
    along = mesh.edge_vectors / mesh.edge_lengths[:, None]
    points = np.empty((mesh.n_edges, 2, 3))
    for k in (0, 1):
        v = mesh.edges[:, k]
        down = axes[v] - np.einsum("ex,ex->e", axes[v], along)[:, None] * along
        reach = depth / np.linalg.norm(down, axis=1)
        points[:, k] = mesh.vertices[v] - reach[:, None] * axes[v]
    return points


@pytest.mark.parametrize("name", NAMES)
def test_beams_have_one_height_and_their_lower_edges_meet_at_the_nodes(name: str) -> None:
    plan = design(EXAMPLES / f"{name}.toml")
    mesh = plan.support.mesh
    assert plan.support.kind == "edge"
    assert plan.support.torsion_deg_max < LIMIT
    assert plan.support.beam_height_spread is not None
    assert plan.support.beam_height_spread < LIMIT
    depth = 80.0
    assert {beam.shape.profile.name for beam in plan.gridshell.beams} == {"FL 80x12"}
    ends = lower_nodes(plan, depth)
    below = np.full((mesh.n_vertices, 3), np.nan)
    below[mesh.edges.ravel()] = ends.reshape(-1, 3)
    assert np.abs(below[mesh.edges] - ends).max() < LIMIT  # mm: all beams of a node agree
    report = classify_offset(mesh, below)
    assert report.is_parallel
    assert report.spread["edge"] < LIMIT
    assert report.distance["edge"] == pytest.approx(depth)
    assert 60 <= mesh.n_faces <= 120
    # Beams as specified: the datum of each runs along its edge, z away from the lower one.
    for beam in plan.gridshell.beams[::17]:
        z = np.array(beam.placement)[:3, 2]
        middle = 0.5 * (ends[beam.edge, 0] + ends[beam.edge, 1])
        edge = mesh.vertices[mesh.edges[beam.edge]].mean(axis=0)
        assert abs((edge - middle) @ z - depth) < LIMIT


@pytest.mark.slow
def test_the_job_tells_of_the_edge_offset(tmp_path: Path) -> None:
    """`tests/test_readme.py` runs all examples; here what is said of this one."""
    done = run("make", EXAMPLES / "koebe_ball.toml", "-o", tmp_path / "ball")
    assert done.exit_code == 0, done.output
    assert "edge offset: beams of one height meet at the nodes" in done.output
    manifest = json.loads((tmp_path / "ball" / "manifest.json").read_text())
    assert manifest["support"]["kind"] == "edge"
    assert manifest["support"]["beam_height_spread"] < LIMIT
    assert manifest["checks"]["failed"] == 0


def test_a_net_made_for_edge_offset_gets_it_without_being_asked(tmp_path: Path) -> None:
    path = tmp_path / "roof.toml"
    path.write_text('[net]\nkind = "minimal"\nsurface = "enneper"\ncells = 6\n')
    assert design(path).support.kind == "edge"


def test_combinatorics_lie_beside_the_project(tmp_path: Path) -> None:
    mesh = cube_cells(4)
    write_obj(tmp_path / "cells.obj", mesh)
    text = (tmp_path / "cells.obj").read_text().split("\n")
    first = next(i for i, line in enumerate(text) if line.startswith("f"))
    text[first:] = ["g other", *text[first : first + 80], "g piece", *text[first + 80 :]]
    (tmp_path / "cells.obj").write_text("\n".join(text))
    path = tmp_path / "roof.toml"
    words = '[net]\nkind = "minimal"\nsurface = "file"\npolyhedron_file = "cells.obj"\n'
    path.write_text(words)
    plan = design(path)
    assert plan.mesh.n_faces == 16
    assert plan.source.file is not None
    assert plan.source.file.endswith("cells.obj")
    assert plan.source.sha256 is not None
    path.write_text(words + 'piece = "roof"\n')
    with pytest.raises(Exception, match='no faces are marked "roof"'):
        design(path)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ('surface = "catnoid"', 'surface = "catnoid" is unknown; did you mean catenoid'),
        ("surface = 4", "surface = 4 must be a text in quotes"),
        ('surfce = "catenoid"', "did you mean surface"),
        ("cells = 3.5", "whole number"),
    ],
)
def test_mistakes_name_file_line_and_key(line: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "roof.toml"
    path.write_text(f'[net]\nkind = "minimal"\n{line}\n')
    with pytest.raises(ProjectError, match=words) as caught:
        load_project(path)
    assert caught.value.line == 3


def test_the_command_lists_choices_and_writes_circles(tmp_path: Path) -> None:
    said = run("net", "minimal", "--list").output
    assert 'surface = "catenoid"  which minimal surface [catenoid, enneper, scherk' in said
    target, circles = tmp_path / "ball.obj", tmp_path / "ball.csv"
    words = ["--set", "net.shape=cube", "--set", "net.cells=3", "-o", target]
    done = run("net", "koebe", *words, "--circles", circles)
    assert done.exit_code == 0, done.output
    assert "54 incircles, 56 vertex-circles, 56 spheres" in done.output
    with circles.open() as stream:
        assert len(list(csv.DictReader(stream))) == 54 + 56 + 56
    refused = run("net", "translation", "-o", tmp_path / "t.obj", "--circles", circles)
    assert refused.exit_code == 2
    assert "not s-isothermic" in refused.output
    assert not (tmp_path / "t.obj").exists()


@pytest.mark.slow
def test_circles_as_step_are_read_by_the_kernel(tmp_path: Path) -> None:
    from build123d import GeomType, import_step

    target = tmp_path / "ball.step"
    words = ["--set", "net.shape=cube", "--set", "net.cells=2", "-o", tmp_path / "ball.obj"]
    done = run("net", "koebe", *words, "--circles", target)
    assert done.exit_code == 0, done.output
    edges = import_step(str(target)).edges()
    assert len(edges) == 24 + 26 + 3 * 26
    assert all(edge.geom_type == GeomType.CIRCLE for edge in edges)
    curves = SIsothermic.of(read_mesh(tmp_path / "ball.obj").mesh).curves()
    radii = [
        given.radii if isinstance(given, Circles) else given.great_circles().radii
        for given in curves.values()
    ]
    found = np.sort([edge.radius for edge in edges])
    assert np.abs(found - np.sort(np.concatenate(radii))).max() < 1e-6

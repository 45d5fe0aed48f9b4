"""`ddgfab optimize` and [optimize]: files, reports, conflicts."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from ddgfab.grid import grid_mesh
from ddgfab.io import read_mesh, write_mesh
from ddgfab.measures import planarity_percent
from ddgfab.mesh import Mesh
from ddgfab.optimize import Change
from ddgfab.optimize.pane_size import misfit
from fabrication import design
from fabrication.cli import app
from fabrication.cli.common import Reading

EDGE_MM = 1000.0


def skew(cells: int = 8, bend: float = 0.08) -> Mesh:
    """A skew dome: edges across the principal directions, so that no quad is flat."""
    u, v = np.meshgrid(np.arange(cells + 1.0), np.arange(cells + 1.0), indexing="ij")
    z = bend * (0.6 * u * v - 0.5 * u**2 - 0.4 * v**2)
    return grid_mesh(EDGE_MM * np.stack([u, v, z], axis=-1))


@pytest.fixture
def roof(tmp_path: Path) -> Path:
    path = tmp_path / "roof.obj"
    write_mesh(path, skew())
    return path


def run(*words: object) -> tuple[int, str]:
    result = CliRunner().invoke(app, [str(word) for word in words])
    return result.exit_code, result.output


def test_planar_is_the_default_goal(roof: Path, tmp_path: Path) -> None:
    target = tmp_path / "flat.obj"
    code, said = run("optimize", roof, "-o", target, "--no-picture")
    assert code == 0, said
    mesh = read_mesh(target).mesh
    assert planarity_percent(mesh).max() <= 0.2
    report = json.loads((tmp_path / "flat.json").read_text())
    moved = np.linalg.norm(mesh.vertices - read_mesh(roof).mesh.vertices, axis=1)
    assert report["movement_max"] == pytest.approx(moved.max(), abs=1e-4)
    assert report["before"]["measures"]["planarity_percent"]["greatest"] > 1
    assert report["after"]["measures"]["planarity_percent"]["greatest"] <= 0.2
    assert 0 < report["design"]["distance_mean"] < 0.25 * report["design"]["mean_edge"]
    assert report["prices"][-1]["percent"] <= 0.2
    assert report["history"]
    assert "planarity, max" in said
    assert "distance from the surface, both ways" in said
    assert "price list" in said
    assert not (tmp_path / "flat.png").exists()


def test_picture(roof: Path, tmp_path: Path) -> None:
    code, said = run("optimize", roof, "-o", tmp_path / "flat.off")
    assert code == 0, said
    assert "no picture" in said or (tmp_path / "flat.png").stat().st_size > 10_000


def test_exact_and_close_are_options(roof: Path, tmp_path: Path) -> None:
    target = tmp_path / "flat.obj"
    code, said = run("optimize", roof, "-o", target, "--flat", 0, "--no-picture")
    assert code == 0, said
    assert planarity_percent(read_mesh(target).mesh).max() < 1e-7
    for keep in ("close", "0.4"):
        code, said = run("optimize", roof, "-o", target, "--keep", keep, "--no-picture")
        assert code == 0, said


def test_missed_goals_keep_the_best_mesh_apart_and_name_the_next_command(
    roof: Path, tmp_path: Path
) -> None:
    target = tmp_path / "flat.obj"
    code, said = run(
        "optimize", roof, "-o", target, "--set", "optimize.distance_limit_edges=[0.001, 1.0]"
    )
    assert code == 1
    assert "limit 0.001" in said
    assert not target.exists()
    assert not (tmp_path / "flat.json").exists()
    assert planarity_percent(read_mesh(tmp_path / "flat.missed.obj").mesh).max() <= 0.2
    (line,) = [line for line in said.splitlines() if line.startswith("next: ")]
    assert "--keep close" in line
    assert "--set 'optimize.distance_limit_edges=[0.001, 1]'" in line
    for _ in range(6):  # what is named helps, in the end
        words = shlex.split(line.removeprefix("next: ddgfab "))
        code, said = run(*words, "--no-picture")
        if code == 0:
            break
        (line,) = [line for line in said.splitlines() if line.startswith("next: ")]
    assert code == 0, said
    assert target.exists()


def test_limit_of_movement(roof: Path, tmp_path: Path) -> None:
    code, said = run("optimize", roof, "-o", tmp_path / "flat.obj", "--max-movement", "0.001")
    assert code == 1
    assert "--max-movement 0.002" in said


def test_another_surface(roof: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.obj"
    mesh = read_mesh(roof).mesh
    write_mesh(other, mesh.with_vertices(mesh.vertices + np.array([0, 0, 400])))
    code, said = run("optimize", roof, "-o", tmp_path / "a.obj", "--surface", other, "--no-picture")
    assert code == 0, said
    code, said = run("optimize", roof, "-o", tmp_path / "b.obj", "--no-picture")
    assert code == 0, said
    near, own = (json.loads((tmp_path / f"{name}.json").read_text()) for name in "ab")
    apart = Change(read_mesh(other).mesh, read_mesh(tmp_path / "b.obj").mesh, read_mesh(other).mesh)
    assert apart.distance_mean > 200
    assert near["design"]["distance_mean"] < 0.5 * apart.distance_mean
    assert own["design"]["distance_mean"] < 100


def test_impossible_boundary_names_faces(tmp_path: Path) -> None:
    """One skew quad whose four corners are fixed cannot be flat."""
    path = tmp_path / "quad.obj"
    write_mesh(path, skew(1, 0.3))
    code, said = run("optimize", path, "-o", tmp_path / "out.obj", "--boundary", "fixed")
    assert code == 1
    assert "1 faces cannot be planar" in said
    assert "faces 0" in said
    assert not (tmp_path / "out.obj").exists()
    (command,) = [line for line in said.splitlines() if line.startswith("next: ")]
    code, said = run(
        *shlex.split(command)[2:], "--no-picture", "--set", "optimize.rise_limit_percent=0"
    )
    assert code == 0, said


def test_a_surface_that_is_elsewhere_is_refused(roof: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.obj"
    mesh = read_mesh(roof).mesh
    write_mesh(other, mesh.with_vertices(mesh.vertices + np.array([9000.0, 0, 20000])))
    code, said = run("optimize", roof, "--surface", other)
    assert code == 2
    assert "from the mesh on average" in said
    assert "one place and one unit" in said


def test_the_next_command_keeps_the_surface(roof: Path, tmp_path: Path) -> None:
    words = ["optimize", roof, "-o", tmp_path / "out.obj", "--surface", roof]
    code, said = run(*words, "--set", "optimize.zigzag_limit_deg=0.01")
    assert code == 1
    (command,) = [line for line in said.splitlines() if line.startswith("next: ")]
    assert f"--surface {roof}" in command


def test_advice_where_no_net_can_be_traced_does_not_come_back(tmp_path: Path) -> None:
    """Too few vertices for a fit: after the smooth and the traced net, the result is accepted."""
    source = tmp_path / "cap.obj"
    write_mesh(source, skew(5))
    words = ["optimize", source, "-o", tmp_path / "out.obj", "--goal", "circular"]
    words += ["--set", "optimize.zigzag_limit_deg=0.01", "--set", "optimize.rise_limit_percent=0"]
    seen = []
    for _ in range(6):
        code, said = run(*words, "--no-picture")
        if code == 0:
            break
        (command,) = [line for line in said.splitlines() if line.startswith("next: ")]
        assert command not in seen
        seen.append(command)
        words = shlex.split(command)[2:]
    assert code == 0
    assert any("--retrace" in command for command in seen)


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["--goal", "round"], "[optimize] goal"),
        (["--boundary", "loose"], "[optimize] boundary"),
        (["--fix", "1,x"], "x is not a vertex"),
        (["--fix", "9999"], "9999"),
        (["--max-movement", "-1"], "max_movement_mm"),
        (["--flat", "-1"], "flat_percent"),
        (["--keep", "far"], "keep"),
        (["--goal", "families", "--keep", "close"], 'keep is for goal = "planar"'),
        (["--set", "optimize.goall=planar"], "did you mean goal"),
        (["--set", "goal=planar"], "expected section.key=value, such as optimize.goal=planar"),
    ],
)
def test_bad_options(roof: Path, tmp_path: Path, words: list[str], expected: str) -> None:
    code, said = run("optimize", roof, "-o", tmp_path / "out.obj", *words)
    assert code == 2, said
    assert expected in said
    assert sorted(p.name for p in tmp_path.iterdir()) == ["roof.obj"]


def test_bad_targets(roof: Path, tmp_path: Path) -> None:
    assert "unknown kind of mesh file" in run("optimize", roof, "-o", tmp_path / "out.stp")[1]
    assert "no folder" in run("optimize", roof, "-o", tmp_path / "none" / "out.obj")[1]


def test_project_section(roof: Path) -> None:
    plan = design(str(roof), optimize={"goal": "planar"}, panel={"kind": "none"})
    assert plan.optimized is not None
    assert planarity_percent(plan.mesh).max() <= 0.2
    assert plan.support.torsion_free
    assert design(str(roof), panel={"kind": "none"}).optimized is None


def test_far_away_in_metres_the_result_lies_where_the_source_lay(tmp_path: Path) -> None:
    away = np.array([456789.0, 5412345.0, 430.0])
    mesh = skew()
    near, far = tmp_path / "near.obj", tmp_path / "far.obj"
    write_mesh(near, mesh)
    write_mesh(far, mesh.with_vertices(mesh.vertices / 1000.0 + away), units="m")
    code, text = run("optimize", near, "-o", tmp_path / "a.obj", "--no-picture")
    assert code == 0, text
    # The surface has the source's corner cut off: its own local origin would be another one.
    part = Mesh.build(mesh.vertices / 1000.0 + away, mesh.faces[1:])
    write_mesh(tmp_path / "part.obj", part, units="m")
    for extra in ((), ("--surface", far), ("--surface", tmp_path / "part.obj")):
        words = ["optimize", far, "-o", tmp_path / "b.obj", "--no-picture", *extra]
        # The corner is an edge away from a surface without it.
        code, text = run(*words, "--set", "optimize.distance_limit_edges=[0.25, 1.5]")
        assert code == 0, text
        one = read_mesh(tmp_path / "a.obj", units="stated").mesh.vertices
        other = read_mesh(tmp_path / "b.obj", units="stated").in_place.vertices
        limit = 1.0 if extra[1:] != (tmp_path / "part.obj",) else 100.0  # [mm]
        assert np.abs(other - 1000.0 * away - one).max() < limit


def test_the_next_command_reads_the_mesh_the_same_way() -> None:
    assert Reading().arguments() == []
    given = Reading("cm", 2.0, "-y", True, True, 0.5).arguments()
    assert " ".join(given) == "--units cm --scale 2 --up -y --flip --quads --weld 0.5"


def test_inspect_and_optimize_say_what_planar_faces_will_cost(roof: Path, tmp_path: Path) -> None:
    code, said = run("inspect", roof)
    assert code == 0
    (line,) = [line for line in said.splitlines() if line.startswith("planar faces: expect about")]
    told = json.loads(run("inspect", roof, "--json")[1])["planar_forecast"]
    assert told["text"] == line
    assert 0 < told["distance_mean"] < 0.1 * told["unit"]
    code, said = run("optimize", roof, "-o", tmp_path / "flat.obj", "--no-picture")
    assert code == 0, said
    assert line in said
    code, said = run("inspect", tmp_path / "flat.obj")
    assert "planar faces:" not in said
    assert json.loads(run("inspect", tmp_path / "flat.obj", "--json")[1])["planar_forecast"] is None


def test_crumpled_roofs_name_the_diagonals_with_the_unit_of_the_file(tmp_path: Path) -> None:
    x, y = np.meshgrid(np.arange(21.0), np.arange(13.0), indexing="ij")
    z = 1.5 * np.sin(np.pi * x / 5 + 0.5) * np.cos(np.pi * y / 6)
    path = tmp_path / "waves.obj"
    write_mesh(path, grid_mesh(np.stack([x, y, z], axis=-1)), units=None)
    code, said = run("optimize", path, "--units", "m", "-o", tmp_path / "flat.obj", "--no-picture")
    assert code == 1
    assert "crumpled" in said
    (line,) = [line for line in said.splitlines() if line.startswith("next: ")]
    words = shlex.split(line.removeprefix("next: "))
    assert words == [
        *("ddgfab", "optimize", str(path), "-o", str(tmp_path / "flat.obj"), "--units", "m"),
        "--diagonals",
    ]
    assert (tmp_path / "flat.missed.obj").exists()
    assert run(*words[1:], "--no-picture")[0] == 0
    flat = read_mesh(tmp_path / "flat.obj").mesh
    assert planarity_percent(flat).max() <= 0.2
    assert flat.n_faces == 20 * 13 + 21 * 12  # an edge each
    assert run(*words[1:], "--retrace")[0] == 2


def test_panes_no_larger_than_what_is_made(roof: Path, tmp_path: Path) -> None:
    target = tmp_path / "flat.obj"
    code, said = run("optimize", roof, "-o", target, "--max-pane", "700,1100", "--no-picture")
    assert code == 0, said
    assert misfit(read_mesh(target).mesh, (700.0, 1100.0)).max() <= 1 + 1e-6
    assert read_mesh(target).mesh.n_faces > read_mesh(roof).mesh.n_faces
    assert "largest pane" in said
    code, said = run("optimize", roof, "-o", target, "--max-pane", "wide", "--no-picture")
    assert code == 2
    assert "--max-pane wide: expected two lengths in mm, such as 1500,2500" in said
    settings = "[net]\nfile = 'roof.obj'\n[optimize]\ngoal = 'planar'\nmax_pane_mm = [700, 1100]\n"
    (tmp_path / "job.toml").write_text(settings)
    job = design(tmp_path / "job.toml")
    assert misfit(job.mesh, (700.0, 1100.0)).max() <= 1 + 1e-9
    assert not job.gridshell.problems


def test_wishes_for_equal_edges_tell_their_price(roof: Path, tmp_path: Path) -> None:
    target = tmp_path / "flat.obj"
    words = ("optimize", roof, "-o", target, "--no-picture", "--equal-edges")
    code, said = run(*words, 1, "--set", "optimize.equal_weight=1")
    assert code == 0, said
    assert "price of the wish, distance mean / greatest:" in said
    price = json.loads((tmp_path / "flat.json").read_text())["wishes"]
    _, without, now = price["repetitions"][0]["spread"]
    assert now < without
    assert 0 < price["distance_mean"] < 100
    for count in ("-1", "9999"):
        code, said = run(*words, count)
        assert code == 2
        assert "equal_edges" in said
    code, said = run("optimize", roof, "--goal", "families", "--equal-edges", "1")
    assert code == 2
    assert 'equal_edges is for goal = "planar"' in said


def test_meshes_that_cannot_be_traced_anew_name_the_command_on_their_own_edges(
    tmp_path: Path,
) -> None:
    source = tmp_path / "two.obj"
    one = skew()
    apart = one.vertices + np.array([20 * EDGE_MM, 0, 0])
    faces = [*one.faces, *(face + one.n_vertices for face in one.faces)]
    write_mesh(source, Mesh.build(np.concatenate([one.vertices, apart]), faces), units="mm")
    code, text = run("optimize", source, "-o", tmp_path / "out.obj", "--retrace")
    assert code != 0
    assert "2 pieces; one is needed" in text
    (command,) = [line for line in text.splitlines() if line.startswith("next: ")]
    assert "--retrace" not in command
    assert not list(tmp_path.glob("out*"))
    code, text = run(*shlex.split(command)[2:], "--no-picture")
    assert code == 0, text

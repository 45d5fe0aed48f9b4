"""`ddgfab dilemma`: directions, forecast, the changed mesh where its file had it, a picture."""

from __future__ import annotations

import json
import runpy
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from ddgfab.grid import grid_mesh
from ddgfab.io import read_mesh, write_mesh
from ddgfab.measures import planarity_percent
from fabrication.cli import app

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "surface_dilemma.py"


def run(*arguments: object) -> tuple[int, str]:
    result = CliRunner().invoke(app, ["dilemma", *map(str, arguments)])
    return result.exit_code, result.output


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> Path:
    mesh = runpy.run_path(str(EXAMPLE))["lattice"](np.radians(30))
    path = tmp_path_factory.mktemp("drawn") / "drawn.obj"
    write_mesh(path, mesh.with_vertices(mesh.vertices + np.array([5e6, 4e6, 0])), units="mm")
    return path


def test_forecast_alone_writes_nothing(drawn: Path, tmp_path: Path) -> None:
    code, text = run(drawn, "--forecast", "-o", tmp_path / "a.obj")
    assert code == 0, text
    assert "from principal      median 30," in text
    assert "168.2 mm at most along the normal" in text
    assert not list(tmp_path.iterdir())


def test_mesh_report_and_picture(drawn: Path, tmp_path: Path) -> None:
    target = tmp_path / "moved.obj"
    code, text = run(drawn, "-o", target, "--json")
    assert code == 0, text
    record = json.loads(text)
    assert record["keep"] == 0.5
    before, after = (read_mesh(path).in_place for path in (drawn, target))
    moved = np.linalg.norm(after.vertices - before.vertices, axis=1).max()
    assert moved == pytest.approx(record["movement_max"], abs=0.01)
    assert 150 < moved < 180
    assert planarity_percent(after).max() < 1e-4
    assert target.with_suffix(".png").stat().st_size > 20_000


def test_settings_are_options_too(drawn: Path) -> None:
    by_option = run(drawn, "--forecast", "--json", "--keep", "0.2", "--up", "-x")
    settings = ("--set", "dilemma.keep=0.2", "--set", "net.up=-x")
    assert run(drawn, "--forecast", "--json", *settings) == by_option
    assert json.loads(by_option[1])["forecast"]["keep"] == 0.2
    code, text = run(drawn, "--forecast", "--set", "dilemma.keap=1")
    assert code == 2
    assert "did you mean keep?" in text
    code, text = run(drawn, "--forecast", "--set", "optimize.keep=1")
    assert code == 2
    assert "it takes dilemma.key=value" in text


def test_what_is_refused_is_said(drawn: Path, tmp_path: Path) -> None:
    target = tmp_path / "moved.obj"
    for arguments, message in (
        (("--goal", "conical"), 'goal "conical" is unknown'),
        (("--keep", "-1"), "keep -1: a part of the anisotropy"),
        (("--surface", "dome"), "lies"),
    ):
        code, text = run(drawn, "-o", target, *arguments)
        assert code == 2
        assert message in text
    assert not target.exists()


def test_inspect_advises_and_optimize_traces_anew(tmp_path: Path) -> None:
    along = np.linspace(-8e3, 8e3, 14)
    u, v = np.meshgrid(along, along, indexing="ij")
    x, y = 0.8 * u - 0.6 * v, 0.6 * u + 0.8 * v
    mesh = grid_mesh(np.stack([x, y, x**2 / 24e3 - y**2 / 36e3], axis=-1))
    drawn, target = tmp_path / "drawn.obj", tmp_path / "anew.obj"
    write_mesh(drawn, mesh, units="mm")
    result = CliRunner().invoke(app, ["inspect", str(drawn)])
    assert result.exit_code == 0, result.output
    assert "ddgfab optimize --diagonals" in result.output
    result = CliRunner().invoke(
        app, ["optimize", str(drawn), "-o", str(target), "--retrace", "--no-picture"]
    )
    assert result.exit_code == 0, result.output
    assert "note: retraced on a smooth surface" in result.output
    made = read_mesh(target).in_place
    assert planarity_percent(made).max() <= 0.2
    x, y, z = made.vertices.T
    assert np.abs(z - x**2 / 24e3 + y**2 / 36e3).max() < 60
    assert json.loads(target.with_suffix(".json").read_text())["retraced"]["lines"][0] > 5
    result = CliRunner().invoke(app, ["optimize", str(drawn), "--retrace", "--fix", "0"])
    assert result.exit_code == 2
    assert "--fix and --surface" in result.output

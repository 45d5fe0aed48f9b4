"""`ddgfab dilemma`: directions, forecast, the changed mesh where its file had it, a picture."""

from __future__ import annotations

import json
import runpy
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

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


def test_what_is_refused_is_said(drawn: Path, tmp_path: Path) -> None:
    target = tmp_path / "moved.obj"
    for arguments, message in (
        (("--wish", "conical"), 'wish "conical" is unknown'),
        (("--keep", "-1"), "keep -1: a part of the anisotropy"),
        (("--surface", "dome"), "lies"),
    ):
        code, text = run(drawn, "-o", target, *arguments)
        assert code == 2
        assert message in text
    assert not target.exists()

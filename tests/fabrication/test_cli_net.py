"""`ddgfab net`: kinds, parameters, formats, offsets and mistakes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from ddgfab.forms.registry import find_generator, generate, kinds
from ddgfab.io import read_mesh
from fabrication.cli import app


def net(*words: object) -> Result:
    return CliRunner().invoke(app, ["net", *(str(word) for word in words)])


def test_list_shows_all_kinds_and_parameters() -> None:
    said = net("--list").output
    for kind in kinds():
        assert f"{kind}: {find_generator(kind).summary}" in said
    assert "domes = 2  domes in a row [1 to 9]" in said
    assert net("canal", "--list").output.count(":") < said.count(":")


@pytest.mark.parametrize("suffix", [".obj", ".off", ".ply"])
def test_every_format_reads_back(suffix: str, tmp_path: Path) -> None:
    target = tmp_path / f"roof{suffix}"
    said = net("translation", "--set", "net.panels_along=5", "--set", "net.domes=1", "-o", target)
    assert said.exit_code == 0, said.output
    assert str(target) in said.output
    again = read_mesh(target).mesh
    wanted = generate("translation", {"panels_along": 5, "domes": 1})
    assert np.abs(again.vertices - wanted.vertices).max() < 1e-9
    assert again.n_faces == 40


@pytest.mark.parametrize("kind", kinds())
def test_every_kind_is_written(kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert net(kind).exit_code == 0
    assert read_mesh(tmp_path / f"{kind}.obj").mesh.n_faces == generate(kind).n_faces


def test_offset(tmp_path: Path) -> None:
    said = net("conical", "--offset", 300, "-o", tmp_path / "skin.obj")
    assert said.exit_code == 0
    assert "face offset: " in said.output
    inner, outer = generate("conical"), read_mesh(tmp_path / "skin.obj").mesh
    first = inner.corners[inner.face_start[:-1]]
    shift = outer.vertices[first] - inner.vertices[first]
    assert np.abs(np.einsum("fx,fx->f", shift, inner.face_normals) - 300).max() < 1e-9


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "which kind of net? One of "),
        (["conicl"], "did you mean conical"),
        (["conicl", "--list"], "did you mean conical"),
        (["canal", "--set", "panels"], "expected section.key=value, such as net.key=value"),
        (["canal", "--set", "panels_along=8"], "such as net.panels_along=8"),
        (["canal", "--set", "nett.panels_along=8"], "did you mean net.panels_along"),
        (["canal", "--set", "beam.end=cope"], "no section beam; it takes net.key=value"),
        (["canal", "--set", "net.kind=conical"], "give one of them"),
        (["canal", "--set", "net.parameters=5"], "parameters is unknown"),
        (["canal", "--set", "net.panels_alon=3"], "did you mean panels_along"),
        (["canal", "--set", "net.turn_deg=400"], "-180 to 180"),
        (["canal", "-o", "roof.stl"], ".obj, .off, .ply"),
        (["canal", "--offset", "nan"], "--offset nan: at most 1e+06 mm"),
        (["canal", "--offset", "1e300"], "at most 1e+06 mm"),
        (["translation", "--offset", "100"], "no offset at a constant distance"),
    ],
)
def test_mistakes_end_with_code_2_and_write_nothing(
    words: list[str], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = net(*words)
    assert result.exit_code == 2
    assert said in result.output
    assert not list(tmp_path.iterdir())

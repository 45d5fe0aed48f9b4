"""The README's snippets and the examples run as they are printed."""

from __future__ import annotations

import re
import runpy
import shlex
from pathlib import Path

import pytest
from typer.testing import CliRunner

from ddgfab.forms import canopy
from ddgfab.io import write_obj
from fabrication.cli import app
from fabrication.gridshell.load import load_project

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text("utf-8")


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a roof.obj in metres and a roof.toml, as the README assumes."""
    roof = canopy(panels_along=6, panels_across=4)
    write_obj(tmp_path / "roof.obj", roof.scaled(1e-3))
    (tmp_path / "roof.toml").write_text(blocks("toml")[0])
    monkeypatch.chdir(tmp_path)
    return tmp_path


def blocks(language: str) -> list[str]:
    """The fenced blocks of a language."""
    return re.findall(rf"```{language}\n(.*?)```", README, flags=re.DOTALL)


@pytest.mark.slow
@pytest.mark.parametrize("snippet", blocks("python"))
def test_python_snippet(snippet: str, here: Path) -> None:
    exec(compile(snippet, "README.md", "exec"), {})
    if "make(" in snippet:
        assert (here / "out" / "roof" / "manifest.json").exists()


@pytest.mark.slow
def test_commands(here: Path) -> None:
    """Every `ddgfab ...` line of the usage block, in order; globs as the shell would."""
    lines = [line for line in blocks("bash")[2].splitlines() if line.startswith("ddgfab ")]
    assert len(lines) == 6
    for line in lines:
        words = []
        for word in shlex.split(line, comments=True)[1:]:
            found = sorted(map(str, Path().glob(word))) if "*" in word else []
            words += found or [word]
        result = CliRunner().invoke(app, words)
        assert result.exit_code == 0, (line, result.output)


@pytest.mark.slow
@pytest.mark.parametrize("line", blocks("bash")[3].splitlines())
def test_linkages(line: str, here: Path) -> None:
    result = CliRunner().invoke(app, shlex.split(line, comments=True)[1:])
    assert result.exit_code == 0, result.output
    assert list(here.rglob("report.html"))


def test_the_project_snippet_is_valid(here: Path) -> None:
    assert load_project("roof.toml").beam.profile == "RHS 100x50x4"


def test_the_picture_is_there() -> None:
    for picture in re.findall(r"!\[[^\]]*\]\(([^)]+)\)", README):
        assert (ROOT / picture).stat().st_size < 400_000


@pytest.mark.slow
@pytest.mark.parametrize("name", ["03_schedules.py", "04_solids.py"])
def test_example_program(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    runpy.run_path(str(ROOT / "examples" / name), run_name="__main__")
    said = capsys.readouterr().out
    assert "N-0000" in said or "beams are longer" in said


@pytest.mark.slow
@pytest.mark.parametrize(
    "project", sorted((ROOT / "examples").glob("*.toml")), ids=lambda p: p.stem
)
def test_example_project(project: Path, tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["make", str(project), "-o", str(tmp_path / "out")])
    assert result.exit_code == 0, result.output
    assert (tmp_path / "out" / "manifest.json").exists()

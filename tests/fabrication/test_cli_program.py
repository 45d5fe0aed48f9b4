"""The program itself: version, exit codes of faults, readers that stop reading."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from ddgfab.forms import canopy
from ddgfab.io import read_mesh, write_obj
from fabrication.cli import app
from fabrication.version import package_version

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = [sys.executable, "-m", "fabrication"]


def test_version_needs_no_command() -> None:
    result = CliRunner().invoke(app, ["--version"])
    assert result.exit_code == 0
    assert result.output == f"ddgfab {package_version()}\n"


def test_help_offers_shell_completion() -> None:
    assert "--install-completion" in CliRunner().invoke(app, ["--help"]).output


@pytest.mark.parametrize("fault", [ValueError, TypeError, RuntimeError, KeyError])
def test_a_fault_of_the_program_has_its_own_exit_code(
    fault: type[Exception], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*args: object) -> None:
        raise fault("broken")

    write_obj(tmp_path / "roof.obj", canopy(panels_along=4, panels_across=3))
    monkeypatch.setattr("ddgfab.measures.inspect", broken)
    result = CliRunner().invoke(app, ["inspect", str(tmp_path / "roof.obj")])
    assert result.exit_code == 3
    assert fault.__name__ in result.output
    assert "fault of ddgfab" in result.output
    assert "Traceback" not in result.output
    shown = CliRunner().invoke(app, ["inspect", str(tmp_path / "roof.obj"), "--debug"])
    assert isinstance(shown.exception, fault)


def test_too_little_memory_is_no_fault(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*args: object) -> None:
        raise MemoryError

    write_obj(tmp_path / "roof.obj", canopy(panels_along=4, panels_across=3))
    monkeypatch.setattr("ddgfab.measures.inspect", full)
    result = CliRunner().invoke(app, ["inspect", str(tmp_path / "roof.obj")])
    assert result.exit_code == 2
    assert result.output.startswith(
        "error: there is too little memory for this\nNothing was written"
    )


def test_a_package_that_is_missing_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_obj(tmp_path / "roof.obj", canopy(panels_along=4, panels_across=3))
    monkeypatch.setitem(sys.modules, "manifold3d", None)
    words = ["make", str(tmp_path / "roof.obj"), "-o", str(tmp_path / "out"), "--jobs", "1"]
    result = CliRunner().invoke(app, [*words, "--formats", "csv"])
    assert result.exit_code == 2, result.output
    assert "error: manifold3d is needed for this and not installed: pip install" in result.output
    assert [path.name for path in tmp_path.iterdir()] == ["roof.obj"]


def test_bad_usage_keeps_exit_code_2() -> None:
    assert CliRunner().invoke(app, ["inspect"]).exit_code == 2
    assert CliRunner().invoke(app, ["inspect", "none.obj"]).exit_code == 2


@pytest.mark.slow
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
@pytest.mark.parametrize("words", [["--help"], ["net", "--help"], ["net", "--list"]])
def test_a_full_disk_is_one_message(words: list[str]) -> None:
    with Path("/dev/full").open("w") as full:
        job = subprocess.run(
            [*PROGRAM, *words], stdout=full, stderr=subprocess.PIPE, cwd=ROOT, check=False
        )
    said = job.stderr.decode()
    assert job.returncode == 2, said
    assert said.startswith("error: output cannot be written")
    assert said.count("\n") == 1


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="closes streams by their numbers")
@pytest.mark.parametrize(
    ("closed", "mesh", "code"),
    [((1,), "roof.obj", 0), ((0, 1, 2), "roof.obj", 0), ((1, 2), "none.obj", 2)],
)
def test_streams_that_are_closed_are_no_fault(
    closed: tuple[int, ...], mesh: str, code: int, tmp_path: Path
) -> None:
    """As with `>&-`; the files of a job do not get what is printed."""
    write_obj(tmp_path / "roof.obj", canopy(panels_along=4, panels_across=3))
    words = ["optimize", mesh, "-o", "flat.obj", "--goal", "planar"]
    numbers = " ".join(f"{number}>&-" for number in closed)
    command = " ".join([*map(shlex.quote, [*PROGRAM, *words]), numbers])
    job = subprocess.run(
        ["/bin/sh", "-c", command],
        cwd=tmp_path,
        capture_output=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        check=False,
    )
    assert job.returncode == code, job.stderr
    assert b"Traceback" not in job.stderr
    if code == 0:
        assert read_mesh(tmp_path / "flat.obj").mesh.n_faces == 12


@pytest.mark.slow
@pytest.mark.parametrize("words", [["net", "--list"], ["inspect", "roof.obj", "--json"]])
def test_a_closed_pipe_is_no_fault(words: list[str], tmp_path: Path) -> None:
    """The reader is gone before the first line, as with `| head` on a longer output."""
    write_obj(tmp_path / "roof.obj", canopy(panels_along=4, panels_across=3))
    with subprocess.Popen(
        [*PROGRAM, *words],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={"PYTHONPATH": str(ROOT)},
    ) as job:
        assert job.stdout is not None
        assert job.stderr is not None
        job.stdout.close()
        said = job.stderr.read().decode()
        assert job.wait(timeout=60) == 0, said
    assert said == ""

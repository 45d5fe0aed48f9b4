"""The command line: exit codes, one clear message for bad input, nothing half written."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from roofs import barrel
from typer.testing import CliRunner, Result

from ddgfab.forms import canopy
from ddgfab.io import write_obj
from fabrication.cli import app

PROGRAM = "from fabrication.cli import main; main()"


def ddgfab(*words: object) -> Result:
    """The command, in this process."""
    return CliRunner().invoke(app, [str(word) for word in words])


@pytest.fixture
def roof(tmp_path: Path) -> Path:
    """A barrel of 12 panels, in mm."""
    write_obj(tmp_path / "roof.obj", barrel())
    return tmp_path / "roof.obj"


def test_inspect_says_what_kind_of_net(roof: Path) -> None:
    said = ddgfab("inspect", roof)
    assert said.exit_code == 0
    assert "conical and circular" in said.output
    data = json.loads(ddgfab("inspect", roof, "--json").output)
    assert data["measures"]["planarity"]["greatest"] < 1e-6


def test_check_tells_good_files_from_broken_ones(small_folder: Path, tmp_path: Path) -> None:
    good = sorted((small_folder / "parts").glob("*/BP-001.*"))
    assert len(good) == 2
    said = ddgfab("check", *good)
    assert said.exit_code == 0, said.output
    broken = tmp_path / "half.stl"
    broken.write_bytes(good[1].read_bytes()[:-50])
    assert ddgfab("check", broken).exit_code != 0
    assert ddgfab("check", tmp_path / "none.step").exit_code == 2


def test_a_job_of_schedules_only(roof: Path, tmp_path: Path) -> None:
    said = ddgfab("make", roof, "-o", tmp_path / "out", "--formats", "csv", "--jobs", 1)
    assert said.exit_code == 0, said.output
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names - {"preview.png"} == {"manifest.json", "timings.json", "schedules"}


BAD = {
    "misspelt key": (["--set", "beam.profil=FL 60x8"], "profile"),
    "unknown section": (["--set", "beams.profile=FL 60x8"], "beam"),
    "no such profile": (["--set", "beam.profile=HEB 200"], "HEB 200"),
    "wrong type": (["--set", "panel.thickness_mm=thick"], "thickness_mm"),
    "no equals sign": (["--set", "panel.kind"], "section.key=value"),
    "node too small": (["--set", "node.diameter_mm=9"], "N-0"),
    "gap wider than a panel": (["--set", "panel.gap_mm=3000"], "P-0"),
    "corner too round": (["--set", "panel.corner_radius_mm=900"], "P-0"),
    "beam too short": (["--set", "beam.min_length_mm=5000"], "B-0"),
    "another unit": (["--set", "project.scale=0.001"], "median edge"),
    "unknown format": (["--formats", "dwg"], "formats"),
    "unknown tier": (["--verify", "maybe"], "verify"),
}


@pytest.mark.parametrize(("words", "said"), BAD.values(), ids=BAD.keys())
def test_bad_settings(words: list[str], said: str, roof: Path, tmp_path: Path) -> None:
    before = sorted(tmp_path.rglob("*"))
    result = ddgfab("make", roof, "-o", tmp_path / "out", "--jobs", 1, *words)
    assert result.exit_code == 2, result.output
    assert said in result.output
    message = result.output[result.output.index("error: ") :]
    assert len(message.strip().splitlines()) <= 3
    assert "Traceback" not in result.output
    assert sorted(tmp_path.rglob("*")) == before


def test_a_truncated_mesh(roof: Path, tmp_path: Path) -> None:
    text = roof.read_text()
    (tmp_path / "cut.obj").write_text(text[: text.index("\nf ") + 5])
    result = ddgfab("make", tmp_path / "cut.obj", "-o", tmp_path / "out")
    assert result.exit_code == 2
    assert "cut.obj:" in result.output
    assert not (tmp_path / "out").exists()


def test_a_file_in_the_way_and_a_foreign_folder(roof: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x")
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "thesis.txt").write_text("x")
    for place in ("file", "folder"):
        result = ddgfab("make", roof, "-o", tmp_path / place, "--formats", "csv", "--jobs", 1)
        assert result.exit_code == 2
        assert place in result.output
    assert (tmp_path / "folder" / "thesis.txt").exists()


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_stopping_a_job_leaves_nothing(number: signal.Signals, tmp_path: Path) -> None:
    """A real process with two workers, stopped while parts are made."""
    write_obj(tmp_path / "roof.obj", canopy(panels_along=40, panels_across=20))
    job = running(tmp_path)
    os.killpg(job.pid, number)  # the terminal sends Ctrl-C to the whole group
    assert job.stderr is not None
    said = job.stderr.read()
    assert job.wait(timeout=20) == 128 + number
    assert "nothing was written" in said
    assert "Traceback" not in said
    assert sorted(path.name for path in tmp_path.iterdir()) == ["roof.obj"]


@pytest.mark.slow
def test_a_killed_job_leaves_no_workers(tmp_path: Path) -> None:
    """SIGKILL of the parent alone: its workers end, and the next job clears what it left."""
    write_obj(tmp_path / "roof.obj", canopy(panels_along=40, panels_across=20))
    job = running(tmp_path)
    workers = children(job.pid)
    assert workers
    job.kill()
    job.wait(timeout=20)
    for _ in range(100):
        if not any(alive(worker) for worker in workers):
            break
        time.sleep(0.1)
    assert not any(alive(worker) for worker in workers)
    assert not (tmp_path / "out").exists()


def running(folder: Path) -> subprocess.Popen[str]:
    """A job with two workers in a session of its own, as it makes parts."""
    words = ["make", "roof.obj", "-o", "out", "--jobs", "2"]
    job = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *words],
        cwd=folder,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        env={**os.environ, "PYTHONPATH": str(Path(__file__).resolve().parents[2])},
    )
    assert job.stderr is not None
    for line in job.stderr:
        if line.startswith("parts"):
            break
    time.sleep(0.3)
    return job


def children(pid: int) -> list[int]:
    """Process ids of the children of a process (Linux)."""
    listing = Path(f"/proc/{pid}/task/{pid}/children")
    if not listing.exists():
        pytest.skip("needs Linux's list of child processes")
    return [int(word) for word in listing.read_text().split()]


def alive(pid: int) -> bool:
    """Whether a process runs (one that has ended and waits for its parent does not)."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False

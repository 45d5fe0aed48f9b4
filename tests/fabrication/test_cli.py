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


def test_settings_say_how_a_mesh_is_read(roof: Path) -> None:
    """The same names as in project files, with the same limits; options have precedence."""
    given = ("inspect", roof, "--json")
    by_option = json.loads(ddgfab(*given, "--units", "cm", "--up", "y").output)
    by_setting = json.loads(ddgfab(*given, "--set", "project.units=cm", "--set", "net.up=y").output)
    plain = json.loads(ddgfab(*given).output)
    assert by_setting == by_option
    length = [record["edge_length"][1] for record in (by_setting, plain)]
    assert length[0] == pytest.approx(10 * length[1])
    both = ddgfab(*given, "--set", "project.units=cm", "--units", "m", "--up", "y")
    assert json.loads(both.output) == json.loads(ddgfab(*given, "--units", "m", "--up", "y").output)
    for change, text in (
        ("project.units=yard", 'units = "yard" must be'),
        ("net.upp=y", "did you mean net.up?"),
        ("panel.gap_mm=3", "this command has no section panel; it takes project.key=value or net"),
    ):
        refused = ddgfab("inspect", roof, "--set", change)
        assert refused.exit_code == 2
        assert text in " ".join(refused.output.split())


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
    assert names - {"preview.png"} == {"manifest.json", "run.json", "schedules"}


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
    "a list without brackets": (["--set", "panel.max_size_mm=2500x1500"], "as [2500, 1500]"),
    "a list too short": (["--set", "panel.max_size_mm=[1]"], "list such as [3210, 6000] is needed"),
    "a list too long": (["--set", "panel.max_size_mm=[1, 2, 3]"], "must be a list of 2 values"),
    "no list": (["--set", "output.formats=step"], 'a list such as ["step"'),
    "no key": (["--set", "a"], "expected section.key=value, such as panel.gap_mm=15"),
    "nothing": (["--set", ""], "expected section.key=value"),
    "no section": (["--set", ".gap_mm=3"], "expected section.key=value"),
    "a key in a key": (["--set", "panel.gap_mm.x=3"], "must be a number"),
    "a very deep key": (["--set", f"panel{'.x' * 5000}=3"], "is not a key"),
    "a key with holes": (["--set", "panel..gap_mm=3"], ".gap_mm is not a key"),
    "too many digits": (["--set", f"panel.gap_mm={'9' * 5000}"], "has 5000 digits: too many"),
    "beyond 64 bits": (["--set", f"output.jobs={2**63}"], "does not fit into 64 bits"),
    "64 bits": (["--set", f"beam.density={2**63 - 1}"], "equal to 1000000000"),
    "a huge number": (["--set", "node.diameter_mm=1e300"], "less than or equal to 1000000000"),
    "a huge negative": (
        ["--set", "panel.offset_mm=-1e300"],
        "greater than or equal to -1000000000",
    ),
    "a huge profile": (["--set", "beam.profile=[[0,0],[1e300,0],[0,1]]"], "beyond 10000 mm"),
    "not a number": (["--set", "panel.gap_mm=nan"], "finite number"),
    "deep lists": (["--set", f"panel.gap_mm={'[' * 3000}"], "too deep"),
    "NUL in a name": (["--set", 'project.name="a\\u0000b"'], "has the control character"),
    "NUL in a path": (["--set", 'net.file="a\\u0000b.obj"'], "has the control character"),
    "parameters": (["--set", "net.parameters=5"], "parameters is unknown"),
    "a table": (["--set", "panel.gap_mm={}"], "gap_mm = {} must be a number"),
    "a date": (["--set", "panel.gap_mm=2020-01-01"], "2020-01-01 must be a number"),
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


def test_the_root_of_the_file_system_is_no_output(roof: Path) -> None:
    words = [["make", roof], ["linkage"], ["net", "canal"], ["trace", "dome"], ["optimize", roof]]
    for command in [*words, ["init"]]:
        result = ddgfab(*command, "-o", "/")
        assert result.exit_code == 2, result.output
        assert "error: /: " in result.output
        assert "fault" not in result.output


def test_what_a_setting_changes_is_not_blamed_on_the_file(roof: Path) -> None:
    project = roof.with_suffix(".toml")
    project.write_text('[net]\nkind = "mesh"\nfile = "roof.obj"\n[panel]\ngap_mm = "a"\n')
    said = ddgfab("make", project, "--set", "panel.thickness_mm=b").output
    assert "roof.toml:5: [panel] gap_mm" in said
    assert "[panel] thickness_mm" in said
    said = ddgfab("make", project, "--set", "panel.gap_mm=b").output
    assert "error: [panel] gap_mm = " in said
    assert "roof.toml" not in said


def test_a_kind_of_net_is_a_source_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    small = ["--set", "net.panels_along=4", "--set", "net.panels_across=3", "--dry-run"]
    result = ddgfab("make", "conical", *small)
    assert result.exit_code == 0, result.output
    assert "Panels: 12 of " in result.output
    assert "outputs/conical" in result.output
    assert "did you mean conical?" in ddgfab("make", "conicl").output


def test_an_argument_too_many_says_how_outputs_are_named(roof: Path) -> None:
    for words in (["make", roof, "out"], ["optimize", roof, "out.obj"], ["linkage", "cube", "out"]):
        result = ddgfab(*words)
        assert result.exit_code == 2
        assert "there is no place for out" in result.output
        assert "named by -o" in result.output


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


@pytest.mark.parametrize(("place", "words"), [("", "has no name"), ("/", "no job can take")])
def test_a_place_that_cannot_be_is_found_before_the_work(
    place: str, words: str, tmp_path: Path
) -> None:
    """The mesh is not even read: its name is wrong too."""
    result = ddgfab("make", tmp_path / "roof.obj", "-o", place)
    assert result.exit_code == 2
    assert words in result.output


def test_another_project_is_replaced_only_by_force(roof: Path, tmp_path: Path) -> None:
    words = ["-o", tmp_path / "out", "--formats", "csv", "--jobs", 1, "--verify", "none"]
    assert ddgfab("make", roof, *words).exit_code == 0
    other = tmp_path / "大阪.obj"
    other.write_bytes(roof.read_bytes())
    result = ddgfab("make", other, *words)
    assert result.exit_code == 2
    assert f"project {roof.stem}; this is 大阪" in result.output
    assert "--force" in result.output
    assert ddgfab("make", other, *words, "--dry-run").exit_code == 2
    assert ddgfab("make", other, *words, "--force").exit_code == 0


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
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


STOPPED = """
import os, sys
from ddgfab.io.atomic import atomic_write
from fabrication.cli import app
from fabrication.cli.terminal import session

@app.command("stopped")
def stopped(number: int, how: str) -> None:
    stop = lambda: [os.kill(os.getpid(), number), *range(1000)]
    if how == "before":
        stop()
    with session(False):
        if how == "exec":
            exec("stop()", {"stop": stop})
        if how == "library":
            try:
                stop()
            except BaseException:
                raise ImportError("initialization failed")
        if how == "written":
            with atomic_write("a.txt") as stream:
                stream.write(b"a")
            stop()
    stop()

app()
"""


@pytest.mark.skipif(os.name != "posix", reason="signals are POSIX's")
@pytest.mark.parametrize(
    ("how", "name", "said"),
    [
        ("before", "SIGHUP", ""),
        ("exec", "SIGINT", ": nothing was written"),
        ("exec", "SIGTERM", ": nothing was written"),
        ("exec", "SIGHUP", ": nothing was written"),
        ("library", "SIGTERM", ": nothing was written"),
        ("written", "SIGHUP", ": a.txt is complete"),
        ("after", "SIGTERM", ""),
    ],
)
def test_signals_at_any_time_end_with_their_code_and_a_true_message(
    how: str, name: str, said: str, tmp_path: Path
) -> None:
    """Dataclasses are made by exec, and libraries make an error of what comes as they load."""
    number = getattr(signal, name)
    done = subprocess.run(
        [sys.executable, "-c", STOPPED, "stopped", str(int(number)), how],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        preexec_fn=as_in_a_terminal,
        env={**os.environ, "PYTHONPATH": str(Path(__file__).resolve().parents[2])},
    )
    assert (done.returncode, done.stderr) == (128 + number, f"interrupted{said}\n")


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


def as_in_a_terminal() -> None:
    """Signals that are ignored stay so in children: Ctrl-C in the background, SIGHUP by nohup."""
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


def running(folder: Path) -> subprocess.Popen[str]:
    """A job with two workers in a session of its own, as it makes parts."""
    words = ["make", "roof.obj", "-o", "out", "--jobs", "2"]
    job = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *words],
        cwd=folder,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=as_in_a_terminal,
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

"""What a terminal shows: escapes, clipped values, steps with ticks, --quiet, --verbose."""

from __future__ import annotations

import os
import re
import sys
from pathlib import Path

import pytest
from roofs import barrel
from typer.testing import CliRunner

from ddgfab.errors import DdgError, InputError, clipped, printable
from ddgfab.io import write_obj
from fabrication.cli import app
from fabrication.cli.steps import StepPrinter
from fabrication.cli.terminal import Session

ESCAPE, BIDI, NEXT_LINE = "\x1b[31m", "\u202e", "\x85"
STEERING = re.compile("[\x00-\x09\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069]")
"""What no output may have: everything that is not a line break and that a terminal obeys."""


def run(*words: object) -> tuple[int, str]:
    result = CliRunner().invoke(app, [str(word) for word in words])
    return result.exit_code, result.output


@pytest.fixture(autouse=True)
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_obj(tmp_path / "roof.obj", barrel())


# --- characters that a terminal obeys --------------------------------------------------------
NASTY = f"a{ESCAPE}b{BIDI}c{NEXT_LINE}d\te"
COMMANDS = [
    [],
    ["make"],
    ["linkage"],
    ["optimize", "roof.obj"],
    ["trace", "dome"],
    ["net", "canal"],
    ["init"],
]


@pytest.mark.parametrize("command", COMMANDS[1:], ids=lambda words: words[0])
@pytest.mark.parametrize("form", ["{}", "{}.key=1", "net.{}=1", "{}=", "net.kind={}"])
def test_settings_are_shown_as_escapes(command: list[str], form: str) -> None:
    code, said = run(*command, "--set", form.format(NASTY))
    assert code == 2, said
    assert not STEERING.search(said), repr(said)
    value = re.search(r"a\\(x|u00)1b\[31mb\\u202ec\\x85d", said)
    assert value or "[net] is unknown" in said or "no such setting" in said, said


@pytest.mark.parametrize("command", COMMANDS, ids=lambda words: " ".join(words) or "none")
def test_unknown_options_and_arguments_too(command: list[str]) -> None:
    for word in (f"--{NASTY}", NASTY):
        code, said = run(*command, *(["more"] if "roof.obj" in command else []), word, word, word)
        assert code == 2, said
        assert not STEERING.search(said), repr(said)


@pytest.mark.parametrize(
    "words",
    [
        ["make"],
        ["inspect"],
        ["check"],
        ["linkage"],
        ["optimize"],
        ["trace"],
        ["net"],
        ["init"],
    ],
    ids=lambda words: words[0],
)
@pytest.mark.parametrize("suffix", ["", ".obj", ".toml", ".step", ".txt"])
def test_names_of_files_too(words: list[str], suffix: str) -> None:
    code, said = run(*words, NASTY + suffix)
    assert code == 2, said
    assert not STEERING.search(said), repr(said)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.toml", f'[net]\nkind = "canopy"\n"{ESCAPE}x" = 3\n'.replace(ESCAPE, "\\u001b")),
        ("b.toml", '[net]\nkind = "canopy"\n["\\u202ebeam"]\nx = 3\n'),
        ("c.toml", '[net]\nkind = "\\u001b[2Jcanopy"\n'),
        ("d.toml", '[project]\nname = "a\\u0000b"\n[net]\nkind = "canopy"\n'),
        ("e.toml", f"[net]\nkind = {ESCAPE}\n"),
        ("f.obj", f"v 0 0 {ESCAPE}\n"),
        ("g.obj", f"v 0 0 0\nf 1 {BIDI}2 3\n"),
        ("h.off", f"OFF\n3 1 {ESCAPE}0\n"),
        ("i.ply", f"ply\nformat {ESCAPE} 1.0\n"),
        ("j.obj", f"# units: {ESCAPE}\nv 0 0 x{'y' * 9000}\n"),
    ],
)
def test_what_files_hold_too(name: str, text: str) -> None:
    Path(name).write_text(text)
    code, said = run("inspect" if name[-1] in "jfy" else "make", name)
    assert code == 2, said
    assert not STEERING.search(said), repr(said)
    assert max(map(len, said.splitlines())) < 400


def test_a_name_that_is_accepted_is_shown_as_escapes() -> None:
    code, said = run("net", "canal", "-o", f"r{BIDI}oof.obj")
    assert code == 0
    assert not STEERING.search(said)
    assert r"written to r\u202eoof.obj" in said


@pytest.mark.parametrize("command", COMMANDS[1:], ids=lambda words: words[0])
def test_long_values_are_clipped(command: list[str]) -> None:
    for word in (
        "x" * 5000,
        f"net.{'k' * 5000}=1",
        f"panel.gap_mm={'9' * 5000}",
        "n.x=" + "[" * 900,
    ):
        code, said = run(*command, "--set", word)
        assert code == 2, said
        assert max(map(len, said.splitlines())) < 500, said
        assert "fault" not in said


def test_escapes_of_the_library() -> None:
    assert str(DdgError(f"{NASTY}\nnext")) == "a\\x1b[31mb\\u202ec\\x85d\\te\nnext"
    assert printable("Dach über Hof, 日本\n") == "Dach über Hof, 日本\n"
    assert clipped("ab\ncd") == r"ab\ncd"
    assert clipped("x" * 61) == "x" * 60 + "..."
    assert clipped("x" * 60) == "x" * 60
    assert printable("\udcff") == r"\udcff"  # a byte of a file name that is not UTF-8
    assert str(InputError("bad", file="a\nb", line=3)) == r"a\nb:3: bad"


# --- quiet and verbose -------------------------------------------------------------------------
def test_quiet_prints_the_result_only() -> None:
    code, said = run("make", "roof.obj", "-o", "out", "--formats", "csv", "--jobs", 1, "-q")
    assert (code, len(said.splitlines())) == (0, 1)
    assert said.endswith("files in out\n")
    assert run("net", "canal", "-q") == (0, "written to canal.obj [mm]\n")
    code, said = run("optimize", "canal.obj", "-o", "flat.obj", "--no-picture", "-q")
    assert (code, said) == (0, "written to flat.obj [mm]\n")
    code, said = run("inspect", "roof.obj", "-q")
    assert (code, len(said.splitlines())) == (0, 1)
    code, said = run("trace", "dome", "-q")
    assert (code, said) == (0, "written to net.obj [mm]\n")
    code, said = run("init", "-q")
    assert (code, said) == (0, "written to canopy.toml\n")


def test_quiet_keeps_errors_and_excludes_verbose() -> None:
    code, said = run("make", "none.obj", "-q")
    assert code == 2
    assert said.startswith("error: none.obj: ")
    code, said = run("make", "roof.obj", "-q", "-v")
    assert (code, said) == (2, "error: --quiet and --verbose exclude each other\n")


def test_verbose_tells_settings_processes_and_times() -> None:
    words = ["make", "roof.obj", "-o", "out", "--formats", "csv", "--jobs", 1]
    said = run(*words, "-v", "--set", "panel.gap_mm=15")[1]
    assert "setting panel.gap_mm = 15\n" in said
    assert "processes: 1\n" in said
    assert re.search(r"^time parts: \d+\.\d\d s$", said, re.MULTILINE)
    assert re.search(r"^parts: \d+\.\d s$", said, re.MULTILINE)
    plain = run(*words)[1]
    assert "time parts" not in plain
    assert "setting" not in plain


def test_the_last_lines_name_the_files_to_open() -> None:
    words = ["--formats", "step,csv", "--jobs", 1, "--verify", "none", "--set", "panel.kind=none"]
    said = run("make", "roof.obj", "-o", "out", *words)[1]
    last = [line.removeprefix("  open ") for line in said.splitlines() if "  open " in line]
    assert [Path(name).name for name in last] == ["assembly.step", "preview.png", "panels.csv"]
    assert all(Path(name).is_file() for name in last)


# --- steps -------------------------------------------------------------------------------------
def test_lines_where_there_is_no_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    steps = StepPrinter(timed=True)
    for step in ("parts", "parts", "read back", "parts"):
        steps(step, 1, 2)
    steps.close()
    steps.close()
    shown = re.sub(r"\d+\.\d s", "T", capsys.readouterr().err)
    assert shown == "parts ...\nparts: T\nread back ...\nread back: T\nparts: T\n"
    quiet = Session(quiet=True)
    quiet.progress("parts", 1, 2)
    quiet.close()
    assert capsys.readouterr().err == ""


SHOWING = """
import time
from fabrication.cli.steps import StepPrinter
steps = StepPrinter()
steps("parts", 0, 4)
for done in range(1, 5):
    time.sleep(0.15)
    steps("parts", done, 4)
steps("optimize", 0, 0)
time.sleep(0.2)
for done in (1, 2):
    steps("read back", done, 40)
    time.sleep(0.4)
steps.stop()
"""


def on_a_terminal(program: str) -> str:
    """What a program writes to a terminal of 80 columns."""
    pty = pytest.importorskip("pty")
    pid, terminal = pty.fork()
    if pid == 0:  # pragma: no cover - another process
        os.environ.update(TERM="xterm", COLUMNS="80", LANG="C.UTF-8", PYTHONIOENCODING="utf-8")
        os.execv(sys.executable, [sys.executable, "-c", program])
    data = b""
    while True:
        try:
            piece = os.read(terminal, 65536)
        except OSError:  # the program has ended
            break
        if not piece:
            break
        data += piece
    os.waitpid(pid, 0)
    os.close(terminal)
    return re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", data.decode())


@pytest.mark.skipif(os.name != "posix", reason="needs a pseudo-terminal")
def test_finished_steps_tick_and_the_live_one_has_time_left() -> None:
    shown = on_a_terminal(SHOWING)
    assert re.search(r"about \d", shown)
    last = shown[shown.rindex("\N{CHECK MARK} parts") :]
    first, second, third = last.strip().splitlines()[:3]
    assert re.fullmatch(r"\N{CHECK MARK} parts .* 4/4 0\.[5-9] s *", first)
    assert re.fullmatch(r"\N{CHECK MARK} optimize .* 0\.[2-4] s *", second)
    assert re.fullmatch(r"\N{MULTIPLICATION SIGN} read back .* 2/40 \d\.\d s *", third)
    assert all(len(line) <= 80 for line in shown.splitlines())

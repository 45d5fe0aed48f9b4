"""Command lines of every command, with options, settings and files that chance puts together.

    python tests/attack/commands.py --count 20000

Each is run in a folder with a file of every kind. It ends with exit code 0 or 1, or with 2 and a
message, and then nothing is changed; no code 3, no traceback, nothing a terminal obeys, no working
folder that is left. What there is to put together comes from the program (`known`).
"""

from __future__ import annotations

import os
import random
import re
import resource
import shutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

HERE = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(HERE), str(HERE / "tests" / "attack"), str(HERE / "tests" / "fabrication")]

import inputs  # noqa: E402
from known import ABSURD, Option, Setting, commands, settings  # noqa: E402
from typer.testing import CliRunner  # noqa: E402
from watch import Watch, run, said_well  # noqa: E402

from ddgfab.errors import InputError  # noqa: E402
from ddgfab.forms.registry import kinds  # noqa: E402
from ddgfab.surfaces.analytic import SURFACES  # noqa: E402
from fabrication.cli import app  # noqa: E402
from fabrication.linkage.project import kit_kinds  # noqa: E402
from fabrication.project.toml import toml_text  # noqa: E402

SECONDS = 60.0
"""A command may compute so long; what it is asked for may be large."""

MEMORY = 8 << 30
"""Memory [bytes] that may be reserved: kernel and renderer reserve much, and use little."""

RESIDENT = 1 << 30
"""Memory [bytes] that a command may use beside what was used before."""

STEERING = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069]")
JOBS = ("1", "1", "-1", "257", "x", "1e9")
"""Counts of processes: no more than one is started."""

SOUND: dict[str, tuple[str, ...]] = {
    "make": ("roof.obj", "roof.toml", "rules.toml", "surface.toml", "cells.obj", "dome"),
    "linkage": ("bennett", "cube", "knet.obj", "kit.toml"),
    "optimize": ("roof.obj", "vault.obj", "triangles.obj", "roof.ply"),
    "trace": ("patch.step", "patch.iges", "scan.obj", "dome", "saddle", "torus-piece"),
    "dilemma": ("scan.obj", "scan.off"),
    "inspect": ("roof.obj", "cells.obj", "knet.obj", "roof.off"),
    "check": ("part.stl", "part.3mf", "model.glb", "panels.csv", "box.step", "model.ifc"),
}
"""Sources with which a command gets far; one that is not here has only those of `sources`."""


def sources() -> tuple[str, ...]:
    """What may stand as the source of some command."""
    return (*inputs.names(), *kinds(), *SURFACES, *kit_kinds())


def command_line(rng: random.Random) -> list[str]:
    """A command with its source, some options and some settings."""
    name = rng.choice(list(commands()))
    options = commands()[name]
    words, source = [name], ""
    wild = rng.random() < 0.4
    if rng.random() < 0.95:
        near = SOUND.get(name, kinds() if name == "net" else ())
        source = rng.choice(sources() if wild or not near else near)
        words.append(source)
    if wild and rng.random() < 0.1:
        words.append(rng.choice(sources()))
    known = {option.name for option in options}
    if "--set" in known:
        for _ in range(rng.choice((0, 1, 2, 4) if wild else (0, 1))):
            words += _set(rng.choice(_likely(name, source, rng)), source, rng)
    for _ in range(rng.choice((0, 1, 2, 3) if wild else (0, 0, 1))):
        words += _given(rng.choice(options), rng)
    if "--dry-run" in known and rng.random() < DRY:
        words.append("--dry-run")
    if "--no-picture" in known and rng.random() < DRY:
        words.append("--no-picture")
    if "--jobs" in known and "--jobs" not in words:
        words += ["--jobs", "1"]
    if "--formats" in known and "--formats" not in words and rng.random() < 0.8:
        words += ["--formats", "csv"]
    return words


DRY = 0.9
"""Parts and pictures take a hundred times as long as what decides about them."""


def _likely(name: str, source: str, rng: random.Random) -> list[Setting]:
    """Settings of the product that a command is about, and of its source, mostly."""
    everything = list(settings())
    if rng.random() < 0.1:
        return everything
    product = {"linkage": source, "dilemma": "dilemma"}.get(name, "gridshell")
    own = [s for s in everything if s.product == product]
    own = [s for s in own if not s.with_ or source in s.with_[-1]] or everything
    if name in ("net", "trace", "optimize"):
        section = "net" if name != "optimize" else name
        own = [s for s in own if s.section == section]
    if name == "net":
        own = [s for s in own if s.with_] or own
    return own


def _set(setting: Setting, source: str, rng: random.Random) -> Iterator[str]:
    """A setting as it is typed, mostly with what makes it known."""
    own = setting.values if setting.values and rng.random() < 0.8 else ABSURD
    if setting.section == "optimize" and rng.random() < 0.7:
        yield from ("--set", f"optimize.goal={rng.choice(('planar', 'torsion-free', 'families'))}")
    if source not in [value for _, _, value in setting.with_] and rng.random() < 0.8:
        for section, key, value in setting.with_:
            yield from ("--set", f"{section}.{key}={value}")
    value = rng.choice(JOBS) if setting.key == "jobs" else typed(rng.choice(own), rng)
    yield from ("--set", f"{setting.section}.{setting.key}={value}")


def typed(value: Any, rng: random.Random) -> str:
    """A value as it may stand behind --set."""
    if isinstance(value, str) and rng.random() < 0.7:
        return value
    if isinstance(value, dict | list):
        return repr(value).replace("True", "true").replace(": ", " = ").replace("'", '"')
    try:
        return toml_text(value)
    except (TypeError, ValueError):
        return str(value)


def _given(option: Option, rng: random.Random) -> list[str]:
    """An option with a value."""
    if not option.takes_value:
        return [option.name]
    which = rng.random()
    if option.name == "--jobs":
        value = rng.choice(JOBS)
    elif option.name in ("-o", "--output"):
        value = rng.choice(("out", "out.obj", "out.toml", "net.ply", "roof.obj", *inputs.names()))
    elif option.numeric and which < 0.8:
        value = rng.choice(("0", "1", "2", "3", "-1", "0.5", "45", "1500", "1e9", "1e300", "nan"))
    elif which < 0.5 and option.words:
        value = rng.choice(option.words)
    elif which < 0.75:
        value = rng.choice(sources())
    else:
        value = typed(rng.choice(ABSURD), rng)
    return [option.name, value] if option.name else [value]


# --- what may come of it ------------------------------------------------------------------------
def judge(words: list[str], folder: Path) -> str:
    """Run a command line in a folder with all files; raises where it ends as none may.

    Raises
    ------
    InputError
        It was refused, as it should be; with its message.
    AssertionError
        It ended otherwise.
    """
    place = folder / "case"
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir()
    inputs.copied(place)
    before, used = _state(place), _resident()
    with _in(place):
        result = CliRunner().invoke(app, words)
    error = result.exception
    if error is not None and not isinstance(error, SystemExit):
        raise error
    said = result.output
    assert not STEERING.search(said.replace("\t", "")), f"steers the terminal: {said!r}"
    assert "Traceback" not in said, f"a traceback: {said[-800:]}"
    assert result.exit_code in (0, 1, 2), f"exit code {result.exit_code}: {said[-800:]}"
    hidden = [p.name for p in place.rglob(".*")] + [p.name for p in place.rglob("*.tmp*")]
    assert not hidden, f"left behind: {hidden}"
    assert _resident() - used < RESIDENT, f"used {(_resident() - used) >> 20} MB"
    if result.exit_code == 2:
        changed = _state(place) ^ before
        assert not changed, f"refused, and changed {sorted(changed)}"
        at = said.rfind("error: ")
        assert at >= 0, f"refused without a message: {said!r}"
        message = said[at:].strip()
        assert said_well(message), f"no message: {message!r}"
        raise InputError(message.split("\n")[0])
    return said


def _state(place: Path) -> set[tuple[str, int, int]]:
    """Names, lengths and times of all files."""
    found = set()
    for path in place.rglob("*"):
        state = path.lstat()
        found.add((str(path.relative_to(place)), state.st_size, state.st_mtime_ns))
    return found


def _resident() -> int:
    """Most memory [bytes] that this process used so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


@contextmanager
def _in(place: Path) -> Iterator[None]:
    before = Path.cwd()
    os.chdir(place)
    try:
        yield
    finally:
        os.chdir(before)


def attack(watch: Watch, seed: int, folder: Path) -> None:
    """One command line."""
    words = command_line(random.Random(seed))
    watch.call(f"{seed}: {words}", lambda: judge(words, folder), SECONDS)


if __name__ == "__main__":
    with TemporaryDirectory() as place:
        sys.exit(run(attack, __doc__, 20_000, Path(place), memory=MEMORY))

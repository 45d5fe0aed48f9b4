"""Every command in too little memory, and stopped by signals at any time; as processes.

    python tests/attack/limits.py --count 200             # memory, from too little to import up
    python tests/attack/limits.py --count 200 --signals   # SIGINT, SIGTERM, SIGHUP and SIGKILL

A command that is short of memory ends as it always does, or with a message and nothing written; one
that is stopped has exit code 128 and the signal's number. No traceback, no core, no process, no
working folder is left (after SIGKILL, once the next job has looked), and an older result is whole.
Half of the runs find the files of the run before: a command replaces them, or refuses and changes
nothing. Single files are as they were or, to the byte, those of a whole run, however a run ended.
"""

from __future__ import annotations

import argparse
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory

HERE = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(HERE), str(HERE / "tests" / "attack"), str(HERE / "tests" / "fabrication")]

import inputs  # noqa: E402
from kills import ENVIRONMENT, processes_of  # noqa: E402
from known import commands  # noqa: E402

from fabrication.job.folder import OutputFolder  # noqa: E402
from fabrication.job.manifest import faults  # noqa: E402

LINES: dict[str, tuple[tuple[str, ...], ...]] = {
    "make": (
        ("roof.obj", "--jobs", "1", "-o", "out"),
        ("roof.obj", "--jobs", "2", "-o", "out", "--formats", "step,csv,ifc,dxf"),
        ("patch.step", "--jobs", "1", "-o", "out", "--formats", "csv"),
    ),
    "linkage": (("bennett", "-o", "out"), ("knet", "-o", "out", "--formats", "csv,html")),
    "init": (("roof.obj", "-o", "new.toml"),),
    "optimize": (("scan.obj", "-o", "new.obj"), ("triangles.obj", "--goal", "families")),
    "trace": (("patch.step", "-o", "new.obj"), ("dome", "-o", "new.obj")),
    "dilemma": (("scan.obj", "-o", "new.obj"),),
    "inspect": (("scan.obj",), ("patch.3dm",)),
    "check": (("box.step", "part.stl", "part.3mf", "model.glb"), ("model.ifc", "part.dxf")),
    "net": (("conical", "-o", "new.obj"), ("koebe", "-o", "new.obj", "--circles", "c.step")),
}
"""Lines of each command that end well; one that is not here runs without arguments."""

MEGABYTES = (300, 6000)
"""Address space, from less than it takes to import to more than anything takes."""

STOPS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL)
LONGEST = 900.0
"""Seconds by the clock."""

TOOK: dict[str, float] = {}
"""Seconds by the clock of each line's first run, which is not stopped."""

WHOLE: dict[str, dict[str, bytes]] = {}
"""Files beside the output folder that each line's first run wrote."""

EXISTS = re.compile(r"error: (?P<name>\S+): exists already; --force replaces it")
"""The message of a command that does not replace a file unless it is told to."""


def lines() -> list[list[str]]:
    """All lines, of all commands that there are."""
    return [[name, *words] for name in commands() for words in LINES.get(name, ((),))]


def as_in_a_terminal() -> None:
    """Signals that are ignored stay so in children: as of jobs in the background."""
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


def limited(megabytes: int) -> None:
    """In the process to be: so much address space, and no core."""
    import resource

    resource.setrlimit(resource.RLIMIT_AS, (megabytes << 20, megabytes << 20))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def short_of_memory(rng: random.Random, place: Path, words: list[str]) -> str:
    """Run a line in some address space; how it ended."""
    low, high = MEGABYTES
    megabytes = int(low * (high / low) ** rng.random())
    before = _state(place)
    job = _start(words, place, lambda: limited(megabytes))
    said = _said(job)
    _require_clean(said, place, job.pid)
    assert job.returncode in (0, 1, 2), f"{megabytes} MB: exit code {job.returncode}: {said[-600:]}"
    if job.returncode == 2:
        changed = _state(place) ^ before
        assert not changed, f"{megabytes} MB: refused, and changed {sorted(changed)}"
        assert "error: " in said, f"{megabytes} MB: no message: {said!r}"
    return {0: "ended well", 1: "ended with failed parts", 2: "refused"}[job.returncode]


def stopped(rng: random.Random, place: Path, words: list[str], took: float) -> str:
    """Run a line, stop it after a while; how it ended. `took`: seconds of a whole run."""
    number = rng.choice(STOPS)
    before = _state(place)
    job = _start(words, place, as_in_a_terminal)
    try:
        job.wait(timeout=rng.uniform(0.0, 1.05) * took)
    except subprocess.TimeoutExpired:
        if number == signal.SIGTERM:
            job.send_signal(number)
        else:
            os.killpg(job.pid, number)
    said = _said(job)
    code = job.returncode
    if code == -signal.SIGINT and "start.py" not in said:
        said = ""  # Python itself was stopped, with a traceback, before the program began
    if number == signal.SIGKILL and code == -number:
        OutputFolder(place / "out").prepare()
        _require_clean("", place, job.pid)
        return "killed"
    _require_clean(said, place, job.pid)
    if code in (-number, 128 + number):  # the first: before Python, or the program, has handlers
        changed = _state(place) ^ before
        names = sorted({path for path, _, _ in changed})
        if "interrupted: nothing was written" in said:
            assert not names, f"{number.name}: nothing was written, but {names[:9]}"
        elif code > 0 and not said.endswith("interrupted\n") and "complete" not in said:
            assert not names, f"{number.name}: {said[-300:]}, and changed {names[:9]}"
        return f"stopped by {number.name}"
    if code == 2 and (found := EXISTS.search(said)):
        _require_refused(found["name"], before, place)
        return "refused to replace a file"
    assert code in (0, 1), f"{number.name}: exit code {code}: {said[-600:]}"
    return "came through"


def _require_refused(name: str, before: set[tuple[str, int, int]], place: Path) -> None:
    """A file that is not replaced was there before, and nothing is changed."""
    assert name in {path for path, _, _ in before}, f"refused, but {name} was not there"
    changed = _state(place) ^ before
    assert not changed, f"refused to replace {name}, and changed {sorted(changed)}"


def written_beside(place: Path) -> dict[str, bytes]:
    """Files that commands wrote beside the output folder, and what is in them."""
    known = {path.name for path in inputs.folder().iterdir()} | {"out"}
    new = [path for path in place.iterdir() if path.name not in known]
    files = [p for path in new for p in (path, *path.rglob("*")) if p.is_file()]
    return {str(p.relative_to(place)): p.read_bytes() for p in files}


def clear(place: Path) -> None:
    """Remove what commands wrote beside the output folder."""
    for name in {name.split("/")[0] for name in written_beside(place)}:
        path = place / name
        shutil.rmtree(path) if path.is_dir() else path.unlink()


def _require_whole(line: str, place: Path) -> None:
    """Files beside the output folder are whole, or not there."""
    for name, data in written_beside(place).items():
        assert WHOLE[line].get(name) == data, f"{name} is not the file of a whole run"


def _start(words: list[str], place: Path, prepare: object) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "fabrication", *words],
        cwd=place,
        env={"SOURCE_DATE_EPOCH": "1700000000", **ENVIRONMENT},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        start_new_session=True,
        preexec_fn=prepare,  # type: ignore[arg-type]
    )


def _said(job: subprocess.Popen[str]) -> str:
    try:
        return job.communicate(timeout=LONGEST)[0]
    except subprocess.TimeoutExpired:
        os.killpg(job.pid, signal.SIGKILL)
        raise AssertionError(f"does not end: {job.communicate()[0][-600:]}") from None


def _require_clean(said: str, place: Path, group: int) -> None:
    """No traceback, no process, no working folder; what is in the output folder is whole."""
    assert "Traceback" not in said, f"a traceback: {said[-800:]}"
    assert not re.search(r"terminate called|fault of ddgfab|Segmentation", said), said[-800:]
    for _ in range(50):
        if not (left := processes_of(group)):
            break
        time.sleep(0.2)
    assert not left, f"processes are left: {left}"
    hidden = [p.name for p in place.rglob(".*")]
    assert not hidden, f"left behind: {hidden}"
    if (place / "out").exists():
        wrong = faults(place / "out")
        assert wrong is None, f"not whole: {wrong}"


def _state(place: Path) -> set[tuple[str, int, int]]:
    found = set()
    for path in place.rglob("*"):
        with suppress(FileNotFoundError):
            state = path.lstat()
            found.add((str(path.relative_to(place)), state.st_size, state.st_mtime_ns))
    return found


def attack(count: int, folder: Path, *, signals: bool = False, seed: int = 0) -> Counter[str]:
    """Outcomes by kind; what may not happen begins with FAILED."""
    rng, outcomes = random.Random(seed), Counter[str]()
    for number in range(seed, seed + count):
        words = lines()[number % len(lines())]
        place = folder / "-".join(w.strip("-./") for w in words[:2])
        if not place.exists():
            place.mkdir()
            inputs.copied(place)
        line = " ".join(words)
        try:
            if signals:
                if line not in TOOK:
                    clear(place)
                    begin = time.monotonic()
                    _said(_start(words, place, as_in_a_terminal))
                    TOOK[line] = time.monotonic() - begin
                    WHOLE[line] = written_beside(place)
                if WHOLE[line].keys() != written_beside(place).keys() or rng.random() < 0.5:
                    clear(place)
                outcome = stopped(rng, place, words, TOOK[line])
                _require_whole(line, place)
            else:
                if rng.random() < 0.5:
                    clear(place)
                outcome = short_of_memory(rng, place, words)
        except AssertionError as error:
            outcome = f"FAILED {line}: {error}"
        outcomes[outcome] += 1
    return outcomes


def main() -> int:
    """Attack, print, and say whether all went well."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--signals", action="store_true", help="stop them by signals")
    given = parser.parse_args()
    outcomes = Counter[str]()
    with TemporaryDirectory() as folder:
        for begin in range(0, given.count, 10):
            count, seed = min(10, given.count - begin), given.seed + begin
            outcomes += attack(count, Path(folder), signals=given.signals, seed=seed)
            print(f"{begin + count} runs: {dict(outcomes)}", flush=True)
    return 1 if any(kind.startswith("FAILED") for kind in outcomes) else 0


if __name__ == "__main__":
    sys.exit(main())

"""Jobs killed at random moments; the folder is the old or the new result, with others' files.

    python tests/attack/kills.py --count 200                 # small results, a second each
    python tests/attack/kills.py --count 50 --command        # `ddgfab make`, whole process groups

Kills at every operation of the commit, in every way in which a folder takes its place, are
`DDGFAB_ATTACK=1 pytest tests/fabrication/test_job_kills.py`.
"""

from __future__ import annotations

import argparse
import os
import random
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory

HERE = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(HERE), str(HERE / "tests" / "fabrication")]

import folder_cases as cases  # noqa: E402
from roofs import barrel  # noqa: E402

from ddgfab.errors import DdgError  # noqa: E402
from ddgfab.io import write_obj  # noqa: E402
from fabrication.job.folder import OutputFolder  # noqa: E402
from fabrication.job.manifest import faults  # noqa: E402

ENVIRONMENT = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
JOB = """
import sys
from pathlib import Path
import folder_cases as cases
print("begin", flush=True)
for k in range(1000):
    cases.make_job(Path(sys.argv[1]), f"run{k}")
"""
COMMAND = ["make", "roof.obj", "--formats", "csv,stl", "--verify", "none", "--jobs", "2", "-q"]


def kill_small_jobs(rng: random.Random, target: Path) -> str:
    """A process that makes one result after the other is killed; which run's result is there."""
    job = subprocess.Popen(
        [sys.executable, "-c", JOB, str(target)], env=ENVIRONMENT, stdout=subprocess.PIPE
    )
    assert job.stdout is not None
    job.stdout.readline()
    time.sleep(rng.uniform(0.0, 0.5))
    job.kill()
    job.wait()
    OutputFolder(target).prepare()
    if not target.exists():
        return "nothing yet"
    cases.text_of(target)
    if not (target / "notes").exists():
        cases.add_others(target)
        return "first result"
    cases.require_others(target)
    return "whole"


class Command:
    """`ddgfab make` with two workers; the first job comes through and tells what is whole."""

    def __init__(self) -> None:
        self.files: set[str] = set()
        self.longest = 0.0

    def __call__(self, rng: random.Random, target: Path) -> str:
        """Start a job, kill it with its workers after a while, and look at what is there."""
        roof = target.with_name("roof.obj")
        if not roof.exists():
            write_obj(roof, barrel(4, 5))
        begin = time.monotonic()
        job = subprocess.Popen(
            [sys.executable, "-m", "fabrication", *COMMAND, "-o", str(target)],
            cwd=target.parent,
            env=ENVIRONMENT,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            start_new_session=True,
        )
        try:
            # Most of a job is spent before its files are there: half of the kills come at its end.
            part = rng.choice((rng.uniform(0.1, 1.0), rng.uniform(0.8, 1.05)))
            said = job.communicate(timeout=part * self.longest if self.files else None)[1]
        except subprocess.TimeoutExpired:
            os.killpg(job.pid, signal.SIGKILL)
            job.communicate()
            ended = "killed"
        else:
            self.longest = 0.5 * (self.longest or time.monotonic() - begin)
            self.longest += 0.5 * (time.monotonic() - begin)
            if job.returncode:
                return f"FAILED with {job.returncode}: {said.decode()[-300:]}"
            ended = "came through"
        OutputFolder(target).prepare()
        wrong = faults(target)
        if wrong is not None:
            return f"FAILED: {wrong}"
        files = {str(path.relative_to(target)) for path in target.rglob("*") if path.is_file()}
        self.files = self.files or files
        if not (target / "mine").exists():
            if len(self.files) != len(files):
                return "FAILED: a file of others is lost"
            (target / "mine").write_text("keep")
        elif files - {"mine"} != self.files:
            return f"FAILED: files differ: {sorted((files - {'mine'}) ^ self.files)}"
        if left := processes_of(job.pid):
            return f"FAILED: processes are left: {left}"
        return f"{ended}, whole"


def processes_of(group: int) -> list[int]:
    """Processes of a session that still run."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            words = path.read_text().rpartition(")")[2].split()
            if int(words[3]) == group and words[0] != "Z":
                found.append(int(path.parent.name))
    return found


def attack(
    count: int,
    folder: Path,
    *,
    kill: Callable[[random.Random, Path], str] = kill_small_jobs,
    seed: int = 0,
) -> Counter[str]:
    """Outcomes by kind; what may not happen begins with FAILED."""
    rng, outcomes = random.Random(seed), Counter[str]()
    target = folder / "out"
    for _ in range(count):
        try:
            outcome = kill(rng, target)
        except (DdgError, AssertionError, OSError) as error:
            outcome = f"FAILED: {type(error).__name__}: {error}"
        outcomes[outcome] += 1
        left = {path.name for path in folder.iterdir()} - {"out", "roof.obj"}
        if left:
            outcomes[f"FAILED: left behind: {sorted(left)}"] += 1
    return outcomes


def main() -> int:
    """Attack, print, and say whether all went well."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--command", action="store_true", help="kill `ddgfab make`")
    given = parser.parse_args()
    outcomes, kill = Counter[str](), Command() if given.command else kill_small_jobs
    with TemporaryDirectory() as folder:
        for begin in range(0, given.count, 10):
            count = min(10, given.count - begin)
            outcomes += attack(count, Path(folder), kill=kill, seed=given.seed + begin)
            print(f"{begin + count} jobs: {dict(outcomes)}", flush=True)
    return 1 if any(kind.startswith("FAILED") for kind in outcomes) else 0


if __name__ == "__main__":
    sys.exit(main())

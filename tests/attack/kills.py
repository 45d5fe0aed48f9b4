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
from pathlib import Path
from tempfile import TemporaryDirectory

HERE = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(HERE), str(HERE / "tests" / "fabrication")]

import folder_cases as cases  # noqa: E402

from ddgfab.errors import DdgError  # noqa: E402
from fabrication.job.folder import OutputFolder  # noqa: E402
from fabrication.job.manifest import faults, read_manifest  # noqa: E402

ENVIRONMENT = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
JOB = """
import sys
from pathlib import Path
import folder_cases as cases
print("begin", flush=True)
for k in range(1000):
    cases.make_job(Path(sys.argv[1]), f"run{k}")
"""
COMMAND = ["make", "--formats", "csv,stl", "--verify", "none", "--set", "net.panels_along=4"]


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


def kill_command(rng: random.Random, target: Path) -> str:
    """`ddgfab make` with two workers is killed, the whole group."""
    begin, ended_before = time.monotonic(), target.exists()
    job = subprocess.Popen(
        [sys.executable, "-m", "fabrication", *COMMAND, "-q", "-o", str(target), "--jobs", "2"],
        env=ENVIRONMENT,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    try:
        job.wait(timeout=rng.uniform(0.3, 1.1) * kill_command.longest)  # type: ignore[attr-defined]
    except subprocess.TimeoutExpired:
        os.killpg(job.pid, signal.SIGKILL)
        job.wait()
        ended = "killed"
    else:
        kill_command.longest = time.monotonic() - begin  # type: ignore[attr-defined]
        ended = "came through" if job.returncode == 0 else f"FAILED with {job.returncode}"
    OutputFolder(target).prepare()
    if target.exists():
        wrong = faults(target)
        if wrong is not None:
            return f"FAILED: {wrong}"
        if len(read_manifest(target / "manifest.json")["files"]) < 20:
            return "FAILED: files are missing"
        if not (target / "mine").exists() and ended_before:
            return "FAILED: a file of others is lost"
        (target / "mine").write_text("keep")
    return f"{ended}, {'whole' if target.exists() else 'nothing yet'}"


kill_command.longest = 20.0  # type: ignore[attr-defined]


def attack(count: int, folder: Path, *, command: bool = False, seed: int = 0) -> Counter[str]:
    """Outcomes by kind; what may not happen begins with FAILED."""
    rng, outcomes = random.Random(seed), Counter[str]()
    target = folder / "out"
    for _ in range(count):
        try:
            outcome = (kill_command if command else kill_small_jobs)(rng, target)
        except (DdgError, AssertionError, OSError) as error:
            outcome = f"FAILED: {type(error).__name__}: {error}"
        outcomes[outcome] += 1
        left = {path.name for path in folder.iterdir()} - {"out"}
        if left:
            outcomes[f"FAILED: left behind: {sorted(left)}"] += 1
    return outcomes


def main() -> int:
    """Attack, print, and say whether all went well."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--command", action="store_true", help="kill `ddgfab make`")
    given = parser.parse_args()
    with TemporaryDirectory() as folder:
        outcomes = attack(given.count, Path(folder), command=given.command)
    print(f"{given.count} kills: {dict(outcomes)}")
    return 1 if any(kind.startswith("FAILED") for kind in outcomes) else 0


if __name__ == "__main__":
    sys.exit(main())

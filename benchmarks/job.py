"""The whole job on a mesh, against a naive build123d script of the same parts and files.

    python benchmarks/job.py MESH [--rounds 3]

Alternates them in one run: `ddgfab make` with the cheap checks, with everything read back, and
`naive_job.py`, once as it is and once with the families given for nothing. Ours is timed as a user
would (process start included), theirs without start and without the design. Median of the rounds.
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent


def ours(mesh: Path, folder: Path, verify: str) -> float:
    """Seconds of one `ddgfab make`."""
    begin = time.perf_counter()
    program = "from fabrication.cli import main; main()"
    words = ["make", str(mesh), "-o", str(folder), "--verify", verify]
    words += ["--set", "project.median_edge_mm=1500"]
    done = subprocess.run([sys.executable, "-c", program, *words], capture_output=True, check=False)
    if done.returncode != 0:
        raise SystemExit(done.stderr.decode())
    return time.perf_counter() - begin


def theirs(mesh: Path, folder: Path, *more: str) -> dict[str, float]:
    """Seconds of the naive script, by step."""
    words = [sys.executable, str(HERE / "naive_job.py"), str(mesh), str(folder), *more]
    done = subprocess.run(words, capture_output=True, check=True)
    result: dict[str, float] = json.loads(done.stdout.decode().splitlines()[-1])
    return result


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description="The whole job against a naive script")
    parser.add_argument("mesh", type=Path)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    cheap, full, naive, given = [], [], [], []
    with tempfile.TemporaryDirectory() as place:
        for k in range(options.rounds):
            cheap.append(ours(options.mesh, Path(place) / f"cheap-{k}", "none"))
            full.append(ours(options.mesh, Path(place) / f"full-{k}", "all"))
            naive.append(theirs(options.mesh, Path(place) / f"naive-{k}"))
            given.append(theirs(options.mesh, Path(place) / f"given-{k}", "--families"))
            print(
                f"round {k + 1}: cheap {cheap[-1]:.1f} s, all read back {full[-1]:.1f} s, "
                f"naive {naive[-1]['total']:.1f} s, with families given {given[-1]['total']:.1f} s",
                flush=True,
            )
    steps = {step: statistics.median(n[step] for n in naive) for step in naive[0]}
    print("naive, by step: " + ", ".join(f"{step} {s:.1f} s" for step, s in steps.items()))
    total = steps["total"]
    shared = statistics.median(n["total"] for n in given)
    for name, times, target in (("cheap checks", cheap, 10), ("all read back", full, 4)):
        median = statistics.median(times)
        print(
            f"{name}: {median:.1f} s, {total / median:.1f} times faster (target {target}); "
            f"{shared / median:.1f} times where the naive script is given the families"
        )


if __name__ == "__main__":
    main()

"""Kits of linkages: seconds for all files, and how the search for contacts grows with the net.

    python benchmarks/linkage.py [--rounds 3]

The default Bennett kit (target 30 s) and a K-net of 6 x 6 isograms, 84 bars on 49 pins (target 180
s), each as a user would run it, with everything read back; then the certified free range of nets of
3 x 3, 6 x 6 and 12 x 12 isograms: pairs that were looked at for an interval of the driving angle,
beside all pairs of parts. Median of the rounds.
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

import numpy as np

from fabrication.linkage.bodies import bodies
from fabrication.linkage.detail import detail_linkage
from fabrication.linkage.kit import find_kit_project
from fabrication.linkage.widen import motion_of

NET = ["knet", "--set", "linkage.cells=[6,6]", "--set", "linkage.deltas_deg=[12,12]"]


def kit_seconds(words: list[str], folder: Path) -> tuple[float, dict[str, float]]:
    """Seconds of one `ddgfab linkage`, process start included, and those of its steps."""
    program = "from fabrication.cli import main; main()"
    begin = time.perf_counter()
    command = [sys.executable, "-c", program, "linkage", *words, "-o", str(folder)]
    done = subprocess.run(command, capture_output=True, check=False)
    seconds = time.perf_counter() - begin
    if done.returncode != 0:
        raise SystemExit(done.stderr.decode())
    steps: dict[str, float] = json.loads((folder / "run.json").read_text())["seconds"]
    return seconds, steps


def kits(rounds: int) -> None:
    """Whole kits."""
    with tempfile.TemporaryDirectory() as place:
        for name, words, target in (("bennett", [], 30), ("K-net 6 x 6", NET, 180)):
            runs = [kit_seconds(words, Path(place) / f"{name}-{k}") for k in range(rounds)]
            median = statistics.median(seconds for seconds, _ in runs)
            print(f"{name}: {median:.1f} s (target {target} s)")
            steps = sorted(runs[-1][1].items(), key=lambda step: -step[1])[:6]
            print("  " + ", ".join(f"{step} {seconds:.1f} s" for step, seconds in steps))


def growth(rounds: int) -> None:
    """The search for contacts on nets of one shape, cut finer."""
    for cells in (3, 6, 12):
        given = {"cells": [cells, cells], "deltas_deg": [72 / cells, 72 / cells]}
        project = find_kit_project("knet", given)
        linkage = detail_linkage(project.mechanism(), project.part_settings())
        times = []
        for _ in range(rounds):
            begin = time.perf_counter()
            motion = motion_of(linkage)
            times.append(time.perf_counter() - begin)
        parts = len(bodies(linkage))
        moved = np.degrees(motion.range)
        print(
            f"{cells} x {cells}: {linkage.mechanism.n_bars} bars, {parts} parts, "
            f"{parts * (parts - 1) // 2} pairs of parts; free through {moved:.1f} deg, "
            f"{motion.examined / max(moved, 1):.0f} pairs examined a degree, "
            f"{statistics.median(times):.2f} s"
        )


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description="Kits of linkages")
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    kits(options.rounds)
    growth(options.rounds)


if __name__ == "__main__":
    main()

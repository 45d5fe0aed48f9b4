"""Time and peak memory of the whole job at 1, 4 and 16 times the panels of the built-in example.

python benchmarks/growth.py [--steps 1 2 4]
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PROGRAM = """
import json, resource, sys
from fabrication.cli import main
try:
    main()
finally:
    own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    workers = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    print("PEAK", own, workers, file=sys.stderr)
"""


def run(factor: int, folder: Path, verify: str) -> tuple[float, float, float]:
    """Seconds, peak memory of the main process and of its largest worker [MB]."""
    words = ["make", "-o", str(folder), "--verify", verify]
    words += ["--set", f"net.panels_along={28 * factor}"]
    words += ["--set", f"net.panels_across={11 * factor}"]
    # Smaller turns from panel to panel keep the shape; the span stays, panels keep their size.
    begin = time.perf_counter()
    done = subprocess.run([sys.executable, "-c", PROGRAM, *words], capture_output=True, check=False)
    seconds = time.perf_counter() - begin
    text = done.stderr.decode()
    if done.returncode != 0:
        raise SystemExit(text)
    own, workers = text.rsplit("PEAK", 1)[1].split()
    return seconds, int(own) / 1024, int(workers) / 1024


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description="Growth of time and memory")
    parser.add_argument("--steps", type=int, nargs="+", default=[1, 2, 4])
    parser.add_argument("--verify", default="none")
    options = parser.parse_args()
    print(f"{'panels':>8}{'seconds':>10}{'ms/panel':>10}{'main MB':>10}{'worker MB':>11}")
    with tempfile.TemporaryDirectory() as place:
        for factor in options.steps:
            panels = 308 * factor**2
            seconds, own, worker = run(factor, Path(place) / str(factor), options.verify)
            each = 1e3 * seconds / panels
            print(f"{panels:8}{seconds:10.1f}{each:10.1f}{own:10.0f}{worker:11.0f}", flush=True)


if __name__ == "__main__":
    main()

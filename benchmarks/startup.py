"""What a user waits for before anything happens: `ddgfab --help`, `ddgfab inspect` on 1,000 quads.

python benchmarks/startup.py
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from ddgfab.forms import canopy
from ddgfab.io import write_obj

ROUNDS = 7


def seconds(*words: str) -> float:
    """Median time of a command in a fresh process."""
    program = "from fabrication.cli import main; main()"
    times = []
    for _ in range(ROUNDS):
        begin = time.perf_counter()
        subprocess.run([sys.executable, "-c", program, *words], capture_output=True, check=True)
        times.append(time.perf_counter() - begin)
    return statistics.median(times)


def main() -> None:
    """Run and print."""
    with tempfile.TemporaryDirectory() as place:
        mesh = Path(place) / "roof.obj"
        write_obj(mesh, canopy(panels_along=50, panels_across=20))
        print(f"ddgfab --help: {seconds('--help'):.2f} s (target 0.5)")
        print(f"ddgfab inspect, 1,000 quads: {seconds('inspect', str(mesh)):.2f} s (target 1.5)")


if __name__ == "__main__":
    main()

"""Planar faces: how processor time and peak memory grow with the number of quads.

Run: python benchmarks/planar_growth.py [--kind wavy] [SIDE ...]

Each mesh has SIDE x SIDE quads, or AxB; by default about 1,000, 3,000, 10,000, 30,000 and 100,000
in all. Every run is a process of its own. Seconds are processor time of `optimize`, with its check
of the limits, on one thread.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import time

import numpy as np
from planar_meshes import GRIDS
from planarise import ONE_THREAD

from ddgfab.grid import grid_mesh
from ddgfab.mesh import Mesh
from ddgfab.optimize import optimize

SIDES = ("32", "55", "100", "173", "316")


def mesh_of(kind: str, side: str) -> Mesh:
    """A mesh of the benchmark, or for AxB a part of one."""
    rows, columns = (int(part) for part in (side.split("x") * 2)[:2])
    n = max(rows, columns)
    points = GRIDS[kind](n).vertices.reshape(n + 1, n + 1, 3)
    return grid_mesh(points[: rows + 1, : columns + 1], (False, False))


def one(kind: str, side: str) -> dict[str, float]:
    """Measure one mesh."""
    mesh = mesh_of(kind, side)
    begin = time.process_time()
    result = optimize(mesh, throw=False)
    seconds = time.process_time() - begin
    change = result.change
    return {
        "faces": mesh.n_faces,
        "seconds": seconds,
        "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        "steps": len(result.history),
        "percent": 100 * result.residual,
        "mean": change.distance_mean / change.edge,
        "greatest": change.distance_out[1] / change.edge,
        "folded": len(change.folded),
        "reflex": len(change.reflex_quads),
    }


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description="growth of planarization")
    parser.add_argument("sides", nargs="*", default=SIDES)
    parser.add_argument("--kind", default="wavy", choices=("wavy", "noisy", "dome"))
    parser.add_argument("--one", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        print(json.dumps(one(options.kind, options.one)))
        return
    print(options.kind)
    print("  faces  seconds  exponent  peak MB  steps    %   mean  greatest  folded  reflex")
    last: dict[str, float] | None = None
    for side in options.sides:
        words = [sys.executable, __file__, "--kind", options.kind, "--one", side]
        done = subprocess.run(words, capture_output=True, check=True, text=True, env=ONE_THREAD)
        got = json.loads(done.stdout.splitlines()[-1])
        growth = ""
        if last is not None and got["faces"] > last["faces"]:
            ratio = np.log(got["seconds"] / last["seconds"])
            growth = f"{ratio / np.log(got['faces'] / last['faces']):.2f}"
        print(
            f"{got['faces']:7} {got['seconds']:8.1f} {growth:>9} {got['peak_mb']:8.0f}"
            f"{got['steps']:7}{got['percent']:6.2f}{got['mean']:7.3f}{got['greatest']:10.2f}"
            f"{got['folded']:8}{got['reflex']:8}",
            flush=True,
        )
        last = got


if __name__ == "__main__":
    main()

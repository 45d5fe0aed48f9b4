"""Repetition: number of families before and after, within a fit tolerance and a movement.

Run: python benchmarks/families.py FOLDER, where six_quad.obj and heart.obj lie. Tolerance and
movement are parts of the mean edge. Seconds are processor time; set OMP_NUM_THREADS=1.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

from ddgfab.io import read_mesh
from ddgfab.measures import planarity_percent
from ddgfab.optimize import families
from ddgfab.optimize.repetition import Piece

CASES: tuple[tuple[str, Piece, float, float], ...] = (
    ("six_quad", "edge", 0.001, 0.1),
    ("six_quad", "panel", 0.001, 0.1),
    ("six_quad", "panel", 0.005, 0.1),
    ("heart", "edge", 0.001, 0.1),
    ("heart", "panel", 0.005, 0.1),
)
"""Mesh, pieces, fit tolerance and greatest movement [mean edges]."""


def main() -> None:
    """Print the table."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    for name, of, tolerance, movement in CASES:
        mesh = read_mesh(folder / f"{name}.obj").mesh
        unit, begin = float(mesh.edge_lengths.mean()), time.process_time()
        result = families(
            mesh,
            of=of,
            fit_tolerance=tolerance * unit,
            max_movement=movement * unit,
            throw=False,
        )
        seconds = time.process_time() - begin
        print(
            f"{name:10s} {of:6s} tolerance {tolerance:g}: {len(result.labels)} pieces, "
            f"{result.families_before} -> {result.families} families, movement "
            f"{result.movement_max / unit:.3f} {result.movement_mean / unit:.3f}, planarity "
            f"{planarity_percent(mesh).max():.1g} -> {planarity_percent(result.mesh).max():.1g} %, "
            f"{result.status}, {seconds:.0f} s",
            flush=True,
        )


if __name__ == "__main__":
    main()

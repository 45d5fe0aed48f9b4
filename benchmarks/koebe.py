"""Koebe polyhedra of growing size, and minimal surfaces dual to them; on one core.

python benchmarks/koebe.py [--quick]

The peer minimises the same convex functional by L-BFGS (scipy), the method that one would take
first: gradient only, no Hessian.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import math
import resource
import time
from collections.abc import Callable
from typing import TypeVar

import numpy as np
from scipy.optimize import minimize
from scipy.spatial import ConvexHull

from ddgfab.mesh import Mesh
from ddgfab.nets.koebe import koebe
from ddgfab.nets.koebe.pattern import CirclePattern
from ddgfab.nets.koebe.solids import cube_cells
from ddgfab.nets.minimal import minimal_surface

LIMITS = {10_000: 2.0, 100_000: 40.0}
LIMIT_DUAL_S = 1.0
CELLS = 100
T = TypeVar("T")


def cube(circles: int) -> Mesh:
    """The cube in equal cells with about so many vertices and faces: 12 k^2 + 2."""
    return cube_cells(round(math.sqrt(circles / 12.0)))


def hull(circles: int) -> Mesh:
    """Hull of random points: V vertices of any degree and 2 V - 4 triangles."""
    points = np.random.default_rng(0).normal(size=((circles + 4) // 3, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    faces = ConvexHull(points).simplices.astype(np.int64)
    out = np.linalg.det(points[faces]) < 0
    faces[out] = faces[out][:, ::-1]
    return Mesh.build(points, faces)


def timed(task: Callable[[], T], repeat: int = 1) -> tuple[float, T]:
    """Seconds, the least of some runs, and the result."""
    best = math.inf
    for _ in range(repeat):
        begin = time.perf_counter()
        result = task()
        best = min(best, time.perf_counter() - begin)
    return best, result


def verdict(value: float, limit: float) -> str:
    return "ok" if value <= limit else "MISSED"


def by_lbfgs(mesh: Mesh) -> tuple[float, float]:
    """Seconds and greatest missing angle [rad] of the peer."""
    pattern = CirclePattern(mesh, 0)
    seconds, found = timed(
        lambda: minimize(
            lambda rho: (pattern.functional(rho), pattern.gradient(rho)),
            pattern.first_guess(),
            jac=True,
            method="L-BFGS-B",
            options={"maxiter": 100_000, "maxfun": 100_000, "ftol": 0.0, "gtol": 1e-10},
        )
    )
    return seconds, float(np.abs(found.jac).max())


def main() -> None:
    """Print times, growth, exactness."""
    parser = argparse.ArgumentParser(description="Koebe polyhedra and minimal surfaces")
    parser.add_argument("--quick", action="store_true", help="up to 10,000 circles")
    quick = parser.parse_args().quick
    sizes = [1_000, 3_000, 10_000] + ([] if quick else [30_000, 100_000])
    print(
        f"{'':6}{'circles':>9}{'seconds':>9}{'limit':>16}{'steps':>7}{'growth':>8}{'tangency':>10}"
        f"{'peak MB':>9}"
    )
    for name, make in (("cube", cube), ("hull", hull)):
        last: tuple[int, float] | None = None
        for size in sizes:
            mesh = make(size)
            seconds, solid = timed(lambda m=mesh: koebe(Mesh.build(m.vertices, m.faces)))
            count = mesh.n_vertices + mesh.n_faces
            limit = LIMITS.get(size)
            said = "" if limit is None else f"{limit:g} s {verdict(seconds, limit)}"
            order = "" if last is None else f"{math.log(seconds / last[1], count / last[0]):.2f}"
            peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
            print(
                f"{name:6}{count:9}{seconds:9.2f}{said:>16}{len(solid.history) - 1:7}{order:>8}"
                f"{solid.residuals()['tangency']:10.1e}{peak:9.0f}",
                flush=True,
            )
            last = count, seconds
    small = cube(1_000)
    own = timed(lambda: koebe(Mesh.build(small.vertices, small.faces)), 3)[0]
    peer, left = by_lbfgs(small)
    print(
        f"{small.n_vertices + small.n_faces} circles: L-BFGS {peer:.1f} s to a missing angle of "
        f"{left:.0e} rad, without layout; Newton {own:.3f} s with all: {peer / own:.0f} times less"
    )
    cells = 30 if quick else CELLS
    solid = koebe(cube_cells(cells))
    seconds, net = timed(lambda: minimal_surface(solid.net(np.arange(cells**2))), 3)
    turned, other = timed(lambda: net.associated(0.5 * math.pi), 3)
    print(
        f"dual and minimal surface of {cells} x {cells} cells: {seconds:.3f} s (limit "
        f"{LIMIT_DUAL_S:g} s: {verdict(seconds, LIMIT_DUAL_S)}), closing {net.closing:.0e}; "
        f"conjugate surface {turned:.3f} s, closing {other.closing:.0e}"
    )


if __name__ == "__main__":
    main()

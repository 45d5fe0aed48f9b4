"""Tracing, fitting, and the design dilemma: process seconds, best of three.

python benchmarks/surfaces.py
"""

from __future__ import annotations

import runpy
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ddgfab.grid import grid_mesh
from ddgfab.mesh import Mesh
from ddgfab.redesign.dilemma import dilemma
from ddgfab.surfaces.analytic import named_surface
from ddgfab.surfaces.fit import fit_mesh
from ddgfab.trace import trace

EXAMPLE = Path(__file__).parents[1] / "examples" / "surface_dilemma.py"
ROUNDS = 3


def seconds(work: Callable[[], object]) -> float:
    """Least process time of some rounds [s]."""
    times = []
    for _ in range(ROUNDS):
        begin = time.process_time()
        work()
        times.append(time.process_time() - begin)
    return min(times)


def scan(count: int) -> Mesh:
    """A roof of about `count` vertices with noise of 1e-4 of its size."""
    side = round(np.sqrt(count))
    x, y = np.meshgrid(np.linspace(-12, 12, side), np.linspace(-8, 8, side), indexing="ij")
    z = 3 * (1 - 0.7 * (y / 8) ** 2 - 0.2 * (x / 12) ** 2)
    z += 3e-3 * np.random.default_rng(1).normal(size=z.shape)
    quads = grid_mesh(np.stack([x, y, z], axis=-1))
    faces = [t for a, b, c, d in quads.faces for t in ((a, b, c), (a, c, d))]
    return Mesh.build(quads.vertices, faces)


if __name__ == "__main__":
    roof = named_surface("wave-roof")
    for spacing, limit in ((1350.0, 2), (685.0, 4)):
        taken = seconds(lambda spacing=spacing: trace(roof, spacing))
        count = trace(roof, spacing).mesh.n_vertices
        print(f"trace, {count} vertices: {taken:.2f} s (limit {limit})")
    cloud = scan(6000)
    print(f"fit, {cloud.n_vertices} vertices: {seconds(lambda: fit_mesh(cloud)):.2f} s (limit 1)")
    drawn = runpy.run_path(str(EXAMPLE))["lattice"](np.radians(30))
    print(f"dilemma, {drawn.n_faces} faces: {seconds(lambda: dilemma(drawn)):.2f} s (limit 1)")

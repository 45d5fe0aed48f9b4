"""Planar faces: `optimize` beside ShapeOp, libigl and compas, on the same meshes, in one run.

python benchmarks/planarise.py [--quick] [--limit SECONDS] [--only NAME ...]

The peers are used when they are installed (pip install compas compas-shapeop libigl); missing ones
are named. Every run is a process of its own, so that its peak memory is its own, and ends at the
time limit. Times are processor seconds of the solving alone. ddgfab uses numpy and scipy alone.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import json
import os
import platform
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ddgfab.grid import grid_mesh
from ddgfab.io import read_mesh
from ddgfab.mesh import Floats, Mesh
from ddgfab.optimize import Change, Keep, Quality, optimize

MESHES = Path(__file__).resolve().parents[2] / "shared" / "data" / "meshes"
FILES = ("heart", "botanic_garden_bubble", "chebyshev_sphere", "helical_minimal", "knet1")
SIZES = {"400": 20, "1,000": 32, "10,000": 100, "100,000": 316}


ONE_THREAD = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", MKL_NUM_THREADS="1")


# --- meshes --------------------------------------------------------------------------------------
def wavy(n: int, noise: float = 0.0) -> Mesh:
    """n x n quads of side one on a wavy sheet; the net runs off the principal directions."""
    u, v = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1), indexing="ij")
    x, y = u + 0.04 * np.sin(2 * np.pi * v), v + 0.04 * np.sin(2 * np.pi * u)
    z = 0.08 * np.sin(2 * np.pi * u + 0.5) * np.cos(2 * np.pi * v) + 0.1 * u * v
    points = n * np.stack([x, y, z], axis=-1)
    points += noise * np.random.default_rng(0).normal(size=points.shape)
    return grid_mesh(points, (False, False))


def dome(n: int) -> Mesh:
    """n x n quads on a paraboloid, the net turned by 0.5 rad off its principal directions."""
    u, v = np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, n + 1), indexing="ij")
    x, y = np.cos(0.5) * u - np.sin(0.5) * v, np.sin(0.5) * u + np.cos(0.5) * v
    z = -0.35 * x**2 - 0.1 * y**2 + 0.02 * np.sin(3 * x) * np.cos(2 * y)
    return grid_mesh(n / 2 * np.stack([x, y, z], axis=-1), (False, False))


def torus(n: int) -> Mesh:
    """n x n quads on a closed torus, the net twisted off its principal directions."""
    u, v = np.meshgrid(*2 * [2 * np.pi * np.arange(n) / n], indexing="ij")
    a, b = u + 0.2 * np.sin(v), v + 0.2 * np.sin(u)
    ring = 2 + np.cos(b)
    points = np.stack([ring * np.cos(a), ring * np.sin(a), np.sin(b)], axis=-1)
    return grid_mesh(n / 8 * points, (True, True))


GRIDS: dict[str, Callable[[int], Mesh]] = {
    "wavy": wavy,
    "noisy": lambda n: wavy(n, 0.05),
    "dome": dome,
    "torus": torus,
}


def mesh_named(name: str) -> Mesh:
    """A mesh by its name in the table: a file, or "wavy 10,000"."""
    if name in FILES:
        return read_mesh(MESHES / f"{name}.obj").mesh
    kind, size = name.split()
    return GRIDS[kind](SIZES[size])


# --- methods: mesh -> vertices, seconds ----------------------------------------------------------
def ours(mesh: Mesh) -> tuple[Floats, float, str]:
    """`optimize` with all defaults: faces planar to 0.2 %."""
    return planarized(mesh, None, "balanced")


def exact(mesh: Mesh) -> tuple[Floats, float, str]:
    """The same, faces planar to 1e-10."""
    return planarized(mesh, 0.0, "balanced")


def coarse(mesh: Mesh) -> tuple[Floats, float, str]:
    """As planar as libigl stops, as close to the surface as it can be."""
    return planarized(mesh, 0.5, "close")


def planarized(mesh: Mesh, flat: float | None, keep: Keep) -> tuple[Floats, float, str]:
    """`optimize`, timed; the limits of distance do not end a run, they are noted."""
    begin = time.process_time()
    result = optimize(mesh, flat=flat, keep=keep, throw=False)
    seconds = time.process_time() - begin
    note = f"{len(result.history)} steps"
    return (
        result.mesh.vertices,
        seconds,
        note + ("" if result.status == "converged" else ", refused"),
    )


def libigl(mesh: Mesh, threshold: float) -> tuple[Floats, float, str]:
    """igl.planarize_quad_mesh (Bouaziz et al. 2012)."""
    import igl

    quads = mesh.corners.reshape(-1, 4).astype(np.int64)
    begin = time.process_time()
    points = igl.planarize_quad_mesh(mesh.vertices, quads, 10_000, threshold)
    return np.asarray(points), time.process_time() - begin, f"threshold {threshold:g}"


def shapeop(mesh: Mesh, rounds: int, closeness: float) -> tuple[Floats, float, str]:
    """compas_shapeop: plane constraints of weight 1, closeness as given."""
    from compas_shapeop.shapeop import Solver

    solver = Solver()
    solver.points = mesh.vertices.copy()
    begin = time.process_time()
    for face in mesh.corners.reshape(-1, 4).tolist():
        solver.add_plane_constraint(face, 1.0)
    for vertex in range(mesh.n_vertices):
        solver.add_closeness_constraint(vertex, closeness)
    solver.init()
    solver.solve(rounds)
    return np.array(solver.points), time.process_time() - begin, f"{rounds} rounds"


def compas(mesh: Mesh) -> tuple[Floats, float, str]:
    """compas mesh_planarize_faces, 100 rounds (pure Python)."""
    from compas.datastructures import Mesh as CompasMesh
    from compas.geometry.quadmesh_planarize_none import mesh_planarize_faces

    other = CompasMesh.from_vertices_and_faces(
        mesh.vertices.tolist(), mesh.corners.reshape(-1, 4).tolist()
    )
    begin = time.process_time()
    mesh_planarize_faces(other, kmax=100)
    seconds = time.process_time() - begin
    return np.array([other.vertex_coordinates(v) for v in other.vertices()]), seconds, "100 rounds"


METHODS: dict[str, tuple[str, Callable[[Mesh], tuple[Floats, float, str]]]] = {
    "ddgfab": ("numpy", ours),
    "ddgfab exact": ("numpy", exact),
    "ddgfab close": ("numpy", coarse),
    "libigl 5e-3": ("libigl", lambda mesh: libigl(mesh, 5e-3)),
    "libigl 2e-3": ("libigl", lambda mesh: libigl(mesh, 2e-3)),
    "libigl 1e-6": ("libigl", lambda mesh: libigl(mesh, 1e-6)),
    "ShapeOp 1e-7": ("compas_shapeop", lambda mesh: shapeop(mesh, 1000, 1e-7)),
    "ShapeOp 1e-3": ("compas_shapeop", lambda mesh: shapeop(mesh, 1000, 1e-3)),
    "compas": ("compas", compas),
}


def one(method: str, name: str) -> dict[str, object]:
    """Run a method on a mesh and measure what came out."""
    mesh = mesh_named(name)
    before = Quality.of(mesh)
    points, seconds, note = METHODS[method][1](mesh)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    if not np.isfinite(points).all():
        return {"seconds": seconds, "note": "not finite", "before": before.planarity}
    after = mesh.with_vertices(points)
    change = Change(mesh, after, mesh)
    edge = change.edge
    return {
        "seconds": seconds,
        "before": before.planarity,
        "planarity": Quality.of(after).planarity,
        "distance": [change.distance_mean / edge, change.distance_out[1] / edge],
        "moved": float(change.movement.mean()) / edge,
        "rise": change.rise_kept,
        "crease": float(np.degrees(change.crease[0])),
        "folded": len(change.folded),
        "reflex": len(change.reflex_quads),
        "peak_mb": peak,
        "note": note,
    }


def installed(package: str) -> str | None:
    """Version of a package, or None."""
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return None


def row(method: str, name: str, limit: float) -> str:
    """Run one method in a process of its own; a line of the table."""
    words = [sys.executable, __file__, "--one", method, name]
    try:
        done = subprocess.run(
            words, capture_output=True, timeout=limit, check=False, text=True, env=ONE_THREAD
        )
    except subprocess.TimeoutExpired:
        return f"{name:<24}{method:<14}{'':>8}  stopped after {limit:g} s"
    if done.returncode != 0:
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        return f"{name:<24}{method:<14}{'':>8}  failed: {last[:90]}"
    got = json.loads(done.stdout.strip().splitlines()[-1])
    if "planarity" not in got:
        return f"{name:<24}{method:<14}{got['seconds']:8.2f}  {got['note']}"
    rise = "-" if got["rise"] is None else f"{got['rise']:.2f}"
    return (
        f"{name:<24}{method:<14}{got['seconds']:8.2f}{got['before']:10.1e}{got['planarity']:10.1e}"
        f"{got['distance'][0]:9.3f}{got['distance'][1]:7.2f}{got['moved']:7.2f}{rise:>6}"
        f"{got['crease']:5.0f}{got['folded']:5}{got['reflex']:5}{got['peak_mb']:7.0f}  "
        + got["note"]
    )


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description="planar faces beside peers")
    parser.add_argument("--quick", action="store_true", help="no grids above 1,000 quads")
    parser.add_argument("--limit", type=float, default=120.0, help="seconds for one run")
    parser.add_argument("--only", nargs="+", help="names of meshes")
    parser.add_argument("--one", nargs=2, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        print(json.dumps(one(*options.one)))
        return
    names = [name for name in FILES if (MESHES / f"{name}.obj").exists()]
    sizes = list(SIZES)[: 2 if options.quick else None]
    names += [f"wavy {size}" for size in sizes]
    names += [f"{kind} {size}" for kind in ("noisy", "dome", "torus") for size in sizes[1:3]]
    names += ["noisy 100,000"] if "100,000" in sizes else []
    packages = ("numpy", "scipy", "libigl", "compas_shapeop", "compas")
    versions = {p: installed(p) for p in packages}
    print(f"Python {platform.python_version()}, {os.cpu_count()} cores; one thread;", end=" ")
    print(", ".join(f"{p} {v or 'MISSING'}" for p, v in versions.items()))
    print(
        "processor seconds; greatest distance of diagonals over their mean before and after; "
        "distance both ways,\nmean, and greatest to the input, mean movement [mean edges]; "
        "rise kept; 99th "
        "percentile of changes of dihedral angles [deg];\nfolded faces; quads with new reflex "
        "corners; peak memory [MB]"
    )
    for name in options.only or names:
        for method, (package, _) in METHODS.items():
            slow = method == "compas" and "," in name  # minutes, and it stops far from planar
            if versions[package] is not None and not slow:
                print(row(method, name, options.limit), flush=True)


if __name__ == "__main__":
    main()

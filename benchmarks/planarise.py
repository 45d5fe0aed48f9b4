"""Planar faces: `optimize` beside libigl and ShapeOp, on the same meshes, in one run.

Run: python benchmarks/planarise.py [--limit SECONDS] [--only NAME ...] [FILE.obj ...]

The peers are used when they are installed (pip install libigl compas compas-shapeop); missing ones
are named. Each runs as it comes, to 0.2 %, and to 1e-10, there with a quarter of the limit; beside
each stands what `optimize` makes at the planarity that the peer reached, once balanced and once
close to the surface. Every run is a process of its own with a limit of processor time; times are
processor seconds of the solving alone, on one thread. Hexagons are for ShapeOp alone: libigl takes
quads.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import multiprocessing
import os
import platform
import resource
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from multiprocessing.connection import Connection

ONE_THREAD = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", MKL_NUM_THREADS="1")
os.environ.update(ONE_THREAD)  # before numpy is loaded

import numpy as np  # noqa: E402
from planar_meshes import FILES, MESHES, mesh_named  # noqa: E402

from ddgfab.measures import planarity_percent  # noqa: E402
from ddgfab.mesh import Floats, Mesh  # noqa: E402
from ddgfab.optimize import Change, Keep, optimize  # noqa: E402

NAMES = (
    "hexdome 400",
    "hexsaddle 400",
    *FILES,
    "wavy 400",
    "wavy 1,000",
    "wavy 1,600",
    "noisy 400",
    "noisy 1,000",
    "dome 1,000",
    "torus 1,000",
)
EXACT = 1e-10
"""The least violation that is asked of anyone."""
_ROUNDS = 50
"""Rounds of ShapeOp between two looks at the planarity."""


@dataclass(frozen=True)
class Made:
    """What a method made of a mesh: seconds, planarity, distances in mean edges, faults."""

    seconds: float
    planarity: float
    mean: float
    greatest: float
    moved: float
    rise: float | None
    crease: float
    folded: int
    reflex: int
    note: str

    @staticmethod
    def of(mesh: Mesh, points: Floats, seconds: float, note: str) -> Made:
        """Measure a result."""
        after = mesh.with_vertices(points)
        change = Change(mesh, after, mesh)
        edge = change.edge
        return Made(
            seconds,
            float(planarity_percent(after).max()) / 100,
            change.distance_mean / edge,
            change.distance_out[1] / edge,
            float(change.movement.mean()) / edge,
            change.rise_kept,
            float(np.degrees(change.crease[0])),
            len(change.folded),
            len(change.reflex_quads) + len(change.reflex_polygons),
            note,
        )

    def __str__(self) -> str:
        rise = "-" if self.rise is None else f"{self.rise:.2f}"
        return (
            f"{self.seconds:7.2f}{100 * self.planarity:10.2g} %{self.mean:8.3f}{self.greatest:7.2f}"
            f"{self.moved:7.2f}{rise:>6}{self.crease:5.0f}{self.folded:4}{self.reflex:4}  "
            + self.note
        )


# --- methods: mesh -> vertices, seconds, note ----------------------------------------------------
Method = Callable[[Mesh], tuple[Floats, float, str]]


def ours(planarity: float, keep: Keep) -> Method:
    """`optimize`; the limits of distance do not end a run, they are noted."""

    def run(mesh: Mesh) -> tuple[Floats, float, str]:
        begin = time.process_time()
        flat = 0.0 if planarity <= EXACT else min(100 * planarity, 100.0)
        result = optimize(mesh, flat=flat, keep=keep, throw=False)
        seconds = time.process_time() - begin
        refused = "" if result.status == "converged" else ", refused"
        return result.mesh.vertices, seconds, f"{len(result.history)} steps{refused}"

    return run


def libigl(threshold: float) -> Method:
    """igl.planarize_quad_mesh (Bouaziz et al. 2012)."""

    def run(mesh: Mesh) -> tuple[Floats, float, str]:
        import igl

        quads = mesh.corners.reshape(-1, 4).astype(np.int64)
        begin = time.process_time()
        points = igl.planarize_quad_mesh(mesh.vertices, quads, 1_000_000, threshold)
        return np.asarray(points), time.process_time() - begin, f"threshold {threshold:g}"

    return run


def shapeop(closeness: float, planarity: float | None) -> Method:
    """ShapeOp: planes of weight 1; 1,000 rounds, or until faces are planar; its looks are free."""

    def run(mesh: Mesh) -> tuple[Floats, float, str]:
        from compas_shapeop.shapeop import Solver

        solver = Solver()
        solver.points = mesh.vertices.copy()
        begin = time.process_time()
        for face in mesh.faces:
            solver.add_plane_constraint(face.tolist(), 1.0)
        for vertex in range(mesh.n_vertices):
            solver.add_closeness_constraint(vertex, closeness)
        solver.init()
        seconds, rounds = time.process_time() - begin, 0
        while True:
            begin = time.process_time()
            solver.solve(_ROUNDS)
            seconds, rounds = seconds + time.process_time() - begin, rounds + _ROUNDS
            points = np.array(solver.points)
            if planarity is None:
                done = rounds >= 1000
            else:
                done = planarity_percent(mesh.with_vertices(points)).max() <= 100 * planarity
            if done:
                return points, seconds, f"closeness {closeness:g}, {rounds:,} rounds"

    return run


PEERS: dict[str, tuple[str, Method]] = {
    "libigl 5e-3": ("libigl", libigl(5e-3)),
    "libigl 2e-3": ("libigl", libigl(2e-3)),
    "libigl 1e-10": ("libigl", libigl(EXACT)),
    "ShapeOp near": ("compas_shapeop", shapeop(1e-3, None)),
    "ShapeOp 0.2 %": ("compas_shapeop", shapeop(1e-7, 2e-3)),
    "ShapeOp 1e-10": ("compas_shapeop", shapeop(1e-7, EXACT)),
}
"""Package and method. "near" is how ShapeOp stays nearest to its input, at its own planarity."""


# --- runs ----------------------------------------------------------------------------------------
def limited(method: Method, name: str, limit: float) -> Made | str:
    """Run a method in a process of its own; the reason where it does not end well."""
    here, there = multiprocessing.Pipe(duplex=False)
    child = multiprocessing.get_context("fork").Process(
        target=_run, args=(method, name, limit, there)
    )
    child.start()
    there.close()
    try:
        got: Made | str = here.recv()
    except EOFError:
        got = f"over {limit:g} s"
    child.join()
    return got


def _run(method: Method, name: str, limit: float, answer: Connection) -> None:
    resource.setrlimit(resource.RLIMIT_CPU, (int(limit) + 2, int(limit) + 2))
    mesh = mesh_named(name)
    try:
        points, seconds, note = method(mesh)
        finite = np.isfinite(points).all()
        answer.send(Made.of(mesh, points, seconds, note) if finite else "not finite")
    except Exception as reason:
        answer.send(f"failed: {reason}"[:100])


@cache
def ours_at(name: str, planarity: float, keep: Keep, limit: float) -> Made | str:
    """What `optimize` makes at a planarity."""
    return limited(ours(planarity, keep), name, limit)


def compare(name: str, limit: float, missing: set[str]) -> None:
    """The rows of a mesh."""
    mesh = mesh_named(name)
    start = float(planarity_percent(mesh).max()) / 100
    print(f"\n{name}: {mesh.n_faces:,} faces, {100 * start:.2g} %")
    print(f"  {'':<22}{'':>7}", f"{'0.2 %, balanced':<24}", ours_at(name, 2e-3, "balanced", limit))
    print(f"  {'':<29}", f"{'exact, balanced':<24}", ours_at(name, EXACT, "balanced", limit))
    for peer, (package, method) in PEERS.items():
        if package in missing or (package == "libigl" and (mesh.face_sizes != 4).any()):
            continue
        made = limited(method, name, limit / 4 if peer.endswith("1e-10") else limit)
        print(f"  {peer:<54}", made, flush=True)
        if isinstance(made, str):
            continue
        wanted = max(EXACT, float(f"{made.planarity:.2g}"))
        for keep in ("balanced", "close"):
            own = ours_at(name, wanted, keep, limit)
            ratio = ""
            if isinstance(own, Made):
                parts = (own.mean / made.mean, own.greatest / made.greatest) if made.mean else ()
                ratio = ", ".join(f"{part:.2f}" for part in parts)
            print(f"    {keep:<25} of theirs: {ratio:<13}", own, flush=True)


def installed(package: str) -> str | None:
    """Version of a package, or None."""
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return None


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description="planar faces beside peers")
    parser.add_argument("files", nargs="*", help="further meshes")
    parser.add_argument("--limit", type=float, default=60.0, help="processor seconds for one run")
    parser.add_argument("--only", nargs="+", help="names of meshes, as wavy 1,000")
    options = parser.parse_args()
    names = [n for n in NAMES if n not in FILES or (MESHES / f"{n}.obj").exists()]
    versions = {p: installed(p) for p in ("numpy", "scipy", "libigl", "compas_shapeop")}
    print(f"Python {platform.python_version()};", end=" ")
    print(", ".join(f"{p} {v or 'MISSING'}" for p, v in versions.items()))
    print(
        "processor seconds; planarity; distance both ways, mean, and greatest to the input, mean "
        "movement [mean edges];\nrise kept; 99th percentile of changes of dihedral angles [deg]; "
        "folded faces; faces with new reflex corners.\n'of theirs': mean and greatest distance "
        "over those of the peer, at its planarity"
    )
    for name in [*options.files, *(options.only or names)]:
        compare(name, options.limit, {p for p, v in versions.items() if v is None})


if __name__ == "__main__":
    main()

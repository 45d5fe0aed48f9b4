"""Torsion-free axes: lean against movement on two roofs, with vertices fixed and free.

Run: python benchmarks/torsion.py FOLDER, where botanic_garden_bubble.obj and heart.obj lie. The
recipe is given a limit of the lean after the other at one limit of the movement; each line is one
mesh with planar faces and axes free of torsion, or says what is missed. Below each curve: where the
lean and movement are greatest in the line of least lean that is met, and what those vertices are.
Seconds are processor time; set OMP_NUM_THREADS=1.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np

from ddgfab.io import read_mesh
from ddgfab.measures import planarity_percent, torsion
from ddgfab.mesh import Floats, Mesh
from ddgfab.optimize import TorsionFreeResult, interior_angles, torsion_free
from ddgfab.support import SupportStructure, even_lean, optimize

CURVES: dict[str, tuple[tuple[float, float], ...]] = {
    "botanic_garden_bubble": (
        (15.0, 0.25),
        (15.0, 0.35),
        (20.0, 0.5),
        (15.0, 0.5),
        (12.0, 0.5),
        (10.0, 0.5),
        (8.0, 0.5),
        (6.0, 0.5),
        (4.0, 0.5),
    ),
    "heart": (
        (28.0, 1.0),
        (25.0, 1.25),
        (25.0, 1.5),
        (20.0, 1.5),
        (15.0, 1.5),
        (20.0, 2.0),
        (15.0, 2.0),
        (10.0, 2.0),
    ),
}
"""Limits for each mesh: greatest lean [deg], greatest movement [mean edges]."""

WORST = 6
"""How many of the vertices that hold a curve back are named."""


def line(name: str, lean: Floats, moved: Floats, rest: str) -> str:
    """A row of the table: greatest and mean lean [deg] and movement [mean edges]."""
    degrees = np.degrees(lean)
    return (
        f"{name:24s} lean {degrees.max():5.1f} {degrees.mean():5.1f}   "
        f"movement {moved.max():.3f} {moved.mean():.3f}   {rest}"
    )


def fixed(mesh: Mesh) -> None:
    """The rows with vertices fixed: normals, least mean lean, least greatest lean."""
    still = np.zeros(mesh.n_vertices)
    normals = np.degrees(torsion(mesh, mesh.vertex_normals))
    print(line("vertex normals", still, still, f"torsion {normals.max():.3g} deg"))
    found: list[tuple[str, SupportStructure]] = [("fixed, least mean", optimize(mesh))]
    found.append(("fixed, evened out", even_lean(mesh, found[0][1])))
    for name, support in found:
        flat = f"torsion {support.torsion_deg_max:.0e} deg, faces as they are"
        print(line(name, support.lean, still, flat))


def free(mesh: Mesh, limits: tuple[float, float]) -> TorsionFreeResult:
    """One row of the curve."""
    unit, begin = float(mesh.edge_lengths.mean()), time.process_time()
    result = torsion_free(
        mesh, max_lean=np.radians(limits[0]), max_movement=limits[1] * unit, throw=False
    )
    seconds = time.process_time() - begin
    support, angles = result.support, np.degrees(interior_angles(result.mesh))
    rest = (
        f"torsion {support.torsion_deg_max:.0e} deg, planarity "
        f"{planarity_percent(result.mesh).max():.0e} %, corners {angles.min():.0f} to "
        f"{angles.max():.0f} deg, {result.status}, {len(result.history)} steps, {seconds:.0f} s"
    )
    name = f"free, {limits[0]:g} deg, {limits[1]:g} edges"
    print(line(name, support.lean, result.movement / unit, rest), flush=True)
    return result


def held_back(result: TorsionFreeResult) -> None:
    """Which vertices lean and move most, and how far their edges were from principal directions."""
    mesh, unit = result.original, float(result.original.edge_lengths.mean())
    angles = np.degrees(torsion(mesh, mesh.vertex_normals))
    around = np.zeros(mesh.n_vertices)
    for end in mesh.edges.T:
        np.maximum.at(around, end, angles)
    for name, values in (
        ("lean [deg]", np.degrees(result.support.lean)),
        ("movement [edges]", result.movement / unit),
    ):
        order = np.argsort(-values, kind="stable")
        near = values >= 0.9 * values.max()
        rim = float(mesh.boundary_vertex[near].mean())
        worst = ", ".join(f"{v} ({values[v]:.3g})" for v in order[:WORST].tolist())
        print(
            f"  greatest {name}: {worst}; {int(near.sum())} vertices within a tenth of it, "
            f"{100 * rim:.0f} % of them on the boundary; torsion of the input's normals there "
            f"{around[near].mean():.1f} deg (all vertices {around.mean():.1f})"
        )


def main() -> None:
    """Print both curves."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    for name, curve in CURVES.items():
        mesh = read_mesh(folder / f"{name}.obj").mesh
        print(f"{name}: {mesh}; lean and movement: greatest, mean")
        fixed(mesh)
        results = [free(mesh, limits) for limits in curve]
        met = [r for r in results if r.status == "converged"]
        if met:
            held_back(min(met, key=lambda r: r.support.lean_deg_max))


if __name__ == "__main__":
    main()

"""Torsion-free axes: lean against distance from the surface, with vertices fixed and free.

Run: python benchmarks/torsion.py FOLDER, where the meshes of `CURVES` lie. Each line is one limit
of the lean: a mesh with planar faces and axes free of torsion, or what is missed. The hull is built
here: a translation net of steep arcs in planes at 50 deg to a shallow one, twisted lengthwise.
Seconds are processor time; set OMP_NUM_THREADS=1.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np

from ddgfab.grid import grid_mesh
from ddgfab.io import read_mesh
from ddgfab.measures import planarity_percent
from ddgfab.mesh import Mesh
from ddgfab.optimize import TorsionFreeResult, mean_edge, optimize
from ddgfab.support import SupportStructure, even_lean, parallel_axes, torsion_free_axes

CURVES: dict[str, tuple[float | None, ...]] = {
    "hull": (None, 20.0, 6.0),
    "botanic_garden_bubble": (None, 20.0, 8.0, 5.0),
    "heart": (None, 30.0, 16.0),
    "quad_dome": (None,),
    "conical1": (None,),
    "six_quad": (None,),
    "chebyshev_sphere": (None,),
}
"""Limits of lean for each mesh [deg]; None: those that are tried by default."""


def hull(m: int = 40, n: int = 16) -> Mesh:
    """Edges are conjugate, but far from the principal directions; normals turn by 160 deg."""
    across, along, oblique, twist = (*np.radians([160.0, 60.0, 50.0]), 0.12)
    s, t = np.linspace(-1, 1, n + 1) * across / 2, np.linspace(-1, 1, m + 1) * along / 2
    wide, long = n / across, m / along
    x = long * np.sin(t)[:, None] + wide * np.sin(s) * np.sin(oblique)
    y = wide * np.sin(s) * np.cos(oblique) + 0 * t[:, None]
    z = long * (np.cos(t)[:, None] - 1) + wide * np.cos(s)
    c, i = np.cos(twist * x / m), np.sin(twist * x / m)
    return grid_mesh(np.stack([x, c * y - i * z, i * y + c * z], axis=-1))


def line(result: TorsionFreeResult, name: str, seconds: float) -> str:
    """A row of the table."""
    support, change, edge = result.support, result.change, mean_edge(result.original)
    rise = "" if change.rise_kept is None else f"rise {100 * change.rise_kept:.0f} %, "
    return (
        f"{name:12s} lean {support.lean_deg_max:5.1f} {support.lean_deg_mean:5.1f} deg   distance "
        f"{change.distance_mean / edge:.3f} {change.distance_max / edge:.2f}   movement "
        f"{result.movement_max / edge:.2f} {result.movement_mean / edge:.2f}   {rise}creases "
        f"{np.degrees(change.crease[0]):.0f} deg, torsion {support.torsion_deg_max:.0e} deg, "
        f"planarity {planarity_percent(result.mesh).max():.0e} %, {result.status}, "
        f"{len(result.history)} steps, {seconds:.1f} s"
    )


def main() -> None:
    """Print the tables; lean, distance and movement: greatest and mean, mean and greatest."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    for name, limits in CURVES.items():
        mesh = hull() if name == "hull" else read_mesh(folder / f"{name}.obj").mesh
        print(f"{name}: {mesh}, planarity {planarity_percent(mesh).max():.2g} %")
        still = [
            ("nearest parallel mesh", SupportStructure.of(mesh, parallel_axes(mesh))),
            ("vertices fixed", torsion_free_axes(mesh, throw=False)),
        ]
        if still[1][1].torsion_free:
            still.append(("vertices fixed, evened out", even_lean(mesh, still[1][1])))
        for kind, support in still:
            print(
                f"  {kind}: lean {support.lean_deg_max:.1f} {support.lean_deg_mean:.1f} deg, "
                f"torsion {support.torsion_deg_max:.0e} deg"
            )
        for limit in limits:
            options = {} if limit is None else {"max_lean": float(np.radians(limit))}
            begin = time.process_time()
            result = optimize(mesh, "torsion-free", throw=False, **options)  # type: ignore[arg-type]
            assert isinstance(result, TorsionFreeResult)
            label = "default" if limit is None else f"to {limit:g} deg"
            print("  " + line(result, label, time.process_time() - begin), flush=True)


if __name__ == "__main__":
    main()

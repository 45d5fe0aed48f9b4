"""Tracing, fitting, the design dilemma: process seconds, best of three; directions with noise.

python benchmarks/surfaces.py

Directions are those of the fit beside those of libigl (principal_curvature, rings of 2 and 5),
where it is installed: pip install libigl.
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
from ddgfab.surfaces.nearest import nearest_points
from ddgfab.surfaces.principal import lifted, principal
from ddgfab.surfaces.sampled import interpolated
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


def cap(noise: float, side: int = 78) -> tuple[Mesh, np.ndarray, np.ndarray]:
    """Triangles of an ellipsoid cap with noise [part of its size]; exact points and directions."""
    rng = np.random.default_rng(5)
    u, v = np.meshgrid(
        np.linspace(-0.62, 0.62, side), np.linspace(-0.55, 0.55, side), indexing="ij"
    )
    surface = interpolated(
        lambda a, b: np.stack(
            [3 * np.sin(a), 2 * np.cos(a) * np.sin(b), np.cos(a) * np.cos(b)], axis=-1
        ),
        (-0.7, 0.7, -0.6, 0.6),
    )
    uv = np.stack([u, v], axis=-1).reshape(-1, 2)
    jets = surface.jets(uv)
    quads = grid_mesh((jets.x + 4 * noise * rng.normal(size=jets.x.shape)).reshape(side, side, 3))
    faces = [t for a, b, c, d in quads.faces for t in ((a, b, c), (a, c, d))]
    inside = (np.abs(uv) < [0.5, 0.44]).all(axis=1)
    first = lifted(jets, principal(jets).first)
    return (
        Mesh.build(quads.vertices, faces),
        jets.x[inside],
        np.where(inside[:, None], first, np.nan),
    )


def off(found: list[np.ndarray], exact: np.ndarray) -> str:
    """Mean and 99 % of the angles between two directions of a cross and exact ones."""
    cos = np.max([np.abs(np.einsum("nx,nx->n", exact, d)) for d in found], axis=0)
    angle = np.degrees(np.arccos(np.clip(cos, -1, 1)))
    return f"{angle.mean():5.2f} / {np.percentile(angle, 99):5.2f}"


def directions() -> None:
    """Errors of principal directions [deg], mean / 99 %."""
    try:
        import igl
    except ImportError:
        igl = None
    for noise in (0.0, 1e-4, 1e-3):
        mesh, x, first = cap(noise)
        keep = ~np.isnan(first[:, 0])
        surface = fit_mesh(mesh).surface
        jets = surface.jets(nearest_points(surface, x).uv)
        own = principal(jets)
        row = off([lifted(jets, own.first), lifted(jets, own.second)], first[keep])
        text = f"directions, noise {noise:g}: fit {row}"
        if igl is not None:
            faces = mesh.corners.reshape(-1, 3).astype(np.int64)
            for ring in (2, 5):
                got = igl.principal_curvature(mesh.vertices, faces, ring)
                text += f", libigl {ring} rings {off([d[keep] for d in got[:2]], first[keep])}"
        print(text)


if __name__ == "__main__":
    directions()
    roof = named_surface("wave-roof")
    for spacing, limit in ((1350.0, 2), (685.0, 4)):
        taken = seconds(lambda spacing=spacing: trace(roof, spacing))
        count = trace(roof, spacing).mesh.n_vertices
        print(f"trace, {count} vertices: {taken:.2f} s (limit {limit})")
    cloud = scan(6000)
    print(f"fit, {cloud.n_vertices} vertices: {seconds(lambda: fit_mesh(cloud)):.2f} s (limit 1)")
    drawn = runpy.run_path(str(EXAMPLE))["lattice"](np.radians(30))
    print(f"dilemma, {drawn.n_faces} faces: {seconds(lambda: dilemma(drawn)):.2f} s (limit 1)")

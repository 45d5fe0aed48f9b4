"""Curvature of one surface by three discrete notions, beside the smooth values: an ellipsoid."""

from __future__ import annotations

import sys

import numpy as np

from ddgfab.curvature import (
    angle_defects,
    cotangent_mean_curvature,
    mixed_vertex_areas,
    skew_curvature,
    steiner_curvatures,
    triangulate,
)
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Floats
from ddgfab.nets import best_normal, evolve_by_angles, interior_angles, vertex_normals
from ddgfab.surfaces import ellipsoid_curvatures, ellipsoid_patch


def errors(cells: int) -> dict[str, tuple[float, float]]:
    """Mean errors of H and K, relative, on a patch of curvature lines with so many cells a side."""
    u, v = np.linspace(5.0, 7.5, cells + 1), np.linspace(1.5, 3.0, cells + 1)
    patch = ellipsoid_patch(u[:, None], v[None])
    x = evolve_by_angles(patch[:, 0], patch[0], interior_angles(patch))  # exactly circular
    normals = vertex_normals(x, best_normal(x))  # by reflection in the edges
    mesh = grid_mesh(x)

    def compared(h: Floats, k: Floats, p: Floats, q: Floats) -> tuple[float, float]:
        one, two = ellipsoid_curvatures(p, q)
        smooth_h, smooth_k = 0.5 * (one + two), one * two
        sign = np.sign(np.nanmean(h))  # the grid's faces look outward or inward
        return (
            float(np.nanmean(np.abs(sign * h - smooth_h) / smooth_h)),
            float(np.nanmean(np.abs(k - smooth_k) / smooth_k)),
        )

    center = np.meshgrid(0.5 * (u[1:] + u[:-1]), 0.5 * (v[1:] + v[:-1]), indexing="ij")
    found = {}
    # Faces: the normals of a circular net are a parallel mesh, its Gauss image.
    steiner = steiner_curvatures(mesh, normals.reshape(-1, 3))
    found["Steiner"] = compared(steiner.mean, steiner.gauss, *(c.ravel() for c in center))
    # Quads, skew or not, with unit normals at their corners.
    gauss, mean = skew_curvature(x, normals)
    found["skew quads"] = compared(mean, gauss, *center)
    # Vertices of triangles: gradient of the area, and what the angles lack to a full turn.
    triangles = triangulate(mesh)
    h = cotangent_mean_curvature(triangles)
    k = np.where(
        mesh.boundary_vertex, np.nan, angle_defects(triangles) / mixed_vertex_areas(triangles)
    )
    at = np.meshgrid(u, v, indexing="ij")
    found["cotangent, angles"] = compared(h, k, at[0].ravel(), at[1].ravel())
    return found


def main() -> None:
    """Print the table: errors at two sizes, and the order of convergence."""
    coarse, fine = errors(16), errors(32)
    sys.stdout.write(
        f"{'':20}{'H, 16':>9}{'H, 32':>9}{'order':>7}{'K, 16':>9}{'K, 32':>9}{'order':>7}\n"
    )
    for name, first in coarse.items():
        second = fine[name]
        row = ""
        for a, b in zip(first, second, strict=True):
            row += f"{a:9.1e}{b:9.1e}{np.log2(a / b):7.2f}"
        sys.stdout.write(f"{name:20}{row}\n")


if __name__ == "__main__":
    main()

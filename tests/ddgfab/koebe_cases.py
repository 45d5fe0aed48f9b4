"""Polyhedra that tests of Koebe nets start from."""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull

from ddgfab.mesh import Mesh
from ddgfab.nets.koebe.solids import (
    antiprism,
    cube_cells,
    dual_solid,
    goldberg,
    pillow,
    prism,
    triangle_cells,
)


def random_hull(count: int, seed: int = 0) -> Mesh:
    """Convex hull of random points on a sphere: triangles, vertices of any degree."""
    points = np.random.default_rng(seed).normal(size=(count, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    faces = ConvexHull(points).simplices.astype(np.int64)
    out = np.linalg.det(points[faces] - points.mean(axis=0)) < 0
    faces[out] = faces[out][:, ::-1]
    return Mesh.build(points, faces)


SOLIDS = {
    "tetrahedron": triangle_cells("tetrahedron", 1),
    "cube": cube_cells(1),
    "cells": cube_cells(5),
    "octahedron": triangle_cells("octahedron", 3),
    "icosahedron": triangle_cells("icosahedron", 2),
    "goldberg": goldberg(3),
    "prism": prism(7),
    "antiprism": antiprism(5),
    "pillow": pillow(6),
    "hull": random_hull(60),
    "polyhedron": dual_solid(random_hull(80, 3)),
}

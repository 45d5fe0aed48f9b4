"""Meshes of the benchmarks of planar faces: files, and nets made here."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from ddgfab.grid import grid_mesh
from ddgfab.io import read_mesh
from ddgfab.mesh import Mesh

MESHES = Path(__file__).resolve().parents[2] / "shared" / "data" / "meshes"
FILES = (
    "heart",
    "botanic_garden_bubble",
    "chebyshev_sphere",
    "helical_minimal",
    "knet1",
    "quad_dome",
    "six_quad",
    "conical1",
)
SIZES = {"400": 20, "1,000": 32, "1,600": 40, "10,000": 100, "100,000": 316}


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


def hexagons(n: int, bends: tuple[float, float]) -> Mesh:
    """n x n hexagons of side one on a paraboloid of these bends."""
    ring = np.exp(1j * (np.pi / 3 * np.arange(6) + np.pi / 6))
    row, column = (a.ravel()[:, None] for a in np.meshgrid(*2 * [np.arange(n)], indexing="ij"))
    every = np.sqrt(3) * (row + column % 2 / 2) + 1.5j * column + ring
    flat = np.stack([every.real, every.imag], axis=-1).reshape(-1, 2)
    _, first, number = np.unique(np.round(flat, 5), axis=0, return_index=True, return_inverse=True)
    flat = flat[first] - flat[first].mean(axis=0)
    height = (np.array(bends) * flat**2).sum(axis=1)
    return Mesh.build(np.c_[flat, height], number.reshape(-1, 6))


GRIDS: dict[str, Callable[[int], Mesh]] = {
    "wavy": wavy,
    "noisy": lambda n: wavy(n, 0.05),
    "dome": dome,
    "torus": torus,
    "hexdome": lambda n: hexagons(n, (-0.01, -0.06)),
    "hexsaddle": lambda n: hexagons(n, (-0.03, 0.04)),
}


def mesh_named(name: str) -> Mesh:
    """A mesh by its name in the table: a file, or "wavy 10,000"."""
    if name.endswith(".obj"):
        return read_mesh(Path(name)).mesh
    if name in FILES:
        return read_mesh(MESHES / f"{name}.obj").mesh
    kind, size = name.split()
    return GRIDS[kind](SIZES[size])

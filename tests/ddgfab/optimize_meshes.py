"""Meshes that are far from planar nets in different ways, for the tests of optimization."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ddgfab.grid import grid_mesh
from ddgfab.mesh import Floats, Mesh


def wavy(n: int, noise: float = 0.0) -> Mesh:
    """A wavy grid of n x n quads of side one that run off the principal directions."""
    u, v = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1), indexing="ij")
    x, y = u + 0.04 * np.sin(2 * np.pi * v), v + 0.04 * np.sin(2 * np.pi * u)
    z = 0.05 * np.sin(2 * np.pi * u + 0.5) * np.cos(2 * np.pi * v) + 0.1 * u * v
    points = n * np.stack([x, y, z], axis=-1)
    points += noise * np.random.default_rng(0).normal(size=points.shape)
    return grid_mesh(points, (False, False))


def roof(nx: int, ny: int, rise: float = 1.5, waves: float = 2.0) -> Mesh:
    """A wavy roof of nx x ny quads: asymptotic and conjugate where the waves change sign."""
    x, y = np.meshgrid(np.arange(nx + 1.0), np.arange(ny + 1.0), indexing="ij")
    z = rise * np.sin(2 * np.pi * waves * x / nx + 0.5) * np.cos(2 * np.pi * y / ny)
    return grid_mesh(np.stack([x, y, z], axis=-1), (False, False))


def dome(n: int, turn: float = 0.5) -> Mesh:
    """A dome with different curvatures, its grid turned off the principal directions.

    Without symmetry: at the center of a symmetric dome two points of the surface are nearest, and
    rounding chooses.
    """
    u, v = np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, n + 1), indexing="ij")
    x = np.cos(turn) * u - np.sin(turn) * v
    y = np.sin(turn) * u + np.cos(turn) * v
    z = -0.35 * x**2 - 0.1 * y**2 + 0.02 * np.sin(3 * x) * np.cos(2 * y)
    return grid_mesh(n / 2 * np.stack([x, y, z], axis=-1), (False, False))


def torus(n: int, twist: float) -> Mesh:
    """A closed torus, its net off the principal directions."""
    u, v = np.meshgrid(*2 * [2 * np.pi * np.arange(n) / n], indexing="ij")
    a, b = u + twist * np.sin(v), v + twist * np.sin(u)
    points = np.stack(
        [(2 + np.cos(b)) * np.cos(a), (2 + np.cos(b)) * np.sin(a), np.sin(b)], axis=-1
    )
    return grid_mesh(n / 8 * points, (True, True))


def hexagons(n: int, bend: tuple[float, float] = (-0.03, -0.04)) -> Mesh:
    """n x n hexagons on a paraboloid: a bowl, or a saddle where the bends differ in sign."""
    ring = np.exp(1j * (np.pi / 3 * np.arange(6) + np.pi / 6))
    names: dict[tuple[float, float], int] = {}
    faces = []
    for i in range(n):
        for j in range(n):
            corners = np.sqrt(3) * (i + j % 2 / 2) + 1.5j * j + ring
            keys = [(round(c.real, 5), round(c.imag, 5)) for c in corners]
            faces.append([names.setdefault(key, len(names)) for key in keys])
    flat = np.array(list(names))
    flat -= flat.mean(axis=0)
    height = bend[0] * flat[:, 0] ** 2 + bend[1] * flat[:, 1] ** 2
    return Mesh.build(np.c_[flat, height], faces)


def shell_of_hexagons() -> Mesh:
    """314 hexagons on a free-form shell with a round outline: hills, hollows and saddles."""
    flat = hexagons(25, (0.0, 0.0))
    x, y, _ = flat.vertices.T
    away = np.hypot(*(flat.face_centers[:, :2] / (np.sqrt(3) * 12.5) / [1, 0.87]).T)
    kept = [face for face, far in zip(flat.faces, away, strict=True) if far < 0.8]
    used, corners = np.unique(np.array(kept), return_inverse=True)
    z = 3.5 * np.cos(x / 4.5) * np.cos(y / 7) - (x / 10) ** 2 - (y / 9) ** 2
    return Mesh.build(np.c_[x, y, z][used], corners.reshape(-1, 6))


def rotation(seed: int = 5) -> Floats:
    """A rotation of no particular axis."""
    turn = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    return np.asarray(turn * np.sign(np.linalg.det(turn)))


FLAT = 0.2
"""Default planarity [%]."""

ANY_ZIGZAG = {"zigzag_limit": np.pi}
"""For what is said of meshes that are crumpled: 180 deg."""

CASES: dict[str, tuple[Callable[[], Mesh], float, float, dict[str, Any]]] = {
    "wavy": (lambda: wavy(16), 0.14, 0.8, ANY_ZIGZAG),
    "dome": (lambda: dome(16), 0.03, 0.95, {}),
    "torus": (lambda: torus(24, 0.2), 0.04, 0.98, {}),
    "bowl of hexagons": (lambda: hexagons(9), 0.02, 0.97, {}),
    "saddle of hexagons": (lambda: hexagons(9, (0.05, -0.05)), 0.15, 0.9, ANY_ZIGZAG),
}
"""Mesh, greatest mean distance [mean edges], least rise kept, limits."""

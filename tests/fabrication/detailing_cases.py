"""Small meshes with node axes that the detailing tests share (no tests here)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ddgfab.mesh import Floats, Mesh, unit
from fabrication.gridshell.detailing.gridshell import Gridshell, detail
from fabrication.gridshell.load import make_project


@dataclass(frozen=True)
class Case:
    """The least that `detail` needs of a support structure."""

    mesh: Mesh
    axes: Floats

    def detail(self, **sections: dict[str, object]) -> Gridshell:
        return detail(self.mesh, self, make_project(sections))


def grid(m: int, n: int, side: float = 1500.0, without: tuple[int, ...] = ()) -> Mesh:
    """Flat m x n squares in z = 0; faces in `without` are left out (holes)."""
    x, y = np.meshgrid(np.arange(m + 1) * side, np.arange(n + 1) * side, indexing="ij")
    vertices = np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3)
    i = np.arange((m + 1) * (n + 1)).reshape(m + 1, n + 1)
    faces = np.stack([i[:-1, :-1], i[1:, :-1], i[1:, 1:], i[:-1, 1:]], axis=-1).reshape(-1, 4)
    return Mesh.build(vertices, [f for k, f in enumerate(faces) if k not in without])


def vertical(mesh: Mesh) -> Case:
    return Case(mesh, np.tile([0.0, 0.0, 1.0], (mesh.n_vertices, 1)))


def central(mesh: Mesh, center: tuple[float, float, float]) -> Case:
    """Axes through one center: torsion-free on every mesh (Prop. 5.2)."""
    return Case(mesh, unit(mesh.vertices - np.array(center)))


def fan(count: int, closed: bool, drop: float = 200.0, side: float = 1500.0) -> Case:
    """`count` triangles round an apex; a closed fan's apex has that valence."""
    rim = count if closed else count + 1
    angle = 2 * np.pi * np.arange(rim) / (count if closed else count + 2)
    ring = np.stack([side * np.cos(angle), side * np.sin(angle), np.full(rim, -drop)], axis=-1)
    faces = [[0, 1 + k, 1 + (k + 1) % rim] for k in range(count)]
    return central(Mesh.build(np.vstack([[0.0, 0.0, 0.0], ring]), faces), (0.0, 0.0, -6000.0))


def hexagons() -> Case:
    """Seven hexagons, lifted onto a paraboloid (skew faces), axes through a center: valence 3."""
    centers = [(0.0, 0.0)] + [
        (3**0.5 * np.cos(a), 3**0.5 * np.sin(a)) for a in np.pi / 6 + np.arange(6) * np.pi / 3
    ]
    points: list[tuple[float, float]] = []
    faces = []
    for cx, cy in centers:
        face = []
        for a in np.arange(6) * np.pi / 3:
            p = (round(cx + np.cos(a), 6), round(cy + np.sin(a), 6))
            if p not in points:
                points.append(p)
            face.append(points.index(p))
        faces.append(face)
    flat = 1000.0 * np.array(points)
    height = -(flat**2).sum(axis=1, keepdims=True) / 40000.0
    return central(Mesh.build(np.hstack([flat, height]), faces), (0.0, 0.0, -20000.0))


def dome(m: int = 6, n: int = 5) -> Case:
    """Planar quads of a translational surface with axes through a center below it."""
    flat = grid(m, n)
    v = flat.vertices - flat.vertices.mean(axis=0)
    v[:, 2] = -(v[:, 0] ** 2) / 30000.0 - v[:, 1] ** 2 / 22000.0
    return central(flat.with_vertices(v), (300.0, -200.0, -14000.0))


def placed(placement: Floats, points: Floats) -> Floats:
    """Points (n, 3) of a part's frame in the world."""
    return points @ placement[:3, :3].T + placement[:3, 3]

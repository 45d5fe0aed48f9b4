"""A roof, and mesh files of it, that tests of the readers write in many ways."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ddgfab.grid import grid_mesh
from ddgfab.io import (
    ReadResult,
    read_mesh,
)
from ddgfab.mesh import Floats, Mesh

GRID = (4, 3)


def roof() -> Mesh:
    x, y = np.meshgrid(np.arange(5.0), np.arange(4.0), indexing="ij")
    moves = np.random.default_rng(2).uniform(-0.03, 0.03, (20, 3))  # so that all digits are used
    height = 0.3 - 0.05 * ((x - 2.1) ** 2 + (y - 1.3) ** 2)
    mesh = grid_mesh(np.stack([1.37 * x, 1.51 * y, height], axis=-1))
    return mesh.with_vertices(mesh.vertices + moves)


def obj(points: Floats, faces: list[list[int]], form: str = "{:.17g}") -> str:
    rows = ["v " + " ".join(form.format(c) for c in p) for p in points.tolist()]
    return "\n".join([*rows, *("f " + " ".join(str(i + 1) for i in f) for f in faces)]) + "\n"


def lists(mesh: Mesh) -> list[list[int]]:
    return [face.tolist() for face in mesh.faces]


def read(path: Path, content: str | bytes, **ways: object) -> ReadResult:
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_mesh(path, **ways)  # type: ignore[arg-type]


def is_roof(found: Mesh, scale: float = 1.0, digits: float = 1e-9) -> bool:
    """The same quads at the same places, in any order."""
    mesh = roof()
    if (found.n_vertices, found.n_edges) != (mesh.n_vertices, mesh.n_edges):
        return False
    if set(found.face_sizes.tolist()) != {4}:
        return False
    gaps = np.linalg.norm(found.vertices[:, None] / scale - mesh.vertices[None], axis=2)
    name = gaps.argmin(axis=1)
    same = {frozenset(name[f].tolist()) for f in found.faces}
    return bool(gaps.min(axis=1).max() < digits) and same == {frozenset(f) for f in lists(mesh)}


def compas(version: int, mesh: Mesh, first: int) -> dict[str, object]:
    points = {str(first + i): dict(zip("xyz", p, strict=True)) for i, p in
              enumerate(mesh.vertices.tolist())}  # fmt: skip
    faces = {str(7 * i): [first + v for v in f] for i, f in enumerate(lists(mesh))}
    if version == 1:
        value = {
            "vertex": points,
            "face": faces,
            "dva": {"x": 0.0},
            "edgedata": {},
            "max_vertex": 99,
        }
        return {"dtype": "compas.datastructures/Mesh", "value": value, "guid": "1"}
    data = {"vertex": points, "face": {k: [str(v) for v in f] for k, f in faces.items()},
            "default_vertex_attributes": {"x": 0.0, "z": 0.0}, "facedata": {}}  # fmt: skip
    return {"dtype": "compas.datastructures/Mesh", "data": data, "name": "Mesh"}

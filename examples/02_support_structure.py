"""Torsion-free node axes on a mesh of your own, given as arrays: what they cost is lean."""

from __future__ import annotations

import sys

import numpy as np

from ddgfab.errors import SupportError
from ddgfab.grid import grid_mesh
from ddgfab.measures import torsion
from ddgfab.mesh import Mesh
from ddgfab.support import support_structure


def main() -> None:
    """A wavy roof with skew faces gets axes by optimisation; as triangles only central ones."""
    x, y = np.meshgrid(np.linspace(0, 24e3, 17), np.linspace(0, 15e3, 11), indexing="ij")
    height = 3000 * np.sin(x / 24e3 * np.pi) * np.sin(y / 15e3 * np.pi) + 0.04 * x + 0.02 * y
    roof = grid_mesh(np.stack([x, y, height], axis=-1))
    structure = support_structure(roof)
    before = np.degrees(torsion(roof, roof.vertex_normals).max())
    sys.stdout.write(f"{structure}\ntorsion of the vertex normals was {before:.2f} deg\n")
    for vertex in structure.worst_vertices(3):
        sys.stdout.write(f"  vertex {vertex} leans {np.degrees(structure.lean[vertex]):.1f} deg\n")

    # Cut into triangles the same roof has only axes through one center (Prop. 5.2).
    corners = np.stack(roof.faces)
    triangles = Mesh.build(roof.vertices, np.concatenate([corners[:, :3], corners[:, [0, 2, 3]]]))
    try:
        support_structure(triangles)
    except SupportError as error:
        sys.stdout.write(f"as triangles: {error}\n{support_structure(triangles, 'central')}\n")


if __name__ == "__main__":
    main()

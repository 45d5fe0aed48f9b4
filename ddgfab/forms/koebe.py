"""Ball-shaped gridshells: Koebe polyhedra, all of whose beams have one height."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Final

import numpy as np

from ddgfab.errors import InputError
from ddgfab.forms.generators import About, ParameterError, generator
from ddgfab.io.cells import read_cells
from ddgfab.mesh import Mesh
from ddgfab.nets.koebe.polyhedron import KoebePolyhedron, koebe
from ddgfab.nets.koebe.solids import antiprism, cube_cells, goldberg, prism, triangle_cells
from ddgfab.nets.sisothermic_labels import piece

SHAPES: Final[dict[str, Callable[[int], Mesh]]] = {
    "cube": cube_cells,
    "goldberg": goldberg,
    "octahedron": lambda cells: triangle_cells("octahedron", cells),
    "icosahedron": lambda cells: triangle_cells("icosahedron", cells),
    "prism": prism,
    "antiprism": antiprism,
}
"""Polyhedra by name, and how they follow from a number."""


def koebe_solid(shape: str, cells: int, file: str = "") -> KoebePolyhedron:
    """The Koebe polyhedron of a named shape or of an OBJ file, turned towards its vertices."""
    if file:
        rough = read_cells(file).mesh
    elif shape not in SHAPES:
        raise InputError(f'shape "{shape}": one of {", ".join(SHAPES)}, or a file')
    else:
        rough = SHAPES[shape](cells)
    return koebe(rough).aligned(rough.vertices - rough.vertices.mean(axis=0))


@generator("koebe", support="edge")
def koebe_ball(
    shape: Annotated[
        str, About("combinatorics of the panels", choices=(*SHAPES, "file"))
    ] = "goldberg",
    cells: Annotated[
        int, About("cells on an edge of the shape; sides of a prism or antiprism", 1, 100)
    ] = 4,
    radius_mm: Annotated[float, About("radius of the sphere that all edges touch", 1e-3)] = 7000.0,
    base: Annotated[
        float,
        About("panels whose middle is below base x radius are left out; -1: none", -1, 0.95),
    ] = -1.0,
    polyhedron_file: Annotated[
        str, About('with shape = "file": OBJ of any convex polyhedron, by its faces', file=True)
    ] = "",
) -> Mesh:
    """Ball or dome whose edges touch a sphere: a Koebe polyhedron, beams of one height.

    Panels are planar with incircles that touch each other, node axes run through the center.

    Raises
    ------
    ParameterError
        A parameter of the wrong type or beyond its limits, or a file without shape = "file".
    MeshError
        A file whose faces are not those of a polyhedron; names the cut pair or the handle.

    Source: `koebe`; mathematics.md 7.1.
    """
    if (shape == "file") != bool(polyhedron_file):
        raise ParameterError(
            'polyhedron_file = "..." and shape = "file" go together', "polyhedron_file"
        )
    if shape in ("prism", "antiprism") and cells < 3:
        raise ParameterError(f"cells = {cells}: a {shape} has 3 sides or more", "cells")
    mesh = koebe_solid(shape, cells, polyhedron_file).mesh
    keep = mesh.face_centers[:, 2] >= base
    if base > -1.0 and not keep.all():
        if not keep.any():
            raise ParameterError(f"base = {base:g} leaves no panel", "base")
        mesh = piece(mesh, np.flatnonzero(keep)).mesh
    points = mesh.vertices * radius_mm
    points[:, 2] -= points[:, 2].min()
    return mesh.with_vertices(points)

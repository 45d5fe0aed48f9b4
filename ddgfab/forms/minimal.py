"""Gridshells on discrete minimal surfaces, all of whose beams have one height."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from ddgfab.errors import InputError
from ddgfab.forms.generators import About, ParameterError, generator
from ddgfab.forms.placing import grounded
from ddgfab.io.cells import read_cells
from ddgfab.mesh import Mesh
from ddgfab.nets.koebe.polyhedron import koebe
from ddgfab.nets.minimal.net import MinimalNet, catenoid, enneper, helicoid, minimal_surface
from ddgfab.nets.minimal.periodic import scherk, schwarz_d, schwarz_p, schwarz_p_cell

SURFACES = (
    "catenoid",
    "enneper",
    "scherk",
    "schwarz_p",
    "schwarz_p_cell",
    "helicoid",
    "schwarz_d",
    "file",
)
"""Minimal surfaces by name; helicoid and schwarz_d follow asymptotic lines and have skew panels."""


def from_cells(file: str, name: str, sheets: int = 1) -> MinimalNet:
    """The minimal surface of a cell decomposition of the sphere, over the faces that a name marks.

    Parameters
    ----------
    file : OBJ; its faces are those of a convex polyhedron, wherever its vertices lie
    name : of a group, object or material that marks the piece to dualise
    sheets : 2 for the branched double cover of the piece, which odd faces and inner vertices need

    Raises
    ------
    MeshError
        Not a polyhedron (names the cut pair, the boundary, ...), no such name, or a piece in which
        the signs of the edges cannot alternate (names the faces).
    DegenerateError
        A piece round a hole whose dual does not close.
    InputError
        Two sheets for a piece that needs one.

    Source: mathematics.md 7.5, 7.6.
    """
    cells = read_cells(file)
    marked = cells.group(name)
    rough = cells.mesh.vertices - cells.mesh.vertices.mean(axis=0)
    gauss = koebe(cells.mesh).aligned(rough).net(marked)
    if sheets == 1:
        return minimal_surface(gauss)
    cover = gauss.covered()
    if cover.mesh.components.max() > gauss.mesh.components.max():
        raise InputError(f'the piece "{name}" needs no double cover: take sheets = 1', file=file)
    return minimal_surface(cover)


@generator("minimal", support="edge")
def minimal_roof(
    surface: Annotated[str, About("which minimal surface", choices=SURFACES)] = "catenoid",
    panel_mm: Annotated[float, About("median length of the edges", 1e-3)] = 1500.0,
    panels_around: Annotated[int, About("catenoid, helicoid: panels in a full turn", 3, 1000)] = 24,
    rings_below: Annotated[int, About("catenoid, helicoid: rings below the waist", 0, 200)] = 3,
    rings_above: Annotated[int, About("catenoid, helicoid: rings above the waist", 0, 200)] = 3,
    columns: Annotated[
        int, About("catenoid, helicoid: panels round a net cut open; 0: closed", 0, 4000)
    ] = 0,
    cells: Annotated[
        int, About("enneper, scherk, schwarz: cells on a side of the piece", 1, 100)
    ] = 8,
    reach: Annotated[
        float,
        About("enneper: how far it turns over; 1: vertical in the middle of its sides", 0.01, 3),
    ] = 0.6,
    storeys: Annotated[int, About("scherk: storeys of the tower", 1, 50)] = 1,
    polyhedron_file: Annotated[
        str,
        About('with surface = "file": OBJ of a cell decomposition of the sphere', file=True),
    ] = "",
    piece: Annotated[
        str, About("file: group, object or material that marks the faces of the piece")
    ] = "piece",
    sheets: Annotated[
        int, About("file: 2 for the double cover of a piece with odd faces or inner vertices", 1, 2)
    ] = 1,
) -> Mesh:
    """Minimal surface along its curvature lines, with an edge offset: beams of one height.

    The dual of a Koebe net: planar panels with incircles that touch each other. Helicoid and
    schwarz_d, conjugates, follow asymptotic lines: their panels are skew, they have no edge offset.

    Raises
    ------
    ParameterError
        A parameter of the wrong type or beyond its limits, or one that the surface needs.
    DegenerateError
        Enneper with circles too large for the sphere.
    MeshError
        A file that cannot be used; see `from_cells`.

    Source: `ddgfab.nets.minimal`; Bobenko, Hoffmann, Springborn 2006; mathematics.md 7.6.
    """
    if (surface == "file") != bool(polyhedron_file):
        raise ParameterError(
            'polyhedron_file = "..." and surface = "file" go together', "polyhedron_file"
        )
    rings = (-rings_below, rings_above)
    if surface in ("catenoid", "helicoid") and rings_below + rings_above < 1:
        raise ParameterError("rings_below and rings_above are both 0: one is needed", "rings_above")
    least = {"scherk": 3, "schwarz_p_cell": 2}.get(surface, 1)
    if cells < least:
        raise ParameterError(f"cells = {cells}: {surface} needs {least} or more", "cells")
    if surface == "catenoid":
        net = catenoid(panels_around, rings, columns or None)
    elif surface == "helicoid":
        net = helicoid(panels_around, rings, columns or panels_around)
    elif surface == "enneper":
        net = enneper((cells, cells), reach / cells)
    elif surface == "scherk":
        net = scherk(cells, storeys)
    elif surface == "file":
        net = from_cells(polyhedron_file, piece, sheets)
    elif surface == "schwarz_p_cell":
        net = schwarz_p_cell(cells).net
    else:
        net = schwarz_p(cells) if surface == "schwarz_p" else schwarz_d(cells)
    return _upright(net.mesh.scaled(panel_mm / float(np.median(net.mesh.edge_lengths))))


def _upright(mesh: Mesh) -> Mesh:
    """The mesh on the ground, with normals up where most of its area has such a side."""
    placed = mesh.with_vertices(grounded(mesh.vertices))
    if placed.vector_areas[:, 2].sum() >= 0:
        return placed
    return Mesh.build(placed.vertices, [face[::-1] for face in placed.faces])

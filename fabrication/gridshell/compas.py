"""COMPAS JSON: the net with what stands on its vertices, edges and faces.

`compas.json_load("net.json")` gives a `compas.datastructures.Mesh` (version 2); the node axes and
the marks and numbers of nodes, beams and panels are its attributes.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final
from uuid import NAMESPACE_URL, uuid5

import numpy as np

from ddgfab.errors import InputError
from ddgfab.io import read_mesh
from fabrication.formats.base import Contents, Format, Whole
from fabrication.specs import Check

if TYPE_CHECKING:
    from fabrication.gridshell.design import Design

NET: Final = "net.json"
"""Name of the file."""

_SPACE: Final = uuid5(NAMESPACE_URL, "ddgfab/compas")


class Compas(Format):
    """COMPAS JSON: net.json.

    Parameters
    ----------
    design : whose net is written
    """

    name = "compas"
    suffixes = (".json",)

    def __init__(self, design: Design) -> None:
        self.design = design

    def whole_files(self, contents: Contents) -> list[str]:
        """net.json."""
        return [NET]

    def write_whole(self, folder: Path, whole: Whole) -> list[str]:
        """The net; lengths in millimeters, about the origin that its attributes name."""
        text = json.dumps(record(self.design, whole), ensure_ascii=False)
        (folder / NET).write_text(text + "\n", "utf-8")
        return []

    def check_whole(self, folder: Path, whole: Whole) -> list[Check]:
        """Read back as a mesh: the same vertices and faces."""
        mesh = self.design.mesh
        try:
            found = read_mesh(folder / NET).mesh
        except InputError as error:
            return [Check("compas readable", False, str(error))]
        same = found.n_vertices == mesh.n_vertices and np.array_equal(found.corners, mesh.corners)
        away = float(np.abs(found.vertices - mesh.vertices).max()) if same else None
        return [
            Check("compas readable", True),
            Check("compas net", same),
            Check("compas positions_mm", away == 0.0, away, 0.0),
        ]


def record(design: Design, whole: Whole) -> dict[str, Any]:
    """The mesh as `compas.data` has it: `Mesh.__data__` of version 2."""
    mesh, grid = design.mesh, design.gridshell
    number_of = {
        instance.mark: family.number for family in whole.families for instance in family.instances
    }

    def about(piece: Any) -> dict[str, Any]:
        mark = piece.mark
        status = "rejected" if mark in whole.failed else "ok"
        number = number_of.get(mark)
        return {"mark": mark, "number": number, "role": piece.kind.role, "status": status}

    vertices: dict[str, dict[str, Any]] = {
        str(k): {"x": x, "y": y, "z": z} for k, (x, y, z) in enumerate(mesh.vertices.tolist())
    }
    for node in grid.nodes:
        vertices[str(node.vertex)] |= {**about(node), "axis": node.axis.tolist()}
    faces: dict[str, dict[str, Any]] = {str(k): {} for k in range(mesh.n_faces)}
    for panel in grid.panels:
        faces[str(panel.face)] = about(panel)
    edges: dict[str, Mapping[str, Any]] = {}
    for beam in grid.beams:
        # COMPAS names an edge by its sorted vertices.
        edges[str(tuple(sorted(int(v) for v in mesh.edges[beam.edge])))] = about(beam)
    name = whole.about.project
    origin = list(whole.about.origin)
    return {
        "dtype": "compas.datastructures/Mesh",
        "data": {
            "attributes": {"name": name, "units": "mm", "origin_mm": origin},
            "default_vertex_attributes": {"x": 0.0, "y": 0.0, "z": 0.0},
            "default_edge_attributes": {},
            "default_face_attributes": {},
            "vertex": vertices,
            "face": {str(k): face.tolist() for k, face in enumerate(mesh.faces)},
            "facedata": faces,
            "edgedata": edges,
            "max_vertex": mesh.n_vertices - 1,
            "max_face": mesh.n_faces - 1,
        },
        "inheritance": [],
        "name": name,
        "guid": str(uuid5(_SPACE, name)),
    }

"""COMPAS JSON: the meshes of a file, alone or inside lists, scenes and sessions."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import numpy as np

from ddgfab.errors import MeshError
from ddgfab.io.raw import RawMesh, check_count
from ddgfab.io.tokens import clip, decode
from ddgfab.mesh import Floats

LIMIT_JSON = 32 * 1024 * 1024
"""Larger JSON is refused [bytes]; as objects it takes some 25 times as much memory."""

DEPTH = 60
"""Containers are looked into to this depth."""


def parse_compas(data: bytes, file: str) -> RawMesh:
    """The mesh of a COMPAS JSON file, versions 1 and 2 of the library.

    A mesh is a record with vertices (or `vertex`) and faces (or `face`), under `value` or `data`
    (`state` in sessions) of an object whose `dtype` names a mesh. Where a file holds several, the
    first is read, with a note.

    Raises
    ------
    MeshError
        No JSON, no mesh in it, or a mesh whose faces name vertices that do not exist.

    Source: COMPAS, `compas.datastructures.Mesh`, `__data__` (versions 1.17 and 2.x).
    """
    if len(data) > LIMIT_JSON:
        raise MeshError(
            f"has {len(data)} bytes; JSON is read up to {LIMIT_JSON}: export OBJ or PLY", file=file
        )
    try:
        root = json.loads(decode(data, file))
    except json.JSONDecodeError as error:
        raise MeshError(f"is not JSON: {error.msg}", file=file, line=error.lineno) from None
    except (RecursionError, ValueError) as error:
        raise MeshError(
            f"is not JSON that can be read: {clip(str(error), 80)}", file=file
        ) from None
    found = list(_meshes(root, 0))
    if not found:
        raise MeshError(
            "holds no mesh of COMPAS (an object with vertices and faces)\n"
            "write one with compas.json_dump(mesh, file)",
            file=file,
        )
    record = found[0]
    notes = []
    if len(found) > 1:
        notes.append(f"the file holds {len(found)} meshes: the first is read")
    for what in ("vertices", "faces"):
        table = record.get({"vertices": "vertex", "faces": "face"}[what], record.get(what))
        check_count(len(table or ()), what, file)
    ids, points = _vertices(record, file)
    rank = {name: i for i, name in enumerate(ids)}
    corners: list[int] = []
    sizes = []
    for name, face in _items(record["face"] if "face" in record else record["faces"]):
        loop = face.get("vertices") if isinstance(face, dict) else face
        if not isinstance(loop, list):
            raise MeshError(f"face {clip(name)} is not a list of vertices", file=file)
        for vertex in loop:
            if str(vertex) not in rank:
                raise MeshError(
                    f"face {clip(name)} names vertex {clip(str(vertex))}, which is not there",
                    file=file,
                )
        sizes.append(len(loop))
        corners += [rank[str(vertex)] for vertex in loop]
    return RawMesh(
        file,
        points,
        np.array(corners, dtype=np.int64),
        np.array(sizes, dtype=np.int64),
        None,
        None,
        notes,
    )


def _meshes(node: Any, depth: int) -> Iterator[dict[str, Any]]:
    """Records of meshes in a tree of lists and dictionaries, in the file's order."""
    if depth > DEPTH:
        return
    if isinstance(node, dict):
        faces = node.get("face", node.get("faces"))
        points = node.get("vertex", node.get("vertices"))
        if isinstance(faces, dict | list) and isinstance(points, dict | list) and len(points):
            yield node
            return
        for child in node.values():
            yield from _meshes(child, depth + 1)
    elif isinstance(node, list):
        for child in node:
            if isinstance(child, dict | list):
                yield from _meshes(child, depth + 1)


def _items(table: Any) -> list[tuple[str, Any]]:
    if isinstance(table, dict):
        return list(table.items())
    return [(str(i), row) for i, row in enumerate(table)]


def _vertices(record: dict[str, Any], file: str) -> tuple[list[str], Floats]:
    """Names and coordinates; an attribute that a vertex lacks has the mesh's default."""
    base = record.get("default_vertex_attributes") or record.get("dva")
    base = base if isinstance(base, dict) else {}
    names, points = [], []
    for name, row in _items(record["vertex"] if "vertex" in record else record["vertices"]):
        values = [{**base, **row}.get(k, 0.0) for k in "xyz"] if isinstance(row, dict) else row
        try:
            x, y, z = (float(value) for value in values)
        except (TypeError, ValueError, OverflowError):
            raise MeshError(
                f"vertex {clip(name)} has no three numbers as coordinates", file=file
            ) from None
        names.append(name)
        points.append((x, y, z))
    return names, np.array(points, dtype=np.float64).reshape(-1, 3)

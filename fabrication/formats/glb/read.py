"""GLB back to triangle meshes [mm]: positions, indices and the nodes that place them."""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from ddgfab.errors import InputError, clipped
from ddgfab.io.regular import read_regular
from ddgfab.mesh import Floats
from fabrication.formats.stl import weld
from fabrication.specs import Placement, TriangleMesh

_Z_UP: Final = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # glTF's axes (y up) to ours
_MILLIMETERS: Final = 1000.0
_TYPES: Final = {5121: "<u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_TRIANGLES: Final = 4

LIMIT_BYTES: Final = 256 * 1024 * 1024
"""Larger files are refused."""

FARTHEST: Final = 1e15
"""Greatest entry of a placement [1 and mm]; beyond, volumes may overflow."""

_UNREADABLE: Final = (
    *(struct.error, ValueError, KeyError, IndexError, TypeError, AttributeError),
    *(RecursionError, OverflowError, FloatingPointError),
)
"""What values of wrong types in the file's JSON come to."""


@dataclass(frozen=True, eq=False)
class GlbNode:
    """A node with a mesh: its name, the mesh [mm], where it stands."""

    name: str
    mesh: TriangleMesh
    placement: Placement

    def vertices(self) -> Floats:
        """(n, 3) vertices [mm] where they stand."""
        placed: Floats = self.mesh.vertices @ self.placement[:3, :3].T + self.placement[:3, 3]
        return placed


@dataclass(frozen=True, eq=False)
class ContentGLB:
    """Meshes of a GLB with their names, z up; and the pieces that its nodes make of them."""

    meshes: tuple[tuple[str, TriangleMesh], ...]
    pieces: tuple[GlbNode, ...]


def read_glb(path: Path) -> ContentGLB:
    """The triangle meshes of a GLB (glTF 2.0, chapters 3 and 4), and its nodes that show them.

    Raises
    ------
    InputError
        Missing, no GLB, or truncated; or it holds what is not read: other primitives than indexed
        triangles, compressed, sparse or external data.
    """
    data = read_regular(path, LIMIT_BYTES, InputError, what="a GLB file", advice="split the model")
    try:
        magic, version, total = struct.unpack_from("<4sII", data)
        if magic != b"glTF" or version != 2 or total != len(data):
            raise InputError("not a GLB of glTF 2.0, or truncated", file=str(path))
        size = struct.unpack_from("<I", data, 12)[0]
        document = json.loads(data[20 : 20 + size])
        binary = data[28 + size :]
        meshes = [
            (str(mesh.get("name", "")), _mesh(document, binary, mesh))
            for mesh in document.get("meshes", ())
        ]
        scene = _item(document, "scenes", document.get("scene", 0))
        pieces = _pieces(document, [mesh for _, mesh in meshes], scene)
    except InputError:
        raise
    except _UNREADABLE as error:
        raise InputError(f"not a readable GLB ({clipped(repr(error))})", file=str(path)) from error
    return ContentGLB(tuple(meshes), tuple(pieces))


def _mesh(document: dict[str, Any], binary: bytes, mesh: dict[str, Any]) -> TriangleMesh:
    """All primitives of a mesh as one, corners of equal coordinates welded."""
    corners = []
    for primitive in mesh["primitives"]:
        if primitive.get("mode", _TRIANGLES) != _TRIANGLES or primitive.get("extensions"):
            raise ValueError("only plain triangles are read")
        points = _array(document, binary, primitive["attributes"]["POSITION"], 3)
        order = _array(document, binary, primitive["indices"], 1).ravel().astype(np.int64)
        corners.append(points[order].reshape(-1, 3, 3))
    metric = np.concatenate(corners).astype(np.float64) @ _Z_UP.T * _MILLIMETERS
    if not np.isfinite(metric).all():
        raise ValueError("a coordinate is not finite")
    return weld(metric)


def _item(document: dict[str, Any], table: str, index: Any) -> Any:
    """An entry of a table by its number, which is none from the end."""
    if not isinstance(index, int) or index < 0:
        raise ValueError(f"{clipped(index)} is not a number of {table}")
    return document[table][index]


def _array(document: dict[str, Any], binary: bytes, index: int, width: int) -> Any:
    """(n, width) values of an accessor."""
    accessor = _item(document, "accessors", index)
    view = _item(document, "bufferViews", accessor["bufferView"])
    if "sparse" in accessor or _item(document, "buffers", view["buffer"]).get("uri"):
        raise ValueError("sparse or external data are not read")
    kind = np.dtype(_TYPES[accessor["componentType"]])
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    stride = view.get("byteStride", width * kind.itemsize)
    if stride < width * kind.itemsize or start < 0 or (width == 1) == (kind.kind == "f"):
        raise ValueError("values overlap, or are of the wrong kind")
    array: Any = np.ndarray(
        (accessor["count"], width), kind, binary, start, (stride, kind.itemsize)
    )
    return array


def _pieces(
    document: dict[str, Any], meshes: list[TriangleMesh], scene: dict[str, Any]
) -> list[GlbNode]:
    """The nodes of a scene that show a mesh, each node in one place (glTF 2.0, 3.5.1)."""
    pieces, seen = [], set[int]()
    left = [(index, np.eye(4)) for index in reversed(scene["nodes"])]
    while left:
        index, above = left.pop()
        node = _item(document, "nodes", index)
        if index in seen:
            raise ValueError(f"node {index} stands in two places")
        seen.add(index)
        with np.errstate(over="ignore", invalid="ignore"):
            at = above @ _motion(node)
        if not (np.abs(at) <= FARTHEST).all():
            raise ValueError(f"node {index} is placed beyond {FARTHEST:g} mm")
        if "mesh" in node:
            if not 0 <= node["mesh"] < len(meshes):
                raise ValueError(f"node {index} shows a mesh that is not there")
            pieces.append(GlbNode(str(node.get("name", "")), meshes[node["mesh"]], at))
        left += [(child, at) for child in reversed(node.get("children", ()))]
    return pieces


def _motion(node: dict[str, Any]) -> Placement:
    """A node's own placement in our axes and millimeters (glTF 2.0, 3.5.2)."""
    own = np.array(node.get("matrix", np.eye(4).T.ravel()), dtype=np.float64).reshape(4, 4).T
    if "matrix" not in node:
        x, y, z, w = np.array(node.get("rotation", (0, 0, 0, 1)), dtype=np.float64)
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        turn = np.eye(3) + 2 * w * cross + 2 * cross @ cross
        own[:3, :3] = turn * np.array(node.get("scale", (1, 1, 1)), dtype=np.float64)
        own[:3, 3] = node.get("translation", (0, 0, 0))
    motion = np.eye(4)
    motion[:3, :3] = _Z_UP @ own[:3, :3] @ _Z_UP.T
    motion[:3, 3] = _Z_UP @ own[:3, 3] * _MILLIMETERS
    return motion

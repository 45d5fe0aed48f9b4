"""GLB (glTF 2.0 binary): metres, y up, one mesh a part number, one named node an instance."""

from __future__ import annotations

import json
import struct
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from ddgfab.errors import InputError
from ddgfab.io.atomic import atomic_write
from ddgfab.mesh import Floats
from fabrication.formats.base import FAILED, FAILED_COLOR, Contents, Format, Whole
from fabrication.formats.glb.read import read_glb
from fabrication.formats.solids import SolidsReport, mesh_report
from fabrication.specs import Check, Color, Family, Finish, Kind, Placement, TriangleMesh
from fabrication.version import originating_system

GLASS_ALPHA: Final = 0.35
"""Opacity of what is made of glass."""

MODEL: Final = "model.glb"
"""Name of the file of the whole."""

_METRE: Final = 0.001
_Y_UP: Final = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])  # ours (z up) to glTF's (y up)
_FLOAT, _UINT32 = 5126, 5125
_ARRAY_BUFFER, _ELEMENT_ARRAY_BUFFER = 34962, 34963


class Glb(Format):
    """GLB: the whole as colored meshes, pieces that failed in red."""

    name = "glb"
    suffixes = (".glb",)
    by_default = "always"

    def whole_files(self, contents: Contents) -> list[str]:
        """model.glb."""
        return [MODEL]

    def write_whole(self, folder: Path, whole: Whole) -> list[str]:
        """model.glb; see `glb_bytes`."""
        meshes = {number: part.mesh for number, part in whole.parts.items()}
        (folder / MODEL).write_bytes(glb_bytes(whole.shown, meshes, whole.failed))
        return []

    def check_whole(self, folder: Path, whole: Whole) -> list[Check]:
        """Read back: every piece once, under its mark, its bounds where it was placed."""
        try:
            content = read_glb(folder / MODEL)
        except InputError as error:
            return [Check("glb readable", False, str(error))]
        marks = [i.mark for family in whole.shown for i in family.instances]
        found = {piece.name: piece for piece in content.pieces}
        away = limit = 0.0
        for family in whole.shown:
            points = whole.parts[family.number].mesh.vertices
            for instance in family.instances:
                at = instance.placement
                exact = points @ at[:3, :3].T + at[:3, 3]
                if instance.mark in found:
                    back = found[instance.mark].vertices()
                    bounds = [
                        np.ptp([b.min(axis=0), e.min(axis=0)], axis=0).max()
                        for b, e in ((back, exact), (-back, -exact))
                    ]
                    away = max(away, *map(float, bounds))
                limit = max(limit, SINGLE_ROUNDING * float(np.abs(points).max()))
        return [
            Check("glb readable", True),
            Check(
                "glb pieces",
                sorted(p.name for p in content.pieces) == sorted(marks),
                float(len(content.pieces)),
                float(len(marks)),
            ),
            Check("glb positions_mm", away <= limit, away, limit),
        ]

    def inspect(self, path: Path) -> SolidsReport:
        """Its meshes, corners of equal coordinates welded, and what they share where they stand."""
        content = read_glb(path)
        place = {id(mesh): k for k, (_, mesh) in enumerate(content.meshes)}
        standing = [(place[id(p.mesh)], p.name, p.placement) for p in content.pieces]
        used = Counter(k for k, _, _ in standing)
        meshes = [(name, used[k], mesh) for k, (name, mesh) in enumerate(content.meshes)]
        return mesh_report(path, "GLB", "meter", meshes, standing)


FORMAT: Final = Glb()

SINGLE_ROUNDING: Final = 4 * 2.0**-23
"""How far a coordinate of a placed part may be rounded (single precision), relative to its size."""


def glb_bytes(
    families: Sequence[Family],
    meshes: Mapping[str, TriangleMesh],
    failed: Collection[str] = (),
    *,
    name: str = "model",
) -> bytes:
    """The model as GLB. Without normals: viewers then shade flat, as glTF 2.0 (3.7.2.1) says.

    Parameters
    ----------
    families : part numbers with their instances
    meshes : by part number, the mesh in the part's frame [mm]
    failed : marks of pieces that are shown in red
    """
    positions = [_converted(meshes[f.number].vertices).astype("<f4") for f in families]
    triangles = [meshes[f.number].triangles.astype("<u4") for f in families]
    lengths = [sum(p.nbytes for p in positions), sum(t.nbytes for t in triangles)]
    document = {
        "asset": {"version": "2.0", "generator": originating_system()},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        **_scene(families, failed, name),
        "accessors": _accessors(positions, triangles),
        "bufferViews": [
            {
                "buffer": 0,
                "byteLength": lengths[0],
                "byteStride": 12,
                "target": _ARRAY_BUFFER,
            },
            {
                "buffer": 0,
                "byteOffset": lengths[0],
                "byteLength": lengths[1],
                "target": _ELEMENT_ARRAY_BUFFER,
            },
        ],
        "buffers": [{"byteLength": sum(lengths)}],
    }
    text = json.dumps(document, separators=(",", ":"), ensure_ascii=False).encode()
    text += b" " * (-len(text) % 4)
    data = b"".join(a.tobytes() for a in [*positions, *triangles])
    total = 12 + 8 + len(text) + 8 + len(data)
    return b"".join(
        [
            struct.pack("<4sII", b"glTF", 2, total),
            struct.pack("<I4s", len(text), b"JSON"),
            text,
            struct.pack("<I4s", len(data), b"BIN\0"),
            data,
        ]
    )


def _scene(families: Sequence[Family], failed: Collection[str], name: str) -> dict[str, Any]:
    """Nodes by kind under one root, materials, and the meshes that nodes refer to."""
    kinds = list(dict.fromkeys(family.kind for family in families))
    groups: dict[Kind, list[int]] = {f.kind: [] for f in families if f.instances}
    # A glTF mesh owns its material, so a part number has a red twin where a piece of it failed.
    prints: dict[tuple[str, bool], int] = {}
    nodes: list[dict[str, Any]] = []
    for family in families:
        for instance in family.instances:
            key = (family.number, instance.mark in failed)
            groups[family.kind].append(1 + len(groups) + len(nodes))
            nodes.append(
                {
                    "name": instance.mark,
                    "mesh": prints.setdefault(key, len(prints)),
                    "matrix": _matrix(instance.placement),
                }
            )
    looks = [(kind.role, kind.color, kind.finish) for kind in kinds]
    if any(red for _, red in prints):
        looks.append((FAILED, FAILED_COLOR, "plastic"))
    look_of = {family.number: kinds.index(family.kind) for family in families}
    index = {family.number: i for i, family in enumerate(families)}
    return {
        "nodes": [
            {"name": name, "children": list(range(1, 1 + len(groups)))},
            *({"name": kind.title, "children": group} for kind, group in groups.items()),
            *nodes,
        ],
        "materials": [_material(*look) for look in looks],
        "meshes": [
            _mesh(number, index[number], len(kinds) if red else look_of[number])
            for number, red in prints
        ],
    }


def _mesh(number: str, index: int, material: int) -> dict[str, Any]:
    """The mesh of a part number, whose positions and corners are two accessors in a row."""
    return {
        "name": number,
        "primitives": [
            {
                "attributes": {"POSITION": 2 * index},
                "indices": 2 * index + 1,
                "material": material,
            }
        ],
    }


def write_glb(
    path: Path,
    families: Sequence[Family],
    meshes: Mapping[str, TriangleMesh],
    failed: Collection[str] = (),
    *,
    name: str = "model",
) -> None:
    """Write the model as GLB (atomically); see `glb_bytes`.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    with atomic_write(path) as file:
        file.write(glb_bytes(families, meshes, failed, name=name))


def _converted(points: Floats) -> Floats:
    """(n, 3) points [mm, z up] in metres, y up."""
    converted: Floats = points @ _Y_UP.T * _METRE
    return converted


def _matrix(placement: Placement) -> list[float]:
    """A placement in glTF's frame, column after column."""
    result = np.eye(4)
    result[:3, :3] = _Y_UP @ placement[:3, :3] @ _Y_UP.T
    result[:3, 3] = _Y_UP @ placement[:3, 3] * _METRE
    return [float(x) + 0.0 for x in result.T.ravel()]


def _accessors(positions: list[Any], triangles: list[Any]) -> list[dict[str, Any]]:
    """Per mesh the accessor of its positions (with the bounds that glTF asks for) and indices."""
    accessors: list[dict[str, Any]] = []
    at = [0, 0]
    for points, corners in zip(positions, triangles, strict=True):
        accessors += [
            {
                "bufferView": 0,
                "byteOffset": at[0],
                "componentType": _FLOAT,
                "count": len(points),
                "type": "VEC3",
                "min": points.min(axis=0).astype(float).tolist(),
                "max": points.max(axis=0).astype(float).tolist(),
            },
            {
                "bufferView": 1,
                "byteOffset": at[1],
                "componentType": _UINT32,
                "count": int(corners.size),
                "type": "SCALAR",
            },
        ]
        at[0] += points.nbytes
        at[1] += corners.nbytes
    return accessors


def _material(name: str, color: Color, finish: Finish) -> dict[str, Any]:
    """A material; glTF wants linear colors, ours are sRGB (IEC 61966-2-1)."""
    srgb = np.array(color)
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    glass = finish == "glass"
    factor = [*(round(float(x), 6) for x in linear), GLASS_ALPHA if glass else 1.0]
    material: dict[str, Any] = {
        "name": name,
        "pbrMetallicRoughness": {
            "baseColorFactor": factor,
            "metallicFactor": 0.1 if glass else 0.6,
            "roughnessFactor": 0.1 if glass else 0.5,
        },
    }
    if glass:
        material |= {"alphaMode": "BLEND", "doubleSided": True}
    return material

"""GLB as bytes: buffers, accessors, nodes, materials."""

from __future__ import annotations

import json
import struct
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ddgfab.io.atomic import atomic_write
from fabrication.formats.base import FAILED, FAILED_COLOR
from fabrication.formats.glb.frame import converted, converted_motion, converted_normals
from fabrication.formats.glb.movement import Movement, animation, key_times, keys, there_and_back
from fabrication.formats.glb.normals import shaded
from fabrication.specs import Color, Family, Finish, Kind, Placement, TriangleMesh
from fabrication.version import originating_system

GLASS_ALPHA: Final = 0.35
"""Opacity of what is made of glass."""

_FLOAT, _UINT32 = 5126, 5125
_ARRAY_BUFFER, _ELEMENT_ARRAY_BUFFER = 34962, 34963
_TYPES: Final = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}


def glb_bytes(
    families: Sequence[Family],
    meshes: Mapping[str, TriangleMesh],
    failed: Collection[str] = (),
    *,
    name: str = "model",
    masses: Mapping[str, float] | None = None,
    movement: Movement | None = None,
    about: Mapping[str, Any] | None = None,
) -> bytes:
    """The model as GLB; nodes have mark, number, role, mass and status as `extras`.

    Parameters
    ----------
    families : part numbers with their instances
    meshes : by part number, the mesh in the part's frame [mm]
    failed : marks of pieces that are shown in red
    masses : by part number [kg]
    movement : how pieces move; the first animation of the file
    about : `extras` of the root, whose name is `name`
    """
    buffers = _Buffers()
    for mesh in shaded([meshes[family.number] for family in families]):
        buffers.add("points", converted(mesh.points).astype("<f4"), bounds=True)
        buffers.add("normals", converted_normals(mesh.normals).astype("<f4"))
        buffers.add("triangles", mesh.triangles.astype("<u4").reshape(-1, 1))
    scene = _scene(families, failed, name, masses or {}, movement)
    if about:
        scene["nodes"][0]["extras"] = dict(about)
    if movement is not None:
        scene["animations"] = [_animated(scene["nodes"], movement, buffers)]
    document = {
        "asset": {"version": "2.0", "generator": originating_system()},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        **scene,
        **buffers.entries(),
    }
    text = json.dumps(document, separators=(",", ":"), ensure_ascii=False).encode()
    text += b" " * (-len(text) % 4)
    data = buffers.data()
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


def _scene(
    families: Sequence[Family],
    failed: Collection[str],
    name: str,
    masses: Mapping[str, float],
    movement: Movement | None,
) -> dict[str, Any]:
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
            extras: dict[str, Any] = {"mark": instance.mark, "number": family.number}
            extras |= {"role": family.role, "status": "rejected" if key[1] else "ok"}
            if family.number in masses:
                extras |= {"mass_kg": masses[family.number]}
            moves = movement is not None and instance.mark in movement.placements
            nodes.append(
                {
                    "name": instance.mark,
                    "mesh": prints.setdefault(key, len(prints)),
                    **_place(instance.placement, moves=moves),
                    "extras": extras,
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
    """The mesh of a part number; positions, normals and corners are three accessors in a row."""
    return {
        "name": number,
        "primitives": [
            {
                "attributes": {"POSITION": 3 * index, "NORMAL": 3 * index + 1},
                "indices": 3 * index + 2,
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


def _place(placement: Placement, *, moves: bool) -> dict[str, Any]:
    """A placement, of what moves as an animation can change it."""
    if not moves:
        return {"matrix": converted_motion(placement).T.ravel().tolist()}
    shift, turn = keys(placement[None])
    return {"translation": shift[0].tolist(), "rotation": turn[0].tolist()}


def _animated(
    nodes: Sequence[Mapping[str, Any]], movement: Movement, buffers: _Buffers
) -> dict[str, Any]:
    """The animation, with what it needs in the buffers."""
    poses = max(map(len, movement.placements.values()))
    first = buffers.add("keys", key_times(poses).reshape(-1, 1), bounds=True)
    moving = [k for k, node in enumerate(nodes) if node["name"] in movement.placements]
    for node in moving:
        for values in keys(there_and_back(movement.placements[nodes[node]["name"]])):
            buffers.add("keys", values)
    return animation(movement.name, moving, first)


@dataclass
class _Buffers:
    """Accessors, and the four views of one buffer that they lie in, one after the other."""

    accessors: list[dict[str, Any]] = field(default_factory=list)
    views: dict[str, list[NDArray[Any]]] = field(
        default_factory=lambda: {"points": [], "normals": [], "triangles": [], "keys": []}
    )
    sizes: dict[str, int] = field(default_factory=dict)

    def add(self, view: str, values: NDArray[Any], *, bounds: bool = False) -> int:
        """The number of the accessor of new values (n, width)."""
        at = self.sizes.get(view, 0)
        count, width = values.shape
        kind = _UINT32 if values.dtype.kind == "u" else _FLOAT
        accessor = {
            "bufferView": list(self.views).index(view),
            "byteOffset": at,
            "componentType": kind,
            "count": count,
            "type": _TYPES[width],
        }
        if bounds:
            low, high = values.min(axis=0), values.max(axis=0)
            accessor |= {"min": low.astype(float).tolist(), "max": high.astype(float).tolist()}
        self.accessors.append(accessor)
        self.views[view].append(values)
        self.sizes[view] = at + values.nbytes
        return len(self.accessors) - 1

    def entries(self) -> dict[str, Any]:
        """Accessors, views and buffer for the document."""
        vertices = {"byteStride": 12, "target": _ARRAY_BUFFER}
        extra = {"points": vertices, "normals": vertices}
        views, at = [], 0
        for name, size in self.sizes.items():
            target = {"target": _ELEMENT_ARRAY_BUFFER} if name == "triangles" else {}
            own = {"buffer": 0, "byteOffset": at, "byteLength": size}
            views.append({**own, **extra.get(name, target)})
            at += size
        return {
            "accessors": self.accessors,
            "bufferViews": views,
            "buffers": [{"byteLength": at}],
        }

    def data(self) -> bytes:
        """The buffer."""
        return b"".join(values.tobytes() for view in self.views.values() for values in view)


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

"""Bytes of mesh files, packed with gzip or not, and advice for files of other formats."""

from __future__ import annotations

import gzip
import hashlib
import io
import zlib
from pathlib import Path
from typing import Final

from ddgfab.errors import MeshError, clipped
from ddgfab.io.regular import read_regular

LIMIT_BYTES = 128 * 1024 * 1024
"""Largest mesh file that is read [bytes] unless the caller allows more; also after unpacking."""

BLOCK: Final = 1 << 20
"""Packed files are unpacked in blocks of so many bytes."""

_MESH = "export a polygon mesh: OBJ, OFF, PLY or STL"
_SOLID = f"holds exact surfaces, no mesh: mesh it in your CAD program and {_MESH}"
_SURFACE = (
    "holds exact surfaces, no mesh: `ddgfab trace` lays a net on a face of it, or mesh it in your "
    f"CAD program and {_MESH}"
)
_DRAWING = (
    "is a drawing: export the faces as a mesh (OBJ, OFF, PLY, STL), or the bars as OBJ lines ('l')"
)
_SCENE = f"is a scene of a modelling program: {_MESH}"
ADVICE: Final[dict[str, str]] = {
    ".step": _SURFACE,
    ".stp": _SURFACE,
    ".iges": _SURFACE,
    ".igs": _SURFACE,
    ".brep": _SOLID,
    ".sat": _SOLID,
    ".x_t": _SOLID,
    ".x_b": _SOLID,
    ".sldprt": _SOLID,
    ".ipt": _SOLID,
    ".catpart": _SOLID,
    ".fcstd": _SOLID,
    ".dxf": _DRAWING,
    ".dwg": _DRAWING,
    ".svg": _DRAWING,
    ".pdf": _DRAWING,
    ".skp": f"{_SCENE} (SketchUp: File > Export > 3D Model > OBJ, without 'triangulate all faces')",
    ".ifc": f"is a building model: {_MESH} of the one surface that the net is on",
    ".rvt": f"is a building model: {_MESH} of the one surface that the net is on",
    ".blend": f"{_SCENE} (Blender: File > Export > Wavefront, up axis Z)",
    ".fbx": _SCENE,
    ".dae": _SCENE,
    ".glb": f"holds triangles for display: {_MESH}",
    ".gltf": f"holds triangles for display: {_MESH}",
    ".3ds": _SCENE,
    ".max": _SCENE,
    ".usd": _SCENE,
    ".usdz": _SCENE,
    ".3dm": "is a Rhino file: the program reads its meshes, from Python "
    f"`fabrication.meshes_in.read_mesh`; or {_MESH}",
    ".gh": "is a Grasshopper definition: bake its mesh in Rhino and export OBJ",
    ".ghx": "is a Grasshopper definition: bake its mesh in Rhino and export OBJ",
    ".3mf": "holds solids for printing, triangles only: export OBJ, OFF, PLY or STL",
    ".amf": "holds solids for printing, triangles only: export OBJ, OFF, PLY or STL",
    ".vtk": f"{_MESH} (ParaView: File > Save Data > PLY)",
    ".vtp": f"{_MESH} (ParaView: File > Save Data > PLY)",
    ".msh": f"is a finite element mesh: {_MESH}",
    ".xyz": f"holds points without faces: {_MESH}",
    ".csv": f"holds a table: {_MESH}",
    ".txt": f"{_MESH}",
    ".zip": "is an archive: unpack it (single files may be packed with gzip, as roof.obj.gz)",
    ".7z": "is an archive: unpack it (single files may be packed with gzip, as roof.obj.gz)",
    ".rar": "is an archive: unpack it (single files may be packed with gzip, as roof.obj.gz)",
}
"""What to do with files that are not meshes, by suffix."""


def suffix_of(path: Path) -> str:
    """The suffix that names the format, in lower case; that of gzip does not count."""
    own = path.suffix.lower()
    return Path(path.stem).suffix.lower() if own == ".gz" else own


def unknown_format(path: Path, known: tuple[str, ...]) -> MeshError:
    """The error for a file that no parser reads: what to export instead."""
    suffix = suffix_of(path)
    if suffix in ADVICE:
        return MeshError(f"{suffix} is not read: it {_verb(ADVICE[suffix])}", file=str(path))
    shown = f"unknown kind of mesh file '{clipped(suffix)}'"
    if not suffix:
        shown = (
            "is a folder" if path.is_dir() else "a name without suffix says no kind of mesh file"
        )
    return MeshError(f"{shown}; known: {', '.join(known)}", file=str(path))


def _verb(advice: str) -> str:
    """Advice that starts with an order needs another beginning."""
    return f"is not a mesh of polygons: {advice}" if advice.startswith("export") else advice


def load_bytes(path: Path, limit_bytes: int) -> tuple[bytes, str]:
    """Content of a file, unpacked, and its SHA-256 as it lies on the disk.

    Raises
    ------
    MeshError
        What is missing, no regular file, empty, above the limit, or damaged gzip.
    """
    file = str(path)
    data = read_regular(path, limit_bytes)
    digest = hashlib.sha256(data).hexdigest()
    if data.startswith(b"\x1f\x8b"):
        try:
            data = _unpacked(data, limit_bytes)
        except (OSError, EOFError, zlib.error) as error:
            raise MeshError(f"is damaged gzip: {error}", file=file) from error
        if len(data) > limit_bytes:
            raise _too_large("the unpacked bytes exceed", limit_bytes, file)
    if not data or data.isspace():
        raise MeshError("the file is empty", file=file)
    return data, digest


def _unpacked(data: bytes, limit_bytes: int) -> bytes:
    """What gzip holds, up to one byte above the limit, in blocks: little takes little memory."""
    found = bytearray()
    with gzip.open(io.BytesIO(data)) as stream:
        while len(found) <= limit_bytes:
            block = stream.read(min(BLOCK, limit_bytes + 1 - len(found)))
            if not block:
                break
            found += block
    return bytes(found)


def _too_large(what: str, limit: int, file: str) -> MeshError:
    return MeshError(
        f"{what} the limit of {limit}; simplify the mesh or raise limit_bytes", file=file
    )

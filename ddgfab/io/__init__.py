"""Meshes from and to OBJ, OFF and PLY files; the only file access in `ddgfab`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ddgfab.arguments import checked
from ddgfab.errors import MeshError, OutputError
from ddgfab.io.atomic import atomic_path, atomic_write
from ddgfab.io.obj import parse_obj, write_obj
from ddgfab.io.off import parse_off, write_off
from ddgfab.io.ply import parse_ply, write_ply
from ddgfab.io.raw import LIMIT_BYTES, RawMesh, load_bytes
from ddgfab.io.repairs import repair
from ddgfab.mesh import Mesh

__all__ = [
    "LIMIT_BYTES",
    "ReadResult",
    "atomic_path",
    "atomic_write",
    "check_target",
    "read_mesh",
    "write_mesh",
    "write_obj",
    "write_off",
    "write_ply",
]

_PARSERS: dict[str, Callable[[bytes, str], RawMesh]] = {
    ".obj": parse_obj,
    ".off": parse_off,
    ".ply": parse_ply,
}

_WRITERS: dict[str, Callable[[str | Path, Mesh], None]] = {
    ".obj": write_obj,
    ".off": write_off,
    ".ply": write_ply,
}


@dataclass(frozen=True, eq=False)
class ReadResult:
    """A mesh from a file, and what happened on the way.

    Attributes
    ----------
    mesh : oriented manifold mesh, in the file's unit times the scale
    notes : what was ignored, mended or is remarkable, a sentence each
    file, sha256 : where it came from
    vertices, faces : how many the file has (before unused and duplicated vertices went)
    """

    mesh: Mesh
    notes: tuple[str, ...]
    file: str
    sha256: str
    vertices: int
    faces: int

    def __repr__(self) -> str:
        return f"ReadResult({self.mesh!r} from {self.file}, {len(self.notes)} notes)"


@checked
def read_mesh(
    path: str | Path,
    scale: float = 1.0,
    *,
    merge: float | None = None,
    limit_bytes: int = LIMIT_BYTES,
) -> ReadResult:
    """Read a polygon mesh; the suffix says the format: .obj, .off or .ply.

    Parameters
    ----------
    scale : factor on all coordinates (1000 for metres to millimetres)
    merge : distance, after scaling, below which vertices are one; None for
        `tolerances.MERGE_RELATIVE` of the bounding box diagonal, 0 to merge nothing
    limit_bytes : largest file that is read

    Raises
    ------
    MeshError
        With file, line (text formats) and reason: what cannot be read, or is no oriented manifold
        surface even after mending.
    """
    path = Path(path)
    if not (np.isfinite(scale) and scale > 0):
        raise MeshError(f"scale {scale}: a positive number is needed")
    if merge is not None and not (np.isfinite(merge) and merge >= 0):
        raise MeshError(f"merge distance {merge}: a length of 0 or more is needed")
    parse = _PARSERS.get(path.suffix.lower())
    if parse is None:
        raise MeshError(
            f"unknown kind of mesh file '{path.suffix}'; known: {', '.join(_PARSERS)}",
            file=str(path),
        )
    data, digest = load_bytes(path, limit_bytes)
    raw = parse(data, str(path))
    mesh, notes = repair(replace(raw, points=raw.points * scale), merge)
    if path.suffix.lower() != ".ply" and not data.endswith((b"\n", b"\r", b"\n\0")):
        notes.append("the last line has no line break: if the file was cut off, look there")
    return ReadResult(mesh, tuple(notes), str(path), digest, len(raw.points), len(raw.sizes))


@checked
def write_mesh(path: str | Path, mesh: Mesh) -> None:
    """Write a polygon mesh; the suffix says the format: .obj, .off or .ply.

    Raises
    ------
    MeshError
        Another suffix.
    OutputError
        A file that cannot be written; nothing is left half written.
    """
    _WRITERS[check_target(path)](path, mesh)


@checked
def check_target(path: str | Path) -> str:
    """The format of a mesh file to be written, its suffix in lower case; for long work ahead.

    Raises
    ------
    MeshError
        Another suffix than `write_mesh` knows.
    OutputError
        There is no folder for it.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in _WRITERS:
        raise MeshError(
            f"unknown kind of mesh file '{Path(path).suffix}'; known: {', '.join(_WRITERS)}",
            file=str(path),
        )
    if not Path(path).parent.is_dir():
        raise OutputError(f"{path}: cannot be written: there is no folder {Path(path).parent}")
    return suffix

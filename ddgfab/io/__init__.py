"""Meshes from OBJ, OFF, PLY, STL and COMPAS files; the only file access in `ddgfab`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final, TypeAlias

import numpy as np

from ddgfab.arguments import checked
from ddgfab.errors import MeshError, OutputError
from ddgfab.io.atomic import atomic_path, atomic_write
from ddgfab.io.axes import own_axes, unit_axes
from ddgfab.io.compas import parse_compas
from ddgfab.io.groups import Groups
from ddgfab.io.load import LIMIT_BYTES, load_bytes, suffix_of, unknown_format
from ddgfab.io.obj import parse_obj, write_obj
from ddgfab.io.off import parse_off, write_off
from ddgfab.io.pairs import merge_pairs, paired_in_order
from ddgfab.io.place import Up, flipped, local_origin, looks, rough_digits, upright
from ddgfab.io.ply import parse_ply, write_ply
from ddgfab.io.raw import RawMesh
from ddgfab.io.repairs import repair
from ddgfab.io.stl import parse_stl
from ddgfab.io.units import (
    FACTORS,
    SHORTEST_MEDIAN_MM,
    Unit,
    likely_setting,
    to_millimetres,
    unlikely_size,
)
from ddgfab.mesh import Floats, Mesh
from ddgfab.tolerances import COORDINATE_LIMIT

__all__ = [
    "FACTORS",
    "LIMIT_BYTES",
    "SHORTEST_MEDIAN_MM",
    "STATED",
    "Groups",
    "Parser",
    "ReadResult",
    "Unit",
    "Up",
    "atomic_path",
    "atomic_write",
    "check_target",
    "likely_setting",
    "read_mesh",
    "to_millimetres",
    "unlikely_size",
    "write_mesh",
    "write_obj",
    "write_off",
    "write_ply",
]

STATED: Final = "stated"
"""For `read_mesh`: the unit that the file states."""

Parser: TypeAlias = Callable[[bytes, str], RawMesh]
"""From the content of a file and its name to what it states."""

_PARSERS: dict[str, Parser] = {
    ".obj": parse_obj,
    ".off": parse_off,
    ".ply": parse_ply,
    ".stl": parse_stl,
    ".json": parse_compas,
}

_WRITERS: dict[str, Callable[..., None]] = {
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
    units : unit that the file states in a comment, or None
    origin : (3,) what was subtracted from coordinates far from the origin, in the unit of the mesh
    axes : (V, 3) unit node axes that the file carries for just this geometry, or None
    groups : named groups of an OBJ file (`g`, `o`), by vertices and edges of the mesh
    """

    mesh: Mesh
    notes: tuple[str, ...]
    file: str
    sha256: str
    vertices: int
    faces: int
    units: str | None
    origin: Floats
    axes: Floats | None
    groups: Groups = field(default_factory=Groups)

    @property
    def in_place(self) -> Mesh:
        """The mesh where the file has it, however far from the origin that is."""
        return self.mesh.with_vertices(self.mesh.vertices + self.origin)

    def __repr__(self) -> str:
        return f"ReadResult({self.mesh!r} from {self.file}, {len(self.notes)} notes)"


@checked
def read_mesh(
    path: str | Path,
    scale: float = 1.0,
    *,
    units: str | None = None,
    merge: float | None = None,
    up: str = "z",
    flip: bool = False,
    quads: bool = False,
    limit_bytes: int = LIMIT_BYTES,
    readers: Mapping[str, Parser] | None = None,
) -> ReadResult:
    """Read a polygon mesh; the suffix says the format: .obj, .off, .ply, .stl or .json (COMPAS).

    Files may be packed with gzip (roof.obj.gz). Coordinates far from the origin come about a
    local origin.

    Parameters
    ----------
    scale : factor on all coordinates (1000 for metres to millimetres)
    units : "mm", "cm", "m", "in" or "ft": unit of the coordinates times the scale; "stated": the
        one that the file states in a comment, else millimetres. The mesh then comes in
        millimetres. None: coordinates stay as they are
    merge : distance, after scaling, below which vertices are one; None for what the digits of the
        file leave, 0 to merge nothing
    up : axis of the file that becomes z: "z", "y", "x", "-z", "-y" or "-x"
    flip : turn all faces over
    quads : merge pairs of triangles into quads
    limit_bytes : largest file that is read
    readers : parsers of further formats by suffix (".3dm"): content and name of a file to what it
        states

    Raises
    ------
    MeshError
        With file, line (text formats) and reason: what cannot be read, or is not an oriented
        manifold surface even after mending.
    """
    path = Path(path)
    if not (np.isfinite(scale) and scale > 0):
        raise MeshError(f"scale {scale}: a positive number is needed")
    if merge is not None and not (np.isfinite(merge) and merge >= 0):
        raise MeshError(f"merge distance {merge}: a length of 0 or more is needed")
    parsers = {**_PARSERS, **(readers or {})}
    parse = parsers.get(suffix_of(path))
    if parse is None:
        raise unknown_format(path, tuple(parsers))
    data, digest = load_bytes(path, limit_bytes)
    raw = own_axes(parse(data, str(path)))
    if units is not None:
        asked = None if units == STATED else units
        scale = to_millimetres(asked, scale, raw.units, str(path))
    placed, origin = _placed(raw, scale, up)
    mesh, repaired, notes = repair(placed, merge)
    axes = unit_axes(repaired.axes, up)
    if origin.any():
        notes.append(
            "the mesh lies far from the origin: ({:.12g}, {:.12g}, {:.12g}) was subtracted from "
            "its coordinates".format(*origin)
        )
        rough = rough_digits(placed.lost, mesh)
        notes += [rough] if rough else []
    mesh, paired = _paired(mesh, quads)
    notes += paired
    if flip:
        mesh = flipped(mesh)
        axes = None if axes is None else -axes
    notes += looks(mesh)
    if suffix_of(path) in (".obj", ".off") and not data.endswith((b"\n", b"\r", b"\n\0")):
        notes.append("the last line has no line break: if the file was cut off, look there")
    counts = len(raw.points), len(raw.sizes)
    return ReadResult(
        mesh, tuple(notes), str(path), digest, *counts, raw.units, origin, axes, repaired.groups
    )


def _placed(raw: RawMesh, scale: float, up: str) -> tuple[RawMesh, Floats]:
    """What a file states, scaled, upright and about a local origin; and that origin."""
    with np.errstate(over="ignore"):  # what is too large is refused by `repair`
        points = upright(raw.points * scale, up)
    finite = bool(len(points)) and bool((np.abs(points) <= COORDINATE_LIMIT).all())
    used = np.unique(raw.corners[(raw.corners >= 0) & (raw.corners < len(points))])
    origin = local_origin(points[used]) if finite else np.zeros(3)
    scaled = replace(raw, points=points - origin, step=raw.step * scale, lost=raw.lost * scale)
    return scaled, origin


def _paired(mesh: Mesh, quads: bool) -> tuple[Mesh, list[str]]:
    """The mesh with pairs of triangles merged into quads where that is asked for, and notes."""
    if not quads:
        if not paired_in_order(mesh):
            return mesh, []
        return mesh, [
            "its triangles are quads cut in two: quads = true in [net] (--quads) merges them"
        ]
    merged, left = merge_pairs(mesh)
    return merged, [f"{left} triangles found no partner for a quad and stay"] if left else []


@checked
def write_mesh(
    path: str | Path,
    mesh: Mesh,
    *,
    units: str | None = None,
    axes: Floats | None = None,
    groups: Groups | None = None,
) -> None:
    """Write a polygon mesh; the suffix says the format: .obj, .off or .ply.

    Parameters
    ----------
    units : unit of the coordinates, written as a comment that `read_mesh` understands
    axes : (V, 3) node axes, written as vertex normals, with a comment that says so and holds a
        digest of the geometry: `read_mesh` takes them for no other
    groups : named vertices and edges, of which OBJ files keep the names; others have none

    Raises
    ------
    MeshError
        Another suffix.
    OutputError
        A file that cannot be written; nothing is left half written.
    """
    suffix = check_target(path)
    named = {"groups": groups} if groups and suffix == ".obj" else {}
    _WRITERS[suffix](path, mesh, units=units, axes=axes, **named)


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

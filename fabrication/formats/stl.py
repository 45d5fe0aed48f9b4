"""Binary STL straight from arrays; and STL, binary or text, back to triangles."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ddgfab.errors import InputError
from ddgfab.io.atomic import atomic_write
from ddgfab.io.regular import read_regular
from ddgfab.mesh import Floats
from ddgfab.tolerances import COORDINATE_LIMIT
from fabrication.checks.mesh import measure_mesh
from fabrication.formats.base import Format, Part, Provenance
from fabrication.formats.solids import SolidsReport, mesh_report
from fabrication.specs import Check, TriangleMesh

_RECORD: Final = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_HEADER: Final = 80

LIMIT_BYTES: Final = 256 * 1024 * 1024
"""Larger files are refused."""

STL_ROUNDING: Final = 2.0**-23
"""Greatest rounding of a coordinate in an STL (single precision), relative to its size."""


class Stl(Format):
    """STL: a mesh a part number, in millimeters; the file itself names no unit."""

    name = "stl"
    suffixes = (".stl",)
    parts = True
    by_default = "always"

    def write_part(self, path: Path, part: Part, about: Provenance) -> None:
        """Binary; see `stl_bytes`."""
        path.write_bytes(stl_bytes(part.mesh, part.number))

    def check_part(self, path: Path, part: Part) -> list[Check]:
        """Read back and compared; see `check_stl_part`."""
        return check_stl_part(path, part.mesh)

    def inspect(self, path: Path) -> SolidsReport:
        """Closed, outward, without crossings; see `Format.inspect`."""
        return mesh_report(path, "STL", "mm assumed", [("", 1, read_stl(path))])


FORMAT: Final = Stl()


def stl_bytes(mesh: TriangleMesh, name: str = "") -> bytes:
    """The mesh as binary STL [mm]: header "ddgfab NAME", unit normals from the rounded corners.

    The same mesh always gives the same bytes.
    """
    records = np.zeros(len(mesh.triangles), dtype=_RECORD)
    corners = mesh.vertices.astype(np.float32)[mesh.triangles]
    records["corners"] = corners
    exact = corners.astype(np.float64)
    normals = np.cross(exact[:, 1] - exact[:, 0], exact[:, 2] - exact[:, 0])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    records["normal"] = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0)
    # A header that begins with "solid" would be taken for a text STL.
    header = f"ddgfab {name}".encode("ascii", "replace")[:_HEADER].ljust(_HEADER, b" ")
    return header + len(records).to_bytes(4, "little") + records.tobytes()


def write_stl(path: Path, mesh: TriangleMesh, name: str = "") -> None:
    """Write a mesh as binary STL (atomically).

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    with atomic_write(path) as file:
        file.write(stl_bytes(mesh, name))


def read_stl(path: Path) -> TriangleMesh:
    """The triangles of a binary or text STL; equal corners become one vertex.

    Raises
    ------
    InputError
        The file is missing, truncated, no STL, or holds coordinates that are not finite.
    """
    data = read_regular(path, LIMIT_BYTES, InputError, what="an STL file", advice="split the body")
    corners = _binary(data)
    if corners is None:
        corners = _text(data, path)
    if not (np.abs(corners) <= COORDINATE_LIMIT).all():
        text = f"the STL holds a coordinate that is not finite, or beyond {COORDINATE_LIMIT:g}"
        raise InputError(text, file=str(path))
    return weld(corners)


def check_stl_part(path: Path, mesh: TriangleMesh) -> list[Check]:
    """The checks of one part number's STL file, read back and compared with the mesh written.

    Returns
    -------
    Checks "stl readable", and if it is, "stl triangles" (count), "stl watertight" (open edges after
    welding equal corners), "stl corners" (greatest distance [mm], against single precision).
    """
    try:
        back = read_stl(path)
    except InputError as error:
        return [Check("stl readable", False, str(error))]
    count, expected = len(back.triangles), len(mesh.triangles)
    checks = [
        Check("stl readable", True),
        Check("stl triangles", count == expected, float(count), float(expected)),
    ]
    open_edges = measure_mesh(back).open_edges
    checks.append(Check("stl watertight", count > 0 and open_edges == 0, float(open_edges), 0.0))
    if count == expected and count:
        away = float(np.abs(back.vertices[back.triangles] - mesh.vertices[mesh.triangles]).max())
        limit = STL_ROUNDING * float(np.abs(mesh.vertices).max())
        checks.append(Check("stl corners", away <= limit, away, limit))
    return checks


def weld(corners: Floats) -> TriangleMesh:
    """The mesh of (m, 3, 3) triangle corners; corners with equal coordinates become one vertex."""
    # Adding 0 turns -0 into 0, so that the two are one coordinate.
    flat = np.ascontiguousarray(corners.reshape(-1, 3) + 0.0)
    vertices, inverse = np.unique(flat, axis=0, return_inverse=True)
    triangles: NDArray[np.int64] = inverse.reshape(-1, 3).astype(np.int64)
    return TriangleMesh(vertices, triangles)


def _binary(data: bytes) -> Floats | None:
    """(m, 3, 3) corners when the length of the data is what a binary STL says it is."""
    if len(data) < _HEADER + 4:
        return None
    count = int(np.frombuffer(data, "<u4", 1, _HEADER)[0])
    if len(data) != _HEADER + 4 + count * _RECORD.itemsize:
        return None
    records = np.frombuffer(data, _RECORD, count, _HEADER + 4)
    return np.array(records["corners"], dtype=np.float64)


def _text(data: bytes, path: Path) -> Floats:
    """(m, 3, 3) corners of a text STL."""
    if not data.lstrip().startswith(b"solid"):
        expected = "" if len(data) < _HEADER + 4 else _expected(data)
        raise InputError(f"no STL, or a truncated one: {len(data)} bytes{expected}", file=str(path))
    values: list[list[float]] = []
    for number, line in enumerate(data.decode("ascii", "replace").splitlines(), start=1):
        words = line.split()
        if not words or words[0].lower() != "vertex":
            continue
        try:
            point = [float(word) for word in words[1:]]
        except ValueError:
            point = []
        if len(point) != 3:
            raise InputError("a vertex needs three numbers", file=str(path), line=number)
        values.append(point)
    if len(values) % 3 or not values or b"endsolid" not in data:
        raise InputError(
            f"the text STL ends early: {len(values)} vertices, "
            f"{'an' if b'endsolid' in data else 'no'} endsolid line",
            file=str(path),
        )
    return np.array(values).reshape(-1, 3, 3)


def _expected(data: bytes) -> str:
    count = int(np.frombuffer(data, "<u4", 1, _HEADER)[0])
    return f", where its {count} triangles need {_HEADER + 4 + count * _RECORD.itemsize}"

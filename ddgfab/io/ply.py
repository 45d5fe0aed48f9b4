"""PLY (Stanford polygon file format), text and binary: polygons in, polygons out."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ddgfab.arguments import checked
from ddgfab.errors import MeshError
from ddgfab.io.atomic import atomic_write
from ddgfab.io.header import AXES_NOTE, header_lines, stated_digest
from ddgfab.io.ply_body import BinaryBody, Element, Property, TextBody
from ddgfab.io.raw import RawMesh, check_count
from ddgfab.io.tokens import clip, integer
from ddgfab.io.units import stated_unit
from ddgfab.mesh import Floats, Ints, Mesh

_TYPES = {
    "char": "i1",
    "uchar": "u1",
    "short": "i2",
    "ushort": "u2",
    "int": "i4",
    "uint": "u4",
    "float": "f4",
    "double": "f8",
    "int8": "i1",
    "uint8": "u1",
    "int16": "i2",
    "uint16": "u2",
    "int32": "i4",
    "uint32": "u4",
    "float32": "f4",
    "float64": "f8",
}
_INDEX_NAMES = ("vertex_indices", "vertex_index")


@dataclass
class _Header:
    """Format, elements in order, lines of the header, and where the body begins."""

    format: str = ""
    elements: list[Element] = field(default_factory=list)
    lines: int = 0
    end: int = 0
    comments: list[str] = field(default_factory=list)


def parse_ply(data: bytes, file: str) -> RawMesh:
    """Vertices and polygons of a PLY file: text, binary little or big endian.

    Polygons are the list property `vertex_indices` or `vertex_index` of the element `face`; other
    properties and elements are skipped.

    Raises
    ------
    MeshError
        A header that is none, no vertices or faces in it, a file that ends too soon, tokens that
        are not numbers. Line numbers for the header and for text files.

    Source: Turk, The PLY polygon file format, 1994.
    """
    header = _header(data, file)
    by_name = {element.name: element for element in header.elements}
    for name in ("vertex", "face"):
        if name not in by_name:
            raise MeshError(f"the header has no element '{name}'", file=file, line=header.lines)
    scalars = {p.name for p in by_name["vertex"].properties if p.count is None}
    if not {"x", "y", "z"} <= scalars:
        raise MeshError("vertices have no properties x, y and z", file=file, line=header.lines)
    lists = [p.name for p in by_name["face"].properties if p.count and not p.code.startswith("f")]
    index_name = next((name for name in _INDEX_NAMES if name in lists), None)
    if index_name is None:
        raise MeshError(
            "faces have no list of whole numbers vertex_indices or vertex_index",
            file=file,
            line=header.lines,
        )
    body: TextBody | BinaryBody
    if header.format == "ascii":
        body = TextBody(data[header.end :], file, header.lines)
    else:
        order = "<" if header.format == "binary_little_endian" else ">"
        body = BinaryBody(data[header.end :], file, order)
    names: tuple[str, ...] = ("x", "y", "z")
    if AXES_NOTE in "\n".join(header.comments) and {"nx", "ny", "nz"} <= scalars:
        names = ("x", "y", "z", "nx", "ny", "nz")
    table = np.empty((0, 6))
    step = 0.0
    corners = sizes = np.empty(0, dtype=np.int64)
    lines: dict[str, Ints | None] = {}
    skipped = []
    for element in header.elements:
        if element.name == "vertex":
            columns, lines["vertex"] = body.scalars(element, names)
            table = np.stack(columns, axis=1)
            code = next(p.code for p in element.properties if p.name == "x")
            step = body.step(code, table[:, :3])
        elif element.name == "face":
            corners, sizes, lines["face"] = body.lists(element, index_name)
        else:
            body.skip(element)
            skipped.append(f"ignored {element.count} elements '{clip(element.name)}'")
    if body.rest():
        skipped.append("ignored what follows the last element")
    return RawMesh(
        file,
        table[:, :3].copy(),
        corners,
        sizes,
        lines["vertex"],
        lines["face"],
        skipped,
        step,
        stated_unit("\n".join(header.comments)),
        table[:, 3:].copy() if len(names) == 6 else None,
        stated_digest("\n".join(header.comments)),
        lost=body.lost or step,
    )


def _header(data: bytes, file: str) -> _Header:
    """The header's lines up to `end_header`; they end with LF or CRLF."""
    header = _Header()
    while True:
        stop = data.find(b"\n", header.end)
        if stop < 0 or header.lines > 10_000:
            raise MeshError("truncated: no end_header", file=file, line=max(header.lines, 1))
        words = data[header.end : stop].decode("ascii", errors="replace").split()
        header.end = stop + 1
        header.lines += 1
        line = header.lines
        if line == 1:
            if words != ["ply"]:
                raise MeshError("a PLY file starts with a line 'ply'", file=file, line=line)
        elif not words or words[0] in ("comment", "obj_info"):
            header.comments.append(" ".join(words[1:]))
        elif words[0] == "end_header":
            break
        else:
            _declare(header, words, file, line)
    if not header.format:
        raise MeshError("the header names no format", file=file, line=header.lines)
    for element in header.elements:
        if not element.properties and element.count:
            raise MeshError(
                f"element '{clip(element.name)}' has no properties", file=file, line=header.lines
            )
    return header


def _declare(header: _Header, words: list[str], file: str, line: int) -> None:
    """One line of the header: format, element or property."""
    known = ("ascii", "binary_little_endian", "binary_big_endian")
    wrong = MeshError(f"cannot read '{clip(' '.join(words))}' in the header", file=file, line=line)
    if words[0] == "format" and len(words) == 3:
        if words[1] not in known:
            raise MeshError(
                f"unknown format '{clip(words[1])}'; known: {', '.join(known)}",
                file=file,
                line=line,
            )
        header.format = words[1]
    elif words[0] == "element" and len(words) == 3:
        count = integer(words[2], file, line, "count")
        if count < 0 or words[1] in {element.name for element in header.elements}:
            raise wrong
        check_count(count, f"elements '{clip(words[1])}'", file, line)
        header.elements.append(Element(words[1], count, []))
    elif words[0] == "property" and header.elements and len(words) in (3, 5):
        types = words[2:4] if words[1] == "list" else words[1:2]
        if (words[1] == "list") != (len(words) == 5) or any(t not in _TYPES for t in types):
            raise wrong
        codes = [_TYPES[t] for t in types]
        taken = {item.name for item in header.elements[-1].properties}
        if words[-1] in taken or (len(codes) == 2 and codes[0].startswith("f")):
            raise wrong
        count_code = codes[0] if len(codes) == 2 else None
        header.elements[-1].properties.append(Property(words[-1], codes[-1], count_code))
    else:
        raise wrong


@checked
def write_ply(
    path: str | Path,
    mesh: Mesh,
    *,
    binary: bool = True,
    units: str | None = None,
    axes: Floats | None = None,
) -> None:
    """Write a mesh as PLY (little endian doubles, or text), atomically and exactly.

    Parameters
    ----------
    units : written as a comment, which `read_mesh` understands
    axes : (V, 3) node axes, written as vertex normals with a comment that says so

    Raises
    ------
    InputError
        An unknown unit, or axes of the wrong shape.
    OutputError
        The file cannot be written; an old one is left as it was.
    """
    kind = "binary_little_endian" if binary else "ascii"
    comments = "".join(f"comment {line}\n" for line in header_lines(mesh, units, axes))
    table = mesh.vertices if axes is None else np.hstack([mesh.vertices, axes])
    names = ("x", "y", "z", "nx", "ny", "nz")[: table.shape[1]]
    head = (
        f"ply\nformat {kind} 1.0\n{comments}element vertex {mesh.n_vertices}\n"
        + "".join(f"property double {name}\n" for name in names)
        + f"element face {mesh.n_faces}\nproperty list int int vertex_indices\nend_header\n"
    )
    with atomic_write(path) as stream:
        stream.write(head.encode("ascii"))
        if binary:
            stream.write(table.astype("<f8").tobytes())
            with_sizes = np.insert(mesh.corners, mesh.face_start[:-1], mesh.face_sizes)
            stream.write(with_sizes.astype("<i4").tobytes())
        else:
            rows = [" ".join(map(repr, row)) for row in table.tolist()]
            rows += [f"{len(face)} " + " ".join(map(str, face.tolist())) for face in mesh.faces]
            stream.write(("\n".join(rows) + "\n").encode("ascii"))

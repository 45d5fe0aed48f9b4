"""STL (stereolithography), text and binary: triangles in."""

from __future__ import annotations

import numpy as np

from ddgfab.errors import MeshError
from ddgfab.io.near import labeled
from ddgfab.io.raw import RawMesh, Rows, binary_step, check_count
from ddgfab.io.tokens import decode, numbered
from ddgfab.mesh import Floats, Ints

_HEADER = 84
_RECORD = np.dtype([("normal", "<f4", 3), ("points", "<f4", (3, 3)), ("attribute", "<u2")])


def parse_stl(data: bytes, file: str) -> RawMesh:
    """Triangles of an STL file; corners at equal coordinates are one vertex.

    Raises
    ------
    MeshError
        A binary file of another length than it states, text that is not STL, no triangles.

    Source: 3D Systems, StereoLithography interface specification, 1989.
    """
    if len(data) >= _HEADER:
        count = int(np.frombuffer(data, "<u4", 1, 80)[0])
        if len(data) == _HEADER + count * _RECORD.itemsize:
            check_count(count, "triangles", file)
            table = np.frombuffer(data, _RECORD, count, _HEADER)
            with np.errstate(invalid="ignore"):  # signaling NaN, refused below as any other
                points = table["points"].astype(np.float64).reshape(-1, 3)
            return _of(file, points, None, binary_step(points, "<f4"))
    if data.lstrip()[:5].lower() != b"solid":
        stated = int(np.frombuffer(data, "<u4", 1, 80)[0]) if len(data) >= _HEADER else 0
        raise MeshError(
            f"is not an STL file: it does not start with 'solid', and a binary file of {stated} "
            f"triangles has {_HEADER + stated * _RECORD.itemsize} bytes, not {len(data)}",
            file=file,
        )
    rows = Rows(file)
    text = decode(data, file)
    for line, content in numbered(text):
        parts = content.split()
        if parts and parts[0].lower() == "vertex":
            if len(parts) != 4:
                raise MeshError(
                    f"a vertex needs three coordinates; {len(parts) - 1} given",
                    file=file,
                    line=line,
                )
            rows.vertex(parts[1:], line, per=3)
    lines = np.array(rows.point_lines, dtype=np.int64)
    if len(lines) % 3 or "endsolid" not in text.lower():
        raise MeshError(
            f"truncated: {len(lines)} corners are there, and "
            f"{'three make a triangle' if len(lines) % 3 else 'endsolid is missing'}",
            file=file,
            line=int(lines[-1]) if len(lines) else None,
        )
    points = np.array(rows.points, dtype=np.float64).reshape(-1, 3)
    return _of(file, points, lines, rows.digits.step)


def _of(file: str, points: Floats, lines: Ints | None, step: float) -> RawMesh:
    """Vertices at equal coordinates are one; ids in the order of the file."""
    if not len(points):
        raise MeshError("holds no triangles", file=file)
    first, label = labeled(points)
    order = np.argsort(first, kind="stable")
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    keep = first[order]
    return RawMesh(
        file,
        points[keep],
        rank[label],
        np.full(len(points) // 3, 3, dtype=np.int64),
        None if lines is None else lines[keep],
        None if lines is None else lines[::3],
        [],
        step,
    )

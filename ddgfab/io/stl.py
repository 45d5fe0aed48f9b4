"""STL (stereolithography), text and binary: triangles in."""

from __future__ import annotations

import numpy as np

from ddgfab.errors import MeshError
from ddgfab.io.raw import SAMPLE, RawMesh, binary_step, decimal_step
from ddgfab.io.tokens import decode, number
from ddgfab.mesh import Floats, Ints

_HEADER = 84
_RECORD = np.dtype([("normal", "<f4", 3), ("points", "<f4", (3, 3)), ("attribute", "<u2")])


def parse_stl(data: bytes, file: str) -> RawMesh:
    """Triangles of an STL file; corners at equal coordinates are one vertex.

    Raises
    ------
    MeshError
        A binary file of another length than it states, text that is no STL, no triangles.

    Source: 3D Systems, StereoLithography interface specification, 1989.
    """
    if len(data) >= _HEADER:
        count = int(np.frombuffer(data, "<u4", 1, 80)[0])
        if len(data) == _HEADER + count * _RECORD.itemsize:
            table = np.frombuffer(data, _RECORD, count, _HEADER)
            points = table["points"].astype(np.float64).reshape(-1, 3)
            return _of(file, points, None, binary_step(points, "<f4"))
    if data.lstrip()[:5].lower() != b"solid":
        stated = int(np.frombuffer(data, "<u4", 1, 80)[0]) if len(data) >= _HEADER else 0
        raise MeshError(
            f"is no STL file: it does not start with 'solid', and a binary file of {stated} "
            f"triangles has {_HEADER + stated * _RECORD.itemsize} bytes, not {len(data)}",
            file=file,
        )
    rows, lines, sample = [], [], list[str]()
    text = decode(data, file)
    for line, content in enumerate(text.split("\n"), start=1):
        parts = content.split()
        if parts and parts[0].lower() == "vertex":
            if len(parts) != 4:
                raise MeshError(
                    f"a vertex needs three coordinates; {len(parts) - 1} given",
                    file=file,
                    line=line,
                )
            rows.append([number(token, file, line) for token in parts[1:]])
            lines.append(line)
            sample += parts[1:] if len(sample) < SAMPLE else []
    if len(rows) % 3 or "endsolid" not in text.lower():
        raise MeshError(
            f"truncated: {len(rows)} corners are there, and "
            f"{'three make a triangle' if len(rows) % 3 else 'endsolid is missing'}",
            file=file,
            line=lines[-1] if lines else None,
        )
    points = np.array(rows, dtype=np.float64).reshape(-1, 3)
    return _of(file, points, np.array(lines, dtype=np.int64), decimal_step(sample))


def _of(file: str, points: Floats, lines: Ints | None, step: float) -> RawMesh:
    """Vertices at equal coordinates are one; ids in the order of the file."""
    if not len(points):
        raise MeshError("holds no triangles", file=file)
    first, label = np.unique(points, axis=0, return_index=True, return_inverse=True)[1:]
    order = np.argsort(first, kind="stable")
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    keep = first[order]
    return RawMesh(
        file,
        points[keep],
        rank[label.reshape(-1)].astype(np.int64),
        np.full(len(points) // 3, 3, dtype=np.int64),
        None if lines is None else lines[keep],
        None if lines is None else lines[::3],
        [],
        step,
    )

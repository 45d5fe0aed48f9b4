"""OFF (Geomview object file format): polygons in, polygons out."""

from __future__ import annotations

import re
from pathlib import Path

from ddgfab.arguments import checked
from ddgfab.errors import MeshError
from ddgfab.io.atomic import atomic_write
from ddgfab.io.raw import RawMesh, clip, decode, integer, number
from ddgfab.mesh import Mesh

_HEADER = re.compile(r"(ST)?(C)?(N)?(4)?(n)?OFF(\d*)$")


def parse_off(data: bytes, file: str) -> RawMesh:
    """Vertices and polygons of an OFF, COFF, NOFF or STOFF file; colours and normals are skipped.

    Counts may stand behind the header, even without a space between (found in ModelNet), or in the
    next line, with or without that of the edges.
    Files that count vertices from 1 are against the format but found: when the ids run from 1 to
    the number of vertices and 0 never occurs, they are read so, with a note.

    Raises
    ------
    MeshError
        No OFF header, binary or four-dimensional files, fewer vertices or faces than stated,
        tokens that are no numbers.

    Source: Geomview manual, OFF files.
    """
    rows = []
    for line, content in enumerate(decode(data, file).split("\n"), start=1):
        parts = content.partition("#")[0].split()
        if parts:
            rows.append((line, parts))
    counts, line, at = _head(rows, file)
    n_points, n_faces = counts
    stated = n_points + n_faces
    if len(rows) - at < stated:
        have = len(rows) - at
        raise MeshError(
            f"truncated: {n_points} vertices and {n_faces} faces are stated in line {line}, "
            f"{min(have, n_points)} and {max(have - n_points, 0)} are there",
            file=file,
            line=rows[-1][0],
        )
    notes = []
    if len(rows) - at > stated:
        notes.append(f"ignored all after the last stated face (from line {rows[at + stated][0]})")
    points, point_lines = [], []
    for row, parts in rows[at : at + n_points]:
        if len(parts) < 3:
            raise MeshError(
                f"a vertex needs three coordinates; {len(parts)} given", file=file, line=row
            )
        points.append([number(token, file, row) for token in parts[:3]])
        point_lines.append(row)
    faces, face_lines = [], []
    for row, parts in rows[at + n_points : at + stated]:
        size = integer(parts[0], file, row, "number of corners")
        if size < 3:
            raise MeshError(f"a face needs three corners; {size} given", file=file, line=row)
        if len(parts) < size + 1:
            raise MeshError(
                f"a face of {size} corners names {len(parts) - 1} vertices", file=file, line=row
            )
        faces.append([integer(token, file, row) for token in parts[1 : size + 1]])
        face_lines.append(row)
    raw = RawMesh.of(file, points, faces, point_lines, face_lines, notes)
    return _from_one(raw)


def _head(rows: list[tuple[int, list[str]]], file: str) -> tuple[tuple[int, int], int, int]:
    """Counts of vertices and faces, their line, and the row where the vertices begin."""
    if not rows:
        raise MeshError("holds nothing but comments", file=file)
    line, parts = rows[0]
    found = _HEADER.match("OFF" if parts[0] == "off" else parts[0])
    if not found:
        raise MeshError(
            f"starts with '{clip(parts[0])}'; an OFF file starts with OFF", file=file, line=line
        )
    if found[4] or found[5]:
        raise MeshError(
            f"'{clip(parts[0])}' has points of another dimension; three are needed",
            file=file,
            line=line,
        )
    rest = ([found[6]] if found[6] else []) + parts[1:]
    if rest and rest[0].upper() == "BINARY":
        raise MeshError("binary OFF is not read; save it as text", file=file, line=line)
    at = 1
    if not rest:
        if len(rows) < 2:
            raise MeshError("truncated: the counts are missing", file=file, line=line)
        line, rest = rows[1]
        at = 2
    if len(rest) < 2:
        raise MeshError("numbers of vertices and faces are needed", file=file, line=line)
    counts = tuple(integer(token, file, line, "count") for token in rest[:2])
    if min(counts) < 0:
        raise MeshError(f"count {min(counts)} is negative", file=file, line=line)
    return (counts[0], counts[1]), line, at


def _from_one(raw: RawMesh) -> RawMesh:
    """Ids from 0, also where the file counts from 1."""
    if not len(raw.corners) or raw.corners.min() != 1 or raw.corners.max() != len(raw.points):
        return raw
    note = "the file counts vertices from 1, against the format: read so"
    return RawMesh(
        raw.file,
        raw.points,
        raw.corners - 1,
        raw.sizes,
        raw.point_lines,
        raw.face_lines,
        [*raw.notes, note],
    )


@checked
def write_off(path: str | Path, mesh: Mesh) -> None:
    """Write a mesh as OFF, atomically; coordinates as their shortest exact decimals.

    Raises
    ------
    OutputError
        The file cannot be written; an old one is left as it was.
    """
    rows = ["OFF", f"{mesh.n_vertices} {mesh.n_faces} {mesh.n_edges}"]
    rows += [f"{x!r} {y!r} {z!r}" for x, y, z in mesh.vertices.tolist()]
    rows += [f"{len(face)} " + " ".join(map(str, face.tolist())) for face in mesh.faces]
    with atomic_write(path) as stream:
        stream.write(("\n".join(rows) + "\n").encode("ascii"))

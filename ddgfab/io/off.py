"""OFF (Geomview object file format): polygons in, polygons out."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from ddgfab.arguments import checked
from ddgfab.errors import MeshError
from ddgfab.io.atomic import atomic_write
from ddgfab.io.header import AXES_NOTE, comments_of, header_lines
from ddgfab.io.raw import SAMPLE, RawMesh, decimal_step
from ddgfab.io.tokens import clip, decode, integer, number
from ddgfab.io.units import stated_unit
from ddgfab.mesh import Floats, Mesh

_HEADER = re.compile(r"(ST)?(C)?(N)?(4)?(n)?OFF(\d*)$")
Row = tuple[int, list[str]]


def parse_off(data: bytes, file: str) -> RawMesh:
    """Vertices and polygons of an OFF, COFF, NOFF or STOFF file; colors are skipped.

    Counts may stand behind the header, even without a space between (found in ModelNet), or in the
    next line, with or without that of the edges. Line breaks mean nothing where the records are
    not a line each: then the numbers are read one after the other.
    Files that count vertices from 1 are against the format but found: when the ids run from 1 to
    the number of vertices and 0 never occurs, they are read so, with a note. Normals of a NOFF
    file count only where a comment says that they are node axes.

    Raises
    ------
    MeshError
        No OFF header, binary or four-dimensional files, fewer vertices or faces than stated,
        tokens that are no numbers.

    Source: Geomview manual, OFF files.
    """
    text = decode(data, file)
    comments = comments_of(text, "#")
    rows = []
    for line, content in enumerate(text.split("\n"), start=1):
        parts = content.partition("#")[0].split()
        if parts:
            rows.append((line, parts))
    counts, values, at = _head(rows, file)
    body = rows[at:]
    raw = _by_lines(body, counts, file)
    if raw is None:
        try:
            raw = _by_tokens(body, counts, values, file)
        except MeshError:
            if len(body) >= sum(counts):  # a line for each record: what is wrong with one of them?
                _check_lines(body, counts, file)
            raise
    axes = _axes(body, counts[0]) if AXES_NOTE in comments and values >= 6 else None
    return replace(_from_one(raw), units=stated_unit(comments), axes=axes)


def _by_lines(rows: list[Row], counts: tuple[int, int], file: str) -> RawMesh | None:
    """The file where every record has a line of its own; None where it has not."""
    n_points, n_faces = counts
    stated = n_points + n_faces
    points, faces = rows[:n_points], rows[n_points:stated]
    if len(rows) < stated or any(len(parts) < 3 for _, parts in points):
        return None
    if any(not p[0].isdecimal() or len(p[0]) > 9 or len(p) <= int(p[0]) for _, p in faces):
        return None
    notes = []
    if len(rows) > stated:
        notes.append(f"ignored all after the last stated face (from line {rows[stated][0]})")
    polygons = []
    for line, parts in faces:
        size = _size(parts[0], file, line)
        polygons.append([integer(token, file, line) for token in parts[1 : size + 1]])
    sample = points[:: max(1, 3 * len(points) // SAMPLE)]
    return RawMesh.of(
        file,
        [[number(token, file, line) for token in parts[:3]] for line, parts in points],
        polygons,
        [line for line, _ in points],
        [line for line, _ in faces],
        notes,
        step=decimal_step(token for _, parts in sample for token in parts[:3]),
    )


def _check_lines(rows: list[Row], counts: tuple[int, int], file: str) -> None:
    """Raise for the first line that is no record."""
    for line, parts in rows[: counts[0]]:
        if len(parts) < 3:
            raise MeshError(
                f"a vertex needs three coordinates; {len(parts)} given", file=file, line=line
            )
    for line, parts in rows[counts[0] : sum(counts)]:
        size = _size(parts[0], file, line)
        if len(parts) <= size:
            raise MeshError(
                f"a face of {size} corners names {len(parts) - 1} vertices", file=file, line=line
            )


def _by_tokens(rows: list[Row], counts: tuple[int, int], values: int, file: str) -> RawMesh:
    """The file as a sequence of numbers, whatever its lines; a face ends with its last corner.

    What follows the corners in the line of the last of them is the color of the face.
    """
    n_points, n_faces = counts
    tokens = [(line, token) for line, parts in rows for token in parts]
    ends = {}  # token after the last one of its line
    at = 0
    for line, parts in rows:
        at += len(parts)
        ends[line] = at
    last = rows[-1][0] if rows else None
    have = min(n_points, len(tokens) // values)
    if have < n_points:
        raise MeshError(
            f"truncated: {n_points} vertices and {n_faces} faces are stated, {have} and 0 are "
            f"there (a vertex needs {'three coordinates' if values == 3 else f'{values} numbers'})",
            file=file,
            line=last,
        )
    points, point_lines = [], []
    for start in range(0, values * n_points, values):
        points.append([number(token, file, line) for line, token in tokens[start : start + 3]])
        point_lines.append(tokens[start][0])
    faces: list[list[int]] = []
    face_lines: list[int] = []
    at = values * n_points
    for face in range(n_faces):
        if at >= len(tokens):
            raise MeshError(
                f"truncated: {n_points} vertices and {n_faces} faces are stated, "
                f"{n_points} and {face} are there",
                file=file,
                line=last,
            )
        line, token = tokens[at]
        size = _size(token, file, line)
        stop = at + 1 + size
        if stop > len(tokens):
            raise MeshError(
                f"truncated: a face of {size} corners names {len(tokens) - at - 1} vertices",
                file=file,
                line=line,
            )
        faces.append([integer(t, file, n) for n, t in tokens[at + 1 : stop]])
        face_lines.append(line)
        at = max(stop, ends[tokens[stop - 1][0]]) if _is_color(tokens, stop, ends) else stop
    notes = ["its records are not a line each: read as a sequence of numbers"]
    if at < len(tokens):
        notes.append(f"ignored all after the last stated face (from line {tokens[at][0]})")
    sample = tokens[: values * n_points : max(1, values * n_points // SAMPLE)]
    return RawMesh.of(
        file, points, faces, point_lines, face_lines, notes, step=decimal_step(t for _, t in sample)
    )


def _is_color(tokens: list[tuple[int, str]], stop: int, ends: dict[int, int]) -> bool:
    """Whether the rest of the line in which a face ends is its color.

    A color is three or four numbers, of which one has a point, or which no face could begin with.
    """
    left = ends[tokens[stop - 1][0]] - stop
    if not 1 <= left <= 4:
        return False
    rest = [token for _, token in tokens[stop : stop + left]]
    return any("." in token for token in rest) or not rest[0].isdecimal() or int(rest[0]) < 3


def _size(token: str, file: str, line: int) -> int:
    size = integer(token, file, line, "number of corners")
    if size < 3:
        raise MeshError(f"a face needs three corners; {size} given", file=file, line=line)
    return size


def _axes(rows: list[Row], n_points: int) -> Floats | None:
    """(V, 3) the normals behind the coordinates."""
    try:
        table = [[float(token) for token in parts[3:6]] for _, parts in rows[:n_points]]
        axes = np.array(table, dtype=np.float64).reshape(n_points, 3)
    except ValueError:
        return None
    return axes if np.isfinite(axes).all() else None


def _head(rows: list[Row], file: str) -> tuple[tuple[int, int], int, int]:
    """Counts of vertices and faces, numbers a vertex has, and the row where the vertices begin."""
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
    while len(rest) < 3 and at < len(rows) and (len(rest) < 2 or len(rows[at][1]) == 1):
        line, more = rows[at]  # the counts may be spread over lines too
        rest += more
        at += 1
    if not rest:
        raise MeshError("truncated: the counts are missing", file=file, line=line)
    if len(rest) < 2:
        raise MeshError("numbers of vertices and faces are needed", file=file, line=line)
    counts = tuple(integer(token, file, line, "count") for token in rest[:2])
    if min(counts) < 0:
        raise MeshError(f"count {min(counts)} is negative", file=file, line=line)
    values = 3 + (3 if found[3] else 0) + (4 if found[2] else 0) + (2 if found[1] else 0)
    return (counts[0], counts[1]), values, at


def _from_one(raw: RawMesh) -> RawMesh:
    """Ids from 0, also where the file counts from 1."""
    if not len(raw.corners) or raw.corners.min() != 1 or raw.corners.max() != len(raw.points):
        return raw
    note = "the file counts vertices from 1, against the format: read so"
    return replace(raw, corners=raw.corners - 1, notes=[*raw.notes, note])


@checked
def write_off(
    path: str | Path, mesh: Mesh, *, units: str | None = None, axes: Floats | None = None
) -> None:
    """Write a mesh as OFF, atomically; coordinates as their shortest exact decimals.

    Parameters
    ----------
    units : written as a comment, which `read_mesh` understands
    axes : (V, 3) node axes, written as vertex normals (NOFF) with a comment that says so

    Raises
    ------
    InputError
        An unknown unit, or axes of the wrong shape.
    OutputError
        The file cannot be written; an old one is left as it was.
    """
    rows = ["OFF" if axes is None else "NOFF"]
    rows += [f"# {line}" for line in header_lines(mesh, units, axes)]
    rows += [f"{mesh.n_vertices} {mesh.n_faces} {mesh.n_edges}"]
    table = mesh.vertices if axes is None else np.hstack([mesh.vertices, axes])
    rows += [" ".join(map(repr, row)) for row in table.tolist()]
    rows += [f"{len(face)} " + " ".join(map(str, face.tolist())) for face in mesh.faces]
    with atomic_write(path) as stream:
        stream.write(("\n".join(rows) + "\n").encode("ascii"))

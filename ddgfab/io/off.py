"""OFF (Geomview object file format): polygons in, polygons out."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from itertools import chain, islice
from pathlib import Path

import numpy as np

from ddgfab.arguments import checked
from ddgfab.errors import MeshError
from ddgfab.io.atomic import atomic_write
from ddgfab.io.header import AXES_NOTE, comments_of, header_lines, stated_digest
from ddgfab.io.raw import RawMesh, Rows, check_count
from ddgfab.io.tokens import clip, decode, integer, token_rows
from ddgfab.io.units import stated_unit
from ddgfab.mesh import Floats, Mesh

_HEADER = re.compile(r"(ST)?(C)?(N)?(4)?(n)?OFF(\d*)$")
Row = tuple[int, list[str]]
Word = tuple[int, str]

HEAD_ROWS = 5
"""Header and counts stand in so many lines at most, if each has one word."""


def parse_off(data: bytes, file: str) -> RawMesh:
    """Vertices and polygons of an OFF, COFF, NOFF or STOFF file; colors are skipped.

    The word OFF may be missing. Counts may stand behind the header, even without a space between
    (found in ModelNet), or in the next line, with or without that of the edges. Line breaks mean
    nothing where the records are not a line each: then the numbers are read one after the other.
    Files that count vertices from 1 are against the format but found: when the ids run from 1 to
    the number of vertices and 0 never occurs, they are read so, with a note. Normals of a NOFF
    file count only where a comment says that they are node axes.

    Raises
    ------
    MeshError
        No OFF header, binary or four-dimensional files, fewer vertices or faces than stated,
        tokens that are not numbers.

    Source: Geomview manual, OFF files.
    """
    text = decode(data, file)
    comments = comments_of(text, "#")
    counts, values, at, rest = _head(list(islice(token_rows(text), HEAD_ROWS)), file)

    def body() -> Iterator[Row]:
        return chain(rest, islice(token_rows(text), at, None))

    if _line_each(body(), counts):
        raw = _by_lines(body(), counts, file)
    else:
        try:
            raw = _by_tokens(body(), counts, values, file)
        except MeshError:
            if _has_rows(body(), sum(counts)):  # a line for each record: what is wrong with one?
                _check_lines(body(), counts, file)
            raise
    axes = _axes(body(), counts[0]) if AXES_NOTE in comments and values >= 6 else None
    return replace(
        _from_one(raw),
        units=stated_unit(comments),
        axes=axes,
        axes_of=stated_digest(comments),
    )


def _line_each(rows: Iterator[Row], counts: tuple[int, int]) -> bool:
    """Whether every record has a line of its own."""
    for _ in range(counts[0]):
        if len(next(rows, (0, []))[1]) < 3:
            return False
    for _ in range(counts[1]):
        parts = next(rows, (0, [""]))[1]
        if not parts[0].isdecimal() or len(parts[0]) > 9 or len(parts) <= int(parts[0]):
            return False
    return True


def _has_rows(rows: Iterator[Row], count: int) -> bool:
    return sum(1 for _ in islice(rows, count)) == count


def _by_lines(body: Iterator[Row], counts: tuple[int, int], file: str) -> RawMesh:
    """The file where every record has a line of its own."""
    rows = Rows(file)
    for line, parts in islice(body, counts[0]):
        rows.vertex(parts[:3], line)
    for line, parts in islice(body, counts[1]):
        size = _size(parts[0], file, line)
        rows.face([integer(token, file, line) for token in parts[1 : size + 1]], line)
    return RawMesh.of(file, rows, _left_over(next(body, None)))


def _left_over(row: Row | None) -> list[str]:
    """The note of what stands behind the last stated face, if anything does."""
    return [] if row is None else [f"ignored all after the last stated face (from line {row[0]})"]


def _check_lines(rows: Iterator[Row], counts: tuple[int, int], file: str) -> None:
    """Raise for the first line that is not a record."""
    for line, parts in islice(rows, counts[0]):
        if len(parts) < 3:
            raise MeshError(
                f"a vertex needs three coordinates; {len(parts)} given", file=file, line=line
            )
    for line, parts in islice(rows, counts[1]):
        size = _size(parts[0], file, line)
        if len(parts) <= size:
            raise MeshError(
                f"a face of {size} corners names {len(parts) - 1} vertices", file=file, line=line
            )


class _Tokens:
    """The tokens of a file one after the other, with the lines they stand in."""

    def __init__(self, rows: Iterator[Row]) -> None:
        self._rows = rows
        self._row: list[str] = []
        self._at = 0
        self.line = 0

    def take(self, count: int) -> list[Word]:
        """The next tokens, fewer where the file ends."""
        found: list[Word] = []
        while len(found) < count and self.more():
            part = self._row[self._at : self._at + count - len(found)]
            self._at += len(part)
            found += [(self.line, token) for token in part]
        return found

    def more(self) -> bool:
        """Whether any word is left."""
        while self._at >= len(self._row):
            row = next(self._rows, None)
            if row is None:
                return False
            self.line, self._row = row
            self._at = 0
        return True

    def rest(self) -> list[str]:
        """What is left of the line of the last word."""
        return self._row[self._at :]

    def skip_rest(self) -> None:
        """Go on with the next line."""
        self._at = len(self._row)


def _by_tokens(body: Iterator[Row], counts: tuple[int, int], values: int, file: str) -> RawMesh:
    """The file as a sequence of numbers, whatever its lines; a face ends with its last corner.

    What follows the corners in the line of the last of them is the color of the face.
    """
    n_points, n_faces = counts
    stated = f"{n_points} vertices and {n_faces} faces are stated"
    tokens = _Tokens(body)
    rows = Rows(file)
    for have in range(n_points):
        words = tokens.take(values)
        if len(words) < values:
            raise MeshError(
                f"truncated: {stated}, {have} and 0 are there (a vertex needs "
                f"{'three coordinates' if values == 3 else f'{values} numbers'})",
                file=file,
                line=tokens.line or None,
            )
        rows.vertex([token for _, token in words[:3]], words[0][0])
    for face in range(n_faces):
        first = tokens.take(1)
        if not first:
            raise MeshError(
                f"truncated: {stated}, {n_points} and {face} are there",
                file=file,
                line=tokens.line or None,
            )
        line = first[0][0]
        size = _size(first[0][1], file, line)
        corners = tokens.take(size)
        if len(corners) < size:
            raise MeshError(
                f"truncated: a face of {size} corners names {len(corners)} vertices",
                file=file,
                line=line,
            )
        rows.face([integer(token, file, n) for n, token in corners], line)
        if _is_color(tokens.rest()):
            tokens.skip_rest()
    notes = ["its records are not a line each: read as a sequence of numbers"]
    if tokens.more():
        notes += _left_over((tokens.line, []))
    return RawMesh.of(file, rows, notes)


def _is_color(rest: list[str]) -> bool:
    """Whether the rest of the line in which a face ends is its color.

    A color is three or four numbers, of which one has a point, or which no face could begin with.
    """
    if not 1 <= len(rest) <= 4:
        return False
    first = rest[0]
    return (
        any("." in token for token in rest)
        or not first.isdecimal()
        or (len(first) < 10 and int(first) < 3)
    )


def _size(token: str, file: str, line: int) -> int:
    size = integer(token, file, line, "number of corners")
    if size < 3:
        raise MeshError(f"a face needs three corners; {size} given", file=file, line=line)
    return size


def _axes(rows: Iterator[Row], n_points: int) -> Floats | None:
    """(V, 3) the normals behind the coordinates."""
    try:
        table = [[float(token) for token in parts[3:6]] for _, parts in islice(rows, n_points)]
        axes = np.array(table, dtype=np.float64).reshape(n_points, 3)
    except ValueError:
        return None
    return axes if np.isfinite(axes).all() else None


def _head(rows: list[Row], file: str) -> tuple[tuple[int, int], int, int, list[Row]]:
    """Counts of vertices and faces, numbers a vertex has, and the row where the vertices begin.

    Vertices that begin in the line of the counts are the last that is returned.
    """
    if not rows:
        raise MeshError("holds nothing but comments", file=file)
    line, parts = rows[0]
    if parts[0].isdecimal() and len(parts) > 1 and parts[1].isdecimal():
        parts = ["OFF", *parts]  # Geomview takes files without the word too
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
    for count, what in zip(counts, ("vertices", "faces"), strict=True):
        check_count(count, what, file, line)
    values = 3 + (3 if found[3] else 0) + (4 if found[2] else 0) + (2 if found[1] else 0)
    left = [(line, rest[3:])] if len(rest) >= 6 else []
    return (counts[0], counts[1]), values, at, left


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

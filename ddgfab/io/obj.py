"""Wavefront OBJ: polygons in, polygons out."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

from ddgfab.arguments import checked
from ddgfab.errors import MeshError
from ddgfab.io.atomic import atomic_write
from ddgfab.io.raw import RawMesh, clip, decode, integer, number
from ddgfab.mesh import Mesh

_SILENT = frozenset({"vt", "vn", "vp", "o", "g", "s", "usemtl", "mtllib"})
_STATED = re.compile(r"#\s*(\d+)\s+vertices,\s*(\d+)\s+faces\s*$", re.MULTILINE)


def parse_obj(data: bytes, file: str) -> RawMesh:
    """Vertices and polygons of an OBJ file; everything else is ignored, and noted if geometry.

    Reads `v` with weights or colours, `f` as `1`, `1/2`, `1//3`, `1/2/3`, negative numbers,
    comments, continued lines, several objects, any line end, byte order marks.

    Raises
    ------
    MeshError
        A number that is none, vertex number 0, fewer than three corners, binary content, or fewer
        faces than the file's own head says.

    Source: Wavefront Advanced Visualizer manual, appendix B1 (object files).
    """
    text = decode(data, file)
    points: list[tuple[float, float, float]] = []
    faces: list[list[int]] = []
    point_lines: list[int] = []
    face_lines: list[int] = []
    ignored: Counter[str] = Counter()
    first: dict[str, int] = {}
    for line, content in _lines(text, file):
        parts = content.split()
        if not parts:
            continue
        key = parts[0]
        if key == "v":
            points.append(_point(parts, file, line))
            point_lines.append(line)
            if len(parts) != 4:
                kind = {5: "vertex weights", 7: "vertex colours", 8: "vertex colours"}
                ignored[kind.get(len(parts), "extra values at vertices")] += 1
                first.setdefault(kind.get(len(parts), "extra values at vertices"), line)
        elif key == "f" or key == "fo":
            faces.append(_polygon(parts, len(points), file, line))
            face_lines.append(line)
        elif key not in _SILENT:
            what = {"l": "polylines 'l'", "p": "points 'p'"}.get(key, f"lines '{clip(key)}'")
            ignored[what] += 1
            first.setdefault(what, line)
    stated = _STATED.search(text)
    if stated and (len(points) < int(stated[1]) or len(faces) < int(stated[2])):
        raise MeshError(
            f"truncated: its head says {stated[1]} vertices and {stated[2]} faces, "
            f"{len(points)} and {len(faces)} are there",
            file=file,
            line=text.count("\n") + 1,
        )
    notes = [f"ignored {n} {what} (first in line {first[what]})" for what, n in ignored.items()]
    return RawMesh.of(file, points, faces, point_lines, face_lines, notes)


def _lines(text: str, file: str) -> list[tuple[int, str]]:
    """Numbered lines without comments; a continued line has the number of its first part."""
    lines = list(enumerate(text.split("\n"), start=1))
    if "#" in text:
        lines = [(n, s.partition("#")[0] if "#" in s else s) for n, s in lines]
    if "\\" not in text:
        return lines
    joined: list[tuple[int, str]] = []
    pending: tuple[int, str] | None = None
    for n, content in lines:
        if pending is not None:
            n, content = pending[0], pending[1] + " " + content
            pending = None
        bare = content.rstrip()
        if bare.endswith("\\"):
            pending = (n, bare[:-1])
        else:
            joined.append((n, content))
    if pending is not None:
        raise MeshError("the file ends in a continued line: truncated", file=file, line=pending[0])
    return joined


def _point(parts: list[str], file: str, line: int) -> tuple[float, float, float]:
    if len(parts) < 4:
        raise MeshError(
            f"a vertex needs three coordinates; {len(parts) - 1} given", file=file, line=line
        )
    return number(parts[1], file, line), number(parts[2], file, line), number(parts[3], file, line)


def _polygon(parts: list[str], count: int, file: str, line: int) -> list[int]:
    """Vertex ids from 0; numbers below 0 count back from the vertices read so far."""
    if len(parts) < 4:
        raise MeshError(f"a face needs three corners; {len(parts) - 1} given", file=file, line=line)
    face = []
    for token in parts[1:]:
        index = integer(token.partition("/")[0] or token, file, line)
        if index == 0:
            raise MeshError("vertex number 0: OBJ counts from 1", file=file, line=line)
        if index < -count:
            raise MeshError(
                f"vertex number {index}: only {count} vertices stand before it",
                file=file,
                line=line,
            )
        face.append(index - 1 if index > 0 else count + index)
    return face


@checked
def write_obj(path: str | Path, mesh: Mesh) -> None:
    """Write a mesh as OBJ, atomically; coordinates as their shortest exact decimals.

    Raises
    ------
    OutputError
        The file cannot be written; an old one is left as it was.
    """
    rows = [f"# {mesh.n_vertices} vertices, {mesh.n_faces} faces"]
    rows += [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh.vertices.tolist()]
    rows += ["f " + " ".join(map(str, (face + 1).tolist())) for face in mesh.faces]
    with atomic_write(path) as stream:
        stream.write(("\n".join(rows) + "\n").encode("ascii"))

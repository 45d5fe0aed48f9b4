"""Wavefront OBJ: polygons in, polygons out; node axes as vertex normals."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ddgfab.arguments import checked
from ddgfab.errors import MeshError
from ddgfab.io.atomic import atomic_write
from ddgfab.io.header import AXES_NOTE, comments_of, header_lines
from ddgfab.io.raw import SAMPLE, RawMesh, decimal_step
from ddgfab.io.tokens import clip, decode, integer, number
from ddgfab.io.units import stated_unit
from ddgfab.io.wires import Wires, faces_of_wires
from ddgfab.mesh import Floats, Mesh

_SILENT = frozenset({"vt", "vp", "o", "g", "s", "usemtl", "mtllib"})
_FREEFORM = {"curv": "NURBS curves", "curv2": "NURBS curves in surfaces", "surf": "NURBS surfaces"}
_BETWEEN = frozenset(
    {"cstype", "deg", "bmat", "step", "parm", "trim", "hole", "scrv", "sp", "end", "con", "mg"}
    | {"bevel", "c_interp", "d_interp", "lod", "maplib", "usemap", "shadow_obj", "trace_obj"}
    | {"ctech", "stech", "bsp", "bzp", "cdc", "cdp", "res"}
)
_STATED = re.compile(r"#\s*(\d+)\s+vertices,\s*(\d+)\s+faces\s*$", re.MULTILINE)
_EXTRA = {5: "vertex weights", 7: "vertex colors", 8: "vertex colors"}


@dataclass
class _Content:
    """What has been read so far."""

    points: list[tuple[float, float, float]] = field(default_factory=list)
    tokens: list[list[str]] = field(default_factory=list)
    normals: list[tuple[float, float, float]] = field(default_factory=list)
    faces: list[list[int]] = field(default_factory=list)
    face_normals: list[list[int]] = field(default_factory=list)
    wires: list[list[int]] = field(default_factory=list)
    point_lines: list[int] = field(default_factory=list)
    face_lines: list[int] = field(default_factory=list)
    wire_lines: list[int] = field(default_factory=list)
    ignored: Counter[str] = field(default_factory=Counter)
    first: dict[str, int] = field(default_factory=dict)

    def ignore(self, what: str, line: int) -> None:
        """Count what is passed over, and keep where it stands first."""
        self.ignored[what] += 1
        self.first.setdefault(what, line)

    def notes(self) -> list[str]:
        """A sentence for each kind of thing that was passed over."""
        return [f"ignored {n} {what} (first in line {self.first[what]})" for what, n in
                self.ignored.items()]  # fmt: skip


def parse_obj(data: bytes, file: str) -> RawMesh:
    """Vertices and polygons of an OBJ file; what else is there is ignored, and noted if geometry.

    Reads `v` with weights or colors, `f` as `1`, `1/2`, `1//3`, `1/2/3`, negative numbers,
    comments, continued lines, several objects, any line end, byte order marks, a unit in a comment
    ("# units: m"). Vertex normals count only where a comment says that they are node axes. A file
    of lines `l` without faces becomes a mesh where they bound faces in a clear way.

    Raises
    ------
    MeshError
        A number that is none, vertex number 0, fewer than three corners, binary content, fewer
        faces than the file's own head says, no faces (and what there is instead).

    Source: Wavefront Advanced Visualizer manual, appendix B1 (object files).
    """
    text = decode(data, file)
    comments = comments_of(text, "#")
    with_axes = AXES_NOTE in comments
    read = _Content()
    for line, content in _lines(text, file):
        parts = content.split()
        if parts:
            _take(read, parts, with_axes, file, line)
    stated = _STATED.search(text)
    if stated and (len(read.points) < int(stated[1]) or len(read.faces) < int(stated[2])):
        raise MeshError(
            f"truncated: its head says {stated[1]} vertices and {stated[2]} faces, "
            f"{len(read.points)} and {len(read.faces)} are there",
            file=file,
            line=text.count("\n") + 1,
        )
    sample = read.tokens[:: max(1, 3 * len(read.tokens) // SAMPLE)]
    step = decimal_step(token for row in sample for token in row)
    if not read.faces:
        _faces_from_wires(read, step, file)
    return RawMesh.of(
        file,
        read.points,
        read.faces,
        read.point_lines,
        read.face_lines,
        read.notes(),
        step=step,
        units=stated_unit(comments),
        axes=_axes(read) if with_axes else None,
    )


def _take(read: _Content, parts: list[str], with_axes: bool, file: str, line: int) -> None:
    """One line of the file."""
    key = parts[0].lower()
    if key == "v":
        if len(parts) < 4:
            raise MeshError(
                f"a vertex needs three coordinates; {len(parts) - 1} given", file=file, line=line
            )
        read.points.append(_vector(parts, file, line))
        read.tokens.append(parts[1:4])
        read.point_lines.append(line)
        if len(parts) != 4:
            read.ignore(_EXTRA.get(len(parts), "extra values at vertices"), line)
    elif key in ("f", "fo"):
        if len(parts) < 4:
            raise MeshError(
                f"a face needs three corners; {len(parts) - 1} given", file=file, line=line
            )
        read.faces.append(_corners(parts, len(read.points), file, line))
        read.face_lines.append(line)
        if with_axes:
            read.face_normals.append(_normal_ids(parts, len(read.normals)))
    elif key == "vn":
        if with_axes and len(parts) == 4:
            read.normals.append(_vector(parts, file, line))
    elif key == "l" and len(parts) > 2:
        read.wires.append(_corners(parts, len(read.points), file, line))
        read.wire_lines.append(line)
        read.ignore("polylines 'l'", line)
    elif key in _FREEFORM:
        read.ignore(_FREEFORM[key], line)
    elif key not in _SILENT and key not in _BETWEEN:
        read.ignore({"p": "points 'p'"}.get(key, f"lines '{clip(key)}'"), line)


def _faces_from_wires(read: _Content, step: float, file: str) -> None:
    """Faces that lines bound, where a file has no others; otherwise says what there is."""
    skipped = ", ".join(f"{n} {what}" for what, n in read.ignored.items())
    if not read.wires:
        instead = f"; skipped {skipped}: export a mesh of polygons" if skipped else ""
        raise MeshError(
            f"the mesh has no faces ({len(read.points)} vertices{instead})",
            file=file,
        )
    wires = Wires.of(np.array(read.points).reshape(-1, 3), read.wires, step)
    faces, lines = faces_of_wires(wires, read.wire_lines, file)
    read.faces += faces
    read.face_lines += lines
    count = read.ignored.pop("polylines 'l'")
    read.ignore(f"faces made of {count} polylines 'l': the file has no faces of its own", lines[0])


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


def _vector(parts: list[str], file: str, line: int) -> tuple[float, float, float]:
    return number(parts[1], file, line), number(parts[2], file, line), number(parts[3], file, line)


def _corners(parts: list[str], count: int, file: str, line: int) -> list[int]:
    """Vertex ids from 0; numbers below 0 count back from the vertices read so far."""
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


def _normal_ids(parts: list[str], count: int) -> list[int]:
    """Ids of the normals at the corners, -1 where a corner has none."""
    ids = []
    for token in parts[1:]:
        text = token.split("/")[2] if token.count("/") == 2 else ""
        index = int(text) if text.lstrip("-").isdecimal() and len(text) < 12 else 0
        ids.append(index - 1 if index > 0 else count + index if index < 0 else -1)
    return ids


def _axes(read: _Content) -> Floats | None:
    """The axis of each vertex: the normal at its corners."""
    axes = np.zeros((len(read.points), 3))
    for face, ids in zip(read.faces, read.face_normals, strict=True):
        for vertex, index in zip(face, ids, strict=True):
            if not (0 <= index < len(read.normals) and vertex < len(axes)):
                return None
            axes[vertex] = read.normals[index]
    return axes


@checked
def write_obj(
    path: str | Path, mesh: Mesh, *, units: str | None = None, axes: Floats | None = None
) -> None:
    """Write a mesh as OBJ, atomically; coordinates as their shortest exact decimals.

    Parameters
    ----------
    units : written as a comment, which `read_mesh` understands
    axes : (V, 3) node axes, written as vertex normals with a comment that says so

    Raises
    ------
    InputError
        Something else than a mesh, an unknown unit, or axes of the wrong shape.
    OutputError
        The file cannot be written; an old one is left as it was.
    """
    head = header_lines(mesh, units, axes)
    rows = [f"# {line}" for line in [f"{mesh.n_vertices} vertices, {mesh.n_faces} faces", *head]]
    rows += [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh.vertices.tolist()]
    if axes is not None:
        rows += [f"vn {x!r} {y!r} {z!r}" for x, y, z in np.asarray(axes, dtype=float).tolist()]
    end = "" if axes is None else "//{0}"
    corner = "{0}" + end
    rows += ["f " + " ".join(corner.format(i) for i in (face + 1).tolist()) for face in mesh.faces]
    with atomic_write(path) as stream:
        stream.write(("\n".join(rows) + "\n").encode("ascii"))

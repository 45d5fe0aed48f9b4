"""Wavefront OBJ: polygons in, polygons out; node axes as vertex normals."""

from __future__ import annotations

import re
from array import array
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ddgfab.arguments import checked
from ddgfab.errors import MeshError
from ddgfab.io.atomic import atomic_write
from ddgfab.io.groups import GroupRows, Groups
from ddgfab.io.header import AXES_NOTE, comments_of, header_lines, stated_digest
from ddgfab.io.raw import RawMesh, Rows, check_count
from ddgfab.io.tokens import clip, decode, integer, number, numbered
from ddgfab.io.units import stated_unit
from ddgfab.io.wires import Wires, faces_of_wires
from ddgfab.mesh import Floats, Mesh

_SILENT = frozenset({"vt", "vp", "s", "usemtl", "mtllib"})
_FREEFORM = {"curv": "NURBS curves", "curv2": "NURBS curves in surfaces", "surf": "NURBS surfaces"}
_BETWEEN = frozenset(
    {"cstype", "deg", "bmat", "step", "parm", "trim", "hole", "scrv", "sp", "end", "con", "mg"}
    | {"bevel", "c_interp", "d_interp", "lod", "maplib", "usemap", "shadow_obj", "trace_obj"}
    | {"ctech", "stech", "bsp", "bzp", "cdc", "cdp", "res"}
)
_STATED = re.compile(
    r"#[ \t]*(\d{1,15})[ \t]+vertices,[ \t]*(\d{1,15})[ \t]+faces[ \t]*$", re.MULTILINE
)
HEAD_CHARACTERS = 65_536
"""What a file says of its own length is looked for in so many characters from its start."""

KINDS = 20
"""Kinds of unknown lines that are counted separately; a file that is not OBJ may hold any."""

_EXTRA = {5: "vertex weights", 7: "vertex colors", 8: "vertex colors"}


@dataclass
class _Content:
    """What has been read so far."""

    rows: Rows
    normals: array[float] = field(default_factory=lambda: array("d"))
    corner_normals: array[int] = field(default_factory=lambda: array("q"))
    wires: list[list[int]] = field(default_factory=list)
    wire_lines: list[int] = field(default_factory=list)
    ignored: Counter[str] = field(default_factory=Counter)
    first: dict[str, int] = field(default_factory=dict)
    taken: list[str] = field(default_factory=list)
    groups: GroupRows = field(default_factory=GroupRows)

    def ignore(self, what: str, line: int) -> None:
        """Count what is passed over, and keep where it stands first."""
        if what not in self.first and len(self.first) >= KINDS:
            what = "lines of other kinds"
        self.ignored[what] += 1
        self.first.setdefault(what, line)

    def notes(self) -> list[str]:
        """A sentence for each kind of thing that was passed over, or taken for another."""
        over = self.ignored.items()
        skipped = [f"ignored {n} {what} (first in line {self.first[what]})" for what, n in over]
        return skipped + self.taken


def parse_obj(data: bytes, file: str) -> RawMesh:
    """Vertices and polygons of an OBJ file; what else is there is ignored, and noted if geometry.

    Reads `v` with weights or colors, `f` as `1`, `1/2`, `1//3`, `1/2/3`, negative numbers,
    comments, continued lines, several objects, any line end, byte order marks, a unit in a comment
    ("# units: m"). Vertex normals count only where a comment says that they are node axes. A file
    of lines `l` without faces becomes a mesh where they bound faces in a clear way. Faces, lines
    and points `p` below `g` or `o` make groups.

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
    rows = Rows(file)
    read = _Content(rows)
    for line, content in _lines(text, file):
        parts = content.split()
        if parts:
            _take(read, parts, with_axes, file, line)
    stated = _STATED.search(text, 0, HEAD_CHARACTERS)
    points, faces = len(rows.point_lines), len(rows.sizes)
    if stated and (points < int(stated[1]) or faces < int(stated[2])):
        raise MeshError(
            f"truncated: its head says {stated[1]} vertices and {stated[2]} faces, "
            f"{points} and {faces} are there",
            file=file,
            line=text.count("\n") + 1,
        )
    if not faces:
        _faces_from_wires(read, file)
    return RawMesh.of(
        file,
        rows,
        read.notes(),
        units=stated_unit(comments),
        axes=_axes(read) if with_axes else None,
        axes_of=stated_digest(comments),
        groups=read.groups.groups(points),
    )


def _take(read: _Content, parts: list[str], with_axes: bool, file: str, line: int) -> None:
    """One line of the file."""
    key = parts[0].lower()
    if key == "v":
        if len(parts) < 4:
            raise MeshError(
                f"a vertex needs three coordinates; {len(parts) - 1} given", file=file, line=line
            )
        read.rows.vertex(parts[1:4], line)
        if len(parts) != 4:
            read.ignore(_EXTRA.get(len(parts), "extra values at vertices"), line)
    elif key in ("f", "fo"):
        if len(parts) < 4:
            raise MeshError(
                f"a face needs three corners; {len(parts) - 1} given", file=file, line=line
            )
        face = _corners(parts, len(read.rows.point_lines), file, line)
        read.rows.face(face, line)
        read.groups.add(face, closed=True)
        if with_axes:
            read.corner_normals.extend(_normal_ids(parts, len(read.normals) // 3))
    elif key == "vn":
        if with_axes and len(parts) == 4:
            read.normals.extend(_vector(parts, file, line))
    elif key == "l" and len(parts) > 2:
        wire = _corners(parts, len(read.rows.point_lines), file, line)
        read.wires.append(wire)
        read.wire_lines.append(line)
        check_count(len(read.wires), "lines 'l'", file, line)
        if not read.groups.add(wire):
            read.ignore("polylines 'l'", line)
    elif key in ("g", "o"):
        read.groups.name(key, parts[1:])
    elif key == "p" and read.groups.named:
        for point in _corners(parts, len(read.rows.point_lines), file, line):
            read.groups.add([point])
    elif key in _FREEFORM:
        read.ignore(_FREEFORM[key], line)
    elif key not in _SILENT and key not in _BETWEEN:
        read.ignore({"p": "points 'p'"}.get(key, f"lines '{clip(key)}'"), line)


def _faces_from_wires(read: _Content, file: str) -> None:
    """Faces that lines bound, where a file has no others; otherwise says what there is."""
    rows = read.rows
    skipped = ", ".join(f"{n} {what}" for what, n in read.ignored.items())
    if not read.wires:
        instead = f"; skipped {skipped}: export a mesh of polygons" if skipped else ""
        raise MeshError(
            f"the mesh has no faces ({len(rows.point_lines)} vertices{instead})",
            file=file,
        )
    points = np.array(rows.points, dtype=np.float64).reshape(-1, 3)
    wires = Wires.of(points, read.wires, rows.digits.step, file)
    faces, lines = faces_of_wires(wires, read.wire_lines, file)
    for face, line in zip(faces, lines, strict=True):
        rows.face(face, line)
    read.ignored.pop("polylines 'l'", 0)
    read.taken.append(
        f"the file has no faces of its own: {len(faces)} faces were made of its "
        f"{len(read.wires)} polylines "
        f"'l' (first in line {lines[0]})"
    )


def _lines(text: str, file: str) -> Iterator[tuple[int, str]]:
    """Numbered lines without comments; a continued line has the number of its first part."""
    parts: list[str] = []
    first = last = 0
    for line, content in numbered(text):
        bare = content.partition("#")[0].rstrip() if "#" in content else content.rstrip()
        if parts and line > last + 1:  # a blank line ends what was to be continued
            yield first, " ".join(parts)
            parts = []
        first, last = (first if parts else line), line
        if bare.endswith("\\"):
            parts.append(bare[:-1])
        else:
            yield first, " ".join([*parts, bare])
            parts = []
    if parts and text.count("\n") + 1 == last:
        raise MeshError("the file ends in a continued line: truncated", file=file, line=first)
    if parts:
        yield first, " ".join(parts)


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
        index = int(text) if text.removeprefix("-").isdecimal() and len(text) < 12 else 0
        ids.append(index - 1 if index > 0 else count + index if index < 0 else -1)
    return ids


def _axes(read: _Content) -> Floats | None:
    """The axis of each vertex: the normal at its corners."""
    axes = np.zeros((len(read.rows.point_lines), 3))
    normals = np.array(read.normals, dtype=np.float64).reshape(-1, 3)
    vertices = np.array(read.rows.corners, dtype=np.int64)
    ids = np.array(read.corner_normals, dtype=np.int64)
    if len(ids) != len(vertices) or not ((ids >= 0) & (ids < len(normals))).all():
        return None
    if not ((vertices >= 0) & (vertices < len(axes))).all():
        return None
    axes[vertices] = normals[ids]
    return axes


@checked
def write_obj(
    path: str | Path,
    mesh: Mesh,
    *,
    units: str | None = None,
    axes: Floats | None = None,
    groups: Groups | None = None,
) -> None:
    """Write a mesh as OBJ, atomically; coordinates as their shortest exact decimals.

    Parameters
    ----------
    units : written as a comment, which `read_mesh` understands
    axes : (V, 3) node axes, written as vertex normals with a comment that says so
    groups : written after the faces, as points `p` and lines `l` below `g`

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
    rows += [] if groups is None else groups.lines()
    with atomic_write(path) as stream:
        stream.write(("\n".join(rows) + "\n").encode("ascii"))

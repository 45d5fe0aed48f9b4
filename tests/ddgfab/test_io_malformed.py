"""Files that cannot be used: one clear message with file, line and reason, never a traceback."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ddgfab.errors import MeshError
from ddgfab.io import read_mesh, write_obj, write_off, write_ply
from ddgfab.mesh import Mesh

V = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"  # lines 1 to 4
OFF_V = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
PLY = (
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
)  # nine lines

# suffix, content, line, part of the reason
TABLE: list[tuple[str, str | bytes, int | None, str]] = [
    ("obj", "", None, "the file is empty"),
    ("obj", " \n\n", None, "the file is empty"),
    ("obj", V, None, "no faces"),
    ("obj", "# nothing here\n", None, "no faces"),
    ("obj", "hello world\n", None, "no faces"),
    ("obj", V + "f 1 2 9\n", 5, "names vertex 8"),
    ("obj", V + "f 1 2 3 4\nf 1 2 0\n", 6, "OBJ counts from 1"),
    ("obj", V + "f 1 2 -5\n", 5, "only 4 vertices stand before it"),
    ("obj", V + "f 1 2 x\n", 5, "'x' is not a vertex number"),
    ("obj", V + "f 1 2 3.5\n", 5, "'3.5' is not a vertex number"),
    ("obj", V + "f 1 2 /3\n", 5, "'/3' is not a vertex number"),
    ("obj", V + "f 1 2 1_0\n", 5, "'1_0' is not a vertex number"),
    ("obj", V + "f 1 2\n", 5, "three corners; 2 given"),
    ("obj", V + "f\n", 5, "three corners; 0 given"),
    ("obj", V + "f 1 2 3 4\nf 1 2 \\\n 3 2\n", 6, "repeats vertex 1"),
    ("obj", V + "f 1 2 3 4 2\n", 5, "repeats vertex 1"),
    ("obj", V + "f 1 2 \\\n", 5, "three corners; 2 given"),
    ("obj", V + "f 1 2 3 \\", 5, "truncated"),
    ("obj", V + "v 1e61 0 0\nf 1 2 5\n", 5, "vertex 4 has a coordinate beyond 1e+60"),
    ("obj", V + "v 1 nan 0\nf 1 2 3\n", 5, "'nan' is not finite"),
    ("obj", V + "v 1 -inf 0\nf 1 2 3\n", 5, "'-inf' is not finite"),
    ("obj", V + "v 1 1e999 0\nf 1 2 3\n", 5, "'1e999' is not finite"),
    ("obj", V + "v 1 2\nf 1 2 3\n", 5, "three coordinates; 2 given"),
    ("obj", V + "v 1,5 0 0\nf 1 2 3\n", 5, "'1,5' is not a number: decimals need a point"),
    ("obj", V + "v 1 abc 0\nf 1 2 3\n", 5, "'abc' is not a number"),
    ("obj", V + "v 1 1_0 0\nf 1 2 3\n", 5, "'1_0' is not a number"),
    ("obj", V + "v 1 " + "9x" * 99 + " 0\nf 1 2 3\n", 5, "..."),
    ("obj", V + "v 2 0 0\nf 1 2 3 4\nf 1 2 5\n", 7, "face 1 has no area"),
    ("obj", V + "f 1 2 4 3\n", 5, "outline crosses itself"),
    ("obj", V + "f 1 2 3\nf 2 3 1\n", 6, "face 1 has the same vertices as face 0"),
    ("obj", V + "v 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 2 5\n", 8, "edge 0-1 is not manifold"),
    ("obj", b"\x7fELF\x00\x01\x02 f 1 2 3\n", 1, "binary data"),
    ("obj", V.encode() + b"f 1 2 3\n\x00\x01", 6, "binary data"),
    ("obj", "# 4 vertices, 2 faces\n" + V + "f 1 2 3\n", 7, "truncated: its head says 4"),
    ("off", "", None, "the file is empty"),
    ("off", "# nothing\n", None, "nothing but comments"),
    ("off", "solid\n4 1 0\n", 1, "'solid'"),
    ("off", "4OFF\n4 1 0\n", 1, "another dimension"),
    ("off", "nOFF 5\n4 1 0\n", 1, "another dimension"),
    ("off", "OFF BINARY\n", 1, "binary OFF"),
    ("off", "OFF\n", 1, "counts are missing"),
    ("off", "OFF\n4\n", 2, "numbers of vertices and faces"),
    ("off", "OFF\n4 -1 0\n" + OFF_V, 2, "count -1 is negative"),
    ("off", "OFF\n4 x 0\n" + OFF_V, 2, "'x' is not a count"),
    ("off", "OFF\n4 2 0\n" + OFF_V + "4 0 1 2 3\n", 7, "4 vertices and 2 faces are stated"),
    ("off", "OFF\n9 1 0\n" + OFF_V, 6, "truncated"),
    ("off", "OFF\n4 1 0\n" + OFF_V + "4 0 1 2\n", 7, "4 corners names 3 vertices"),
    ("off", "OFF\n4 1 0\n" + OFF_V + "2 0 1\n", 7, "three corners; 2 given"),
    ("off", "OFF\n4 1 0\n" + OFF_V + "4 0 1 2 4\n", 7, "names vertex 4"),
    ("off", "OFF\n4 1 0\n" + OFF_V + "3 -1 1 2\n", 7, "names vertex -1"),
    ("off", "OFF\n4 1 0\n" + OFF_V.replace("1 1 0", "1 one 0") + "3 0 1 2\n", 5, "'one'"),
    ("off", "OFF\n4 1 0\n" + OFF_V.replace("1 1 0", "1 1") + "3 0 1 2\n", 5, "three coordinates"),
    ("off", "OFF\n4 0 0\n" + OFF_V, None, "no faces"),
    ("ply", "solid\n", 1, "starts with a line 'ply'"),
    ("ply", "ply\nformat ascii 1.0\n", 2, "no end_header"),
    ("ply", PLY.replace("ascii", "binary_middle_endian"), 2, "binary_middle_endian"),
    ("ply", PLY.replace("property float z\n", ""), 8, "no properties x, y and z"),
    ("ply", PLY.replace("vertex_indices", "corners"), 9, "vertex_indices or vertex_index"),
    ("ply", PLY.replace("int vertex", "float vertex"), 9, "vertex_indices or vertex_index"),
    ("ply", PLY.replace("list uchar", "list float"), 8, "cannot read 'property list float"),
    ("ply", PLY.replace("float y", "real y"), 5, "cannot read 'property real y'"),
    ("ply", PLY.replace("float y", "float x"), 5, "cannot read 'property float x'"),
    ("ply", PLY.replace("element face 1", "element face"), 7, "cannot read 'element face'"),
    ("ply", PLY.replace("vertex 4", "vertex -4"), 3, "cannot read 'element vertex -4'"),
    ("ply", PLY.replace("vertex 4", "vertex many"), 3, "'many' is not a count"),
    ("ply", PLY.replace("element face 1", "element skin 1"), 9, "no element 'face'"),
    ("ply", PLY.replace("format ascii 1.0\n", ""), 8, "names no format"),
    ("ply", PLY + OFF_V, 13, "truncated: 1 of 'face' are stated, 0 are there"),
    ("ply", PLY + OFF_V + "4 0 1 2\n", 14, "'vertex_indices' are missing"),
    ("ply", PLY + OFF_V + "4 0 1 2 7\n", 14, "names vertex 7"),
    ("ply", PLY + OFF_V + "-1 0 1 2\n", 14, "'vertex_indices' are missing"),
    ("ply", PLY + OFF_V.replace("1 1 0", "1 1") + "3 0 1 2\n", 12, "'z' are missing"),
    ("ply", PLY + OFF_V.replace("1 1 0", "1 ? 0") + "3 0 1 2\n", 12, "'?' is not a number"),
    ("ply", PLY + OFF_V + "2 0 1\n", 14, "face 0 has 2 corners"),
    ("ply", PLY.encode() + b"\n\n0 0 \x00", 12, "binary data"),
    ("stl", "solid\n", None, "0 corners are there, and endsolid is missing"),
    ("abc", "solid\n", None, "unknown kind of mesh file '.abc'; known: .obj, .off, .ply, .stl"),
    ("step", "ISO-10303-21;\n", None, "mesh it in your CAD program and export a polygon mesh"),
    ("json", "{", 1, "is not JSON"),
    ("json", '{"value": 3}', None, "holds no mesh of COMPAS"),
]


@pytest.mark.parametrize(
    ("suffix", "content", "line", "reason"), TABLE, ids=[f"{r[0]}: {r[3]}" for r in TABLE]
)
def test_malformed_files_name_file_line_and_reason(
    suffix: str, content: str | bytes, line: int | None, reason: str, tmp_path: Path
) -> None:
    path = tmp_path / f"bad.{suffix}"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    with pytest.raises(MeshError) as caught:
        read_mesh(path)
    message = str(caught.value)
    assert reason in message
    assert caught.value.file == str(path)
    assert caught.value.line == line
    assert message.startswith(f"{path}: " if line is None else f"{path}:{line}: ")
    assert message.count("\n") < 3


def test_missing_folder_and_too_big_files(tmp_path: Path) -> None:
    with pytest.raises(MeshError, match="no such file"):
        read_mesh(tmp_path / "none.obj")
    (tmp_path / "folder.obj").mkdir()
    with pytest.raises(MeshError, match="this is a folder"):
        read_mesh(tmp_path / "folder.obj")
    path = tmp_path / "a.obj"
    path.write_text(V + "f 1 2 3 4\n")
    size = path.stat().st_size
    assert read_mesh(path, limit_bytes=size).faces == 1
    with pytest.raises(MeshError, match=f"{size} bytes exceed the limit of {size - 1}"):
        read_mesh(path, limit_bytes=size - 1)


def prism() -> Mesh:
    """Quads and triangles, so that binary files have records of several lengths."""
    points = [[0.5, 0, 0], [1, 0, 0.25], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]]
    return Mesh.build(points, [[0, 2, 1], [3, 4, 5], [0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]])


@pytest.mark.parametrize("kind", ["obj", "off", "ply", "ply text"])
def test_no_damage_ends_in_anything_but_a_mesh_or_a_mesh_error(kind: str, tmp_path: Path) -> None:
    path = tmp_path / f"a.{kind[:3]}"
    if kind == "obj":
        write_obj(path, prism())
    elif kind == "off":
        write_off(path, prism())
    else:
        write_ply(path, prism(), binary=kind == "ply")
    whole = path.read_bytes()
    rng = np.random.default_rng(1)
    damaged = [whole[:cut] for cut in range(0, len(whole), 3)]
    for _ in range(300):
        data = bytearray(whole)
        for at in rng.integers(0, len(data), size=rng.integers(1, 4)):
            data[at] = rng.integers(0, 256)
        damaged.append(bytes(data))
    refused = []
    for data in damaged:
        path.write_bytes(data)
        try:
            mesh = read_mesh(path).mesh
        except MeshError as error:
            refused.append(str(error))
        else:
            mesh.validate()
    assert len(refused) > 100
    assert all(message.startswith(str(path)) for message in refused)


@pytest.mark.parametrize("kind", ["obj", "off", "ply"])
def test_every_truncation_of_our_own_files_is_noticed(kind: str, tmp_path: Path) -> None:
    path = tmp_path / f"a.{kind}"
    {"obj": write_obj, "off": write_off, "ply": write_ply}[kind](path, prism())
    whole = path.read_bytes()
    for cut in range(len(whole)):
        path.write_bytes(whole[:cut])
        try:
            result = read_mesh(path)
        except MeshError:
            continue
        # A cut within the last face may leave a face; then at least the reader is told.
        assert len(result.notes) == 1
        assert "the last line has no line break" in result.notes[0]

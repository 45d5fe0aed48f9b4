"""Reading: every spelling of the same square pair gives the same mesh."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from ddgfab.errors import MeshError
from ddgfab.io import ReadResult, read_mesh

POINTS = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 1], [2, 1, 1]]
FACES = [[0, 1, 2, 3], [1, 4, 5, 2]]

V = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 1\nv 2 1 1\n"
F = "f 1 2 3 4\nf 2 5 6 3\n"

OBJ_SPELLINGS: dict[str, str | bytes] = {
    "plain": V + F,
    "texture": V + "vt 0 0\nvt 1 0\nf 1/1 2/2 3/1 4/2\nf 2/1 5/1 6/1 3/1\n",
    "normal": V + "vn 0 0 1\nf 1//1 2//1 3//1 4//1\nf 2//1 5//1 6//1 3//1\n",
    "both": V + "vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1 4/1/1\nf 2/1/1 5/1/1 6/1/1 3/1/1\n",
    "negative": V + "f -6 -5 -4 -3\nf -5 -2 -1 -4\n",
    "negative, interleaved": "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf -4 -3 -2 -1\n"
    "v 2 0 1\nv 2 1 1\nf -5 -2 -1 -4\n",
    "faces first": F + V,
    "comments": "# a\n#b\n" + V.replace("v 1 1 0", "v 1 1 0 # corner") + "\n  \n" + F + "# end\n",
    "crlf": (V + F).replace("\n", "\r\n"),
    "old mac": (V + F).replace("\n", "\r"),
    "bom": b"\xef\xbb\xbf" + (V + F).encode(),
    "utf-16": ("\ufeff" + V + F).encode("utf-16-le"),
    "latin-1 name": b"o Stra\xdfe\n" + (V + F).encode(),
    "continued": V + "f 1 2 \\\n 3 4\nf 2 \\\n5 \\\n6 3\n",
    "groups": "mtllib a.mtl\no one\n" + V + "g left\nusemtl red\ns off\nf 1 2 3 4\n"
    "g right\nf 2 5 6 3\n",
    "tabs and indents": "  " + (V + F).replace(" ", "\t"),
    "exponents": V.replace("v 2 0 1", "v +2.0e0 0.E0 1d0".replace("1d0", "100e-2")) + F,
}


def read(tmp_path: Path, content: str | bytes, name: str = "a.obj", **options: float) -> ReadResult:
    path = tmp_path / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return read_mesh(path, **options)  # type: ignore[arg-type]


def same(result: ReadResult) -> bool:
    faces = [face.tolist() for face in result.mesh.faces]
    return bool((result.mesh.vertices == POINTS).all()) and faces == FACES


@pytest.mark.parametrize("name", OBJ_SPELLINGS)
def test_spellings_of_obj(name: str, tmp_path: Path) -> None:
    result = read(tmp_path, OBJ_SPELLINGS[name])
    assert same(result)
    assert result.notes == ()
    assert (result.vertices, result.faces) == (6, 2)


@pytest.mark.parametrize(
    ("content", "note"),
    [
        (V + "l 1 2 3\n" + F + "l 1 2\n", "ignored 2 polylines 'l' (first in line 7)"),
        (V + "p 1\n" + F, "ignored 1 points 'p' (first in line 7)"),
        (V.replace("v 0 0 0", "v 0 0 0 1.0") + F, "ignored 1 vertex weights (first in line 1)"),
        (
            V.replace("v 1 0 0", "v 1 0 0 .5 .5 .5") + F,
            "ignored 1 vertex colors (first in line 2)",
        ),
        (
            (V + F).rstrip(),
            "the last line has no line break: if the file was cut off, look there",
        ),
        (V + "curv 0 1 2\n" + F, "ignored 1 NURBS curves (first in line 7)"),
    ],
)
def test_what_obj_holds_besides_is_ignored_and_noted(
    content: str, note: str, tmp_path: Path
) -> None:
    result = read(tmp_path, content)
    assert same(result)
    assert result.notes == (note,)


OFF_V = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 0 1\n2 1 1\n"
OFF_F = "4 0 1 2 3\n4 1 4 5 2\n"
OFF_SPELLINGS = {
    "plain": "OFF\n6 2 7\n" + OFF_V + OFF_F,
    "counts on the first line": "OFF 6 2 7\n" + OFF_V + OFF_F,
    "no space before the counts": "OFF6 2 7\n" + OFF_V + OFF_F,
    "no edge count": "OFF\n6 2\n" + OFF_V + OFF_F,
    "comments": "# made by hand\nOFF # kind\n\n6 2 0 # counts\n" + OFF_V + "# faces\n" + OFF_F,
    "colours": "COFF\n6 2 0\n" + OFF_V.replace("\n", " 255 0 0 255\n") + OFF_F,
    "normals": "NOFF\n6 2 0\n" + OFF_V.replace("\n", " 0 0 1\n") + OFF_F,
    "face colours": "OFF\n6 2 0\n" + OFF_V + OFF_F.replace("\n", " 0.5 0.5 0.5\n"),
    "crlf": ("OFF\n6 2 7\n" + OFF_V + OFF_F).replace("\n", "\r\n"),
    "lower case": "off\n6 2 7\n" + OFF_V + OFF_F,
}


@pytest.mark.parametrize("name", OFF_SPELLINGS)
def test_spellings_of_off(name: str, tmp_path: Path) -> None:
    result = read(tmp_path, OFF_SPELLINGS[name], "a.off")
    assert same(result)
    assert result.notes == ()


def test_off_that_counts_from_one_is_read_so_and_noted(tmp_path: Path) -> None:
    result = read(tmp_path, "OFF\n6 2 0\n" + OFF_V + "4 1 2 3 4\n4 2 5 6 3\n", "a.off")
    assert same(result)
    assert len(result.notes) == 1
    assert "counts vertices from 1" in result.notes[0]


def test_off_rest_is_noted(tmp_path: Path) -> None:
    result = read(tmp_path, "OFF\n6 2 0\n" + OFF_V + OFF_F + "more\n", "a.off")
    assert result.notes == ("ignored all after the last stated face (from line 11)",)


PLY_HEAD = (
    "ply\nformat {format} 1.0\ncomment made by hand\nelement vertex 6\nproperty float x\n"
    "property float y\nproperty uchar red\nproperty float z\n{between}"
    "element face 2\nproperty list uchar int {name}\nproperty uchar flag\nend_header\n"
)


def ply(
    format: str,
    *,
    faces: list[list[int]] = FACES,
    name: str = "vertex_indices",
    edges: bool = False,
    crlf: bool = False,
) -> bytes:
    between = (
        "element edge 1\nproperty int vertex1\nproperty list uchar short other\n" if edges else ""
    )
    head = PLY_HEAD.format(format=format, name=name, between=between)
    if format == "ascii":
        rows = [f"{x} {y} 7 {z}" for x, y, z in POINTS]
        rows += ["3 2 1 0"] if edges else []
        rows += [f"{len(f)} {' '.join(map(str, f))} 9" for f in faces]
        text = head + "\n".join(rows) + "\n"
        return (text.replace("\n", "\r\n") if crlf else text).encode()
    order = "<" if "little" in format else ">"
    body = b""
    for x, y, z in POINTS:
        body += np.array([x, y], order + "f4").tobytes() + b"\x07"
        body += np.array([z], order + "f4").tobytes()
    if edges:
        body += np.array([3], order + "i4").tobytes() + b"\x02"
        body += np.array([1, 0], order + "i2").tobytes()
    for face in faces:
        body += bytes([len(face)]) + np.array(face, order + "i4").tobytes() + b"\x09"
    return head.encode() + body


FORMATS = ["ascii", "binary_little_endian", "binary_big_endian"]


@pytest.mark.parametrize("format", FORMATS)
@pytest.mark.parametrize("edges", [False, True])
@pytest.mark.parametrize("name", ["vertex_indices", "vertex_index"])
def test_spellings_of_ply(format: str, edges: bool, name: str, tmp_path: Path) -> None:
    result = read(tmp_path, ply(format, edges=edges, name=name), "a.ply")
    assert same(result)
    assert result.notes == (("ignored 1 elements 'edge'",) if edges else ())


@pytest.mark.parametrize("format", FORMATS)
def test_ply_with_mixed_polygons(format: str, tmp_path: Path) -> None:
    faces = [[0, 1, 2, 3], [1, 4, 2]]
    # The sixth vertex is used by no face, so it goes.
    result = read(tmp_path, ply(format, faces=faces), "a.ply")
    assert [face.tolist() for face in result.mesh.faces] == faces
    assert result.notes == ("removed 1 vertex that no face uses",)


def test_ply_text_with_windows_line_ends(tmp_path: Path) -> None:
    assert same(read(tmp_path, ply("ascii", crlf=True), "a.ply"))


def test_scale_digest_and_suffix_case(tmp_path: Path) -> None:
    result = read(tmp_path, V + F, "A.OBJ", scale=1000.0)
    assert result.mesh.vertices.max() == 2000.0
    assert result.sha256 == hashlib.sha256((V + F).encode()).hexdigest()
    assert result.file.endswith("A.OBJ")
    for scale in (0.0, -1.0, float("nan")):
        with pytest.raises(MeshError, match="positive number"):
            read(tmp_path, V + F, scale=scale)


def test_meshes_of_others_are_read_without_remark(mesh_file: Callable[[str], Path]) -> None:
    counts = {
        "conical1.obj": (1147, 1080),
        "six_quad.obj": (720, 656),
        "botanic_garden_bubble.obj": (1121, 1076),
        "heart.obj": (441, 400),
        "quad_dome.obj": (57, 48),
        "tri_dome.obj": (91, 160),
    }
    for name, expected in counts.items():
        result = read_mesh(mesh_file(name))
        assert (result.mesh.n_vertices, result.mesh.n_faces) == expected
        assert result.notes == ()

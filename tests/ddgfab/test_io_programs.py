"""Files as trimesh 5.2, meshio 5.3, COMPAS 2.15 and Rhino write them: two quads, or triangles.

The first three programs wrote them from one mesh; the COMPAS scene is without its other colors.
Rhino's OBJ is in the form of its exporter, and one file counts its corners back from the end.
"""

from __future__ import annotations

import base64
from pathlib import Path

import numpy as np
import pytest

from ddgfab.errors import MeshError
from ddgfab.io import read_mesh
from ddgfab.mesh import Mesh

POINTS = [[0, 0, 0], [2, 0, 0], [2, 1.5, 0], [0, 1.5, 0], [4, 0, 0.25], [4, 1.5, 0.25]]
QUADS = [[0, 1, 2, 3], [1, 4, 5, 2]]
TRIANGLES = [[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]]

TRIMESH_OBJ = """\
# https://github.com/mikedh/trimesh
v 0.00000000 0.00000000 0.00000000
v 2.00000000 0.00000000 0.00000000
v 2.00000000 1.50000000 0.00000000
v 0.00000000 1.50000000 0.00000000
v 4.00000000 0.00000000 0.25000000
v 4.00000000 1.50000000 0.25000000
vn 0.00000000 0.00000000 1.00000000
vn -0.06213744 0.00000000 0.99806760
vn -0.06213744 0.00000000 0.99806760
vn 0.00000000 0.00000000 1.00000000
vn -0.12403473 0.00000000 0.99227788
vn -0.12403473 0.00000000 0.99227788
f 1//1 2//2 3//3
f 1//1 3//3 4//4
f 2//2 5//5 6//6
f 2//2 6//6 3//3
"""
MESHIO_OBJ = """\
# Created by meshio v5.3.5, 2026-11-29T14:52:35.954479
v 0.0 0.0 0.0
v 2.0 0.0 0.0
v 2.0 1.5 0.0
v 0.0 1.5 0.0
v 4.0 0.0 0.25
v 4.0 1.5 0.25
f 1 2 3 4
f 2 5 6 3
"""
COMPAS_OBJ = """\
# OBJ
# COMPAS
# version: 2.15.1
# precision: 3
# V F E: 6 2 7

o Mesh 0
v 0.000 0.000 0.000
v 2.000 0.000 0.000
v 2.000 1.500 0.000
v 0.000 1.500 0.000
v 4.000 0.000 0.250
v 4.000 1.500 0.250
f 1 2 3 4
f 2 5 6 3
"""
RHINO_OBJ = """\
# Rhino

mtllib roof.mtl
g Roof Default
usemtl Default
v 0 0 0
v 2 0 0
v 2 1.5 0
v 0 1.5 0
v 4 0 0.25
v 4 1.5 0.25
vt 0 0
vt 0.5 0
vt 0.5 1
vt 0 1
vt 1 0
vt 1 1
vn 0 0 1
vn -0.062137437 0 0.99806762
vn -0.062137437 0 0.99806762
vn 0 0 1
vn -0.12403473 0 0.9922779
vn -0.12403473 0 0.9922779
s off
f 1/1/1 2/2/2 3/3/3 4/4/4
g Porch Default
f 2/2/2 5/5/5 6/6/6 3/3/3
"""
COUNTED_BACK_OBJ = """\
o first
v 0 0 0
v 2 0 0
v 2 1.5 0
v 0 1.5 0
vn 0 0 1
f -4//-1 -3//-1 -2//-1 -1//-1
o second
v 4 0 0.25
v 4 1.5 0.25
vn -0.12403473 0 0.9922779
f -5//-1 -2//-1 -1//-1 -4//-1
"""
TRIMESH_OFF = """\
OFF
6 4 0
0.0000000000 0.0000000000 0.0000000000
2.0000000000 0.0000000000 0.0000000000
2.0000000000 1.5000000000 0.0000000000
0.0000000000 1.5000000000 0.0000000000
4.0000000000 0.0000000000 0.2500000000
4.0000000000 1.5000000000 0.2500000000
3 0 1 2
3 0 2 3
3 1 4 5
3 1 5 2
"""
MESHIO_OFF = """\
OFF
# Created by meshio

6 4 0

0.0 0.0 0.0
2.0 0.0 0.0
2.0 1.5 0.0
0.0 1.5 0.0
4.0 0.0 0.25
4.0 1.5 0.25
3 0 1 2
3 0 2 3
3 1 4 5
3 1 5 2
"""
TRIMESH_PLY_HEAD = """\
ply
format {} 1.0
comment https://github.com/mikedh/trimesh
element vertex 6
property float x
property float y
property float z
property float nx
property float ny
property float nz
element face 4
property list uchar int vertex_indices
end_header
"""
TRIMESH_PLY_BODY = """\
0.00000000 0.00000000 0.00000000 0.00000000 0.00000000 1.00000000
2.00000000 0.00000000 0.00000000 -0.06213744 0.00000000 0.99806762
2.00000000 1.50000000 0.00000000 -0.06213744 0.00000000 0.99806762
0.00000000 1.50000000 0.00000000 0.00000000 0.00000000 1.00000000
4.00000000 0.00000000 0.25000000 -0.12403473 0.00000000 0.99227786
4.00000000 1.50000000 0.25000000 -0.12403473 0.00000000 0.99227786
3 0 1 2
3 0 2 3
3 1 4 5
3 1 5 2
"""
TRIMESH_PLY_BYTES = (
    "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAIA/AAAAQAAAAAAAAAAA1IN+vQAAAABcgX8/AAAAQAAAwD8AAAAA1IN+"
    "vQAAAABcgX8/AAAAAAAAwD8AAAAAAAAAAAAAAAAAAIA/AACAQAAAAAAAAIA+7AX+vQAAAADsBX4/AACAQAAA"
    "wD8AAIA+7AX+vQAAAADsBX4/AwAAAAABAAAAAgAAAAMAAAAAAgAAAAMAAAADAQAAAAQAAAAFAAAAAwEAAAAF"
    "AAAAAgAAAA=="
)
MESHIO_PLY_HEAD = """\
ply
format {} 1.0
comment Created by meshio v5.3.5, 2026-11-29T14:52:35.922869
element vertex 6
property double x
property double y
property double z
property double t
element face 2
property list uint8 int32 vertex_indices
end_header
"""
MESHIO_PLY_BODY = """\
0.0 0.0 0.0 0.0
2.0 0.0 0.0 1.0
2.0 1.5 0.0 2.0
0.0 1.5 0.0 3.0
4.0 0.0 0.25 4.0
4.0 1.5 0.25 5.0
4 0 1 2 3
4 1 4 5 2
"""
MESHIO_PLY_BYTES = (
    "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAQAAAAAAAAAAAAAAAAAAAAAAAAAAAAADw"
    "PwAAAAAAAABAAAAAAAAA+D8AAAAAAAAAAAAAAAAAAABAAAAAAAAAAAAAAAAAAAD4PwAAAAAAAAAAAAAAAAAA"
    "CEAAAAAAAAAQQAAAAAAAAAAAAAAAAAAA0D8AAAAAAAAQQAAAAAAAABBAAAAAAAAA+D8AAAAAAADQPwAAAAAA"
    "ABRABAAAAAABAAAAAgAAAAMAAAAEAQAAAAQAAAAFAAAAAgAAAA=="
)
TRIMESH_STL = """\
solid
facet normal 0.0 0.0 1.0
outer loop
vertex 0.0 0.0 0.0
vertex 2.0 0.0 0.0
vertex 2.0 1.5 0.0
endloop
endfacet
facet normal 0.0 -0.0 1.0
outer loop
vertex 0.0 0.0 0.0
vertex 2.0 1.5 0.0
vertex 0.0 1.5 0.0
endloop
endfacet
facet normal -0.12403473458920847 0.0 0.9922778767136677
outer loop
vertex 2.0 0.0 0.0
vertex 4.0 0.0 0.25
vertex 4.0 1.5 0.25
endloop
endfacet
facet normal -0.12403473458920847 0.0 0.9922778767136677
outer loop
vertex 2.0 0.0 0.0
vertex 4.0 1.5 0.25
vertex 2.0 1.5 0.0
endloop
endfacet

endsolid
"""
TRIMESH_STL_BYTES = (
    "BAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAAEAAAAAAAAAAAAAAAEAAAMA/AAAAAAAAAAAAAAAAAIAA"
    "AIA/AAAAAAAAAAAAAAAAAAAAQAAAwD8AAAAAAAAAAAAAwD8AAAAAAADsBf69AAAAAOwFfj8AAABAAAAAAAAA"
    "AAAAAIBAAAAAAAAAgD4AAIBAAADAPwAAgD4AAOwF/r0AAAAA7AV+PwAAAEAAAAAAAAAAAAAAgEAAAMA/AACA"
    "PgAAAEAAAMA/AAAAAAAA"
)
"""After the 80 bytes of the header, which are zero."""

COMPAS_MESH = """\
{"dtype": "compas.datastructures/Mesh", "data": {"attributes": {}, "default_vertex_attributes": \
{"x": 0.0, "y": 0.0, "z": 0.0}, "default_edge_attributes": {}, "default_face_attributes": {}, \
"vertex": {"0": {"x": 0.0, "y": 0.0, "z": 0.0}, "1": {"x": 2.0, "y": 0.0, "z": 0.0}, \
"2": {"x": 2.0, "y": 1.5, "z": 0.0}, "3": {"x": 0.0, "y": 1.5, "z": 0.0}, \
"4": {"x": 4.0, "y": 0.0, "z": 0.25}, "5": {"x": 4.0, "y": 1.5, "z": 0.25}}, \
"face": {"0": [0, 1, 2, 3], "1": [1, 4, 5, 2]}, "facedata": {"0": {}, "1": {}}, "edgedata": {}, \
"max_vertex": 5, "max_face": 1}, "inheritance": [], \
"guid": "f498fb90-d156-4690-ae41-ec52f92d90fc"}"""
COMPAS_SCENE = """\
{"dtype": "compas.scene/Scene", "data": {"name": "Scene", "root": {"name": "ROOT", "children": \
[{"item": "f498fb90-d156-4690-ae41-ec52f92d90fc", "settings": {"name": "Mesh", "color": null, \
"opacity": 1.0, "show": true, "frame": {"dtype": "compas.geometry/Frame", "data": {"point": \
[0.0, 0.0, 0.0], "xaxis": [1.0, 0.0, 0.0], "yaxis": [0.0, 1.0, 0.0]}, \
"guid": "8532d57c-0b48-42b6-9d1a-fe1faf91e1c3"}, "vertexcolor": {"dtype": \
"compas.colors/ColorDict", "data": {"default": {"dtype": "compas.colors/Color", "data": \
{"red": 0, "green": 0, "blue": 0, "alpha": 1.0}}, "dict": {}}}, "vertexsize": 1.0}, \
"children": []}]}, "items": [%s]}, "inheritance": ["compas.datastructures/Tree"], \
"name": "Scene", "guid": "072bb607-dd96-4bd4-bfd1-86ef26a8aecd"}"""


def binary(head: str, body: str) -> bytes:
    return head.format("binary_little_endian").encode() + base64.b64decode(body)


def ascii_ply(head: str, body: str) -> bytes:
    return (head.format("ascii") + body).encode()


FILES: dict[str, tuple[str, bytes, list[list[int]]]] = {
    "trimesh obj": ("a.obj", TRIMESH_OBJ.encode(), TRIANGLES),
    "meshio obj": ("a.obj", MESHIO_OBJ.encode(), QUADS),
    "compas obj": ("a.obj", COMPAS_OBJ.encode(), QUADS),
    "rhino obj": ("a.obj", RHINO_OBJ.replace("\n", "\r\n").encode(), QUADS),
    "obj counted back": ("a.obj", COUNTED_BACK_OBJ.encode(), QUADS),
    "trimesh off": ("a.off", TRIMESH_OFF.encode(), TRIANGLES),
    "meshio off": ("a.off", MESHIO_OFF.encode(), TRIANGLES),
    "trimesh ply": ("a.ply", ascii_ply(TRIMESH_PLY_HEAD, TRIMESH_PLY_BODY), TRIANGLES),
    "trimesh binary ply": ("a.ply", binary(TRIMESH_PLY_HEAD, TRIMESH_PLY_BYTES), TRIANGLES),
    "meshio ply": ("a.ply", ascii_ply(MESHIO_PLY_HEAD, MESHIO_PLY_BODY), QUADS),
    "meshio binary ply": ("a.ply", binary(MESHIO_PLY_HEAD, MESHIO_PLY_BYTES), QUADS),
    "trimesh stl": ("a.stl", TRIMESH_STL.encode(), TRIANGLES),
    "meshio stl": ("a.stl", TRIMESH_STL.replace("\nvertex", "\n  vertex").encode(), TRIANGLES),
    "trimesh binary stl": ("a.stl", bytes(80) + base64.b64decode(TRIMESH_STL_BYTES), TRIANGLES),
    "compas mesh": ("a.json", COMPAS_MESH.encode(), QUADS),
    "compas list": ("a.json", f"[{COMPAS_MESH}]".encode(), QUADS),
    "compas dict": ("a.json", f'{{"roof": {COMPAS_MESH}, "n": 3}}'.encode(), QUADS),
    "compas scene": ("a.json", (COMPAS_SCENE % COMPAS_MESH).encode(), QUADS),
}


def rows(mesh: Mesh) -> list[list[float]]:
    return np.round(mesh.vertices, 9).tolist()


def turned(face: list[list[float]]) -> list[list[float]]:
    """A face from its least corner on: files of triangles leave the order of vertices open."""
    first = face.index(min(face))
    return face[first:] + face[:first]


@pytest.mark.parametrize("name", FILES)
def test_files_of_other_programs_are_the_mesh(name: str, tmp_path: Path) -> None:
    file, data, faces = FILES[name]
    path = tmp_path / file
    path.write_bytes(data)
    mesh = read_mesh(path).mesh
    assert sorted(rows(mesh)) == sorted(POINTS)
    found = [turned([rows(mesh)[v] for v in face.tolist()]) for face in mesh.faces]
    assert found == [turned([POINTS[v] for v in face]) for face in faces]
    if file != "a.stl":
        assert rows(mesh) == POINTS


@pytest.mark.parametrize("name", [n for n, (_, _, faces) in FILES.items() if faces is TRIANGLES])
def test_pairs_of_triangles_become_the_quads(name: str, tmp_path: Path) -> None:
    file, data, _ = FILES[name]
    path = tmp_path / file
    path.write_bytes(data)
    mesh = read_mesh(path, quads=True).mesh
    found = sorted(turned([rows(mesh)[v] for v in face.tolist()]) for face in mesh.faces)
    assert found == sorted(turned([POINTS[v] for v in face]) for face in QUADS)


@pytest.mark.parametrize("name", ["compas list", "compas scene", "trimesh obj", "meshio ply"])
def test_a_corner_that_is_missing_is_told(name: str, tmp_path: Path) -> None:
    file, data, _ = FILES[name]
    path = tmp_path / file
    text = data.decode()
    for old, new in (("[1, 4, 5, 2]", "[1, 4, 77, 2]"), ("5//5", "77//5"), ("4 1 4 5", "4 1 4 77")):
        text = text.replace(old, new)
    assert text != data.decode()
    path.write_text(text)
    with pytest.raises(MeshError, match=r"\b7[67]\b"):
        read_mesh(path)

"""Meshes in from files of other kinds: STL, COMPAS, gzip, lines, cut quads; place and side."""

from __future__ import annotations

import gzip
import json
import struct
from pathlib import Path

import numpy as np
import pytest

from ddgfab.errors import InputError, MeshError
from ddgfab.grid import grid_mesh
from ddgfab.io import read_mesh, write_mesh
from ddgfab.mesh import Mesh


def roof(m: int = 4, n: int = 3) -> Mesh:
    """A shallow roof of quads, m x n, that looks up."""
    x, y = np.meshgrid(np.arange(m + 1.0), np.arange(n + 1.0), indexing="ij")
    return grid_mesh(np.stack([x, y, 0.3 - 0.05 * ((x - 2) ** 2 + (y - 1) ** 2)], axis=-1))


def cut(mesh: Mesh) -> list[list[int]]:
    """The quads cut along a diagonal, one after the other."""
    return [t for a, b, c, d in (f.tolist() for f in mesh.faces) for t in ([a, b, c], [a, c, d])]


def same_faces(one: Mesh, other: Mesh) -> bool:
    def key(mesh: Mesh) -> set[frozenset[tuple[float, ...]]]:
        return {frozenset(map(tuple, np.round(mesh.vertices[f], 4).tolist())) for f in mesh.faces}

    return key(one) == key(other)


@pytest.mark.parametrize("shuffled", [False, True])
def test_binary_stl_of_cut_quads_gives_the_quads_back(shuffled: bool, tmp_path: Path) -> None:
    mesh = roof()
    triangles = mesh.vertices[np.array(cut(mesh))]
    if shuffled:
        triangles = triangles[np.random.default_rng(3).permutation(len(triangles))]
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *t.ravel().tolist(), 0) for t in triangles)
    path = tmp_path / "a.stl"
    path.write_bytes(b" " * 80 + struct.pack("<I", len(triangles)) + body)
    read = read_mesh(path)
    assert read.mesh.n_vertices == mesh.n_vertices
    assert any("--quads" in note for note in read.notes) != shuffled
    assert same_faces(read_mesh(path, quads=True).mesh, mesh)
    path.write_bytes(path.read_bytes()[:-10])
    with pytest.raises(MeshError, match="is not an STL file"):
        read_mesh(path)


@pytest.mark.parametrize("session", [False, True])
def test_compas_meshes_of_both_versions(session: bool, tmp_path: Path) -> None:
    mesh = roof()
    vertices = {str(10 + i): dict(zip("xyz", p, strict=True)) for i, p in
                enumerate(mesh.vertices.tolist())}  # fmt: skip
    faces = {str(i): (f + 10).tolist() for i, f in enumerate(mesh.faces)}
    record = {"dtype": "compas.datastructures/Mesh", "data": {"vertex": vertices, "face": faces}}
    path = tmp_path / "a.json"
    path.write_text(json.dumps({"items": [1, {"state": record}]} if session else record))
    assert same_faces(read_mesh(path).mesh, mesh)
    faces["0"][0] = 999
    path.write_text(json.dumps(record))
    with pytest.raises(MeshError, match="names vertex 999, which is not there"):
        read_mesh(path)


def test_lines_bound_faces_and_gzip_is_unpacked(tmp_path: Path) -> None:
    mesh = roof()
    rows = ["v {} {} {}".format(*p) for p in mesh.vertices.tolist()]
    rows += ["l {} {}".format(*(e + 1)) for e in mesh.edges.tolist() for e in [np.array(e)]]
    path = tmp_path / "a.obj.gz"
    path.write_bytes(gzip.compress(("\n".join(rows) + "\n").encode()))
    assert same_faces(read_mesh(path).mesh, mesh)


def test_off_with_faces_over_several_lines(tmp_path: Path) -> None:
    mesh = roof()
    write_mesh(tmp_path / "a.off", mesh)
    head, *rows = (tmp_path / "a.off").read_text().split("\n")
    (tmp_path / "b.off").write_text(head + "\n" + "\n".join(" ".join(rows).split()) + "\n")
    assert same_faces(read_mesh(tmp_path / "b.off").mesh, mesh)


@pytest.mark.parametrize("up", ["x", "y", "-x", "-y", "-z"])
def test_up_turns_without_reflection_and_flip_turns_over(up: str, tmp_path: Path) -> None:
    mesh = roof()
    axis = np.zeros(3)
    axis["xyz".index(up[-1])] = -1.0 if up[0] == "-" else 1.0
    other = np.roll(axis, 1)
    frame = np.stack([other, np.cross(axis, other), axis])
    path = tmp_path / "a.obj"
    write_mesh(path, mesh.with_vertices(mesh.vertices @ frame))
    read = read_mesh(path, up=up)
    assert np.allclose(read.mesh.vertices[:, 2], mesh.vertices[:, 2])
    assert read.mesh.vector_areas.sum(axis=0)[2] > 0
    turned = read_mesh(path, up=up, flip=True)
    assert any("look down" in note for note in turned.notes)
    assert any(f"--up {up}" in note or "look down" in note for note in read_mesh(path).notes)


def test_far_from_the_origin_comes_about_a_local_one(tmp_path: Path) -> None:
    mesh = roof()
    path = tmp_path / "a.obj"
    away = np.array([456789.0, 5412345.0, 430.0])
    write_mesh(path, mesh.with_vertices(mesh.vertices + away))
    read = read_mesh(path)
    assert np.allclose(read.mesh.vertices + read.origin, mesh.vertices + away)
    assert np.abs(read.mesh.vertices).max() < 20
    assert any("456789" in note for note in read.notes)


def test_units_that_the_file_states(tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    write_mesh(path, roof(), units="m")
    assert np.median(read_mesh(path, units="stated").mesh.edge_lengths) > 900
    with pytest.raises(InputError, match='"units: m"'):
        read_mesh(path, units="mm")


def test_faces_on_one_another_and_vertices_on_edges_are_named(tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    square = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\n"
    path.write_text(square + "f 1 2 3 4\nf 1 2 3\nf 1 3 4\n")
    with pytest.raises(MeshError, match=r"faces 0 \(line 5\) and .* lie on one another"):
        read_mesh(path)
    path.write_text(
        square + "v 1 2 0\nv 1 4 0\nv 2 4 0\nv 0 4 0\nf 1 2 3 4\nf 4 5 6 8\nf 5 3 7 6\n"
    )
    with pytest.raises(MeshError, match="vertex 4 lies on edge 2-3 of face 0"):
        read_mesh(path)

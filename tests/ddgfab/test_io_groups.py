"""Groups of OBJ files: which vertices and edges they name, through all that reading does to ids."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from ddgfab.io import Groups, read_mesh, write_mesh

POINTS = [(x, y, 0.1 * x * y) for y in range(3) for x in range(3)]
V = "".join(f"v {x} {y} {z}\n" for x, y, z in POINTS)


def read(tmp_path: Path, text: str, **ways: object) -> tuple[Groups, np.ndarray, tuple[str, ...]]:
    path = tmp_path / "roof.obj"
    path.write_text(text)
    found = read_mesh(path, **ways)  # type: ignore[arg-type]
    return found.groups, found.mesh.vertices, found.notes


def places(vertices: np.ndarray, ids: np.ndarray) -> set[tuple[float, ...]]:
    return {tuple(np.round(row, 6).tolist()) for row in vertices[ids]}


def test_faces_lines_and_points(tmp_path: Path) -> None:
    text = V + (
        "o roof top\ng low left\nf 1 2 5 4\ng low\nf 2 3 6 5\ng\nf 4 5 8 7\nf 5 6 9 8\n"
        "g rim\nl 1 2 3\ng foot\np 1 3\n"
    )
    groups, _, notes = read(tmp_path, text)
    assert groups.all_names == ("roof top", "low", "left", "rim", "foot")
    assert groups.edges_of("left").tolist() == [[0, 1], [0, 3], [1, 4], [3, 4]]
    assert groups.vertices_of("low").tolist() == [0, 1, 2, 3, 4, 5]
    assert len(groups.edges_of("low")) == 7
    assert groups.edges_of("rim").tolist() == [[0, 1], [1, 2]]
    assert groups.vertices_of("foot").tolist() == [0, 2]
    assert not len(groups.edges_of("foot"))
    assert len(groups.edges_of("roof top")) == 12
    assert not len(groups.vertices_of("none"))
    assert not any("ignored" in note for note in notes), notes


def test_ids_follow_unused_and_welded_vertices(tmp_path: Path) -> None:
    """The same places, whatever stands before, between and twice in the file."""
    plain = V + "f 1 2 5 4\nf 2 3 6 5\nf 4 5 8 7\nf 5 6 9 8\ng rim\nl 1 2 3\ng foot\np 9\n"
    groups, vertices, _ = read(tmp_path, plain)
    twice = (
        "v 7 7 7\n" + V + "v 2 0 0\nv 2 1 0.2\nv 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 2 0.4\n"
        "f 2 3 6 5\nf 3 11 12 6\nf 5 6 9 8\nf 6 7 10 9\n"
        "g rim\nl 13 14 15\ng foot\np 16\n"
    )
    other, moved, _ = read(tmp_path, twice)
    assert len(moved) == len(vertices) == 9
    for name in ("rim", "foot"):
        assert places(moved, other.vertices_of(name)) == places(vertices, groups.vertices_of(name))
    assert len(other.edges_of("rim")) == 2


def test_points_of_lines_far_from_vertices_are_in_no_group(tmp_path: Path) -> None:
    text = V + "v 0.4 0 0\nf 1 2 5 4\nf 2 3 6 5\ng rim\nl 1 10 2\nl 2 3\n"
    groups, _, _ = read(tmp_path, text)
    assert groups.edges_of("rim").tolist() == [[1, 2]]


def test_diagonals_of_merged_triangles_go(tmp_path: Path) -> None:
    text = V + "g all\nf 1 2 5\nf 1 5 4\nf 2 3 6\nf 2 6 5\n"
    path = tmp_path / "roof.obj"
    path.write_text(text)
    found = read_mesh(path, quads=True)
    edges = {tuple(sorted(edge)) for edge in found.mesh.edges.tolist()}
    assert {tuple(edge) for edge in found.groups.edges_of("all").tolist()} >= edges


@pytest.mark.parametrize("suffix", [".obj", ".off"])
def test_written_groups_are_read(suffix: str, tmp_path: Path) -> None:
    read(tmp_path, V + "f 1 2 5 4\nf 2 3 6 5\n")
    mesh = read_mesh(tmp_path / "roof.obj").mesh
    groups = Groups.of({"rim of it": ([4], [[0, 1], [1, 2]]), "corner": ([0, 2], [])})
    path = tmp_path / f"again{suffix}"
    write_mesh(path, mesh, groups=groups)
    found = read_mesh(path).groups
    if suffix == ".off":
        assert not found
        return
    assert found.all_names == ("rim_of_it", "corner")
    assert found.vertices_of("rim_of_it").tolist() == [0, 1, 2, 4]
    assert found.edges_of("rim_of_it").tolist() == [[0, 1], [1, 2]]
    assert found.vertices_of("corner").tolist() == [0, 2]


def test_lines_that_make_the_faces_are_groups_too(tmp_path: Path) -> None:
    text = V + "g rim\nl 1 2 3\ng rest\nl 1 4 5 2\nl 3 6 5\n"
    groups, _, notes = read(tmp_path, text)
    assert groups.edges_of("rim").tolist() == [[0, 1], [1, 2]]
    assert any("were made of its 3 polylines" in note for note in notes)


def test_ids_beyond_the_file(tmp_path: Path) -> None:
    groups, _, _ = read(tmp_path, V + "f 1 2 5 4\ng rim\nl 1 2\nl 2 77\np 99 1\n")
    assert groups.edges_of("rim").tolist() == [[0, 1]]
    assert groups.vertices_of("rim").tolist() == [0, 1]


def test_ids_far_beyond_the_file_take_no_memory(tmp_path: Path) -> None:
    tracemalloc.start()
    groups, _, _ = read(tmp_path, V + "f 1 2 5 4\ng rim\nl 1 2\nl 2 20000001\np 20000000\n")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert groups.vertices_of("rim").tolist() == [0, 1]
    assert peak < 10e6

"""What reading mends, and what it says about it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ddgfab.errors import MeshError
from ddgfab.io import read_mesh
from ddgfab.mesh import Floats, Ints

CUBE_V = [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]
CUBE_F = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def obj(path: Path, points: list[list[float]] | Floats, faces: list[list[int]] | Ints) -> Path:
    rows = [f"v {x!r} {y!r} {z!r}" for x, y, z in np.asarray(points, dtype=float).tolist()]
    rows += ["f " + " ".join(str(i + 1) for i in face) for face in faces]
    path.write_text("\n".join(rows) + "\n")
    return path


def grid(n: int) -> tuple[Floats, Ints]:
    i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
    at = (i * (n + 1) + j)[:-1, :-1].ravel()
    points = np.stack([i, j, 0.1 * i * j], axis=-1).reshape(-1, 3).astype(float)
    return points, np.stack([at, at + n + 1, at + n + 2, at + 1], axis=1)


def test_flipped_faces_are_turned_back_and_counted(tmp_path: Path) -> None:
    rng = np.random.default_rng(5)
    points, faces = grid(9)
    wrong = rng.choice(81, size=30, replace=False)
    mixed = [face[::-1] if k in wrong else face for k, face in enumerate(faces.tolist())]
    result = read_mesh(obj(tmp_path / "a.obj", points, mixed))
    assert result.notes == ("flipped 30 faces to agree with their neighbours",)
    assert (result.mesh.face_normals[:, 2] > 0).all()
    for k, face in enumerate(result.mesh.faces):
        assert face[0] == mixed[k][0]  # the first corner stays the first
        assert set(face.tolist()) == set(mixed[k])


def test_majority_decides_for_each_component_and_the_first_face_in_a_tie(tmp_path: Path) -> None:
    points, faces = grid(1)
    pair = [[0, 1, 0], [0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 0, 0], [2, 1, 0]]
    tie = [[0, 3, 2, 1], [2, 4, 5, 3]]  # downwards, upwards
    both = tie + [[i + 6 for i in face] for face in faces.tolist()]
    all_points = np.concatenate([pair, points + 9])
    result = read_mesh(obj(tmp_path / "a.obj", all_points, both))
    assert np.sign(result.mesh.face_normals[:, 2]).tolist() == [-1, -1, 1]
    assert result.notes == (
        "flipped 1 face to agree with their neighbours",
        "2 components, of 1 to 2 faces",
    )


def test_moebius_strip_is_refused(tmp_path: Path) -> None:
    n = 12
    t = np.arange(n) * 2 * np.pi / n
    points = [
        [
            (2 + s * np.cos(a / 2)) * np.cos(a),
            (2 + s * np.cos(a / 2)) * np.sin(a),
            s * np.sin(a / 2),
        ]
        for a in t
        for s in (-0.5, 0.5)
    ]
    faces = [[2 * k, 2 * k + 1, 2 * k + 3, 2 * k + 2] for k in range(n - 1)]
    last = [2 * n - 2, 2 * n - 1]
    with pytest.raises(MeshError, match="has one side only"):
        read_mesh(obj(tmp_path / "a.obj", points, [*faces, [*last, 0, 1]]))
    # Without its last face the same strip is a disk.
    assert read_mesh(obj(tmp_path / "b.obj", points, faces)).notes == ()


def test_closed_mesh_that_looks_inwards_is_noted_and_kept(tmp_path: Path) -> None:
    result = read_mesh(obj(tmp_path / "a.obj", CUBE_V, [face[::-1] for face in CUBE_F]))
    assert result.notes == ("the faces of 1 closed component look inwards",)
    assert read_mesh(obj(tmp_path / "b.obj", CUBE_V, CUBE_F)).notes == ()


def test_soup_of_a_cube_becomes_one_closed_mesh(tmp_path: Path) -> None:
    points = [CUBE_V[i] for face in CUBE_F for i in face]
    faces = np.arange(24).reshape(6, 4)
    result = read_mesh(obj(tmp_path / "a.obj", points, faces))
    assert result.mesh.n_vertices == 8
    assert result.mesh.boundary_loops == ()
    assert result.notes == ("merged 16 duplicated vertices nearer than 5.2e-05 to another",)
    apart = read_mesh(tmp_path / "a.obj", merge=0)
    assert apart.mesh.n_vertices == 24
    assert apart.notes == ("6 components, of 1 to 1 faces",)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_merging_goes_with_the_size_of_the_mesh(scale: float, tmp_path: Path) -> None:
    rng = np.random.default_rng(8)
    points, faces = grid(3)
    first, second = faces[:6], faces[6:] + 16
    shift = rng.uniform(-1, 1, points.shape)
    diagonal = np.linalg.norm(np.ptp(points, axis=0))
    near = np.concatenate([points, points + 0.3e-7 * diagonal * shift])
    far = np.concatenate([points, points + 3e-7 * diagonal * np.sign(shift)])
    halves = np.concatenate([first, second])
    merged = read_mesh(obj(tmp_path / "a.obj", near, halves), scale)
    assert len(merged.mesh.boundary_loops) == 1
    assert merged.mesh.n_vertices == 16
    assert len(read_mesh(obj(tmp_path / "b.obj", far, halves), scale).mesh.boundary_loops) == 2
    again = read_mesh(tmp_path / "b.obj", scale, merge=1e-6 * diagonal * scale)
    assert len(again.mesh.boundary_loops) == 1


def test_merged_vertices_keep_the_order_of_the_file(tmp_path: Path) -> None:
    points = [[0, 0, 0], [9, 9, 9], [1, 0, 0], [1, 1, 0], [1, 0, 0], [2, 0, 0], [1, 1, 0]]
    result = read_mesh(obj(tmp_path / "a.obj", points, [[0, 2, 3], [4, 5, 6]]))
    assert result.mesh.vertices[:, 0].tolist() == [0, 1, 1, 2]
    assert [face.tolist() for face in result.mesh.faces] == [[0, 1, 2], [1, 3, 2]]
    assert result.notes[0] == "removed 1 vertex that no face uses"
    assert result.notes[1].startswith("merged 2 duplicated vertices")


def test_face_that_would_collapse_keeps_its_corners_unless_asked(tmp_path: Path) -> None:
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [2, 1e-9, 0]]
    path = obj(tmp_path / "a.obj", points, [[0, 1, 2, 3], [1, 4, 5, 2]])
    assert read_mesh(path).mesh.face_sizes.tolist() == [4, 3]
    points[5] = [2, 1e-5, 0]
    path = obj(tmp_path / "a.obj", points, [[0, 1, 2, 3], [1, 4, 5, 2]])
    assert read_mesh(path).mesh.face_sizes.tolist() == [4, 4]
    thin = obj(tmp_path / "b.obj", [*points[:5], [2, 1e-3, 0]], [[0, 1, 2, 3], [1, 4, 5]])
    with pytest.raises(MeshError, match=r"face 1 collapses .* \[net\] weld_mm") as caught:
        read_mesh(thin, merge=0.01)
    assert caught.value.line == 8
    points[5] = [2, 1e-9, 0]
    path = obj(tmp_path / "a.obj", points, [[0, 1, 2, 3], [1, 4, 5, 2]])
    assert read_mesh(path, merge=0).mesh.n_vertices == 6
    with pytest.raises(MeshError, match=r"merge distance -1"):
        read_mesh(path, merge=-1.0)


def test_side_of_length_zero_goes_even_without_merging(tmp_path: Path) -> None:
    points = [[0, 0, 0], [1, 0, 0], [1, 0, 0], [0, 1, 0]]
    path = obj(tmp_path / "a.obj", points, [[0, 1, 2, 3]])
    result = read_mesh(path, merge=0)
    assert result.mesh.face_sizes.tolist() == [3]
    assert "1 face repeated a corner, which was dropped (first: face 0 (line 5))" in result.notes


def test_sheets_that_meet_at_one_vertex_are_an_error_at_that_vertex(tmp_path: Path) -> None:
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 1, 1], [2, 2, 1]]
    path = obj(tmp_path / "a.obj", points, [[0, 1, 2], [2, 3, 4]])
    with pytest.raises(MeshError, match="vertex 2 is not manifold") as caught:
        read_mesh(path)
    assert caught.value.line == 3


def test_lines_stay_right_after_vertices_went(tmp_path: Path) -> None:
    # Vertex 0 (line 1) is unused and vertex 4 merges into 1, so ids move; lines must not.
    points = [[5, 5, 5], [0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0], [-1, 0, 1], [-1, 1, 1]]
    path = obj(tmp_path / "a.obj", points, [[1, 2, 3], [4, 5, 6]])
    with pytest.raises(MeshError, match="vertex 0 is not manifold") as caught:
        read_mesh(path)
    assert caught.value.line == 2


def test_hundred_thousand_faces_are_read_exactly(tmp_path: Path) -> None:
    points, faces = grid(320)
    result = read_mesh(obj(tmp_path / "a.obj", points, faces))
    assert (result.mesh.vertices == points).all()
    assert (result.mesh.corners == faces.ravel()).all()

"""Groups follow quads that are divided for panes."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ddgfab.grid import grid_mesh
from ddgfab.io import Groups, read_mesh
from ddgfab.mesh import Mesh
from ddgfab.optimize import kept_groups, optimize

PANE = (0.6, 0.6)


def roof(nx: int = 3, ny: int = 2) -> Mesh:
    x, y = np.meshgrid(np.arange(nx + 1.0), np.arange(ny + 1.0), indexing="ij")
    return grid_mesh(np.stack([x, y, 0.02 * x * x], axis=-1))


def read(tmp_path: Path, mesh: Mesh, rows: list[str]) -> tuple[Mesh, Groups]:
    """The mesh with its groups, through an OBJ file."""
    path = tmp_path / "roof.obj"
    points = [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh.vertices.tolist()]
    path.write_text("\n".join([*points, *rows]) + "\n", encoding="utf-8")
    found = read_mesh(path)
    return found.mesh, found.groups


def face_row(mesh: Mesh, face: int) -> str:
    return "f " + " ".join(str(v + 1) for v in mesh.face(face).tolist())


def test_lines_faces_and_points_stay_marked(tmp_path: Path) -> None:
    mesh = roof()
    eave = np.flatnonzero(np.abs(mesh.vertices[:, 1]) < 1e-9)
    eave = eave[np.argsort(mesh.vertices[eave, 0])]
    rows = ["g rest", *(face_row(mesh, f) for f in range(1, mesh.n_faces))]
    rows += ["g bay", face_row(mesh, 0), "g eave", "l " + " ".join(str(v + 1) for v in eave)]
    rows += ["g feet", "p 1"]
    own, groups = read(tmp_path, mesh, rows)
    result = optimize(own, "planar", max_pane=PANE)
    assert result.parts is not None
    found = kept_groups(groups, own, result)
    cut = result.mesh
    eaves = found.edges_of("eave")
    assert len(eaves) == 6  # three edges in two parts each
    assert np.abs(cut.vertices[eaves][:, :, 1]).max() < 0.2  # none across
    assert np.isin(key(cut, eaves), key(cut, cut.edges)).all()
    assert cut.boundary_edge[np.isin(key(cut, cut.edges), key(cut, eaves))].all()
    # A quad of 2 x 2 pieces has 12 edges and 9 vertices, all of them near its own.
    bay = found.edges_of("bay")
    assert len(bay) == 12
    assert np.isin(key(cut, bay), key(cut, cut.edges)).all()
    corners = mesh.vertices[mesh.face(0)]
    inside = cut.vertices[found.vertices_of("bay")]
    assert len(inside) == 9
    assert (inside[:, :2] > corners[:, :2].min(axis=0) - 0.1).all()
    assert (inside[:, :2] < corners[:, :2].max(axis=0) + 0.1).all()
    assert found.vertices_of("feet").tolist() == groups.vertices_of("feet").tolist()
    both = set(key(cut, bay).tolist()) | set(key(cut, found.edges_of("rest")).tolist())
    assert both == set(key(cut, cut.edges).tolist())


def key(mesh: Mesh, pairs: np.ndarray) -> np.ndarray:
    return np.asarray(pairs.min(axis=1) * mesh.n_vertices + pairs.max(axis=1))


def test_triangles_of_a_file_mark_the_quad_that_they_became(tmp_path: Path) -> None:
    mesh = roof()
    path = tmp_path / "roof.obj"
    rows = [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh.vertices.tolist()]
    for face in range(mesh.n_faces):
        a, b, c, d = (mesh.face(face) + 1).tolist()
        rows += [f"g {'bay' if face == 0 else 'rest'}", f"f {a} {b} {c}", f"f {a} {c} {d}"]
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    found = read_mesh(path, quads=True)
    result = optimize(found.mesh, "planar", max_pane=PANE)
    assert len(kept_groups(found.groups, found.mesh, result).edges_of("bay")) == 12


def test_a_ring_of_lines_marks_no_face(tmp_path: Path) -> None:
    """Lines round a quad mark its sides, not what divides it."""
    mesh = roof()
    loop = [*(mesh.face(0) + 1).tolist(), int(mesh.face(0)[0]) + 1]
    rows = [face_row(mesh, f) for f in range(mesh.n_faces)]
    rows += ["g ring", "l " + " ".join(map(str, loop))]
    own, groups = read(tmp_path, mesh, rows)
    result = optimize(own, "planar", max_pane=PANE)
    assert len(kept_groups(groups, own, result).edges_of("ring")) == 8


def test_edges_that_are_not_in_the_result_are_gone() -> None:
    mesh = roof()
    a, b, c, _ = mesh.face(0).tolist()
    groups = Groups.of({"side": ([], [[a, b]]), "across": ([], [[a, c]])})
    found = kept_groups(groups, mesh, optimize(mesh, "planar"))
    assert len(found.edges_of("side")) == 1
    assert len(found.edges_of("across")) == 0

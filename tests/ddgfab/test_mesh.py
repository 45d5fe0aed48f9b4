"""Mesh: edges, stars, loops and normals on small meshes that can be counted by hand."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from ddgfab.errors import MeshError
from ddgfab.mesh import Floats, Mesh, unit

CUBE_POINTS = np.array(list(itertools.product((0.0, 1.0), repeat=3)))  # id = 4 x + 2 y + z
CUBE_FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def cube() -> Mesh:
    """Unit cube, faces counterclockwise from outside."""
    return Mesh.build(CUBE_POINTS, CUBE_FACES)


def grid(m: int, n: int, heights: Floats | None = None, *, omit: tuple[int, ...] = ()) -> Mesh:
    """m x n unit quads over the x, y plane, normals upwards, without some faces."""
    i, j = np.meshgrid(np.arange(m + 1), np.arange(n + 1), indexing="ij")
    z = np.zeros(i.shape) if heights is None else heights
    at = (i * (n + 1) + j)[:-1, :-1].ravel()
    faces = np.stack([at, at + n + 1, at + n + 2, at + 1], axis=1)
    return Mesh.build(
        np.stack([i, j, z], axis=-1).reshape(-1, 3), np.delete(faces, list(omit), axis=0)
    )


def test_cube_counts_and_outward_normals() -> None:
    mesh = cube()
    assert (mesh.n_vertices, mesh.n_edges, mesh.n_faces) == (8, 12, 6)
    assert mesh.n_vertices - mesh.n_edges + mesh.n_faces == 2  # Euler, genus 0
    assert not mesh.boundary_vertex.any()
    assert mesh.boundary_loops == ()
    assert (mesh.valences == 3).all()
    assert np.allclose(mesh.face_normals, 2 * (mesh.face_centers - 0.5), atol=1e-15)
    assert np.allclose(mesh.vertex_normals, unit(mesh.vertices - 0.5), atol=1e-15)
    assert np.allclose(mesh.face_areas, 1)
    assert np.allclose(mesh.corner_angles, np.pi / 2)
    assert mesh.diameter == pytest.approx(np.sqrt(3))


def test_edges_run_as_in_their_left_face() -> None:
    mesh = grid(3, 2)
    for edge, (a, b) in enumerate(mesh.edges):
        left, right = mesh.edge_faces[edge]
        assert _runs(mesh, int(left), a, b)
        assert right < 0 or _runs(mesh, int(right), b, a)
        assert mesh.boundary_edge[edge] == (right < 0)
    for face in range(mesh.n_faces):
        corners = mesh.face(face)
        for k, edge in enumerate(mesh.face_edges(face)):
            pair = {int(corners[k]), int(corners[(k + 1) % 4])}
            assert set(mesh.edges[edge].tolist()) == pair


def _runs(mesh: Mesh, face: int, a: int, b: int) -> bool:
    corners = mesh.face(face).tolist()
    return corners[(corners.index(a) + 1) % len(corners)] == b


@pytest.mark.parametrize("mesh", [grid(3, 4), grid(4, 4, omit=(5,)), cube()], ids=repr)
def test_stars_are_counterclockwise_and_name_the_face_after_each_edge(mesh: Mesh) -> None:
    for vertex in range(mesh.n_vertices):
        edges, faces = mesh.star(vertex)
        assert len(edges) == mesh.valences[vertex] == len(set(edges.tolist()))
        ways = [_way(mesh, int(edge), vertex) for edge in edges]
        for k, face in enumerate(faces):
            if face < 0:
                assert k == len(faces) - 1  # only after the last edge, at the boundary
                assert mesh.boundary_vertex[vertex]
                continue
            following = int(edges[(k + 1) % len(edges)])
            assert {int(edges[k]), following} <= set(mesh.face_edges(int(face)).tolist())
            turn = np.cross(ways[k], ways[(k + 1) % len(ways)])
            assert turn @ mesh.face_normals[face] > 0
        assert (faces < 0).sum() == mesh.boundary_vertex[vertex]


def _way(mesh: Mesh, edge: int, vertex: int) -> Floats:
    a, b = mesh.edges[edge]
    return mesh.vertices[b if a == vertex else a] - mesh.vertices[vertex]


def test_hole_has_its_own_loop_with_the_surface_on_the_left() -> None:
    mesh = grid(4, 4, omit=(5,))
    assert sorted(len(loop) for loop in mesh.boundary_loops) == [4, 16]
    areas = []
    for loop in mesh.boundary_loops:
        x, y = mesh.vertices[loop, 0], mesh.vertices[loop, 1]
        areas.append(float(0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))))
    # The outer rim turns counterclockwise round 16 unit squares, the hole's clockwise round one.
    assert sorted(areas) == [-1.0, 16.0]
    assert mesh.n_vertices - mesh.n_edges + mesh.n_faces == 0  # an annulus


def test_components_are_numbered_by_face() -> None:
    one, n = grid(2, 1), 6
    faces = [*one.faces, *[face + n for face in one.faces]]
    mesh = Mesh.build(np.concatenate([one.vertices, one.vertices + 10]), faces)
    assert mesh.components.tolist() == [0, 0, 1, 1]
    assert len(mesh.boundary_loops) == 2


def test_mixed_polygons_and_repr() -> None:
    mesh = Mesh.build(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0.5, 0]], [[0, 1, 2, 3], [1, 4, 2]]
    )
    assert repr(mesh) == "Mesh(5 vertices, 6 edges, 1 triangles, 1 quads, 1 boundary loops)"
    assert mesh.face_areas == pytest.approx([1.0, 0.5])
    assert [len(face) for face in mesh.faces] == [4, 3]


def test_vertex_without_faces_is_harmless() -> None:
    mesh = Mesh.build([[0, 0, 0], [9, 9, 9], [1, 0, 0], [0, 1, 0]], [[0, 2, 3]])
    assert mesh.valences.tolist() == [2, 0, 2, 2]
    assert len(mesh.star(1)[0]) == 0
    assert np.isfinite(mesh.vertex_normals).all()
    # The lonely vertex does not count: (1, 0) is sqrt(5) / 3 from the mean of the three corners.
    assert mesh.diameter == pytest.approx(2 * np.sqrt(5) / 3)


def test_arrays_cannot_be_changed_and_copies_are_taken() -> None:
    points = CUBE_POINTS.copy()
    mesh = Mesh.build(points, CUBE_FACES)
    points[:] = 7
    assert mesh.vertices.max() == 1
    for array in (mesh.vertices, mesh.corners, mesh.face_start, mesh.edges, mesh.star_edges):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1


def test_new_vertices_keep_the_faces() -> None:
    mesh = cube()
    assert mesh.scaled(1000).face_areas == pytest.approx(np.full(6, 1e6))
    assert mesh.scaled(2).corners is mesh.corners
    with pytest.raises(MeshError, match=r"shape \(2, 3\); expected \(8, 3\)"):
        mesh.with_vertices(np.zeros((2, 3)))


SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1]]


@pytest.mark.parametrize(
    ("points", "faces", "message"),
    [
        (SQUARE, [], "no faces"),
        (SQUARE, [[0, 1]], "face 0 has 2 corners"),
        (SQUARE, [[0, 1, 9]], "face 0 names vertex 9; the mesh has 5"),
        (SQUARE, [[0, 1, -1]], "names vertex -1"),
        (SQUARE, [[0, 1, 1, 2]], "face 0 repeats vertex 1"),
        (SQUARE, [[0.0, 1.5, 2.0]], "whole numbers"),
        ([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]], r"shape \(3, 2\)"),
        ([[0, 0, 0], [1, 0, np.nan], [0, 1, 0]], [[0, 1, 2]], "vertex 1 .* not finite"),
        (SQUARE, [[0, 1, 2], [0, 1, 3]], "faces 0 and 1 run the same way along edge 0-1"),
        (SQUARE, [[0, 1, 2], [1, 0, 3], [0, 1, 4]], "run the same way along edge 0-1"),
    ],
)
def test_what_is_no_oriented_manifold_is_refused(
    points: list[list[float]], faces: list[list[int]], message: str
) -> None:
    with pytest.raises(MeshError, match=message):
        Mesh.build(points, faces)


def test_two_cones_at_one_vertex_are_refused() -> None:
    ring = [[np.cos(t), np.sin(t), 1] for t in np.arange(3) * 2 * np.pi / 3]
    points = [[0, 0, 0], *ring, *[[x, y, -z] for x, y, z in ring]]
    upper = [[0, 1, 2], [0, 2, 3], [0, 3, 1]]
    lower = [[0, 5, 4], [0, 6, 5], [0, 4, 6]]
    Mesh.build(points, upper)
    with pytest.raises(MeshError, match="vertex 0 is not manifold"):
        Mesh.build(points, upper + lower)


def test_relabelled_vertices_give_the_same_surface() -> None:
    rng = np.random.default_rng(3)
    mesh = grid(4, 3, rng.random((5, 4)))
    new = rng.permutation(mesh.n_vertices)  # vertex i becomes new[i]
    points = np.empty_like(mesh.vertices)
    points[new] = mesh.vertices
    other = Mesh.build(points, [new[face] for face in mesh.faces])
    assert np.allclose(other.vertex_normals[new], mesh.vertex_normals, atol=1e-14)
    assert (other.valences[new] == mesh.valences).all()
    assert (other.boundary_vertex[new] == mesh.boundary_vertex).all()
    assert other.edge_lengths == pytest.approx(mesh.edge_lengths)


def test_normals_of_a_sphere_converge_to_the_radius() -> None:
    errors = []
    for n in (8, 16, 32):
        u, v = np.meshgrid(np.linspace(0.5, 1.2, n + 1), np.linspace(0, 1, n + 1), indexing="ij")
        x = np.stack([np.sin(u) * np.cos(v), np.sin(u) * np.sin(v), np.cos(u)], axis=-1)
        mesh = grid(n, n).with_vertices(x.reshape(-1, 3))
        inner = ~mesh.boundary_vertex
        gap = np.linalg.norm(mesh.vertex_normals - mesh.vertices, axis=1)
        errors.append(float(gap[inner].max()))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (orders > 1.8).all()

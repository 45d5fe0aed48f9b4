"""The net of diagonals of a mesh."""

from __future__ import annotations

import numpy as np
from optimize_meshes import dome, hexagons, rotation

from ddgfab.optimize import better_diagonals, diagonal_net
from ddgfab.optimize.surface import SmoothSurface


def test_diagonals_meet_in_the_middle_of_faces_and_keep_the_boundary() -> None:
    mesh = dome(6)
    net = diagonal_net(mesh)
    assert net.n_faces == mesh.n_edges
    assert net.n_vertices == mesh.n_vertices + mesh.n_faces
    np.testing.assert_array_equal(net.vertices[: mesh.n_vertices], mesh.vertices)
    rims = [set(map(tuple, np.sort(m.edges[m.boundary_edge]).tolist())) for m in (mesh, net)]
    assert rims[0] == rims[1]
    assert int((net.face_sizes == 3).sum()) == len(rims[0])
    assert (net.face_normals[:, 2] * mesh.face_normals[0, 2] > 0).all()  # the same side is up
    middles = net.vertices[mesh.n_vertices :]
    centers = np.array([mesh.vertices[face].mean(axis=0) for face in mesh.faces])
    assert np.linalg.norm(middles - centers, axis=1).max() < 0.2
    off = SmoothSurface(mesh).closest(centers)[0] - middles
    assert np.abs(off).max() < 1e-12


def test_diagonals_do_not_depend_on_the_place_of_a_mesh() -> None:
    mesh, turn, shift = dome(6), rotation(), np.array([1e4, 0, 0])
    again = diagonal_net(mesh.with_vertices(1e3 * mesh.vertices @ turn.T + shift))
    back = (again.vertices - shift) @ turn / 1e3
    assert np.abs(back - diagonal_net(mesh).vertices).max() < 1e-9


def test_diagonals_are_compared_for_quads_alone() -> None:
    mesh = hexagons(3)
    assert diagonal_net(mesh).n_faces == mesh.n_edges
    assert better_diagonals(mesh) is None

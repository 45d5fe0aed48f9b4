"""The associated family of minimal nets: closed forms, straight lines, branch points."""

from __future__ import annotations

import numpy as np
import pytest
from koebe_cases import SOLIDS

from ddgfab.errors import DegenerateError, InputError, MeshError
from ddgfab.mesh import unit
from ddgfab.nets.koebe import koebe
from ddgfab.nets.minimal import (
    catenoid,
    enneper,
    helicoid,
    minimal_surface,
    schwarz_d,
    schwarz_p,
)
from ddgfab.nets.minimal.periodic import schwarz_koebe
from ddgfab.offsets import koebe_field
from ddgfab.surfaces import smooth_enneper


@pytest.mark.parametrize("angle", [0.3, 1.0, np.pi / 2, 2.5])
def test_associated_family_closes_and_keeps_edges(angle: float) -> None:
    for net in (enneper((8, 8), 0.08), schwarz_p(8), catenoid(16, (-3, 3), 12)):
        other = net.associated(angle)
        assert other.closing < 1e-11
        assert np.abs(other.mesh.edge_lengths / net.mesh.edge_lengths - 1).max() < 1e-11
        # Edges stay perpendicular to the normals at their contact points and turn by the angle.
        tangent = unit(other.mesh.edge_vectors)
        assert np.abs(np.einsum("ex,ex->e", tangent, net.gauss.contacts)).max() < 1e-10
        cosine = np.einsum("ex,ex->e", tangent, unit(net.mesh.edge_vectors))
        assert np.abs(cosine - np.cos(angle)).max() < 1e-10
        turned = np.cross(net.gauss.contacts, unit(net.mesh.edge_vectors))
        sine = np.einsum("ex,ex->e", tangent, turned)
        assert np.abs(sine - np.sin(angle)).max() < 1e-10
        back = other.associated(0.0)
        assert np.abs(back.mesh.vertices - net.mesh.vertices).max() < 1e-10 * net.mesh.diameter
        with pytest.raises(InputError, match="deg of the associated family"):
            other.mean_curvatures()
        with pytest.raises(InputError, match="incircles"):
            _ = other.circles


def test_enneper_is_congruent_to_its_associates_in_the_limit() -> None:
    """The smooth family only turns Enneper's surface; at pi / 2 by 45 deg, up to order 2."""
    for n, limit in ((8, 0.02), (16, 0.005)):
        net = enneper((n, n), 0.4 / n)
        other = net.associated(0.5 * np.pi)
        assert np.sort(other.mesh.edge_lengths) == pytest.approx(np.sort(net.mesh.edge_lengths))
        corner = np.linalg.norm(other.mesh.vertices, axis=1).max()
        smooth = 2 * smooth_enneper().conjugate().points(0.4 + 0.4j)
        assert corner == pytest.approx(np.linalg.norm(smooth), abs=limit)


def test_helicoid_is_ruled_with_a_straight_axis() -> None:
    net = helicoid(12, (-3, 3), 24)
    grid = net.mesh.vertices.reshape(25, 7, 3)
    assert np.linalg.norm(grid[:, 3, :2] - grid[0, 3, :2], axis=1).max() < 1e-13
    steps = np.diff(grid[:, 3, 2])
    assert np.abs(np.abs(steps) - 2 * np.sin(np.pi / 12)).max() < 1e-13  # waist of the catenoid
    assert np.abs(grid[..., 2] - grid[:, 3:4, 2]).max() < 1e-13  # rulings are horizontal
    rulings = unit(grid[:, 4:] - grid[:, 3:4])
    assert np.abs(np.cross(rulings, rulings[:, :1])).max() < 1e-12
    # Two turns in 24 columns of 12.
    assert rulings[24, 0] == pytest.approx(rulings[0, 0], abs=1e-12)
    assert rulings[12, 0] == pytest.approx(rulings[0, 0], abs=1e-12)
    with pytest.raises(DegenerateError, match="period of this size: cut it open"):
        catenoid(12, (-3, 3)).associated(0.5 * np.pi)


def test_schwarz_d_piece_is_bounded_by_straight_lines() -> None:
    """The conjugate of a plane curvature line is a straight line: a skew quadrangle of edges."""
    net = schwarz_d(6)
    loop = net.mesh.boundary_loops[0]
    corner = np.flatnonzero(net.mesh.valences[loop] == 2)
    loop = np.roll(loop, -corner[0])
    points = net.mesh.vertices[np.append(loop, loop[0])]
    for k in range(4):
        line = points[6 * k : 6 * k + 7]
        assert np.linalg.svd(line - line.mean(axis=0))[1][1] < 1e-11 * net.mesh.diameter
    corners = points[:24:6]
    sides = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1)
    assert np.ptp(sides) < 1e-11 * sides[0]
    # Four edges of a regular tetrahedron: diagonals are as long as the sides.
    assert np.linalg.norm(corners[2] - corners[0]) == pytest.approx(sides[0], rel=1e-10)
    assert np.linalg.norm(corners[3] - corners[1]) == pytest.approx(sides[0], rel=1e-10)


def test_branch_points_from_the_double_cover() -> None:
    """Three sides of the cube round a corner: a flat point of Schwarz' P, a monkey saddle."""
    solid = schwarz_koebe(4)
    sides = (np.arange(96) // 16) % 2 == 1
    gauss = solid.net(sides)
    with pytest.raises(MeshError, match=r"1 inner vertices .* between faces \d+, \d+, \d+"):
        minimal_surface(gauss)
    net = minimal_surface(gauss.covered())
    assert net.mesh.n_faces == 96
    assert np.abs(net.mean_curvatures()).max() < 1e-12
    center = np.flatnonzero(net.mesh.valences == 6)
    assert len(center) == 1
    # The two sheets are images of each other in the point.
    points = net.mesh.vertices
    image = 2 * points[center] - points
    off = np.linalg.norm(image[:, None] - points[None], axis=2).min(axis=1)
    assert off.max() < 1e-11 * net.mesh.diameter
    assert np.abs(np.abs(koebe_field(net.mesh)) - np.abs(net.gauss.mesh.vertices)).max() < 1e-10


def test_an_odd_face_becomes_a_face_of_twice_as_many_sides() -> None:
    solid = koebe(SOLIDS["pillow"])
    mesh = solid.mesh
    triangle = int((mesh.face_sizes == 3).argmax())
    near = np.unique(mesh.edge_faces[mesh.face_edges(triangle)])
    near = near[(mesh.face_sizes[near] == 4) | (near == triangle)]
    net = minimal_surface(solid.net(near).covered())
    assert np.unique(net.mesh.face_sizes).tolist() == [4, 6]
    # Every quad has a side whose both ends have no other face: one neighbour is enough there.
    assert np.abs(np.abs(koebe_field(net.mesh)) - np.abs(net.gauss.mesh.vertices)).max() < 1e-11
    assert net.closing < 1e-13
    assert np.abs(net.mean_curvatures()).max() < 1e-12
    # Two odd faces side by side: the cover is a ring, whose dual has the period of a wing.
    with pytest.raises(DegenerateError, match="period of this size"):
        minimal_surface(solid.net(np.unique(mesh.edge_faces[mesh.face_edges(triangle)])).covered())

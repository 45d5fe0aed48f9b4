"""s-isothermic nets: test, duals of faces and nets, labels, double covers, refusals."""

from __future__ import annotations

import numpy as np
import pytest
from koebe_cases import SOLIDS

from ddgfab.errors import DegenerateError, InputError, MeshError
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.nets import SIsothermic, double_cover, dual, dual_face, label_edges, piece
from ddgfab.nets.integration import integrate
from ddgfab.nets.koebe import koebe
from ddgfab.nets.koebe.solids import cube_cells, prism
from ddgfab.nets.sisothermic import tangential
from ddgfab.transforms import Moebius


def side(cells: int = 6) -> SIsothermic:
    """One side of the Koebe cube, a net of quads with all its corners."""
    return koebe(cube_cells(cells)).net(np.arange(cells**2))


def tangential_polygon(angles: Floats, radius: float = 1.3) -> Floats:
    """(n, 3) corners of the polygon whose sides touch a circle at given angles, in some plane."""
    after = np.roll(angles, -1)
    half = 0.5 * ((after - angles) % (2 * np.pi))
    corner = radius / np.cos(half)
    at = angles + half
    flat = np.stack([corner * np.cos(at), corner * np.sin(at)], axis=1)
    frame = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    return np.asarray(flat @ frame[:2] + [3.0, -1.0, 2.0])


# --- the test (7.3) ----------------------------------------------------------------------------
def test_koebe_nets_are_s_isothermic_and_radii_are_found_again() -> None:
    for name in ("cells", "pillow", "goldberg", "polyhedron"):
        solid = koebe(SOLIDS[name])
        found = SIsothermic.of(solid.mesh)
        assert np.abs(found.radii - solid.radii).max() < 1e-12
        assert max(found.residuals().values()) < 1e-12
        assert np.abs(found.contacts - solid.contacts).max() < 1e-12
        assert np.abs(np.linalg.norm(found.contacts, axis=1) - 1).max() < 1e-12
    assert side().regular
    assert not koebe(SOLIDS["goldberg"]).net().regular  # odd faces
    assert not koebe(cube_cells(4)).net().regular  # vertices with three edges


def test_it_is_invariant_under_similarities_and_under_moebius_only_for_spheres() -> None:
    net = side()
    big = SIsothermic.of(net.mesh.scaled(1e6))
    assert np.abs(big.radii / net.radii - 1e6).max() < 1e-5
    turn = Moebius.similarity(np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0], 1e-6)
    assert (
        max(SIsothermic.of(net.mesh.with_vertices(turn(net.mesh.vertices))).residuals().values())
        < 1e-9
    )


@pytest.mark.parametrize(
    ("points", "words"),
    [
        ([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]], "face 0 misses an incircle by"),
        ([[0, 0, 0], [1, 0, 0], [1, 1, 0.2], [0, 1, 0]], "face 0 is off its plane by"),
        ([[0, 0, 0], [1, 0, 0], [2, 0, 0], [1, 1, 0]], "face 0 is straight at vertex 1"),
        ([[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]], "face 0 has no area"),
    ],
)
def test_what_is_not_s_isothermic_is_named(points: list[list[float]], words: str) -> None:
    with pytest.raises(DegenerateError, match=words):
        SIsothermic.of(Mesh.build(points, [[0, 1, 2, 3]]))


def test_incircles_that_do_not_touch_are_named_at_their_vertex() -> None:
    # A triangle touches its side elsewhere than in the middle, where the square does.
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [1.5, 0.2, 1.0]]
    with pytest.raises(
        DegenerateError, match=r"vertex \d has tangents to its incircles that differ"
    ):
        SIsothermic.of(Mesh.build(points, [[0, 1, 2, 3], [1, 4, 2]]))


def test_tangential_of_polygons_of_any_number_of_sides() -> None:
    for count in (3, 4, 5, 8):
        angles = np.sort(np.random.default_rng(count).uniform(0, 2 * np.pi, count))
        angles = 2 * np.pi * np.arange(count) / count + 0.2 * np.sin(angles)
        polygon = tangential_polygon(angles)
        found = tangential(Mesh.build(polygon, [list(range(count))]))
        assert found.face_radii[0] == pytest.approx(1.3, abs=1e-13)
        assert np.abs(found.centers[0] - [3.0, -1.0, 2.0]).max() < 1e-13
        assert max(v.max() for v in found.defects.values()) < 1e-14


# --- duals (7.4, 7.5) --------------------------------------------------------------------------
@pytest.mark.parametrize("count", [3, 4, 5, 6, 7, 8])
def test_dual_of_a_face(count: int) -> None:
    """v*_(j+1) - v*_j = -(-1)^j (v_(j+1) - v_j) / (r_j r_(j+1)); odd faces take two turns."""
    spread = 0.3 * np.random.default_rng(count).uniform(size=count)
    polygon = tangential_polygon(2 * np.pi * np.arange(count) / count + spread)
    mesh = Mesh.build(polygon, [list(range(count))])
    net = SIsothermic.of(mesh)
    found = dual_face(polygon)
    assert len(found) == count * (1 + count % 2)
    j = np.arange(len(found))
    here, after = polygon[j % count], polygon[(j + 1) % count]
    r, r_after = net.radii[j % count], net.radii[(j + 1) % count]
    wanted = -((-1.0) ** j)[:, None] * (after - here) / (r * r_after)[:, None]
    sides = np.roll(found, -1, axis=0) - found
    assert np.abs(sides - wanted).max() < 1e-13
    # It touches a circle of radius 1 / rho about 0: distance of every side from the center.
    away = np.linalg.norm(np.cross(found, unit(sides)), axis=1)
    assert np.abs(away - 1 / 1.3).max() < 1e-13
    # Radii 1 / r: contact points at that distance from the corners.
    foot = np.einsum("jx,jx->j", -found, unit(sides))
    assert np.abs(np.abs(foot) - 1 / r).max() < 1e-13
    # Angles pi - angle (both in 0..pi).
    back = np.roll(sides, 1, axis=0)
    angle = np.arccos(np.clip(-np.einsum("jx,jx->j", unit(sides), unit(back)), -1, 1))
    assert np.abs(angle - (np.pi - mesh.corner_angles[j % count])).max() < 1e-7
    if count % 2:  # after one turn it has not closed
        assert np.linalg.norm(sides[:count].sum(axis=0)) > 0.1


def test_dual_of_a_polygon_without_incircle_is_refused() -> None:
    with pytest.raises(DegenerateError, match="incircle"):
        dual_face([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]])


def test_global_dual_is_s_isothermic_and_an_involution() -> None:
    net = side()
    one = dual(net)
    assert one.closing < 1e-13
    assert max(one.net.residuals().values()) < 1e-11
    assert np.abs(one.net.radii * net.radii - 1).max() < 1e-14
    assert np.abs(SIsothermic.of(one.net.mesh).radii / one.net.radii - 1).max() < 1e-10
    two = dual(one.net, one.labels)
    home = net.mesh.vertices - net.mesh.vertices.mean(axis=0)
    assert np.abs(two.net.mesh.vertices - home).max() < 1e-12
    # Signs alternate round every face; edges are parallel to the old ones, of length e / r r.
    mesh = net.mesh
    assert (one.labels[mesh.corner_edge] == -one.labels[mesh.corner_edge[mesh.corner_next]]).all()
    i, j = mesh.edges.T
    wanted = mesh.edge_lengths / (net.radii[i] * net.radii[j])
    assert np.abs(one.net.mesh.edge_lengths / wanted - 1).max() < 1e-12
    # Every face is the dual of its face, up to sign and place.
    for face in (0, 7, 35):
        ids = mesh.face(face)
        own = one.net.mesh.vertices[ids] - one.net.mesh.vertices[ids[0]]
        alone = dual_face(mesh.vertices[ids])
        alone = alone - alone[0]
        assert min(np.abs(own - s * alone).max() for s in (1, -1)) < 1e-11 * np.abs(own).max()


def test_duals_of_nets_that_are_not_s_isothermic_do_not_close() -> None:
    net = side()
    bent = SIsothermic(net.mesh, net.radii * (1 + 1e-3 * np.cos(np.arange(len(net.radii)))))
    with pytest.raises(DegenerateError, match=r"does not close: edge \d+ misses by"):
        dual(bent)
    with pytest.raises(InputError, match="expected"):
        integrate(net.mesh, np.zeros((3, 3)))


def test_a_disconnected_net_is_refused() -> None:
    solid = koebe(cube_cells(5))
    apart = solid.net(np.r_[6, 75 + 6])
    with pytest.raises(MeshError, match="disconnected: no edges lead from vertex 0 to vertex"):
        dual(apart)


# --- labels and covers -------------------------------------------------------------------------
def test_labels_that_cannot_be_name_the_faces() -> None:
    with pytest.raises(MeshError, match=r"2 faces have an odd number of sides \(faces 0, 1\)"):
        label_edges(prism(5))
    with pytest.raises(
        MeshError, match=r"8 inner vertices .* vertex \d+ between faces \d+, \d+, \d+"
    ):
        label_edges(cube_cells(3))
    # A ring of quads round a corner of the cube that was taken out: no odd face or vertex is left.
    mesh = cube_cells(4)
    corner = int(np.flatnonzero((mesh.vertices == 1).all(axis=1))[0])
    near = mesh.star(corner)[1]
    second = np.unique(
        [f for v in mesh.corners[np.isin(mesh.corner_face, near)] for f in mesh.star(v)[1]]
    )
    ring = piece(mesh, np.setdiff1d(second, near))
    with pytest.raises(MeshError, match=r"it fails on a ring round a hole \(faces \d"):
        label_edges(ring.mesh)
    for advice in ("branched double cover", "simply connected piece"):
        with pytest.raises(MeshError, match=advice):
            label_edges(mesh)


def test_double_cover_of_the_cube_has_genus_three() -> None:
    mesh = cube_cells(3)
    cover = double_cover(mesh)
    c = cover.mesh
    assert (c.n_faces, c.n_edges) == (2 * mesh.n_faces, 2 * mesh.n_edges)
    assert c.n_vertices == 2 * mesh.n_vertices - 8
    assert c.n_vertices - c.n_edges + c.n_faces == 2 - 2 * 3
    assert c.components.max() == 0
    assert (cover.labels[c.corner_edge] == -cover.labels[c.corner_edge[c.corner_next]]).all()
    # A covering: vertices, faces and edges lie over those below, all edges twice.
    assert np.array_equal(c.vertices, mesh.vertices[cover.vertices])
    assert np.array_equal(np.bincount(cover.faces), np.full(mesh.n_faces, 2))
    assert np.array_equal(np.bincount(np.bincount(cover.vertices)), [0, 8, mesh.n_vertices - 8])
    assert (
        c.valences
        == mesh.valences[cover.vertices] * np.where(mesh.valences[cover.vertices] == 3, 2, 1)
    ).all()


def test_double_cover_with_odd_faces_and_of_a_net_that_needs_none() -> None:
    mesh = SOLIDS["pillow"]  # eight triangles, all vertices even
    cover = double_cover(mesh)
    assert np.array_equal(np.unique(cover.mesh.face_sizes), [4, 6])
    assert (cover.mesh.face_sizes == 6).sum() == 8
    assert cover.mesh.n_edges == 2 * mesh.n_edges
    label_edges(cover.mesh)
    plain = double_cover(side().mesh)
    assert plain.mesh.components.max() == 1
    # The dual closes on the cover of an odd face: a hexagon over each triangle, two turns.
    solid = koebe(mesh)
    triangle = int((mesh.face_sizes == 3).argmax())
    around = double_cover(solid.mesh)
    over = np.flatnonzero(around.faces == triangle)
    part = piece(around.mesh, over)
    assert part.mesh.face_sizes.tolist() == [6]
    twice = SIsothermic(part.mesh, solid.radii[around.vertices[part.vertices]])
    assert dual(twice).closing < 1e-14
    with pytest.raises(MeshError, match="finer mesh"):
        double_cover(SOLIDS["tetrahedron"])


def test_pieces() -> None:
    mesh = cube_cells(3)
    part = piece(mesh, np.arange(mesh.n_faces) < 9)
    assert part.mesh.n_faces == 9
    assert np.array_equal(part.mesh.vertices, mesh.vertices[part.vertices])
    assert np.array_equal(part.faces, np.arange(9))
    with pytest.raises(MeshError, match="no faces"):
        piece(mesh, np.array([], dtype=np.int64))
    with pytest.raises(MeshError, match="face 54 is not in the mesh"):
        piece(mesh, np.array([3, 54]))
    with pytest.raises(MeshError, match="not manifold"):
        piece(mesh, np.array([0, 4]))


def test_a_planar_square_grid_is_its_own_dual_family() -> None:
    x, y = np.meshgrid(np.arange(4.0), np.arange(5.0), indexing="ij")
    net = SIsothermic.of(grid_mesh(np.stack([x, y, 0 * x], axis=-1)))
    assert np.abs(net.radii - 0.5).max() < 1e-15
    other = dual(net).net.mesh.vertices.reshape(4, 5, 3)
    # Edges e / r r = 4 e, with signs that tell the two directions apart.
    assert np.abs(np.abs(np.diff(other, axis=0)[..., 0]) - 4).max() < 1e-14
    product = np.diff(other, axis=0)[0, 0, 0] * np.diff(other, axis=1)[0, 0, 1]
    assert product == pytest.approx(-16)

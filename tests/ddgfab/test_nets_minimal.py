"""Discrete minimal surfaces: closed forms, H = 0, symmetry, periods, associated family, limits."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from koebe_cases import SOLIDS
from net_cases import apart, centered

from ddgfab.errors import DegenerateError, InputError, MeshError
from ddgfab.forms.minimal import from_cells
from ddgfab.io import write_obj
from ddgfab.nets import SIsothermic, label_edges
from ddgfab.nets.koebe import enneper_koebe, koebe, koebe_vertex
from ddgfab.nets.koebe.grids import catenoid_koebe
from ddgfab.nets.koebe.solids import cube_cells
from ddgfab.nets.minimal import (
    catenoid,
    enneper,
    minimal_surface,
    scherk,
    schwarz_p,
    schwarz_p_cell,
)
from ddgfab.nets.minimal.periodic import join, mirrored, schwarz_koebe
from ddgfab.offsets import classify_offset, koebe_field

SURFACES = {
    "enneper": lambda: enneper((7, 5), 0.1),
    "catenoid": lambda: catenoid(11, (-2, 4)),
    "scherk": lambda: scherk(7),
    "tower": lambda: scherk(6, 3),
    "schwarz_p": lambda: schwarz_p(5),
    "cell": lambda: schwarz_p_cell(4).net,
}


@pytest.mark.parametrize("name", SURFACES)
def test_minimal_nets(name: str) -> None:
    """H = 0 face by face, an edge offset with the Gauss image, s-isothermic itself."""
    net = SURFACES[name]()
    assert net.closing < 1e-12
    assert np.abs(net.mean_curvatures()).max() < 1e-12
    assert max(SIsothermic.of(net.mesh).residuals().values()) < 1e-10
    assert np.abs(SIsothermic.of(net.mesh).radii / net.radii - 1).max() < 1e-9
    distance = 0.1 * float(np.median(net.mesh.edge_lengths))
    report = classify_offset(net.mesh, net.offset(distance))
    assert report.is_parallel
    assert "edge" in report.constant
    assert report.spread["edge"] < 1e-9 * distance
    # The Gauss image is found again from the mesh alone, boundary and all.
    field = koebe_field(net.mesh)
    sign = np.sign(np.einsum("vx,vx->", field, net.gauss.mesh.vertices))
    assert np.abs(sign * field - net.gauss.mesh.vertices).max() < 1e-9
    # Face normals are shared, and edges alternate.
    normals = np.einsum("fx,fx->f", net.mesh.face_normals, net.gauss.mesh.face_normals)
    assert np.abs(np.abs(normals) - 1).max() < 1e-11
    alternate = (
        net.labels[net.mesh.corner_edge] * net.labels[net.mesh.corner_edge[net.mesh.corner_next]]
    )
    assert (alternate == -1).all()
    # Angles at a dual corner are pi less those of the Koebe net.
    assert np.abs(net.mesh.corner_angles + net.gauss.mesh.corner_angles - np.pi).max() < 1e-9
    assert len(net.circles) == net.mesh.n_faces
    assert len(net.spheres) == net.mesh.n_vertices


def test_angle_sums_of_the_dual_are_4_pi_less_those_of_the_koebe_net() -> None:
    """mathematics.md 7.5: more than 2 pi, as the vertices of a Koebe polyhedron are convex."""
    net = schwarz_p(6)
    inner = ~net.mesh.boundary_vertex
    for mesh, sign in ((net.mesh, 1), (net.gauss.mesh, -1)):
        total = np.bincount(mesh.corners, mesh.corner_angles, mesh.n_vertices)[inner]
        assert (sign * (total - 2 * np.pi)).min() > 0
    both = np.bincount(net.mesh.corners, net.mesh.corner_angles + net.gauss.mesh.corner_angles)
    assert np.abs(both[inner] - 4 * np.pi).max() < 1e-10


# --- closed forms (7.2, 7.6) -------------------------------------------------------------------
def test_enneper_is_the_closed_form() -> None:
    h, cells = 0.25, (6, 8)
    u, v = (h * (2.0 * np.arange(n + 1) - n) for n in cells)
    a, b = np.meshgrid(u, v, indexing="ij")
    x = a * (1 + b**2 + h**2 / 3) - a**3 / 3
    y = -b * (1 + a**2 + h**2 / 3) + b**3 / 3
    wanted = np.stack([x, y, a**2 - b**2], axis=-1)
    assert wanted[4, 6] == pytest.approx([0.96875, -0.9375, -0.75])  # u = 1 h 2, v = 2 h 2
    net = enneper(cells, h)
    found = np.swapaxes(net.mesh.vertices.reshape(9, 7, 3), 0, 1)
    assert (
        min(
            np.abs(centered(s * found.reshape(-1, 3)) - centered(wanted.reshape(-1, 3))).max()
            for s in (1, -1)
        )
        < 1e-13
    )


def test_catenoid_is_the_closed_form() -> None:
    net = catenoid(6, (-1, 1))
    ring = net.mesh.vertices.reshape(6, 3, 3)
    radius = np.hypot(ring[..., 0], ring[..., 1])
    height = ring[:, :, 2] - ring[:, 1:2, 2]
    assert np.abs(radius - [5 / 3, 1, 5 / 3]).max() < 1e-13
    assert np.abs(np.abs(height) - [2 / 3**0.5, 0, 2 / 3**0.5]).max() < 1e-13
    wide = catenoid(17, (-3, 5)).mesh.vertices.reshape(17, 9, 3)
    step = np.arcsinh(np.tan(np.pi / 17))
    i = 2.0 * np.arange(-3, 6)
    assert np.abs(np.hypot(wide[..., 0], wide[..., 1]) - np.cosh(i * step)).max() < 1e-12
    assert np.abs(np.abs(np.diff(wide[..., 2], axis=1)) - 2 * np.sinh(step)).max() < 1e-13


def test_koebe_vertices_of_planar_circles() -> None:
    """A second route: the pole of the circle through three points projected to the sphere."""
    center, radius = np.array([0.4, -0.3]), 0.7
    angle = np.array([0.1, 1.7, 4.0])
    w = center + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    square = (w**2).sum(axis=1)
    t = np.concatenate([2 * w, (square - 1)[:, None]], axis=1) / (1 + square)[:, None]
    pole = np.linalg.solve(t, np.ones(3))
    vertex, length = koebe_vertex(center, radius)
    assert np.abs(vertex - pole).max() < 1e-14
    assert length**2 == pytest.approx(vertex @ vertex - 1)
    # mathematics.md 7.2 for C = (1, 0), r = 1/2: |C|^2 - r^2 = 3/4.
    vertex, length = koebe_vertex([1.0, 0.0], 0.5)
    assert vertex == pytest.approx([8 / 7, 0.0, -1 / 7], abs=1e-15)
    assert length == pytest.approx(4 / 7, abs=1e-15)
    with pytest.raises(DegenerateError, match=r"circle \(1,\) covers half of the sphere"):
        koebe_vertex([[0.0, 0.0], [0.1, 0.0]], [0.5, 1.2])


# --- Schwarz, Scherk ---------------------------------------------------------------------------
def test_schwarz_p_piece_is_bounded_by_a_plane_square() -> None:
    net = schwarz_p(6)
    corners = net.mesh.vertices[net.mesh.valences == 2]
    assert len(corners) == 4
    assert np.linalg.svd(corners - corners.mean(axis=0))[1][2] < 1e-12 * net.mesh.diameter
    lengths = np.sort(np.linalg.norm(corners[1:] - corners[0], axis=1))
    assert lengths[1] / lengths[0] == pytest.approx(1, abs=1e-9)
    assert lengths[2] / lengths[0] == pytest.approx(2**0.5, abs=1e-9)


def test_schwarz_p_cell_closes_up_under_its_periods() -> None:
    cell = schwarz_p_cell(5)
    net, period = cell.net, cell.periods[0, 0]
    assert np.array_equal(cell.periods, period * np.eye(3))
    assert net.mesh.n_faces == 12 * 25
    assert net.mesh.components.max() == 0
    # Side of the square of a piece: half the period.
    piece = schwarz_p(5)
    corners = piece.mesh.vertices[piece.mesh.valences == 2]
    side = np.sort(np.linalg.norm(corners[1:] - corners[0], axis=1))[0]
    assert 2 * side == pytest.approx(period, rel=1e-11)
    # Modulo the periods the boundary is gone: a closed surface of genus 3.
    edges, points = net.mesh.edges, net.mesh.vertices
    middle = 0.5 * (points[edges[:, 0]] + points[edges[:, 1]])
    rim = middle[net.mesh.boundary_edge]
    turns = (rim[:, None] - rim[None]) / period
    same = np.abs(turns - np.rint(turns)).max(axis=2) < 1e-9
    assert (same.sum(axis=1) == 2).all()
    whole = np.mod(points / period + 1e-7, 1.0)
    distinct = len(np.unique(np.round(whole, 6), axis=0))
    closed_edges = net.mesh.n_edges - net.mesh.boundary_edge.sum() // 2
    assert distinct - closed_edges + net.mesh.n_faces == 2 - 2 * 3
    # The level set cos x + cos y + cos z = 0 is near Schwarz' P and has its symmetry.
    level = np.cos(2 * np.pi * points / period).sum(axis=1)
    assert np.abs(level).max() < 0.12


def test_schwarz_p_from_the_level_of_its_symmetry() -> None:
    """Reflections in x = 0, y = 0, z = 0 map the infinite surface to itself."""
    cell = schwarz_p_cell(4)
    period, points = cell.periods[0, 0], cell.net.mesh.vertices
    for axis in range(3):
        image = points.copy()
        image[:, axis] *= -1
        turns = (image[:, None] - points[None]) / period
        off = np.abs(turns - np.rint(turns)).max(axis=2).min(axis=1)
        assert off.max() < 1e-10


def test_scherk_arcs_are_plane_and_alternate() -> None:
    net = scherk(8)
    z = net.mesh.vertices[:, 2]
    loop = net.mesh.boundary_loops[0]
    level = np.abs(net.gauss.mesh.vertices[loop, 2]) < 1e-12  # normals are horizontal on the arcs
    arcs = np.sign(z[loop][level])
    assert np.abs(np.abs(z[loop][level]) - z.max()).max() < 1e-12 * net.mesh.diameter
    assert z.min() == pytest.approx(-z.max(), rel=1e-12)
    assert (np.diff(np.append(arcs, arcs[0])) != 0).sum() == 4
    assert level.sum() == 4 * 7
    tower = scherk(8, 3)
    assert tower.mesh.n_faces == 3 * net.mesh.n_faces
    assert np.ptp(tower.mesh.vertices[:, 2]) == pytest.approx(3 * np.ptp(z))
    with pytest.raises(InputError, match="storeys"):
        scherk(4, 0)
    with pytest.raises(InputError, match="cells on a side"):
        scherk(2)


def test_mirror_images_grow_together_only_where_they_fit() -> None:
    one = scherk(5)
    other = mirrored(one, 2, float(one.mesh.vertices[:, 2].max()))
    assert np.abs(other.mean_curvatures()).max() < 1e-12
    both = join([one, other], [np.zeros(3), np.zeros(3)])
    shared = 2 * one.mesh.n_vertices - both.mesh.n_vertices
    assert shared == 2 * 4
    with pytest.raises(MeshError, match="run the same way"):
        join([one, one], [np.zeros(3), np.zeros(3)])
    slip = 1e-6 * float(one.mesh.edge_lengths.min())
    with pytest.raises(DegenerateError, match=r"copies do not fit: edge \d+ misses"):
        join([one, other], [np.zeros(3), np.array([slip, 0.0, 0.0])])


# --- combinatorics of one's own, and refusals --------------------------------------------------
def test_combinatorics_from_a_file(tmp_path: Path) -> None:
    mesh = cube_cells(4)
    path = tmp_path / "cells.obj"
    write_obj(path, mesh)
    lines = path.read_text("ascii").split("\n")
    first = next(i for i, line in enumerate(lines) if line.startswith("f"))
    rest = lines[first : first + 80]
    lines[first:] = ["g rest", *rest, "usemtl top", "g roof all", *lines[first + 80 :]]
    path.write_text("\n".join(lines), "ascii")
    for name in ("roof", "all", "top"):
        net = from_cells(str(path), name)
        assert apart(net.mesh.vertices, schwarz_p(4).mesh.vertices) < 1e-9
    with pytest.raises(MeshError, match=r'no faces are marked "dome"; .*: all, rest, roof, top'):
        from_cells(str(path), "dome")
    with pytest.raises(MeshError, match="inner vertices have an odd number of edges"):
        from_cells(str(path), "rest")
    with pytest.raises(InputError, match=r"cells\.obj: the piece .roof. needs no double cover"):
        from_cells(str(path), "roof", sheets=2)
    two = tmp_path / "open.obj"
    two.write_text("\n".join(lines[: first + 60]), "ascii")
    with pytest.raises(MeshError, match="truncated"):
        from_cells(str(two), "rest")
    # Where the vertices lie does not matter.
    flat = tmp_path / "flat.obj"
    flat.write_text("\n".join("v 0 0 0" if s.startswith("v ") else s for s in lines), "ascii")
    assert apart(from_cells(str(flat), "roof").mesh.vertices, schwarz_p(4).mesh.vertices) < 1e-9


def test_gauss_images_must_touch_the_sphere() -> None:
    good = enneper_koebe((3, 3), 0.1)
    off = SIsothermic(good.mesh.scaled(1.01), good.radii * 1.01)
    with pytest.raises(DegenerateError, match=r"edge \d+ misses the unit sphere by 1.0e-02"):
        minimal_surface(off)
    with pytest.raises(MeshError, match="odd number of edges"):
        minimal_surface(schwarz_koebe(3).net())
    with pytest.raises(MeshError, match="odd number of sides"):
        minimal_surface(koebe(SOLIDS["goldberg"]).net(np.arange(40)))
    other = minimal_surface(good, labels=-label_edges(good.mesh))
    assert np.abs(other.mesh.vertices + minimal_surface(good).mesh.vertices).max() < 1e-12


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: enneper((0, 3), 0.1), "cells of direction 0 = 0"),
        (lambda: enneper((2, 2), 1.2), "covers half"),
        (lambda: catenoid(2, (0, 1)), "around = 2"),
        (lambda: catenoid_koebe(5, (1, 1)), "rings from 1 to 1"),
        (lambda: schwarz_p(0), "cells on a side"),
        (lambda: schwarz_p_cell(1), "2 or more"),
    ],
)
def test_mistakes(call: object, words: str) -> None:
    with pytest.raises((InputError, DegenerateError), match=words):
        call()  # type: ignore[operator]


def test_a_scaled_net_keeps_its_gauss_image() -> None:
    net = enneper((4, 4), 0.1)
    big = net.scaled(1000.0)
    assert np.abs(big.radii / net.radii - 1000).max() < 1e-9
    assert np.abs(big.associated(0.0).mesh.vertices - big.mesh.vertices).max() < 1e-9
    assert big.gauss is net.gauss

"""Measures: exact small cases, invariance under motion, scale and relabelling, files of others."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from measure_meshes import grid, mixed, random_grid

from ddgfab.io import read_mesh
from ddgfab.measures import (
    chebyshev_defect,
    circular_defect,
    conical_defect,
    dihedral_angles,
    planarity,
    planarity_percent,
    star_defect,
    torsion,
)
from ddgfab.mesh import Floats, Mesh, unit

SCALAR = {  # measure, power of the scale it goes with
    "planarity": (planarity, 1),
    "planarity_percent": (planarity_percent, 0),
    "circular": (circular_defect, 0),
    "conical": (conical_defect, 0),
    "star": (star_defect, 0),
    "sides": (chebyshev_defect, 0),
    "dihedral": (dihedral_angles, 0),
    "torsion": (lambda mesh: torsion(mesh, mesh.vertex_normals), 0),
}


def rotation(seed: int) -> Floats:
    q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return q * np.sign(np.linalg.det(q))


@pytest.mark.parametrize("name", SCALAR)
@pytest.mark.parametrize("mesh", [random_grid(1), mixed()], ids=["grid", "mixed"])
def test_measures_do_not_change_under_motions_and_go_with_the_scale(name: str, mesh: Mesh) -> None:
    measure, power = SCALAR[name]
    value = measure(mesh)
    assert np.abs(value).max() > 1e-3
    for factor in (1e-6, 1.0, 1e6):
        moved = mesh.with_vertices(factor * (mesh.vertices @ rotation(7).T + [1.0, -2.0, 3.0]))
        # 1e-7: angles near 0 lose half of the digits.
        assert measure(moved) == pytest.approx(factor**power * value, rel=1e-7, abs=1e-7 * factor)


@pytest.mark.parametrize("name", SCALAR)
@pytest.mark.parametrize("mesh", [random_grid(2), mixed()], ids=["grid", "mixed"])
def test_measures_follow_the_labels(name: str, mesh: Mesh) -> None:
    measure, _ = SCALAR[name]
    rng = np.random.default_rng(4)
    new, order = rng.permutation(mesh.n_vertices), rng.permutation(mesh.n_faces)
    points = np.empty_like(mesh.vertices)
    points[new] = mesh.vertices
    faces = [np.roll(new[mesh.face(f)], rng.integers(5)) for f in order]
    value, other = measure(mesh), measure(Mesh.build(points, faces))
    if len(value) == mesh.n_faces:
        assert other == pytest.approx(value[order], abs=1e-9)
    elif len(value) == mesh.n_vertices:
        assert other[new] == pytest.approx(value, abs=1e-9)
    else:
        assert np.sort(other) == pytest.approx(np.sort(value), abs=1e-9)


def test_mirror_turns_dihedral_angles_and_nothing_else() -> None:
    mesh = random_grid(3)
    flipped = Mesh.build(mesh.vertices, [face[::-1] for face in mesh.faces])
    both = {
        tuple(sorted(e)): a for e, a in zip(mesh.edges.tolist(), dihedral_angles(mesh), strict=True)
    }
    for edge, angle in zip(flipped.edges.tolist(), dihedral_angles(flipped), strict=True):
        assert angle == pytest.approx(-both[tuple(sorted(edge))], abs=1e-12)
    assert planarity_percent(flipped) == pytest.approx(planarity_percent(mesh))
    assert circular_defect(flipped) == pytest.approx(circular_defect(mesh))
    assert conical_defect(flipped) == pytest.approx(conical_defect(mesh))


# --- exact small cases --------------------------------------------------------------------------
def test_lifted_corner_of_a_square() -> None:
    # Corner (1, 1) of the unit square lifted by h. Over the plane of least squares, of slope h/2
    # in x and in y, the heights are h/4 up and down in turn; measured along its normal, to first
    # order, h/4 / sqrt(1 + 2 (h/2)^2). Diagonals: (1, 1, h) and (-1, 1, 0), normal
    # (-h, -h, 2) / s with s = sqrt(4 + 2 h^2); gap = h / s.
    h = 0.01
    mesh = Mesh.build([[0, 0, 0], [1, 0, 0], [1, 1, h], [0, 1, 0]], [[0, 1, 2, 3]])
    tilt = np.sqrt(1 + h * h / 2)
    assert planarity(mesh)[0] == pytest.approx(h / 4 / tilt, rel=1e-4)
    mean = (np.sqrt(2 + h * h) + np.sqrt(2)) / 2
    assert planarity_percent(mesh)[0] == pytest.approx(100 * h / np.sqrt(4 + 2 * h * h) / mean)


def test_planarity_of_a_sampled_surface_goes_with_the_step() -> None:
    # z = x y + 0.3 x^3, squares of side h about (0.4, 0.3). The midpoints of the diagonals are
    # h^2 z_xy / 2 apart along z, z_xy = 1; across the tangent plane that is h^2 / (2 w) with
    # w^2 = 1 + z_x^2 + z_y^2. Diagonals: h (1, 1, z_x + z_y) and h (-1, 1, z_y - z_x).
    zx, zy = 0.3 + 0.9 * 0.4**2, 0.4
    diagonals = np.sqrt(2 + (zx + zy) ** 2) + np.sqrt(2 + (zy - zx) ** 2)
    limit = 100 / (np.sqrt(1 + zx**2 + zy**2) * diagonals)
    for h in (1e-2, 1e-3):
        x, y = np.meshgrid([0.4 - h / 2, 0.4 + h / 2], [0.3 - h / 2, 0.3 + h / 2], indexing="ij")
        mesh = grid(np.stack([x, y, x * y + 0.3 * x**3], axis=-1))
        assert planarity_percent(mesh)[0] / h == pytest.approx(limit, rel=2 * h**2)


def test_hexagon_with_a_lifted_corner_and_planar_ones() -> None:
    t = np.arange(6) * np.pi / 3
    points = np.stack([np.cos(t), np.sin(t), 0 * t], axis=1)
    flat = Mesh.build(points, [list(range(6))])
    assert planarity(flat)[0] < 1e-15
    assert circular_defect(flat)[0] < 1e-14
    # Alternating heights +-h are orthogonal to 1, x and y: the plane of least squares stays z = 0.
    # The nine diagonals: six of length sqrt(3) between equal heights, three of sqrt(4 + 4 h^2).
    h = 0.01
    waved = flat.with_vertices(points + np.outer(h * (-1) ** np.arange(6), [0, 0, 1]))
    assert planarity(waved)[0] == pytest.approx(h)
    mean = (6 * np.sqrt(3) + 3 * np.sqrt(4 + 4 * h * h)) / 9
    assert planarity_percent(waved)[0] == pytest.approx(100 * 2 * h / mean)


def test_triangles_are_planar_and_circular() -> None:
    mesh = Mesh.build([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 5]], [[0, 1, 2], [1, 3, 2]])
    for measure in (planarity, planarity_percent, circular_defect, chebyshev_defect):
        assert measure(mesh).tolist() == [0, 0]


def test_parallel_diagonals_mean_planar() -> None:
    # An outline with parallel diagonals: (0,0) (2,1) (1,0) (4,1): both run along x. Turned, their
    # cross product is rounding noise of any direction.
    flat = np.array([[0, 0, 0], [2, 1, 0], [1, 0, 0], [4, 1, 0]])
    for seed in range(9):
        mesh = Mesh.build(flat @ rotation(seed).T, [[0, 1, 2, 3]])
        assert planarity_percent(mesh)[0] < 1e-12
        assert planarity(mesh)[0] < 1e-14


@pytest.mark.parametrize("corners", [4, 5, 6, 9])
def test_circle_has_no_circular_defect_and_a_moved_corner_has(corners: int) -> None:
    rng = np.random.default_rng(corners)
    t = np.sort(rng.uniform(0, 2 * np.pi, corners))
    points = np.stack([np.cos(t), np.sin(t), 0 * t], axis=1) @ rotation(corners).T + 5
    mesh = Mesh.build(points, [list(range(corners))])
    assert circular_defect(mesh)[0] < 1e-13
    center = np.full(3, 5.0)
    points[1] = center + 1.01 * (points[1] - center)
    assert circular_defect(mesh.with_vertices(points))[0] > 1e-3


def test_rhombus_has_twice_its_acute_angle_missing() -> None:
    # Opposite angles of a rhombus are equal: |2 a - pi| with a = 60 deg is 60 deg.
    points = [[0, 0, 0], [1, 0, 0], [1.5, np.sqrt(0.75), 0], [0.5, np.sqrt(0.75), 0]]
    mesh = Mesh.build(points, [[0, 1, 2, 3]])
    assert circular_defect(mesh)[0] == pytest.approx(np.pi / 3)
    assert chebyshev_defect(mesh)[0] == pytest.approx(0, abs=1e-12)


def test_reflex_corner_counts_its_inner_angle() -> None:
    # A dart: angles 30, 30 at the wings; a at the tip, 360 - 60 - a at the reflex corner.
    dart = Mesh.build([[2, 0, 0], [0, 1, 0], [0.5, 0, 0], [0, -1, 0]], [[0, 1, 2, 3]])
    tip = 2 * np.arctan2(1, 2)
    wing = np.arctan2(1, 0.5) - np.arctan2(1, 2)
    assert circular_defect(dart)[0] == pytest.approx(abs(np.pi - 2 * wing))
    assert tip + (2 * np.pi - tip - 2 * wing) + 2 * wing == pytest.approx(2 * np.pi)


@pytest.mark.parametrize("valence", [3, 4, 5, 6, 7])
def test_pyramid_over_a_regular_polygon_is_conical_and_a_skew_one_is_not(valence: int) -> None:
    t = np.arange(valence) * 2 * np.pi / valence
    rim = np.stack([np.cos(t), np.sin(t), 0 * t], axis=1)
    faces = [[0, 1 + k, 1 + (k + 1) % valence] for k in range(valence)]
    straight = Mesh.build(np.concatenate([[[0, 0, 1.0]], rim]), faces)
    assert np.abs(conical_defect(straight)).max() < 1e-14
    skew = straight.with_vertices(np.concatenate([[[0.3, 0.2, 1.0]], rim]))
    defect = conical_defect(skew)
    assert (defect[1:] == 0).all()  # the boundary has none
    assert defect[0] < 1e-14 if valence == 3 else defect[0] > 5e-3


def test_planes_tangent_to_a_cone_have_no_conical_defect() -> None:
    # Faces between arbitrary rulings of intersecting tangent planes of one cone of revolution:
    # normals at unequal azimuths on one circle; edges from consecutive planes.
    for azimuths in ([0.1, 1.2, 3.0, 4.4], [0, 1.0, 2.2, 3.1, 4.9], [0, 0.8, 2.0, 3.0, 4.0, 5.3]):
        t = np.array(azimuths)
        normals = np.stack([0.6 * np.cos(t), 0.6 * np.sin(t), 0.8 + 0 * t], axis=1)
        ways = unit(np.cross(normals, np.roll(normals, -1, axis=0)))
        ways *= -np.sign(ways[:, 2:])  # downwards from the apex
        k = len(t)
        faces = [[0, 1 + (i - 1) % k, 1 + i] for i in range(k)]
        mesh = Mesh.build(np.concatenate([[[0, 0, 0]], ways]), faces)
        assert mesh.face_normals == pytest.approx(normals)
        assert conical_defect(mesh)[0] < 1e-12
    tilted = mesh.with_vertices(mesh.vertices * [1, 2, 1])  # a cone, but not of revolution
    assert conical_defect(tilted)[0] > 0.01


def test_stars_in_one_plane() -> None:
    # Hyperbolic paraboloid z = x y: both families of edges are straight lines of the surface.
    i, j = np.meshgrid(np.arange(5.0), np.arange(4.0), indexing="ij")
    net = grid(np.stack([i, j, i * j], axis=-1))
    assert star_defect(net).max() < 1e-14
    assert planarity_percent(net).min() > 1
    # A vertex at height h over a square of neighbours with half diagonal 1: all edges leave the
    # plane through the vertex that fits best, the horizontal one, by atan h.
    h = 0.3
    rim = [[1, 0, -h], [0, 1, -h], [-1, 0, -h], [0, -1, -h]]
    fan = Mesh.build([[0, 0, 0], *rim], [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]])
    assert star_defect(fan)[0] == pytest.approx(np.arctan(h))


def test_sides_of_a_trapezoid() -> None:
    # Sides 4, 1, 3, 1 (nearly): |4 - 3| over the mean.
    points = [[0, 0, 0], [4, 0, 0], [3.5, np.sqrt(0.75), 0], [0.5, np.sqrt(0.75), 0]]
    mesh = Mesh.build(points, [[0, 1, 2, 3]])
    assert chebyshev_defect(mesh)[0] == pytest.approx(100 * 1 / 2.25)


def test_dihedral_angles_of_a_cube_a_valley_and_a_plane() -> None:
    points = [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    assert dihedral_angles(Mesh.build(points, faces)) == pytest.approx(np.full(12, np.pi / 2))
    for slope in (-0.5, 0.0, 0.5):  # two slopes that meet at x = 0; normals upwards
        x = np.array([-1.0, 0.0, 1.0])
        net = np.stack([np.stack([x, x * 0 + y, slope * abs(x)], axis=-1) for y in (0, 1)], axis=1)
        angle = dihedral_angles(grid(net))
        # A valley (slope up on both sides) is concave seen from above.
        assert angle.sum() == pytest.approx(-2 * np.arctan(slope))


# --- meshes of others, against numbers measured independently -----------------------------------
@pytest.mark.parametrize(
    ("name", "measure", "greatest", "slack"),
    [
        ("conical1.obj", planarity_percent, 0.004, 5e-4),
        ("conical1.obj", lambda m: np.degrees(conical_defect(m)), 0.04, 5e-3),
        ("six_quad.obj", planarity_percent, 0.006, 5e-4),
        ("botanic_garden_bubble.obj", planarity_percent, 1.0, 0.05),
        ("botanic_garden_bubble.obj", lambda m: np.degrees(SCALAR["torsion"][0](m)), 9.6, 0.05),
        ("heart.obj", planarity_percent, 12, 0.5),
        ("knet1.obj", lambda m: m.edge_lengths, 0.99, 1e-3),
        ("knet1.obj", lambda m: 100 * star_defect(m)[~m.boundary_vertex], 4e-5, 5e-6),
        ("knet1.obj", lambda m: np.degrees(SCALAR["torsion"][0](m)), 6.5, 0.05),
        ("helical_minimal.obj", planarity_percent, 5, 0.05),
        ("helical_minimal.obj", lambda m: np.degrees(SCALAR["torsion"][0](m)), 8.3, 0.05),
        ("chebyshev_sphere.obj", lambda m: m.edge_lengths, 0.1, 1e-4),
        ("quad_dome.obj", planarity_percent, 1.4, 0.05),
    ],
)
def test_numbers_of_an_independent_study(
    name: str,
    measure: Callable[[Mesh], Floats],
    greatest: float,
    slack: float,
    mesh_file: Callable[[str], Path],
) -> None:
    assert measure(read_mesh(mesh_file(name)).mesh).max() == pytest.approx(greatest, abs=slack)

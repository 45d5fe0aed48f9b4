"""Every term: its Jacobian by finite differences, its independence of unit, and what it says."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from ddgfab.errors import InputError
from ddgfab.grid import grid_mesh
from ddgfab.measures import (
    chebyshev_defect,
    circular_defect,
    conical_defect,
    planarity_percent,
    star_defect,
)
from ddgfab.mesh import Floats, Mesh
from ddgfab.optimize import PathOptions, Problem, Term, settle
from ddgfab.optimize.terms import (
    boundary_glide,
    circularity_terms,
    closeness,
    cone_terms,
    conicality_terms,
    corner_angle_limits,
    edge_lengths,
    fairness,
    laplacian_fairness,
    on_curve,
    on_surface,
    opposite_sides,
    orthogonality,
    panel_size,
    planarity_terms,
    plane_stars,
    strain,
)

RNG = np.random.default_rng(5)


def quads(rows: int = 5, columns: int = 4, noise: float = 0.05) -> Mesh:
    """A bumpy grid of unit squares, with noise."""
    u, v = np.meshgrid(np.arange(rows + 1.0), np.arange(columns + 1.0), indexing="ij")
    points = np.stack([u, v, 0.3 * np.sin(0.7 * u + 0.3) * np.cos(0.9 * v)], axis=-1)
    jitter = np.random.default_rng(1).normal(size=points.shape)
    return grid_mesh(points + noise * jitter, (False, False))


def hexagons(noise: float = 0.05) -> Mesh:
    """Seven hexagons of side one round the first, on a bowl."""
    centers = [(0, 0), (1, 0), (0, 1), (-1, 1), (-1, 0), (0, -1), (1, -1)]
    turn = np.pi / 3 * np.arange(6) + np.pi / 6
    ring = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    names: dict[tuple[float, float], int] = {}
    points, faces = [], []
    for i, j in centers:
        middle = np.sqrt(3) * np.array([i + j / 2, j * np.sqrt(3) / 2])
        face = []
        for corner in middle + ring:
            key = (round(corner[0], 6), round(corner[1], 6))
            if key not in names:
                names[key] = len(points)
                points.append([*corner, 0.1 * corner @ corner])
            face.append(names[key])
        faces.append(face)
    jitter = np.random.default_rng(2).normal(size=(len(points), 3))
    return Mesh.build(np.array(points) + noise * jitter, faces)


def fan(valence: int = 6, noise: float = 0.05) -> Mesh:
    """Quads round one vertex."""
    turn = 2 * np.pi * np.arange(2 * valence) / (2 * valence)
    radius = np.where(np.arange(2 * valence) % 2, 1.5, 1.0)
    ring = np.stack([radius * np.cos(turn), radius * np.sin(turn), -0.4 * radius], axis=1)
    points = np.concatenate([[[0.0, 0.0, 0.0]], ring])
    points += noise * np.random.default_rng(3).normal(size=points.shape)
    size = 2 * valence
    return Mesh.build(points, [[0, k + 1, k + 2, (k + 2) % size + 1] for k in range(0, size, 2)])


MIXED = Mesh.build(
    [[0, 0, 0], [1, 0, 0.1], [2, 0, 0], [2, 1, 0.2], [1, 1.2, 0], [0, 1, 0.3], [0.5, 2, 0.1]],
    [[0, 1, 4, 5], [1, 2, 3, 4], [5, 4, 3, 6]],
)

SQUARE = np.array([[[0, 0, 0], [3, 0, 0]], [[3, 0, 0], [3, 3, 1]], [[3, 3, 1], [0, 3, 0]]], float)

TERMS: dict[str, tuple[Mesh, Callable[[Mesh], Sequence[Term]]]] = {
    "planarity of quads": (quads(), planarity_terms),
    "planarity of hexagons": (hexagons(), planarity_terms),
    "planarity of some faces": (MIXED, lambda m: planarity_terms(m, [0, 2])),
    "circularity of quads": (quads(), circularity_terms),
    "circularity of hexagons": (hexagons(), circularity_terms),
    "conicality": (quads(), conicality_terms),
    "cones of quads": (fan(), cone_terms),
    "closeness": (quads(), lambda m: [closeness(m, m.vertices + 0.1 * np.eye(3)[0])]),
    "fairness": (quads(), lambda m: [fairness(m)]),
    "fairness of movement": (quads(), lambda m: [fairness(m, smoothing=0.0)]),
    "fairness of hexagons": (hexagons(), lambda m: [fairness(m)]),
    "Laplacian fairness": (quads(), lambda m: [laplacian_fairness(m)]),
    "strain": (hexagons(), lambda m: [strain(m)]),
    "equal edges": (quads(), lambda m: [edge_lengths(m)]),
    "bounded edges": (quads(), lambda m: [edge_lengths(m, low=m.edge_lengths.mean())]),
    "panel size": (quads(), lambda m: [panel_size(m, 1.2 * m.edge_lengths.mean())]),
    "opposite sides": (quads(), lambda m: [opposite_sides(m)]),
    "plane stars": (quads(), lambda m: [plane_stars(m)]),
    "orthogonality": (quads(), lambda m: [orthogonality(m)]),
    "corner angles": (quads(), lambda m: [corner_angle_limits(m, 1.55, 1.6)]),
    "on a curve": (
        quads(),
        lambda m: [on_curve(m, [0, 3, 7], SQUARE * m.edge_lengths.mean())],
    ),
    "on a surface": (
        quads(),
        lambda m: [on_surface(m, m.with_vertices(1.1 * m.vertices + 0.07 * m.edge_lengths.mean()))],
    ),
    "gliding boundary": (
        quads(),
        lambda m: boundary_glide(
            m.with_vertices(1.02 * m.vertices), np.flatnonzero(m.boundary_vertex)
        )[0],
    ),
}


@pytest.mark.parametrize("name", TERMS)
def test_jacobian_is_the_derivative(name: str) -> None:
    mesh, make = TERMS[name]
    terms = make(mesh)
    assert terms
    for term in terms:
        x = mesh.vertices.ravel().copy()
        matrix = term.jacobian(x)
        assert matrix.shape == (len(term.residual(x)), len(x))
        step = 1e-6
        for _ in range(4):
            way = RNG.normal(size=len(x))
            slope = (term.residual(x + step * way) - term.residual(x - step * way)) / (2 * step)
            np.testing.assert_allclose(matrix @ way, slope, atol=2e-7 * max(1, abs(slope).max()))


@pytest.mark.parametrize("name", TERMS)
def test_pattern_of_entries_stays_and_further_unknowns_are_ignored(name: str) -> None:
    mesh, make = TERMS[name]
    for term in make(mesh):
        x = mesh.vertices.ravel()
        other = np.concatenate([x + 0.01 * RNG.normal(size=len(x)), np.ones(7)])
        one, two = term.jacobian(x), term.jacobian(other)
        np.testing.assert_array_equal(one.indices, two.indices)
        np.testing.assert_array_equal(one.indptr, two.indptr)
        assert two.shape[1] == len(x) + 7


@pytest.mark.parametrize("name", [n for n in TERMS if n != "closeness"])
@pytest.mark.parametrize("unit", [1e-6, 1e6])
def test_residuals_do_not_depend_on_the_unit(name: str, unit: float) -> None:
    mesh, make = TERMS[name]
    large = mesh.scaled(unit)
    for term, scaled in zip(make(mesh), make(large), strict=True):
        one = np.abs(term.residual(mesh.vertices.ravel()))
        two = np.abs(scaled.residual(large.vertices.ravel()))
        np.testing.assert_allclose(one, two, rtol=1e-6, atol=1e-8)


def residual(terms: Sequence[Term], mesh: Mesh) -> Floats:
    return np.concatenate([t.residual(mesh.vertices.ravel()) for t in terms])


# --- what the terms say, against the measures or against exact cases -----------------------------
def test_planarity_of_quads_is_the_distance_of_the_diagonals() -> None:
    mesh = quads()
    np.testing.assert_allclose(
        np.abs(residual(planarity_terms(mesh), mesh)), planarity_percent(mesh) / 100, rtol=1e-10
    )


def test_planarity_vanishes_just_on_planar_polygons() -> None:
    flat = hexagons(0.0)
    flat = flat.with_vertices(np.c_[flat.vertices[:, :2], flat.vertices[:, 0]])
    assert np.abs(residual(planarity_terms(hexagons()), flat)).max() < 1e-14
    # An L-shaped hexagon: not convex, far from regular; no bend of it is overlooked.
    corners = np.array([[0, 0, 0], [3, 0, 0], [3, 1, 0], [1, 1, 0], [1, 3, 0], [0, 3, 0]], float)
    shape = Mesh.build(corners, [range(6)])
    matrix = planarity_terms(shape)[0].jacobian(corners.ravel()).toarray()
    heights = matrix[:, 2::3]
    kernel = np.linalg.svd(heights)[2][3:]
    assert np.linalg.matrix_rank(heights) == 3
    affine = np.c_[np.ones(6), corners[:, :2]]
    assert np.linalg.matrix_rank(np.vstack([kernel, affine.T])) == 3


def test_triangles_have_no_rows() -> None:
    mesh = Mesh.build(np.eye(3), [[0, 1, 2]])
    assert planarity_terms(mesh) == circularity_terms(mesh) == cone_terms(mesh) == ()


def turned() -> Mesh:
    """Part of a surface of revolution, cut into isosceles trapezoids: circular and conical."""
    angle, height = np.meshgrid(0.2 * np.arange(6), np.arange(5.0), indexing="ij")
    radius = 3 + 0.5 * np.sin(height)
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=-1)
    return grid_mesh(points, (False, False))


def test_a_net_of_revolution_meets_all_three() -> None:
    mesh = turned()
    for make in (planarity_terms, circularity_terms, conicality_terms):
        assert np.abs(residual(make(mesh), mesh)).max() < 1e-13


def test_circularity_is_the_measure() -> None:
    mesh = quads()
    np.testing.assert_allclose(
        np.abs(residual(circularity_terms(mesh), mesh)), circular_defect(mesh), atol=1e-12
    )


def test_conicality_is_half_the_measure() -> None:
    mesh = quads()
    terms = conicality_terms(mesh)
    np.testing.assert_allclose(
        2 * np.abs(residual(terms, mesh)), conical_defect(mesh)[terms[0].elements], atol=1e-12
    )


def test_cones_vanish_on_a_pyramid_and_not_on_others() -> None:
    regular = fan(noise=0.0)
    assert np.abs(residual(cone_terms(regular), regular)).max() < 1e-12
    assert np.abs(residual(cone_terms(fan()), fan())).max() > 1e-3
    assert np.degrees(conical_defect(regular)).max() < 1e-8


def test_fairness_bends_only_across_features() -> None:
    """A roof with its ridge as a feature is fair; without, the polylines across it bend."""
    points = np.stack(np.meshgrid(np.arange(5.0), np.arange(4.0), indexing="ij"), axis=-1)
    roof = grid_mesh(
        np.concatenate([points, -np.abs(points[..., :1] - 2)], axis=-1), (False, False)
    )
    ridge = np.flatnonzero((np.abs(roof.vertices[roof.edges, 0] - 2) < 1e-9).all(axis=1))
    assert np.abs(residual([fairness(roof, features=ridge)], roof)).max() < 1e-12
    assert np.abs(residual([fairness(roof)], roof)).max() > 1
    # Along the ridge polylines are still fair: a vertex of it moved along is seen.
    bent = roof.vertices.copy()
    bent[np.flatnonzero(np.abs(bent[:, 0] - 2) < 1e-9)[1], 1] += 0.2
    moved = roof.with_vertices(bent)
    assert np.abs(residual([fairness(roof, features=ridge)], moved)).max() > 0.1


def solved(mesh: Mesh, *terms: Term, fixed: Sequence[int] = ()) -> Mesh:
    problem = Problem.build(mesh, [closeness(mesh, weight=1e-3), *terms], fixed=fixed)
    found = settle(problem, 1e3, PathOptions(tolerance=1e-9, steps_per_stage=60))
    return mesh.with_vertices(problem.vertices(found.value))


def test_equal_and_bounded_edges() -> None:
    mesh = quads()
    equal = solved(mesh, edge_lengths(mesh, hard=True))
    assert np.ptp(equal.edge_lengths) < 1e-8
    low, high = 0.95, 1.05
    bounded = solved(mesh, edge_lengths(mesh, low=low, high=high, weight=1e3))
    assert mesh.edge_lengths.min() < low - 0.01
    assert mesh.edge_lengths.max() > high + 0.01
    assert low - 1e-3 < bounded.edge_lengths.min() <= bounded.edge_lengths.max() < high + 1e-3


def test_panel_size() -> None:
    mesh = quads()
    limit = 1.4
    corners = mesh.corners.reshape(-1, 4)

    def widest(m: Mesh) -> float:
        points = m.vertices[corners]
        return float(np.linalg.norm(points[:, :, None] - points[:, None], axis=-1).max())

    assert widest(mesh) > limit + 0.1
    assert widest(solved(mesh, panel_size(mesh, limit, weight=1e3))) < limit + 2e-3


def test_opposite_sides_make_a_chebyshev_net() -> None:
    mesh = quads()
    assert chebyshev_defect(mesh).max() > 5
    assert chebyshev_defect(solved(mesh, opposite_sides(mesh, hard=True))).max() < 1e-6


def test_plane_stars_and_edges_kept_make_a_k_net() -> None:
    mesh = quads(noise=0.02)
    net = solved(mesh, plane_stars(mesh), opposite_sides(mesh, hard=True))
    assert np.degrees(star_defect(net)).max() < 1e-6
    assert chebyshev_defect(net).max() < 1e-6


def test_orthogonality() -> None:
    mesh = quads()
    sheared = mesh.with_vertices(mesh.vertices @ np.array([[1, 0, 0], [0.3, 1, 0], [0, 0, 1]]))
    net = solved(sheared, orthogonality(sheared, hard=True))
    corners = net.vertices[net.corners.reshape(-1, 4)]
    first = corners[:, 1] + corners[:, 2] - corners[:, 0] - corners[:, 3]
    second = corners[:, 2] + corners[:, 3] - corners[:, 0] - corners[:, 1]
    assert np.abs((first * second).sum(axis=1)).max() < 1e-8


def test_corner_angle_limits() -> None:
    mesh = quads()
    low, high = np.radians(85), np.radians(95)
    assert np.degrees(mesh.corner_angles).min() < 82
    better = solved(mesh, corner_angle_limits(mesh, low, high, weight=1e3))
    assert np.degrees(better.corner_angles).min() > 84.9
    assert np.degrees(better.corner_angles).max() < 95.1


def test_vertices_slide_on_a_surface() -> None:
    """Points off a plane come down to it and nowhere else."""
    mesh = quads()
    plane = grid_mesh(
        np.stack([*np.meshgrid([-9.0, 9.0], [-9.0, 9.0], indexing="ij"), np.zeros((2, 2))], -1),
        (False, False),
    )
    down = solved(mesh, on_surface(mesh, plane, hard=True))
    assert np.abs(down.vertices[:, 2]).max() < 1e-9
    np.testing.assert_allclose(down.vertices[:, :2], mesh.vertices[:, :2], atol=1e-7)


def test_boundary_glides_along_itself_and_keeps_its_corners() -> None:
    mesh = quads(noise=0.0)
    (term,), corners = boundary_glide(mesh, np.flatnonzero(mesh.boundary_vertex))
    assert sorted(corners.tolist()) == [0, 4, 25, 29]
    assert np.abs(term.residual(mesh.vertices.ravel())).max() < 1e-12


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda m: edge_lengths(m, target=1.0, low=0.5), "not both"),
        (lambda m: edge_lengths(m, low=2.0, high=1.0), "2 to 1"),
        (lambda m: edge_lengths(m, target=-1.0), "-1"),
        (lambda m: panel_size(m, 0.0), "no larger than 0"),
        (lambda m: corner_angle_limits(m, 2.0, 1.0), "2 to 1"),
        (lambda m: opposite_sides(hexagons()), "no"),
        (lambda m: orthogonality(hexagons()), "none"),
        (lambda m: plane_stars(m, [0]), "valence 3"),
    ],
)
def test_what_cannot_be_is_said(make: Callable[[Mesh], object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        make(quads())

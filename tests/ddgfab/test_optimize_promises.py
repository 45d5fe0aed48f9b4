"""optimize: oracles, and awkward meshes: in pieces, mixed, with sharp corners, symmetric."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from optimize_meshes import dome, roof, rotation, shell_of_hexagons, torus, wavy

from ddgfab.grid import grid_mesh
from ddgfab.io import read_mesh
from ddgfab.measures import planarity_percent
from ddgfab.mesh import Mesh
from ddgfab.optimize import Change, Limits, PathOptions, mean_edge, optimize
from ddgfab.optimize.energy import Weights, energy
from ddgfab.optimize.frame import Frame
from ddgfab.optimize.goal import net_problem
from ddgfab.optimize.goal import violation as violation_of
from ddgfab.optimize.merit import Merit
from ddgfab.optimize.net_goals import PLANAR
from ddgfab.optimize.path import follow
from ddgfab.optimize.rim import rim_corners
from ddgfab.optimize.terms.base import LinearTerm, VectorTerm

FLAT = 0.2


# --- oracles -------------------------------------------------------------------------------------
def test_a_torus_off_its_curvature_lines_is_slid_on_its_surface() -> None:
    mesh = torus(24, 0.2)
    change = optimize(mesh).change
    assert change.distance_mean < 0.05 * change.edge
    assert change.movement.mean() > 10 * change.distance_mean


def test_quads_on_a_sphere_come_nearer_with_refinement() -> None:
    """Meridians turned off: planar quads exist near every smooth surface as cells shrink."""

    def distance(n: int) -> float:
        u, v = np.meshgrid(*2 * [np.linspace(-0.7, 0.7, n + 1)], indexing="ij")
        x = np.stack([np.tan(u + 0.2 * v**2), np.tan(v + 0.3 * u * v), np.ones_like(u)], axis=-1)
        mesh = grid_mesh(n * x / np.linalg.norm(x, axis=-1, keepdims=True))
        return optimize(mesh, flat=0).change.distance_mean / n  # of a sphere of radius one

    coarse, fine = distance(8), distance(16)
    assert 0 < fine < 0.5 * coarse


def test_every_accepted_step_is_on_the_right_side_of_all_barriers() -> None:
    mesh = wavy(10)
    small = Frame.of(mesh).inside(mesh)
    problem = net_problem(small, PLANAR)
    merit = Merit(problem)
    seen: list[bool] = []

    def violation(x: np.ndarray) -> float:
        return violation_of(problem, x)

    path = follow(problem, violation, PathOptions(tolerance=2e-3))
    seen = [merit.possible(end.x) for end in path.waypoints]
    assert len(seen) > 3
    assert all(seen)
    assert any(len(barrier.active(path.value)[1]) for barrier in problem.barriers)
    assert all(step.longest <= 0.5 + 1e-12 for step in path.history)


@pytest.mark.parametrize("flat", [FLAT, 0.0])
def test_a_shell_of_hexagons_keeps_surface_and_rise(flat: float) -> None:
    _keeps_its_shape(shell_of_hexagons(), flat)


@pytest.mark.slow
@pytest.mark.parametrize("flat", [FLAT, 0.0])
def test_a_shell_of_hexagons_made_by_others(mesh_file: Callable[[str], Path], flat: float) -> None:
    _keeps_its_shape(read_mesh(mesh_file("aag.obj")).mesh, flat)


def _keeps_its_shape(mesh: Mesh, flat: float) -> None:
    """Within the distance and the rise of the specification, without a fold."""
    result = optimize(mesh, flat=flat, zigzag_limit=np.pi)
    change = result.change
    assert planarity_percent(mesh).max() > 10 * FLAT
    assert planarity_percent(result.mesh).max() <= max(flat, 1e-8)
    assert change.distance_mean < 0.2 * change.edge
    assert change.rise_kept == pytest.approx(1.0, abs=0.05)
    assert not len(change.folded)


def test_asking_for_less_costs_less() -> None:
    """On gentle meshes every step to flatter faces is one away from the surface."""
    mesh = dome(10)
    asked = (1.0, 0.5, 0.2, 0.0)
    results = [optimize(mesh, flat=flat) for flat in asked]
    far = [result.change.distance_mean for result in results]
    assert far == sorted(far)
    for flat, result in zip(asked[:-1], results, strict=False):  # no flatter than asked for
        assert 0.98 * flat < 100 * result.residual <= flat
    assert 0 < far[0] < 0.6 * far[-1]


# --- awkward meshes ------------------------------------------------------------------------------
def test_pieces_are_optimized_as_they_are_alone() -> None:
    """Two equal domes apart, in one mesh: each becomes what one alone becomes."""
    one = dome(8)
    shift = np.array([40.0, 5.0, 0.0])
    faces = [*one.faces, *(face + one.n_vertices for face in one.faces)]
    both = Mesh.build(np.concatenate([one.vertices, one.vertices + shift]), faces)
    alone, found = optimize(one), optimize(both)
    parts = found.mesh.vertices.reshape(2, -1, 3) - np.array([0 * shift, shift])[:, None]
    for part in parts:
        assert np.abs(part - alone.mesh.vertices).max() < 1e-6 * mean_edge(one)


def test_triangles_mixed_in_and_vertices_without_faces() -> None:
    mesh = dome(8)
    faces: list[np.ndarray] = []
    for number, face in enumerate(mesh.faces):
        faces += [face[[0, 1, 2]], face[[0, 2, 3]]] if number % 5 == 0 else [face]
    spare = np.array([[99.0, 0, 0]])
    mixed = Mesh.build(np.concatenate([mesh.vertices, spare]), faces)
    result = optimize(mixed, zigzag_limit=np.pi)
    assert planarity_percent(result.mesh).max() <= FLAT
    assert not len(result.change.folded)
    assert result.change.distance_mean < 0.1 * mean_edge(mixed)
    np.testing.assert_array_equal(result.mesh.vertices[-1], spare[0])


def test_sharp_corners_of_the_input_are_no_obstacle() -> None:
    """Corners of 6 deg at a tip: as planar as asked for, no sharper than by the slack."""
    mesh = dome(8)
    points = mesh.vertices.copy()
    corner = int(np.flatnonzero(mesh.valences == 2)[0])
    ends = mesh.edges[(mesh.edges == corner).any(axis=1)].sum(axis=1) - corner
    middle = points[ends].mean(axis=0)
    away = points[corner] - middle
    points[corner] = middle + away / np.linalg.norm(away) * np.linalg.norm(
        points[ends[0]] - points[ends[1]]
    ) / (2 * np.tan(np.radians(3)))
    sharp = mesh.with_vertices(points)
    least = np.degrees(sharp.corner_angles.min())
    assert 5.5 < least < 6.5
    result = optimize(sharp, distance_limit=(1.0, 5.0), zigzag_limit=np.pi)
    assert planarity_percent(result.mesh).max() <= FLAT
    assert not len(result.change.folded)


def test_corners_of_the_boundary_are_held() -> None:
    """Edges slide along a boundary, but not round its corners: those would be cut off."""
    mesh = dome(12)
    corners = rim_corners(mesh)
    assert sorted(corners.tolist()) == np.flatnonzero(mesh.valences == 2).tolist()
    moved = optimize(mesh).movement
    assert moved[corners].max() < 0.5 * moved[mesh.boundary_vertex].max()


def test_a_symmetric_roof_ends_the_same_however_it_is_turned() -> None:
    """Bends may form on either side of a mirror: numbers of vertices choose, not rounding."""
    mesh = roof(20, 12, rise=0.8)
    one = optimize(mesh, throw=False).mesh  # it is crumpled
    for seed in range(3):
        turn = rotation(seed)
        turned = optimize(mesh.with_vertices(mesh.vertices @ turn.T), throw=False).mesh
        assert np.abs(turned.vertices @ turn - one.vertices).max() < 1e-6


# --- sizes of panes ------------------------------------------------------------------------------
def test_edges_that_slide_keep_near_their_lengths(monkeypatch: pytest.MonkeyPatch) -> None:
    """Free to slide, edges of a turned dome become 1.7 times as long; what holds them is cheap."""
    mesh = dome(12)
    held = optimize(mesh).change
    assert held.edge_ratio[1] < 1.55
    assert held.edge_stretch[2] < 1.4
    monkeypatch.setattr(Weights, "of", staticmethod(partial(_without, "stretch", Weights.of)))
    loose = optimize(mesh).change
    assert loose.edge_ratio[1] > held.edge_ratio[1] + 0.1
    assert held.distance_mean < loose.distance_mean + 0.02 * held.edge


def _without(weight: str, of: Callable[..., Weights], *args: object, **options: object) -> Weights:
    return replace(of(*args, **options), **{weight: 0.0})


def test_nothing_slides_for_free() -> None:
    """A mesh without boundary that moves as a whole bends and strains nowhere: sliding holds it."""
    mesh = torus(12, 0.2)
    terms = [t for t in energy(mesh, Weights.of(mesh)) if isinstance(t, VectorTerm | LinearTerm)]
    shifted = (mesh.vertices + np.array([0.1, 0.0, 0.0])).ravel()
    cost = sum(t.weight * float((t.residual(shifted) ** 2).sum()) for t in terms)
    assert 1e-3 < cost / (mesh.n_vertices * 0.1**2) < 1e-2


def test_flanks_are_not_cut_off(monkeypatch: pytest.MonkeyPatch) -> None:
    """Vertices that slide stay near the surface; points of the surface hold the mesh between."""
    mesh = roof(20, 12, rise=0.8)
    held = optimize(mesh, boundary="glide", throw=False).change
    monkeypatch.setattr(Weights, "of", staticmethod(partial(_without, "cover", Weights.of)))
    loose = optimize(mesh, boundary="glide", throw=False).change
    assert held.distance_mean < 0.9 * loose.distance_mean
    assert held.distance_back[1] < loose.distance_back[1]


def test_a_surface_may_be_larger_than_the_mesh() -> None:
    """What lies beyond its boundary neither draws it nor counts as left bare."""
    whole = dome(12)
    points = whole.vertices.reshape(13, 13, 3)
    part = grid_mesh(points[3:10, 3:10])
    change = optimize(part, surface=whole).change
    rim = part.boundary_vertex
    assert change.movement[rim].mean() < 0.6 * change.edge
    assert change.from_surface.max() < 0.1 * change.edge


def test_stretched_edges_are_beyond_the_limits() -> None:
    mesh = dome(6)
    for factor, beyond in ((1.5, False), (1.7, True), (0.45, False), (0.3, True)):
        change = Change(mesh, mesh.with_vertices(factor * mesh.vertices), mesh)
        assert change.edge_stretch == pytest.approx((factor,) * 3)
        assert ("stretch" in Limits().kinds(change)) == beyond
    said = [text for text in Limits().exceeded(change) if "edges are stretched" in text]
    assert "5 of 100 to 0.30 of their length" in said[0]
    assert "limits 0.4 and 1.6" in said[0]


def test_the_boundary_is_laid_on_the_surface_given() -> None:
    """Rim and corners follow the surface across it, so that no edge of the old place is left."""
    mesh = dome(10)
    lower = mesh.with_vertices(mesh.vertices - [0, 0, 0.5])
    result = optimize(mesh, surface=lower)
    rim = mesh.boundary_vertex
    assert result.change.from_surface[rim].mean() < 0.15 * mean_edge(mesh)


# --- meshes made by others -----------------------------------------------------------------------
@pytest.mark.slow
def test_a_smooth_mesh_made_by_others_is_invariant(mesh_file: Callable[[str], Path]) -> None:
    mesh = read_mesh(mesh_file("botanic_garden_bubble.obj")).mesh
    edge, turn = mean_edge(mesh), rotation()
    found = optimize(mesh)
    shift = np.array([1e3, -2e3, 3e2]) * edge
    order = np.random.default_rng(3).permutation(mesh.n_vertices)
    where = np.argsort(order)
    shuffled = Mesh.build(mesh.vertices[order], [where[face] for face in mesh.faces[::-1]])
    for other, back in (
        (mesh.with_vertices(mesh.vertices @ turn.T), lambda x: x @ turn),
        (mesh.with_vertices(1e3 * mesh.vertices), lambda x: x / 1e3),
        (mesh.with_vertices(mesh.vertices + shift), lambda x: x - shift),
        (shuffled, lambda x: x[where]),
    ):
        again = back(optimize(other).mesh.vertices)
        assert np.linalg.norm(again - found.mesh.vertices, axis=1).max() < 1e-8 * edge
    less = optimize(mesh, flat=0.5)
    assert less.change.distance_mean <= found.change.distance_mean

"""Equal edges and panels as soft wishes: what they reach, what they cost, refusals."""

from __future__ import annotations

import numpy as np
import pytest
from optimize_meshes import dome, rotation

from ddgfab.errors import InputError, OptimizeError
from ddgfab.grid import grid_mesh
from ddgfab.measures import planarity_percent
from ddgfab.mesh import Mesh
from ddgfab.optimize import OptimizeResult, mean_edge, optimize
from ddgfab.optimize.report import comparison, comparison_text

MESH = dome(8)


def spread(mesh: Mesh) -> float:
    """How far edges are from their mean, root mean square over the mean."""
    return float(mesh.edge_lengths.std() / mesh.edge_lengths.mean())


def test_more_weight_makes_edges_more_equal_and_costs_distance() -> None:
    plain = optimize(MESH)
    found = [optimize(MESH, equal_edges=1, equal_weight=w) for w in (1.0, 10.0)]
    spreads = [spread(r.mesh) for r in (plain, *found)]
    assert spreads[0] > 1.3 * spreads[1] > 1.3**2 * spreads[2]
    costs = [r.change.distance_mean for r in (plain, *found)]
    assert costs == sorted(costs)
    for result in found:
        assert planarity_percent(result.mesh).max() <= 0.2
        assert not len(result.change.folded)


def test_the_price_is_that_of_a_run_without_the_wish() -> None:
    plain = optimize(MESH)
    result = optimize(MESH, equal_edges=1)
    assert result.wishes is not None
    assert result.wishes.met_without
    assert result.wishes.distance_mean == plain.change.distance_mean
    assert result.wishes.distance_max == plain.change.distance_max
    (one,) = result.wishes.repetitions
    before, without, now = one.spread
    scale = mean_edge(MESH)
    for value, mesh in ((before, MESH), (without, plain.mesh), (now, result.mesh)):
        assert value == pytest.approx(mesh.edge_lengths.std() / mean_edge(mesh), rel=1e-9)
    assert scale > 0
    assert optimize(MESH).wishes is None


def test_a_net_with_two_lengths_finds_back_to_them() -> None:
    """A translation net of equal chords, 1 and 1.3 long, shaken by 2 %."""

    def arc(count: int, chord: float, turn: float) -> np.ndarray:
        a = turn * np.arange(-count / 2, count / 2 + 1)
        return np.asarray(chord / (2 * np.sin(turn / 2)) * np.stack([np.sin(a), np.cos(a)]))

    u, v = arc(8, 1.0, 0.08), arc(6, 1.3, 0.07)
    points = np.zeros((9, 7, 3))
    points[..., 0], points[..., 1] = u[0][:, None], v[0]
    points[..., 2] = u[1][:, None] + v[1]
    exact = grid_mesh(points)
    np.testing.assert_allclose(np.unique(exact.edge_lengths.round(9)), [1.0, 1.3])
    noise = 0.02 * np.random.default_rng(0).normal(size=points.shape)
    shaken = grid_mesh(points + noise)
    result = optimize(shaken, flat=0, equal_edges=2, equal_weight=100)
    assert result.wishes is not None
    before, without, now = result.wishes.repetitions[0].spread
    assert now < 0.1 * min(before, without)
    groups = [result.mesh.edge_lengths[exact.edge_lengths < 1.15], result.mesh.edge_lengths]
    assert groups[0].mean() == pytest.approx(1.0, abs=0.01)


def test_panels_of_one_shape() -> None:
    plain, found = optimize(MESH), optimize(MESH, equal_panels=1, equal_weight=10)
    corners = MESH.corners.reshape(-1, 4)

    def diagonals(mesh: Mesh) -> float:
        ends = mesh.vertices[corners]
        lengths = np.linalg.norm(ends[:, :2] - ends[:, 2:], axis=2)
        return float(np.sort(lengths, axis=1).std(axis=0).max())

    assert diagonals(found.mesh) < 0.8 * diagonals(plain.mesh)
    assert found.wishes is not None
    assert found.wishes.repetitions[0].of == "panel"


def test_meshes_that_meet_the_goal_move_for_a_wish() -> None:
    """Triangles are planar: nothing is to do without the wish."""
    faces = [f for q in MESH.corners.reshape(-1, 4) for f in (q[[0, 1, 2]], q[[0, 2, 3]])]
    mesh = Mesh.build(MESH.vertices, faces)
    result = optimize(mesh, equal_edges=3, equal_weight=10)
    assert result.wishes is not None
    before, without, now = result.wishes.repetitions[0].spread
    assert without == before
    assert now < 0.8 * before
    assert result.wishes.distance_mean < 1e-9 < result.change.distance_mean


def test_wishes_do_not_depend_on_unit_place_and_order() -> None:
    options = {"equal_edges": 2, "equal_panels": 1}
    best = optimize(MESH, **options).mesh.vertices
    turn, shift = rotation(), np.array([1e4, -2e4, 3e3])
    moved = MESH.with_vertices(1e3 * MESH.vertices @ turn.T + shift)
    found = (optimize(moved, **options).mesh.vertices - shift) @ turn / 1e3
    assert np.abs(found - best).max() < 1e-7
    order = np.random.default_rng(3).permutation(MESH.n_vertices)
    where = np.argsort(order)
    other = Mesh.build(MESH.vertices[order], [where[face] for face in MESH.faces[::-1]])
    assert np.abs(optimize(other, **options).mesh.vertices[where] - best).max() < 1e-7


def test_a_wish_that_costs_too_much_is_named_and_made_softer() -> None:
    limit = (1.5 * optimize(MESH).change.distance_mean / mean_edge(MESH), 1.0)
    options = {"equal_edges": 1, "equal_weight": 30.0, "distance_limit": limit}
    with pytest.raises(OptimizeError, match="without the wish for equal pieces") as caught:
        optimize(MESH, **options)  # type: ignore[arg-type]
    best = caught.value.result
    assert isinstance(best, OptimizeResult)
    assert best.wishes is not None
    for _ in range(6):
        assert best.advice[0][0] == "equal_weight"
        options |= dict(best.advice)  # type: ignore[arg-type]
        best = optimize(MESH, throw=False, **options)  # type: ignore[arg-type]
        if best.status == "converged":
            break
    assert best.status == "converged"
    assert spread(best.mesh) < spread(optimize(MESH).mesh)


def test_report() -> None:
    result = optimize(MESH, equal_edges=2)
    record = comparison(result)["wishes"]
    assert record["repetitions"][0]["kinds"] == 2
    assert len(record["repetitions"][0]["spread"]) == 3
    text = comparison_text(result)
    assert "equal edges, 2 lengths: lengths differ from them by" in text
    assert "price of the wish, distance mean / greatest:" in text
    assert "price of the wish" not in comparison_text(optimize(MESH))


@pytest.mark.parametrize(
    ("text", "options"),
    [
        ("equal_edges = -1", {"equal_edges": -1}),
        ("equal_weight = 0: must be positive", {"equal_edges": 1, "equal_weight": 0}),
        ("equal_panels = 65: the mesh has 64 panels", {"equal_panels": 65}),
        ('equal_edges is for goals planar.*, not for "families"', {"goal": "families"}),
    ],
)
def test_refusals(text: str, options: dict[str, object]) -> None:
    with pytest.raises(InputError, match=text):
        optimize(MESH, **({"equal_edges": 1} | options))  # type: ignore[arg-type]

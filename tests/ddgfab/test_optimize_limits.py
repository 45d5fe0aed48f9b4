"""optimize: limits and the advice they end in, the price list and the forecast."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from optimize_meshes import ANY_ZIGZAG, CASES, FLAT, dome, roof, wavy

from ddgfab.errors import OptimizeError
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Mesh
from ddgfab.optimize import (
    Limits,
    OptimizeResult,
    better_diagonals,
    expected,
    mean_edge,
    optimize,
)
from ddgfab.optimize.advice import advice_text
from ddgfab.optimize.directions import TRACE, accepted, other_way
from ddgfab.optimize.forecast import HARMLESS, doubtful, forecast_text


def test_beyond_the_limits_the_goal_is_missed_and_the_next_option_named() -> None:
    mesh = dome(12)
    edge = mean_edge(mesh)
    wide = optimize(mesh)
    near = wide.change.distance_mean / edge
    with pytest.raises(OptimizeError, match="mean distance from the surface") as caught:
        optimize(mesh, distance_limit=(0.5 * near, 1.0))
    best = caught.value.result
    assert isinstance(best, OptimizeResult)
    assert best.status == "missed"
    assert best.advice == (("keep", "close"),)
    assert 'keep = "close"' in str(caught.value)
    limit = 0.01 * wide.movement_max
    with pytest.raises(
        OptimizeError, match=f"move further: max_movement = {2 * limit:.2g}"
    ) as caught:
        optimize(mesh, max_movement=limit)
    assert isinstance(caught.value.result, OptimizeResult)
    assert caught.value.result.movement_max < limit


def followed(mesh: Mesh) -> tuple[OptimizeResult, dict[str, object]]:
    """What comes of a mesh when all advice is followed, and that advice."""
    options: dict[str, object] = {}
    for _ in range(5):
        result = optimize(mesh, throw=False, **options)  # type: ignore[arg-type]
        if result.status == "converged":
            break
        assert result.advice
        options |= dict(result.advice)
        if TRACE in options:
            break
    return result, options


@pytest.mark.parametrize("name", ["wavy 6", "wavy 8", "lines of a saddle", "roof"])
def test_the_advice_helps(name: str) -> None:
    """Waves along both directions, straight lines of a saddle, 3 to 20 cells: diagonals help.

    Smooth faces flatten such meshes, keeping the surface crumples them.
    """
    u, v = np.meshgrid(np.arange(5.0), np.arange(4.0), indexing="ij")
    mesh = {
        "wavy 6": wavy(6),
        "wavy 8": wavy(8),
        "lines of a saddle": grid_mesh(np.stack([u, v, 0.15 * (u - 2) * (v - 1.5)], axis=-1)),
        "roof": roof(20, 12),
    }[name]
    result, options = followed(mesh)
    assert result.status == "converged"
    assert options["diagonals"] is True
    assert result.change.distance_mean < 0.1 * result.change.edge
    assert result.change.rise_kept is not None
    assert result.change.rise_kept > 0.9


def test_where_only_another_net_helps_a_trace_is_advised() -> None:
    """Waves whose edges run half way between the conjugate directions and their diagonals."""
    u, v = np.meshgrid(np.arange(-10.0, 11.0), np.arange(-6.0, 7.0), indexing="ij")
    x, y = np.cos(0.39) * u - np.sin(0.39) * v, np.sin(0.39) * u + np.cos(0.39) * v
    height = 2 * np.sin(np.pi * x / 5 + 0.5) * np.cos(np.pi * y / 5)
    mesh = grid_mesh(np.stack([u, v, height], axis=-1))
    result, options = followed(mesh)
    assert result.status == "missed"
    assert options[TRACE] == pytest.approx(mean_edge(mesh), rel=0.01)


@pytest.mark.parametrize("shape", ["tube", "pieces"])
def test_where_no_net_can_be_traced_the_result_is_accepted_as_it_is(shape: str) -> None:
    """A net is traced anew on a disk alone: the last advice names limits, and they are kept."""
    flat = roof(10, 8, 1.2)
    u, v, height = flat.vertices.reshape(11, 9, 3)[:10].transpose(2, 0, 1)
    turn, far = 2 * np.pi * u / 10, 2 + 0.4 * height
    mesh = grid_mesh(np.stack([far * np.cos(turn), far * np.sin(turn), v], -1), (True, False))
    if shape == "pieces":
        faces = [*flat.faces, *(face + flat.n_vertices for face in flat.faces)]
        shift = np.array([40.0, 0, 0])
        mesh = Mesh.build(np.concatenate([flat.vertices, flat.vertices + shift]), faces)
    first = optimize(mesh, "conical", distance_limit=(0.01, 0.02), throw=False)
    limits = Limits(distance_mean=0.01, distance_max=0.02)
    found = accepted(first, limits)
    assert found
    assert not {TRACE, "diagonals"} & set(dict(other_way(first, "fair", limits)))
    again = optimize(mesh, "conical", **{"distance_limit": (0.01, 0.02), **dict(found)})  # type: ignore[arg-type]
    assert again.status == "converged"
    assert "one boundary" in advice_text((("zigzag_limit", 0.1),))


def test_folded_faces_are_never_accepted() -> None:
    mesh = dome(6)
    result = optimize(mesh)
    points = mesh.vertices.copy()
    points[24] += 3.0 * (points[25] - points[24])  # beyond its neighbour
    folded = replace(result, mesh=mesh.with_vertices(points))
    assert "folded" in Limits().kinds(folded.change)
    assert accepted(folded, Limits()) == ()


def test_after_close_an_even_closer_number_is_advised() -> None:
    """A dome whose conical net is far off: what is named next is nearer."""
    mesh = dome(24)
    far = [0.001, 0.002]
    limits = {"distance_limit": (far[0], far[1]), "throw": False, **ANY_ZIGZAG}
    first = optimize(mesh, "conical", keep="close", **limits)  # type: ignore[arg-type]
    assert first.advice == (("keep", 0.1),)
    second = optimize(mesh, "conical", keep=0.1, **limits)  # type: ignore[arg-type]
    assert second.change.distance_mean < first.change.distance_mean
    assert second.advice != first.advice


def test_prices_fall_and_end_at_the_goal() -> None:
    result = optimize(dome(12))
    percent = [price.percent for price in result.prices]
    assert len(percent) > 1
    assert percent == sorted(percent, reverse=True)
    assert percent[-1] <= FLAT
    assert all(p.distance_mean <= p.distance_max <= p.movement_max + 0.05 for p in result.prices)


@pytest.mark.parametrize("name", ["wavy", "saddle of hexagons"])
def test_the_forecast_is_right_within_a_factor(name: str) -> None:
    mesh = CASES[name][0]()
    told = expected(mesh)
    assert told is not None
    result = optimize(mesh, **ANY_ZIGZAG)
    found = float(result.change.from_surface.mean())
    assert 0.5 < told.distance_mean / found < 2
    assert told == replace(told, distance_mean=result.forecast.distance_mean)  # type: ignore[union-attr]


def test_the_forecast_tells_which_edges_can_turn_in_the_surface() -> None:
    """A dome off its principal directions is only slid; waves are left, and a trace is advised."""
    smooth, waves = expected(dome(12)), expected(roof(20, 12))
    assert smooth is not None
    assert waves is not None
    assert smooth.distance_mean < HARMLESS * smooth.unit
    assert not doubtful(smooth)
    assert "conjugate" not in forecast_text(smooth)
    assert doubtful(waves)
    for part in ("do not follow conjugate directions", "--retrace"):
        assert part in forecast_text(waves)
    diagonals = better_diagonals(roof(20, 12))
    assert diagonals is not None
    assert not doubtful(diagonals)
    assert "--diagonals" in forecast_text(waves, "mm", diagonals)


def test_no_forecast_for_planar_faces() -> None:
    assert expected(optimize(dome(8), flat=0).mesh) is None

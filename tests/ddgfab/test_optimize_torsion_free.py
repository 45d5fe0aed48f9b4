"""Recipe torsion-free: what it reaches, what it keeps, what it refuses."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ddgfab.errors import DegenerateError, InputError, OptimizeError, SupportError
from ddgfab.grid import grid_mesh
from ddgfab.io import read_mesh
from ddgfab.measures import lean, planarity_percent, torsion
from ddgfab.mesh import Mesh
from ddgfab.optimize import (
    TorsionFreeResult,
    folded_faces,
    mean_edge,
    optimize,
    torsion_goal,
)
from ddgfab.optimize.report import comparison, comparison_text
from ddgfab.support import (
    SupportStructure,
    even_lean,
    parallel_axes,
    support_structure,
    torsion_free_axes,
)
from ddgfab.tolerances import TORSION_EXACT_DEG


def vault(turn_deg: float = 25.0, count: int = 5) -> Mesh:
    """A paraboloid z = (x^2 - 0.3 y^2) / 12 under a square grid turned off its principal lines."""
    i, j = np.meshgrid(*(np.arange(count + 1.0) - count / 2,) * 2, indexing="ij")
    c, s = np.cos(np.radians(turn_deg)), np.sin(np.radians(turn_deg))
    x, y = c * i - s * j, s * i + c * j
    return grid_mesh(np.stack([x, y, (x**2 - 0.3 * y**2) / 12], axis=-1))


def hull(m: int = 12, n: int = 8, oblique_deg: float = 50.0) -> Mesh:
    """Steep arcs in planes at an angle to a shallow arc: a translation net, twisted lengthwise.

    Its edges are conjugate but far from the principal directions, and the normals turn by 160 deg.
    """
    across, along, twist = np.radians(160.0), np.radians(60.0), 0.04
    s, t = np.linspace(-1, 1, n + 1) * across / 2, np.linspace(-1, 1, m + 1) * along / 2
    wide, long = n / across, m / along
    turn = np.radians(oblique_deg)
    x = long * np.sin(t)[:, None] + wide * np.sin(s) * np.sin(turn)
    y = wide * np.sin(s) * np.cos(turn) + 0 * t[:, None]
    z = long * (np.cos(t)[:, None] - 1) + wide * np.cos(s)
    c, i = np.cos(twist * x / m), np.sin(twist * x / m)
    return grid_mesh(np.stack([x, c * y - i * z, i * y + c * z], axis=-1))


def honeycomb(count: int) -> Mesh:
    """Hexagons over a paraboloid, a little skew."""
    sqrt3 = np.sqrt(3.0)
    ids: dict[tuple[int, int], int] = {}
    points: list[list[float]] = []
    faces = []
    turns = np.radians(60.0 * np.arange(6) + 30.0)
    for a in range(count):
        for b in range(count):
            center = np.array([sqrt3 * (a + 0.5 * b), 1.5 * b])
            face = []
            for x, y in center + np.stack([np.cos(turns), np.sin(turns)], axis=1):
                key = round(1e3 * x), round(1e3 * y)
                if key not in ids:
                    ids[key] = len(points)
                    points.append([x, y, -0.03 * (x - 3) ** 2 - 0.05 * (y - 2) ** 2 + 0.01 * x * y])
                face.append(ids[key])
            faces.append(face)
    return Mesh.build(points, faces)


def torsion_free(mesh: Mesh, **options: Any) -> TorsionFreeResult:
    """The goal by its name."""
    result = optimize(mesh, "torsion-free", **options)
    assert isinstance(result, TorsionFreeResult)
    return result


def check(result: TorsionFreeResult, lean_deg: float = 12.0) -> None:
    """What every result promises, measured anew."""
    assert result.status == "converged"
    assert np.degrees(torsion(result.mesh, result.axes)).max() <= TORSION_EXACT_DEG
    assert planarity_percent(result.mesh).max() < 1e-8
    assert not len(folded_faces(result.mesh, result.original))
    assert not len(result.change.reflex_quads)
    assert np.allclose(np.linalg.norm(result.axes, axis=1), 1.0)
    assert np.degrees(lean(result.mesh, result.axes)).max() < lean_deg
    edge = mean_edge(result.original)
    assert result.change.distance_mean < 0.25 * edge
    assert result.change.distance_max < edge


@pytest.fixture(scope="module")
def found() -> TorsionFreeResult:
    return torsion_free(vault())


def test_moving_vertices_lets_axes_stand_up(found: TorsionFreeResult) -> None:
    """Vertices fixed: axes lean by more, and faces are not planar."""
    check(found)
    fixed = even_lean(found.original)
    assert found.support.lean_deg_max < 0.6 * fixed.lean_deg_max
    assert planarity_percent(found.original).max() > 1
    assert found.goal == "torsion-free"
    assert found.tried == ()


def test_a_result_is_left_as_it_is(found: TorsionFreeResult) -> None:
    again = torsion_free(found.mesh)
    assert again.mesh is found.mesh
    assert again.history == ()
    check(again)


def test_support_structure_takes_the_axes(found: TorsionFreeResult) -> None:
    support = support_structure(found.mesh, axes=found.axes)
    assert support.kind == "given"
    assert np.allclose(support.axes, found.axes)
    # axes that lean too far, or have torsion, are passed over
    assert support_structure(found.mesh, axes=found.axes, lean_limit_deg=0.01).kind != "given"
    assert support_structure(found.mesh, axes=found.mesh.vertex_normals).kind != "given"
    with pytest.raises(SupportError, match="shape"):
        support_structure(found.mesh, axes=found.axes[:-1])


@pytest.fixture(scope="module")
def upright() -> TorsionFreeResult:
    return torsion_free(hull())


def test_a_twisted_hull(upright: TorsionFreeResult) -> None:
    """Nearly planar faces, yet axes of every parallel mesh lean by 57 deg: vertices must slide."""
    mesh = upright.original
    assert 0.1 < planarity_percent(mesh).max() < 0.15
    still = [
        SupportStructure.of(mesh, parallel_axes(mesh)).lean_deg_max,
        torsion_free_axes(mesh, throw=False).lean_deg_max,
    ]
    assert min(still) > 55
    check(upright)


def test_less_lean_costs_distance(upright: TorsionFreeResult) -> None:
    """The barrier holds the lean below any limit; the price is distance from the surface."""
    leaning = torsion_free(upright.original, max_lean=np.radians(24.0))
    check(leaning, 24.0)
    assert leaning.support.lean_deg_max > 12.0
    assert leaning.change.distance_mean < upright.change.distance_mean


def test_no_vertex_moves_beyond_the_limit() -> None:
    mesh = vault()
    free = torsion_free(mesh)
    limit = 0.8 * free.movement_max
    result = torsion_free(mesh, max_movement=limit, rise_limit=0.75)
    check(result, 30.0)
    assert result.movement_max < limit


def test_gliding_boundary() -> None:
    mesh = vault(turn_deg=5.0, count=4)
    result = torsion_free(mesh, boundary="glide")
    check(result)
    rim = np.flatnonzero(mesh.boundary_vertex)
    corners = np.flatnonzero(mesh.valences == 2)
    assert result.movement[rim].max() > 1e-3
    assert np.array_equal(result.mesh.vertices[corners], mesh.vertices[corners])
    ends = mesh.vertices[mesh.edges[mesh.boundary_edge]]
    along = ends[:, 1] - ends[:, 0]
    for point in result.mesh.vertices[rim]:
        part = np.einsum("ex,ex->e", point - ends[:, 0], along) / (along**2).sum(axis=1)
        foot = ends[:, 0] + np.clip(part, 0, 1)[:, None] * along
        assert np.linalg.norm(point - foot, axis=1).min() < 0.02


def test_a_fixed_boundary() -> None:
    """Possible where the boundary nearly follows principal lines, and refused where it does not."""
    mesh = vault(turn_deg=5.0)
    wide = {"zigzag_limit": 0.3, "stretch_limit": 1.0}  # edges next to the boundary stretch
    result = torsion_free(mesh, boundary="fixed", max_lean=np.radians(28.0), **wide)
    check(result, 28.0)
    rim = mesh.boundary_vertex
    assert np.array_equal(result.mesh.vertices[rim], mesh.vertices[rim])
    with pytest.raises(OptimizeError, match=r"faces stay .* from planar") as caught:
        torsion_free(vault(), boundary="fixed", max_lean=np.radians(28.0))
    assert 'boundary = "free"' in str(caught.value)
    assert isinstance(caught.value.result, TorsionFreeResult)


def test_fixed_vertices_stay() -> None:
    mesh = vault(turn_deg=12.0)
    result = torsion_free(mesh, fixed=[0, 17])
    check(result)
    assert np.array_equal(result.mesh.vertices[[0, 17]], mesh.vertices[[0, 17]])


def test_limits_are_tried_in_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    """What less lean would have cost is told where the first limit is out of reach."""
    monkeypatch.setattr(torsion_goal, "LEANS_DEG", (0.5, 30.0))
    result = torsion_free(hull(8, 6))
    check(result, 30.0)
    assert [trial.met for trial in result.tried] == [False, True]
    assert result.tried[1].own["lean_deg_max"] == pytest.approx(result.support.lean_deg_max)
    assert result.remarks[0].startswith("lean up to 0.5 deg: not within the limits")
    stages = [stage for stage, _ in result.history]
    assert stages[0] == "lean up to 0.5 deg"
    assert stages[-1] == "lean up to 30 deg"


def test_report(found: TorsionFreeResult) -> None:
    """The numbers of every goal, and those of the axes."""
    report = comparison(found)
    assert report["lean_deg_max"] == pytest.approx(np.degrees(found.support.lean.max()))
    assert report["design"]["distance_mean"] == found.change.distance_mean
    assert report["prices"][-1]["percent"] < 1e-6
    text = comparison_text(found)
    for part in ("distance from the surface, both ways", "rise", "creases", "price", "lean max"):
        assert part in text


def test_hexagons() -> None:
    """Three edges a node: every planar mesh has parallel meshes enough, so axes stand upright."""
    result = torsion_free(honeycomb(2))
    check(result)
    assert result.support.lean_deg_max < 5


def test_axes_only() -> None:
    mesh = vault()
    result = torsion_free(mesh, axes_only=True)
    assert np.array_equal(result.mesh.vertices, mesh.vertices)
    assert result.support.torsion_deg_max <= TORSION_EXACT_DEG
    even = even_lean(mesh).lean_deg_max
    limit = 1.05 * even
    bounded = torsion_free(mesh, axes_only=True, max_lean=np.radians(limit))
    assert bounded.support.lean_deg_max < limit
    with pytest.raises(OptimizeError, match=r"axis torsion stays at .* worst edge \d"):
        torsion_free(mesh, axes_only=True, max_lean=np.radians(1.0))


def test_limits_that_cannot_be_kept() -> None:
    """A hundredth of an edge does not make the faces planar."""
    mesh = vault(count=3)
    options = {"max_lean": np.radians(1.0), "max_movement": 0.01}
    with pytest.raises(OptimizeError, match=r"faces stay .* from planar.*worst") as caught:
        torsion_free(mesh, **options)
    assert "max_movement = 0.02" in str(caught.value)
    best = caught.value.result
    assert isinstance(best, TorsionFreeResult)
    assert best.status == "missed"
    assert best.movement_max < 0.01
    again = torsion_free(mesh, **options, throw=False)
    assert again.status == "missed"
    assert np.array_equal(again.mesh.vertices, best.mesh.vertices)


def test_refusals() -> None:
    mesh = vault(count=2)
    with pytest.raises(InputError, match="max_lean = 0"):
        torsion_free(mesh, max_lean=0.0)
    with pytest.raises(InputError, match=r"max_movement = -1"):
        torsion_free(mesh, max_movement=-1.0)
    with pytest.raises(InputError, match="fixed vertex 9; ids run from 0 to 8"):
        torsion_free(mesh, fixed=[9])
    with pytest.raises(InputError, match="one of free, glide, fixed"):
        torsion_free(mesh, boundary="loose")
    triangle = Mesh.build([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    with pytest.raises(SupportError, match="triangle mesh"):
        torsion_free(triangle)
    points = mesh.vertices.copy()
    points[[0, 1, 3, 4]] = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]]
    with pytest.raises(DegenerateError, match="face 0 has no area"):
        torsion_free(mesh.with_vertices(points))


def test_small_dome(mesh_file: Callable[[str], Path]) -> None:
    result = torsion_free(read_mesh(mesh_file("quad_dome.obj")).mesh)
    check(result, 2.0)  # 1.4 deg with vertices fixed, faces not planar


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "lean_deg", "distance"),
    [("botanic_garden_bubble", 11.0, (0.06, 0.38)), ("heart", 22.4, (0.2, 1.0))],
)
def test_meshes_made_by_others(
    mesh_file: Callable[[str], Path], name: str, lean_deg: float, distance: tuple[float, float]
) -> None:
    """A solver that moved vertices by limited distances had these leans, at mean distances of 0.098
    and 0.420, greatest 0.380 and 1.096 mean edges. Heart has corners of 6 deg."""
    result = torsion_free(read_mesh(mesh_file(f"{name}.obj")).mesh)
    check(result, lean_deg)
    edge = mean_edge(result.original)
    assert result.change.distance_mean < distance[0] * edge
    assert result.change.distance_max < distance[1] * edge

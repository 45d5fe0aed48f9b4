"""Coarser meshes to begin with: what is left out, and that results are as good."""

from __future__ import annotations

import numpy as np
import pytest
from optimize_meshes import dome, hexagons, torus, wavy

from ddgfab.grid import grid_mesh
from ddgfab.measures import planarity_percent
from ddgfab.mesh import Floats, Mesh
from ddgfab.optimize import PathOptions, optimize
from ddgfab.optimize import nets as reaching
from ddgfab.optimize.coarse import coarsened
from ddgfab.optimize.energy import Weights, energy
from ddgfab.optimize.frame import Frame
from ddgfab.optimize.limits import Limits
from ddgfab.optimize.net_goals import PLANAR
from ddgfab.optimize.terms.base import LinearTerm, VectorTerm


def test_every_other_line_is_left_out() -> None:
    mesh = dome(8)
    coarse = coarsened(mesh)
    assert coarse is not None
    coarse.mesh.validate()
    assert coarse.mesh.n_faces == mesh.n_faces // 4
    np.testing.assert_array_equal(coarse.mesh.vertices, mesh.vertices[coarse.kept])
    facing = coarse.mesh.face_normals @ mesh.face_normals.mean(axis=0)
    assert facing.min() > 0
    assert set(np.flatnonzero(mesh.valences == 2)) <= set(coarse.kept.tolist())
    closed = coarsened(torus(12, 0.2))
    assert closed is not None
    assert not closed.mesh.boundary_edge.any()
    assert closed.mesh.n_faces == 36


def test_linear_values_are_prolonged_exactly_on_a_regular_grid() -> None:
    mesh = dome(6)
    flat = mesh.with_vertices(
        np.stack(np.meshgrid(np.arange(7.0), np.arange(7.0), [0.0], indexing="ij"), -1).reshape(
            -1, 3
        )
    )
    coarse = coarsened(flat)
    assert coarse is not None
    turn = np.array([[1.0, 2, 3], [0, -1, 4], [2, 0, 1]])
    found = coarse.prolonged(flat.vertices[coarse.kept] @ turn)
    np.testing.assert_allclose(found, flat.vertices @ turn, atol=1e-12)


@pytest.mark.parametrize(("rows", "columns"), [(7, 8), (9, 13), (2, 25)])
def test_odd_numbers_of_strips_keep_one_as_it_is(rows: int, columns: int) -> None:
    u, v = np.meshgrid(np.arange(rows + 1.0), np.arange(columns + 1.0), indexing="ij")
    mesh = grid_mesh(np.stack([u, v, 0.1 * u * v], axis=-1), (False, False))
    coarse = coarsened(mesh)
    assert coarse is not None
    coarse.mesh.validate()
    assert coarse.mesh.n_faces == -(-rows // 2) * -(-columns // 2)
    areas = coarse.mesh.with_vertices(coarse.mesh.vertices * [1, 1, 0]).face_areas
    assert areas.sum() == pytest.approx(rows * columns)
    np.testing.assert_allclose(  # bilinear: exact
        coarse.prolonged(mesh.vertices[coarse.kept]), mesh.vertices, atol=1e-12
    )


def test_strips_that_were_left_are_merged_next() -> None:
    """So no coarse face is much narrower than others."""
    mesh: Mesh | None = dome(47)
    for count in (24, 12, 6):
        coarse = coarsened(mesh)
        assert coarse is not None
        mesh = coarse.mesh
        assert mesh.n_faces == count**2
        assert mesh.edge_lengths.min() > 0.3 * mesh.edge_lengths.max()


def test_polylines_of_irregular_vertices_stay() -> None:
    """Three grids round a vertex of valence three, an odd number of edges wide."""
    mesh = triple(5)
    coarse = coarsened(mesh)
    assert coarse is not None
    coarse.mesh.validate()
    assert coarse.mesh.n_faces == 27
    center = np.flatnonzero((mesh.valences == 3) & ~mesh.boundary_vertex)
    assert set(center) <= set(coarse.kept.tolist())
    np.testing.assert_allclose(
        coarse.prolonged(mesh.vertices[coarse.kept]), mesh.vertices, atol=1e-12
    )


def triple(n: int) -> Mesh:
    """Three rhombi of n x n quads in the plane, round one vertex."""
    turns = 2 * np.pi / 3 * np.arange(3)
    ways = np.stack([np.cos(turns), np.sin(turns), 0 * turns], axis=1)
    points, faces = [], []
    u, v = (a.ravel()[:, None] for a in np.meshgrid(*2 * [np.arange(n + 1)], indexing="ij"))
    one = grid_mesh(np.zeros((n + 1, n + 1, 3)), (False, False)).faces
    for k in range(3):
        points.append(u * ways[k] + v * ways[(k + 1) % 3])
        faces += [face + k * (n + 1) ** 2 for face in one]
    everywhere = np.concatenate(points)
    _, first, number = np.unique(
        np.round(everywhere, 6), axis=0, return_index=True, return_inverse=True
    )
    return Mesh.build(everywhere[first], [number.ravel()[face] for face in faces])


def test_meshes_that_cannot_be_coarser() -> None:
    assert coarsened(hexagons(4)) is None
    assert coarsened(torus(5, 0.1)) is None  # too few strips would be left round the tube
    assert coarsened(dome(1)) is None
    one = dome(4)
    pieces = Mesh.build(
        np.concatenate([one.vertices, one.vertices + np.array([20.0, 0, 0])]),
        [*one.faces, *(face + one.n_vertices for face in one.faces)],
    )
    both = coarsened(pieces)
    assert both is not None
    assert both.mesh.n_faces == 8


def test_a_coarse_mesh_has_the_energy_of_the_fine_one() -> None:
    """Of a smooth movement, but for one factor: the fourth power of the ratio of mean edges."""
    mesh = dome(32)
    mesh = Frame.of(mesh).inside(mesh)
    coarse = coarsened(mesh)
    assert coarse is not None
    scale = float(coarse.mesh.edge_lengths.mean())
    small = coarse.mesh.with_vertices(coarse.mesh.vertices / scale)
    waves = np.array([[0.05, 0.02, 0.0], [0.0, 0.04, 0.03], [0.06, 0.0, 0.01]])
    move = np.sin(mesh.vertices @ waves)
    weights = Weights(fair=10.0)

    def parts(one: Mesh, by: Floats, given: Weights) -> dict[str, float]:
        terms = [t for t in energy(one, given) if isinstance(t, VectorTerm | LinearTerm)]
        moved = (one.vertices + by).ravel()
        found = {t.name: t.weight * float((t.residual(moved) ** 2).sum()) for t in terms[:-1]}
        return found | {"corner": terms[-1].weight * float((terms[-1].residual(moved) ** 2).sum())}

    fine = parts(mesh, move, weights)
    rough = parts(small, move[coarse.kept] / scale, weights.coarser(scale))
    assert len(fine) == 6
    for name, value in fine.items():
        assert rough[name] * scale**4 == pytest.approx(value, rel=0.25), name


def test_results_from_a_coarser_mesh_are_as_good(monkeypatch: pytest.MonkeyPatch) -> None:
    mesh = dome(24)
    plain = optimize(mesh)
    monkeypatch.setattr(reaching, "LEAST_FACES", 100)
    nested = optimize(mesh)
    assert not np.array_equal(plain.mesh.vertices, nested.mesh.vertices)
    assert planarity_percent(nested.mesh).max() <= 0.2
    assert nested.change.distance_mean < 1.3 * plain.change.distance_mean + 0.01 * plain.change.edge
    assert not len(nested.change.folded)


def test_fixed_vertices_stay_and_options_of_a_path_are_kept(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(reaching, "LEAST_FACES", 100)
    mesh = dome(12)
    fixed = [0, 5, 84]
    result = optimize(mesh, fixed=fixed)
    assert np.array_equal(result.mesh.vertices[fixed], mesh.vertices[fixed])
    own = PathOptions(tolerance=2e-3)
    found = reaching.reach(mesh, PLANAR, options=own).result
    monkeypatch.undo()
    same = reaching.reach(mesh, PLANAR, options=own).result
    np.testing.assert_array_equal(found.mesh.vertices, same.mesh.vertices)


def test_noise_falls_back_to_the_mesh_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    """The movement of a noisy coarse mesh would fold the fine one."""
    mesh = wavy(16, 0.06)
    anything = Limits(distance_mean=1.0, distance_max=3.0, rise=0.0, zigzag=np.pi)
    monkeypatch.setattr(reaching, "LEAST_FACES", 100)
    result = reaching.reach(mesh, PLANAR, limits=anything).result
    assert planarity_percent(result.mesh).max() <= 0.2
    assert not len(result.change.folded)

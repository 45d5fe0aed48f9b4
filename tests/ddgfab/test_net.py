"""Net: shifts, sub-nets, meshes back and forth."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.errors import InputError, MeshError
from ddgfab.mesh import Floats, Mesh
from ddgfab.net import Net, difference, shift
from ddgfab.nets.circular import circularity
from ddgfab.nets.conjugate import planarity


def points(*shape: int, dim: int = 3) -> Floats:
    return np.random.default_rng(7).normal(size=(*shape, dim))


def torus_points(rows: int = 5, columns: int = 6) -> Floats:
    u = 2 * np.pi * np.arange(rows)[:, None] / rows
    v = 2 * np.pi * np.arange(columns)[None, :] / columns
    r = 3 + np.cos(v)
    return np.stack(np.broadcast_arrays(r * np.cos(u), r * np.sin(u), np.sin(v)), axis=-1)


def shuffled(mesh: Mesh, seed: int) -> Mesh:
    """Other vertex ids, order of faces and first corners."""
    rng = np.random.default_rng(seed)
    new = rng.permutation(mesh.n_vertices)
    vertices = np.empty_like(mesh.vertices)
    vertices[new] = mesh.vertices
    faces = [np.roll(new[face], rng.integers(4)) for face in mesh.faces]
    return Mesh.build(vertices, [faces[k] for k in rng.permutation(mesh.n_faces)])


def quads_of(mesh: Mesh) -> list[bytes]:
    """Faces as sets of points with orientation, independent of ids."""
    out = []
    for face in mesh.faces:
        p = mesh.vertices[face]
        first = int(np.lexsort(p.T)[0])
        out.append(np.roll(p, -first, axis=0).tobytes())
    return sorted(out)


# --- differences ---------------------------------------------------------------------------------
@pytest.mark.parametrize("periodic", [False, True])
def test_differences_commute_and_obey_the_product_rule(periodic: bool) -> None:
    x = points(5, 4, 6)
    for k, m in ((0, 1), (0, 2), (1, 2)):
        one = difference(difference(x, k, periodic=periodic), m, periodic=periodic)
        other = difference(difference(x, m, periodic=periodic), k, periodic=periodic)
        assert np.allclose(one, other, atol=1e-14)
        twice = shift(shift(x, k, periodic=periodic), m, periodic=periodic)
        again = shift(shift(x, m, periodic=periodic), k, periodic=periodic)
        assert np.array_equal(twice, again)
    a, b = x, points(5, 4, 6, dim=3)[::-1]
    for axis in range(3):
        d_ab = difference(a * b, axis, periodic=periodic)
        a_k = shift(a, axis, periodic=periodic)
        b_here = b if periodic else np.take(b, range(b.shape[axis] - 1), axis=axis)
        rule = a_k * difference(b, axis, periodic=periodic)
        rule += difference(a, axis, periodic=periodic) * b_here
        assert np.allclose(d_ab, rule, atol=1e-13)


def test_shifts_by_index() -> None:
    net = Net.build(points(5, 4), (True, False))
    assert np.array_equal(net.shift(0)[4], net.points[0])
    assert np.array_equal(net.shift(0, -1)[0], net.points[4])
    assert np.array_equal(net.shift(1, 2), net.points[:, 2:])
    assert np.array_equal(net.shift(1, -1), net.points[:, :-1])
    assert net.difference(0).shape == (5, 4, 3)
    assert net.difference(1).shape == (5, 3, 3)
    assert np.allclose(net.difference(0).sum(axis=0), 0, atol=1e-14)
    with pytest.raises(InputError, match="cannot be shifted by 4"):
        net.shift(1, 4)
    with pytest.raises(InputError, match="directions 0 to 1"):
        net.shift(2)


# --- records -------------------------------------------------------------------------------------
def test_sizes_text_and_what_is_refused() -> None:
    assert repr(Net.build(points(29, 12))) == "Net(29 x 12 points in R^3, 28 x 11 cells)"
    closed = Net.build(points(5, 4, 3, 3, dim=4), (True, False, False, True))
    assert repr(closed) == (
        "Net(5 x 4 x 3 x 3 points in R^4, 5 x 3 x 2 x 3 cells, closed in direction 0 and 3)"
    )
    assert (closed.d, closed.dim, closed.shape) == (4, 4, (5, 4, 3, 3))
    with pytest.raises(ValueError, match="read-only"):
        closed.points[0] = 0
    bad = points(4, 4)
    bad[2, 1, 0] = np.inf
    with pytest.raises(InputError, match=r"point \(2, 1\) of the net is not finite"):
        Net.build(bad)
    with pytest.raises(InputError, match="shape"):
        Net.build([1.0, 2.0, 3.0])
    with pytest.raises(InputError, match="shape"):
        Net.build(np.zeros((0, 3, 3)))
    with pytest.raises(InputError, match="1 flags for the 2 directions"):
        Net.build(points(4, 4), [True])
    with pytest.raises(InputError, match="3 are needed"):
        Net.build(points(4, 2), [False, True])


def test_sub_nets() -> None:
    net = Net.build(points(5, 4, 3, 6), (True, False, False, False))
    assert net[1].shape == (4, 3, 6)
    assert np.array_equal(net[:, 2, :, -1].points, net.points[:, 2, :, -1])
    assert net[:, 2, :, -1].periodic == (True, False)
    assert net[1:4].periodic == (False,) * 4
    assert net[::2, 1:3].shape == (3, 2, 3, 6)
    for key, message in (
        ((0,) * 5, "5 indices"),
        ((0, 9), "index 9 in direction 1"),
        ((0,) * 4, "all directions"),
        (slice(4, 4), "shape"),
    ):
        with pytest.raises(InputError, match=message):
            net[key]


def test_measures_take_nets_and_see_the_closing_quads() -> None:
    x = torus_points()
    closed = Net.build(x, (True, True))
    assert np.asarray(closed).shape == (6, 7, 3)
    assert planarity(closed).shape == (5, 6)
    assert circularity(closed).max() < 1e-14  # a surface of revolution
    x[4, 2] += [0.0, 0.0, 0.1]
    seen = np.argwhere(circularity(Net.build(x, (True, True))) > 1e-9)
    assert sorted(map(tuple, seen.tolist())) == [(3, 1), (3, 2), (4, 1), (4, 2)]
    assert np.asarray(Net.build(x)).shape == (5, 6, 3)


# --- meshes --------------------------------------------------------------------------------------
@pytest.mark.parametrize("periodic", [(False, False), (True, False), (False, True), (True, True)])
@pytest.mark.parametrize("seed", range(4))
def test_meshes_of_any_vertex_order_are_grids_again(periodic: tuple[bool, bool], seed: int) -> None:
    mesh = Net.build(torus_points(), periodic).to_mesh()
    net = Net.from_mesh(shuffled(mesh, seed))
    assert sum(net.periodic) == sum(periodic)
    assert quads_of(net.to_mesh()) == quads_of(mesh)


@pytest.mark.parametrize("shape", [(2, 2), (2, 5), (5, 2), (3, 3)])
def test_small_grids_come_back(shape: tuple[int, int]) -> None:
    mesh = Net.build(points(*shape)).to_mesh()
    net = Net.from_mesh(shuffled(mesh, 1))
    assert sorted(net.shape) == sorted(shape)
    assert quads_of(net.to_mesh()) == quads_of(mesh)


def test_the_identity_order_comes_back_unchanged() -> None:
    x = points(6, 4)
    assert np.array_equal(Net.from_mesh(Net.build(x).to_mesh()).points, x)


def faces_without(mesh: Mesh, *drop: int) -> Mesh:
    return Mesh.build(mesh.vertices, [f for k, f in enumerate(mesh.faces) if k not in drop])


def test_meshes_that_are_no_grids_are_refused() -> None:
    mesh = Net.build(points(5, 5)).to_mesh()
    with pytest.raises(MeshError, match="no grid: face 1 has 3 corners"):
        Net.from_mesh(Mesh.build(points(5), [[0, 1, 2, 3], [0, 3, 4]]))
    for drop in ((0,), (3,), (15,), (5,), (14, 15), (5, 6, 9, 10)):
        with pytest.raises(MeshError, match="no grid"):
            Net.from_mesh(faces_without(mesh, *drop))
    cube = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    with pytest.raises(MeshError, match="no grid"):
        Net.from_mesh(Mesh.build(points(8), cube))
    with pytest.raises(MeshError, match=r"face \d+ ends before the others"):
        Net.from_mesh(faces_without(mesh, 14, 15))
    # A slit from the boundary inwards: the faces are in rows, but not all glued across.
    slit = [np.array(f) for f in mesh.faces]
    for k in (9, 13):  # cells (2, 1), (3, 1) get points (3, 1), (4, 1) of their own
        slit[k] = np.where(slit[k] == 16, 25, np.where(slit[k] == 21, 26, slit[k]))
    with pytest.raises(MeshError, match=r"no grid: face .* out of line"):
        Net.from_mesh(Mesh.build(points(27), slit))
    # Two grids apart.
    both = [*mesh.faces, *(f + 25 for f in mesh.faces)]
    with pytest.raises(MeshError, match="no grid: face"):
        Net.from_mesh(Mesh.build(points(50), both))
    # A torus that closes with a shift.
    ids = np.arange(30).reshape(5, 6)
    ids = np.concatenate([ids, np.roll(ids[:1], 2, axis=1)])
    ids = np.concatenate([ids, ids[:, :1]], axis=1)
    twisted = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], -1)
    with pytest.raises(MeshError, match="no grid"):
        Net.from_mesh(Mesh.build(points(30), twisted.reshape(-1, 4)))
    # Three quads round a vertex of valence three.
    with pytest.raises(MeshError, match="no grid"):
        Net.from_mesh(Mesh.build(points(7), [[0, 1, 2, 3], [0, 3, 4, 5], [0, 5, 6, 1]]))
    with pytest.raises(MeshError, match="a mesh needs two"):
        Net.build(points(3, 3, 3)).to_mesh()
    with pytest.raises(MeshError, match="shape"):
        Net.build(points(3, 3, dim=2)).to_mesh()

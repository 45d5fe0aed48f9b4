"""Offsets at a constant distance of vertices, faces, edges; the space of parallel meshes."""

from __future__ import annotations

import numpy as np
import pytest
from net_cases import (
    catenoid_net,
    circular_net,
    concyclic_defect,
    koebe_net,
    parallel_defect,
    planar_net,
    skew_net,
    space_canal,
)

from ddgfab.errors import DegenerateError, InputError, MeshError
from ddgfab.forms.registry import generate
from ddgfab.forms.translation import translation_net
from ddgfab.grid import grid_mesh
from ddgfab.measures import mixed_areas, oriented_areas, planarity
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.nets import circularity, conjugate_residuals
from ddgfab.nets.conical import circular_to_conical, conical_determinant
from ddgfab.offsets import (
    classify_offset,
    edge_offset,
    exact_offset,
    face_offset,
    koebe_field,
    vertex_offset,
)
from ddgfab.support.parallel import edge_conditions
from ddgfab.transforms import combescure, nearest_parallel, parallel_dimension, parallel_space


def dodecahedron() -> Mesh:
    """Regular, edges tangent to a sphere; faces by distance to the face axes."""
    g = (1 + 5**0.5) / 2
    points = [(a, b, c) for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)]
    for s in (-1, 1):
        for t in (-1, 1):
            points += [(0, s / g, t * g), (s / g, t * g, 0), (t * g, 0, s / g)]
    v = np.array(points, dtype=float)
    faces = []
    for s in (-1, 1):
        for t in (-1, 1):
            for axis in ((0, s * g, t), (s * g, t, 0), (t, 0, s * g)):
                n = unit(np.array(axis, dtype=float))
                ids = np.argsort(v @ n)[-5:]
                x = unit(v[ids[0]] - n * (v[ids[0]] @ n))
                angle = np.arctan2(v[ids] @ np.cross(n, x), v[ids] @ x)
                faces.append(ids[np.argsort(angle)].tolist())
    return Mesh.build(v, faces)


def koebe_radius() -> float:
    """Circumradius over midradius of a dodecahedron: sqrt(3) / golden ratio."""
    return float(np.sqrt(3.0) / ((1 + 5**0.5) / 2))


def face_planes(mesh: Mesh) -> Floats:
    """(F,) heights of the faces' planes over the origin, from their first corners."""
    first = mesh.vertices[mesh.corners[mesh.face_start[:-1]]]
    return np.asarray(np.einsum("fx,fx->f", first, mesh.face_normals))


# --- the space of parallel meshes (10.4) --------------------------------------------------------
@pytest.mark.parametrize(("rows", "cols"), [(1, 1), (2, 3), (4, 6)])
def test_parallel_meshes_of_a_net_have_dimension_m_n_3(rows: int, cols: int) -> None:
    assert parallel_dimension(grid_mesh(planar_net(rows, cols))) == rows + cols + 3
    # Skew quads: only translation and scaling are sure; quads that are not planar are rigid.
    assert parallel_dimension(grid_mesh(skew_net(rows + 1, cols + 1))) == 4


def test_simple_polyhedra_have_one_dimension_for_each_face() -> None:
    mesh = dodecahedron()
    assert (mesh.n_vertices, mesh.n_faces, mesh.n_edges) == (20, 12, 30)
    assert parallel_dimension(mesh) == 12
    cube = Mesh.build(
        [[x, y, z] for x in (0, 1) for y in (0, 2) for z in (0, 3)],
        [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]],
    )
    assert parallel_dimension(cube) == 6
    octahedron = Mesh.build(
        [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]],
        [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]],
    )
    assert parallel_dimension(octahedron) == 4  # triangles: similar copies only


def test_parallel_space_is_orthonormal_and_parallel() -> None:
    mesh = grid_mesh(planar_net())
    basis = parallel_space(mesh)
    flat = basis.reshape(len(basis), -1)
    assert np.abs(flat @ flat.T - np.eye(len(flat))).max() < 1e-12
    assert np.abs(edge_conditions(mesh) @ flat.T).max() < 1e-12
    some = np.tensordot(np.random.default_rng(0).normal(size=len(basis)), basis, axes=1)
    assert classify_offset(mesh, mesh.vertices + 50 * some).parallel < 1e-11
    with pytest.raises(InputError, match="limit 2000"):
        parallel_space(grid_mesh(planar_net(50, 50)))


def test_combescure_gives_all_parallel_nets() -> None:
    x = planar_net(5, 4)
    rng = np.random.default_rng(4)
    a, b = rng.uniform(0.5, 1.5, 5), rng.uniform(0.5, 1.5, 4)
    y = combescure(x, a, b, (1.0, 2.0, 3.0))
    assert np.array_equal(y[0, 0], [1, 2, 3])
    assert parallel_defect(x, y) < 1e-12
    ratio = np.linalg.norm(y[1:, 0] - y[:-1, 0], axis=1) / np.linalg.norm(
        x[1:, 0] - x[:-1, 0], axis=1
    )
    assert np.abs(ratio - a).max() < 1e-12
    # Its quads close from both sides: planes of the quads are kept.
    assert planarity(grid_mesh(y)).max() < 1e-9
    assert np.abs(combescure(x, 2 * np.ones(5), 2 * np.ones(4)) - (2 * x - x[0, 0])).max() < 1e-9
    # The map from factors is linear and onto: rank m + n, with translations m + n + 3.
    zero = combescure(x, 0 * a, 0 * b, np.zeros(3))
    columns = [
        combescure(x, np.eye(9)[k, :5], np.eye(9)[k, 5:], np.zeros(3)).ravel() for k in range(9)
    ]
    assert np.abs(zero).max() == 0
    assert np.linalg.matrix_rank(np.array(columns), tol=1e-6) == 9
    assert (
        np.abs(
            np.einsum("k,kx->x", [*a, *b], columns) - combescure(x, a, b, np.zeros(3)).ravel()
        ).max()
        < 1e-9
    )
    # And back.
    assert np.abs(combescure(y, 1 / a, 1 / b, x[0, 0]) - x).max() < 1e-9


def test_a_net_and_its_parallel_net_are_layers_of_a_conjugate_net() -> None:
    """mathematics.md 1.10: the quads between them are planar, trapezoids."""
    x = planar_net(5, 4)
    y = combescure(x, np.linspace(0.7, 1.2, 5), np.linspace(1.3, 0.9, 4), x[0, 0] + [5, 9, 300])
    layers = np.stack([x, y], axis=2)
    assert max(conjugate_residuals(layers).values()) < 1e-11
    x[2, 2] += [0.0, 0.0, 30.0]
    assert max(conjugate_residuals(np.stack([x, y], axis=2)).values()) > 1e-3


def test_nearest_parallel_finds_a_parallel_net_again() -> None:
    x = planar_net()
    mesh = grid_mesh(x)
    y = combescure(x, np.linspace(0.8, 1.2, 5), np.linspace(1.1, 0.9, 4))
    wanted = y.reshape(-1, 3)
    assert np.abs(nearest_parallel(mesh, wanted).vertices - wanted).max() < 1e-9
    noise = np.random.default_rng(5).normal(size=mesh.vertices.shape) * 20
    near = nearest_parallel(mesh, y.reshape(-1, 3) + noise)
    assert classify_offset(mesh, near).parallel < 1e-10
    # The rest is perpendicular to the space.
    rest = (y.reshape(-1, 3) + noise - near.vertices).ravel()
    space = parallel_space(mesh).reshape(-1, rest.size)
    assert np.abs(space @ rest).max() < 1e-6
    with pytest.raises(InputError, match="finite"):
        nearest_parallel(mesh, np.full(mesh.vertices.shape, np.nan))


def test_combescure_refuses() -> None:
    x = planar_net(2, 2)
    with pytest.raises(InputError, match="are needed"):
        combescure(x, [1.0], [1.0, 1.0])
    x[2, 2] = x[1, 2] + (x[2, 1] - x[1, 2]) * 2  # on the line of its neighbours
    with pytest.raises(DegenerateError, match=r"quad \(1, 1\)") as caught:
        combescure(x, [1.0, 1.0], [1.0, 1.0])
    assert caught.value.cell == (1, 1)


# --- offsets (10.6) and which they are (10.7) ------------------------------------------------
@pytest.mark.parametrize("make", [circular_net, space_canal])
def test_vertex_offset_of_a_circular_net(make: object) -> None:
    x = make()  # type: ignore[operator]
    mesh = grid_mesh(x)
    moved = vertex_offset(mesh, 250.0)
    away = np.linalg.norm(moved.vertices - mesh.vertices, axis=1)
    assert np.ptp(away) < 1e-9
    assert away.mean() == pytest.approx(250.0, abs=1e-9)
    assert np.einsum("vx,vx->v", moved.vertices - mesh.vertices, mesh.vertex_normals).min() > 0
    report = classify_offset(mesh, moved)
    assert report.constant == ("vertex",)
    assert report.is_parallel
    assert "vertex offset" in str(report)
    # (v' - v) / d is a circular net in the unit sphere.
    image = (moved.vertices - mesh.vertices).reshape(x.shape) / 250.0
    assert concyclic_defect(moved.vertices.reshape(x.shape)) < 1e-10
    assert circularity(image).max() < 1e-8


def test_face_offset_of_a_conical_net() -> None:
    k = circular_to_conical(circular_net())
    mesh = grid_mesh(k)
    moved = face_offset(mesh, 250.0)
    report = classify_offset(mesh, moved)
    assert report.constant == ("face",)
    assert report.spread["face"] < 1e-9
    # Second route: heights of the planes.
    assert np.abs(face_planes(moved) - face_planes(mesh) - 250.0).max() < 1e-9
    assert np.abs(conical_determinant(moved.vertices.reshape(k.shape))).max() < 1e-12
    assert classify_offset(moved, face_offset(moved, -250.0)).constant == ("face",)


def test_edge_offset_of_nets_parallel_to_koebe_nets() -> None:
    k = koebe_net()
    edges = np.concatenate([(k[1:] - k[:-1]).reshape(-1, 3), (k[:, 1:] - k[:, :-1]).reshape(-1, 3)])
    starts = np.concatenate([k[:-1].reshape(-1, 3), k[:, :-1].reshape(-1, 3)])
    assert np.abs(np.linalg.norm(np.cross(starts, unit(edges)), axis=1) - 1).max() < 1e-14
    assert np.abs(koebe_field(grid_mesh(k)) - k.reshape(-1, 3)).max() < 1e-12
    rng = np.random.default_rng(6)
    x = combescure(k, rng.uniform(0.7, 1.3, 6), rng.uniform(0.7, 1.3, 5)) * 1000.0
    mesh = grid_mesh(x)
    moved = edge_offset(mesh, 350.0)
    report = classify_offset(mesh, moved)
    assert report.constant == ("edge",)
    assert report.spread["edge"] < 1e-9
    assert report.distance["edge"] == pytest.approx(350.0, abs=1e-9)
    assert np.abs(moved.vertices - mesh.vertices - 350.0 * k.reshape(-1, 3)).max() < 1e-8


def test_edge_offset_of_a_saddle_and_of_a_closed_polyhedron() -> None:
    catenoid = grid_mesh(catenoid_net() * 1000.0)
    report = classify_offset(catenoid, edge_offset(catenoid, 100.0))
    assert report.constant == ("edge",)
    assert report.is_parallel
    solid = dodecahedron()
    space = parallel_space(solid)
    rng = np.random.default_rng(8)
    some = solid.with_vertices(
        solid.vertices + 0.05 * np.tensordot(rng.normal(size=12), space, axes=1)
    )
    assert np.ptp(some.edge_lengths) > 0.01
    report = classify_offset(some, edge_offset(some, 0.3))
    # Its Koebe polyhedron is the regular one, on whose circumsphere the vertices lie too.
    assert report.constant == ("vertex", "edge", "face")
    assert np.abs(np.linalg.norm(koebe_field(some), axis=1) - koebe_radius()).max() < 1e-12
    assert classify_offset(solid, edge_offset(solid, 0.3)).constant == ("vertex", "edge", "face")


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_offsets_at_any_scale(scale: float) -> None:
    koebe = grid_mesh(combescure(koebe_net(), np.linspace(0.8, 1.2, 6), np.linspace(1.1, 0.9, 5)))
    conical = grid_mesh(circular_to_conical(circular_net() * scale))
    circular = grid_mesh(circular_net() * scale)
    for offset, mesh, size, kind in (
        (vertex_offset, circular, 250.0, "vertex"),
        (face_offset, conical, 250.0, "face"),
        (edge_offset, koebe.scaled(scale), 0.3, "edge"),
    ):
        report = classify_offset(mesh, offset(mesh, size * scale))  # type: ignore[operator]
        assert report.constant == (kind,)
        assert report.distance[kind] == pytest.approx(size * scale, rel=1e-11)


@pytest.mark.parametrize("kind", ["circular", "conical"])
def test_offsets_do_not_depend_on_the_numbering(kind: str) -> None:
    mesh = generate(kind)
    order = np.random.default_rng(9).permutation(mesh.n_vertices)
    faces = np.argsort(order)[mesh.corners].reshape(-1, 4)[::-1]
    other = Mesh.build(mesh.vertices[order], np.roll(faces, 1, axis=1))
    first, second = exact_offset(mesh, 200.0)[0], exact_offset(other, 200.0)[0]
    assert np.abs(first.vertices[order] - second.vertices).max() < 1e-6


def test_only_the_right_nets_have_offsets() -> None:
    circular, conical = generate("circular"), generate("conical")
    plain = grid_mesh(planar_net())
    for offset, mesh, words in (
        (vertex_offset, conical, "not circular"),
        (face_offset, circular, "not conical"),
        (edge_offset, circular, "Koebe"),
        (vertex_offset, plain, "not circular"),
        (face_offset, plain, "not conical"),
        (edge_offset, plain, "Koebe"),
        (exact_offset, plain, "no offset at a constant distance"),
    ):
        with pytest.raises(DegenerateError, match=words):
            offset(mesh, 100.0)  # type: ignore[operator]
    assert exact_offset(circular, 80.0)[1].constant == ("vertex",)
    assert exact_offset(conical, 80.0)[1].constant == ("face",)
    assert exact_offset(grid_mesh(koebe_net()), 0.1)[1].distance["vertex"] == pytest.approx(0.1)
    with pytest.raises(MeshError, match="shape"):
        classify_offset(plain, plain.vertices[:-1])


def test_rotational_nets_have_vertex_and_face_offsets_which_differ() -> None:
    mesh = generate("rotational")
    for offset, kind in ((vertex_offset, "vertex"), (face_offset, "face")):
        assert classify_offset(mesh, offset(mesh, -120.0)).constant == (kind,)


def test_classify_sees_a_mesh_that_is_not_parallel() -> None:
    mesh = generate("circular")
    moved = vertex_offset(mesh, 100.0).vertices.copy()
    moved[50] += [0.0, 0.0, 0.1]
    report = classify_offset(mesh, moved)
    assert not report.is_parallel
    assert report.constant == ()
    assert "no offset" in str(report)


# --- areas (8.1) -----------------------------------------------------------------------------
def test_mixed_areas_make_the_steiner_polynomial() -> None:
    x = circular_net()
    mesh, moved = grid_mesh(x), vertex_offset(grid_mesh(x), 1.0)
    s = moved.vertices - mesh.vertices
    own, mixed, image = (
        oriented_areas(mesh),
        mixed_areas(mesh, mesh.vertices, s),
        oriented_areas(mesh, s),
    )
    assert np.allclose(own, mesh.face_areas, rtol=1e-13)
    for t in (-300.0, 120.0, 900.0):
        area = oriented_areas(mesh, mesh.vertices + t * s)
        assert np.abs(area - (own + 2 * t * mixed + t**2 * image)).max() < 1e-12 * own.max()
    assert np.abs(mixed_areas(mesh, s, s) - image).max() < 1e-12


def test_areas_of_a_parallelogram_by_hand() -> None:
    """Edges (2, 0), (0, 3): area 6; with the unit square: mixed area (2 * 1 + 3 * 1) / 2."""
    net = translation_net([[0, 0, 0], [2, 0, 0]], [[0, 0, 0], [0, 3, 0]])
    one = translation_net([[0, 0, 0], [1, 0, 0]], [[0, 0, 0], [0, 1, 0]]).reshape(-1, 3)
    mesh = grid_mesh(net)
    assert oriented_areas(mesh)[0] == 6.0
    assert mixed_areas(mesh, mesh.vertices, one)[0] == 2.5
    assert oriented_areas(mesh, one * [-1, 1, 1])[0] == -1.0
    with pytest.raises(MeshError, match="shape"):
        mixed_areas(mesh, one, one[:3])

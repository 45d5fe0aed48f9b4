"""Exact structures: parallel meshes, circular and conical nets, central; their certificate."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.linalg import matrix_rank
from support_cases import planar_net

from ddgfab.errors import SupportError
from ddgfab.forms import canopy
from ddgfab.grid import grid_mesh
from ddgfab.io import read_mesh
from ddgfab.measures import planarity_percent, torsion
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.nets import circularity, vertex_normals
from ddgfab.support import (
    SupportStructure,
    best_center,
    central,
    cone_axes,
    parallel_field,
    reflected_axes,
    support_structure,
)
from ddgfab.support.exact import smoothest_normals
from ddgfab.support.nearest_axes import jacobian, tangent_frames
from ddgfab.support.parallel import edge_conditions


def conical_net() -> tuple[Mesh, Floats]:
    """Planes through the vertices of a circular net across its normals meet in a conical net.

    Its interior vertex (i, j) touches a cone about the axis of a circle (mathematics.md 2.8).
    """
    net = canopy(9, 7, 1400.0).vertices.reshape(10, 8, 3)
    normals = vertex_normals(net, unit(reflected_axes(grid_mesh(net))[0]))
    corners = [(slice(None, -1), slice(None, -1)), (slice(1, None), slice(None, -1))]
    corners += [(slice(1, None), slice(1, None)), (slice(None, -1), slice(1, None))]
    rows = np.stack([normals[c] for c in corners], axis=-2)
    right = np.stack([np.einsum("ijk,ijk->ij", normals[c], net[c]) for c in corners], axis=-1)
    points = np.einsum("ijxk,ijk->ijx", np.linalg.pinv(rows), right)
    assert np.abs(np.einsum("ijkx,ijx->ijk", rows, points) - right).max() < 1e-6  # they concur
    axes = unit(np.cross(net[1:, 1:] - net[:-1, :-1], net[:-1, 1:] - net[1:, :-1]))
    return grid_mesh(points), axes.reshape(-1, 3)


def icosahedron(seed: int = 3) -> Mesh:
    g = (1 + 5**0.5) / 2
    points = np.array(
        [(0, s, t * g) for s in (-1, 1) for t in (-1, 1)]
        + [(s, t * g, 0) for s in (-1, 1) for t in (-1, 1)]
        + [(t * g, 0, s) for s in (-1, 1) for t in (-1, 1)],
        dtype=float,
    )
    faces = [
        (i, j, k)
        for i in range(12)
        for j in range(12)
        for k in range(12)
        if i < min(j, k)
        and all(
            abs(np.linalg.norm(points[a] - points[b]) - 2) < 1e-9
            for a, b in ((i, j), (j, k), (k, i))
        )
        and np.linalg.det(points[[i, j, k]]) > 0
    ]
    noise = np.random.default_rng(seed).normal(size=points.shape)
    return Mesh.build(points + 0.08 * noise, faces)


def free_dimension(structure: SupportStructure) -> int:
    matrix = jacobian(structure.mesh, structure.axes, tangent_frames(structure.axes)).toarray()
    return 2 * structure.mesh.n_vertices - int(matrix_rank(matrix, tol=1e-8))


# --- parallel meshes -----------------------------------------------------------------------
@pytest.mark.parametrize(("rows", "cols"), [(2, 2), (3, 5), (5, 4)])
def test_parallel_meshes_of_a_planar_net_form_a_space_of_m_n_3(rows: int, cols: int) -> None:
    matrix = edge_conditions(planar_net(rows, cols)).toarray()
    assert matrix.shape[1] - matrix_rank(matrix, tol=1e-9) == rows + cols + 3


def test_parallel_field_is_parallel_and_nearest() -> None:
    mesh = planar_net()
    field = parallel_field(mesh, mesh.vertex_normals)
    start, end = mesh.edges.T
    assert np.abs(np.cross(field[end] - field[start], unit(mesh.edge_vectors))).max() < 1e-12
    # Second route: dense projection of the normals on the null space.
    rows = np.linalg.svd(edge_conditions(mesh).toarray())[2]
    null = rows[-(5 + 4 + 3) :]
    expected = (null.T @ (null @ mesh.vertex_normals.ravel())).reshape(-1, 3)
    assert np.abs(field - expected).max() < 1e-7  # rounding times the penalty 1e7


def test_offset_structure_on_a_planar_net() -> None:
    structure = support_structure(planar_net(), "offset")
    assert structure.kind == "offset"
    assert structure.torsion_deg_max < 1e-9
    assert structure.lean_deg_max < 20
    assert support_structure(planar_net()).kind == "offset"  # nothing better is exact


# --- circular and conical ------------------------------------------------------------------
def test_circular_net_gets_reflected_normals() -> None:
    mesh = canopy()
    structure = support_structure(mesh, "normal")
    assert structure.kind == "normal"
    assert structure.torsion_deg_max < 1e-9
    assert structure.lean_deg_max < 10
    net = mesh.vertices.reshape(29, 12, 3)
    again = vertex_normals(net, structure.axes[0]).reshape(-1, 3)
    assert np.abs(again - structure.axes).max() < 1e-12
    # Vertex offset: parallel, circular, distance exactly d.
    shifted = mesh.vertices + 300 * structure.axes
    assert circularity(shifted.reshape(net.shape)).max() < 1e-12

    # Nearest to the surface normals in the two-parameter family.
    def distance(axes: Floats) -> float:
        return float(np.sum((axes - mesh.vertex_normals) ** 2))

    for tilt in np.random.default_rng(0).normal(size=(6, 3)) * 0.02:
        other = vertex_normals(net, structure.axes[0] + tilt).reshape(-1, 3)
        assert distance(other) > distance(structure.axes)


def uneven(x: Callable[[Floats, Floats], list[Floats]]) -> Mesh:
    """A net along lines at uneven parameters."""
    rng = np.random.default_rng(6)
    u, v = (np.cumsum(rng.uniform(0.1, 0.3, count)) for count in (7, 6))
    return grid_mesh(np.stack(x(*np.meshgrid(u, v, indexing="ij")), axis=-1))


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_smoothest_normals_are_those_of_spheres_and_cylinders(side: float) -> None:
    """Though the nets are uneven, so that their vertex normals are not; two parts are as each."""
    ball = uneven(
        lambda u, v: [np.cos(u) * np.cos(v), side * np.sin(u) * np.cos(v), np.sin(v) + 0 * u]
    )
    tube = uneven(lambda u, v: [np.cos(u), side * np.sin(u), 3.0 * v])
    for mesh, exact in (
        (ball, ball.vertices),
        (tube, tube.vertices * [1.0, 1.0, 0.0]),
    ):
        outward = np.sign(np.sum(exact * mesh.vertex_normals))
        assert np.abs(mesh.vertex_normals - outward * exact).max() > 1e-3
        assert np.abs(smoothest_normals(mesh) - outward * exact).max() < 1e-9
    beside = tube.vertices + np.array([9.0, 0.0, 0.0])
    both = Mesh.build(
        np.concatenate([ball.vertices, beside]),
        [*ball.faces, *(face + ball.n_vertices for face in tube.faces)],
    )
    parts = np.concatenate([smoothest_normals(ball), smoothest_normals(tube)])
    assert np.abs(smoothest_normals(both) - parts).max() < 1e-9


def test_smoothest_normals_of_one_face_are_across_it() -> None:
    """No line of the net has two edges in a row: nothing else decides."""
    corners = np.array([[0.0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]])
    for face, up in (([0, 1, 2, 3], 1.0), ([3, 2, 1, 0], -1.0)):
        found = smoothest_normals(Mesh.build(corners, [face]))
        assert np.abs(found - [0.0, 0.0, up]).max() < 1e-12


def test_conical_net_gets_the_axes_of_its_cones() -> None:
    mesh, axes = conical_net()
    assert planarity_percent(mesh).max() < 1e-6
    found = cone_axes(mesh)
    inner = ~mesh.boundary_vertex
    assert np.abs(np.cross(found, axes)[inner]).max() < 1e-4  # circle axes; boundary tie 1e-6
    structure = support_structure(mesh, "axis")
    assert structure.torsion_deg_max < 1e-9
    assert structure.lean_deg_max < 20
    # Each axis makes equal angles with the faces around it.
    for vertex in np.flatnonzero(inner):
        angles = mesh.face_normals[mesh.star(int(vertex))[1]] @ structure.axes[vertex]
        assert np.ptp(angles) < 1e-6
    assert support_structure(mesh).torsion_deg_max < 1e-9


# --- triangles -----------------------------------------------------------------------------
def test_triangle_meshes_have_central_structures_only() -> None:
    """Prop. 5.2: on a distorted icosahedron the freedom is that of the center, 3."""
    mesh = icosahedron()
    structure = central(mesh, (0.1, -0.1, 0.05))
    assert structure.torsion_deg_max < 1e-9
    assert free_dimension(structure) == 3


def test_best_center_of_a_sphere_and_of_a_plane() -> None:
    mesh = icosahedron(0)
    ball = mesh.with_vertices(unit(mesh.vertices) * 2 + [5, 6, 7])
    center = best_center(ball)
    assert center is not None
    assert np.abs(center - [5, 6, 7]).max() < 0.3
    assert support_structure(ball, "central").lean_deg_max < 20
    flat = grid_mesh(np.stack(np.meshgrid([0.0, 1, 2], [0.0, 1], [0.0]), axis=-1)[:, :, 0])
    assert best_center(flat) is None
    parallel = central(flat)
    assert np.abs(np.abs(parallel.axes[:, 2]) - 1).max() < 1e-12
    assert parallel.lean_deg_max < 1e-9  # on the side of the normals


def test_vertices_without_faces_move_no_center() -> None:
    mesh = icosahedron()
    more = Mesh.build(np.concatenate([mesh.vertices, [[40.0, -30.0, 20.0]]]), mesh.faces)
    one, two = best_center(mesh), best_center(more)
    assert one is not None
    assert two is not None
    assert np.abs(one - two).max() < 1e-12
    structures = central(mesh), central(more)
    assert np.abs(structures[0].axes - structures[1].axes[:-1]).max() < 1e-12
    assert (structures[1].axes[-1] == 0).all()
    assert central(more, more.vertices[-1]).torsion_deg_max < 1e-9  # it may be the center itself


def test_triangle_mesh_is_refused_with_the_way_out(mesh_file: Callable[[str], Path]) -> None:
    mesh = read_mesh(mesh_file("tri_dome.obj")).mesh
    with pytest.raises(SupportError, match=r"Prop\. 5\.2") as caught:
        support_structure(mesh)
    assert 'kind = "central"' in str(caught.value)
    worst = np.degrees(torsion(mesh, mesh.vertex_normals).max())
    assert f"{worst:.2f} deg" in str(caught.value)
    structure = support_structure(mesh, "central")
    assert structure.torsion_deg_max < 1e-9
    assert structure.lean_deg_max < 10


def test_center_at_a_vertex_is_refused() -> None:
    mesh = icosahedron()
    with pytest.raises(SupportError, match="vertex 4 lies in the center"):
        central(mesh, mesh.vertices[4])


# --- the record ----------------------------------------------------------------------------
def test_edge_planes_hold_edge_and_axes_and_point_left() -> None:
    mesh = canopy(8, 6)
    structure = support_structure(mesh)
    normals = structure.edge_planes
    start, end = mesh.edges.T
    for inside in (unit(mesh.edge_vectors), structure.axes[start], structure.axes[end]):
        assert np.abs(np.einsum("ex,ex->e", normals, inside)).max() < 1e-9
    middle = 0.5 * (mesh.vertices[start] + mesh.vertices[end])
    left = mesh.face_centers[mesh.edge_faces[:, 0]] - middle
    assert (np.einsum("ex,ex->e", normals, left) > 0).all()


def test_the_certificate_names_the_five_worst() -> None:
    mesh = canopy(8, 6)
    axes = unit(mesh.vertex_normals + 0.1 * np.random.default_rng(2).normal(size=(63, 3)))
    structure = SupportStructure.of(mesh, axes)
    record = structure.to_dict()
    for rows, name, angles in (
        (record["torsion_worst_edges"], "edge", structure.torsion),
        (record["lean_worst_vertices"], "vertex", structure.lean),
    ):
        found = np.degrees(np.sort(angles)[::-1][:5])
        assert [row["deg"] for row in rows] == pytest.approx(found.tolist())
        assert [angles[row[name]] for row in rows] == pytest.approx(np.radians(found).tolist())


def test_certificate_counts_a_known_torsion() -> None:
    """One edge, axes 10 deg apart about it: torsion 10 deg (mathematics.md 10.2)."""
    mesh = Mesh.build([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
    axes = np.tile([0.0, 0.0, 2.0], (4, 1))
    axes[1] = [0, np.sin(np.radians(10)), np.cos(np.radians(10))]
    structure = SupportStructure.of(mesh, axes)
    assert structure.torsion_deg_max == pytest.approx(10)
    assert structure.torsion_deg_mean == pytest.approx(2.5)
    assert structure.worst_edges(1).tolist() == [0]
    assert structure.lean_deg_max == pytest.approx(10)
    assert structure.leaning(5.0).tolist() == [1]
    assert not structure.torsion_free
    record = structure.to_dict()
    assert record["torsion_worst_edges"][0] == {"edge": 0, "deg": pytest.approx(10)}
    assert "torsion max 1.0e+01 deg" in repr(structure)
    with pytest.raises(SupportError, match="axis of vertex 2"):
        SupportStructure.of(mesh, axes * [[1], [1], [0], [1]])
    with pytest.raises(SupportError, match="shape"):
        SupportStructure.of(mesh, axes[:3])


def test_closed_net_of_six_digits_is_taken_within_the_limit_asked_for() -> None:
    """Surface of three cubes round a corner, sheared and tapered: 28 conditions, as many freedoms.

    Planar faces have exact axes; rounded to six digits they have none, but nearly.
    """
    cubes = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    points: dict[tuple[int, ...], int] = {}
    faces = []
    for cube in cubes:
        for axis in range(3):
            for side in (0, 1):
                beside = list(cube)
                beside[axis] += 2 * side - 1
                if tuple(beside) in cubes:
                    continue
                a, b = (np.eye(3, dtype=int)[(axis + k) % 3] for k in (1, 2))
                start = np.array(cube) + side * np.eye(3, dtype=int)[axis]
                loop = [start, start + a, start + a + b, start + b][:: 1 if side else -1]
                faces.append([points.setdefault(tuple(p.tolist()), len(points)) for p in loop])
    flat = np.array(list(points), dtype=float) @ [[1, 0.1, 0.05], [0.2, 0.9, 0], [0, 0.1, 1.1]]
    flat /= 1 + 0.1 * flat[:, :1] + 0.07 * flat[:, 2:]  # projective: planes stay planes
    exact = Mesh.build(flat, faces)
    assert exact.n_edges == 28
    assert support_structure(exact).torsion_free
    rounded = exact.with_vertices(np.round(flat, 6))
    with pytest.raises(SupportError, match=r"torsion stays at .* \(limit 1e-06"):
        support_structure(rounded)
    found = support_structure(rounded, torsion_limit_deg=0.1)
    assert 1e-6 < found.torsion_deg_max < 1e-3

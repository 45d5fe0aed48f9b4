"""Support structures from boundary data on skew quad patches; axes from beam planes."""

from __future__ import annotations

import numpy as np
import pytest
from net_cases import circular_net, planar_net, skew_net

from ddgfab.errors import DegenerateError, InputError, SupportError
from ddgfab.grid import grid_mesh
from ddgfab.measures import torsion
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.nets import vertex_normals
from ddgfab.nets.axes import circle_axes
from ddgfab.nets.conical import best_normal, circular_to_conical
from ddgfab.support import SupportStructure, incircle_axes, node_torsion, propagate_axes
from ddgfab.support.nearest_axes import jacobian, tangent_frames


def axes_of(x: Floats, data: Floats) -> Floats:
    m = x.shape[0] - 1
    first = np.array([data[0], data[1], 1.0])
    return propagate_axes(x, first, data[2 : 2 + m], data[2 + m :])


@pytest.mark.parametrize(("rows", "cols"), [(2, 2), (4, 3), (3, 6)])
@pytest.mark.parametrize("make", [skew_net, planar_net])
def test_propagated_structures_are_torsion_free_and_have_dimension_m_n_2(
    rows: int, cols: int, make: object
) -> None:
    x = make(rows, cols)  # type: ignore[operator]
    mesh = grid_mesh(x)
    rng = np.random.default_rng(3)
    data = rng.normal(size=rows + cols + 2) * 0.05
    axes = axes_of(x, data)
    assert np.degrees(torsion(mesh, axes.reshape(-1, 3)).max()) < 1e-9
    assert np.abs(np.linalg.norm(axes, axis=-1) - 1).max() < 1e-14
    # The parameters are independent, and there are no other structures near: both ranks agree.
    step = 1e-6
    moves = np.array(
        [
            (axes_of(x, data + step * e) - axes_of(x, data - step * e)).ravel() / (2 * step)
            for e in np.eye(len(data))
        ]
    )
    assert np.linalg.matrix_rank(moves, tol=1e-4) == rows + cols + 2
    flat = axes.reshape(-1, 3)
    matrix = jacobian(mesh, flat, tangent_frames(flat)).toarray()
    free = 2 * mesh.n_vertices - np.linalg.matrix_rank(matrix, tol=1e-8 * np.abs(matrix).max())
    assert free == rows + cols + 2


def test_propagation_finds_reflected_normals_again() -> None:
    """The vertex normals of a circular net, from their turns along two lines."""
    x = circular_net()
    n = vertex_normals(x, best_normal(x))

    def turns(points: Floats, axes: Floats) -> Floats:
        edges = np.diff(points, axis=0)
        sine = np.cross(axes[:-1], axes[1:])
        side = np.sign(np.einsum("kx,kx->k", sine, np.cross(axes[:-1], edges)))
        return np.asarray(
            side
            * np.arctan2(np.linalg.norm(sine, axis=1), np.einsum("kx,kx->k", axes[:-1], axes[1:]))
        )

    again = propagate_axes(x, n[0, 0], turns(x[:, 0], n[:, 0]), turns(x[0], n[0]))
    assert np.abs(again - n).max() < 1e-10


def test_degenerate_data_name_the_vertex() -> None:
    x = planar_net(2, 2)
    with pytest.raises(DegenerateError, match=r"vertex \(1, 0\): the axis before it runs along"):
        propagate_axes(x, x[1, 0] - x[0, 0], [0.0, 0.0], [0.0, 0.0])
    flat = np.stack(
        [*np.meshgrid(np.arange(3.0), np.arange(3.0), indexing="ij"), np.zeros((3, 3))], axis=-1
    )
    flat[1, 1] = (1.0, 0.5, 0.0)
    flat[1, 0], flat[0, 1] = (1.0, 0.0, 0.0), (1.0, 1.0, 0.0)  # x1, x12, x2 on a line
    with pytest.raises(DegenerateError, match=r"vertex \(1, 1\): the planes.*coincide") as caught:
        propagate_axes(flat, (0.0, 0.0, 1.0), [0.0, 0.0], [0.0, 0.0])
    assert caught.value.cell == (1, 1)
    with pytest.raises(InputError, match=r"\(2,\) needed"):
        propagate_axes(x, (0, 0, 1), [0.0], [0.0, 0.0])


@pytest.mark.parametrize("first", [(0.0, 1.0), (0.0, 0.0, 1.0, 1.0), (0.0, 0.0, 0.0)])
def test_a_first_axis_that_is_none_is_refused(first: tuple[float, ...]) -> None:
    with pytest.raises(InputError, match="axis"):
        propagate_axes(planar_net(2, 2), first, [0.0, 0.0], [0.0, 0.0])
    with pytest.raises(InputError, match=r"points \(3, 3, 2\)"):
        propagate_axes(planar_net(2, 2)[..., :2], (0.0, 0.0, 1.0), [0.0, 0.0], [0.0, 0.0])


def test_node_torsion_gives_the_axes_back_and_sees_a_turned_plane() -> None:
    x = skew_net(4, 3)
    mesh = grid_mesh(x)
    axes = propagate_axes(x, (0.0, 0.1, 1.0), np.full(4, 0.02), np.full(3, -0.03)).reshape(-1, 3)
    structure = SupportStructure.of(mesh, axes)
    value, lines = node_torsion(mesh, structure.edge_planes)
    assert value.max() < 1e-12
    assert np.linalg.norm(np.cross(lines, axes), axis=1).max() < 1e-9
    # A plane turned about its edge by 10 degrees: its two nodes have torsion, others none.
    edge = int(np.flatnonzero(~mesh.boundary_vertex[mesh.edges].any(axis=1))[0])
    planes = structure.edge_planes.copy()
    along = mesh.edge_vectors[edge] / mesh.edge_lengths[edge]
    angle = np.radians(10.0)
    planes[edge] = np.cos(angle) * planes[edge] + np.sin(angle) * np.cross(along, planes[edge])
    value = node_torsion(mesh, planes)[0]
    assert value[mesh.edges[edge]].min() > 0.01
    others = np.setdiff1d(np.arange(mesh.n_vertices), mesh.edges[edge])
    assert value[others].max() < 1e-12
    with pytest.raises(InputError, match="shape"):
        node_torsion(mesh, planes[1:])


def test_twist_of_ten_degrees() -> None:
    """mathematics.md 10.2: e = (1, 0, 0), axes (0, 0, 1) and (0, sin 10, cos 10) deg."""
    mesh = Mesh.build([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
    tilt = np.radians(10.0)
    axes = np.tile([0.0, 0.0, 1.0], (4, 1))
    axes[1] = (0.0, np.sin(tilt), np.cos(tilt))
    edge = [tuple(e) for e in mesh.edges.tolist()].index((0, 1))
    assert np.degrees(torsion(mesh, axes)[edge]) == pytest.approx(10.0, abs=1e-12)
    assert np.degrees(torsion(mesh, -axes * [[3.0], [-2.0], [1.0], [1.0]])[edge]) == pytest.approx(
        10
    )


def bipyramid(sides: int = 5) -> Mesh:
    """All edges touch the unit sphere: equator 1 / cos(pi / n), apex R / sqrt(R^2 - 1)."""
    radius = 1.0 / np.cos(np.pi / sides)
    apex = radius / np.sqrt(radius**2 - 1.0)
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle], axis=1)
    points = np.concatenate([ring, [[0, 0, apex], [0, 0, -apex]]])
    faces = [[k, (k + 1) % sides, sides] for k in range(sides)]
    faces += [[(k + 1) % sides, k, sides + 1] for k in range(sides)]
    return Mesh.build(points, faces)


def incircle_defect(mesh: Mesh) -> float:
    """Greatest det(c' - c, n, n') of neighbouring incircles, relative to the distance."""
    centers, axes = incircle_axes(mesh)
    left, right = mesh.edge_faces.T
    step = unit(centers[right] - centers[left])
    value = np.einsum("ex,ex->e", step, np.cross(axes[left], axes[right]))
    return float(np.abs(value).max())


def test_incircle_axes_of_a_cp_mesh_support_its_dual() -> None:
    mesh = bipyramid()
    # A projective map of the sphere keeps tangent edges: nothing symmetric is left.
    speed = 0.4
    x, y, z = mesh.vertices.T
    factor = 1.0 / (1.0 + speed * x)
    moved = np.stack([x + speed, y * np.sqrt(1 - speed**2), z * np.sqrt(1 - speed**2)], axis=1)
    some = mesh.with_vertices(moved * factor[:, None])
    along = unit(some.edge_vectors)
    away = np.linalg.norm(np.cross(some.vertices[some.edges[:, 0]], along), axis=1)
    assert np.abs(away - 1).max() < 1e-13
    radius = np.sqrt(np.sum(some.vertices**2, axis=1) - 1)
    assert np.abs(radius[some.edges].sum(axis=1) - some.edge_lengths).max() < 1e-13  # CP: 10.11
    assert np.ptp(some.edge_lengths) > 0.1
    centers = incircle_axes(some)[0]
    sides = some.vertices[some.corners] - centers[some.corner_face]
    on = np.linalg.norm(np.cross(sides, along[some.corner_edge]), axis=1).reshape(-1, 3)
    assert np.ptp(on, axis=1).max() < 1e-13  # one radius a face
    assert incircle_defect(some) < 1e-14
    noise = np.random.default_rng(1).normal(size=mesh.vertices.shape)
    assert incircle_defect(mesh.with_vertices(mesh.vertices + 0.1 * noise)) > 1e-3
    with pytest.raises(SupportError, match="face 0 has 4 corners"):
        incircle_axes(grid_mesh(planar_net()))


def test_circle_axes_support_the_dual_of_a_circular_net() -> None:
    """mathematics.md 10.6: at any points of the axes that make edges, here the conical partner."""
    x = circular_net()
    structure = SupportStructure.of(
        grid_mesh(circular_to_conical(x)), circle_axes(x)[1].reshape(-1, 3)
    )
    assert structure.torsion_deg_max < 1e-9

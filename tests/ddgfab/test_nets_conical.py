"""Conical nets: their tests, cones, and the way from and to circular nets (mathematics.md 2.8 -
2.10)."""

from __future__ import annotations

import numpy as np
import pytest
from net_cases import circular_net, concyclic_defect, parallel_defect, planar_net, space_canal

from ddgfab.errors import DegenerateError, InputError
from ddgfab.forms.rotational import rotational_net
from ddgfab.grid import grid_mesh
from ddgfab.measures import conical_defect, planarity
from ddgfab.mesh import Floats, unit
from ddgfab.nets import circularity, vertex_normals
from ddgfab.nets.axes import circle_axes
from ddgfab.nets.conical import (
    angle_balance,
    best_normal,
    circular_to_conical,
    cone_axes,
    cone_offsets,
    conical_determinant,
    conical_residuals,
    conical_to_circular,
    face_normals,
)
from ddgfab.transforms import combescure

MERIDIAN = np.array([[3.0, 0.0], [2.8, 0.9], [2.2, 1.6], [1.3, 2.0]])
NETS = [circular_net, space_canal]


@pytest.mark.parametrize("make", NETS)
def test_circular_to_conical(make: object) -> None:
    x = make()  # type: ignore[operator]
    k = circular_to_conical(x)
    assert k.shape == (x.shape[0] - 1, x.shape[1] - 1, 3)
    size = np.linalg.norm(np.ptp(x.reshape(-1, 3), axis=0))
    n = vertex_normals(x, best_normal(x))
    # Every face of the result lies in the plane through an interior vertex across its normal.
    assert (
        np.abs(np.abs(np.einsum("ijk,ijk->ij", face_normals(k), n[1:-1, 1:-1])) - 1).max() < 1e-12
    )
    for i in (0, 1):
        for j in (0, 1):
            corner = k[i : k.shape[0] - 1 + i, j : k.shape[1] - 1 + j]
            height = np.einsum("ijk,ijk->ij", corner - x[1:-1, 1:-1], n[1:-1, 1:-1])
            assert np.abs(height).max() < 1e-12 * size
    assert planarity(grid_mesh(k)).max() < 1e-12 * size
    assert np.abs(conical_determinant(k)).max() < 1e-13
    assert np.abs(angle_balance(k)).max() < 1e-9
    assert max(conical_residuals(k).values()) < 1e-12
    assert conical_defect(grid_mesh(k)).max() < 1e-9
    # The cone's axis is the circle's axis, line for line.
    center, axis = circle_axes(x)
    inner = slice(1, -1), slice(1, -1)
    assert np.linalg.norm(np.cross(cone_axes(k), axis[inner]), axis=-1).max() < 1e-10
    assert np.linalg.norm(np.cross(k - center, axis), axis=-1).max() < 1e-11 * size


def test_the_way_there_and_back() -> None:
    """Conical to circular with the first point of the original gives the original."""
    x = circular_net()
    back = conical_to_circular(circular_to_conical(x), x[1, 1])
    assert np.abs(back - x[1:-1, 1:-1]).max() < 1e-9


def test_conical_to_circular_is_a_two_parameter_family() -> None:
    k = circular_to_conical(circular_net())
    n = face_normals(k)
    free = conical_to_circular(k)
    for first in (None, free[0, 0] + [90.0, -40.0, 10.0], free[0, 0] - [50.0, 120.0, 5.0]):
        y = conical_to_circular(k, first)
        assert np.abs(np.einsum("ijk,ijk->ij", y - k[:-1, :-1], n)).max() < 1e-9  # in its face
        assert circularity(y).max() < 1e-11
        assert concyclic_defect(y) < 1e-11
        # Other order of the directions: path independence.
        turned = conical_to_circular(k.transpose(1, 0, 2), y[0, 0]).transpose(1, 0, 2)
        assert np.abs(turned - y).max() < 1e-9
    centers = 0.25 * (k[1:, 1:] + k[1:, :-1] + k[:-1, 1:] + k[:-1, :-1])

    def distance(y: Floats) -> float:
        return float(np.sum((y - centers) ** 2))

    rng = np.random.default_rng(1)
    for step in 5.0 * rng.normal(size=(5, 3)):
        assert distance(conical_to_circular(k, free[0, 0] + step)) > distance(free)


def test_rotational_nets_are_conical_for_a_constant_step_only() -> None:
    """mathematics.md 2.9 and 12: 2e-17 for a constant step, of the order 1e-3 for unequal ones."""
    even = rotational_net(MERIDIAN, np.linspace(0.0, 2.0, 9))
    assert np.abs(conical_determinant(even)).max() < 1e-16
    assert np.abs(angle_balance(even)).max() < 1e-13
    uneven = rotational_net(MERIDIAN, np.array([0.0, 0.2, 0.5, 0.6, 1.0, 1.5]))
    assert np.abs(conical_determinant(uneven)).max() > 1e-4
    assert np.abs(angle_balance(uneven)).max() > 1e-3


def test_normals_are_concyclic_at_folded_vertices_where_angles_do_not_balance() -> None:
    """A parallel net with one negative factor folds over along a strip; its planes stay."""
    k = circular_to_conical(circular_net())
    factors = np.ones(k.shape[0] - 1)
    factors[2] = -1.0
    folded = combescure(k, factors, np.ones(k.shape[1] - 1))
    assert parallel_defect(k, folded) < 1e-10
    assert np.abs(conical_determinant(folded, face_normals(k))).max() < 1e-12
    assert np.abs(angle_balance(folded)).max() > 0.1


def test_cone_offsets_move_all_faces_by_one() -> None:
    k = circular_to_conical(circular_net())
    d, n = cone_offsets(k), face_normals(k)
    for i in (0, 1):
        for j in (0, 1):
            faces = n[i : n.shape[0] - 1 + i, j : n.shape[1] - 1 + j]
            assert np.abs(np.einsum("ijk,ijk->ij", d, faces) - 1).max() < 1e-11
    assert parallel_defect(k[1:-1, 1:-1], k[1:-1, 1:-1] + 300 * d) < 1e-11
    assert np.abs(np.linalg.norm(cone_axes(k), axis=-1) - 1).max() < 1e-15


def test_the_measures_see_nets_that_are_not_conical() -> None:
    x = planar_net()
    assert np.abs(conical_determinant(x)).max() > 1e-5
    assert conical_residuals(x)["normals"] > 1e-3
    assert np.abs(angle_balance(x)).max() > 1e-3
    # Reflected points do not close there.
    y = conical_to_circular(x)
    turned = conical_to_circular(x.transpose(1, 0, 2), y[0, 0]).transpose(1, 0, 2)
    assert np.abs(turned - y).max() > 0.1


def test_flat_circular_nets_become_flat_conical_nets() -> None:
    """All planes are one; each vertex stays in its circle's center, the limit of the axis rule."""
    u, v = np.meshgrid(np.arange(4.0), np.arange(3.0) ** 1.2, indexing="ij")
    flat = np.stack([u, v, 0 * u], axis=-1)
    k = circular_to_conical(flat)
    assert np.abs(k - circle_axes(flat)[0]).max() < 1e-14
    y = conical_to_circular(np.stack([u, v, 0 * u], axis=-1))
    assert np.abs(y[..., 2]).max() == 0
    assert circularity(y).max() < 1e-14


def test_best_normal_is_nearest() -> None:
    x = circular_net()
    target = grid_mesh(x).vertex_normals.reshape(x.shape)
    first = best_normal(x)

    def distance(start: Floats) -> float:
        return float(np.sum((vertex_normals(x, start) - target)[1:-1, 1:-1] ** 2))

    for tilt in np.random.default_rng(2).normal(size=(6, 3)) * 0.1:
        assert distance(unit(first + tilt)) > distance(first)


def test_degenerate_nets_name_the_place() -> None:
    x = circular_net()
    with pytest.raises(InputError, match="normals of shape"):
        conical_determinant(x, np.zeros((3, 3, 3)))
    with pytest.raises(InputError, match="at least"):
        conical_determinant(x[:2])
    broken = x.copy()
    broken[3, 2] = np.nan
    with pytest.raises(InputError, match=r"point \(3, 2\)"):
        face_normals(broken)
    line = np.array([[[0, 0, 0], [1, 0, 0]], [[2, 0, 0], [3, 0, 0]]], dtype=float)
    with pytest.raises(DegenerateError, match=r"quad \(0, 0\): its diagonals are parallel"):
        face_normals(line)
    folded = np.array(
        [[[0, 0, 0], [0, 1, 0], [0, 0, 0]], [[1, 0, 0], [1, 1, 0], [1, 0, 0]]], dtype=float
    )
    with pytest.raises(DegenerateError, match=r"inner edge \(0, 0\): its faces are folded"):
        conical_to_circular(folded)

"""Multifrontal Cholesky factors: against scipy, whatever the order, the places and the pattern."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from optimize_meshes import hexagons, torus, wavy
from scipy.sparse import csr_array, diags_array, eye_array, kron

from ddgfab.errors import DegenerateError
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.dissection import dissect
from ddgfab.optimize.linear import SymmetricSolver
from ddgfab.optimize.multifrontal import Multifrontal


def graph_of(mesh: Mesh) -> csr_array:
    """Vertices coupled with those two edges away, and themselves."""
    one, two = mesh.edges.T
    ones = np.ones(len(mesh.edges))
    near = csr_array((ones, (one, two)), shape=2 * (mesh.n_vertices,))
    near = csr_array(near + near.T + eye_array(mesh.n_vertices))
    return csr_array(near @ near)


def system(mesh: Mesh, seed: int = 0) -> tuple[csr_array, Ints, Floats]:
    """A positive definite matrix of the coordinates of a mesh, nodes and places."""
    graph = graph_of(mesh)
    matrix = csr_array(kron(graph, np.ones((3, 3)), format="csr"))
    matrix.data = np.random.default_rng(seed).normal(size=len(matrix.data))
    matrix = csr_array(matrix @ matrix.T + 1e-3 * eye_array(matrix.shape[0]))
    node = np.repeat(np.arange(mesh.n_vertices), 3)
    return matrix, node, mesh.vertices[node]


MESHES = {"sheet": wavy(14), "torus": torus(16, 0.2), "hexagons": hexagons(8)}


@pytest.mark.parametrize("name", MESHES)
def test_solves(name: str) -> None:
    matrix, node, places = system(MESHES[name])
    right = np.random.default_rng(1).normal(size=len(node))
    x = Multifrontal(node, places).factor(matrix)(right)
    other = SymmetricSolver().factor(matrix)(right)
    np.testing.assert_allclose(x, other, rtol=1e-9, atol=1e-9 * np.abs(other).max())
    assert np.abs(matrix @ x - right).max() < 1e-8


def test_a_narrower_and_a_wider_pattern_later() -> None:
    """What barriers do: entries come and go from step to step."""
    mesh = MESHES["sheet"]
    matrix, node, places = system(mesh)
    solver = Multifrontal(node, places)
    right = np.ones(len(node))
    narrow = csr_array(diags_array(np.arange(1.0, 1 + len(node))))
    wide = csr_array(matrix @ matrix)
    for one in (matrix, narrow, wide, matrix):
        assert np.abs(one @ solver.factor(one)(right) - right).max() < 1e-6


def test_places_are_only_a_hint() -> None:
    """All nodes at one place, or at random ones: another order, the same solution."""
    matrix, node, places = system(MESHES["sheet"])
    right = np.ones(len(node))
    expected = Multifrontal(node, places).factor(matrix)(right)
    scattered = np.random.default_rng(2).normal(size=(node[-1] + 1, 3))[node]
    for other in (np.zeros_like(places), scattered):
        found = Multifrontal(node, other).factor(matrix)(right)
        np.testing.assert_allclose(found, expected, atol=1e-8 * np.abs(expected).max())


def test_unknowns_that_are_held() -> None:
    matrix, node, places = system(MESHES["sheet"])
    kept = np.flatnonzero(np.random.default_rng(3).uniform(size=len(node)) < 0.7)
    part = csr_array(matrix[kept][:, kept])
    numbers = np.unique(node[kept], return_inverse=True)[1]
    right = np.ones(len(kept))
    found = Multifrontal(numbers, places[kept]).factor(part)(right)
    assert np.abs(part @ found - right).max() < 1e-8


def test_matrices_that_are_not_positive_definite_are_refused() -> None:
    matrix, node, places = system(MESHES["sheet"])
    shifted = csr_array(matrix - 5 * eye_array(matrix.shape[0]))
    with pytest.raises(DegenerateError, match="positive definite"):
        Multifrontal(node, places).factor(shifted)


def test_every_node_is_eliminated_once_and_halves_do_not_meet() -> None:
    mesh = MESHES["sheet"]
    graph = graph_of(mesh)
    fronts = dissect(graph, mesh.vertices)
    order = np.concatenate([f.pivots for f in fronts])
    assert np.array_equal(np.sort(order), np.arange(mesh.n_vertices))
    turn = np.argsort(order)
    for at, front in enumerate(fronts):
        assert all(child < at for child in front.children)
        if len(front.border):
            assert turn[front.border].min() > turn[front.pivots].max()
            assert (np.diff(turn[front.border]) > 0).all()
    below = [set(f.pivots.tolist()) for f in fronts]
    for at, front in enumerate(fronts):
        for child in front.children:
            below[at] |= below[child]
        groups = [below[c] for c in front.children]
        for group, other in pairwise(groups):
            near = graph[sorted(group)].indices
            assert not other & set(near.tolist())


def test_factors_of_sheets_grow_little_faster_than_the_number_of_nodes() -> None:
    sizes = []
    for n in (20, 40):
        matrix, node, places = system(wavy(n))
        factor = Multifrontal(node, places).factor(matrix)
        sizes.append(factor.size / len(node))
    assert sizes[1] < 1.6 * sizes[0]

"""Sparse symmetric systems of one path: patterns that come and go."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_array, diags_array, random_array

from ddgfab.errors import DegenerateError
from ddgfab.optimize.linear import SymmetricSolver
from ddgfab.optimize.pattern import Pattern

SIZE = 60


def band(*offsets: int) -> csr_array:
    """A positive definite matrix with entries on some diagonals."""
    rows = [np.full(SIZE - k, -1.0 - 0.1 * k) for k in offsets]
    matrix = diags_array(rows, offsets=list(offsets), shape=(SIZE, SIZE))
    return csr_array(matrix + matrix.T + 20.0 * diags_array(np.arange(1.0, SIZE + 1)))


def test_values_lie_in_the_union_of_all_patterns() -> None:
    pattern, rng = Pattern(), np.random.default_rng(1)
    grown = []
    for density in (0.05, 0.05, 0.02, 0.1):
        matrix = csr_array(random_array((SIZE, SIZE), density=density, rng=rng))
        for same in (matrix, csr_array(3.0 * matrix)):
            values, grew = pattern.values(same)
            grown.append(grew)
            there = csr_array((values, pattern.columns, pattern.starts), shape=matrix.shape)
            assert abs(there - same).max() == 0
    assert grown == [True, False] * 4
    values, grew = pattern.values(csr_array((SIZE, SIZE)))
    assert not grew
    assert not values.any()


@pytest.mark.parametrize("placed", [True, False])
def test_patterns_that_change_are_solved(placed: bool) -> None:
    rng = np.random.default_rng(2)
    nodes = (np.arange(SIZE), rng.normal(size=(SIZE, 3))) if placed else None
    solver = SymmetricSolver(nodes)
    right = rng.normal(size=SIZE)
    for offsets in ((1,), (1, 7), (7,), (1, 2, 30), (30,)):
        matrix = band(*offsets)
        np.testing.assert_allclose(matrix @ solver.factor(matrix)(right), right, atol=1e-12)
    if placed:  # positive definite ones alone
        with pytest.raises(DegenerateError):
            solver.factor(csr_array(-1.0 * band(1)))
        matrix = band(1)
        np.testing.assert_allclose(matrix @ solver.factor(matrix)(right), right, atol=1e-12)

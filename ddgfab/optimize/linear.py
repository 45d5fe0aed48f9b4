"""Sparse symmetric systems: one interface, scipy always, a faster package when it is installed.

Matrices are positive definite or quasi-definite (positive block, negative block on the diagonal),
so that they factor without pivoting in any order. The order that keeps factors sparse is found
once and used again as long as the pattern of entries stays.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import MatrixRankWarning, splu

from ddgfab.errors import DegenerateError
from ddgfab.mesh import Floats, Ints

Solve = Callable[[Floats], Floats]


class SymmetricSolver:
    """Factors symmetric matrices that share a pattern; the ordering is kept between calls."""

    def __init__(self) -> None:
        self._pattern: tuple[Any, Any] | None = None
        self._order: Ints | None = None

    def factor(self, matrix: csr_array | csc_array) -> Solve:
        """Function that solves with the matrix.

        Raises
        ------
        DegenerateError
            The matrix is singular.
        """
        system = csc_array(matrix)
        system.sort_indices()
        if self._order is None or not self._same(system):
            self._pattern = (system.indptr.copy(), system.indices.copy())
            self._order = None
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error", MatrixRankWarning)
                return self._factor(system)
        except (RuntimeError, MatrixRankWarning) as reason:
            raise DegenerateError(
                f"a linear system of {system.shape[0]} unknowns is singular ({reason}): raise the "
                "damping, or give every unknown a term"
            ) from reason

    def _same(self, system: csc_array) -> bool:
        assert self._pattern is not None
        start, rows = self._pattern
        return bool(
            len(rows) == len(system.indices)
            and np.array_equal(start, system.indptr)
            and np.array_equal(rows, system.indices)
        )

    def _factor(self, system: csc_array) -> Solve:
        options = {"SymmetricMode": True}
        if self._order is None:
            lu = splu(system, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
            self._order = np.argsort(lu.perm_c)
            return lambda right: np.asarray(lu.solve(right))
        order = self._order
        lu = splu(
            csc_array(system[order][:, order]),
            permc_spec="NATURAL",
            diag_pivot_thresh=0.0,
            options=options,
        )

        def solve(right: Floats) -> Floats:
            out = np.empty_like(right)
            out[order] = lu.solve(right[order])
            return out

        return solve

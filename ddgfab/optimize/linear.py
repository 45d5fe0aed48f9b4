"""Sparse symmetric systems whose patterns of entries stay or grow.

Positive definite systems whose unknowns have places are factored by dense fronts (`multifrontal`),
the others by SuperLU.

Matrices are positive definite or quasi-definite (positive block, negative block on the diagonal),
so that they factor without pivoting in any order. The order that keeps factors sparse is found
once and used again as long as the pattern of entries stays.

Other packages are not offered: Intel MKL is slower than the fronts (benchmarks/README.md), and the
fast part of CHOLMOD is under the GPL.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable

import numpy as np
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import MatrixRankWarning, splu

from ddgfab.errors import DegenerateError
from ddgfab.mesh import Floats, Ints
from ddgfab.optimize.multifrontal import Multifrontal
from ddgfab.optimize.pattern import Pattern

Solve = Callable[[Floats], Floats]


class SymmetricSolver:
    """Factors symmetric matrices that share a pattern; the ordering is kept between calls."""

    def __init__(self, nodes: tuple[Ints, Floats] | None = None) -> None:
        """Say where the unknowns are, for positive definite systems.

        Parameters
        ----------
        nodes : (n,) the node of each unknown, (n, 3) its place (see `Multifrontal`)
        """
        self._fronts = None if nodes is None else Multifrontal(*nodes)
        self._pattern = Pattern()
        self._order: Ints | None = None

    def factor(self, matrix: csr_array | csc_array) -> Solve:
        """Function that solves with the matrix, for right-hand sides (n,), without places (n, k).

        Raises
        ------
        DegenerateError
            The matrix is singular.
        """
        system = csr_array(matrix)
        if self._fronts is not None and matrix.shape[0]:
            return self._fronts.factor(system)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error", MatrixRankWarning)
                return self._by_columns(*self._pattern.values(system))
        except (RuntimeError, MatrixRankWarning) as reason:
            raise DegenerateError(
                f"a linear system of {system.shape[0]} unknowns is singular ({reason}): raise the "
                "damping, or give every unknown a term"
            ) from reason

    def _by_columns(self, values: Floats, grew: bool) -> Solve:
        options = {"SymmetricMode": True}
        # symmetric: rows are columns
        size = len(self._pattern.starts) - 1
        system = csc_array(
            (values, self._pattern.columns, self._pattern.starts), shape=(size, size)
        )
        if grew or self._order is None:
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

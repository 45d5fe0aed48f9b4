"""Sparse symmetric systems: one interface, scipy always, a faster package when it is installed.

Positive definite systems whose unknowns have places are factored by dense fronts (`multifrontal`),
the others by SuperLU.

Matrices are positive definite or quasi-definite (positive block, negative block on the diagonal),
so that they factor without pivoting in any order. The order that keeps factors sparse is found
once and used again as long as the pattern of entries stays.

``pypardiso`` (Intel MKL) is picked for large systems when it is installed: it factors those of the
direct route several times faster (and small ones slower). CHOLMOD is not offered: its fast part is
under the GPL.
"""

from __future__ import annotations

import importlib
import importlib.util
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.sparse import csc_array, csr_array, csr_matrix, triu
from scipy.sparse.linalg import MatrixRankWarning, splu

from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats, Ints
from ddgfab.optimize.multifrontal import Multifrontal

Solve = Callable[[Floats], Floats]

_PARDISO = "pypardiso"
_SCIPY = "scipy"

_LARGE = 20_000
"""Unknowns from which on another package than scipy pays."""

_SYMMETRIC_INDEFINITE = -2
_ANALYSE_AND_FACTOR, _FACTOR, _SOLVE = 12, 22, 33
"""Matrix type and phases of PARDISO."""


class SymmetricSolver:
    """Factors symmetric matrices that share a pattern; the ordering is kept between calls."""

    def __init__(
        self, backend: str | None = None, nodes: tuple[Ints, Floats] | None = None
    ) -> None:
        """Choose a package of `available`; by default scipy, and the first for large systems.

        Parameters
        ----------
        nodes : for positive definite systems: (n,) the node of each unknown, (n, 3) its place
            (see `Multifrontal`)

        Raises
        ------
        InputError
            A package that is unknown or not installed.
        """
        offered = self.available()
        if backend is not None and backend not in offered:
            raise InputError(f"solver {backend!r} is not here; available: {', '.join(offered)}")
        self._backend = backend
        self._fronts = None if nodes is None else Multifrontal(*nodes)
        self._pattern: tuple[Any, Any] | None = None
        self._order: Ints | None = None
        self._pardiso: Any = None

    @staticmethod
    def available() -> tuple[str, ...]:
        """The packages that are installed, the fastest first."""
        found = importlib.util.find_spec(_PARDISO) is not None
        return (_PARDISO, _SCIPY) if found else (_SCIPY,)

    def factor(self, matrix: csr_array | csc_array) -> Solve:
        """Function that solves with the matrix, for (n,) or (n, k) right-hand sides.

        With pypardiso it is valid until the next call of `factor`.

        Raises
        ------
        DegenerateError
            The matrix is singular.
        """
        large = self.available()[0] if matrix.shape[0] >= _LARGE else _SCIPY
        chosen = self._backend or large
        if chosen == _SCIPY and self._fronts is not None and matrix.shape[0]:
            return self._fronts.factor(csr_array(matrix))
        system = csc_array(matrix)
        system.sort_indices()
        known = self._same(system)
        if not known:
            self._pattern = (system.indptr.copy(), system.indices.copy())
            self._order = None
        factor = self._by_pardiso if chosen == _PARDISO else self._by_scipy
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error", MatrixRankWarning)
                return factor(system, known)
        except (RuntimeError, MatrixRankWarning) as reason:
            raise DegenerateError(
                f"a linear system of {system.shape[0]} unknowns is singular ({reason}): raise the "
                "damping, or give every unknown a term"
            ) from reason

    def _same(self, system: csc_array) -> bool:
        if self._pattern is None:
            return False
        start, rows = self._pattern
        return bool(
            len(rows) == len(system.indices)
            and np.array_equal(start, system.indptr)
            and np.array_equal(rows, system.indices)
        )

    def _by_scipy(self, system: csc_array, known: bool) -> Solve:
        options = {"SymmetricMode": True}
        if not known or self._order is None:
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

    def _by_pardiso(self, system: csc_array, known: bool) -> Solve:
        if not known or self._pardiso is None:
            if self._pardiso is not None:
                self._pardiso.free_memory(everything=True)
            self._pardiso = importlib.import_module(_PARDISO).PyPardisoSolver(_SYMMETRIC_INDEFINITE)
        pardiso = self._pardiso
        upper = csr_matrix(triu(system, format="csr"))
        upper.sort_indices()
        # The public call analyses anew; the phase of an unchanged pattern has no public name.
        pardiso.set_phase(_FACTOR if known else _ANALYSE_AND_FACTOR)
        pardiso._call_pardiso(upper, np.zeros((system.shape[0], 1)))
        pardiso.set_phase(_SOLVE)

        def solve(right: Floats) -> Floats:
            columns = np.asfortranarray(right.reshape(len(right), -1))
            return np.asarray(pardiso._call_pardiso(upper, columns)).reshape(right.shape)

        return solve

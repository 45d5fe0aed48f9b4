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
import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from copy import copy
from typing import Any

import numpy as np
from scipy.sparse import csc_array, csr_array, csr_matrix
from scipy.sparse.linalg import MatrixRankWarning, splu

from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats, Ints
from ddgfab.optimize.multifrontal import Multifrontal
from ddgfab.optimize.pattern import Pattern

Solve = Callable[[Floats], Floats]

_PARDISO = "pypardiso"
_SCIPY = "scipy"

_LARGE = 20_000
"""Unknowns from which on another package than scipy pays."""

_POSITIVE_DEFINITE, _SYMMETRIC_INDEFINITE = 2, -2
_ANALYSE_AND_FACTOR, _FACTOR, _SOLVE = 12, 22, 33
"""Matrix types and phases of PARDISO."""


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
        self._kind = _SYMMETRIC_INDEFINITE if nodes is None else _POSITIVE_DEFINITE
        self._pattern = Pattern()
        self._order: Ints | None = None
        self._pardiso: Any = None
        self._upper: Any = None
        self._above: Ints = np.zeros(0, dtype=np.int64)

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
        system = csr_array(matrix)
        if chosen == _SCIPY and self._fronts is not None and matrix.shape[0]:
            return self._fronts.factor(system)
        values, grew = self._pattern.values(system)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error", MatrixRankWarning)
                return (self._by_pardiso if chosen == _PARDISO else self._by_scipy)(values, grew)
        except (RuntimeError, MatrixRankWarning) as reason:
            raise DegenerateError(
                f"a linear system of {system.shape[0]} unknowns is singular ({reason}): raise the "
                "damping, or give every unknown a term"
            ) from reason

    def _by_scipy(self, values: Floats, grew: bool) -> Solve:
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

    def _by_pardiso(self, values: Floats, grew: bool) -> Solve:
        if grew or self._pardiso is None:
            self._analyzed()
        pardiso, upper = self._pardiso, self._upper
        upper.data = values[self._above]
        # The public call analyses anew; the phase of an unchanged pattern has no public name.
        with _errors_of_pardiso():
            pardiso.set_phase(_ANALYSE_AND_FACTOR if grew else _FACTOR)
            pardiso._call_pardiso(upper, np.zeros((upper.shape[0], 1)))
        pardiso.set_phase(_SOLVE)

        def solve(right: Floats) -> Floats:
            # of self, which so outlives it: its end frees the factor
            columns = np.asfortranarray(right.reshape(len(right), -1))
            return np.asarray(self._pardiso._call_pardiso(upper, columns)).reshape(right.shape)

        return solve

    def _analyzed(self) -> None:
        """A solver of its own for the pattern, whose upper triangle it takes."""
        if self._pardiso is None:
            self._pardiso = _pardiso(self._kind)
            weakref.finalize(self, self._pardiso.free_memory, everything=True)
        else:
            self._pardiso.free_memory(everything=True)
        starts, columns = self._pattern.starts, self._pattern.columns
        rows = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
        self._above = np.flatnonzero(columns >= rows)
        counts = np.bincount(rows[self._above], minlength=len(starts) - 1)
        self._upper = csr_matrix(
            (np.zeros(len(self._above)), columns[self._above], np.append(0, np.cumsum(counts))),
            shape=(len(counts), len(counts)),
        )


def _pardiso(kind: int) -> Any:
    """A solver that has nothing analyzed yet, for a type of matrices.

    Made from the one that the package makes when it is loaded: its constructor searches the whole
    environment for the library each time, which takes as long as some factorizations.
    """
    made = copy(importlib.import_module(_PARDISO).ps)
    made.mtype = kind
    for name in ("pt", "iparm", "perm"):
        setattr(made, name, np.zeros_like(getattr(made, name)))
    return made


@contextmanager
def _errors_of_pardiso() -> Iterator[None]:
    """Errors of the package become RuntimeError."""
    error = importlib.import_module(f"{_PARDISO}.pardiso_wrapper").PyPardisoError
    try:
        yield
    except error as reason:
        raise RuntimeError(str(reason)) from reason

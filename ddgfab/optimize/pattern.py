"""The pattern of entries that the matrices of one path share, so that it is analyzed once.

From step to step barriers become active and inactive, and with them some entries come and go.
Values are laid into the union of all patterns seen, which soon does not grow any more.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from ddgfab.mesh import Floats, Ints


class Pattern:
    """The union of the patterns of square matrices.

    Attributes
    ----------
    starts, columns : (n + 1,), (m,) where its rows begin, columns of its entries, in order
    """

    def __init__(self) -> None:
        self.starts: Ints = np.zeros(0, dtype=np.int64)
        self.columns: Ints = np.zeros(0, dtype=np.int64)
        self._numbers: csr_array | None = None

    def values(self, matrix: csr_array) -> tuple[Floats, bool]:
        """(m,) entries of a matrix in the union, zeros elsewhere; whether the union grew for it."""
        matrix.sum_duplicates()  # sorts columns, too
        at = self._where(matrix)
        grew = at is None
        if at is None:
            self._widen(matrix)
            at = self._where(matrix)
        assert at is not None
        values = np.zeros(len(self.columns))
        values[at] = matrix.data
        return values, grew

    def _where(self, matrix: csr_array) -> Ints | slice | None:
        """Where entries are in the union; None if it lacks some."""
        if self._numbers is None or matrix.nnz > len(self.columns):
            return None
        if matrix.nnz == len(self.columns):
            same = np.array_equal(self.columns, matrix.indices)
            return slice(None) if same and np.array_equal(self.starts, matrix.indptr) else None
        ones = np.ones(len(matrix.indices))
        found = self._numbers.multiply(
            csr_array((ones, matrix.indices, matrix.indptr), shape=matrix.shape)
        )
        return found.data.astype(np.int64) - 1 if found.nnz == matrix.nnz else None

    def _widen(self, matrix: csr_array) -> None:
        ones = np.ones(len(matrix.indices))
        union = csr_array((ones, matrix.indices, matrix.indptr), shape=matrix.shape)
        if self._numbers is not None:
            union = csr_array(union + self._numbers)
            union.sort_indices()
        # the numbers of the entries, from one on, as entries: exact up to 2^53
        self._numbers = csr_array(
            (np.arange(1.0, union.nnz + 1), union.indices, union.indptr), shape=matrix.shape
        )
        self.starts, self.columns = union.indptr, union.indices

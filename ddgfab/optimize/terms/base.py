"""What terms have in common: rows that each depend on a few unknowns, always the same ones."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csr_array, eye_array, kron

from ddgfab.arguments import checked
from ddgfab.mesh import Floats, Ints


@dataclass(frozen=True, eq=False, kw_only=True)
class LocalTerm(ABC):
    """Residuals of which each depends on k unknowns.

    A subclass says what the residuals are in terms of these alone: `values` and `gradients`.

    Attributes
    ----------
    index : (m, k) the unknowns of each residual
    factor : (m,) or a number, multiplies each residual (one over a length, a weight of a row)
    of, elements : what the residuals belong to ("face", "vertex", "edge") and (m,) their ids
    """

    name: str
    index: Ints
    factor: Floats | float = 1.0
    weight: float = 1.0
    hard: bool = False
    of: str = "row"
    elements: Ints | None = None

    @abstractmethod
    def values(self, local: Floats) -> Floats:
        """(m,) residuals from the (m, k) values of their unknowns."""

    @abstractmethod
    def gradients(self, local: Floats) -> Floats:
        """(m, k) derivatives of the residuals by their unknowns."""

    def residual(self, x: Floats) -> Floats:
        """(m,) residuals at the unknowns x."""
        return np.asarray(self.factor * self.values(x[self.index]))

    def jacobian(self, x: Floats) -> csr_array:
        """(m, n) derivative."""
        rows, k = self.index.shape
        slopes = np.asarray(self.factor)[..., None] * self.gradients(x[self.index])
        return csr_array(
            (slopes.ravel(), self.index.ravel(), np.arange(0, rows * k + 1, k)),
            shape=(rows, len(x)),
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class LinearTerm:
    """Residuals A x - b with a fixed sparse matrix: closeness, fairness, fixed lines and planes."""

    name: str
    matrix: csr_array
    target: Floats
    weight: float = 1.0
    hard: bool = False

    def residual(self, x: Floats) -> Floats:
        """(m,) residuals at the unknowns x."""
        columns = self.matrix.shape[1]
        return np.asarray(self.matrix @ x[:columns] - self.target)

    def jacobian(self, x: Floats) -> csr_array:
        """(m, n) derivative: the matrix, widened where blocks of unknowns were added."""
        return widened(self.matrix, len(x))


@dataclass(frozen=True, eq=False, kw_only=True)
class VectorTerm:
    """Residuals S X - B of the (V, 3) vertices: one scalar matrix for all three coordinates.

    What `solve` needs to know of such terms is V x V, so problems whose soft terms are all of this
    kind are the fast ones.

    Attributes
    ----------
    scalar : (m, V) sparse matrix S
    target : (m, 3) B
    """

    name: str
    scalar: csr_array
    target: Floats
    weight: float = 1.0
    hard: bool = False

    @cached_property
    def matrix(self) -> csr_array:
        """(3m, 3V) the same matrix for the flat vector of unknowns."""
        return csr_array(kron(self.scalar, eye_array(3), format="csr"))

    def residual(self, x: Floats) -> Floats:
        """(3m,) residuals at the unknowns x."""
        points = x[: 3 * self.scalar.shape[1]].reshape(-1, 3)
        return np.asarray(self.scalar @ points - self.target).ravel()

    def jacobian(self, x: Floats) -> csr_array:
        """(3m, n) derivative: the matrix, widened where blocks of unknowns were added."""
        return widened(self.matrix, len(x))


@checked
def widened(matrix: csr_array, columns: int) -> csr_array:
    """The matrix with columns of zeros added at its right."""
    return csr_array((matrix.data, matrix.indices, matrix.indptr), shape=(matrix.shape[0], columns))

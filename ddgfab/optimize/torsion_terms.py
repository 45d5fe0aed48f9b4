"""Soft limits of high power."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from ddgfab.mesh import Floats
from ddgfab.optimize.problem import Term
from ddgfab.optimize.terms.axes import block_matrix


@dataclass(frozen=True, eq=False, kw_only=True)
class Power:
    """A soft limit: (|r| / limit)^power for the vectors r of another term, `width` numbers each.

    Far below the limit it costs nothing, above it much, and in between it is smooth: Newton's
    method goes on where a hard bound would make it change its mind at every step. With a high
    power the greatest |r| counts almost alone.
    """

    term: Term
    limit: float
    width: int = 1
    power: int = 4
    weight: float = 1.0
    hard: bool = False

    @property
    def name(self) -> str:
        """The name of the term."""
        return self.term.name

    def _lengths(self, vectors: Floats) -> Floats:
        return np.asarray(np.linalg.norm(vectors, axis=1) / self.limit)

    def residual(self, x: Floats) -> Floats:
        """(m,) residuals."""
        return self._lengths(self.term.residual(x).reshape(-1, self.width)) ** self.power

    def jacobian(self, x: Floats) -> csr_array:
        """(m, n)."""
        vectors = self.term.residual(x).reshape(-1, self.width)
        part = self.power * self._lengths(vectors) ** (self.power - 2) / self.limit**2
        ids = np.arange(len(vectors))
        rows = block_matrix((part[:, None] * vectors)[:, None], ids, ids, (len(ids), len(ids)))
        return csr_array(rows @ self.term.jacobian(x))

    def hessian(self, x: Floats) -> csr_array:
        """(n, n) of half the squared residuals, but for the curvature of r itself: semidefinite."""
        vectors = self.term.residual(x).reshape(-1, self.width)
        lengths, p = self._lengths(vectors), self.power
        flat = p * lengths ** (2 * p - 2) / self.limit**2
        steep = 2 * p * (p - 1) * lengths ** (2 * p - 4) / self.limit**4
        block = flat[:, None, None] * np.eye(self.width)
        block += steep[:, None, None] * vectors[:, :, None] * vectors[:, None, :]
        ids = np.arange(len(vectors))
        slope = self.term.jacobian(x)
        return csr_array(slope.T @ block_matrix(block, ids, ids, (len(ids), len(ids))) @ slope)

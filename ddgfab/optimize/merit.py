"""The function that a path descends: energy, barriers, and the goal's equations under a penalty."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, diags_array, eye_array, vstack

from ddgfab.mesh import Floats, Ints
from ddgfab.optimize.problem import Barrier, Problem, Term
from ddgfab.optimize.terms.base import LinearTerm, VectorTerm, widened


@dataclass(frozen=True, eq=False)
class Model:
    """The merit near a state, to second order and in the free unknowns.

    Attributes
    ----------
    gradient : (n,) of energy and barriers
    hessian : (n, n) of energy and barriers, Gauss-Newton
    lines : (m, n) Jacobian of the equations
    values : (m,) the equations
    """

    gradient: Floats
    hessian: csr_array
    lines: csr_array
    values: Floats


class Merit:
    """Energy E, barriers B and equations c of a problem: E + B + rho |c|^2 / 2.

    Terms whose nearest points move (`at`) are frozen at a state by `freeze`; until the next call
    all values and derivatives are those of the frozen terms.
    """

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self._free: Ints = np.flatnonzero(problem.free)
        self._all = len(self._free) == len(problem.start)
        soft = [t for t in problem.terms if not t.hard]
        linear = [t for t in soft if isinstance(t, VectorTerm | LinearTerm)]
        size = len(problem.start)
        rows = [np.sqrt(t.weight) * widened(csr_array(t.matrix), size) for t in linear]
        aims = [np.sqrt(t.weight) * np.ravel(t.target) for t in linear]
        self._matrix = csr_array(vstack(rows, format="csr")) if rows else csr_array((0, size))
        self._aim = np.concatenate(aims) if aims else np.zeros(0)
        self._square = csr_array(self._matrix.T @ self._matrix)
        self._curved = [t for t in soft if not isinstance(t, VectorTerm | LinearTerm)]
        self._hard = [t for t in problem.terms if t.hard]
        self._frozen: list[Term] = []

    def freeze(self, x: Floats) -> None:
        """Take nearest points and normals at x."""
        self._frozen = [t.at(x) for t in self.problem.following]

    def equations(self, x: Floats) -> Floats:
        """(m,) residuals of the hard terms."""
        parts = [t.residual(x) for t in self._hard]
        return np.concatenate(parts) if parts else np.zeros(0)

    def _barriers(self) -> tuple[Barrier, ...]:
        return self.problem.barriers

    def value(self, x: Floats, rho: float) -> float:
        """The merit; infinite beyond a barrier."""
        total = 0.0
        for barrier in self._barriers():
            total += barrier.value(x)
            if not np.isfinite(total):
                return np.inf
        away = self._matrix @ x - self._aim
        total += 0.5 * float(away @ away)
        for term in (*self._curved, *self._frozen):
            residual = term.residual(x)
            total += 0.5 * term.weight * float(residual @ residual)
        values = self.equations(x)
        total += 0.5 * rho * float(values @ values)
        return total if np.isfinite(total) else np.inf

    def possible(self, x: Floats) -> bool:
        """Whether x is on the right side of all barriers."""
        return all(np.isfinite(barrier.value(x)) for barrier in self._barriers())

    def model(self, x: Floats) -> Model:
        """Derivatives at x."""
        gradient = self._matrix.T @ (self._matrix @ x - self._aim)
        rows: list[csr_array] = []
        for term in (*self._curved, *self._frozen):
            slope = term.jacobian(x)
            gradient += term.weight * (slope.T @ term.residual(x))
            rows.append(csr_array(np.sqrt(term.weight) * slope))
        for barrier in self._barriers():
            slope, first, second = barrier.active(x)
            gradient += slope.T @ first
            rows.append(csr_array(diags_array(np.sqrt(second)) @ slope))
        hessian = self._square
        if rows:
            stacked = csr_array(vstack(rows, format="csr"))
            hessian = csr_array(hessian + stacked.T @ stacked)
        lines = [t.jacobian(x) for t in self._hard]
        whole = csr_array(vstack(lines, format="csr")) if lines else csr_array((0, len(x)))
        if not self._all:
            gradient = gradient[self._free]
            hessian = csr_array(hessian[self._free][:, self._free])
            whole = csr_array(whole[:, self._free])
        return Model(np.asarray(gradient), hessian, whole, self.equations(x))

    @property
    def nodes(self) -> tuple[Ints, Floats] | None:
        """Nodes and places of the free unknowns, for `SymmetricSolver`; None if some have none."""
        problem = self.problem
        layout, points = problem.layout, problem.vertices(problem.start)
        if any(count != len(points) for count in layout.counts):
            return None
        owner = np.concatenate([np.repeat(np.arange(len(points)), w) for w in layout.widths])
        block = np.repeat(np.arange(len(layout.widths)), [len(points) * w for w in layout.widths])
        owner, block = owner[self._free], block[self._free]
        starts = (np.diff(owner, prepend=-1) != 0) | (np.diff(block, prepend=-1) != 0)
        return np.cumsum(starts) - 1, points[owner]

    def moved(self, x: Floats, step: Floats) -> Floats:
        """The unknowns after a step of the free ones."""
        after = x.copy()
        after[self._free] += step
        return after

    def longest(self, step: Floats) -> float:
        """Greatest length of a vertex' (or an axis') part of a step of the free unknowns."""
        full = np.zeros(len(self.problem.start))
        full[self._free] = step
        return max(
            (
                float(np.linalg.norm(self.problem.layout.values(full, name), axis=1).max())
                for name in self.problem.layout.names
            ),
            default=0.0,
        )


def damped(matrix: csr_array, damping: float) -> csr_array:
    """The matrix with a damping on its diagonal."""
    return csr_array(matrix + damping * eye_array(matrix.shape[0]))

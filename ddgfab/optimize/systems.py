"""The linear system of one step: [[H, C'], [C, -mend]] (step, force) = (-gradient, -values).

H is the Gauss-Newton Hessian of the soft terms, C the Jacobian of the hard ones. Three routes:

- *dual*: H is diagonal (closeness only); C H^-1 C' is factored, one unknown an equation;
- *fair*: H is the same V x V matrix for all three coordinates and never changes; it is factored
  once, and conjugate gradients run on C H^-1 C' without forming it. C is like a second difference,
  H like a fourth, so this operator is of order zero: it needs few iterations at any size;
- *direct*: everything else; the whole system is factored.

All unknowns are the free ones, in parts of `Problem.scale`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.sparse import block_array, csr_array, diags_array, eye_array

from ddgfab.mesh import Floats
from ddgfab.optimize.linear import Solve, SymmetricSolver
from ddgfab.optimize.problem import Problem
from ddgfab.optimize.terms.base import VectorTerm


class StepSystem(Protocol):
    """A factored system, to be solved for several right-hand sides."""

    def step(self, gradient: Floats, values: Floats, force: Floats) -> tuple[Floats, Floats]:
        """Step and multipliers; `force` are multipliers near the answer.

        The proximal term pulls towards `force`, so that it mends equations that depend on each
        other without a bias on the others.
        """
        ...


@dataclass(frozen=True)
class Direct:
    """The whole system factored."""

    solve: Solve
    mend: float

    @staticmethod
    def of(solver: SymmetricSolver, hessian: csr_array, lines: csr_array, eps: float) -> Direct:
        """Of the Hessian and the lines of the constraints; `eps` mends lines that depend."""
        rows = lines.shape[0]
        if rows == 0:
            return Direct(solver.factor(hessian), 0.0)
        mend = eps * float(lines.multiply(lines).sum()) / rows
        corner = -mend * eye_array(rows)
        return Direct(solver.factor(block_array([[hessian, lines.T], [lines, corner]])), mend)

    def step(self, gradient: Floats, values: Floats, force: Floats) -> tuple[Floats, Floats]:
        """Step and multipliers."""
        both = self.solve(np.concatenate([-gradient, -values - self.mend * force]))
        return both[: len(gradient)], both[len(gradient) :]


@dataclass(frozen=True)
class Dual:
    """The Schur complement of a diagonal H factored."""

    solve: Solve
    inverse: Floats
    lines: csr_array
    mend: float

    @staticmethod
    def of(solver: SymmetricSolver, diagonal: Floats, lines: csr_array, eps: float) -> Dual:
        """Of the diagonal of H and the lines of the constraints; `eps` mends lines that depend."""
        inverse = 1.0 / diagonal
        product = csr_array(lines @ diags_array(inverse) @ lines.T)
        mend = eps * float(product.diagonal().mean())
        system = product + mend * eye_array(lines.shape[0])
        return Dual(solver.factor(csr_array(system)), inverse, lines, mend)

    def step(self, gradient: Floats, values: Floats, force: Floats) -> tuple[Floats, Floats]:
        """Step and multipliers."""
        pull = self.lines @ (self.inverse * gradient)
        new = self.solve(values - pull + self.mend * force)
        return -self.inverse * (gradient + self.lines.T @ new), new


@dataclass(frozen=True)
class Fair:
    """Conjugate gradients on the Schur complement of a factored, constant V x V matrix."""

    solve: Solve
    lines: csr_array
    across: csr_array
    forcing: float
    """Part of the values that may be left after the step."""
    iterations: int

    def back(self, right: Floats) -> Floats:
        """H^-1 of a vector of free coordinates."""
        return self.solve(right.reshape(-1, 3)).ravel()

    def step(self, gradient: Floats, values: Floats, force: Floats) -> tuple[Floats, Floats]:
        """Step and multipliers."""
        start = -self.back(gradient)
        new = conjugate_gradients(
            lambda v: np.asarray(self.lines @ self.back(self.across @ v)),
            values + self.lines @ start,
            force,
            self.forcing * float(np.linalg.norm(values)),
            self.iterations,
        )
        return start - self.back(self.across @ new), new


def conjugate_gradients(
    product: Callable[[Floats], Floats],
    right: Floats,
    start: Floats,
    tolerance: float,
    iterations: int,
) -> Floats:
    """Approximate solution of a semidefinite system: best of the iterates' energies, the last one.

    Source: Nocedal, Wright 2006, algorithm 5.2.
    """
    x = start.copy()
    residual = right - product(x) if x.any() else right.copy()
    way, square = residual.copy(), float(residual @ residual)
    for _ in range(iterations):
        if square <= tolerance**2:
            break
        image = product(way)
        curvature = float(way @ image)
        if curvature <= 0.0:  # the system is singular along this way: nothing more to gain
            break
        x += (square / curvature) * way
        residual -= (square / curvature) * image
        new = float(residual @ residual)
        way = residual + (new / square) * way
        square = new
    return x


@dataclass(frozen=True)
class FairMetric:
    """The factored V x V matrix of problems whose soft terms are all `VectorTerm`s."""

    solve: Solve
    diagonal: Floats | None
    """(free V,) the matrix where it is diagonal."""

    @staticmethod
    def of(problem: Problem, damping: float) -> FairMetric | None:
        """None where the soft terms are of another kind, or unknowns are held one by one."""
        count = problem.mesh.n_vertices
        soft = [t for t in problem.terms if not t.hard]
        free = problem.free.reshape(-1, 3) if len(problem.free) == 3 * count else None
        if free is None or not soft or (free != free[:, :1]).any():
            return None
        kept = np.flatnonzero(free[:, 0])
        total = damping * eye_array(len(kept))
        scale = diags_array(problem.scale[::3][kept])
        for term in soft:
            if not isinstance(term, VectorTerm):
                return None
            part = csr_array(term.scalar[:, kept] @ scale)
            total = total + term.weight * (part.T @ part)
        matrix = csr_array(total)
        diagonal = matrix.diagonal() if matrix.nnz == len(kept) else None
        # One factorisation, hundreds of solves: scipy is as fast as any there.
        return FairMetric(SymmetricSolver("scipy").factor(matrix), diagonal)

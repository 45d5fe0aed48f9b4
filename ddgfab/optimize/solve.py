"""Damped sequential quadratic programming with Gauss-Newton Hessians on sparse terms.

Minimise sum of weight * |residual|^2 / 2 over soft terms under residual = 0 of hard terms. Each
step solves [[H, C'], [C, -eps]] with H = sum weight J'J + damping. Where H is diagonal (nothing but
closeness) the Schur complement C H^-1 C' + eps is factored instead: one unknown an equation, the
dual Gauss-Newton step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_array, csr_array, diags_array, eye_array, vstack

from ddgfab.errors import OptimizeError
from ddgfab.mesh import Floats
from ddgfab.optimize.linear import SymmetricSolver
from ddgfab.optimize.problem import Problem


@dataclass(frozen=True)
class SolveOptions:
    """How the solver runs; every field may be left as it is."""

    max_steps: int = 50
    """Steps before giving up."""
    tolerance: float = 1e-11
    """Greatest residual of a hard term that counts as met."""
    decrease: float = 1e-4
    """Done when hard terms are met and the objective falls by less than this part in a step."""
    damping: float = 1e-6
    """Weight of |step|^2 (in parts of `Problem.scale`) at the beginning and at least."""
    regularisation: float = 1e-9
    """Weight of the multipliers: mends hard terms that depend on each other."""
    longest_step: float = 1.0
    """No unknown moves by more than this (in parts of `Problem.scale`) in a step."""


@dataclass(frozen=True)
class Step:
    """One line of the history."""

    objective: float
    violation: float
    """Greatest residual of a hard term after the step."""
    longest: float
    """Greatest movement of an unknown, in parts of `Problem.scale`."""
    length: float
    """Part of the proposed step that was taken."""


@dataclass(frozen=True, eq=False)
class Solution:
    """What a solver found: the unknowns, "converged" or why not, and the history of steps."""

    value: Floats
    status: str
    history: tuple[Step, ...]

    @property
    def converged(self) -> bool:
        """Whether the hard terms are met and the objective has come to rest."""
        return self.status == "converged"


Progress = Callable[[int, Step], None]


class _State:
    """Values and derivatives of all terms at a point, in scaled free unknowns."""

    def __init__(self, problem: Problem, x: Floats) -> None:
        self.problem, self.x = problem, x
        self.soft = [(t.weight, t.residual(x)) for t in problem.terms if not t.hard]
        hard = [t.residual(x) for t in problem.terms if t.hard]
        self.values = np.concatenate(hard) if hard else np.zeros(0)
        self.objective = 0.5 * float(sum(w * (r @ r) for w, r in self.soft))
        self.violation = float(np.abs(self.values).max(initial=0.0))

    def merit(self, penalty: float) -> float:
        return self.objective + penalty * float(np.abs(self.values).sum())

    def derivatives(self) -> tuple[csr_array, Floats, csr_array]:
        """Gauss-Newton Hessian, gradient, Jacobian of the hard terms."""
        problem = self.problem
        free = np.flatnonzero(problem.free)
        scale = diags_array(problem.scale[free])
        size = len(free)
        hessian, gradient = csr_array((size, size)), np.zeros(size)
        soft = (t for t in problem.terms if not t.hard)
        for term, (weight, residual) in zip(soft, self.soft, strict=True):
            matrix = csr_array(term.jacobian(self.x)[:, free] @ scale)
            hessian = hessian + weight * (matrix.T @ matrix)
            gradient += weight * (matrix.T @ residual)
        hard = [csr_array(t.jacobian(self.x)[:, free] @ scale) for t in problem.terms if t.hard]
        lines = csr_array(vstack(hard, format="csr")) if hard else csr_array((0, size))
        return csr_array(hessian), gradient, lines


def _system(
    solver: SymmetricSolver,
    parts: tuple[csr_array, Floats, csr_array],
    damping: float,
    eps: float,
) -> Callable[[Floats, Floats, Floats], tuple[Floats, Floats]]:
    """Function (gradient, values, force) -> step in scaled free unknowns, multipliers.

    `force` are the multipliers of the step before: the proximal term pulls towards them, so that
    it mends dependent equations without a bias on the others.
    """
    hessian, _, lines = parts
    rows, size = lines.shape
    damped = csr_array(hessian + damping * eye_array(size))
    if rows == 0:
        free = solver.factor(damped)
        return lambda gradient, values, force: (free(-gradient), force)
    if damped.nnz == size:
        inverse = 1.0 / damped.diagonal()
        scaled = csr_array(lines @ diags_array(inverse))
        product = csr_array(scaled @ lines.T)
        mend = eps * float(product.diagonal().mean())
        dual = solver.factor(product + mend * eye_array(rows))

        def through(gradient: Floats, values: Floats, force: Floats) -> tuple[Floats, Floats]:
            new = dual(values - scaled @ gradient + mend * force)
            return -inverse * (gradient + lines.T @ new), new

        return through
    mend = eps * float(lines.multiply(lines).sum()) / rows
    whole = solver.factor(block_array([[damped, lines.T], [lines, -mend * eye_array(rows)]]))

    def direct(gradient: Floats, values: Floats, force: Floats) -> tuple[Floats, Floats]:
        both = whole(np.concatenate([-gradient, -values - mend * force]))
        return both[:size], both[size:]

    return direct


def solve(
    problem: Problem,
    options: SolveOptions | None = None,
    *,
    throw: bool = True,
    progress: Progress | None = None,
) -> Solution:
    """Solve a problem from its start.

    Parameters
    ----------
    throw : raise when it does not converge; otherwise the best point comes back with its status
    progress : called with the number of each step and what it did

    Returns
    -------
    Solution with status "converged", "stalled" (no step makes it better) or "stopped" (too many)

    Raises
    ------
    OptimizeError
        Not converged; carries the solution.

    Source: Nocedal, Wright 2006, ch. 18 (l1 merit); damping after Levenberg and Marquardt.
    """
    chosen = options or SolveOptions()
    solver = SymmetricSolver()
    state = _State(problem, problem.start.copy())
    damping, penalty, status = chosen.damping, 0.0, "stopped"
    force = np.zeros(len(state.values))
    history: list[Step] = []
    for number in range(chosen.max_steps):
        parts = state.derivatives()
        system = _system(solver, parts, damping, chosen.regularisation)
        move, new = system(parts[1], state.values, force)
        penalty = max(1.5 * float(np.abs(new).max(initial=0.0)), 0.3 * penalty)

        def mended(values: Floats) -> Floats:
            return system(np.zeros(len(move)), values, np.zeros(len(new)))[0]

        after, length, longest = _search(state, move, penalty, chosen.longest_step, mended)
        if after is None:
            damping = max(100 * damping, 1e-4)
            if damping > 1e6:
                status = "converged" if state.violation <= chosen.tolerance else "stalled"
                break
            continue
        force = new
        damping = max(damping / 10, chosen.damping) if length > 0.5 else 3 * damping
        step = Step(after.objective, after.violation, longest, length)
        history.append(step)
        if progress is not None:
            progress(number, step)
        fallen = state.objective - after.objective
        state = after
        if state.violation <= chosen.tolerance and abs(fallen) <= chosen.decrease * max(
            state.objective, np.finfo(float).tiny
        ):
            status = "converged"
            break
    solution = Solution(state.x, status, tuple(history))
    if throw and not solution.converged:
        raise OptimizeError(_words(problem, state, status, len(history), chosen), solution=solution)
    return solution


def _search(
    state: _State,
    move: Floats,
    penalty: float,
    longest: float,
    mended: Callable[[Floats], Floats],
) -> tuple[_State | None, float, float]:
    """The state after the longest of some shorter and shorter steps that lowers the merit.

    A whole step that fails is tried once more with the curvature of the equations taken out
    (second-order correction): otherwise short steps would creep along curved equations.
    """
    problem = state.problem
    greatest = float(np.abs(move).max(initial=0.0))
    if not np.isfinite(greatest):
        return None, 0.0, 0.0
    length = min(1.0, longest / greatest) if greatest > 0 else 1.0
    limit = state.merit(penalty) * (1 + 1e-12)

    def at(step: Floats) -> _State:
        full = np.zeros(len(state.x))
        full[problem.free] = problem.scale[problem.free] * step
        return _State(problem, state.x + full)

    for halving in range(8):
        after = at(length * move)
        if after.merit(penalty) <= limit:
            return after, length, length * greatest
        if halving == 0 and len(after.values):
            bend = after.values - (1 - length) * state.values
            after = at(length * move + mended(bend))
            if after.merit(penalty) <= limit:
                return after, length, length * greatest
        length /= 2
    return None, 0.0, 0.0


def _words(problem: Problem, state: _State, status: str, steps: int, options: SolveOptions) -> str:
    worst = []
    for term in problem.terms:
        if term.hard:
            values = np.abs(term.residual(state.x))
            if len(values) and values.max() > options.tolerance:
                worst.append(f"{term.name} {values.max():.2g} (row {int(values.argmax())})")
    missed = f"; not met: {', '.join(worst)} (limit {options.tolerance:g})" if worst else ""
    return (
        f"optimisation {status} after {steps} steps{missed}\n"
        "hard terms may contradict each other: free some vertices, or make one of them soft"
    )

"""Damped sequential quadratic programming with Gauss-Newton Hessians on sparse terms.

Minimise sum of weight * |residual|^2 / 2 over soft terms under residual = 0 of hard terms. How the
linear system of a step is solved depends on the terms: see `systems`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, dia_array, diags_array, eye_array, vstack

from ddgfab.arguments import checked
from ddgfab.errors import OptimizeError
from ddgfab.mesh import Floats, Ints
from ddgfab.optimize.linear import SymmetricSolver
from ddgfab.optimize.problem import Problem, Term
from ddgfab.optimize.result import Step
from ddgfab.optimize.systems import Direct, Dual, Fair, FairMetric, StepSystem


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
    longest_step: float = np.inf
    """No unknown moves by more than this (in parts of `Problem.scale`) in a step."""
    forcing: float = 0.1
    """Part of the hard residuals that conjugate gradients may leave in a step."""
    iterations: int = 80
    """Conjugate gradient iterations in a step."""
    iterative: bool = True
    """Conjugate gradients where the soft terms allow them; otherwise always factor the system."""
    backend: str | None = None
    """Package that factors, of `SymmetricSolver.available`; by default chosen by size."""


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


_GIVE_UP = 1e6
"""Steps under a heavier damping are too short to be of use."""
_HEAVIER, _HEAVY = 100.0, 1e-4
"""After a step that failed: damping times this, and at least this."""
_EXACT, _FORGET = 1.5, 0.3
"""Penalty over the greatest multiplier, so that the merit is exact; how fast it may sink."""
_HALVINGS = 8
"""Shorter steps that are tried."""
_ROUNDING = 1e-12
"""Part of the merit that is rounding."""


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

    def gradient_and_lines(self) -> tuple[Floats, csr_array]:
        """Gradient of the soft terms, Jacobian of the hard ones."""
        free, scale = self._free()
        gradient = np.zeros(len(free))
        for term, (weight, residual) in zip(self._soft(), self.soft, strict=True):
            slope = weight * (term.jacobian(self.x).T @ residual)
            gradient += np.asarray(slope)[free] * scale.diagonal()
        hard = [t.jacobian(self.x) for t in self.problem.terms if t.hard]
        if not hard:
            return gradient, csr_array((0, len(free)))
        whole = csr_array(vstack(hard, format="csr"))
        lines = whole if len(free) == len(self.x) else whole[:, free]
        return gradient, csr_array(lines @ scale)

    def hessian(self, damping: float) -> csr_array:
        """Gauss-Newton Hessian of the soft terms plus the damping."""
        free, scale = self._free()
        total = damping * eye_array(len(free))
        for term in self._soft():
            matrix = csr_array(term.jacobian(self.x)[:, free] @ scale)
            total = total + term.weight * (matrix.T @ matrix)
        return csr_array(total)

    def _soft(self) -> list[Term]:
        return [t for t in self.problem.terms if not t.hard]

    def _free(self) -> tuple[Ints, dia_array]:
        free = np.flatnonzero(self.problem.free)
        return free, diags_array(self.problem.scale[free])


class _Stepper:
    """Chooses the route of the linear systems once, and factors them."""

    def __init__(self, problem: Problem, options: SolveOptions) -> None:
        self._options = options
        self._solver = SymmetricSolver(options.backend)
        self._metric = None
        if options.iterative:
            self._metric = FairMetric.of(problem, options.damping)

    @property
    def damped(self) -> bool:
        """Whether another damping makes another step."""
        return self._metric is None or self._metric.diagonal is not None

    def system(self, state: _State, lines: csr_array, damping: float) -> StepSystem:
        """The system of a step from a state."""
        chosen = self._options
        if self._metric is not None:
            if self._metric.diagonal is None or lines.shape[0] == 0:
                return Fair(
                    self._metric.solve, lines, csr_array(lines.T), chosen.forcing, chosen.iterations
                )
            diagonal = np.repeat(self._metric.diagonal, 3) + damping
            return Dual.of(self._solver, diagonal, lines, chosen.regularisation)
        return Direct.of(self._solver, state.hessian(damping), lines, chosen.regularisation)


@checked
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
    state, stepper = _State(problem, problem.start.copy()), _Stepper(problem, chosen)
    damping, penalty, status = chosen.damping, 0.0, "stopped"
    force = np.zeros(len(state.values))
    history: list[Step] = []
    for _ in range(chosen.max_steps):
        gradient, lines = state.gradient_and_lines()
        system = stepper.system(state, lines, damping)
        move, new = system.step(gradient, state.values, force)
        penalty = max(_EXACT * float(np.abs(new).max(initial=0.0)), _FORGET * penalty)
        after, length, longest = _search(state, system, move, penalty, chosen.longest_step)
        if after is None:
            damping = max(_HEAVIER * damping, _HEAVY)
            if damping > _GIVE_UP or not stepper.damped:
                status = "converged" if state.violation <= chosen.tolerance else "stalled"
                break
            continue
        force = new
        damping = max(damping / 10, chosen.damping) if length > 0.5 else 3 * damping
        step = Step(after.objective, after.violation, longest, length)
        history.append(step)
        if progress is not None:
            progress(len(history) - 1, step)
        fallen = state.objective - after.objective
        state = after
        if state.violation <= chosen.tolerance and abs(fallen) <= chosen.decrease * max(
            state.objective, np.finfo(float).tiny
        ):
            status = "converged"
            break
    return _finished(problem, state, status, history, chosen, throw)


@checked
def polish(
    problem: Problem,
    options: SolveOptions | None = None,
    *,
    throw: bool = True,
    progress: Progress | None = None,
) -> Solution:
    """Meet the hard terms of a problem with least movement from its start; soft ones are ignored.

    Every step is the shortest one, -C' (C C' + eps)^-1 c: one unknown an equation, quadratic
    convergence. It knows nothing of fairness, so it is for the last digits: `solve` first.

    Parameters, return value and errors are those of `solve`.

    Source: the dual Gauss-Newton method; Nocedal, Wright 2006, section 10.3.
    """
    chosen = options or SolveOptions()
    solver = SymmetricSolver(chosen.backend)
    only = Problem(
        problem.mesh,
        problem.layout,
        problem.start,
        problem.scale,
        problem.free,
        tuple(t for t in problem.terms if t.hard),
    )
    state, status = _State(only, problem.start.copy()), "stopped"
    history: list[Step] = []
    while state.violation > chosen.tolerance and len(history) < chosen.max_steps:
        gradient, lines = state.gradient_and_lines()
        system = Dual.of(solver, np.ones(len(gradient)), lines, chosen.regularisation)
        move, _ = system.step(gradient, state.values, np.zeros(len(state.values)))
        after, length, longest = _search(state, system, move, 1.0, chosen.longest_step)
        if after is None:
            status = "stalled"
            break
        state = after
        history.append(Step(0.0, state.violation, longest, length))
        if progress is not None:
            progress(len(history) - 1, history[-1])
    if state.violation <= chosen.tolerance:
        status = "converged"
    return _finished(problem, state, status, history, chosen, throw)


def _finished(
    problem: Problem,
    state: _State,
    status: str,
    history: list[Step],
    options: SolveOptions,
    throw: bool,
) -> Solution:
    solution = Solution(state.x, status, tuple(history))
    if throw and not solution.converged:
        raise OptimizeError(
            _words(problem, state, status, len(history), options), solution=solution
        )
    return solution


def _search(
    state: _State, system: StepSystem, move: Floats, penalty: float, longest: float
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
    limit = state.merit(penalty) * (1 + _ROUNDING)

    def at(step: Floats) -> _State:
        full = np.zeros(len(state.x))
        full[problem.free] = problem.scale[problem.free] * step
        return _State(problem, state.x + full)

    for halving in range(_HALVINGS):
        after = at(length * move)
        if after.merit(penalty) <= limit:
            return after, length, length * greatest
        if halving == 0 and len(after.values):
            bend = after.values - (1 - length) * state.values
            mended, _ = system.step(np.zeros(len(move)), bend, np.zeros(len(bend)))
            after = at(length * move + mended)
            if after.merit(penalty) <= limit:
                return after, length, length * greatest
        length /= 2
    return None, 0.0, 0.0


def _words(problem: Problem, state: _State, status: str, steps: int, options: SolveOptions) -> str:
    missed = [missed_words(term, state.x, options.tolerance) for term in problem.terms if term.hard]
    found = "; ".join(words for words in missed if words)
    return (
        f"optimisation {status} after {steps} steps{': ' if found else ''}{found}\n"
        "hard terms may contradict each other: free some vertices, or make one of them soft"
    )


def missed_words(term: Term, x: Floats, limit: float) -> str:
    """By how much a hard term is missed and at which elements; empty when it is met."""
    values = np.abs(term.residual(x))
    if values.max(initial=0.0) <= limit:
        return ""
    elements = getattr(term, "elements", None)
    order = np.argsort(-values, kind="stable")[: 4 * _NAMED]
    ids = order if elements is None else elements[order]
    worst = list(dict.fromkeys(ids.tolist()))[:_NAMED]
    return (
        f"{term.name} stays at {values.max():.2g} (limit {limit:g}), worst at "
        f"{getattr(term, 'of', 'row')} {', '.join(map(str, worst))}"
    )


_NAMED = 5
"""How many of the worst elements a message names."""

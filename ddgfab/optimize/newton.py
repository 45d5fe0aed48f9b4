"""Newton's method with the curvature of the equations, from soft to stiff: for coupled goals.

Minimise F(x) = sum of weight * |residual|^2 / 2 over soft terms under c(x) = 0 of hard terms. Where
soft and hard terms pull strongly against each other the multipliers are large, and Gauss-Newton
steps (`ddgfab.optimize.gauss_newton`), which know nothing of the curvature of the equations, run to
and fro. Here each stage minimises the augmented Lagrangian F + <force, c> + |c|^2 / 2 eps by Newton
steps with that curvature; eps falls from stage to stage, so that the unknowns find their way while
the equations are still soft. The last stages correct the multipliers, and a projection onto the
equations (least movement) ends in rounding.

Source: Bertsekas, Constrained Optimization and Lagrange Multiplier Methods, 1982, ch. 2; inertia
correction: Nocedal, Wright 2006, sec. 19.3.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_array, csc_array, csr_array, diags_array, eye_array, vstack
from scipy.sparse.linalg import splu

from ddgfab.errors import OptimizeError
from ddgfab.mesh import Floats
from ddgfab.optimize.gauss_newton import Progress, Solution, Step
from ddgfab.optimize.problem import Problem, Term
from ddgfab.optimize.terms.base import LocalTerm
from ddgfab.optimize.torsion_terms import Power

_DIFFERENCE = 1e-4
"""Step of the differences of gradients, in parts of `Problem.scale`; its square is the error."""

_SHIFT = 1e-9
"""Least damping: keeps unknowns that nothing pulls where they are."""

_FIRST_DAMPING, _LEAST_DAMPING = 1e-2, 1e-4
"""Damping tried first where the function is not convex on the equations; less counts as none."""

_RAISE, _EASE = 20.0, 4.0
"""Factors by which damping is raised when a step fails, and eased after one that succeeds."""

_MOST_DAMPING = 1e8
"""Damping at which steps are too short to go on."""

_REFINEMENTS = 2
"""Corrections of the solution of a system that was factored without pivoting."""

_SUFFICIENT = 1e-4
"""Armijo's constant; customary (Nocedal, Wright 2006, sec. 3.1)."""


@dataclass(frozen=True)
class NewtonOptions:
    """How the method runs; every field may be left as it is."""

    compliance: tuple[float, ...] = (1.0, 0.1, 1e-2, 1e-3, 1e-4)
    """eps of the stages."""
    corrections: int = 6
    """Further stages at the last eps, each with corrected multipliers, until `near` is reached."""
    near: float = 1e-5
    """Residual of hard terms below which the projection takes over."""
    steps: int = 25
    """Newton steps in a stage."""
    decrease: float = 1e-3
    """A stage ends when a step lowers its function by less than this part."""
    longest_step: float = 0.3
    """No unknown moves by more than this (in parts of `Problem.scale`) in a step."""
    projections: int = 20
    """Steps of the projection onto the equations."""
    tolerance: float = 1e-12
    """Greatest residual of a hard term that counts as met."""


def curvature(term: Term, x: Floats, force: Floats, scale: Floats) -> csr_array:
    """(n, n) second derivative of sum force_k r_k of a term, by central differences of gradients.

    Terms that are not local count as linear. Exact to about 1e-8 of its size, which only bends
    the steps of the method, never its result.
    """
    size = len(x)
    if not isinstance(term, LocalTerm) or not len(term.index):
        return csr_array((size, size))
    rows, k = term.index.shape
    local, step = x[term.index], _DIFFERENCE * scale[term.index]
    second = np.empty((rows, k, k))
    for j in range(k):
        move = np.zeros_like(local)
        move[:, j] = step[:, j]
        second[:, j] = (term.gradients(local + move) - term.gradients(local - move)) / (
            2 * step[:, j, None]
        )
    second *= (force * term.factor)[:, None, None]
    second = 0.5 * (second + second.transpose(0, 2, 1))
    r, c = np.broadcast_arrays(term.index[:, :, None], term.index[:, None, :])
    return csr_array((second.ravel(), (r.ravel(), c.ravel())), shape=(size, size))


class _Point:
    """Values of all terms at a point; derivatives on demand, in scaled free unknowns."""

    def __init__(self, problem: Problem, x: Floats) -> None:
        self.problem, self.x = problem, x
        self.soft = [t for t in problem.terms if not t.hard]
        self.hard = [t for t in problem.terms if t.hard]
        self.residuals = [t.residual(x) for t in self.soft]
        values = [t.residual(x) for t in self.hard]
        self.values = np.concatenate(values) if values else np.zeros(0)
        self.objective = 0.5 * float(
            sum(t.weight * (r @ r) for t, r in zip(self.soft, self.residuals, strict=True))
        )
        self.violation = float(np.abs(self.values).max(initial=0.0))

    def _free(self, matrix: csr_array) -> csr_array:
        free = np.flatnonzero(self.problem.free)
        return csr_array(matrix[:, free] @ diags_array(self.problem.scale[free]))

    def lines(self) -> csr_array:
        """Jacobian of the hard terms."""
        return csr_array(vstack([self._free(t.jacobian(self.x)) for t in self.hard], format="csr"))

    def model(self, force: Floats) -> tuple[csr_array, Floats]:
        """Hessian of the Lagrangian (Gauss-Newton in the soft terms) and gradient of F."""
        size = len(self.x)
        hessian, gradient = csr_array((size, size)), np.zeros(size)
        for term, residual in zip(self.soft, self.residuals, strict=True):
            slope = term.jacobian(self.x)
            gradient += term.weight * (slope.T @ residual)
            square = term.hessian(self.x) if isinstance(term, Power) else slope.T @ slope
            hessian = hessian + term.weight * square
        at = 0
        for term in self.hard:
            count = len(term.residual(self.x))
            pull = force[at : at + count]
            hessian = hessian + curvature(term, self.x, pull, self.problem.scale)
            at += count
        free = self.problem.free
        kept = self._free(csr_array(hessian))[np.flatnonzero(free)]
        scale = self.problem.scale[free]
        return csr_array(diags_array(scale) @ kept), scale * gradient[free]

    def moved(self, step: Floats) -> _Point:
        """The point after a step in scaled free unknowns."""
        full = self.x.copy()
        full[self.problem.free] += self.problem.scale[self.problem.free] * step
        return _Point(self.problem, full)


def _factored(matrix: csc_array) -> tuple[Callable[[Floats], Floats], int]:
    """Solver of a symmetric system without pivoting, and its number of negative pivots.

    Raises
    ------
    RuntimeError
        A pivot is zero.
    """
    lu = splu(
        matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
    )

    def solve(right: Floats) -> Floats:
        found = lu.solve(right)
        for _ in range(_REFINEMENTS):
            found = found + lu.solve(right - matrix @ found)
        return np.asarray(found)

    return solve, int((lu.U.diagonal() < 0).sum())


def _downhill(system: csc_array, right: Floats, rows: int) -> Floats | None:
    """Solution of a step's system, None unless the function is convex on the equations."""
    try:
        solve, negative = _factored(system)
    except RuntimeError:
        return None
    return solve(right) if negative == rows else None


def _stage(
    point: _Point,
    force: Floats,
    eps: float,
    options: NewtonOptions,
    report: Callable[[Step], None],
) -> _Point:
    """Minimise F + <force, c> + |c|^2 / 2 eps."""

    def merit(at: _Point) -> float:
        return at.objective + float(force @ at.values + at.values @ at.values / (2 * eps))

    damping, value = 0.0, merit(point)
    for _ in range(options.steps):
        lines, pull = point.lines(), force + point.values / eps
        hessian, gradient = point.model(pull)
        slope_of_merit = gradient + lines.T @ pull
        rows, size = lines.shape
        after, length, move = None, 0.0, np.zeros(size)
        damping = damping / _EASE if damping > _LEAST_DAMPING else 0.0
        while after is None and damping < _MOST_DAMPING:
            damped = hessian + (damping + _SHIFT) * eye_array(size)
            system = block_array([[damped, lines.T], [lines, -eps * eye_array(rows)]], format="csc")
            right = np.concatenate([-gradient, -point.values - eps * force])
            both = _downhill(csc_array(system), right, rows)
            if both is not None:
                move = both[:size]
                start = value, float(slope_of_merit @ move)
                after, length = _shortened(point, move, start, merit, options.longest_step)
            if after is None:
                damping = max(_RAISE * damping, _FIRST_DAMPING)
        if after is None:
            break
        longest = length * float(np.abs(move).max())
        report(Step(after.objective, after.violation, longest, length))
        before, value, point = value, merit(after), after
        if before - value <= options.decrease * max(abs(before), np.finfo(float).tiny):
            break
    return point


def _shortened(
    point: _Point,
    move: Floats,
    start: tuple[float, float],
    merit: Callable[[_Point], float],
    longest: float,
) -> tuple[_Point | None, float]:
    """The first of a few shorter and shorter steps that lowers the merit as its slope promises."""
    value, slope = start
    greatest = float(np.abs(move).max(initial=0.0))
    if not np.isfinite(greatest) or slope >= 0:
        return None, 0.0
    length = min(1.0, longest / greatest) if greatest > 0 else 1.0
    for _ in range(4):
        after = point.moved(length * move)
        if merit(after) <= value + _SUFFICIENT * length * slope:
            return after, length
        length /= 2
    return None, 0.0


def project(point: _Point, options: NewtonOptions, report: Callable[[Step], None]) -> _Point:
    """Onto the equations by least movement: x - C'(C C' + shift)^-1 c, while it gets nearer."""
    for _ in range(options.projections):
        if point.violation <= options.tolerance:
            break
        lines = point.lines()
        square = csc_array(lines @ lines.T + _SHIFT * eye_array(lines.shape[0]))
        move = -(lines.T @ _factored(square)[0](point.values))
        total = float(point.values @ point.values)
        after, length = _shortened(
            point, move, (total, -2 * total), lambda at: float(at.values @ at.values), np.inf
        )
        if after is None:
            break
        report(Step(after.objective, after.violation, length * float(np.abs(move).max()), length))
        point = after
    return point


def newton(
    problem: Problem,
    options: NewtonOptions | None = None,
    *,
    throw: bool = True,
    progress: Progress | None = None,
) -> Solution:
    """Solve a problem whose soft and hard terms pull strongly against each other.

    Parameters
    ----------
    problem : with at least one hard term
    throw : raise when hard terms are not met; otherwise the last point comes back
    progress : called with the number of each step and what it did

    Returns
    -------
    Solution with status "converged" (hard terms are met to `NewtonOptions.tolerance`) or "stopped"

    Raises
    ------
    OptimizeError
        Hard terms are not met; carries the solution.
    """
    chosen = options or NewtonOptions()
    point = _Point(problem, problem.start.copy())
    force = np.zeros(len(point.values))
    history: list[Step] = []

    def report(step: Step) -> None:
        history.append(step)
        if progress is not None:
            progress(len(history) - 1, step)

    for eps in chosen.compliance:
        point = _stage(point, force, eps, chosen, report)
    for _ in range(chosen.corrections):
        if point.violation <= chosen.near:
            break
        force = force + point.values / eps
        point = _stage(point, force, eps, chosen, report)
    point = project(point, chosen, report)
    met = point.violation <= chosen.tolerance
    solution = Solution(point.x, "converged" if met else "stopped", tuple(history))
    if throw and not met:
        worst = ", ".join(
            f"{t.name} {np.abs(r).max():.2g} (row {int(np.abs(r).argmax())})"
            for t, r in ((t, t.residual(point.x)) for t in point.hard)
            if len(r) and np.abs(r).max() > chosen.tolerance
        )
        raise OptimizeError(
            f"equations are not met after {len(history)} steps: {worst} (limit "
            f"{chosen.tolerance:g})\nthe goals contradict each other: allow more movement or lean",
            solution=solution,
        )
    return solution

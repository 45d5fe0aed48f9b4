"""The path to a goal: damped Gauss-Newton steps under a penalty that rises from soft to hard.

From the input on, rho |c|^2 / 2 pulls at the equations c = 0 of the goal with more and more weight,
while the energy keeps the design and barriers keep faces unfolded. So the mesh takes the cheapest
way; what it costs on the way is a price list. Last digits come from `polish`: the shortest
correction in the metric of the energy.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError
from ddgfab.mesh import Floats
from ddgfab.optimize.linear import SymmetricSolver
from ddgfab.optimize.merit import Merit, Model, damped
from ddgfab.optimize.problem import Problem
from ddgfab.optimize.result import Progress, Step


@dataclass(frozen=True)
class PathOptions:
    """How a path runs; every field may be left as it is. Lengths in mean edges."""

    tolerance: float = 2e-3
    """Violation (for planarity: distance of the diagonals over their mean) that counts as met."""
    first_penalty: float = 1.0
    """Penalty of the first stage."""
    growth: float = 4.0
    """Factor from a stage to the next; twice as much where two steps were enough."""
    steps_per_stage: int = 6
    """Steps under one penalty."""
    longest_step: float = 0.5
    """No vertex moves further in a step."""
    on_the_way: bool = False
    """The start comes from elsewhere: it is walked from even where it meets the goal already, and
    stages end when the merit falls little."""
    finish: float = 1e-3
    """Violation from which on the rest is left to the polish. A greater one saves stages, and costs
    a little distance."""
    even_if_met: bool = False
    """Soft terms ask for more than the start has, so the path is walked even where the start meets
    the goal already."""
    max_steps: int = 120
    """Steps before giving up."""
    max_penalty: float = 1e13
    """Penalty before giving up."""


@dataclass(frozen=True, eq=False)
class Waypoint:
    """Where a stage ended: penalty, violation, unknowns."""

    penalty: float
    violation: float
    x: Floats


@dataclass(frozen=True, eq=False)
class Path:
    """What a path reached: unknowns, "converged" or "missed", steps, the ends of its stages."""

    value: Floats
    status: str
    history: tuple[Step, ...]
    waypoints: tuple[Waypoint, ...]


_DAMPING: float = 1e-8
_HEAVIER, _HEAVY, _HEAVIEST = 30.0, 1e-3, 6
"""After a step that failed: damping times this, at least this, this often."""
_SHORTER, _SHORTENINGS, _ARMIJO = 0.4, 7, 1e-4
"""Line search: factor of the length, how often, part of the promised decrease that is enough."""
_FALL, _LONG, _SHORT = 0.05, 0.05, 1e-3
"""A stage ends when the merit falls by a smaller part in a step that is not long, or a step is very
short. Long steps that hardly pay are the way round a bend of the equations, a heavier penalty would
end there; a start on the way has the bend behind it."""
_COARSE = 1e-3
"""Tolerances from this on are not undercut: the path goes back to where they are met."""
_STIFF, _STIFFER, _STIFFEST = 1e9, 30.0, 1e13
"""Penalty of the polish; after a step that left much, times this, up to this. Where equations
depend on each other, as those of closed meshes do, the first one leaves half of the violation."""
_POLISH, _MUCH, _HALVINGS = 12, 0.1, 12
"""Steps of the polish, the part of the violation that is much, and how often one is halved."""
_ROOT_STEPS, _ROOT_WIDTH = 40, 1e-13
"""Steps and accuracy of the search for where the tolerance is met."""


class _Walker:
    """State of a path: unknowns, damping, history."""

    def __init__(
        self,
        problem: Problem,
        violation: Callable[[Floats], float],
        options: PathOptions,
        progress: Progress | None,
    ) -> None:
        self.merit, self.violation, self.options = Merit(problem), violation, options
        self.x = problem.start.copy()
        self.damping = _DAMPING
        self.solver = SymmetricSolver(self.merit.nodes)
        self.history: list[Step] = []
        self._progress = progress

    def step(self, rho: float) -> tuple[float, float]:
        """One step: part by which the merit fell, length; (0, 0) where none was found."""
        merit = self.merit
        merit.freeze(self.x)
        model = merit.model(self.x)
        before = merit.value(self.x, rho)
        gradient = model.gradient + rho * (model.lines.T @ model.values)
        stiff = model.hessian + rho * (model.lines.T @ model.lines)
        for _ in range(_HEAVIEST):
            move = self._solved(stiff, -gradient)
            if move is not None:
                found = self._search(move, gradient, before, rho)
                if found is not None:
                    x, after, length, longest = found
                    self.damping = self.damping / 10 if length > 0.5 else 3 * self.damping
                    self.x = x
                    self._record(model, rho, after, length, longest)
                    return (before - after) / max(before, np.finfo(float).tiny), longest
            self.damping = max(_HEAVIER * self.damping, _HEAVY)
        return 0.0, 0.0

    def _solved(self, matrix: csr_array, right: Floats) -> Floats | None:
        try:
            move = self.solver.factor(damped(matrix, max(self.damping, _DAMPING)))(right)
        except DegenerateError:
            return None
        return move if np.isfinite(move).all() else None

    def _search(
        self, move: Floats, gradient: Floats, before: float, rho: float
    ) -> tuple[Floats, float, float, float] | None:
        slope = float(gradient @ move)
        if not slope < 0:
            return None
        longest = self.merit.longest(move)
        length = min(1.0, self.options.longest_step / max(longest, np.finfo(float).tiny))
        for _ in range(_SHORTENINGS):
            x = self.merit.moved(self.x, length * move)
            after = self.merit.value(x, rho)
            if after <= before + _ARMIJO * length * slope:
                return x, after, length, length * longest
            length *= _SHORTER
        return None

    def _record(
        self, model: Model, rho: float, value: float, length: float, longest: float
    ) -> None:
        equations = self.merit.equations(self.x)
        energy = value - 0.5 * rho * float(equations @ equations)
        step = Step(energy, float(np.abs(equations).max(initial=0.0)), longest, length)
        self.history.append(step)
        if self._progress is not None:
            self._progress(len(self.history) - 1, step)

    def stage(self, rho: float) -> int:
        """Steps at one penalty; their number."""
        taken = 0
        while taken < self.options.steps_per_stage and len(self.history) < self.options.max_steps:
            fall, longest = self.step(rho)
            if longest == 0.0:
                break
            taken += 1
            slow = fall < _FALL and (longest < _LONG or self.options.on_the_way)
            if longest < _SHORT or slow:
                break
        return taken

    def polish(self) -> bool:
        """Meet the equations to the tolerance by shortest steps; undone where it fails."""
        start, count = self.x, len(self.history)
        left, stiffness = self.violation(start), _STIFF
        for _ in range(_POLISH):
            before = left
            if left <= self.options.tolerance or not self._polish_step(stiffness):
                break
            left = self.violation(self.x)
            if left > _MUCH * before:
                stiffness = min(_STIFFER * stiffness, _STIFFEST)
        if left <= self.options.tolerance:
            return True
        self.x = start
        del self.history[count:]
        return False

    def _polish_step(self, stiffness: float) -> bool:
        merit = self.merit
        merit.freeze(self.x)
        model = merit.model(self.x)
        stiff = model.hessian + stiffness * (model.lines.T @ model.lines)
        move = self._solved(stiff, -stiffness * (model.lines.T @ model.values))
        if move is None:
            return False
        longest = merit.longest(move)
        length = min(1.0, self.options.longest_step / max(longest, np.finfo(float).tiny))
        before = float(np.linalg.norm(model.values))
        for _ in range(_HALVINGS):
            x = merit.moved(self.x, length * move)
            if merit.possible(x) and float(np.linalg.norm(merit.equations(x))) < before:
                self.x = x
                self._record(model, 0.0, merit.value(x, 0.0), length, length * longest)
                return True
            length /= 2
        return False


@checked
def follow(
    problem: Problem,
    violation: Callable[[Floats], float],
    options: PathOptions | None = None,
    progress: Progress | None = None,
) -> Path:
    """Follow the path from the start of a problem to where its hard terms are met.

    Parameters
    ----------
    problem : energy as soft terms, the goal as hard ones, with barriers; mean edge one
    violation : (n,) unknowns -> how far from the goal; met at `PathOptions.tolerance`
    progress : called with the number of each step and what it did

    Returns
    -------
    Path; with status "missed" the value is the one of least violation

    Source: penalty path: Nocedal, Wright 2006, sec. 17.1; Gauss-Newton: 10.3.
    """
    chosen = options or PathOptions()
    walker = _Walker(problem, violation, chosen, progress)
    ends = [Waypoint(0.0, violation(walker.x), walker.x)]
    rho, status = chosen.first_penalty, "missed"
    walks = chosen.on_the_way or chosen.even_if_met
    if ends[0].violation <= chosen.tolerance and not walks:
        return Path(walker.x, "converged", (), tuple(ends))
    walker.x = _nudged(walker.merit)
    near = max(chosen.tolerance, chosen.finish)
    while rho <= chosen.max_penalty and len(walker.history) < chosen.max_steps:
        taken = walker.stage(rho)
        ends.append(Waypoint(rho, violation(walker.x), walker.x))
        polished = ends[-1].violation <= near and walker.polish()
        if polished and walker.x is not ends[-1].x:
            ends.append(Waypoint(np.inf, violation(walker.x), walker.x))
        if polished:
            if chosen.tolerance >= _COARSE:
                walker.x = _back_off(walker.merit, violation, chosen.tolerance, ends)
            status = "converged"
            break
        if taken == 0 and walker.damping > _GIVE_UP:
            break
        rho *= chosen.growth if taken > 2 else 2 * chosen.growth
    if status == "missed":
        walker.x = min(ends, key=lambda e: e.violation).x
        if walker.polish():  # seldom from so far away
            ends.append(Waypoint(np.inf, violation(walker.x), walker.x))
            status = "converged"
    return Path(walker.x, status, tuple(walker.history), tuple(ends))


@checked
def settle(
    problem: Problem,
    penalty: float,
    options: PathOptions | None = None,
    progress: Progress | None = None,
) -> Path:
    """Come to rest at one penalty, and meet the equations from there by shortest steps.

    For soft terms that matter more than the way: `follow` stops where its equations are met.

    Parameters
    ----------
    penalty : weight of half the squared equations
    options : at most `steps_per_stage` steps; equations are met within `tolerance`
    progress : called with the number of each step and what it did

    Returns
    -------
    Path; with status "missed" the value is where it came to rest
    """

    def violation(x: Floats) -> float:
        return float(np.abs(walker.merit.equations(x)).max(initial=0.0))

    walker = _Walker(problem, violation, options or PathOptions(), progress)
    while len(walker.history) < walker.options.steps_per_stage:
        fall, longest = walker.step(penalty)
        if fall < _REST or longest == 0.0:
            break
    end = Waypoint(penalty, violation(walker.x), walker.x)
    status = "converged" if walker.polish() else "missed"
    return Path(walker.x, status, tuple(walker.history), (end,))


def _nudged(merit: Merit) -> Floats:
    """The start, with vertices a little off along their normals, by their numbers.

    On a symmetric mesh bends may form on either side, and rounding would choose: another result for
    every rotation and every machine. So the numbers of the vertices choose.
    """
    mesh = merit.problem.mesh
    parts = 2 * (_GOLDEN * np.arange(mesh.n_vertices) % 1.0) - 1
    full = np.zeros(len(merit.problem.start))
    full[: 3 * mesh.n_vertices] = (_NUDGE * parts[:, None] * mesh.vertex_normals).ravel()
    x = merit.problem.start + np.where(merit.problem.free, full, 0.0)
    return x if merit.possible(x) else merit.problem.start.copy()


_NUDGE, _GOLDEN = 1e-10, 0.6180339887498949
"""In mean edges: a thousand times what coordinates are rounded by, and far below what is made.
Multiples of the golden ratio spread evenly and follow no symmetry."""
_REST = 1e-6
"""Part of the merit; steps that lower it by less are at rest."""
_GIVE_UP = 1e6
"""Steps under a heavier damping are too short to be of use."""


def _back_off(
    merit: Merit, violation: Callable[[Floats], float], tolerance: float, ends: list[Waypoint]
) -> Floats:
    """Between the ends of the last two stages, where the tolerance is met, to rounding.

    By false position (Illinois); so the result does not depend on which side rounding falls.
    """
    first, last = ends[-2], ends[-1]
    low, high = 0.0, 1.0
    above, below = first.violation - tolerance, last.violation - tolerance
    best = last.x
    side = 0
    for _ in range(_ROOT_STEPS):
        if high - low < _ROOT_WIDTH or not below < 0 < above:
            break
        middle = (low * below - high * above) / (below - above)
        x = first.x + middle * (last.x - first.x)
        value = violation(x) - tolerance
        if value <= 0:
            high, below, best = middle, value, x
            above /= 2 if side < 0 else 1
            side = -1
        else:
            low, above = middle, value
            below /= 2 if side > 0 else 1
            side = 1
    return best if merit.possible(best) else last.x

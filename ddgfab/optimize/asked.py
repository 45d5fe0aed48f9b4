"""What is asked of a mesh: goals in turn, limits, panes, wishes and what they cost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from ddgfab.errors import OptimizeError
from ddgfab.measures import dihedral_angles
from ddgfab.mesh import Ints, Mesh
from ddgfab.optimize.advice import SOFTER
from ddgfab.optimize.energy import Keep
from ddgfab.optimize.goal import NetGoal
from ddgfab.optimize.limits import Limits
from ddgfab.optimize.nets import Outcome, StageProgress, reach
from ddgfab.optimize.panes import with_panes
from ddgfab.optimize.result import OptimizeResult, Trial
from ddgfab.optimize.rim import Boundary
from ddgfab.optimize.wishes import Wishes

_SOFTER: Final = 3.0
"""Wishes that cost too much are tried with their weight divided by this next."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Asked:
    """What is asked of a mesh, whatever the goal; see `ddgfab.optimize.optimize`.

    Attributes
    ----------
    goals : tried in turn until one is met within the limits
    feature_angle : edges whose faces meet at a larger angle [rad] are features
    softer : weight of the wishes to try next where the goal is met without them; None: it is not
    """

    goals: Sequence[NetGoal]
    flat: float | None
    keep: Keep | float
    fixed: Sequence[int] | Ints
    boundary: Boundary
    surface: Mesh | None
    rim: Mesh | None
    feature_angle: float | None
    limits: Limits
    wishes: Wishes
    progress: StageProgress | None
    softer: float | None = None

    def result(self, mesh: Mesh) -> OptimizeResult:
        """The mesh made what is asked for, divided for panes before, with the price of wishes.

        Raises
        ------
        OptimizeError
            The goal is missed, or a limit exceeded; carries the best mesh as `result`.
        """
        if not self.wishes:
            return self._with_panes(mesh)
        self.wishes.refuse(mesh)
        plain = self._best(mesh)
        met = plain is not None and plain.status == "converged"
        softer = float(f"{self.wishes.weight / _SOFTER:.2g}") if met else None
        try:
            result = replace(self, softer=softer)._with_panes(mesh)
        except OptimizeError as error:
            if plain is not None and isinstance(error.result, OptimizeResult):
                error.result = self._priced(plain, error.result)
            raise
        return result if plain is None else self._priced(plain, result)

    def _priced(self, plain: OptimizeResult, wished: OptimizeResult) -> OptimizeResult:
        return wished.revised(wishes=self.wishes.price(plain, wished))

    def _best(self, mesh: Mesh) -> OptimizeResult | None:
        """The result without wishes, met or not; None where no mesh was found."""
        try:
            return replace(self, wishes=Wishes())._with_panes(mesh)
        except OptimizeError as error:
            return error.result if isinstance(error.result, OptimizeResult) else None

    def _with_panes(self, mesh: Mesh) -> OptimizeResult:
        if self.limits.pane is None:
            return self._reached(mesh)
        return with_panes(mesh, self.limits.pane, self._reached)

    def _reached(self, mesh: Mesh) -> OptimizeResult:
        found: list[tuple[NetGoal, Outcome]] = []
        for goal in self.goals:
            outcome = reach(
                mesh,
                goal,
                flat_percent=self.flat,
                keep=self.keep,
                fixed=self.fixed,
                boundary=self.boundary,
                features=features(mesh, self.feature_angle),
                surface=self.surface,
                rim=self.rim,
                limits=self.limits,
                wishes=self.wishes,
                progress=self.progress,
            )
            found.append((goal, outcome))
            if not outcome.missed:
                break
        outcome = _taken(found)
        if outcome.missed and self.softer is not None:
            advice = ((SOFTER, self.softer),)
            outcome = replace(outcome, result=outcome.result.revised(advice=advice))
        return outcome.taken(throw=True)


def features(mesh: Mesh, angle: float | None) -> Ints | None:
    """Edges whose faces meet at a larger angle [rad]."""
    if angle is None:
        return None
    sharp = np.abs(dihedral_angles(mesh)) > angle
    return np.flatnonzero(sharp & ~mesh.boundary_edge)


def _taken(found: Sequence[tuple[NetGoal, Outcome]]) -> Outcome:
    """The outcome of a goal tried with several limits: the last where it is met, else the best."""
    goal, best = found[-1]
    if best.missed:  # nothing was met: what misses least, the latest of equals
        goal, best = min(reversed(found), key=lambda one: len(one[1].missed))
    if len(found) == 1:
        return best
    trials = tuple(
        Trial(
            one.label or one.name,
            not outcome.missed,
            outcome.result.change.distance_mean,
            outcome.result.change.distance_max,
            outcome.result.own(),
        )
        for one, outcome in found
    )
    history = tuple(step for _, outcome in found for step in outcome.result.history)
    remarks = best.result.remarks
    if not best.missed:
        passed = ", ".join(one.label for one, outcome in found if outcome.missed)
        remarks = (f"{passed}: not within the limits; {goal.label} is", *remarks)
    result = best.result.revised(history=history, tried=trials, remarks=remarks)
    return Outcome(result, best.missed)

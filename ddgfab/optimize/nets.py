"""Reach a goal: the mesh in its frame, the path to the equations, what it cost, what is missed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Final, TypeAlias

import numpy as np

from ddgfab.errors import DegenerateError, InputError, OptimizeError
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.advice import advice_of, complaint, missed_text, remarks_of
from ddgfab.optimize.energy import Keep
from ddgfab.optimize.forecast import forecast_of
from ddgfab.optimize.frame import Frame, element_ids
from ddgfab.optimize.goal import (
    EXACT,
    NetGoal,
    net_problem,
    planarity_of,
    violation,
    weights_of,
)
from ddgfab.optimize.limits import Limits, ids
from ddgfab.optimize.nested import LEAST_FACES, begun, nested_start, onward
from ddgfab.optimize.panes import pane_lengths
from ddgfab.optimize.path import Path, PathOptions, Waypoint, follow
from ddgfab.optimize.problem import VERTICES, Problem, Term, mean_edge
from ddgfab.optimize.result import Forecast, OptimizeResult, Price, Progress, Step
from ddgfab.optimize.rim import Boundary, Constraints, impossible_faces
from ddgfab.optimize.surface import SmoothSurface
from ddgfab.optimize.terms.nearness import NearSurface
from ddgfab.optimize.wishes import Wishes

StageProgress: TypeAlias = Callable[[str, int, Step], None]
"""Called with the name of the stage, the number of the step and the step."""

_AIM: Final = 0.995
"""Part of a tolerance that is aimed at, so that rounding of files does not exceed it."""

_COARSEST: Final = 0.1
"""Price lists begin at this violation."""

_ELSEWHERE: Final = 5.0
"""Meshes further from their surface [mean edges] have another unit, or are of another place."""

_FORECAST_FACES: Final = 20_000
"""Up to this number of faces the forecast is made before solving; beyond it costs as much as a
step."""


@dataclass(frozen=True, eq=False)
class Outcome:
    """A result, and what it misses, in sentences; none: the goal is met within the limits."""

    result: OptimizeResult
    missed: tuple[str, ...] = ()

    def taken(self, throw: bool) -> OptimizeResult:
        """The result.

        Raises
        ------
        OptimizeError
            Something is missed; carries the result.
        """
        if self.missed and throw:
            raise OptimizeError(complaint(self.result, self.missed), result=self.result)
        return self.result


def reach(
    mesh: Mesh,
    goal: NetGoal,
    *,
    flat_percent: float | None = None,
    keep: Keep | float = "balanced",
    fixed: Sequence[int] | Ints = (),
    boundary: Boundary = "free",
    features: Sequence[int] | Ints | None = None,
    surface: Mesh | None = None,
    rim: Mesh | None = None,
    limits: Limits | None = None,
    wishes: Wishes | None = None,
    options: PathOptions | None = None,
    progress: StageProgress | None = None,
) -> Outcome:
    """A mesh that meets a goal, as near to its surface as possible, without folds.

    Parameters
    ----------
    flat_percent : violation that counts as met [%]; 0: to rounding; by default the goal's own
    keep : "close" to the surface, "balanced" or "fair" (smooth faces), or a number (`energy.KEEP`)
    fixed : ids of vertices that stay
    boundary : what the boundary may do
    features : ids of edges across which the movement need not be smooth
    surface : to stay near to; the mesh itself by default
    rim : whose boundary that of the mesh stays near to, as the rim of a surface that was traced;
        the mesh itself by default
    limits : what the result may cost; no vertex moves further than its limit of movement
    wishes : repetition that is wished for besides; a mesh that meets the goal is moved for it

    Raises
    ------
    OptimizeError
        Faces whose fixed corners are not coplanar.
    InputError
        An id out of range, an unknown option, a surface that is elsewhere.
    """
    goal.check(mesh)
    if surface is not None:
        _refuse_far(mesh, surface)
    frame = Frame.of(mesh)
    small = frame.inside(mesh)
    task = _Task(
        goal,
        frame,
        small,
        keep,
        Constraints.of(small, fixed, boundary),
        None if features is None else element_ids(features, mesh.n_edges, "feature edge"),
        None if surface is None else frame.inside(surface),
        None if rim is None else frame.inside(rim),
        limits or Limits(),
        wishes or Wishes(),
        _tolerance(goal, flat_percent),
    )
    problem = task.problem()
    met = violation(problem, problem.start) <= task.tolerance and not _crooked(goal, small)
    if met and not task.wishes:
        return Outcome(task.result(problem, problem.start, mesh, surface))
    _refuse_impossible(goal.name, problem, task.constraints, boundary, 100 * task.tolerance)
    expected = _expected(problem, frame)
    history: list[tuple[str, Step]] = []
    stage = goal.label or goal.name

    def record(number: int, step: Step) -> None:
        history.append((stage, step))
        if progress is not None:
            progress(stage, number, step)

    path = task.path(problem, options, record)
    found = frame.outside(small.vertices, problem.vertices(path.value))
    result = replace(
        task.result(problem, path.value, found, surface),
        history=tuple(history),
        prices=_prices(problem, frame, path.waypoints),
        forecast=expected,
    )
    return task.judged(problem, path, result, boundary)


@dataclass(frozen=True, eq=False)
class _Task:
    """What to do on a mesh whose mean edge is one, `mesh`; other meshes are in its frame."""

    goal: NetGoal
    frame: Frame
    mesh: Mesh
    keep: Keep | float
    constraints: Constraints
    features: Ints | None
    surface: Mesh | None
    rim: Mesh | None
    limits: Limits
    wishes: Wishes
    tolerance: float

    def problem(self) -> Problem:
        """The problem on the mesh itself."""
        limit = self.limits.movement
        return net_problem(
            self.mesh,
            self.goal,
            keep=self.keep,
            constraints=self.constraints,
            surface=self.surface,
            features=self.features,
            rim=self.rim,
            extra=_soft_limits(self.mesh, self.frame, self.limits),
            wishes=self.wishes.terms(self.mesh),
            movement=None if limit is None else limit / self.frame.unit,
        )

    def nests(self, problem: Problem) -> bool:
        """Whether the path may begin on a coarser mesh."""
        alone = self.goal.crooked is None and not self.goal.still
        alone &= problem.layout.names == (VERTICES,) and self.features is None
        return alone and self.mesh.n_faces >= LEAST_FACES

    def coarse_problem(self, one: Mesh, inner: Frame, numbers: Ints) -> Problem:
        """The problem on a coarser mesh, for `nested_start`."""
        held = np.flatnonzero(np.isin(numbers, self.constraints.fixed))
        limit = self.limits.movement
        return net_problem(
            one,
            self.goal,
            keep=self.keep,
            constraints=Constraints(held, self.constraints.glide),
            surface=inner.inside(self.mesh if self.surface is None else self.surface),
            rim=inner.inside(self.mesh if self.rim is None else self.rim),
            movement=None if limit is None else limit / (self.frame.unit * inner.unit),
            wishes=self.wishes.terms(one),
            weights=weights_of(self.mesh, self.goal, self.keep, self.constraints).coarser(
                max(1.0, inner.unit)
            ),
        )

    def path(self, problem: Problem, options: PathOptions | None, progress: Progress) -> Path:
        """The path to the goal; that of a large mesh begins on coarser ones, but with options."""
        way = options or PathOptions(even_if_met=bool(self.wishes))
        if options is None and self.nests(problem):
            move = nested_start(self.mesh, self.coarse_problem, self.tolerance, progress)
            begins = None if move is None else begun(problem, move)
            if begins is not None:
                problem, way = begins, onward(self.mesh)
        chosen = replace(way, tolerance=max(_AIM * self.tolerance, EXACT))
        return follow(problem, partial(violation, problem), chosen, progress)

    def judged(
        self, problem: Problem, path: Path, result: OptimizeResult, boundary: Boundary
    ) -> Outcome:
        """What a result misses, and what to do about it."""
        met = path.status == "converged"
        missed = list(self.limits.exceeded(result.change))
        if not met:
            missed.insert(0, missed_text(self.goal.name, problem, path.value, self.tolerance))
        if crooked := _crooked(self.goal, result.mesh):
            missed.append(crooked)
        result = result.revised(remarks=remarks_of(result))
        if not missed:
            return Outcome(result)
        advice = advice_of(result, met, self.keep, boundary, self.limits, self.goal.easier)
        return Outcome(result.revised(status="missed", advice=advice), tuple(missed))

    def result(
        self, problem: Problem, x: Floats, found: Mesh, surface: Mesh | None
    ) -> OptimizeResult:
        """The result with the unknowns x; `found` and `surface` are in the unit of the input."""
        again = x.copy()
        if found is not self.frame.mesh:  # as the file will have it
            again[problem.layout.block(VERTICES)] = self.frame.inside(found).vertices.ravel()
        return self.goal.result(
            goal=self.goal.name,
            mesh=found,
            original=self.frame.mesh,
            status="converged",
            history=(),
            residual=violation(problem, again),
            surface=surface,
            pane=self.limits.pane,
            **self.goal.own(problem, x),
        )


def _refuse_far(mesh: Mesh, surface: Mesh) -> None:
    """Raise where a surface to stay near to is nowhere near."""
    far = SmoothSurface(surface).distance(mesh.vertices[mesh.valences > 0])
    edges = float(far.mean()) / mean_edge(mesh)
    if edges > _ELSEWHERE:
        raise InputError(
            f"the surface to stay near to is {far.mean():.4g} from the mesh on average "
            f"({edges:.3g} mean edges, limit {_ELSEWHERE:g}), {far.max():.4g} at most: bring both "
            "to one place and one unit"
        )


def _soft_limits(mesh: Mesh, frame: Frame, limits: Limits) -> tuple[Term, ...]:
    """Soft terms of limits: panes no larger than what is made."""
    if limits.pane is None:
        return ()
    return (pane_lengths(mesh, (limits.pane[0] / frame.unit, limits.pane[1] / frame.unit)),)


def _tolerance(goal: NetGoal, flat_percent: float | None) -> float:
    percent = goal.flat_percent if flat_percent is None else flat_percent
    if not (np.isfinite(percent) and 0 <= percent <= 100):
        raise InputError(f"flat = {percent:g} %: 0 (exact) to 100")
    return max(percent / 100, EXACT)


def _refuse_impossible(
    name: str, problem: Problem, constraints: Constraints, boundary: Boundary, percent: float
) -> None:
    """Raise where fixed corners alone keep a face from being planar."""
    faces, skew = impossible_faces(problem.mesh, constraints.fixed, percent)
    asked = np.isin(faces, planarity_of(problem, problem.start)[0])
    faces, skew = faces[asked], skew[asked]
    if not len(faces):
        return
    order = np.argsort(-skew, kind="stable")
    corners = {"free": "fixed", "glide": "fixed or corners of the boundary"}.get(boundary, "fixed")
    raise OptimizeError(
        f"{name}: {len(faces)} faces cannot be planar, because four or more of their corners "
        f"are {corners} and not coplanar: faces {ids(faces[order])}, worst {skew.max():.2g} % "
        f"(limit {percent:.2g} %)\n"
        + (
            'use boundary = "free"'
            if boundary != "free"
            else "fix fewer of their corners, or move those corners into a plane first"
        )
    )


def _expected(problem: Problem, frame: Frame) -> Forecast | None:
    """The forecast, which knows vertices alone."""
    if problem.mesh.n_faces > _FORECAST_FACES or len(problem.layout.names) > 1:
        return None
    try:
        return forecast_of(problem, frame.unit, problem.mesh.vertex_normals)
    except DegenerateError:
        return None


def _crooked(goal: NetGoal, mesh: Mesh) -> str:
    """Reflex corners where the goal's angles would balance without a circle or cone."""
    bad = np.zeros(0, dtype=np.int64) if goal.crooked is None else goal.crooked(mesh)
    return f"{len(bad)} faces have reflex corners: {ids(bad)}" if len(bad) else ""


def _prices(problem: Problem, frame: Frame, ends: Sequence[Waypoint]) -> tuple[Price, ...]:
    """The stages of a path that are flatter than all before them."""
    mesh, used = problem.mesh, problem.mesh.valences > 0
    surface = next(t.surface for t in problem.following if isinstance(t, NearSurface))
    prices: list[Price] = []
    least = _COARSEST
    for end in ends[1:]:
        if end.violation >= least:
            continue
        least = end.violation
        points = problem.vertices(end.x)[used]
        far = frame.unit * surface.distance(points)
        moved = frame.unit * np.linalg.norm(points - mesh.vertices[used], axis=1)
        prices.append(
            Price(
                100 * end.violation,
                float(far.mean()),
                float(far.max()),
                float(moved.mean()),
                float(moved.max()),
            )
        )
    return tuple(prices)

"""Reach a goal: the mesh in its frame, the path to the equations, what it cost, what is missed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final, TypeAlias

import numpy as np

from ddgfab.errors import DegenerateError, InputError, OptimizeError
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.advice import advice_of, complaint, missed_text, remarks_of
from ddgfab.optimize.energy import Keep
from ddgfab.optimize.forecast import forecast_of
from ddgfab.optimize.frame import Frame, element_ids
from ddgfab.optimize.goal import EXACT, NetGoal, net_problem, planarity_of, violation
from ddgfab.optimize.limits import Limits, ids
from ddgfab.optimize.nested import LEAST_FACES, NESTED, begun, nested_start, usable
from ddgfab.optimize.panes import pane_wish
from ddgfab.optimize.path import PathOptions, Waypoint, follow
from ddgfab.optimize.problem import VERTICES, Problem, Term
from ddgfab.optimize.result import Forecast, OptimizeResult, Price, Step
from ddgfab.optimize.rim import Boundary, Constraints, impossible_faces
from ddgfab.optimize.terms.nearness import NearSurface

StageProgress: TypeAlias = Callable[[str, int, Step], None]
"""Called with the name of the stage, the number of the step and the step."""

_AIM: Final = 0.995
"""Part of a tolerance that is aimed at, so that rounding of files does not exceed it."""

_COARSEST: Final = 0.1
"""Price lists begin at this violation."""

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

    Raises
    ------
    OptimizeError
        Faces whose fixed corners are not coplanar.
    InputError
        An id out of range, an unknown option.
    """
    goal.check(mesh)
    frame = Frame.of(mesh)
    small = frame.inside(mesh)
    allowed = limits or Limits()
    constraints = Constraints.of(small, fixed, boundary)
    sharp = None if features is None else element_ids(features, mesh.n_edges, "feature edge")
    tolerance = _tolerance(goal, flat_percent)
    problem = net_problem(
        small,
        goal,
        keep=keep,
        constraints=constraints,
        surface=None if surface is None else frame.inside(surface),
        features=sharp,
        rim=None if rim is None else frame.inside(rim),
        extra=_wishes(small, frame, allowed),
        movement=None if allowed.movement is None else allowed.movement / frame.unit,
    )

    def measure(x: Floats) -> float:
        return violation(problem, x)

    before = measure(problem.start)
    if before <= tolerance and not _crooked(goal, small):
        still = goal.result(
            goal=goal.name,
            mesh=mesh,
            original=mesh,
            status="converged",
            history=(),
            residual=before,
            surface=surface,
            pane=allowed.pane,
            **goal.own(problem, problem.start),
        )
        return Outcome(still)
    _refuse_impossible(goal.name, problem, constraints, boundary, 100 * tolerance)
    expected = _expected(problem, frame)
    history: list[tuple[str, Step]] = []
    stage = goal.label or goal.name

    def tell(number: int, step: Step) -> None:
        history.append((stage, step))
        if progress is not None:
            progress(stage, number, step)

    way = options or PathOptions()
    alone = goal.crooked is None and not goal.still and problem.layout.names == (VERTICES,)
    if alone and options is None and sharp is None and mesh.n_faces >= LEAST_FACES:

        def pose(one: Mesh, inner: Frame, numbers: Ints) -> Problem:
            held = np.flatnonzero(np.isin(numbers, constraints.fixed))
            near = frame.inside(surface) if surface is not None else small
            return net_problem(
                one,
                goal,
                keep=keep,
                constraints=Constraints(held, constraints.glide),
                surface=inner.inside(near),
                rim=inner.inside(small if rim is None else frame.inside(rim)),
                movement=None
                if allowed.movement is None
                else allowed.movement / (frame.unit * inner.unit),
            )

        begin = nested_start(small, pose, tolerance, tell)
        if begin is not None:
            there = begun(problem, begin - small.vertices)
            if usable(there, before):
                problem, way = there, NESTED
    chosen = replace(way, tolerance=max(_AIM * tolerance, EXACT))
    path = follow(problem, measure, chosen, tell)
    found = frame.outside(small.vertices, problem.vertices(path.value))
    again = path.value.copy()
    again[problem.layout.block(VERTICES)] = frame.inside(found).vertices.ravel()
    result = goal.result(
        goal=goal.name,
        mesh=found,
        original=mesh,
        status="converged",
        history=tuple(history),
        residual=measure(again),
        surface=surface,
        prices=_prices(problem, frame, path.waypoints),
        forecast=expected,
        pane=allowed.pane,
        **goal.own(problem, path.value),
    )
    missed = list(allowed.exceeded(result.change))
    met = path.status == "converged"
    if not met:
        missed.insert(0, missed_text(goal.name, problem, path.value, tolerance))
    crooked = _crooked(goal, found)
    if crooked:
        missed.append(crooked)
    result = replace(result, remarks=remarks_of(result))
    if not missed:
        return Outcome(result)
    advice = advice_of(result, met, keep, boundary, allowed, goal.easier)
    return Outcome(replace(result, status="missed", advice=advice), tuple(missed))


def _wishes(mesh: Mesh, frame: Frame, limits: Limits) -> tuple[Term, ...]:
    """Wishes of limits: panes no larger than what is made."""
    if limits.pane is None:
        return ()
    return (pane_wish(mesh, (limits.pane[0] / frame.unit, limits.pane[1] / frame.unit)),)


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

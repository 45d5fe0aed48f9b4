"""Goals about faces and vertices of nets: planar, circular, conical, reached by a penalty path."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final, TypeAlias

import numpy as np

from ddgfab.errors import DegenerateError, InputError, OptimizeError
from ddgfab.measures import planarity_percent
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.barriers import barriers
from ddgfab.optimize.directions import TRACE, TRACE_REASON, other_way
from ddgfab.optimize.energy import Keep, Weights, energy
from ddgfab.optimize.forecast import doubtful, forecast_of, forecast_text
from ddgfab.optimize.frame import Frame, element_ids
from ddgfab.optimize.gauss_newton import Step
from ddgfab.optimize.limits import Limits, ids
from ddgfab.optimize.pane_size import misfit
from ddgfab.optimize.panes import pane_wish
from ddgfab.optimize.path import PathOptions, Waypoint, follow
from ddgfab.optimize.problem import Following, Problem, Term
from ddgfab.optimize.quality import reflex_faces
from ddgfab.optimize.result import Forecast, OptimizeResult, Price
from ddgfab.optimize.rim import Boundary, Constraints, impossible_faces
from ddgfab.optimize.surface import SmoothSurface
from ddgfab.optimize.terms.nearness import NearRim, NearSurface

StageProgress: TypeAlias = Callable[[str, int, Step], None]
"""Called with the name of the stage, the number of the step and the step."""

EXACT: Final = 1e-10
"""Violation of the goals that are met exactly."""

_AIM: Final = 0.995
"""Part of a tolerance that is aimed at, so that rounding of files does not exceed it."""

_COARSEST: Final = 0.1
"""Price lists begin at this violation."""

_FORECAST_FACES: Final = 20_000
"""Up to this number of faces the forecast is made before solving; beyond it costs as much as a
step."""


@dataclass(frozen=True, eq=False)
class NetGoal:
    """A goal that is a set of equations on the vertices of a mesh.

    Attributes
    ----------
    terms : mesh whose mean edge is one -> equations, all hard
    flat_percent : violation that is met by default [%]
    convex : faces (or corners at conical vertices) with reflex corners do not count as met: the
        equations take angles between 0 and pi
    source : where it is defined
    """

    name: str
    terms: Callable[[Mesh], tuple[Term, ...]]
    flat_percent: float
    source: str
    convex: bool = False

    @property
    def tolerance(self) -> float:
        """Violation that is met by default."""
        return max(self.flat_percent / 100, EXACT)

    def violation(self, mesh: Mesh, x: Floats, terms: Sequence[Term] | None = None) -> float:
        """How far unknowns are from the goal: planarity, or an angle [rad] where it is greater."""
        equations = self.terms(mesh) if terms is None else terms
        flat = float(planarity_percent(mesh.with_vertices(x.reshape(-1, 3))).max()) / 100
        return max(flat, *(float(np.abs(t.residual(x)).max(initial=0.0)) for t in equations), 0.0)


def net_problem(
    mesh: Mesh,
    goal: NetGoal,
    *,
    keep: Keep | float = "balanced",
    constraints: Constraints | None = None,
    surface: SmoothSurface | None = None,
    features: Ints | None = None,
    extra: Sequence[Term] = (),
    rim: Mesh | None = None,
) -> Problem:
    """Energy, barriers and equations of a goal on a mesh whose mean edge is one."""
    given = constraints or Constraints(np.zeros(0, dtype=np.int64), glide=False)
    weights = Weights.of(mesh, keep, glide=given.glide)
    kept = energy(mesh, weights, surface, features, rim)
    following: list[Following] = [t for t in kept if isinstance(t, NearSurface | NearRim)]
    soft: list[Term] = [t for t in kept if not isinstance(t, NearSurface | NearRim)]
    problem = Problem.build(mesh, [*soft, *extra, *goal.terms(mesh)], fixed=given.fixed)
    return replace(problem, following=tuple(following), barriers=barriers(mesh))


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
    throw: bool = True,
    progress: StageProgress | None = None,
) -> OptimizeResult:
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
    limits : what the result may cost
    throw : raise when the goal is missed or a limit exceeded; otherwise the best mesh comes back,
        status "missed"

    Raises
    ------
    OptimizeError
        The goal is missed or a limit exceeded; carries the best mesh as `result`.
    InputError
        Faces whose fixed corners are not coplanar, an id out of range, an unknown option.
    """
    frame = Frame.of(mesh)
    small = frame.inside(mesh)
    allowed = limits or Limits()
    constraints = Constraints.of(small, fixed, boundary)
    sharp = None if features is None else element_ids(features, mesh.n_edges, "feature edge")
    tolerance = _tolerance(goal, flat_percent)
    terms = goal.terms(small)

    def violation(x: Floats) -> float:
        return goal.violation(small, x, terms)

    start = small.vertices.ravel()
    before = violation(start)
    if before <= tolerance and not _crooked(goal, small):
        return OptimizeResult(
            goal.name, mesh, mesh, "converged", (), before, surface=surface, pane=allowed.pane
        )
    _refuse_impossible(goal, small, constraints, boundary, 100 * tolerance)
    problem = net_problem(
        small,
        goal,
        keep=keep,
        constraints=constraints,
        surface=None if surface is None else SmoothSurface(frame.inside(surface)),
        features=sharp,
        rim=None if rim is None else frame.inside(rim),
        extra=_wishes(small, frame, allowed),
    )
    expected = _expected(problem, frame)
    history: list[tuple[str, Step]] = []

    def tell(number: int, step: Step) -> None:
        history.append((goal.name, step))
        if progress is not None:
            progress(goal.name, number, step)

    chosen = replace(options or PathOptions(), tolerance=max(_AIM * tolerance, EXACT))
    path = follow(problem, violation, chosen, tell)
    found = frame.outside(small.vertices, problem.vertices(path.value))
    result = OptimizeResult(
        goal=goal.name,
        mesh=found,
        original=mesh,
        status="converged",
        history=tuple(history),
        residual=violation(frame.inside(found).vertices.ravel()),
        surface=surface,
        prices=_prices(problem, frame, path.waypoints),
        forecast=expected,
        pane=allowed.pane,
    )
    missed = list(allowed.exceeded(result.change))
    if path.status != "converged":
        missed.insert(0, _missed(goal, small, terms, path.value, tolerance))
    crooked = _crooked(goal, found)
    if crooked:
        missed.append(crooked)
    if not missed:
        return replace(result, remarks=_remarks(result))
    advice = _advice(result, path.status == "converged", keep, boundary, constraints, allowed)
    result = replace(result, status="missed", remarks=_remarks(result), advice=advice)
    if throw:
        raise OptimizeError(_complaint(result, missed), result=result)
    return result


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
    goal: NetGoal, mesh: Mesh, constraints: Constraints, boundary: Boundary, percent: float
) -> None:
    """Raise where fixed corners alone keep a face from being planar."""
    faces, skew = impossible_faces(mesh, constraints.fixed, percent)
    if not len(faces):
        return
    order = np.argsort(-skew, kind="stable")
    corners = {"free": "fixed", "glide": "fixed or corners of the boundary"}.get(boundary, "fixed")
    raise OptimizeError(
        f"{goal.name}: {len(faces)} faces cannot be planar, because four or more of their corners "
        f"are {corners} and not coplanar: faces {ids(faces[order])}, worst {skew.max():.2g} % "
        f"(limit {percent:.2g} %)\n"
        + (
            'use boundary = "free"'
            if boundary != "free"
            else "fix fewer of their corners, or move those corners into a plane first"
        )
    )


def _expected(problem: Problem, frame: Frame) -> Forecast | None:
    if problem.mesh.n_faces > _FORECAST_FACES:
        return None
    try:
        return forecast_of(problem, frame.unit, problem.mesh.vertex_normals)
    except DegenerateError:
        return None


def _crooked(goal: NetGoal, mesh: Mesh) -> str:
    """Reflex corners where the goal's angles would balance without a circle or cone."""
    if not goal.convex:
        return ""
    inner = np.flatnonzero(~mesh.boundary_vertex) if goal.name == "conical" else None
    bad = reflex_faces(mesh, inner)
    if goal.name == "conical":
        bad = bad[mesh.face_sizes[bad] == 4]
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


def _missed(goal: NetGoal, mesh: Mesh, terms: Sequence[Term], x: Floats, tolerance: float) -> str:
    """By how much the equations are missed, and where."""
    flat = planarity_percent(mesh.with_vertices(x.reshape(-1, 3)))
    texts = []
    if flat.max() > 100 * tolerance:
        worst = np.argsort(-flat, kind="stable")[:5]
        names = ", ".join(f"{f} ({flat[f]:.2g})" for f in worst.tolist())
        texts.append(
            f"faces stay {flat.max():.2g} % from planar (limit {100 * tolerance:.2g} %), "
            f"{int((flat > 100 * tolerance).sum())} of {mesh.n_faces} faces, worst {names}"
        )
    for term in terms:
        values = np.abs(term.residual(x))
        if not term.name.startswith("planarity") and values.max(initial=0.0) > tolerance:
            elements = np.asarray(getattr(term, "elements", np.arange(len(values))))
            worst = elements[np.argsort(-values, kind="stable")[:5]]
            texts.append(
                f"{term.name} stays at {np.degrees(values.max()):.2g} deg (limit "
                f"{np.degrees(tolerance):.2g}), worst {getattr(term, 'of', 'row')} {ids(worst)}"
            )
    return "; ".join(texts) or f"{goal.name} is missed"


def _advice(
    result: OptimizeResult,
    met: bool,
    keep: Keep | float,
    boundary: Boundary,
    constraints: Constraints,
    limits: Limits,
) -> tuple[tuple[str, object], ...]:
    """Options to try next: what holds the goal back first."""
    if boundary == "fixed" or (boundary == "glide" and not met):
        return (("boundary", "free"),)
    if not met:
        best = min((p.percent for p in result.prices), default=0.0)
        return (("flat", float(f"{1.1 * best:.2g}")),) if best else ()
    if limits.kinds(result.change) == {"pane"}:
        size = np.multiply(limits.pane or (), misfit(result.mesh, limits.pane or (1, 1)).max())
        return (("max_pane", tuple(float(f"{1.01 * v:.3g}") for v in size)),)
    if way := other_way(result, keep, limits):
        return way
    if keep != "close" and not (isinstance(keep, float | int) and keep <= 0.2):
        return (("keep", "close"),)
    small = Frame.of(result.original).inside(result.original)
    fair = [Weights.of(small, k).fair for k in (keep, _CLOSEST)]
    if fair[1] < 0.5 * fair[0]:
        return (("keep", _CLOSEST),)
    edge = result.change.edge
    finest = result.prices[-1] if result.prices else None
    for price in reversed(result.prices):
        near = price.distance_mean < 0.9 * limits.distance_mean * edge
        near &= price.distance_max < 0.9 * limits.distance_max * edge
        # A step that is hardly nearer than the result would miss the same limit again.
        nearer = finest is not None and price.distance_max < 0.9 * finest.distance_max
        if near and nearer and price.percent < 5:
            return (("flat", float(f"{1.05 * price.percent:.2g}")),)
    change = result.change
    needed = (
        max(limits.distance_mean, float(f"{1.05 * change.distance_mean / edge:.2g}")),
        max(limits.distance_max, float(f"{1.05 * change.distance_max / edge:.2g}")),
    )
    return (("distance_limit", needed),)


def _remarks(result: OptimizeResult) -> tuple[str, ...]:
    """What a reader of the result should know besides its numbers."""
    out = []
    change = result.change
    if len(change.reflex_polygons):
        out.append(
            f"{len(change.reflex_polygons)} faces of five or more corners have reflex corners now, "
            "as planar faces on saddles have"
        )
    percentile = np.degrees(change.crease[0])
    if percentile > _CREASED_DEG:
        out.append(
            f"creases: one edge in a hundred bends {percentile:.0f} deg more or less than before; "
            "look at the picture"
        )
    if result.forecast is not None and doubtful(result.forecast):
        out.append(forecast_text(result.forecast, "mm").removeprefix("planar faces: "))
    return tuple(out)


_CLOSEST: Final = 0.1
"""What to keep where "close" is too far from the surface: shorter waves crease as well."""
_CREASED_DEG: Final = 20.0
"""Changes of dihedral angles [deg] that people see."""


def _complaint(result: OptimizeResult, missed: Sequence[str]) -> str:
    edge = result.change.edge
    lines = [f"{result.goal}: {'; '.join(missed)}"]
    steps = [p for p in result.prices if p.percent <= 5]
    if len(steps) > 1:
        lines.append(
            "mean distance by planarity: "
            + ", ".join(
                f"{p.percent:.2g} %: {p.distance_mean / edge:.2f} edges" for p in steps[-4:]
            )
        )
    lines.append(advice_text(result.advice))
    return "\n".join(line for line in lines if line)


def advice_text(advice: tuple[tuple[str, object], ...]) -> str:
    """What to try next, in a line."""
    if not advice:
        return "let the edges follow other directions, or use a finer mesh"
    name, value = advice[0]
    reason = {
        "boundary": "the fixed boundary holds it back",
        "flat": "ask for less flat faces",
        "keep": "keep faces smooth rather than the surface"
        if value == "fair"
        else "keep the surface rather than smooth faces",
        "max_pane": "give a finer mesh, or allow larger panes",
        TRACE: TRACE_REASON,
        "distance_limit": "let the edges follow other directions, use a finer mesh, or allow it",
    }.get(name, "try")
    if name == TRACE:
        return f"{reason}, spacing = {value:g}"
    shown = f'"{value}"' if isinstance(value, str) else value
    return f"{reason}: {name} = {shown}"

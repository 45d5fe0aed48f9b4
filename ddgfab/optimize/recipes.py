"""Recipes: planarize, circularize, conicalize a mesh, close to the design and fair.

A recipe solves for hard terms (planar faces, ...) with closeness and fairness as wishes, and tries
stiffnesses: from a gentle one (small movements, fair over few edges) to stiff ones (fair over much
of the mesh), until the result keeps what the input had: no folded faces, corner angles, smoothness.
From the first stiffness that works it goes back towards gentler ones, each starting at the result
before, as long as they work too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from ddgfab.errors import DegenerateError, InputError, OptimizeError
from ddgfab.mesh import Ints, Mesh
from ddgfab.optimize.problem import Problem, Term, mean_edge
from ddgfab.optimize.quality import Quality, folded_faces
from ddgfab.optimize.result import OptimizeResult
from ddgfab.optimize.solve import Progress, Solution, SolveOptions, Step, polish, solve
from ddgfab.optimize.terms import (
    boundary_glide,
    circularity_terms,
    closeness,
    cone_terms,
    conicality_terms,
    fairness,
    planarity_terms,
)

Boundary = Literal["free", "glide", "fixed"]
"""What boundary vertices may do."""


@dataclass(frozen=True)
class RecipeOptions:
    """How recipes run; every field may be left as it is."""

    tolerance: float = 1e-12
    """Greatest residual of planarity (part of the diagonal) and of angles [rad] aimed at."""
    accepted: float = 1e-10
    """Greatest residual that a result may keep; above, `OptimizeError`."""
    angle_slack: float = float(np.radians(10.0))
    """Corner angles may leave the input's range by this much [rad]."""
    roughness_slack: float = 0.01
    """Polylines may bend more than the input's by this part."""
    search_faces: int = 5_000
    """Meshes with more faces take the first stiffness that works."""
    max_steps: int = 25
    """Steps for a stiffness."""


@dataclass(frozen=True)
class _Stiffness:
    """How far fairness reaches, as a part of the mesh's width, and how much bends are smoothed."""

    reach: float
    smoothing: float


_LADDER = (
    _Stiffness(0.05, 0.03),
    _Stiffness(0.10, 0.10),
    _Stiffness(0.10, 0.50),
    _Stiffness(0.20, 0.30),
    _Stiffness(0.10, 1.0),
    _Stiffness(0.14, 1.0),
    _Stiffness(0.20, 1.0),
    _Stiffness(0.40, 1.0),
)
_FIRST = 1
"""Where the ladder is entered."""


@dataclass(frozen=True)
class _Task:
    """A recipe on a mesh whose centre is the origin and whose mean edge is one."""

    goal: str
    mesh: Mesh
    hard: tuple[Term, ...]
    fixed: Ints
    features: Ints | None
    options: RecipeOptions
    iterative: bool
    progress: Callable[[str, int, Step], None] | None

    @property
    def width(self) -> float:
        """Edges across the mesh, about."""
        return self.mesh.diameter / float(np.sqrt(2.0))


@dataclass(frozen=True)
class _Trial:
    """What came of one stiffness."""

    mesh: Mesh
    residual: float
    folded: Ints
    remarks: tuple[str, ...]
    history: tuple[tuple[str, Step], ...]

    def rank(self, accepted: float) -> tuple[bool, int, int, float]:
        """The smaller the better: goal met, folds, remarks, residual."""
        return self.residual > accepted, len(self.folded), len(self.remarks), self.residual


def _attempt(task: _Task, stiffness: _Stiffness, start: Mesh, before: Quality) -> _Trial:
    """Solve with one stiffness from a start, then meet the hard terms to the last digit."""
    mesh, options = task.mesh, task.options
    stage = f"reach {stiffness.reach:g}, smoothing {stiffness.smoothing:g}"
    problem = Problem.build(
        mesh,
        [
            closeness(mesh, weight=(stiffness.reach * task.width) ** -4),
            fairness(mesh, smoothing=stiffness.smoothing, features=task.features),
            *task.hard,
        ],
        fixed=task.fixed,
    ).with_start(start.vertices.ravel())
    history: list[tuple[str, Step]] = []

    def told(name: str) -> Progress:
        def tell(number: int, step: Step) -> None:
            history.append((name, step))
            if task.progress is not None:
                task.progress(name, number, step)

        return tell

    rough = SolveOptions(
        max_steps=options.max_steps,
        tolerance=_ROUGH if task.iterative else _FINE,
        decrease=_DECREASE,
        iterative=task.iterative,
    )
    last = SolveOptions(
        max_steps=_LAST_STEPS, tolerance=options.tolerance, regularisation=_LAST_REGULARISATION
    )
    try:
        found = solve(problem, rough, throw=False, progress=told(stage))
        end = polish(
            problem.with_start(found.value), last, throw=False, progress=told(stage + ", exact")
        )
    except DegenerateError:  # faces collapsed on the way: this stiffness leads nowhere
        end = Solution(start.vertices.ravel(), "stalled", ())
    return _judge(task, mesh.with_vertices(problem.vertices(end.value)), before, tuple(history))


def _judge(
    task: _Task, mesh: Mesh, before: Quality, history: tuple[tuple[str, Step], ...]
) -> _Trial:
    options, after = task.options, Quality.of(mesh)
    remarks = []
    low, high = before.angles
    if after.angles[0] < low - options.angle_slack or after.angles[1] > high + options.angle_slack:
        was = " to ".join(f"{np.degrees(a):.1f}" for a in before.angles)
        now = " to ".join(f"{np.degrees(a):.1f}" for a in after.angles)
        remarks.append(
            f"corner angles {now} deg leave the range of the input, {was} deg, by more than "
            f"{np.degrees(options.angle_slack):g} deg"
        )
    if after.fairness > before.fairness * (1 + options.roughness_slack) + _ROUND:
        remarks.append(
            f"polylines bend more than before: {after.fairness:.3g} of an edge, "
            f"{before.fairness:.3g} in the input (root mean square)"
        )
    residual = max(float(np.abs(t.residual(mesh.vertices.ravel())).max()) for t in task.hard)
    return _Trial(mesh, residual, folded_faces(mesh, task.mesh), tuple(remarks), history)


_ROUGH = 1e-4
"""Residual at which conjugate gradients hand over to exact steps."""
_FINE = 1e-8
"""Residual at which factored steps do."""
_DECREASE = 1e-2
"""The wishes have come to rest when a step improves them by less than this part."""
_LAST_STEPS = 12
_LAST_REGULARISATION = 1e-13
"""For the exact steps: their equations are dependent only on flat or closed meshes."""
_ROUND = 1e-9
"""Roughness that is rounding."""


def _climb(
    task: _Task, ladder: tuple[_Stiffness, ...], first: int
) -> tuple[_Trial, tuple[tuple[str, Step], ...]]:
    """The best trial and all steps: stiffer until one is good, then gentler while they are."""
    accepted = task.options.accepted

    def good(trial: _Trial) -> bool:
        return trial.rank(accepted)[:3] == (False, 0, 0)

    before = Quality.of(task.mesh)
    trials: list[_Trial] = []
    rung = first
    for rung in range(first, len(ladder)):
        trials.append(_attempt(task, ladder[rung], task.mesh, before))
        if good(trials[-1]):
            break
    if good(trials[-1]) and task.mesh.n_faces <= task.options.search_faces:
        for gentler in reversed(range(rung)):
            trials.append(_attempt(task, ladder[gentler], trials[-1].mesh, before))
            if not good(trials[-1]):
                break
    works = [trial for trial in trials if good(trial)]
    best = works[-1] if works else min(trials, key=lambda trial: trial.rank(accepted))
    return best, tuple(step for trial in trials for step in trial.history)


def _run(task: _Task, original: Mesh, back: Callable[[Mesh], Mesh], throw: bool) -> OptimizeResult:
    """Climb the ladder, carry the best mesh back to the unit of the input, judge it there."""
    best, history = _climb(task, _LADDER, _FIRST)
    accepted, folded = task.options.accepted, best.folded
    failed = best.residual > accepted or len(folded) > 0
    result = OptimizeResult(
        task.goal,
        back(best.mesh),
        original,
        "missed" if failed else "converged",
        history,
        best.residual,
        best.remarks,
    )
    if failed and throw:
        raise OptimizeError(_complaint(task, best), result=result)
    return result


def _complaint(task: _Task, best: _Trial) -> str:
    """Worst elements, limits, and what pulls against the goal."""
    accepted, x = task.options.accepted, best.mesh.vertices.ravel()
    lines = []
    for term in task.hard:
        values = np.abs(term.residual(x))
        if values.max() > accepted:
            elements = getattr(term, "elements", None)
            order = np.argsort(-values, kind="stable")
            ids = order if elements is None else elements[order]
            worst = list(dict.fromkeys(ids[: 4 * _NAMED].tolist()))[:_NAMED]
            lines.append(
                f"{term.name} stays at {values.max():.2g} (limit {accepted:g}), worst at "
                f"{getattr(term, 'of', 'row')} {', '.join(map(str, worst))}"
            )
    if len(best.folded):
        names = ", ".join(map(str, best.folded[:_NAMED].tolist()))
        lines.append(f"{len(best.folded)} faces fold: {names}")
    held = len(task.fixed)
    way = (
        f"{held} of {task.mesh.n_vertices} vertices are fixed and pull against it: let the "
        "boundary glide or go free, or fix fewer"
        if held
        else "the design is far from such a net: follow its principal directions with the edges, "
        "or use a finer mesh"
    )
    return (
        f"{task.goal}: {'; '.join(lines)}\n{way}\n"
        f"the best mesh reached moves vertices by {_moved(task, best):.3g} mean edges at most; it "
        "is kept apart and not taken"
    )


_NAMED = 5
"""How many of the worst elements a message names."""


def _moved(task: _Task, trial: _Trial) -> float:
    return float(np.linalg.norm(trial.mesh.vertices - task.mesh.vertices, axis=1).max())


def _recipe(
    goal: str,
    mesh: Mesh,
    terms: Callable[[Mesh], tuple[Term, ...]],
    iterative: bool,
    *,
    fixed: Sequence[int] | Ints,
    boundary: Boundary,
    features: Sequence[int] | Ints | None,
    options: RecipeOptions | None,
    throw: bool,
    progress: Callable[[str, int, Step], None] | None,
) -> OptimizeResult:
    if boundary not in get_args(Boundary):
        raise InputError(f"boundary {boundary!r}; one of {', '.join(get_args(Boundary))}")
    chosen = options or RecipeOptions()
    centre, unit = mesh.vertices[mesh.corners].mean(axis=0), mean_edge(mesh)
    small = mesh.with_vertices((mesh.vertices - centre) / unit)
    hard = terms(small)
    held = _ids(fixed, mesh.n_vertices, "fixed vertex")
    rim = np.flatnonzero(mesh.boundary_vertex)
    if boundary == "fixed":
        held = np.union1d(held, rim)
    elif boundary == "glide":
        sliding, corners = boundary_glide(small, np.setdiff1d(rim, held))
        hard, held = (*hard, *sliding), np.union1d(held, corners)
    met = max((float(np.abs(t.residual(small.vertices.ravel())).max()) for t in hard), default=0.0)
    if met <= chosen.tolerance:
        return OptimizeResult(goal, mesh, mesh, "converged", (), met)
    task = _Task(
        goal,
        small,
        hard,
        held,
        None if features is None else _ids(features, mesh.n_edges, "feature edge"),
        chosen,
        iterative,
        progress,
    )

    def back(found: Mesh) -> Mesh:
        points = found.vertices * unit + centre
        points[held] = mesh.vertices[held]
        return mesh.with_vertices(points)

    return _run(task, mesh, back, throw)


def _ids(given: Sequence[int] | Ints, limit: int, noun: str) -> Ints:
    ids = np.unique(np.asarray(given, dtype=np.int64))
    if len(ids) and not 0 <= ids[0] <= ids[-1] < limit:
        raise InputError(
            f"{noun} {ids[0] if ids[0] < 0 else ids[-1]}; ids run from 0 to {limit - 1}"
        )
    return ids


def planarize(
    mesh: Mesh,
    *,
    fixed: Sequence[int] | Ints = (),
    boundary: Boundary = "free",
    features: Sequence[int] | Ints | None = None,
    options: RecipeOptions | None = None,
    throw: bool = True,
    progress: Callable[[str, int, Step], None] | None = None,
) -> OptimizeResult:
    """Planar faces: quads, hexagons, any polygons; triangles are planar already.

    Parameters
    ----------
    fixed : ids of vertices that stay where they are
    boundary : "free", "glide" along the boundary as it is (its corners stay), or "fixed"
    features : ids of edges across which polylines may turn
    throw : raise when the goal is missed; otherwise the best mesh comes back, status "missed"
    progress : called with the name of the stage, the number of the step and the step

    Returns
    -------
    OptimizeResult; `remarks` say which wishes (corner angles, smoothness) were not granted

    Raises
    ------
    OptimizeError
        Not planar to `RecipeOptions.accepted`, or a face folded; carries the best result.
    InputError
        An id out of range, an unknown boundary.

    Source: maths.md 8.5; Liu, Pottmann, Wallner, Yang, Wang 2006, section 3.
    """
    return _recipe(
        "planarize",
        mesh,
        planarity_terms,
        True,
        fixed=fixed,
        boundary=boundary,
        features=features,
        options=options,
        throw=throw,
        progress=progress,
    )


def circularize(
    mesh: Mesh,
    *,
    fixed: Sequence[int] | Ints = (),
    boundary: Boundary = "free",
    features: Sequence[int] | Ints | None = None,
    options: RecipeOptions | None = None,
    throw: bool = True,
    progress: Callable[[str, int, Step], None] | None = None,
) -> OptimizeResult:
    """Planar faces with their corners on circles; triangles have a circle already.

    Parameters, return value and errors are those of `planarize`.

    Source: Bobenko, Suris, Discrete Differential Geometry, 3.1; maths.md 2.
    """
    return _recipe(
        "circularize",
        mesh,
        lambda m: (*planarity_terms(m), *circularity_terms(m)),
        mesh.n_faces > _FACTORED,
        fixed=fixed,
        boundary=boundary,
        features=features,
        options=options,
        throw=throw,
        progress=progress,
    )


def conicalize(
    mesh: Mesh,
    *,
    fixed: Sequence[int] | Ints = (),
    boundary: Boundary = "free",
    features: Sequence[int] | Ints | None = None,
    options: RecipeOptions | None = None,
    throw: bool = True,
    progress: Callable[[str, int, Step], None] | None = None,
) -> OptimizeResult:
    """Planar faces that touch a cone of revolution at every inner vertex.

    Hexagonal meshes are conical as soon as they are planar. A triangle mesh has hardly any freedom:
    six planes round each vertex; expect an error.

    Parameters, return value and errors are those of `planarize`.

    Source: Liu, Pottmann, Wallner, Yang, Wang 2006, section 4; maths.md 2.9.
    """
    return _recipe(
        "conicalize",
        mesh,
        lambda m: (*planarity_terms(m), *conicality_terms(m), *cone_terms(m)),
        mesh.n_faces > _FACTORED,
        fixed=fixed,
        boundary=boundary,
        features=features,
        options=options,
        throw=throw,
        progress=progress,
    )


_FACTORED = 20_000
"""Up to this number of faces, angles are solved for with factored systems: fewer, surer steps."""

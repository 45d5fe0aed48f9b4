"""Trials of stiffnesses: what recipes have in common.

A trial solves for hard terms (planar faces, ...) with closeness and fairness as wishes. Trials go
from a gentle stiffness (small movements, fair over few edges) to stiff ones (fair over much of the
mesh), until the result keeps what the input had: no folded faces, corner angles, smoothness. From
the first stiffness that works they go back towards gentler ones, each starting at the result
before, as long as they work too.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ddgfab.errors import DegenerateError
from ddgfab.mesh import Ints, Mesh
from ddgfab.optimize.problem import Problem, Term
from ddgfab.optimize.quality import Quality, folded_faces, reflex_faces, roughness
from ddgfab.optimize.solve import Progress, Solution, SolveOptions, Step, polish, solve
from ddgfab.optimize.terms import closeness, fairness, on_surface
from ddgfab.optimize.terms.angles import AngleSums

StageProgress = Callable[[str, int, Step], None]
"""Called with the name of a stage, the number of a step and the step."""


@dataclass(frozen=True)
class RecipeOptions:
    """How recipes run; every field may be left as it is."""

    tolerance: float = 1e-12
    """Greatest residual of planarity (part of the diagonal) and of angles [rad] aimed at."""
    accepted: float = 1e-10
    """Greatest residual that a result may keep; above, `OptimizeError`."""
    angle_slack: float = float(np.radians(10.0))
    """Corner angles may leave the input's range by this much [rad]."""
    sharpest: float = float(np.radians(10.0))
    """Corners nearer to 0 or pi [rad] are wanted only where the input has such."""
    roughness_slack: float = 0.01
    """Polylines may bend more than the input's by this part."""
    search_faces: int = 5_000
    """Meshes with more faces take the first stiffness that works."""
    max_movement: float | None = None
    """Greatest movement of a vertex, in the unit of the mesh: worth more than the wishes, so that
    gentler trials are taken, with remarks, where the others move further."""
    max_steps: int = 25
    """Steps for a stiffness."""
    backend: str | None = None
    """Package that factors, of `SymmetricSolver.available`; by default chosen by size."""


@dataclass(frozen=True)
class Stiffness:
    """How far fairness reaches, as a part of the mesh's width, and how much bends are smoothed."""

    reach: float
    smoothing: float

    def between(self, other: Stiffness) -> Stiffness:
        """Half way."""
        return Stiffness(
            float(np.sqrt(self.reach * other.reach)), (self.smoothing + other.smoothing) / 2
        )


_LADDER = (
    Stiffness(0.05, 0.03),
    Stiffness(0.10, 0.10),
    Stiffness(0.10, 0.50),
    Stiffness(0.20, 0.30),
    Stiffness(0.10, 1.0),
    Stiffness(0.14, 1.0),
    Stiffness(0.20, 1.0),
    Stiffness(0.40, 1.0),
)
_GENTLE = (Stiffness(0.2, 0.0), Stiffness(0.1, 0.0), Stiffness(0.05, 0.0), Stiffness(0.02, 0.0))
"""Tried, in this order, where the others move further than is allowed: bends as they are."""
_FIRST = 1
"""Where the ladder is entered."""
_BISECTIONS = 2
"""Halvings between the gentlest stiffness that works and the next that does not."""


@dataclass(frozen=True)
class Task:
    """A recipe on a mesh whose centre is the origin and whose mean edge is one."""

    goal: str
    mesh: Mesh
    design: Mesh
    """What to stay near and to be as fair as: the mesh, or the mesh without its noise."""
    hard: tuple[Term, ...]
    fixed: Ints
    features: Ints | None
    surface: Mesh | None
    options: RecipeOptions
    iterative: bool
    progress: StageProgress | None

    @cached_property
    def near(self) -> tuple[Term, ...]:
        """The wish to stay on a surface, if there is one."""
        if self.surface is None:
            return ()
        return (on_surface(self.mesh, self.surface, weight=_ON_SURFACE),)

    @property
    def width(self) -> float:
        """Edges across the mesh, about."""
        return self.mesh.diameter / float(np.sqrt(2.0))


@dataclass(frozen=True)
class Trial:
    """What came of one stiffness."""

    mesh: Mesh
    residual: float
    moved: float
    """Greatest movement of a vertex."""
    lost: bool
    """Whether that is so far that nothing of the design is left."""
    folded: Ints
    remarks: tuple[str, ...]
    history: tuple[tuple[str, Step], ...]

    def failed(self, accepted: float) -> bool:
        """Whether hard terms are missed, or faces folded."""
        return not self.residual <= accepted or len(self.folded) > 0

    def rank(self, accepted: float) -> tuple[bool, int, bool, int, float]:
        """The smaller the better: goal met, folds, lost design, wishes, movement or residual."""
        missed = not self.residual <= accepted
        last = self.residual if missed else self.moved
        return missed, len(self.folded), self.lost, len(self.remarks), last


def _attempt(task: Task, stiffness: Stiffness, start: Mesh, before: Quality) -> Trial:
    """Solve with one stiffness from a start, then meet the hard terms to the last digit."""
    mesh, options = task.mesh, task.options
    stage = f"reach {stiffness.reach:.3g}, smoothing {stiffness.smoothing:.3g}"
    problem = Problem.build(
        mesh,
        [
            closeness(task.design, weight=(stiffness.reach * task.width) ** -4),
            fairness(task.design, smoothing=stiffness.smoothing, features=task.features),
            *task.near,
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
        backend=options.backend,
    )
    last = SolveOptions(
        max_steps=_LAST_STEPS,
        tolerance=options.tolerance,
        regularisation=_LAST_REGULARISATION,
        backend=options.backend,
    )
    try:
        found = solve(problem, rough, throw=False, progress=told(stage))
        end = polish(
            problem.with_start(found.value), last, throw=False, progress=told(stage + ", exact")
        )
    except DegenerateError:  # faces collapsed on the way: this stiffness leads nowhere
        end = Solution(start.vertices.ravel(), "stalled", ())
    return _judge(task, mesh.with_vertices(problem.vertices(end.value)), before, tuple(history))


def _judge(task: Task, mesh: Mesh, before: Quality, history: tuple[tuple[str, Step], ...]) -> Trial:
    options, after = task.options, Quality.of(mesh)
    remarks = []
    low, high = before.angles
    least = max(low - options.angle_slack, min(low, options.sharpest))
    most = min(high + options.angle_slack, max(high, np.pi - options.sharpest))
    if after.angles[0] < least or after.angles[1] > most:
        was = " to ".join(f"{np.degrees(a):.1f}" for a in before.angles)
        now = " to ".join(f"{np.degrees(a):.1f}" for a in after.angles)
        remarks.append(
            f"corner angles {now} deg; {was} deg in the input, wanted "
            f"{np.degrees(least):.1f} to {np.degrees(most):.1f} deg"
        )
    if after.fairness > before.fairness * (1 + options.roughness_slack) + _ROUND:
        remarks.append(
            f"polylines bend more than before: {after.fairness:.3g} of an edge, "
            f"{before.fairness:.3g} in the input (root mean square)"
        )
    residual = max(float(np.abs(t.residual(mesh.vertices.ravel())).max()) for t in task.hard)
    moved = float(np.linalg.norm(mesh.vertices - task.mesh.vertices, axis=1).max())
    lost = moved > _LOST * task.mesh.diameter
    folded = np.union1d(folded_faces(mesh, task.mesh), crooked_faces(mesh, task.hard))
    return Trial(mesh, residual, moved, lost, folded, tuple(remarks), history)


def crooked_faces(mesh: Mesh, hard: tuple[Term, ...]) -> Ints:
    """Faces with reflex corners where angles are summed: on circles, and round the vertices of
    cones. Sums of angles between 0 and pi do not see them, and would take crooked nets for good."""
    crooked = [np.empty(0, dtype=np.int64)]
    for term in hard:
        if term.name == "circularity":
            crooked.append(reflex_faces(mesh))
        elif isinstance(term, AngleSums):
            crooked.append(reflex_faces(mesh, term.elements))
    return np.unique(np.concatenate(crooked))


_ON_SURFACE = 0.1
"""Weight of distances from a surface; of movements along it (reach * width)^-4, far less."""
_ROUGH = 3e-4
"""Residual at which conjugate gradients hand over to exact steps."""
_FINE = 1e-8
"""Residual at which factored steps do."""
_DECREASE = 3e-2
"""The wishes have come to rest when a step improves them by less than this part."""
_LAST_STEPS = 12
_LAST_REGULARISATION = 1e-13
"""For the exact steps: their equations are dependent only on flat or closed meshes."""
_NOISE_REACH = 3.0
"""Waves shorter than about six times as many edges can be noise."""
_NOISY = 0.5
"""They are when without them polylines bend less than this part of what they did."""
_LOST = 0.2
"""Movements beyond this part of the diameter are worse than wishes that are not granted."""
_ROUND = 1e-9
"""Roughness that is rounding."""


def without_noise(mesh: Mesh, fixed: Ints, features: Ints | None) -> Mesh:
    """The mesh, or one without its noise where bends of a few edges are mostly noise.

    On large meshes fairness reaches over many edges and would have to fight the noise of each.
    """
    problem = Problem.build(
        mesh,
        [closeness(mesh, weight=_NOISE_REACH**-4), fairness(mesh, features=features)],
        fixed=fixed,
    )
    smooth = mesh.with_vertices(problem.vertices(solve(problem).value))
    return smooth if roughness(smooth) < _NOISY * roughness(mesh) else mesh


def climb(task: Task) -> tuple[Trial, tuple[tuple[str, Step], ...]]:
    """The best trial and all steps: stiffer until one is good, then gentler while they are."""
    accepted = task.options.accepted

    def good(trial: Trial) -> bool:
        return not (trial.failed(accepted) or trial.lost or trial.remarks)

    before = Quality.of(task.mesh)
    trials: list[Trial] = []
    rung = _FIRST
    for rung in range(_FIRST, len(_LADDER)):
        trials.append(_attempt(task, _LADDER[rung], task.design, before))
        if good(trials[-1]):
            break
    best = trials[-1]
    if good(best) and task.mesh.n_faces <= task.options.search_faces:
        works, fails = _LADDER[rung], None
        for gentler in reversed(_LADDER[:rung]):
            trials.append(_attempt(task, gentler, best.mesh, before))
            if not good(trials[-1]):
                fails = gentler
                break
            best, works = trials[-1], gentler
        for _ in range(_BISECTIONS if fails else 0):
            assert fails is not None
            middle = works.between(fails)
            trials.append(_attempt(task, middle, best.mesh, before))
            if good(trials[-1]):
                best, works = trials[-1], middle
            else:
                fails = middle
    if not good(best):
        best = min(trials, key=lambda trial: trial.rank(accepted))
    limit = task.options.max_movement
    if limit is not None and best.moved > limit:
        for gentler in _GENTLE:
            trials.append(_attempt(task, gentler, task.design, before))
            if not trials[-1].failed(accepted) and trials[-1].moved <= limit:
                break
        near = [t for t in trials if not t.failed(accepted) and t.moved <= limit]
        best = min(near, key=lambda trial: trial.rank(accepted), default=best)
    return best, tuple(step for trial in trials for step in trial.history)

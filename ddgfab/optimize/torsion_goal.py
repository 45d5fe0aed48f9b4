"""Recipe torsion-free: planar faces and torsion-free upright node axes, both at once.

On a mesh as it is, torsion-free axes may have to lean far (`ddgfab.support.even_lean`). Here the
vertices move as well, by a limited distance, mostly along the surface, so that edges turn towards
the principal directions, where upright axes have no torsion. Unknown are vertices and axes; equal
to zero are the planarity of faces and det(e, a_i, a_j) of edges; wishes are the lean, the movement
and its smoothness, corner angles and edges that do not collapse. The limits of lean and movement
are soft ones of high power, so that the greatest count most; a ladder of limits is tried, from the
wanted ones upwards, and the first that all is met with is taken.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError, OptimizeError
from ddgfab.measures import planarity_percent, torsion
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.gauss_newton import Step
from ddgfab.optimize.newton import newton
from ddgfab.optimize.problem import Problem, Term, mean_edge
from ddgfab.optimize.quality import Quality, folded_faces
from ddgfab.optimize.result import OptimizeResult
from ddgfab.optimize.torsion_problem import TorsionFreeOptions, boundary_terms, terms_of
from ddgfab.optimize.torsion_terms import AXES
from ddgfab.support.even import even_lean
from ddgfab.support.structure import SupportStructure
from ddgfab.support.triangles import refuse_triangles
from ddgfab.tolerances import RELATIVE_DEGENERATE, TORSION_EXACT_DEG

LIMITS: tuple[tuple[float, float], ...] = (
    (15.0, 0.5),
    (20.0, 0.75),
    (25.0, 1.0),
    (25.0, 1.25),
    (28.0, 1.5),
    (28.0, 2.0),
)
"""Limits that are tried in turn: greatest lean [deg], greatest movement [mean edges]."""


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class TorsionFreeResult(OptimizeResult):
    """An optimised mesh with the node axes that belong to it.

    Attributes
    ----------
    axes : (V, 3) unit node axes
    tried : (lean [deg], movement [mean edges], lean reached [deg], movement reached) of each rung:
        the trade-off
    """

    axes: Floats
    tried: tuple[tuple[float, float, float, float], ...] = ()

    @property
    def support(self) -> SupportStructure:
        """The support structure of the axes on the mesh."""
        return SupportStructure.of(self.mesh, self.axes, "optimize", status=self.status)


@checked
def torsion_free(
    mesh: Mesh,
    *,
    axes_only: bool = False,
    max_lean: float | None = None,
    max_movement: float | None = None,
    fixed: Sequence[int] | Ints = (),
    boundary: str = "free",
    features: Sequence[int] | Ints | None = None,
    options: TorsionFreeOptions | None = None,
    throw: bool = True,
    progress: Callable[[str, int, Step], None] | None = None,
) -> TorsionFreeResult:
    """Planar faces and torsion-free node axes near the surface normals, vertices moving a little.

    Measured on a roof of 1,121 vertices: axes lean by 11.0 deg at most (6.4 on average) where
    vertices move by 0.38 mean edges at most (0.21); with vertices fixed by 29 deg, faces not
    planar. About 60 Newton steps, half a second each.

    Parameters
    ----------
    axes_only : vertices stay where they are and faces as they are; only axes are found
    max_lean : greatest angle [rad] between axis and vertex normal
    max_movement : greatest movement of a vertex, in the unit of the mesh. Limits that are not given
        are those of `LIMITS`, rung after rung, until all goals are met
    fixed : ids of vertices that stay where they are
    boundary : "free", "glide" along the boundary as it is (its corners stay), or "fixed"
    features : ids of edges across which the movement need not be smooth
    throw : raise when a goal is missed; otherwise the best comes back with status "missed"
    progress : called with the name of the stage, the number of the step and the step

    Returns
    -------
    TorsionFreeResult; `axes` belong to its mesh, `remarks` say what became worse

    Raises
    ------
    OptimizeError
        Torsion or planarity stays, a face folds, or a given limit is exceeded; carries the best
        result and tells lean and movement that were reached.
    SupportError
        A triangle mesh: its only torsion-free axes meet in one point (Prop. 5.2).
    DegenerateError
        A face without area.
    InputError
        A limit that is not positive, an id out of range, an unknown boundary.

    Source: Pottmann, Liu, Wallner, Bobenko, Wang 2007, Def. 5.1, section 2; mathematics.md
    10.2-10.4.
    """
    for name, value in (("max_lean", max_lean), ("max_movement", max_movement)):
        if value is not None and not value > 0:
            raise InputError(f"{name} = {value:g}: more than zero is needed")
    if (mesh.face_sizes == 3).all():
        raise refuse_triangles(mesh)
    empty = np.flatnonzero(mesh.face_areas <= RELATIVE_DEGENERATE * mesh.diameter**2)
    if len(empty):
        raise DegenerateError(
            f"face {empty[0]} has no area ({mesh.face_areas[empty[0]]:.1e}), so no plane: repair it"
        )
    chosen = options or TorsionFreeOptions()
    if axes_only:
        return _axes_only(mesh, max_lean, throw)
    centre, unit = mesh.vertices[mesh.corners].mean(axis=0), mean_edge(mesh)
    small = mesh.with_vertices((mesh.vertices - centre) / unit)
    hard, held = boundary_terms(small, fixed, boundary)
    rungs = _rungs(max_lean, None if max_movement is None else float(max_movement) / unit)
    trials: list[_Trial] = []
    for rung in rungs:
        trials.append(_attempt(small, rung, hard, held, features, chosen, progress))
        if trials[-1].good:
            break
    best = min(trials, key=lambda trial: trial.rank)
    points = best.mesh.vertices * unit + centre
    points[held] = mesh.vertices[held]
    result = TorsionFreeResult(
        goal="torsion-free",
        mesh=mesh.with_vertices(points),
        original=mesh,
        status="converged" if best.good else "missed",
        history=tuple(step for trial in trials for step in trial.history),
        residual=best.residual,
        remarks=(*_climbed(trials), *best.remarks),
        axes=best.axes,
        tried=tuple((*t.limits, *t.reached) for t in trials),
    )
    if throw and not best.good:
        raise OptimizeError(_complaint(best, trials), result=result)
    return result


def _rungs(max_lean: float | None, movement: float | None) -> list[tuple[float, float]]:
    """Limits to try: the ladder with what is given in place of its own, each once."""
    lean_deg = None if max_lean is None else float(np.degrees(max_lean))
    rungs = [
        (a if lean_deg is None else lean_deg, b if movement is None else movement)
        for a, b in LIMITS
    ]
    return list(dict.fromkeys(rungs))


@dataclass(frozen=True, eq=False)
class _Trial:
    """What came of one rung, on the mesh whose mean edge is one."""

    limits: tuple[float, float]
    mesh: Mesh
    axes: Floats
    lean: Floats
    movement: Floats
    torsion_deg: float
    planarity: Floats
    folded: Ints
    residual: float
    remarks: tuple[str, ...]
    history: tuple[tuple[str, Step], ...]
    flat_limit: float

    @property
    def exact(self) -> bool:
        """Whether axes are free of torsion and faces planar."""
        flat = bool(self.planarity.max() <= self.flat_limit)
        return flat and self.torsion_deg <= TORSION_EXACT_DEG

    @property
    def reached(self) -> tuple[float, float]:
        """Greatest lean [deg] and movement [mean edges]."""
        return float(np.degrees(self.lean.max())), float(self.movement.max())

    @property
    def excess(self) -> tuple[float, float]:
        """Lean and movement over their limits; up to one is kept."""
        return self.reached[0] / self.limits[0], self.reached[1] / self.limits[1]

    @property
    def good(self) -> bool:
        """Whether all goals are met."""
        return self.exact and not len(self.folded) and max(self.excess) <= 1

    @property
    def rank(self) -> tuple[bool, bool, int, float]:
        """The smaller the better."""
        return not self.good, not self.exact, len(self.folded), max(self.excess)


def _attempt(
    mesh: Mesh,
    limits: tuple[float, float],
    hard: tuple[Term, ...],
    held: Ints,
    features: Sequence[int] | Ints | None,
    options: TorsionFreeOptions,
    progress: Callable[[str, int, Step], None] | None,
) -> _Trial:
    """Solve one rung from the input and its vertex normals, and measure what came out."""
    stage = f"lean {limits[0]:.3g} deg, movement {limits[1]:.3g} mean edges"
    history: list[tuple[str, Step]] = []

    def tell(number: int, step: Step) -> None:
        history.append((stage, step))
        if progress is not None:
            progress(stage, number, step)

    problem = Problem.build(mesh, blocks={AXES: mesh.vertex_normals}, fixed=held)
    problem = problem.with_terms(*terms_of(mesh, problem, limits, options, features), *hard)
    found = newton(problem, options.solver, throw=False, progress=tell).value
    moved = mesh.with_vertices(problem.vertices(found))
    support = SupportStructure.of(moved, problem.layout.values(found, AXES))
    residual = max(float(np.abs(t.residual(found)).max()) for t in problem.terms if t.hard)
    return _Trial(
        limits=limits,
        mesh=moved,
        axes=support.axes,
        lean=support.lean,
        movement=np.linalg.norm(moved.vertices - mesh.vertices, axis=1),
        torsion_deg=support.torsion_deg_max,
        planarity=planarity_percent(moved) / 100,
        folded=folded_faces(moved, mesh),
        residual=residual,
        remarks=_remarks(mesh, moved, options),
        history=tuple(history),
        flat_limit=options.planarity,
    )


def _climbed(trials: list[_Trial]) -> tuple[str, ...]:
    """That limits of the ladder were not met, where a later rung was taken."""
    if len(trials) == 1:
        return ()
    first, last = trials[0].limits, trials[-1]
    return (
        f"axes within {first[0]:g} deg and movement within {first[1]:g} mean edges were not found; "
        f"these lean by up to {last.reached[0]:.1f} deg, with movement up to "
        f"{last.reached[1]:.2f} mean edges",
    )


def _remarks(before: Mesh, after: Mesh, options: TorsionFreeOptions) -> tuple[str, ...]:
    """What the mesh lost on the way."""
    was, now = (np.degrees(Quality.of(mesh).angles) for mesh in (before, after))
    slack = float(np.degrees(options.angle_slack))
    if now[0] >= was[0] - slack and now[1] <= was[1] + slack:
        return ()
    return (
        f"corner angles {now[0]:.1f} to {now[1]:.1f} deg leave the range of the input, "
        f"{was[0]:.1f} to {was[1]:.1f} deg, by more than {slack:g} deg",
    )


def _axes_only(mesh: Mesh, max_lean: float | None, throw: bool) -> TorsionFreeResult:
    """Axes on the mesh as it is, their greatest lean evened out."""
    support = even_lean(mesh)
    missed = max_lean is not None and bool(support.lean.max() > max_lean)
    result = TorsionFreeResult(
        goal="torsion-free",
        mesh=mesh,
        original=mesh,
        status="missed" if missed else "converged",
        history=(),
        residual=float(support.torsion.max()),
        axes=support.axes,
        tried=((support.lean_deg_max, 0.0, support.lean_deg_max, 0.0),),
    )
    if throw and max_lean is not None and missed:
        raise OptimizeError(
            f"torsion-free with vertices fixed: axes lean by up to {support.lean_deg_max:.1f} deg "
            f"(limit {np.degrees(max_lean):.1f}), most at vertices {_named(support.lean)}\n"
            "let the vertices move, or allow more lean",
            result=result,
        )
    return result


def _named(values: Floats) -> str:
    """The ids of the greatest values."""
    return ", ".join(map(str, np.argsort(-values, kind="stable")[:_NAMED].tolist()))


_NAMED = 5
"""How many of the worst elements a message names."""


def _complaint(best: _Trial, trials: list[_Trial]) -> str:
    """What is missed, the worst elements, and the trade-off that was found."""
    lean_deg, movement = best.limits
    lines = []
    if best.torsion_deg > TORSION_EXACT_DEG:
        angles = torsion(best.mesh, best.axes)
        lines.append(
            f"torsion stays at {best.torsion_deg:.2g} deg (limit {TORSION_EXACT_DEG:g}), most at "
            f"edges {_named(angles)}"
        )
    if best.planarity.max() > best.flat_limit:
        lines.append(
            f"faces stay {100 * best.planarity.max():.2g} % from planar (limit "
            f"{100 * best.flat_limit:.0e}), most at faces {_named(best.planarity)}"
        )
    if len(best.folded):
        lines.append(
            f"{len(best.folded)} faces fold: {', '.join(map(str, best.folded[:_NAMED].tolist()))}"
        )
    if best.excess[0] > 1:
        lines.append(
            f"axes lean by up to {best.reached[0]:.1f} deg (limit {lean_deg:.3g}), "
            f"most at vertices {_named(best.lean)}"
        )
    if best.excess[1] > 1:
        lines.append(
            f"vertices move by up to {best.reached[1]:.3g} mean edges (limit {movement:.3g}), "
            f"most at vertices {_named(best.movement)}"
        )
    trade = "; ".join(
        f"{t.reached[0]:.1f} deg with {t.reached[1]:.2f}"
        + ("" if t.exact and not len(t.folded) else " (not exact)")
        for t in trials
    )
    return (
        f"torsion-free: {'; '.join(lines)}\n"
        f"lean against movement [mean edges], as tried: {trade}\n"
        "allow more lean or movement; the best mesh reached is kept apart and not taken"
    )

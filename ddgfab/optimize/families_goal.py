"""Recipe families: fewer distinct panels or beam lengths, by moving vertices a little.

Shapes (distances between the corners of a panel, or the length of an edge) are clustered by
k-means, and vertices move so that as many pieces as possible take their cluster's shape within a
fit tolerance; both alternate. Pieces that cannot follow are let go (Geman-McClure weights), since a
piece that almost fits saves nothing. Several numbers of clusters are tried, and the mesh with the
fewest families is taken. A prototype: k-means finds a good partition, not the best.

Degrees of freedom say what to expect: a mesh with planar quads has about 2V, an edge that takes a
given length uses one, a panel that takes a given shape uses five. So nearly all edges can share
few lengths, and no more than about two panels of five can follow unless the net has repetition in
it already.

Source: Fu, Lai, He, Cohen-Or 2010, K-set tilable surfaces (idea); Geman, McClure 1987 (weights).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import cached_property, partial
from typing import TypeAlias, get_args

import numpy as np

from ddgfab.arguments import checked
from ddgfab.errors import InputError, OptimizeError
from ddgfab.measures import planarity_percent
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.energy import Keep, Weights
from ddgfab.optimize.families_result import FamiliesResult
from ddgfab.optimize.frame import Frame, element_ids
from ddgfab.optimize.goal import Additions, NetGoal, net_problem
from ddgfab.optimize.path import PathOptions, settle
from ddgfab.optimize.problem import VERTICES, Layout, Problem, Term, mean_edge
from ddgfab.optimize.quality import folded_faces
from ddgfab.optimize.repetition import (
    Clusters,
    Piece,
    Pieces,
    cluster_shapes,
    family_labels,
    pieces,
)
from ddgfab.optimize.result import Step
from ddgfab.optimize.rim import Boundary, Constraints
from ddgfab.optimize.terms import planarity_terms
from ddgfab.optimize.terms.shapes import near_shapes
from ddgfab.tolerances import NET_PLANAR_PERCENT


@dataclass(frozen=True)
class FamiliesOptions:
    """How the recipe runs; every field may be left as it is."""

    counts: tuple[float, ...] = (0.5, 0.25, 0.12, 0.06, 0.03)
    """Numbers of clusters to try, as parts of the families of the input."""
    rounds: int = 20
    """Rounds of clustering and moving for each number of clusters."""
    steps: int = 3
    """Gauss-Newton steps in a round."""
    design: float = 1e-3
    """Part of their weights that the terms of the design (`ddgfab.optimize.energy`) have at first;
    it sinks from round to round."""
    sharpest: float = 0.3
    """Pieces this part of the tolerance from their cluster's shape weigh half, in the end."""


@checked
def families(
    mesh: Mesh,
    *,
    of: Piece = "panel",
    fit_tolerance: float | None = None,
    max_movement: float | None = None,
    fixed: Sequence[int] | Ints = (),
    keep: Keep | float = "balanced",
    boundary: Boundary = "free",
    surface: Mesh | None = None,
    features: Sequence[int] | Ints | None = None,
    options: FamiliesOptions | None = None,
    throw: bool = True,
    progress: Callable[[str, int, Step], None] | None = None,
) -> FamiliesResult:
    """Fewer families of congruent panels, or of edges of one length.

    Faces that are planar stay so. Beams of a job share a part number only if their end cuts agree
    as well, which depends on node axes too: equal edges are needed for it, not enough. Measured on
    a roof of 656 panels and 1,376 beams within 1.5 mm, edges 1.5 m: 630 lengths become 62, and the
    job's beams need 344 part numbers instead of 1,049; within 7.5 mm its panels need 426 instead
    of 651.

    Parameters
    ----------
    of : "panel" or "edge"
    fit_tolerance : what counts as equal, in the unit of the mesh (see `family_labels`); by default
        a thousandth of the mean edge
    max_movement : greatest movement of a vertex, in the unit of the mesh; a tenth of the mean edge
    keep, fixed, boundary, surface, features, progress : as in `ddgfab.optimize.optimize`
    throw : raise when no mesh has fewer families; otherwise the input comes back, status "missed"

    Returns
    -------
    FamiliesResult, with the numbers of families before and after

    Raises
    ------
    OptimizeError
        No mesh within `max_movement` has fewer families than the input.
    InputError
        An unknown kind of pieces, a limit that is not positive, an id out of range.
    """
    edge = mean_edge(mesh)
    tolerance, limit = _limits(of, edge, fit_tolerance, max_movement)
    frame = Frame.of(mesh)
    small = frame.inside(mesh)
    task = _Task(
        small,
        of,
        tolerance / edge,
        limit / edge,
        keep,
        Constraints.of(small, fixed, boundary),
        None if features is None else element_ids(features, mesh.n_edges, "feature edge"),
        None if surface is None else frame.inside(surface),
        options or FamiliesOptions(),
    )
    before = family_labels(small, of, task.tolerance)
    best, labels, history = _fewest(task, before, progress)
    missed = best is small
    result = FamiliesResult(
        goal="families",
        mesh=mesh if missed else frame.outside(small.vertices, best.vertices),
        original=mesh,
        status="missed" if missed else "converged",
        history=history,
        residual=task.residual(best.vertices.ravel()),
        surface=surface,
        of=of,
        tolerance=tolerance,
        labels_before=before,
        labels=labels,
    )
    if missed and throw:
        raise OptimizeError(_none_found(result, limit), result=result)
    return result


def _none_found(result: FamiliesResult, limit: float) -> str:
    """What is missed, and what to do about it."""
    return (
        f"families: the {len(result.labels_before)} {result.of}s have {result.families_before} "
        f"families within {result.tolerance:.3g}, and no mesh with fewer was found that moves "
        f"vertices by {limit:.3g} at most\nallow more movement or a greater fit tolerance"
    )


def _limits(
    of: str, edge: float, fit_tolerance: float | None, max_movement: float | None
) -> tuple[float, float]:
    """Fit tolerance and greatest movement; raises for what cannot be asked."""
    tolerance = edge * _TOLERANCE if fit_tolerance is None else fit_tolerance
    limit = edge * _MOVEMENT if max_movement is None else max_movement
    if of not in get_args(Piece):
        raise InputError(f'families of "{of}"; one of {", ".join(get_args(Piece))}')
    for name, value in (("fit_tolerance", tolerance), ("max_movement", limit)):
        if not value > 0:
            raise InputError(f"{name} = {value:g}: more than zero is needed")
    return tolerance, limit


def _fewest(
    task: _Task, before: Ints, progress: Callable[[str, int, Step], None] | None
) -> tuple[Mesh, Ints, tuple[tuple[str, Step], ...]]:
    """The mesh with the fewest families of all numbers of clusters tried, its labels, all steps.

    It is the mesh of the task itself where none has fewer.
    """
    best, labels, history = task.mesh, before, list[tuple[str, Step]]()
    groups = len(np.unique(before))
    counts = dict.fromkeys(max(1, round(part * groups)) for part in task.options.counts)
    for count in counts if groups > 1 else ():

        def record(number: int, step: Step, stage: str = f"{count} clusters") -> None:
            history.append((stage, step))
            if progress is not None:
                progress(stage, number, step)

        found = _moved(task, count, record)
        if found is None:
            continue
        now = family_labels(found, task.of, task.tolerance)
        if len(np.unique(now)) < len(np.unique(labels)):
            best, labels = found, now
    return best, labels, tuple(history)


_TOLERANCE = 1e-3
"""Fit tolerance by default, in mean edges."""

_MOVEMENT = 0.1
"""Greatest movement by default, in mean edges."""

_EXACT = 1e-10
"""Residual of planarity and of gliding that a result may keep."""


_Shapes: TypeAlias = tuple[Pieces, Clusters, Floats]
"""Pieces of one kind, their clusters, and how far each is from what its cluster asks."""


@dataclass(frozen=True, eq=False)
class _Task:
    """What to do on a mesh whose mean edge is one."""

    mesh: Mesh
    of: Piece
    tolerance: float
    limit: float
    keep: Keep | float
    constraints: Constraints
    features: Ints | None
    surface: Mesh | None
    options: FamiliesOptions

    @cached_property
    def equations(self) -> tuple[Term, ...]:
        """Faces that are planar stay so."""
        flat = np.flatnonzero(planarity_percent(self.mesh) <= NET_PLANAR_PERCENT)
        return planarity_terms(self.mesh, flat)

    def problem(
        self, weights: Callable[[Weights], Weights], shapes: Sequence[_Shapes], width: float
    ) -> Problem:
        """The frame of all goals, with pieces near their shapes, which are unknown as well."""

        def additions(mesh: Mesh, layout: Layout) -> Additions:
            return Additions(
                tuple(
                    near_shapes(group, found, layout.block(f"shapes {k}").start, away, width)
                    for k, (group, found, away) in enumerate(shapes)
                )
            )

        goal = NetGoal(
            "families",
            lambda mesh, layout: self.equations,
            0.0,
            "Fu, Lai, He, Cohen-Or 2010",
            weights=weights,
            blocks=lambda mesh: {f"shapes {k}": s[1].shapes for k, s in enumerate(shapes)},
            additions=additions,
        )
        return net_problem(
            self.mesh,
            goal,
            keep=self.keep,
            constraints=self.constraints,
            surface=self.surface,
            features=self.features,
            movement=self.limit,
        )

    def residual(self, x: Floats) -> float:
        """Greatest residual of the equations."""
        return max(
            (float(np.abs(t.residual(x)).max(initial=0.0)) for t in self.equations), default=0.0
        )


def _moved(task: _Task, count: int, record: Callable[[int, Step], None]) -> Mesh | None:
    """The mesh moved towards some number of shapes; None where a limit is not kept."""
    mesh, options = task.mesh, task.options
    groups = pieces(mesh, task.of)
    total = sum(len(group.ids) for group in groups)
    points, sharpest, width = mesh.vertices, options.sharpest * task.tolerance, np.inf
    for left in reversed(range(options.rounds)):
        clusters = [
            cluster_shapes(
                group.distances(points),
                group.turns,
                min(len(group.ids), max(1, round(count * len(group.ids) / total))),
            )
            for group in groups
        ]
        away = [
            np.abs(group.distances(points) - found.targets).max(axis=1)
            for group, found in zip(groups, clusters, strict=True)
        ]
        width = min(width, _WIDE * max(task.limit, *(float(far.max()) for far in away)))
        done = 1 - left / options.rounds
        if done > 1 / 2:  # until then all pieces count
            width = max(sharpest, width * (sharpest / width) ** (1 / max(left, 1)))
        part = options.design * _LEAST_DESIGN ** min(1.0, 2 * done)
        shapes = list(zip(groups, clusters, away, strict=True))
        problem = task.problem(partial(_scaled, part=part), shapes, width)
        start = problem.start.copy()
        start[problem.layout.block(VERTICES)] = points.ravel()
        rough = PathOptions(tolerance=_ROUGH if left else _EXACT, steps_per_stage=options.steps)
        points = problem.vertices(settle(problem.with_start(start), _STIFF, rough, record).value)
    found = mesh.with_vertices(points)
    movement = np.linalg.norm(points - mesh.vertices, axis=1)
    kept = movement.max() <= task.limit and task.residual(points.ravel()) <= _EXACT
    return found if kept and not len(folded_faces(found, mesh)) else None


def _scaled(weights: Weights, part: float) -> Weights:
    """All weights times a part, but for a boundary that glides."""
    scaled = {f.name: part * getattr(weights, f.name) for f in fields(weights)}
    if weights.rim > _GLIDES:
        scaled["rim"] = weights.rim
    return Weights(**scaled)


_LEAST_DESIGN = 1e-5
"""Part of their weights that the terms of the design keep to the end; less bias than rounding."""

_GLIDES = 1e3
"""Boundaries of more weight glide."""

_STIFF = 1e4
"""Penalty of the equations while pieces move."""

_WIDE = 3.0
"""Pieces up to this many times the greatest distance from the shapes weigh much, at first."""

_ROUGH = 1e-8
"""Residual of the equations within a round."""

"""What a goal is: equations, and what else it asks of a mesh, on the energy that keeps a design."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from ddgfab.measures import planarity_percent
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.barriers import barriers
from ddgfab.optimize.energy import Keep, Weights, energy
from ddgfab.optimize.problem import Barrier, Following, Layout, Problem, Term
from ddgfab.optimize.result import OptimizeResult
from ddgfab.optimize.rim import Constraints
from ddgfab.optimize.terms.cover import Covered
from ddgfab.optimize.terms.nearness import NearRim, NearSurface
from ddgfab.optimize.terms.planarity import Planarity
from ddgfab.optimize.within import movement_within

EXACT: Final = 1e-10
"""Violation of the goals that are met exactly."""


@dataclass(frozen=True, eq=False)
class Additions:
    """What a goal adds to the energy: soft terms, soft terms that follow the mesh, barriers."""

    terms: tuple[Term, ...] = ()
    following: tuple[Following, ...] = ()
    barriers: tuple[Barrier, ...] = ()


def _nothing(mesh: Mesh, layout: Layout) -> Additions:
    return Additions()


@dataclass(frozen=True, eq=False)
class NetGoal:
    """A goal: a name, equations, and what belongs to them. Meshes here have mean edge one.

    Attributes
    ----------
    equations : mesh, layout -> terms that are all hard
    flat_percent : violation that is met by default [%]
    source : where it is defined
    crooked : mesh -> faces that do not count as met although the equations hold (whose angles
        balance because a corner is reflex)
    label : stage of the history; the name by default
    check : raises where a mesh cannot meet the goal at all
    weights : weights of the energy -> those of this goal
    still : vertices stay; only the other unknowns are found
    blocks : mesh -> (count, width) first values of unknowns besides the vertices, by name
    additions : mesh, layout -> what the energy also has
    result : what is made of the fields of an `OptimizeResult` and those of `own`
    own : problem, unknowns found -> further fields of the result
    easier : an option, name and value, that asks less; None: there is none
    """

    name: str
    equations: Callable[[Mesh, Layout], Iterable[Term]]
    flat_percent: float
    source: str
    crooked: Callable[[Mesh], Ints] | None = None
    label: str = ""
    check: Callable[[Mesh], None] = lambda mesh: None
    weights: Callable[[Weights], Weights] = lambda weights: weights
    still: bool = False
    blocks: Callable[[Mesh], Mapping[str, Floats]] = lambda mesh: {}
    additions: Callable[[Mesh, Layout], Additions] = _nothing
    result: Callable[..., OptimizeResult] = OptimizeResult
    own: Callable[[Problem, Floats], Mapping[str, Any]] = lambda problem, x: {}
    easier: tuple[str, object] | None = None

    @property
    def tolerance(self) -> float:
        """Violation that is met by default."""
        return max(self.flat_percent / 100, EXACT)


def planarity_of(problem: Problem, x: Floats) -> tuple[Ints, Floats]:
    """Faces that the equations make planar, and how far each is from a plane [%]."""
    asked = [t.elements for t in problem.terms if t.hard and isinstance(t, Planarity)]
    faces = np.unique(np.concatenate([e for e in asked if e is not None] or [np.zeros(0, int)]))
    if not len(faces):
        return faces, np.zeros(0)
    return faces, planarity_percent(problem.mesh.with_vertices(problem.vertices(x)))[faces]


def violation(problem: Problem, x: Floats) -> float:
    """How far unknowns are from a goal: planarity, or the greatest residual where it is more."""
    flat = float(planarity_of(problem, x)[1].max(initial=0.0)) / 100
    hard = (t.residual(x) for t in problem.terms if t.hard)
    return max(flat, *(float(np.abs(r).max(initial=0.0)) for r in hard), 0.0)


def weights_of(mesh: Mesh, goal: NetGoal, keep: Keep | float, constraints: Constraints) -> Weights:
    """Weights of the energy of a goal on a mesh whose mean edge is one."""
    return goal.weights(Weights.of(mesh, keep, glide=constraints.glide))


def net_problem(
    mesh: Mesh,
    goal: NetGoal,
    *,
    keep: Keep | float = "balanced",
    constraints: Constraints | None = None,
    surface: Mesh | None = None,
    features: Ints | None = None,
    movement: float | None = None,
    extra: Sequence[Term] = (),
    wishes: Sequence[Following] = (),
    rim: Mesh | None = None,
    weights: Weights | None = None,
) -> Problem:
    """Energy, barriers and equations of a goal on a mesh whose mean edge is one.

    Parameters
    ----------
    surface : to stay near to; the mesh itself by default
    movement : greatest of a vertex, in mean edges
    extra, wishes : further soft terms on the vertices, and such that follow them
    rim : whose boundary that of the mesh stays near to; the mesh itself by default
    weights : of the energy; those for the mesh by default, see `weights_of`
    """
    given = constraints or Constraints(np.zeros(0, dtype=np.int64), glide=False)
    fixed = np.arange(mesh.n_vertices) if goal.still else given.fixed
    problem = Problem.build(mesh, blocks=goal.blocks(mesh), fixed=fixed)
    if weights is None:
        weights = weights_of(mesh, goal, keep, given)
    kept = energy(mesh, weights, surface, features, rim)
    following: list[Following] = [t for t in kept if isinstance(t, NearSurface | Covered | NearRim)]
    soft: list[Term] = [t for t in kept if not isinstance(t, NearSurface | Covered | NearRim)]
    additions = goal.additions(mesh, problem.layout)
    bounds = [*barriers(mesh), *additions.barriers]
    if movement is not None:
        bounds.append(movement_within(mesh, problem.layout, movement))
    terms = (*soft, *extra, *additions.terms, *goal.equations(mesh, problem.layout))
    return replace(
        problem.with_terms(*terms),
        following=(*following, *additions.following, *wishes),
        barriers=tuple(bounds),
    )

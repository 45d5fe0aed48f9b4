"""optimize: a recipe by the name of its goal, with the limits that every goal shares."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Literal, TypeAlias, get_args

import numpy as np

from ddgfab.errors import InputError, OptimizeError
from ddgfab.measures import dihedral_angles
from ddgfab.mesh import Ints, Mesh
from ddgfab.optimize.families import families
from ddgfab.optimize.recipes import Boundary, circularize, conicalize, planarize
from ddgfab.optimize.result import OptimizeResult
from ddgfab.optimize.solve import Step
from ddgfab.optimize.torsion_free import torsion_free
from ddgfab.optimize.trials import RecipeOptions

Goal: TypeAlias = Literal["planar", "circular", "conical", "torsion-free", "families"]
"""What a mesh can be made: planar faces, a circular net, a conical net, planar faces with upright
torsion-free node axes, fewer families of congruent pieces."""

_RECIPES: dict[str, Callable[..., OptimizeResult]] = {
    "planar": planarize,
    "circular": circularize,
    "conical": conicalize,
    "torsion-free": torsion_free,
    "families": families,
}

_AIMS_AT_MOVEMENT = ("torsion-free", "families")
"""Recipes that take the greatest movement as a goal of their own."""


def optimize(
    mesh: Mesh,
    goal: Goal = "planar",
    *,
    fixed: Sequence[int] | Ints = (),
    boundary: Boundary = "free",
    feature_angle: float | None = None,
    max_movement: float | None = None,
    throw: bool = True,
    progress: Callable[[str, int, Step], None] | None = None,
    **options: Any,
) -> OptimizeResult:
    """Optimise a mesh towards a goal, close to where it is.

    Parameters
    ----------
    goal : "planar", "circular", "conical", "torsion-free", "families"
    fixed : ids of vertices that stay
    boundary : "free", "glide" along itself, or "fixed"
    feature_angle : edges whose faces meet at a larger angle [rad] are features, across which the
        surface need not stay smooth
    max_movement : greatest movement of a vertex, in the unit of the mesh
    throw : raise when the goal is missed; otherwise the best mesh comes back with its status
    progress : called with the name of the stage, the number of the step and the step
    options : what the goal's own recipe takes besides, for instance ``max_lean`` [rad] and
        ``axes_only`` of "torsion-free", ``of`` and ``fit_tolerance`` of "families"

    Raises
    ------
    OptimizeError
        The goal is missed, or only met by moving further than `max_movement`; names the worst
        elements and carries the best mesh as `result`.
    InputError
        An unknown goal, an id out of range, a limit that is not positive.

    Source: the recipe's own: `planarize`, `circularize`, `conicalize`, `torsion_free`, `families`.
    """
    if goal not in _RECIPES:
        raise InputError(f'goal "{goal}" is unknown; one of {", ".join(get_args(Goal))}')
    if max_movement is not None and not max_movement > 0:
        raise InputError(f"max_movement = {max_movement:g}: more than zero is needed")
    features = None
    if feature_angle is not None:
        sharp = np.abs(dihedral_angles(mesh)) > feature_angle
        features = np.flatnonzero(sharp & ~mesh.boundary_edge)
    if goal in _AIMS_AT_MOVEMENT:
        options["max_movement"] = max_movement
    elif "options" not in options:
        options["options"] = RecipeOptions(max_movement=max_movement)
    result = _RECIPES[goal](
        mesh,
        fixed=fixed,
        boundary=boundary,
        features=features,
        throw=throw,
        progress=progress,
        **options,
    )
    if throw and max_movement is not None and result.movement_max > max_movement:
        worst = np.argsort(-result.movement, kind="stable")[:3]
        named = ", ".join(f"{v} ({result.movement[v]:.4g})" for v in worst)
        raise OptimizeError(
            f'goal "{goal}" moves vertices by up to {result.movement_max:.4g}, the limit is '
            f"{max_movement:.4g}; furthest: {named}\n"
            "allow more movement, or change the design where it is furthest from the goal\n"
            "the best mesh reached is kept apart and not taken",
            result=result,
        )
    return result

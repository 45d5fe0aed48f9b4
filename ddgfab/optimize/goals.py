"""The goals of `optimize`, a line each, and the one entry to all of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, Final, Literal, TypeAlias, get_args

import numpy as np

from ddgfab.arguments import checked
from ddgfab.errors import InputError, OptimizeError
from ddgfab.measures import dihedral_angles
from ddgfab.mesh import Ints, Mesh
from ddgfab.optimize.energy import Keep
from ddgfab.optimize.families_goal import families
from ddgfab.optimize.forecast import forecast_of
from ddgfab.optimize.frame import Frame
from ddgfab.optimize.limits import Limits, named
from ddgfab.optimize.nets import NetGoal, StageProgress, net_problem, reach
from ddgfab.optimize.panes import with_panes
from ddgfab.optimize.result import Forecast, OptimizeResult
from ddgfab.optimize.rim import Boundary
from ddgfab.optimize.terms import (
    circularity_terms,
    cone_terms,
    conicality_terms,
    planarity_terms,
)
from ddgfab.optimize.torsion_goal import torsion_free

FLAT_PERCENT: Final = 0.2
"""How flat faces are made by default: what a pane of glass takes up."""

PLANAR: Final = NetGoal(
    "planar",
    lambda m: (*planarity_terms(m),),
    FLAT_PERCENT,
    "Liu, Pottmann, Wallner, Yang, Wang 2006, section 3; mathematics.md 8.5",
)
CIRCULAR: Final = NetGoal(
    "circular",
    lambda m: (*planarity_terms(m), *circularity_terms(m)),
    0.0,
    "Bobenko, Suris, Discrete Differential Geometry, 3.1; mathematics.md 2",
    convex=True,
)
CONICAL: Final = NetGoal(
    "conical",
    lambda m: (*planarity_terms(m), *conicality_terms(m), *cone_terms(m)),
    0.0,
    "Liu, Pottmann, Wallner, Yang, Wang 2006, section 4; mathematics.md 2.9",
    convex=True,
)

NET_GOALS: Final[dict[str, NetGoal]] = {g.name: g for g in (PLANAR, CIRCULAR, CONICAL)}
"""Goals that are equations on the vertices: a new one is a term and a line here."""

OTHER_GOALS: Final[dict[str, Callable[..., OptimizeResult]]] = {
    "torsion-free": torsion_free,
    "families": families,
}
"""Goals that find something besides the vertices."""

Goal: TypeAlias = Literal["planar", "circular", "conical", "torsion-free", "families"]
"""What a mesh can be made: planar faces, a circular net, a conical net, planar faces with upright
torsion-free node axes, fewer families of congruent pieces."""


@checked
def optimize(
    mesh: Mesh,
    goal: Goal = "planar",
    *,
    flat: float | None = None,
    keep: Keep | float = "balanced",
    fixed: Sequence[int] | Ints = (),
    boundary: Boundary = "free",
    surface: Mesh | None = None,
    feature_angle: float | None = None,
    max_movement: float | None = None,
    distance_limit: tuple[float, float] | None = None,
    rise_limit: float = Limits.rise,
    zigzag_limit: float = Limits.zigzag,
    max_pane: tuple[float, float] | None = None,
    throw: bool = True,
    progress: StageProgress | None = None,
    **options: Any,
) -> OptimizeResult:
    """Optimize a mesh towards a goal, as near to its surface as possible and without folds.

    Parameters
    ----------
    mesh : Mesh
    goal : "planar", "circular", "conical", "torsion-free", "families"
    flat : float, optional
        How far faces may be from planar [%, distance of the diagonals over their mean]; by default
        0.2 for "planar", 0 (exact) for the others. For circular and conical nets angles may be off
        by the same part of a radian.
    keep : "close", "balanced", "fair" or a number
        What a design keeps rather: its surface, or smooth faces. A number is the wavelength from
        which distance costs more than bending, as part of the width of the mesh (0.2, 0.33, 0.5).
    fixed : ids of vertices that stay
    boundary : "free", "glide" along itself, or "fixed"
    surface : Mesh, optional
        What to stay near to; the mesh itself by default.
    feature_angle : float, optional
        Edges whose faces meet at a larger angle [rad] are features, across which the movement need
        not be smooth.
    max_movement : float, optional
        Greatest movement of a vertex, in the unit of the mesh.
    distance_limit : (mean, greatest), optional
        Greatest distances between result and surface, both ways, in mean edges: (0.25, 1.0).
    rise_limit : least part of its rise that the mesh keeps; 0 allows all to go
    zigzag_limit : by how much more than before bends at edges may differ from those beside them
        [rad, root mean square]
    max_pane : (shorter, longer), optional
        Lengths of the largest pane, in the unit of the mesh: quads are divided until they fit, and
        stay so; vertices keep their numbers, new ones follow.
    throw : raise when the goal is missed; otherwise the best mesh comes back with its status
    progress : called with the name of the stage, the number of the step and the step
    options : what "torsion-free" (``max_lean`` [rad], ``axes_only``) and "families" (``of``,
        ``fit_tolerance``) take besides

    Returns
    -------
    OptimizeResult

    Raises
    ------
    OptimizeError
        The goal is missed, a face cannot be planar, or a limit is exceeded; names the worst
        elements, carries the best mesh as `result` and says what to try next.
    InputError
        An unknown goal or option, an id out of range, a limit that is not positive.

    Source: planar quads: Liu, Pottmann, Wallner, Yang, Wang 2006; the others name theirs.
    """
    if goal not in get_args(Goal):
        raise InputError(f'goal "{goal}" is unknown; one of {", ".join(get_args(Goal))}')
    allowed = Limits(movement=max_movement, rise=rise_limit, zigzag=zigzag_limit, pane=max_pane)
    if distance_limit is not None:
        mean, most = distance_limit
        allowed = replace(allowed, distance_mean=mean, distance_max=most)
    if goal in NET_GOALS:

        def run(one: Mesh, throw: bool) -> OptimizeResult:
            return reach(
                one,
                NET_GOALS[goal],
                flat_percent=flat,
                keep=keep,
                fixed=fixed,
                boundary=boundary,
                features=_features(one, feature_angle),
                surface=surface,
                limits=allowed,
                throw=throw,
                progress=progress,
                **options,
            )

        if max_pane is None:
            return run(mesh, throw)
        try:
            return with_panes(mesh, max_pane, lambda one: run(one, True))
        except OptimizeError as error:
            if throw or not isinstance(error.result, OptimizeResult):
                raise
            return error.result
    if max_pane is not None:
        raise InputError(f'max_pane is for goals {", ".join(NET_GOALS)}, not for "{goal}"')
    features = _features(mesh, feature_angle)
    result = OTHER_GOALS[goal](
        mesh,
        fixed=fixed,
        boundary=boundary,
        features=features,
        max_movement=max_movement,
        throw=throw,
        progress=progress,
        **options,
    )
    if throw and max_movement is not None and result.movement_max > max_movement:
        raise OptimizeError(
            f'goal "{goal}" moves vertices by up to {result.movement_max:.4g} (limit '
            f"{max_movement:.4g}), most at vertices {named(result.movement)}\n"
            "allow more movement, or change the design where it is farthest from the goal",
            result=result,
        )
    return result


def _features(mesh: Mesh, angle: float | None) -> Ints | None:
    """Edges whose faces meet at a larger angle [rad]."""
    if angle is None:
        return None
    sharp = np.abs(dihedral_angles(mesh)) > angle
    return np.flatnonzero(sharp & ~mesh.boundary_edge)


@checked
def expected(mesh: Mesh) -> Forecast | None:
    """What planar faces of a mesh will cost, from one linear solve; None where they are planar.

    Raises
    ------
    DegenerateError
        The system is singular, as on meshes with faces without area.
    """
    frame = Frame.of(mesh)
    small = frame.inside(mesh)
    if PLANAR.violation(small, small.vertices.ravel()) <= PLANAR.tolerance:
        return None
    return forecast_of(net_problem(small, PLANAR), frame.unit, small.vertex_normals)

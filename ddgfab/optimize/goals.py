"""The goals of `optimize`, a line each, and the one entry to all of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Final, Literal, TypeAlias

from ddgfab.arguments import checked
from ddgfab.errors import InputError, OptimizeError
from ddgfab.mesh import Ints, Mesh
from ddgfab.optimize.asked import Asked, features
from ddgfab.optimize.diagonals import diagonal_net
from ddgfab.optimize.energy import Keep
from ddgfab.optimize.families_goal import families
from ddgfab.optimize.goal import NetGoal
from ddgfab.optimize.limits import Limits, named
from ddgfab.optimize.net_goals import CIRCULAR, CONICAL, PLANAR
from ddgfab.optimize.nets import StageProgress
from ddgfab.optimize.result import OptimizeResult
from ddgfab.optimize.rim import Boundary
from ddgfab.optimize.torsion_goal import torsion_free
from ddgfab.optimize.wishes import EQUAL_WEIGHT, Wishes

GOALS: Final[dict[str, Callable[..., Sequence[NetGoal]]]] = {
    "planar": lambda: [PLANAR],
    "circular": lambda: [CIRCULAR],
    "conical": lambda: [CONICAL],
    "torsion-free": torsion_free,
}
"""Own options of a goal -> goals to try in turn until one is met within the limits. A new goal is a
term and a line here."""

OTHER_GOALS: Final[dict[str, Callable[..., OptimizeResult]]] = {"families": families}
"""Goals that have a solver of their own."""

Goal: TypeAlias = Literal["planar", "circular", "conical", "torsion-free", "families"]
"""What a mesh can be made: planar faces, a circular net, a conical net, planar faces with upright
torsion-free node axes, fewer families of congruent pieces."""


@checked
def optimize(
    mesh: Mesh,
    goal: Goal | NetGoal = "planar",
    *,
    flat: float | None = None,
    keep: Keep | float = "balanced",
    fixed: Sequence[int] | Ints = (),
    boundary: Boundary = "free",
    surface: Mesh | None = None,
    rim: Mesh | None = None,
    feature_angle: float | None = None,
    max_movement: float | None = None,
    distance_limit: tuple[float, float] | None = None,
    rise_limit: float = Limits.rise,
    zigzag_limit: float = Limits.zigzag,
    stretch_limit: float = Limits.stretch,
    max_pane: tuple[float, float] | None = None,
    diagonals: bool = False,
    equal_edges: int = 0,
    equal_panels: int = 0,
    equal_weight: float = EQUAL_WEIGHT,
    throw: bool = True,
    progress: StageProgress | None = None,
    **options: Any,
) -> OptimizeResult:
    """Optimize a mesh towards a goal, as near to its surface as possible and without folds.

    Parameters
    ----------
    mesh : Mesh
    goal : "planar", "circular", "conical", "torsion-free", "families", or a goal of your own
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
    rim : Mesh, optional
        Whose boundary that of the mesh stays near to, as that of a surface that was traced; the
        mesh itself by default.
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
    stretch_limit : part by which edges may become longer or shorter, but for one in twenty each way
    max_pane : (shorter, longer), optional
        Lengths of the largest pane, in the unit of the mesh: quads are divided until they fit, and
        stay so; vertices keep their numbers, new ones follow.
    diagonals : optimize the net of the diagonals of the mesh (`diagonal_net`) instead, near the
        mesh and its boundary; vertices keep their numbers
    equal_edges, equal_panels : number of lengths, or of shapes, that edges or panels are drawn to;
        a soft wish, whose price in distance is found by a second run without it and told in the
        `wishes` of the result. 0: none
    equal_weight : of these wishes, against the distance from the surface, which has 1
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
    if diagonals:
        surface = mesh if surface is None else surface
        rim = mesh if rim is None else rim
        mesh = diagonal_net(mesh)
    wishes = Wishes(equal_edges, equal_panels, equal_weight)
    if isinstance(goal, str) and goal in OTHER_GOALS:
        _refuse(goal, max_pane=max_pane is not None, equal_edges=bool(wishes))
        result = OTHER_GOALS[goal](
            mesh,
            keep=keep,
            fixed=fixed,
            boundary=boundary,
            surface=surface,
            features=features(mesh, feature_angle),
            max_movement=max_movement,
            throw=throw,
            progress=progress,
            **options,
        )
        return _within(result, max_movement, throw)
    asked = Asked(
        goals=_goals(goal, options),
        flat=flat,
        keep=keep,
        fixed=fixed,
        boundary=boundary,
        surface=surface,
        rim=rim,
        feature_angle=feature_angle,
        limits=Limits.given(
            distance_limit,
            movement=max_movement,
            rise=rise_limit,
            zigzag=zigzag_limit,
            stretch=stretch_limit,
            pane=max_pane,
        ),
        wishes=wishes,
        progress=progress,
    )
    try:
        return asked.result(mesh)
    except OptimizeError as error:
        if throw or not isinstance(error.result, OptimizeResult):
            raise
        return error.result


def _refuse(goal: str, **given: bool) -> None:
    """Raise for options that a goal with a solver of its own does not have."""
    for name in (name for name, there in given.items() if there):
        raise InputError(f'{name} is for goals {", ".join(GOALS)}, not for "{goal}"')


def _within(result: OptimizeResult, limit: float | None, throw: bool) -> OptimizeResult:
    """The result of a goal with a solver of its own, if it keeps the limit of movement."""
    if throw and limit is not None and result.movement_max > limit:
        raise OptimizeError(
            f'goal "{result.goal}" moves vertices by up to {result.movement_max:.4g} (limit '
            f"{limit:.4g}), most at vertices {named(result.movement)}\n"
            "allow more movement, or change the design where it is farthest from the goal",
            result=result,
        )
    return result


def _goals(goal: str | NetGoal, options: dict[str, Any]) -> Sequence[NetGoal]:
    """The goals to try in turn."""
    if isinstance(goal, NetGoal):
        if options:
            raise InputError(f'option "{next(iter(options))}" is of no use with a goal of its own')
        return [goal]
    if goal not in GOALS:
        raise InputError(f'goal "{goal}" is unknown; one of {", ".join((*GOALS, *OTHER_GOALS))}')
    return GOALS[goal](**options)

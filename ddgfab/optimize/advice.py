"""What a missed goal misses, and what to try next; what else the reader of a result should know."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from ddgfab.measures import not_a_disk
from ddgfab.mesh import Floats
from ddgfab.optimize.directions import (
    DIAGONALS,
    DIAGONALS_REASON,
    TRACE,
    TRACE_REASON,
    accepted,
    other_way,
)
from ddgfab.optimize.energy import Keep, Weights
from ddgfab.optimize.forecast import doubtful, forecast_text
from ddgfab.optimize.frame import Frame
from ddgfab.optimize.goal import planarity_of
from ddgfab.optimize.limits import Limits, ids
from ddgfab.optimize.pane_size import misfit
from ddgfab.optimize.problem import Problem
from ddgfab.optimize.result import OptimizeResult
from ddgfab.optimize.rim import Boundary
from ddgfab.optimize.terms.planarity import Planarity

_CLOSEST: Final = 0.1
"""What to keep where "close" is too far from the surface: shorter waves crease as well."""
_HELD: Final = 0.8
"""A mesh that moved by more than this part of the limit of movement is held back by it."""
_ACCEPT: Final = (
    "edges like these crease or flatten faces near this surface, and only a mesh of one piece with "
    "one boundary can be traced anew (ddgfab optimize --retrace): cut it open, or accept this"
)
SOFTER: Final = "equal_weight"
"""Name of the advice to wish less for equal pieces."""
_CREASED_DEG: Final = 20.0
"""Changes of dihedral angles [deg] that people see."""


def missed_text(name: str, problem: Problem, x: Floats, tolerance: float) -> str:
    """By how much the equations are missed, and where."""
    faces, flat = planarity_of(problem, x)
    texts = []
    if flat.max(initial=0.0) > 100 * tolerance:
        worst = np.argsort(-flat, kind="stable")[:5]
        names = ", ".join(f"{faces[f]} ({flat[f]:.2g})" for f in worst.tolist())
        texts.append(
            f"faces stay {flat.max():.2g} % from planar (limit {100 * tolerance:.2g} %), "
            f"{int((flat > 100 * tolerance).sum())} of {len(faces)} faces, worst {names}"
        )
    for term in problem.terms:
        if not term.hard or isinstance(term, Planarity):
            continue
        values = np.abs(term.residual(x))
        if values.max(initial=0.0) > tolerance:
            elements = np.asarray(getattr(term, "elements", np.arange(len(values))))
            worst = elements[np.argsort(-values, kind="stable")[:5]]
            texts.append(
                f"{term.name} stays at {np.degrees(values.max()):.2g} deg (limit "
                f"{np.degrees(tolerance):.2g}), worst {getattr(term, 'of', 'row')} {ids(worst)}"
            )
    return "; ".join(texts) or f"{name} is missed"


def advice_of(
    result: OptimizeResult,
    met: bool,
    keep: Keep | float,
    boundary: Boundary,
    limits: Limits,
    easier: tuple[str, object] | None = None,
) -> tuple[tuple[str, object], ...]:
    """Options to try next: what holds the goal back first.

    Parameters
    ----------
    easier : option of the goal that asks less of a mesh
    """
    if boundary == "fixed" or (boundary == "glide" and not met):
        return (("boundary", "free"),)
    if not met and limits.movement is not None and result.movement_max > _HELD * limits.movement:
        return (("max_movement", float(f"{2 * limits.movement:.2g}")),)
    if not met and easier is not None:
        return (easier,)
    if not met:
        folded = "folded" in limits.kinds(result.change)
        return other_way(result, keep, limits) or (() if folded else _flatter(result))
    if limits.kinds(result.change) == {"pane"}:
        size = np.multiply(limits.pane or (), misfit(result.mesh, limits.pane or (1, 1)).max())
        return (("max_pane", tuple(float(f"{1.01 * v:.3g}") for v in size)),)
    if "stretch" in limits.kinds(result.change) and easier is not None:
        return (easier,)
    if way := other_way(result, keep, limits):
        return way
    if keep != "close" and not (isinstance(keep, float | int) and keep <= 0.2):
        return (("keep", "close"),)
    if easier is not None:
        return (easier,)
    small = Frame.of(result.original).inside(result.original)
    fair = [Weights.of(small, k).fair for k in (keep, _CLOSEST)]
    if fair[1] < 0.5 * fair[0]:
        return (("keep", _CLOSEST),)
    if not limits.kinds(result.change):  # reflex corners that the goal does not allow
        return ()
    edge = result.change.edge
    finest = result.prices[-1] if result.prices else None
    for price in reversed(result.prices):
        near = price.distance_mean < 0.9 * limits.distance_mean * edge
        near &= price.distance_max < 0.9 * limits.distance_max * edge
        # A step that is hardly nearer than the result would miss the same limit again.
        nearer = finest is not None and price.distance_max < 0.9 * finest.distance_max
        if near and nearer and price.percent < 5:
            return (("flat", float(f"{1.05 * price.percent:.2g}")),)
    return accepted(result, limits)


def _flatter(result: OptimizeResult) -> tuple[tuple[str, object], ...]:
    """As flat as faces have become, and half as much to spare."""
    best = min((price.percent for price in result.prices), default=0.0)
    return (("flat", float(f"{1.5 * best:.2g}")),) if best else ()


def remarks_of(result: OptimizeResult) -> tuple[str, ...]:
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
        disk = not not_a_disk(result.original)
        told = forecast_text(result.forecast, "mm", traceable=disk)
        out.append(told.removeprefix("planar faces: "))
    return tuple(out)


def complaint(result: OptimizeResult, missed: Sequence[str]) -> str:
    """The message of a missed goal: what is missed, prices, what to try."""
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
        DIAGONALS: DIAGONALS_REASON,
        TRACE: TRACE_REASON,
        SOFTER: "the goal is met without the wish for equal pieces; wish less for it",
        "max_lean": "let the node axes lean further",
        "max_movement": "let vertices move further",
        "distance_limit": "let the edges follow other directions, use a finer mesh, or allow it",
        **dict.fromkeys(("rise_limit", "zigzag_limit", "stretch_limit"), _ACCEPT),
    }.get(name, "try")
    if name == DIAGONALS:
        return reason
    if name == TRACE:
        return f"{reason}, spacing = {value:g}"
    if name in ("max_lean", "zigzag_limit") and isinstance(value, float):
        return f"{reason}: {name} = {np.degrees(value):.3g} deg"
    shown = f'"{value}"' if isinstance(value, str) else value
    return f"{reason}: {name} = {shown}"

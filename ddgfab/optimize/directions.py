"""Where the edges of a mesh are the fault: results that are crumpled or flattened, and what helps.

Planar faces near a surface need edges along conjugate directions. Where a net does not follow them,
keeping the surface crumples it and keeping it smooth flattens it; then only another net helps: that
of its diagonals, where these are conjugate, or one that is traced.
"""

from __future__ import annotations

from typing import Final

from ddgfab.measures import not_a_disk
from ddgfab.optimize.energy import KEEP, Keep, keep_number
from ddgfab.optimize.expectation import better_diagonals
from ddgfab.optimize.forecast import doubtful
from ddgfab.optimize.limits import Limits
from ddgfab.optimize.net_goals import PLANAR
from ddgfab.optimize.result import OptimizeResult

TRACE: Final = "trace"
"""Name of the advice to trace another net; its value is the distance of its lines."""

DIAGONALS: Final = "diagonals"
"""Name of the advice to take the net of diagonals; its value is True."""

DIAGONALS_REASON: Final = (
    "the edges do not follow conjugate directions of the surface, but their diagonals do; take the "
    "net of diagonals (ddgfab optimize --diagonals), whose faces are half as large"
)

TRACE_REASON: Final = (
    "the edges do not follow conjugate directions of the surface; trace a net that does "
    "(ddgfab optimize --retrace)"
)


def other_way(
    result: OptimizeResult, keep: Keep | float, limits: Limits
) -> tuple[tuple[str, object], ...]:
    """What to try after a result that is crumpled, flattened, stretched.

    Followed from result to result, it never comes back to what was tried.

    Returns
    -------
    "keep" with another value, "diagonals", "trace" with the distance of lines and then what
    accepts the result as it is, that alone where no net can be traced, or nothing where the result
    is none of these
    """
    kinds = limits.kinds(result.change)
    crumpled, far = "zigzag" in kinds, bool(kinds & {"distance", "rise"})
    knob = keep_number(keep)
    if not kinds & _WRONG_WAY:
        return ()
    hopeless = "stretch" in kinds or (result.forecast is not None and doubtful(result.forecast))
    if hopeless and (net := _other_net(result, limits)):
        return net
    if crumpled and not far and KEEP["close"] < knob < KEEP["fair"]:
        return (("keep", "fair"),)
    if far and not crumpled and KEEP["close"] < knob <= KEEP["balanced"]:
        return (("keep", "close"),)
    if crumpled or hopeless or (far and ("rise" in kinds or knob > KEEP["balanced"])):
        return _other_net(result, limits) or accepted(result, limits)
    return ()


_WRONG_WAY: Final = frozenset({"zigzag", "distance", "rise", "stretch", "reflex", "folded"})
"""Limits that results exceed where edges run the wrong way."""


def _other_net(result: OptimizeResult, limits: Limits) -> tuple[tuple[str, object], ...]:
    """The net of diagonals where it can be planar, or a traced one of the same spacing."""
    if result.goal == PLANAR.name and better_diagonals(result.original) is not None:
        return ((DIAGONALS, True),)
    if not_a_disk(result.original):
        return ()
    return ((TRACE, float(f"{result.change.edge:.3g}")), *accepted(result, limits))


def accepted(result: OptimizeResult, limits: Limits) -> tuple[tuple[str, object], ...]:
    """Limits that a result keeps, for those it exceeds; none where faces fold or are reflex."""
    change = result.change
    kinds = limits.kinds(change)
    if kinds & {"folded", "reflex"}:
        return ()
    found: list[tuple[str, object]] = []
    if "distance" in kinds:
        least = (limits.distance_mean, limits.distance_max)
        far = (change.distance_mean / change.edge, change.distance_max / change.edge)
        found.append(("distance_limit", tuple(map(max, least, map(_wider, far)))))
    if "rise" in kinds and (kept := change.rise_kept) is not None:
        found.append(("rise_limit", float(f"{0.95 * min(kept, 1 / kept):.2g}")))
    if "zigzag" in kinds:
        found.append(("zigzag_limit", _wider(change.zigzag[1] - change.zigzag[0])))
    if "stretch" in kinds:
        low, _, high = change.edge_stretch
        found.append(("stretch_limit", _wider(max(1 - low, high - 1))))
    return tuple(found)


def _wider(value: float) -> float:
    """A limit that a value keeps, with two digits."""
    return float(f"{1.05 * value:.2g}")

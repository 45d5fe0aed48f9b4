"""Where the edges of a mesh are the fault: results that are crumpled or flattened, and what helps.

Planar faces near a surface need edges along conjugate directions. Where a net does not follow them,
keeping the surface crumples it and keeping it smooth flattens it; then only another net helps.
"""

from __future__ import annotations

from typing import Final

from ddgfab.optimize.energy import KEEP, Keep, keep_number
from ddgfab.optimize.limits import Limits
from ddgfab.optimize.result import OptimizeResult

TRACE: Final = "trace"
"""Name of the advice to trace another net; its value is the distance of its lines."""

TRACE_REASON: Final = (
    "the edges do not follow conjugate directions of the surface; trace a net that does "
    "(ddgfab optimize --retrace)"
)


def other_way(
    result: OptimizeResult, keep: Keep | float, limits: Limits
) -> tuple[tuple[str, object], ...]:
    """What to try after a result that meets its equations but is crumpled, flattened, stretched.

    Followed from result to result, it never comes back to what was tried.

    Returns
    -------
    "keep" with another value, "trace" with the distance of lines, or nothing where the result is
    none of these
    """
    kinds = limits.kinds(result.change)
    crumpled, far = "zigzag" in kinds, bool(kinds & {"distance", "rise"})
    knob = keep_number(keep)
    if "stretch" in kinds:
        return _trace(result)
    if not crumpled and not (far and ("rise" in kinds or knob > KEEP["balanced"])):
        return ()
    if crumpled and not far and KEEP["close"] < knob < KEEP["fair"]:
        return (("keep", "fair"),)
    if far and not crumpled and KEEP["close"] < knob <= KEEP["balanced"]:
        return (("keep", "close"),)
    return _trace(result)


def _trace(result: OptimizeResult) -> tuple[tuple[str, object], ...]:
    """Another net, of the same spacing."""
    return ((TRACE, float(f"{result.change.edge:.3g}")),)

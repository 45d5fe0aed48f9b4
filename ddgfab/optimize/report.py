"""What an optimisation did, as plain numbers and as text for people."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from ddgfab.optimize.result import OptimizeResult

WORST: Final = 5
"""How many of the vertices that moved furthest a report names."""


def comparison(result: OptimizeResult) -> dict[str, Any]:
    """Every measure of `inspect` before and after, movement, remarks and history, ready for JSON.

    Lengths in the unit of the mesh (millimetres in the main job), angles in degrees.
    """
    order = np.argsort(-result.movement, kind="stable")[:WORST]
    return {
        "goal": result.goal,
        "status": result.status,
        "residual": float(result.residual),
        "movement_max": result.movement_max,
        "movement_mean": result.movement_mean,
        "movement_worst": [[int(v), float(result.movement[v])] for v in order],
        "remarks": list(result.remarks),
        "before": result.before.to_dict(),
        "after": result.after.to_dict(),
        "history": [
            {
                "stage": stage,
                "objective": float(step.objective),
                "violation": float(step.violation),
                "step_longest": float(step.longest),
            }
            for stage, step in result.history
        ],
    }


def comparison_text(result: OptimizeResult) -> str:
    """A table of the measures before and after, then movement and remarks."""
    before, after = result.before, result.after
    rows = [("", "before", "after")]
    for name, first in before.measures.items():
        second = after.measures[name]
        rows.append((f"{name}, max", f"{first.greatest:.3g}", f"{second.greatest:.3g}"))
        rows.append((f"{name}, mean", f"{first.mean:.3g}", f"{second.mean:.3g}"))
    for name, one, two in (
        ("edge length, least", before.edge_length[0], after.edge_length[0]),
        ("edge length, greatest", before.edge_length[2], after.edge_length[2]),
        ("corner angle, least [deg]", before.corner_angle_deg[0], after.corner_angle_deg[0]),
        ("corner angle, greatest [deg]", before.corner_angle_deg[1], after.corner_angle_deg[1]),
    ):
        rows.append((name, f"{one:.4g}", f"{two:.4g}"))
    width = max(len(name) for name, _, _ in rows)
    lines = [f"{name:<{width}}  {one:>10}  {two:>10}" for name, one, two in rows]
    worst = ", ".join(
        f"{v} ({result.movement[v]:.4g})"
        for v in np.argsort(-result.movement, kind="stable")[:WORST]
    )
    lines.append(f"kind: {before.kind} -> {after.kind}")
    lines.append(
        f"movement: max {result.movement_max:.4g}, mean {result.movement_mean:.4g} {after.unit}; "
        f"furthest vertices {worst}"
    )
    lines.append(f"{len(result.history)} steps, residual {result.residual:.2g}")
    lines += [f"note: {remark}" for remark in result.remarks]
    return "\n".join(lines)

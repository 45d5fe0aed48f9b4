"""What an optimisation did, as plain numbers and as text for people."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from ddgfab.optimize.families import FamiliesResult
from ddgfab.optimize.result import OptimizeResult
from ddgfab.optimize.torsion_free import TorsionFreeResult

WORST: Final = 5
"""How many of the vertices that moved furthest a report names."""


TRIED: Final = ("lean_limit_deg", "movement_limit_edges", "lean_deg", "movement_edges")
"""What each rung of the trade-off between lean and movement says; edges are mean edges."""


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
        **_own(result),
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


def _own(result: OptimizeResult) -> dict[str, Any]:
    """What only one goal has: node axes with their trade-off, or families."""
    if isinstance(result, TorsionFreeResult):
        support = result.support
        return {
            "torsion_deg_max": support.torsion_deg_max,
            "lean_deg_max": support.lean_deg_max,
            "lean_deg_mean": support.lean_deg_mean,
            "lean_worst": [
                [int(v), float(np.degrees(support.lean[v]))] for v in support.worst_vertices(WORST)
            ],
            "tried": [
                dict(
                    zip(
                        ("lean_limit_deg", "movement_limit", "lean_deg", "movement"),
                        row,
                        strict=True,
                    )
                )
                for row in np.asarray(result.tried, dtype=np.float64).tolist()
            ],
        }
    if isinstance(result, FamiliesResult):
        return {
            "families_of": result.of,
            "families_before": result.families_before,
            "families_after": result.families,
            "fit_tolerance": float(result.tolerance),
        }
    return {}


def _own_lines(result: OptimizeResult) -> list[str]:
    if isinstance(result, TorsionFreeResult):
        support = result.support
        worst = ", ".join(
            f"{v} ({np.degrees(support.lean[v]):.1f})" for v in support.worst_vertices(WORST)
        )
        return [
            f"node axes: torsion max {support.torsion_deg_max:.1e} deg; lean max "
            f"{support.lean_deg_max:.1f}, mean {support.lean_deg_mean:.1f} deg, worst vertices "
            f"{worst}"
        ]
    if isinstance(result, FamiliesResult):
        return [
            f"families of {result.of}s within {result.tolerance:.3g}: {result.families_before} "
            f"before, {result.families} after"
        ]
    return []


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
    lines += _own_lines(result)
    lines.append(f"{len(result.history)} steps, residual {result.residual:.2g}")
    lines += [f"note: {remark}" for remark in result.remarks]
    return "\n".join(lines)

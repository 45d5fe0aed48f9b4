"""What an optimisation did, as plain numbers and as text for people."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any, Final

import numpy as np

from ddgfab.optimize.change import Change
from ddgfab.optimize.limits import ids
from ddgfab.optimize.pane_size import misfit, pane_sizes
from ddgfab.optimize.result import WORST, OptimizeResult

PRICES: Final = 6
"""How many lines of the price list a report shows."""


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
        "design": change_numbers(result.change),
        "prices": [asdict(price) for price in result.prices],
        "max_pane": None
        if result.pane is None
        else {
            "limit": list(result.pane),
            "largest": pane_sizes(result.mesh, result.pane).max(axis=0).tolist(),
            "used": float(misfit(result.mesh, result.pane).max()),
        },
        "forecast": None if result.forecast is None else asdict(result.forecast),
        **result.own(),
        "tried": [asdict(trial) for trial in result.tried],
        "wishes": None if result.wishes is None else asdict(result.wishes),
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


def change_numbers(change: Change) -> dict[str, Any]:
    """What became of a design, ready for JSON: lengths in the unit of the mesh, angles in degrees.

    Distances are between the result and the surface, the greater of both directions; `out` is from
    the result to the surface, `back` the other way.
    """
    before, after = (np.degrees(a).tolist() for a in change.corner_angles)
    return {
        "mean_edge": change.edge,
        "distance_mean": change.distance_mean,
        "distance_max": change.distance_max,
        "distance_out": list(change.distance_out),
        "distance_back": list(change.distance_back),
        "rise_kept": change.rise_kept,
        "volume_kept": change.volume_kept,
        "crease_deg_p99": float(np.degrees(change.crease[0])),
        "crease_deg_max": float(np.degrees(change.crease[1])),
        "zigzag_deg": np.degrees(change.zigzag).tolist(),
        "corner_angles_deg_before": before,
        "corner_angles_deg_after": after,
        "edge_ratio": list(change.edge_ratio),
        "edge_ratio_percentiles_5_50_95": list(change.edge_stretch),
        "new_reflex_quads": change.reflex_quads.tolist(),
        "new_reflex_polygons": change.reflex_polygons.tolist(),
        "folded_faces": change.folded.tolist(),
    }


def change_lines(result: OptimizeResult) -> list[str]:
    """What became of a design, for people."""
    change, unit = result.change, result.after.unit
    edge = change.edge
    kept = ", ".join(
        f"{name} {100 * value:.0f} %"
        for name, value in (("rise", change.rise_kept), ("volume", change.volume_kept))
        if value is not None
    )
    low, high = change.edge_ratio
    shrunk, middle, grown = change.edge_stretch
    zigzag = np.degrees(change.zigzag)
    lines = [
        f"distance from the surface, both ways: mean {change.distance_mean:.4g} {unit} "
        f"({change.distance_mean / edge:.3f} mean edges), greatest {change.distance_max:.4g} "
        f"{unit} ({change.distance_max / edge:.2f})",
        f"kept: {kept or 'no rise and no volume to compare'}",
        f"edges are {low:.2f} to {high:.2f} times as long; 5, 50, 95 of 100 less than "
        f"{shrunk:.2f}, {middle:.2f}, {grown:.2f}",
        f"creases: dihedral angles change by {np.degrees(change.crease[0]):.1f} deg at most at 99 "
        f"of 100 edges, by {np.degrees(change.crease[1]):.1f} deg at the worst",
        "zigzag: bends at edges differ from those beside them by "
        f"{zigzag[1]:.1f} deg (root mean square; before {zigzag[0]:.1f})",
    ]
    if result.pane is not None:
        short, long = pane_sizes(change.after, result.pane).max(axis=0)
        worst = misfit(change.after, result.pane).max()
        lines.append(
            f"largest pane {short:.4g} x {long:.4g} {unit} ({100 * worst:.0f} % of the "
            f"{result.pane[0]:g} x {result.pane[1]:g} that may be)"
        )
    for label, faces in (
        ("quads with new reflex corners", change.reflex_quads),
        ("larger faces with new reflex corners", change.reflex_polygons),
        ("folded faces", change.folded),
    ):
        if len(faces):
            lines.append(f"{label}: {len(faces)} ({ids(faces)})")
    if result.prices:
        steps = [
            f"{p.percent:.2g} %: {p.distance_mean:.3g} / {p.distance_max:.3g}"
            for p in result.prices[-PRICES:]
        ]
        lines.append(f"price list, mean / greatest distance [{unit}]: {'; '.join(steps)}")
    return lines


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
    lines += change_lines(result)
    lines += result.own_lines()
    for trial in result.tried:
        lines.append(
            f"{trial.limit}: {'met' if trial.met else 'missed'}, distance mean / greatest "
            f"{trial.distance_mean:.3g} / {trial.distance_max:.3g} {after.unit}"
        )
    lines += _wish_lines(result)
    lines.append(f"{len(result.history)} steps, residual {result.residual:.2g}")
    lines += [f"note: {remark}" for remark in result.remarks]
    return "\n".join(lines)


def _wish_lines(result: OptimizeResult) -> list[str]:
    """What came of wishes for repetition, and what they cost."""
    price, unit = result.wishes, result.after.unit
    if price is None:
        return []
    lines = []
    for one in price.repetitions:
        what = f"{one.kinds} {'length' if one.of == 'edge' else 'shape'}"
        now, was, plain = (
            f"{100 * one.spread[k]:.2g} % ({100 * one.most[k]:.2g} %)" for k in (2, 0, 1)
        )
        lines.append(
            f"equal {one.of}s, {what}{'' if one.kinds == 1 else 's'}: lengths differ from them by "
            f"{now} of an edge, root mean square (greatest); before {was}, without the wish {plain}"
        )
    change = result.change
    lines.append(
        "price of the wish, distance mean / greatest: "
        f"{price.distance_mean:.3g} / {price.distance_max:.3g} {unit} without, "
        f"{change.distance_mean:.3g} / {change.distance_max:.3g} with it"
        + ("" if price.met_without else "; without it the goal is missed too")
        * (result.status == "missed")
    )
    return lines

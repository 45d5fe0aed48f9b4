"""The schedule of joints: what seals and holds the panes along every beam."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from fabrication.formats.tables import Legend
from fabrication.gridshell.bolt_lists import NO_GRADE
from fabrication.gridshell.detailing.gridshell import Gridshell
from fabrication.gridshell.pieces import Panel
from fabrication.gridshell.schedules.common import Row
from fabrication.project.sections import one_line
from fabrication.solids.polygon import side_vectors

LEGEND: Final = Legend(
    title="Joints",
    about="a joint along a beam: the panes on both sides, gaskets, clamps and caps",
    meanings={
        "beam": "mark of the beam under the joint",
        "edge": "edge of the mesh, counted from 0",
        "place": "inner: between two panes; boundary: beside one",
        "panel_left": "pane on the left of the beam, looking from its start to its end",
        "panel_right": "pane on the right",
        "dihedral_deg": "angle between the two panes: 0 where they are flush, positive where the "
        "joint is convex as seen from outside; empty at the boundary",
        "gap_mm": "gap between the panes, by the project",
        "inner_left_mm": "side of the left pane at its inner surface: length of the gasket inside",
        "inner_right_mm": "the same of the right pane",
        "gasket_mm": "inner gaskets of the joint: the sides of both panes together",
        "gasket": "profile of the gaskets inside, as the project names it",
        "clamp": "what holds the panes, as the project names it",
        "cap": "profile of the cap outside, as the project names it",
        "clamp_mm": "length along which both panes can be clamped: the shorter of their outer "
        "sides; at the boundary the one pane's",
        "cap_mm": "pressure cap outside: the longer of the outer sides, to be fitted at the nodes",
        "marks": "the panes of the joint",
    },
    totals=("gasket_mm", "clamp_mm", "cap_mm"),
    unprinted=("marks",),
)

STRIPS: Final = Legend(
    title="Gaskets, clamps and caps",
    about="a profile along the joints: pieces and lengths to order; each piece is in the list of "
    "joints",
    meanings={
        "kind": "gasket inside, clamp, or cap outside",
        "profile": "as the project names it in [joint]",
        "place": "inner: between two panes; boundary: beside one",
        "quantity": "pieces: gaskets one a pane and side, clamps and caps one a joint",
        "length_m": "of all pieces, without waste",
        "shortest_mm": "length of the shortest piece",
        "longest_mm": "length of the longest piece",
        "marks": "the panes beside these joints",
    },
    totals=("quantity",),
    unprinted=("marks",),
)


def joint_rows(gridshell: Gridshell) -> list[Row]:
    """A row a beam with a pane at one side or both; none where there are no panes."""
    inner, outer = {}, {}
    marks: dict[int, dict[str, Panel]] = {}
    for panel in gridshell.panels:
        below = np.linalg.norm(side_vectors(panel.shape.inner), axis=1).tolist()
        above = np.linalg.norm(side_vectors(panel.shape.outer), axis=1).tolist()
        for side, low, high in zip(panel.sides, below, above, strict=True):
            inner[side.edge, panel.mark], outer[side.edge, panel.mark] = low, high
            marks.setdefault(side.edge, {})[panel.mark] = panel
    rows, project = [], gridshell.project
    for beam in gridshell.beams:
        own = [mark for mark in beam.panels if mark is not None]
        if not own:
            continue
        left, right = beam.panels
        lows = [None if mark is None else inner[beam.edge, mark] for mark in beam.panels]
        highs = [outer[beam.edge, mark] for mark in own]
        side = next(s for s in marks[beam.edge][own[0]].sides if s.edge == beam.edge)
        both = len(own) > 1
        rows.append(
            {
                "beam": beam.mark,
                "edge": beam.edge,
                "place": "inner" if both else "boundary",
                "panel_left": left,
                "panel_right": right,
                "dihedral_deg": float(np.degrees(side.dihedral)) if both else None,
                "gap_mm": project.panel.gap_mm,
                "inner_left_mm": lows[0],
                "inner_right_mm": lows[1],
                "gasket_mm": sum(low for low in lows if low is not None),
                "clamp_mm": min(highs),
                "cap_mm": max(highs),
                "gasket": one_line(project.joint.gasket) or NO_GRADE,
                "clamp": one_line(project.joint.clamp) or NO_GRADE,
                "cap": one_line(project.joint.cap) or NO_GRADE,
                "marks": " ".join(own),
            }
        )
    return rows


def strip_rows(joints: Sequence[Row]) -> list[Row]:
    """A row a profile and place: what to order for all joints; given their rows."""
    found: dict[tuple[str, str, str], list[float]] = {}
    marks: dict[tuple[str, str, str], dict[str, None]] = {}
    for row in joints:
        sides = [row["inner_left_mm"], row["inner_right_mm"]]
        pieces = {
            "gasket": [side for side in sides if side is not None],
            "clamp": [row["clamp_mm"]],
            "cap": [row["cap_mm"]],
        }
        for kind, lengths in pieces.items():
            key = (kind, row[kind], row["place"])
            found.setdefault(key, []).extend(lengths)
            marks.setdefault(key, {}).update(dict.fromkeys(row["marks"].split()))
    order = ("gasket", "clamp", "cap")
    return [
        {
            "kind": kind,
            "profile": profile,
            "place": place,
            "quantity": len(lengths),
            "length_m": 1e-3 * math.fsum(lengths),
            "shortest_mm": min(lengths),
            "longest_mm": max(lengths),
            "marks": " ".join(marks[kind, profile, place]),
        }
        for (kind, profile, place), lengths in sorted(
            found.items(), key=lambda item: (order.index(item[0][0]), *item[0][1:])
        )
    ]

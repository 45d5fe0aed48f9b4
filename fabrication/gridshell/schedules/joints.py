"""The schedule of joints: what seals and holds the panes along every beam."""

from __future__ import annotations

from typing import Final

import numpy as np

from fabrication.formats.tables import Legend
from fabrication.gridshell.detailing.gridshell import Gridshell
from fabrication.gridshell.pieces import Panel
from fabrication.gridshell.schedules.common import Row
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
        "clamp_mm": "length along which both panes can be clamped: the shorter of their outer "
        "sides; at the boundary the one pane's",
        "cap_mm": "pressure cap outside: the longer of the outer sides, to be fitted at the nodes",
        "marks": "the panes of the joint",
    },
    totals=("gasket_mm", "clamp_mm", "cap_mm"),
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
    rows = []
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
                "gap_mm": gridshell.project.panel.gap_mm,
                "inner_left_mm": lows[0],
                "inner_right_mm": lows[1],
                "gasket_mm": sum(low for low in lows if low is not None),
                "clamp_mm": min(highs),
                "cap_mm": max(highs),
                "marks": " ".join(own),
            }
        )
    return rows

"""The schedule of beams: bars as a saw shop cuts and drills them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from fabrication.formats.tables import Legend
from fabrication.gridshell.detailing.connections.base import Joined, Tongue
from fabrication.gridshell.detailing.gridshell import Gridshell
from fabrication.gridshell.schedules.common import (
    MARK,
    NUMBER,
    Masses,
    Row,
    details_of,
    instances_of,
    relative_frame,
)
from fabrication.parts.beam import BEAM
from fabrication.specs import Family


def _both(meanings: Mapping[str, str]) -> dict[str, str]:
    """Meanings of columns about the start, and the same about the end."""
    return {
        name.replace("{end}", end): text.replace("{end}", end)
        for end in ("start", "end")
        for name, text in meanings.items()
    }


LEGEND: Final = Legend(
    title="Beams",
    about="a bar: what to saw, its cuts and holes, and the nodes and panes at it",
    meanings={
        "mark": MARK,
        "number": NUMBER,
        "edge": "edge of the mesh, counted from 0",
        "node_start": "node at the start; x of the part runs from start to end",
        "node_end": "node at the end",
        "profile": "cross-section: depth x width, the depth upright along the node axes",
        "length_axis_mm": "from node axis to node axis, along the edge of the mesh",
        "length_cut_mm": "length of the bar to saw, over all, from long point to long point",
        "length_top_mm": "from cut to cut along the top of the profile, in its middle",
        "length_bottom_mm": "from cut to cut along the bottom of the profile, in its middle",
        "mitre_start_deg": "angle between the start's cut and a square one, seen from the side; "
        "positive where the beam is longer at the top",
        "mitre_end_deg": "that angle at the end, with the same sign: positive is longer at the top",
        "skew_start_deg": "angle between the start's cut and a square one, seen from above; "
        "positive where the beam is longer on its left, looking from start to end: with a mitre a "
        "compound cut",
        "skew_end_deg": "that angle at the end, with the same sign: positive is longer on the left",
        "roll_start_deg": "angle from the beam's own upright to the axis of the start's node, "
        "positive to the left, looking from start to end",
        "roll_end_deg": "that angle for the node at the end",
        **_both(
            {
                "plate_{end}_mm": "thickness of the plate at the {end}, or of the solid end of the "
                "bar before its opening; in a hollow section a plate inside, flush with the cut "
                "and welded to it (weld_mm)",
                "plate_{end}_width_mm": "width of an end plate; its outer face is the cut, it is "
                "welded to the bar (weld_mm)",
                "plate_{end}_height_mm": "height of that plate, along the cut",
                "hole_{end}_up_mm": "where the axis of the hole in the cut at the {end} leaves it, "
                "of several the middle between them: height above the bottom of the profile; the "
                "axis is square to the cut, in the middle of the width",
                "hole_{end}_diameter_mm": "diameter of the hole",
                "hole_{end}_count": "holes in that plate, in rows of two about its middle, which "
                "is where the axis above leaves the cut",
                "hole_{end}_across_mm": "from the holes on the left to those on the right",
                "hole_{end}_along_mm": "from the lowest holes to the highest",
                "vent_{end}_mm": "diameter of the hole in the middle of the plate, into the cavity "
                "of a hollow section",
                "opening_{end}_mm": "length along the beam of the opening behind the plate: from "
                "side to side of a solid bar, in the lower wall of a hollow section",
                "opening_{end}_height_mm": "height of that opening, along the cut; in a hollow "
                "section its width, about the middle",
                "opening_{end}_corner_mm": "radius of its corners",
                "opening_{end}_up_mm": "height of the middle of the opening above the bottom of "
                "the profile; its sides are parallel to the beam, its ends to the cut, and the "
                "first end is the inner face of the plate",
                "opening_{end}_from_mm": "from the cut to the opening, along the bottom of the "
                "profile",
                "slots_{end}_up_mm": "the middle of the cut at the {end}, above the bottom of the "
                "bar",
                "slots_{end}_middle_mm": "from that point along the cut, positive upwards, to the "
                "middle between two slots, which are square to the cut and go from side to side",
                "slots_{end}_apart_mm": "from the middle of one slot to that of the other",
                "slots_{end}_width_mm": "height of the slots",
                "slots_{end}_depth_mm": "their depth from the cut, square to it",
                "bolts_{end}_first_mm": "from the cut, square to it, to the first hole; holes run "
                "parallel to the cut in the middle of the width",
                "bolts_{end}_second_mm": "from the cut, square to it, to the second hole",
                "bolts_{end}_hole_mm": "diameter of these holes",
                "bolts_{end}_recess_mm": "diameter of the recesses for head (at the top) and nut, "
                "at both ends of a hole",
                "bolts_{end}_grip_mm": "from the floor of one recess to that of the other; the "
                "middle between the slots is half way",
            }
        ),
        **_both(
            {
                "straps_{end}_mm": "thickness of two straps welded to the sides of the bar at the "
                "{end}, about the middle of its depth (weld_mm); a tongue goes between them, and "
                "the cut is where they end",
                "straps_{end}_height_mm": "height of the straps",
                "straps_{end}_length_mm": "their length, square to the cut",
                "straps_{end}_lap_mm": "what of that length lies on the bar",
                "straps_{end}_first_mm": "from the cut, square to it, to the first hole across "
                "both, in the middle of their height",
                "straps_{end}_second_mm": "from the cut, square to it, to the second hole",
                "straps_{end}_hole_mm": "diameter of these holes",
            }
        ),
        "slot_width_mm": "width of the slots from both cuts, about the middle of the width, open "
        "at top and bottom",
        "slot_depth_mm": "depth of the slots, square to the cuts",
        "slot_hole_mm": "diameter of the holes across the slots, in the middle of the depth",
        "slot_first_hole_mm": "from each cut, square to it, to the first hole",
        "slot_second_hole_mm": "from each cut, square to it, to the second hole",
        "torsion_deg": "angle between the planes of the edge with either node axis: 0 is a single "
        "mitre, never a compound cut",
        "mass_kg": "mass of one beam",
        "panel_left": "pane on the left, looking from start to end, outside up; empty: the "
        "boundary",
        "panel_right": "pane on the right",
        "offset_start_mm": "from the axis of the node at the start to the cut, along the top of "
        "the profile; with length_top_mm and offset_end_mm the length from axis to axis",
        "offset_end_mm": "from the axis of the node at the end to the cut, along the top of the "
        "profile",
        "connection": "how its ends are joined to the nodes",
        "weld_mm": "throat thickness of the fillet weld: of the ends to the nodes, or of plates to "
        "the bar; empty: not welded",
    },
    totals=("mass_kg", "length_cut_mm"),
    unprinted=("edge",),
)


def beam_rows(gridshell: Gridshell, families: Sequence[Family], masses: Masses) -> list[Row]:
    """Rows of the beam schedule, by edge.

    length_cut_mm is the length of the bar to saw, over all; a mitre [deg] between cut and square
    cut is positive where the beam is longer at the top. Where node axes leave torsion in the beams
    there are four columns more: a skew [deg] between cut and square cut as seen from above,
    positive where the beam is longer on its left (a compound angle, where there is a mitre too),
    and a roll [deg] from the beam's own upright to the node axis, positive to the left as seen
    from the start.
    """
    twisted = any(any(beam.roll) for beam in gridshell.beams)
    pieces = {beam.mark: beam for beam in gridshell.beams}
    rows = {}
    for family, instance in instances_of(families, BEAM):
        beam = pieces[instance.mark]
        nodes, panels, roll = beam.nodes, beam.panels, np.degrees(beam.roll).tolist()
        offsets, joined = beam.offsets, beam.joined
        if relative_frame(beam, instance)[0, 0] < 0:  # turned end for end
            offsets = offsets[::-1]
            joined = None if joined is None else joined[::-1]
            nodes, panels, roll = nodes[::-1], panels[::-1], [-roll[1], -roll[0]]
        torsion = (
            {
                "skew_start_deg": 0.0,
                "skew_end_deg": 0.0,
                "roll_start_deg": roll[0],
                "roll_end_deg": roll[1],
            }
            if twisted
            else {}
        )
        row: Row = {
            "mark": beam.mark,
            "number": family.number,
            "edge": beam.edge,
            "node_start": nodes[0],
            "node_end": nodes[1],
            "profile": None,
            "length_axis_mm": beam.length_axis,
            "length_cut_mm": None,
            "length_top_mm": None,
            "length_bottom_mm": None,
            "mitre_start_deg": None,
            "mitre_end_deg": None,
            "torsion_deg": float(np.degrees(beam.torsion)),
            **torsion,
            **details_of(family.shape),
            **_slots(None if joined is None else joined[0].tongue or joined[1].tongue),
            "mass_kg": masses[family.number],
            "panel_left": panels[0],
            "panel_right": panels[1],
            "offset_start_mm": offsets[0],
            "offset_end_mm": offsets[1],
            "connection": None if joined is None else _joined_by(joined),
            "weld_mm": None if joined is None else joined[0].weld or joined[1].weld,
        }
        rows[beam.mark] = {**row, **family.shape.dimensions()}
    return [rows[beam.mark] for beam in gridshell.beams]


def _joined_by(ends: tuple[Joined, Joined]) -> str:
    """The kind of connection of both ends, or of each."""
    start, end = (how.kind for how in ends)
    return start if start == end else f"{start} at the start, {end} at the end"


def _slots(tongue: Tongue | None) -> Row:
    """Slots and their holes, alike at both ends of all beams."""
    if tongue is None or tongue.straps is not None:
        return {}
    return {
        "slot_width_mm": tongue.slot,
        "slot_depth_mm": tongue.depth,
        "slot_hole_mm": tongue.hole,
        "slot_first_hole_mm": tongue.steps[0],
        "slot_second_hole_mm": tongue.steps[1],
    }

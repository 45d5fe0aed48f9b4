"""What the columns of the lists of bolts mean."""

from __future__ import annotations

from typing import Final

from fabrication.formats.tables import Legend

BOLTS: Final = Legend(
    title="Bolts",
    about="a bolt or stud with its nut and washers: which beam it holds at which node",
    meanings={
        "mark": "name of the bolt; its fasteners are not marked one by one",
        "node": "node that it is screwed into",
        "beam": "beam that it holds",
        "beam_end": "end of the beam as made: start or end",
        "size": "thread",
        "fastener": "bolt or stud, as it is ordered",
        "nut": "nut, as it is ordered",
        "nuts": "how many",
        "washer": "washer, as it is ordered",
        "washers": "how many",
        "grip_mm": "what is clamped, between the seat of the node and the washer",
        "thread_mm": "complete thread that is in the node",
        "node_hole_mm": "diameter of the hole in the node before its thread is cut",
        "node_hole_depth_mm": "depth of that hole from the seat; empty: through the wall",
        "beam_hole_mm": "diameter of the clearance hole in the end of the beam",
        "x_mm": "where the axis of the bolt meets the seat, in the coordinates of the assembly",
        "y_mm": "where the axis of the bolt meets the seat, in the coordinates of the assembly",
        "z_mm": "where the axis of the bolt meets the seat, in the coordinates of the assembly",
        "axis_x": "unit vector of the axis, away from the node",
        "axis_y": "unit vector of the axis, away from the node",
        "axis_z": "unit vector of the axis, away from the node",
    },
    totals=("nuts", "washers"),
    unprinted=("axis_x", "axis_y", "axis_z"),
)

FASTENERS: Final = Legend(
    title="Fasteners",
    about="bolts, studs, nuts or washers of one size and length, as they are ordered",
    meanings={
        "designation": "standard, thread and length",
        "kind": "what it is",
        "quantity": "how many",
        "mass_kg": "mass of one, with a smooth shank: threads make it a few percent lighter",
        "total_mass_kg": "mass of all",
    },
    totals=("quantity", "total_mass_kg"),
)

LEGENDS: Final = {"bolts": BOLTS, "fasteners": FASTENERS}

"""What the columns of the lists of bolts mean."""

from __future__ import annotations

from typing import Final

from fabrication.formats.tables import Legend

POINT: Final = (
    "a point of its axis in the coordinates of the assembly: on the seat; of bolts through plates "
    "in the middle of the plate, of those through discs half way between the discs"
)
DIRECTION: Final = (
    "unit vector of the axis: away from the node; of bolts through plates counterclockwise about "
    "the node, of those through discs outwards, to the head"
)

BOLTS: Final = Legend(
    title="Bolts",
    about="a bolt or stud with its nut and washers: which beam it holds at which node",
    meanings={
        "mark": "name of the bolt; its fasteners are not marked one by one",
        "node": "node that it joins: it is screwed into it, or goes through its plates",
        "beam": "beam that it holds",
        "beam_end": "end of the beam as made: start or end",
        "size": "thread",
        "class": "property class of bolt or stud; those of nut and washer are in the list of "
        "fasteners",
        "fastener": "bolt or stud, as it is ordered",
        "nut": "nut, as it is ordered",
        "nuts": "how many",
        "washer": "washer, as it is ordered",
        "washers": "how many",
        "grip_mm": "what is clamped, washers included: of bolts in threads from the seat of the "
        "node to head or nut, of others from head to nut",
        "thread_mm": "complete thread in the node; empty: it goes through with a nut",
        "node_hole_mm": "diameter of the hole in the node: where there is a thread, before it is "
        "cut",
        "node_hole_depth_mm": "depth of that hole from the seat; empty: through",
        "beam_hole_mm": "diameter of the clearance hole in the end of the beam",
        "x_mm": POINT,
        "y_mm": POINT,
        "z_mm": POINT,
        "axis_x": DIRECTION,
        "axis_y": DIRECTION,
        "axis_z": DIRECTION,
    },
    totals=("nuts", "washers"),
    unprinted=("axis_x", "axis_y", "axis_z"),
)

FASTENERS: Final = Legend(
    title="Fasteners",
    about="bolts, studs, nuts or washers of one size and length, as they are ordered",
    meanings={
        "designation": "standard, thread and length",
        "class": "property class of bolts, studs and nuts, hardness of washers",
        "kind": "what it is",
        "coating": "coating and tightening, as the project states them",
        "quantity": "how many",
        "mass_kg": "mass of one, with a smooth shank: threads make it a few percent lighter",
        "total_mass_kg": "mass of all",
        "marks": "nodes and beams that they join",
    },
    totals=("quantity", "total_mass_kg"),
    unprinted=("marks",),
)

ANCHORS: Final = Legend(
    title="Anchors",
    about="an anchor in the ground: which base plate it holds, and where it is set out",
    meanings={
        "mark": "name of the anchor",
        "base": "base plate that it holds",
        "node": "node above that plate",
        "size": "thread",
        "rod": "threaded rod, as it is ordered",
        "nut": "nut, as it is ordered",
        "washer": "washer, as it is ordered",
        "hole_mm": "diameter of its hole in the base plate",
        "plate_mm": "thickness of the base plate",
        "embedment_mm": "how deep the rod is in the ground; what the concrete needs is in the "
        "assessment (ETA) of the anchor",
        "x_mm": "where its axis meets the ground, in the coordinates of the assembly",
        "y_mm": "where its axis meets the ground, in the coordinates of the assembly",
        "z_mm": "height of the ground there, the underside of the base plate",
    },
)

LEGENDS: Final = {"bolts": BOLTS, "anchors": ANCHORS, "fasteners": FASTENERS}

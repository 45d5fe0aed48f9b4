"""The schedule of nodes: as a mill makes them, arm by arm from the mark."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Final

import numpy as np

from fabrication.formats.tables import Legend
from fabrication.gridshell.detailing.gridshell import Gridshell
from fabrication.gridshell.pieces import Node
from fabrication.gridshell.schedules.common import (
    MARK,
    NUMBER,
    Masses,
    Row,
    WithArms,
    details_of,
    instances_of,
    relative_frame,
)
from fabrication.parts.node import NODE
from fabrication.specs import Family, Instance, Shape

FULL_TURN: Final = 1e-9
"""An azimuth this near [rad] below a full turn is 0."""


LEGEND: Final = Legend(
    title="Nodes",
    about="a node: where it is, its size, and seat, holes and beam of each arm from the mark",
    meanings={
        "mark": MARK,
        "number": NUMBER,
        "vertex": "vertex of the mesh, counted from 0",
        "valence": "how many beams meet at it",
        "x_mm": "position of the vertex, in the coordinates of the assembly",
        "y_mm": "position of the vertex, in the coordinates of the assembly",
        "z_mm": "position of the vertex, in the coordinates of the assembly",
        "axis_x": "unit vector of the node's axis, pointing outwards",
        "axis_y": "unit vector of the node's axis, pointing outwards",
        "axis_z": "unit vector of the node's axis, pointing outwards",
        "diameter_mm": "outside diameter of the bar or tube; of plates and discs of the circle "
        "round all of them",
        "height_mm": "length along the axis, over all",
        "wall_mm": "thickness of the wall of a tube",
        "above_mm": "from the vertex to the top end, along the axis",
        "below_mm": "from the vertex to the bottom end, along the axis",
        "mark_radius_mm": "from the axis to the blind hole in the top end, which marks azimuth 0",
        "mark_diameter_mm": "diameter of that hole",
        "mark_depth_mm": "depth of that hole",
        "mass_kg": "mass of one node",
        "beam_{k}": "beam at arm {k}; arms are counted counterclockwise from the mark, looking at "
        "the top end from outside",
        "azimuth_{k}_deg": "direction of arm {k} about the axis, counterclockwise from the mark, "
        "looking at the top end from outside",
        "elevation_{k}_deg": "rise of beam {k} above the plane across the axis, positive outwards",
        "seat_{k}_mm": "from the axis to the flat milled at azimuth {k}, which is parallel to the "
        "axis and runs along the whole height",
        "seat_depth_{k}_mm": "how deep that flat is milled into the cylinder: radius less seat {k}",
        "seat_width_{k}_mm": "width of that flat",
        "hole_{k}_mm": "height of the center of the hole of arm {k} above the bottom end; it is "
        "square to the seat and, where it is the only one, points to the axis",
        "hole_{k}_diameter_mm": "diameter of that hole before its thread is cut",
        "hole_{k}_depth_mm": "depth of its full diameter from the seat, or from the cylinder where "
        "there is none; empty: through the wall of the tube",
        "thread_{k}": "thread in that hole, and the length that must be complete, in mm",
        "hole_{k}_count": "holes of arm {k}, in rows of two; hole {k} is the height of the lowest",
        "hole_{k}_across_mm": "from the holes on one side of the arm to those on the other",
        "hole_{k}_along_mm": "from the lowest holes to the highest",
        "disc_mm": "thickness of both discs of the node",
        "disc_length_mm": "from the axis to the ends of the strips of the discs",
        "disc_width_mm": "width of the strips of the discs, one along each arm",
        "core_diameter_mm": "diameter of the core between the discs",
        "disc_hole_mm": "diameter of the holes in both discs",
        "disc_{k}_first_mm": "from the axis to the first hole of arm {k}, alike in both discs",
        "disc_{k}_second_mm": "from the axis to its second hole, alike in both discs",
        "plate_mm": "thickness of the plates of a star",
        "plate_length_mm": "from the axis to the ends of its plates",
        "plate_hole_mm": "diameter of the holes through its plates, square to them",
        "hub_diameter_mm": "diameter of the round bar or tube that the plates are welded to",
        "plate_weld_mm": "throat thickness of the fillet welds round the plates",
        "plate_{k}_first_mm": "from the axis to the first hole of the plate of arm {k}",
        "plate_{k}_first_up_mm": "height of that hole above the bottom end",
        "plate_{k}_second_mm": "from the axis to its second hole",
        "plate_{k}_second_up_mm": "height of that hole above the bottom end",
    },
    totals=("mass_kg",),
    unprinted=(
        "vertex",
        "axis_x",
        "axis_y",
        "axis_z",
        "mark_diameter_mm",
        "mark_depth_mm",
    ),
)


def node_rows(gridshell: Gridshell, families: Sequence[Family], masses: Masses) -> list[Row]:
    """Rows of the node schedule, by vertex; azimuths counterclockwise from the part's mark."""
    pieces = {node.mark: node for node in gridshell.nodes}
    most = max((len(node.arms) for node in gridshell.nodes), default=0)
    threads = {
        (bolt.node, bolt.beam): f"{bolt.size} x {bolt.thread:g}"
        for bolt in gridshell.bolts
        if bolt.thread is not None
    }
    rows = {}
    for family, instance in instances_of(families, NODE):
        node = pieces[instance.mark]
        x, y, z = node.position.tolist()
        axis = node.axis.tolist()
        row: Row = {
            "mark": node.mark,
            "number": family.number,
            "vertex": node.vertex,
            "valence": len(node.arms),
            "x_mm": x,
            "y_mm": y,
            "z_mm": z,
            "axis_x": axis[0],
            "axis_y": axis[1],
            "axis_z": axis[2],
            "diameter_mm": None,
            "height_mm": None,
            **details_of(family.shape),
            "mass_kg": masses[family.number],
        }
        arms = _arms_from_mark(node, instance)
        for k in range(most):
            azimuth, arm = arms[k] if k < len(arms) else (None, None)
            row[f"beam_{k + 1}"] = arm.beam if arm else None
            row[f"azimuth_{k + 1}_deg"] = None if azimuth is None else float(np.degrees(azimuth))
            row[f"elevation_{k + 1}_deg"] = float(np.degrees(arm.elevation)) if arm else None
            row |= {name.format(k=k + 1): value for name, value in _arm(family.shape, azimuth)}
            if threads:
                row[f"thread_{k + 1}"] = threads.get((node.mark, arm.beam)) if arm else None
        rows[node.mark] = {**row, **family.shape.dimensions()}
    return [rows[node.mark] for node in gridshell.nodes]


def _arms_from_mark(node: Node, instance: Instance) -> list[tuple[float, Any]]:
    """Azimuth from the mark and arm, counterclockwise; the first is the arm at the mark."""
    relative = relative_frame(node, instance)
    mark = float(np.arctan2(relative[1, 0], relative[0, 0]))
    turned = np.array([arm.azimuth for arm in node.arms]) - mark
    first = int(np.argmin(np.abs(np.remainder(turned + np.pi, 2 * np.pi) - np.pi)))
    order = [*range(first, len(turned)), *range(first)]
    azimuths = np.remainder(turned[order], 2 * np.pi)
    if azimuths[0] > np.pi:  # a little before the mark, within the family's tolerance
        azimuths[0] -= 2 * np.pi
    if abs(azimuths[0]) < FULL_TURN:
        azimuths[0] = 0.0
    return [(float(a), node.arms[k]) for a, k in zip(azimuths, order, strict=True)]


def _arm(shape: Shape, azimuth: float | None) -> Iterable[tuple[str, Any]]:
    """What the shape has for the arm in a direction: columns with {k} for its number."""
    return shape.arm(azimuth).items() if isinstance(shape, WithArms) else ()

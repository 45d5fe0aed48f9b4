"""Bolt list and list of fasteners of a gridshell, as rows of plain values."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np

from fabrication.gridshell.detailing.connections.base import Mounted
from fabrication.gridshell.detailing.gridshell import Gridshell
from fabrication.gridshell.pieces import Anchor, Beam, Bolt
from fabrication.parts.beam import BEAM
from fabrication.parts.fastener import WIDE, FastenerShape
from fabrication.specs import Family, Mate
from fabrication.standards import mass_kg
from fabrication.standards.fasteners import PropertyClass, property_class, steel_density
from fabrication.table import Table

Row = dict[str, Any]

NO_GRADE: Final = "(not stated)"
"""What an order needs and the project does not say."""


def bolt_tables(gridshell: Gridshell, families: Sequence[Family]) -> dict[str, Table]:
    """Tables "bolts", "anchors" and "fasteners"; none where nothing is bolted."""
    rows = {
        "bolts": bolt_rows(gridshell, families),
        "anchors": anchor_rows(gridshell.anchors, gridshell.project.ground.anchor),
        "fasteners": fastener_rows(gridshell),
    }
    return {name: Table(own, name=name) for name, own in rows.items() if own}


def bolt_rows(gridshell: Gridshell, families: Sequence[Family]) -> list[Row]:
    """Rows of the bolt list, by node and arm.

    beam_end is the end of the part as made, which may be turned end for end; x, y, z is where the
    axis meets the seat of the node, axis_x, axis_y, axis_z its direction away from the node; of a
    bolt through a tongue the middle of the tongue, and the direction counterclockwise about the
    node.
    """
    turned = _turned(gridshell.beams, families)
    connection = gridshell.project.connection
    rows = []
    for bolt in gridshell.bolts:
        (_, node_hole), (_, beam_hole) = bolt.holes
        x, y, z = bolt.point.tolist()
        axis = bolt.axis.tolist()
        at_end = bool(bolt.end) != turned[bolt.beam]
        row: Row = {
            "mark": bolt.mark,
            "node": bolt.node,
            "beam": bolt.beam,
            "beam_end": "end" if at_end else "start",
            "size": bolt.size,
            "class": connection.bolt_class,
        }
        kinds = Counter(mounted.shape.kind for mounted in bolt.mounted)
        for mounted in bolt.mounted:
            shape = mounted.shape
            column = "fastener" if shape.kind in ("bolt", "stud") else shape.kind
            row[column] = shape.designation
            if column != "fastener":
                row[f"{column}s"] = kinds[shape.kind]
        rows.append(
            {
                **row,
                "grip_mm": clamped(bolt),
                "thread_mm": bolt.thread,
                "node_hole_mm": node_hole,
                "node_hole_depth_mm": bolt.depth,
                "beam_hole_mm": beam_hole,
                "x_mm": x,
                "y_mm": y,
                "z_mm": z,
                "axis_x": axis[0],
                "axis_y": axis[1],
                "axis_z": axis[2],
            }
        )
    return rows


def clamped(bolt: Bolt) -> float:
    """What a bolt clamps [mm], washers included: between head, nut and, of threads, the seat."""
    ends = [0.0] if bolt.thread is not None else []
    ends += [m.at for m in bolt.mounted if m.shape.kind in ("bolt", "nut")]
    return max(ends) - min(ends)


def class_of(shape: FastenerShape, made: PropertyClass) -> str:
    """Property class of a bolt, stud or nut, or hardness of a washer, as it is ordered."""
    if shape.kind == "washer":
        return made.wide if shape.designation.startswith(WIDE) else made.washer
    return made.nut if shape.kind == "nut" else made.bolt


def anchor_rows(anchors: Sequence[Anchor], size: str) -> list[Row]:
    """Rows of the list of anchors, by base plate; x, y, z is where the axis meets the ground."""
    rows = []
    for anchor in anchors:
        named = {mounted.shape.kind: mounted.shape.designation for mounted in anchor.mounted}
        x, y, z = anchor.point.tolist()
        rows.append(
            {
                "mark": anchor.mark,
                "base": anchor.base,
                "node": anchor.node,
                "size": size,
                "rod": named["stud"],
                "nut": named["nut"],
                "washer": named["washer"],
                "hole_mm": anchor.hole,
                "plate_mm": anchor.through,
                "embedment_mm": anchor.depth,
                "x_mm": x,
                "y_mm": y,
                "z_mm": z,
            }
        )
    return rows


def fastener_rows(gridshell: Gridshell) -> list[Row]:
    """Rows of the list of fasteners: quantity and masses [kg] of each, as they are ordered.

    Masses are those of smooth shanks: threads make them a few percent lighter.
    """
    connection = gridshell.project.connection
    made = property_class(connection.bolt_class)
    joined: dict[FastenerShape, list[str]] = {}
    counts: Counter[FastenerShape] = Counter()
    held: list[tuple[tuple[Mounted, ...], tuple[str, ...]]] = [
        (bolt.mounted, (bolt.node, bolt.beam)) for bolt in gridshell.bolts
    ]
    held += [(anchor.mounted, (anchor.base,)) for anchor in gridshell.anchors]
    for parts, marks in held:
        for mounted in parts:
            counts[mounted.shape] += 1
            joined.setdefault(mounted.shape, []).extend(marks)
    rows = []
    for shape, quantity in sorted(counts.items(), key=lambda item: item[0].designation):
        mass = mass_kg(shape.second_volume(), steel_density())
        rows.append(
            {
                "designation": shape.designation,
                "class": class_of(shape, made),
                "kind": shape.kind,
                "coating": connection.grade or NO_GRADE,
                "quantity": quantity,
                "mass_kg": mass,
                "total_mass_kg": quantity * mass,
                "marks": " ".join(dict.fromkeys(joined[shape])),
            }
        )
    return rows


def mates_of(bolts: Sequence[Bolt], anchors: Sequence[Anchor] = ()) -> tuple[Mate, ...]:
    """What the holes of each bolt must agree on; an anchor has one, in its base plate."""
    held = (
        Mate(
            anchor.mark,
            tuple(anchor.point.tolist()),
            tuple(anchor.axis.tolist()),
            (0.0, anchor.through),
            ((anchor.base, anchor.hole),),
        )
        for anchor in anchors
    )
    joined = (
        Mate(
            bolt.mark,
            tuple(bolt.point.tolist()),
            tuple(bolt.axis.tolist()),
            bolt.span,
            bolt.holes,
        )
        for bolt in bolts
    )
    return (*joined, *held)


def mounted_pairs(gridshell: Gridshell) -> frozenset[frozenset[str]]:
    """Marks of pieces that a bolt holds together: its fasteners with each other and the parts."""
    of_bolt: dict[str, list[str]] = {}
    for piece in gridshell.fasteners:
        of_bolt.setdefault(piece.bolt, []).append(piece.mark)
    held: dict[str, tuple[str, ...]] = {b.mark: (b.node, b.beam) for b in gridshell.bolts}
    held |= {anchor.mark: (anchor.base,) for anchor in gridshell.anchors}
    pairs = set()
    for bolt, own in of_bolt.items():
        for k, mark in enumerate(own):
            pairs |= {frozenset((mark, other)) for other in (*held[bolt], *own[k + 1 :])}
    return frozenset(pairs)


def marks_of(row: Mapping[str, Any]) -> list[str]:
    """The pieces that a row of a schedule is about: of a bolt, the node and the beam."""
    if "node" in row and "beam" in row:
        return [row["node"], row["beam"]]
    if "base" in row:
        return [row["base"]]
    if "marks" in row:
        return str(row["marks"]).split()
    return [row["mark"]] if "mark" in row else []


def _turned(beams: Sequence[Beam], families: Sequence[Family]) -> Mapping[str, bool]:
    """By mark, whether a beam is the shared shape turned end for end."""
    own = {beam.mark: beam.placement[:3, 0] for beam in beams}
    return {
        instance.mark: bool(np.dot(own[instance.mark], instance.placement[:3, 0]) < 0.0)
        for family in families
        if family.kind.role == BEAM.role
        for instance in family.instances
    }

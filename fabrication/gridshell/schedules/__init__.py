"""Schedules of a gridshell as rows of plain values; no CAD is loaded.

Shop dimensions come from the family's shape, topology from the piece. Where an instance was turned
to share its number (a beam end for end, a panel or node about its normal or axis), ends, sides and
arms are listed as the shared shape has them, so that the schedule matches the part as made.

A row names the columns of the usual shapes in their order, without values; the shape's own
`dimensions` fill them, and whatever else it lists follows at the end.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Final

from fabrication.cutting import Stock
from fabrication.families import families as make_families
from fabrication.gridshell.bolt_lists import NO_GRADE, bolt_tables, class_of
from fabrication.gridshell.detailing.gridshell import Gridshell
from fabrication.gridshell.project import Project
from fabrication.gridshell.schedules import (
    bases,
    beams,
    bolts,
    bom,
    cutting,
    glass,
    joints,
    nodes,
    panels,
    plates,
)
from fabrication.gridshell.schedules.bases import base_rows
from fabrication.gridshell.schedules.beams import beam_rows
from fabrication.gridshell.schedules.bom import bom_rows, size_rows
from fabrication.gridshell.schedules.common import Masses, family_masses
from fabrication.gridshell.schedules.cutting import ROUND_MM, cut_rows, usual_lengths
from fabrication.gridshell.schedules.glass import glass_rows
from fabrication.gridshell.schedules.joints import joint_rows, strip_rows
from fabrication.gridshell.schedules.nodes import node_rows
from fabrication.gridshell.schedules.order import order_rows
from fabrication.gridshell.schedules.panels import panel_rows
from fabrication.gridshell.schedules.plates import plate_rows
from fabrication.parts.base import BASE
from fabrication.parts.beam import BEAM
from fabrication.parts.fastener import FastenerShape
from fabrication.parts.node import NODE
from fabrication.parts.panel import PANEL
from fabrication.project.sections import one_line
from fabrication.project.statements import LEGEND as ORDER_LEGEND
from fabrication.specs import Family, Role
from fabrication.standards.fasteners import property_class
from fabrication.table import Table

CONVENTIONS: Final = (
    "Outside is where the node axes point: the side of the panes that the weather sees.",
    "Sides of a pane are counted counterclockwise as seen from outside; corner 1 begins side 1, "
    "angle k is at corner k. Sides, angles and diagonals are those of the outer surface at sharp "
    "corners.",
    "The mark of a pane goes on its outside face at corner 1, so that side 1 is found on site. The "
    "mark of a beam goes on its left side at its start, that of a node on its top end.",
    "A beam runs from its start to its end; left and right, and top, are as seen along it with "
    "outside up. A mitre is positive where the beam is longer at the top, at both ends alike.",
    "A node is seen on its top end, from outside: a blind hole there marks azimuth 0, and "
    "azimuths and arms are counted counterclockwise from it. Elevations are positive outwards.",
    "In part files a beam begins with x = 0 at the start's cut, at the top of the profile, x runs "
    "to its end, z up; z of a node is its axis, x points to the mark; z of a pane points "
    "outwards, its inner surface is at z = 0.",
    "A welded beam stands with its cut at the seat, the clearance between; a stud goes through a "
    "hole in the cut, on the axis of the thread in the node.",
    "Part numbers are the numbers of the drawings (sheets) and the names of the STEP files.",
    "Rejected pieces are beyond a limit or failed a check: they are in the lists and their "
    "totals, and must not be ordered.",
)
"""How signs, sides and counts go."""

__all__ = [
    "CONVENTIONS",
    "beam_rows",
    "bom_rows",
    "cut_rows",
    "family_masses",
    "joint_rows",
    "materials",
    "node_rows",
    "panel_rows",
    "schedules",
    "size_rows",
]


def schedules(
    gridshell: Gridshell,
    families: Sequence[Family] | None = None,
    masses: Masses | None = None,
) -> dict[str, Table]:
    """The tables of a gridshell by name.

    "order" (what holds for all parts of a kind), "bom", "panels", "beams" and "nodes", and where
    there are such: "sizes" of panes, "glass" to buy and "nesting" (where each ply lies on it),
    "joints" between panes and "strips" along these, "bars" (the cut list) and "stock", "plates",
    "bases" (base plates), "bolts", "anchors", "fasteners" and "costs". Families are
    found, and masses computed from the shapes, where they are not given.
    """
    project = gridshell.project
    if families is None:
        families = make_families(gridshell.pieces, gridshell.family_tolerance)
    if masses is None:
        masses = family_masses(families, project)

    made_of = materials(project)
    along = joint_rows(gridshell)
    glazing, nested = glass_rows(families, project)
    bars, stock = cut_rows(families, _stock_of(project), made_of)
    found = {
        "order": (order_rows(gridshell), ORDER_LEGEND),
        "bom": (bom_rows(families, masses, made_of), bom.BOM),
        "panels": (panel_rows(gridshell, families, masses), panels.LEGEND),
        "sizes": (size_rows(families, masses), bom.SIZES),
        "glass": (glazing, glass.GLASS),
        "nesting": (nested, glass.NESTING),
        "joints": (along, joints.LEGEND),
        "strips": (strip_rows(along), joints.STRIPS),
        "beams": (beam_rows(gridshell, families, masses), beams.LEGEND),
        "stock": (stock, cutting.STOCK),
        "bars": (bars, cutting.BARS),
        "nodes": (node_rows(gridshell, families, masses), nodes.LEGEND),
        "plates": (plate_rows(families, made_of), plates.LEGEND),
        "bases": (base_rows(gridshell, families, masses), bases.LEGEND),
    }
    for name, table in bolt_tables(gridshell, families).items():
        found[name] = (table.rows, bolts.LEGENDS[name])
    always = ("bom", "panels", "beams", "nodes")
    tables = {
        name: Table(rows, name, legend)
        for name, (rows, legend) in found.items()
        if rows or name in always
    }
    return {**tables, **project.rates.table(quantities(gridshell, tables))}


def materials(project: Project) -> Callable[[Family], str]:
    """What parts are made of, as they are ordered."""
    beam, node, panel = project.beam, project.node, project.panel
    text = f"glass {panel.build_up}".strip()
    made_of = {
        BEAM.role: f"{beam.material.lower()} {one_line(beam.grade) or NO_GRADE}",
        NODE.role: f"steel {one_line(node.grade) or NO_GRADE}",
        BASE.role: f"steel {one_line(node.grade) or NO_GRADE}",
        PANEL.role: f"{text}, {one_line(panel.grade)}" if panel.grade else f"{text} {NO_GRADE}",
    }
    classes = property_class(project.connection.bolt_class)

    def material(family: Family) -> str:
        if isinstance(family.shape, FastenerShape):
            own = project.connection.grade
            coating = f", {one_line(own)}" if own else f" {NO_GRADE}"
            return f"steel {class_of(family.shape, classes)}{coating}"
        return made_of[family.role]

    return material


def _stock_of(project: Project) -> Callable[[Role], Stock]:
    """What bars of a role are cut from."""
    usual = usual_lengths(project.beam.section())

    def stock(role: Role) -> Stock:
        return project.stock.stock(usual if role == BEAM.role else ROUND_MM)

    return stock


def quantities(
    gridshell: Gridshell, tables: Mapping[str, Table]
) -> Iterator[tuple[str, str, float]]:
    """What [rates] are for: name of the rate, what it is, and how much of it there is."""
    material = gridshell.project.beam.material.lower()
    yield "kg", f"{material} of beams", math.fsum(tables["beams"].column("mass_kg"))
    yield "kg", "steel of nodes", math.fsum(tables["nodes"].column("mass_kg"))
    if gridshell.bases:
        yield "kg", "steel of base plates", math.fsum(tables["bases"].column("mass_kg"))
    yield "m2", "panes", math.fsum(tables["panels"].column("area_m2"))
    yield "cut", "ends of beams", 2.0 * len(tables["beams"])
    ends = [how for beam in gridshell.beams if beam.joined for how in beam.joined]
    combs = [how.comb for how in ends if how.comb is not None]
    recesses = 2.0 * sum(len(comb.steps) for comb in combs)  # for head and nut
    if gridshell.bolts:  # a hole in the node, or one in both of its discs, and one in the beam
        holes = 2.0 * len(gridshell.bolts) + 0.5 * recesses
        yield "hole", "holes for bolts, in nodes and beams", holes
    if openings := sum(how.end is not None for how in ends):
        yield "hole", "openings behind the holes of beams", float(openings)
    if recesses:
        yield "hole", "recesses for heads and nuts in beams", recesses
    if gridshell.anchors:
        yield "hole", "holes for anchors in base plates", float(len(gridshell.anchors))
    yield "node", "nodes", float(len(tables["nodes"]))

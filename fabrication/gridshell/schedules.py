"""Schedules of panels, beams and nodes as rows of plain values; no CAD is loaded.

Shop dimensions come from the family's shape, topology from the piece. Where an instance was turned
to share its number (a beam end for end, a panel or node about its normal or axis), ends, sides and
arms are listed as the shared shape has them, so that the schedule matches the part as made.

A row names the columns of the usual shapes in their order, without values; the shape's own
`dimensions` fill them, and whatever else it lists follows at the end.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final, TypeAlias

import numpy as np

from ddgfab.mesh import Floats
from fabrication.families import families as make_families
from fabrication.gridshell.bolt_lists import bolt_tables
from fabrication.gridshell.detailing.gridshell import Gridshell
from fabrication.gridshell.pieces import Beam, Node, Panel
from fabrication.gridshell.project import Project
from fabrication.parts.beam import BEAM
from fabrication.parts.fastener import FASTENER
from fabrication.parts.node import NODE
from fabrication.parts.panel import PANEL, PanelShape
from fabrication.specs import Family, Instance, Kind
from fabrication.standards import mass_kg
from fabrication.standards.fasteners import steel_density
from fabrication.table import Table

Row: TypeAlias = dict[str, Any]
Masses: TypeAlias = Mapping[str, float]

FULL_TURN: Final = 1e-9
"""An azimuth this near [rad] below a full turn is 0."""


def schedules(
    gridshell: Gridshell,
    families: Sequence[Family] | None = None,
    masses: Masses | None = None,
) -> dict[str, Table]:
    """Tables "panels", "beams" and "nodes" of a gridshell, and of its bolts where it has any.

    Families are found, and masses computed from the shapes, where they are not given.
    """
    if families is None:
        families = make_families(gridshell.pieces, gridshell.family_tolerance)
    if masses is None:
        masses = family_masses(families, gridshell.project)
    return {
        "panels": Table(panel_rows(gridshell, families, masses), name="panels"),
        "beams": Table(beam_rows(gridshell, families, masses), name="beams"),
        "nodes": Table(node_rows(gridshell, families, masses), name="nodes"),
        **bolt_tables(gridshell, families),
    }


def family_masses(families: Sequence[Family], project: Project) -> dict[str, float]:
    """Mass [kg] of one instance of each part number: closed-form volume times density.

    Raises
    ------
    DetailError
        A shape that cannot be made.
    """
    from fabrication.solids import volume_of

    density = {
        BEAM.role: project.beam.density,
        NODE.role: project.node.density,
        PANEL.role: project.panel.density,
        FASTENER.role: steel_density(),
    }
    return {
        family.number: mass_kg(volume_of(family.shape), density[family.role]) for family in families
    }


def panel_rows(gridshell: Gridshell, families: Sequence[Family], masses: Masses) -> list[Row]:
    """Rows of the panel schedule, by face; sides of the outer surface, from the shape's first."""
    pieces = {panel.mark: panel for panel in gridshell.panels}
    widest = max((len(panel.sides) for panel in gridshell.panels), default=0)
    rows = {}
    for family, instance in _instances(families, PANEL):
        panel = pieces[instance.mark]
        row: Row = {
            "mark": panel.mark,
            "number": family.number,
            "face": panel.face,
            "sides": len(panel.sides),
            "area_m2": None,
            "mass_kg": masses[family.number],
            "thickness_mm": None,
            "width_mm": None,
            "height_mm": None,
            "planarity_mm": panel.planarity_mm,
            "planarity_class": panel.planarity_class,
        }
        first = _first_side(panel, instance, pieces[family.instances[0].mark].shape)
        for k in range(widest):
            present = k < len(panel.sides)
            side = panel.sides[(first + k) % len(panel.sides)] if present else None
            row[f"edge_{k + 1}_mm"] = None
            row[f"angle_{k + 1}_deg"] = None
            row[f"dihedral_{k + 1}_deg"] = float(np.degrees(side.dihedral)) if side else None
            row[f"neighbour_{k + 1}"] = side.neighbour if side else None
        rows[panel.mark] = {**row, **family.shape.dimensions()}
    return [rows[panel.mark] for panel in gridshell.panels]


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
    for family, instance in _instances(families, BEAM):
        beam = pieces[instance.mark]
        nodes, panels, roll = beam.nodes, beam.panels, np.degrees(beam.roll).tolist()
        offsets = beam.offsets
        if _relative(beam, instance)[0, 0] < 0:  # turned end for end
            nodes, panels, roll = nodes[::-1], panels[::-1], [-roll[1], -roll[0]]
            offsets = offsets[::-1]
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
            "mitre_start_deg": None,
            "mitre_end_deg": None,
            "torsion_deg": float(np.degrees(beam.torsion)),
            **torsion,
            "mass_kg": masses[family.number],
            "panel_left": panels[0],
            "panel_right": panels[1],
            "offset_start_mm": offsets[0],
            "offset_end_mm": offsets[1],
            "connection": gridshell.joined.kind,
            "weld_mm": gridshell.joined.weld,
        }
        rows[beam.mark] = {**row, **family.shape.dimensions()}
    return [rows[beam.mark] for beam in gridshell.beams]


def node_rows(gridshell: Gridshell, families: Sequence[Family], masses: Masses) -> list[Row]:
    """Rows of the node schedule, by vertex; azimuths counterclockwise from the part's mark."""
    pieces = {node.mark: node for node in gridshell.nodes}
    most = max((len(node.arms) for node in gridshell.nodes), default=0)
    rows = {}
    for family, instance in _instances(families, NODE):
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
            "mass_kg": masses[family.number],
        }
        arms = _arms_from_mark(node, instance)
        for k in range(most):
            azimuth, arm = arms[k] if k < len(arms) else (None, None)
            row[f"beam_{k + 1}"] = arm.beam if arm else None
            row[f"azimuth_{k + 1}_deg"] = None if azimuth is None else float(np.degrees(azimuth))
            row[f"elevation_{k + 1}_deg"] = float(np.degrees(arm.elevation)) if arm else None
        rows[node.mark] = {**row, **family.shape.dimensions()}
    return [rows[node.mark] for node in gridshell.nodes]


def _instances(families: Sequence[Family], kind: Kind) -> Iterator[tuple[Family, Instance]]:
    for family in families:
        if family.kind.role == kind.role:
            for instance in family.instances:
                yield family, instance


def _relative(piece: Beam | Node | Panel, instance: Instance) -> Floats:
    """(4, 4) from the frame of the family's shape to the piece's own frame."""
    own, placed = piece.placement, instance.placement
    relative = np.eye(4)
    relative[:3, :3] = own[:3, :3].T @ placed[:3, :3]
    relative[:3, 3] = own[:3, :3].T @ (placed[:3, 3] - own[:3, 3])
    return relative


def _first_side(panel: Panel, instance: Instance, shape: PanelShape) -> int:
    """Which side of the piece is the first of the family's shape."""
    relative = _relative(panel, instance)
    corner = relative[:2, :2] @ shape.outer[0] + relative[:2, 3]
    return int(np.argmin(np.linalg.norm(panel.shape.outer - corner, axis=1)))


def _arms_from_mark(node: Node, instance: Instance) -> list[tuple[float, Any]]:
    """Azimuth from the mark and arm, counterclockwise; the first is the arm at the mark."""
    relative = _relative(node, instance)
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

"""Schedules of panels, beams and nodes as rows of plain values; no CAD is loaded.

Shop dimensions come from the family's shape, topology from the piece. Where an instance was turned
to share its number (a beam end for end, a panel or node about its normal or axis), ends, sides and
arms are listed as the shared shape has them, so that the schedule matches the part in hand.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final, TypeAlias, cast

import numpy as np

from ddgfab.mesh import Floats
from fabrication.families import families as make_families
from fabrication.gridshell.detailing import Gridshell
from fabrication.gridshell.detailing.outline import area, least_rectangle, side_vectors, turns
from fabrication.gridshell.project import Project
from fabrication.shapes import fibre_ends
from fabrication.specs import Beam, BeamShape, Family, Instance, Node, NodeShape, Panel, PanelShape
from fabrication.table import Table

Row: TypeAlias = dict[str, Any]
Masses: TypeAlias = Mapping[str, float]

KG_PER_MM3: Final = 1e-9  # times a density in kg/m3
M2_PER_MM2: Final = 1e-6

FULL_TURN: Final = 1e-9
"""An azimuth this near [rad] below a full turn is 0."""


def schedules(
    gridshell: Gridshell,
    families: Sequence[Family] | None = None,
    masses: Masses | None = None,
) -> dict[str, Table]:
    """Tables "panels", "beams" and "nodes" of a gridshell.

    Families are found, and masses computed from the shapes, where they are not given.
    """
    if families is None:
        tolerance = gridshell.project.checks.family_tolerance_mm
        families = make_families(gridshell.pieces, tolerance)
    if masses is None:
        masses = family_masses(families, gridshell.project)
    return {
        "panels": Table(panel_rows(gridshell, families, masses), name="panels"),
        "beams": Table(beam_rows(gridshell, families, masses), name="beams"),
        "nodes": Table(node_rows(gridshell, families, masses), name="nodes"),
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
        "beam": project.beam.density,
        "node": project.node.density,
        "panel": project.panel.density,
    }
    return {
        family.number: mass_kg(volume_of(family.shape), density[family.role]) for family in families
    }


def mass_kg(volume: float, density: float) -> float:
    """Mass [kg] of a volume [mm3] of a density [kg/m3]."""
    return volume * density * KG_PER_MM3


def panel_rows(gridshell: Gridshell, families: Sequence[Family], masses: Masses) -> list[Row]:
    """Rows of the panel schedule, by face; sides of the outer surface, from the shape's first."""
    pieces = {panel.mark: panel for panel in gridshell.panels}
    widest = max((len(panel.sides) for panel in gridshell.panels), default=0)
    rows = {}
    for family, instance in _instances(families, "panel"):
        panel, shape = pieces[instance.mark], cast(PanelShape, family.shape)
        small, large = least_rectangle(np.concatenate([shape.inner, shape.outer])).tolist()
        lengths = np.linalg.norm(side_vectors(shape.outer), axis=1).tolist()
        angles = np.degrees(np.pi - turns(shape.outer)).tolist()
        row: Row = {
            "mark": panel.mark,
            "number": family.number,
            "face": panel.face,
            "sides": len(panel.sides),
            "area_m2": float(area(shape.outer, shape.corner_radius)) * M2_PER_MM2,
            "mass_kg": masses[family.number],
            "thickness_mm": shape.thickness,
            "width_mm": small,
            "height_mm": large,
            "planarity_mm": panel.planarity_mm,
            "planarity_class": panel.planarity_class,
        }
        first = _first_side(panel, instance, shape)
        for k in range(widest):
            present = k < len(panel.sides)
            side = panel.sides[(first + k) % len(panel.sides)] if present else None
            row[f"edge_{k + 1}_mm"] = lengths[k] if side else None
            row[f"angle_{k + 1}_deg"] = angles[k] if side else None
            row[f"dihedral_{k + 1}_deg"] = float(np.degrees(side.dihedral)) if side else None
            row[f"neighbour_{k + 1}"] = side.neighbour if side else None
        rows[panel.mark] = row
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
    for family, instance in _instances(families, "beam"):
        beam, shape = pieces[instance.mark], cast(BeamShape, family.shape)
        start, end = fibre_ends(shape)
        nodes, panels, roll = beam.nodes, beam.panels, np.degrees(beam.roll).tolist()
        if _relative(beam, instance)[0, 0] < 0:  # turned end for end
            nodes, panels, roll = nodes[::-1], panels[::-1], [-roll[1], -roll[0]]
        torsion = (
            {
                "skew_start_deg": float(np.degrees(-np.arctan(shape.start.skew))),
                "skew_end_deg": float(np.degrees(np.arctan(shape.end.skew))),
                "roll_start_deg": roll[0],
                "roll_end_deg": roll[1],
            }
            if twisted
            else {}
        )
        rows[beam.mark] = {
            "mark": beam.mark,
            "number": family.number,
            "edge": beam.edge,
            "node_start": nodes[0],
            "node_end": nodes[1],
            "profile": shape.profile.name,
            "length_axis_mm": beam.length_axis,
            "length_cut_mm": float(end.max() - start.min()),
            "mitre_start_deg": float(np.degrees(-np.arctan(shape.start.slope))),
            "mitre_end_deg": float(np.degrees(np.arctan(shape.end.slope))),
            "torsion_deg": float(np.degrees(beam.torsion)),
            **torsion,
            "mass_kg": masses[family.number],
            "panel_left": panels[0],
            "panel_right": panels[1],
        }
    return [rows[beam.mark] for beam in gridshell.beams]


def node_rows(gridshell: Gridshell, families: Sequence[Family], masses: Masses) -> list[Row]:
    """Rows of the node schedule, by vertex; azimuths counterclockwise from the part's mark."""
    pieces = {node.mark: node for node in gridshell.nodes}
    most = max((len(node.arms) for node in gridshell.nodes), default=0)
    rows = {}
    for family, instance in _instances(families, "node"):
        node, shape = pieces[instance.mark], cast(NodeShape, family.shape)
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
            "diameter_mm": 2 * shape.radius,
            "height_mm": shape.z1 - shape.z0,
            "mass_kg": masses[family.number],
        }
        arms = _arms_from_mark(node, instance)
        for k in range(most):
            azimuth, arm = arms[k] if k < len(arms) else (None, None)
            row[f"beam_{k + 1}"] = arm.beam if arm else None
            row[f"azimuth_{k + 1}_deg"] = None if azimuth is None else float(np.degrees(azimuth))
            row[f"elevation_{k + 1}_deg"] = float(np.degrees(arm.elevation)) if arm else None
        rows[node.mark] = row
    return [rows[node.mark] for node in gridshell.nodes]


def _instances(families: Sequence[Family], role: str) -> Iterator[tuple[Family, Instance]]:
    for family in families:
        if family.role == role:
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

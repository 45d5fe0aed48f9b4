"""The schedule of panels: panes as a glazier orders them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np

from fabrication.formats.tables import Legend
from fabrication.gridshell.detailing.gridshell import Gridshell
from fabrication.gridshell.part_settings import PanelSettings
from fabrication.gridshell.pieces import Panel, Side
from fabrication.gridshell.schedules.common import (
    MARK,
    NUMBER,
    Masses,
    Row,
    instances_of,
    relative_frame,
)
from fabrication.parts.panel import PANEL, PanelShape
from fabrication.solids.polygon import side_vectors
from fabrication.specs import Family, Instance

SIZE_STEP_MM: Final = 100.0
"""Sizes of panes are grouped by rectangles of whole steps [mm]."""

EDGE_WORK: Final = {
    "cut": "C",
    "arrissed": "A",
    "ground": "G",
    "smooth ground": "S",
    "polished": "P",
}
"""Codes of the finishes of EN 12150-1."""

_QUAD: Final = 4


LEGEND: Final = Legend(
    title="Panels",
    about="a pane: sides, diagonals, angles, edge work, and what lies beyond each side",
    meanings={
        "mark": MARK,
        "number": NUMBER,
        "face": "face of the mesh, counted from 0",
        "sides": "how many sides the pane has",
        "build_up": "panes, cavities and laminates from the outside inwards",
        "size_class": "least rectangle that holds the pane, both sides rounded up to whole "
        f"{SIZE_STEP_MM:g} mm",
        "area_m2": "area of the outer surface, its corners rounded",
        "mass_kg": "mass of one pane; without spacers, edge seals and steps",
        "thickness_mm": "thickness of all of it",
        "width_mm": "smaller side of the least rectangle round the pane, both surfaces",
        "height_mm": "larger side of the least rectangle round the pane, both surfaces",
        "corner_radius_mm": "radius that all corners are rounded with; 0: sharp corners. Sides "
        "and diagonals go to the sharp corners, where the sides' lines meet",
        "planarity_mm": "greatest distance of a corner of the mesh face from its best plane",
        "planarity_class": "flat; cold-bend: bent into place; reject: too far from a plane",
        "diagonal_13_mm": "outer surface, from corner 1 to corner 3",
        "diagonal_24_mm": "outer surface, from corner 2 to corner 4; of panes with four sides",
        "diagonal_to_{k}_mm": "outer surface, from corner 1 to corner {k}: with the sides these "
        "diagonals fix a pane of five sides or more",
        "edge_{k}_mm": "length of side {k} at the outer surface, from corner {k} to the next; "
        "sides are counted counterclockwise as seen from outside, corner 1 begins side 1",
        "angle_{k}_deg": "inner angle of the pane at corner {k}, where side {k} begins",
        "bevel_{k}_deg": "angle of the face of side {k} to a square edge, positive where the "
        "inner surface is the larger one",
        "edge_work_{k}": "finish of side {k}: C cut, A arrissed, G ground, S smooth ground, P "
        "polished",
        "step_{k}_mm": "how far the inner panes stand back behind the outermost one at side {k}; "
        "the solid is made without the step",
        "beam_{k}": "mark of the beam under side {k}",
        "dihedral_{k}_deg": "angle between this pane and the one beyond side {k}: 0 where they "
        "are flush, positive where the joint is convex as seen from outside; 0 at the boundary",
        "neighbour_{k}": "mark of the pane beyond side {k}; empty at the boundary",
    },
    totals=("area_m2", "mass_kg"),
    unprinted=("face", "planarity_class", "dihedral_{k}_deg", "neighbour_{k}"),
)


def panel_rows(gridshell: Gridshell, families: Sequence[Family], masses: Masses) -> list[Row]:
    """Rows of the panel schedule, by face; sides of the outer surface, from the shape's first."""
    pieces = {panel.mark: panel for panel in gridshell.panels}
    beams = {beam.edge: beam.mark for beam in gridshell.beams}
    widest = max((len(panel.sides) for panel in gridshell.panels), default=0)
    settings = gridshell.project.panel
    rows = {}
    for family, instance in instances_of(families, PANEL):
        panel = pieces[instance.mark]
        shape = pieces[family.instances[0].mark].shape  # the family's own
        row: Row = {
            "mark": panel.mark,
            "number": family.number,
            "face": panel.face,
            "sides": len(panel.sides),
            **({"build_up": settings.build_up} if settings.build_up else {}),
            "size_class": size_class(shape.dimensions()),
            "area_m2": None,
            "mass_kg": masses[family.number],
            "thickness_mm": None,
            "width_mm": None,
            "height_mm": None,
            "corner_radius_mm": settings.corner_radius_mm,
            "planarity_mm": panel.planarity_mm,
            "planarity_class": panel.planarity_class,
            **_diagonals(shape, widest),
        }
        first = _first_side(panel, instance, shape)
        bevels = _bevels(shape)
        for k in range(widest):
            present = k < len(panel.sides)
            side = panel.sides[(first + k) % len(panel.sides)] if present else None
            row[f"edge_{k + 1}_mm"] = None
            row[f"angle_{k + 1}_deg"] = None
            if settings.edge == "mitred":
                row[f"bevel_{k + 1}_deg"] = bevels[k] if present else None
            row[f"edge_work_{k + 1}"] = _work(side, settings) if side else None
            if settings.step_mm > 0:
                row[f"step_{k + 1}_mm"] = _step(side, settings) if side else None
            row[f"beam_{k + 1}"] = beams[side.edge] if side else None
            row[f"dihedral_{k + 1}_deg"] = float(np.degrees(side.dihedral)) if side else None
            row[f"neighbour_{k + 1}"] = side.neighbour if side else None
        rows[panel.mark] = {**row, **shape.dimensions()}
    return [rows[panel.mark] for panel in gridshell.panels]


def size_class(dimensions: Mapping[str, Any]) -> str:
    """The least rectangle of a pane, its sides rounded up, as text."""
    sides = (dimensions["width_mm"], dimensions["height_mm"])
    return " x ".join(f"{rounded_up(side):.0f}" for side in sides)


def rounded_up(length: float) -> float:
    """A length rounded up to `SIZE_STEP_MM`; one that is less than 1e-6 mm over stays."""
    return SIZE_STEP_MM * math.ceil((length - 1e-6) / SIZE_STEP_MM)


def _work(side: Side, settings: PanelSettings) -> str:
    """Code of the edge work of a side."""
    inner = side.neighbour is not None
    return EDGE_WORK[settings.edge_work if inner else settings.edge_work_boundary]


def _step(side: Side, settings: PanelSettings) -> float:
    """How far the inner panes stand back at a side."""
    return settings.step_mm if side.neighbour is None else 0.0


def _diagonals(shape: PanelShape, widest: int) -> Row:
    """Diagonals of the outer surface, which fix it beside its sides.

    Both of a quad; of more sides those from corner 1, which cut the pane into triangles.
    """
    corners = shape.outer
    count = len(corners)

    def length(i: int, j: int) -> float:
        return float(np.linalg.norm(corners[j - 1] - corners[i - 1]))

    row: Row = {
        "diagonal_13_mm": length(1, 3) if count >= _QUAD else None,
        "diagonal_24_mm": length(2, 4) if count == _QUAD else None,
    }
    for k in range(_QUAD, widest):
        row[f"diagonal_to_{k}_mm"] = length(1, k) if k < count else None
    return row


def _bevels(shape: PanelShape) -> list[float]:
    """Angle [deg] of every side's face to a square one, positive where the inner side is larger."""
    along = side_vectors(shape.outer)
    outward = np.stack([along[:, 1], -along[:, 0]], axis=1)
    outward /= np.linalg.norm(outward, axis=1)[:, None]
    wider = np.einsum("ki,ki->k", shape.inner - shape.outer, outward)
    bevels: list[float] = np.degrees(np.arctan2(wider, shape.thickness)).tolist()
    return bevels


def _first_side(panel: Panel, instance: Instance, shape: PanelShape) -> int:
    """Which side of the piece is the first of the family's shape."""
    relative = relative_frame(panel, instance)
    corner = relative[:2, :2] @ shape.outer[0] + relative[:2, 3]
    return int(np.argmin(np.linalg.norm(panel.shape.outer - corner, axis=1)))

"""What a job needs from its design besides shapes: settings of parts, clearances, records."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from fabrication.formats.step import Header, Material
from fabrication.gridshell.design import Design
from fabrication.gridshell.detailing.clearance import PANEL_CLEARANCE
from fabrication.job.manifest import part_record
from fabrication.job.part import PartResult, PartSettings
from fabrication.specs import Check, Role
from fabrication.standards import mass_kg

CHORD_MM: Final = 0.05
"""Greatest distance [mm] of the meshes (STL, GLB, clearances) from the exact surfaces."""


def part_records(
    design: Design,
    parts: Sequence[PartResult],
    checks: Mapping[str, Sequence[Check]],
    settings: PartSettings,
) -> list[dict[str, Any]]:
    """The manifest's parts, by mark; `checks` are those of each mark."""
    results = {part.number: part for part in parts}
    records = []
    for family in design.families:
        part = results[family.number]
        mass = mass_kg(part.properties.volume, settings.materials[family.role].density)
        for instance in family.instances:
            turn, shift = instance.placement[:3, :3], instance.placement[:3, 3]
            placed = part.mesh.vertices @ turn.T + shift
            records.append(
                part_record(
                    mark=instance.mark,
                    number=family.number,
                    role=family.role,
                    placement=instance.placement,
                    volume_mm3=part.properties.volume,
                    mass_kg=mass,
                    bbox_mm=np.stack([placed.min(axis=0), placed.max(axis=0)]),
                    checks=checks[instance.mark],
                )
            )
    return sorted(records, key=lambda record: str(record["mark"]))


def clearances(design: Design) -> dict[tuple[Role, Role], float]:
    """Least gaps [mm] between neighbours: what the project asks for less what families may take.

    A member may be off from its family's shape by the family's deviation, on either side.
    """
    project = design.project
    loss = 2 * max((family.deviation for family in design.families), default=0.0)
    to_steel = PANEL_CLEARANCE if project.panel.offset_mm == "auto" else 0.0
    wanted: dict[tuple[Role, Role], float] = {
        ("beam", "node"): project.beam.clearance_mm,
        ("beam", "panel"): to_steel,
        ("node", "panel"): to_steel,
        ("panel", "panel"): project.panel.gap_mm,
    }
    return {roles: max(0.0, gap - loss) for roles, gap in wanted.items()}


def part_settings(design: Design, folder: Path, formats: frozenset[str]) -> PartSettings:
    """What all parts of a job share; files go below `folder`."""
    project = design.project
    return PartSettings(
        folder=folder,
        step="step" in formats,
        stl="stl" in formats,
        threemf="3mf" in formats,
        chord=CHORD_MM,
        schema=project.output.step_schema,
        header=Header(project.output.author, project.output.organization, project.name),
        materials={
            "beam": Material("Steel", project.beam.density),
            "node": Material("Steel", project.node.density),
            "panel": Material("Glass", project.panel.density),
        },
    )

"""The room that pieces of a gridshell keep from each other, and settings that give it to them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Final

from ddgfab.errors import DetailError, SupportError
from ddgfab.support import SupportStructure, support_structure
from fabrication.checks.assembly import check_assembly
from fabrication.families import families
from fabrication.gridshell.bolt_lists import mounted_pairs
from fabrication.gridshell.design import Design
from fabrication.gridshell.detailing.clearance import PANEL_CLEARANCE
from fabrication.gridshell.detailing.gridshell import detail
from fabrication.parts.base import BASE
from fabrication.parts.beam import BEAM
from fabrication.parts.node import NODE
from fabrication.parts.panel import PANEL
from fabrication.solids import comparison_mesh
from fabrication.specs import Check, Family, Role, TriangleMesh

CHORD_MM: Final = 0.05
"""Greatest distance [mm] of the meshes (STL, GLB, clearances) from the exact surfaces."""

WIDER_MM: Final = (15.0, 20.0, 25.0, 30.0)
"""Gaps [mm] that are tried where panes come too near each other."""

MOST_PIECES: Final = 2000
"""Of more pieces the room is not measured beforehand: it takes seconds a thousand."""


def clearances(design: Design) -> dict[tuple[Role, Role], float]:
    """Least gaps [mm] between neighbours: what the project asks for less what families may take.

    A member may be off from its family's shape by the family's deviation, on either side.
    """
    project = design.project
    loss = 2 * max((family.deviation for family in design.families), default=0.0)
    to_steel = PANEL_CLEARANCE if project.panel.offset_mm == "auto" else 0.0
    wanted: dict[tuple[Role, Role], float] = {
        (BEAM.role, NODE.role): project.beam.clearance_mm,
        (BASE.role, NODE.role): project.beam.clearance_mm,
        (BEAM.role, PANEL.role): to_steel,
        (NODE.role, PANEL.role): to_steel,
        (PANEL.role, PANEL.role): project.panel.gap_mm,
    }
    return {roles: max(0.0, gap - loss) for roles, gap in wanted.items()}


def gaps_kept(
    design: Design, parts: list[Family], meshes: Mapping[str, TriangleMesh]
) -> dict[str, list[Check]]:
    """The clearance checks of the pieces of some families, by mark; see `check_assembly`."""
    return check_assembly(
        parts,
        meshes,
        clearances(design),
        tolerance=2 * CHORD_MM,
        finer=lambda family, chord: comparison_mesh(family.shape, chord),
        mounted=mounted_pairs(design.gridshell),
    )


def settings_with_room(design: Design, torsion_deg: float) -> list[tuple[str, str, Any]] | None:
    """Settings with which a net whose node axes twist can be built, its pieces clear of each other.

    Normals twist the beams, and panes that are cut along twisted planes come nearer to each other
    than their gap: the torsion is allowed with the gap that leaves room. Where none does, axes
    through one center, if they are upright.

    Parameters
    ----------
    torsion_deg : limit of the torsion that the beams keep

    Returns
    -------
    Settings (section, key, value); none where nothing that was tried can be built. None: the net
    is too large to try.
    """
    if len(design.gridshell.pieces) > MOST_PIECES:
        return None
    limit: tuple[str, str, Any] = ("checks", "torsion_deg", torsion_deg)
    own = design.project.panel.gap_mm
    for gap in (own, *(wider for wider in WIDER_MM if wider > own)):
        if _clear(design, design.support, gap):
            return [limit, *([("panel", "gap_mm", gap)] if gap > own else [])]
    try:
        central = support_structure(design.mesh, "central")
    except SupportError:
        return []
    upright = central.lean_deg_max <= design.project.support.lean_limit_deg
    return [("support", "kind", "central")] if upright and _clear(design, central, own) else []


def _clear(design: Design, support: SupportStructure, gap: float) -> bool:
    """Whether all pieces can be made and keep their clearances, with these axes and this gap."""
    project = design.project
    panel = project.panel.model_copy(update={"gap_mm": gap})
    project = project.model_copy(update={"panel": panel})
    try:
        made = detail(design.mesh, support, project, design.source.groups)
    except DetailError:
        return False
    parts = families(made.pieces, project.checks.family_tolerance_mm)
    trial = replace(design, project=project, support=support, gridshell=made, families=parts)
    meshes = {family.number: comparison_mesh(family.shape, CHORD_MM) for family in parts}
    checks = gaps_kept(trial, list(parts), meshes)
    return all(check.passed for own in checks.values() for check in own)

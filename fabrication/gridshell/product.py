"""A gridshell as a product of the job."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any, Final

from ddgfab.errors import OutputError
from ddgfab.optimize.report import comparison
from fabrication.formats.base import Format, Material, Whole
from fabrication.formats.glb import MODEL
from fabrication.formats.html import REPORT, Html
from fabrication.formats.html.page import Step, Subject
from fabrication.formats.sheets.erection import rings_of
from fabrication.formats.step.format import ASSEMBLY
from fabrication.formats.tables import SCHEDULES
from fabrication.formats.xlsx import WORKBOOK
from fabrication.gridshell.bolt_lists import marks_of, mates_of
from fabrication.gridshell.compas import Compas
from fabrication.gridshell.design import Design
from fabrication.gridshell.remedies import remedies
from fabrication.gridshell.room import CHORD_MM, gaps_kept
from fabrication.gridshell.schedules import CONVENTIONS, materials, schedules
from fabrication.gridshell.schedules.order import order_rows, tolerances
from fabrication.job.problems import FailedCheck
from fabrication.job.product import Product
from fabrication.job.whole import PREVIEW
from fabrication.parts.base import BASE
from fabrication.parts.beam import BEAM
from fabrication.parts.fastener import FASTENER
from fabrication.parts.node import NODE
from fabrication.parts.panel import PANEL
from fabrication.pictures.change import write_change
from fabrication.project.statements import not_stated
from fabrication.specs import Check, Family, Mate, Role, TriangleMesh
from fabrication.standards.fasteners import steel_density
from fabrication.table import Table

CHANGE: Final = "optimized.png"
"""Name of the picture of what [optimize] did to the net."""


class GridshellProduct(Product):
    """A design of a gridshell, to be made."""

    chord = CHORD_MM
    libraries = ("rectpack",)
    shown_first = (
        REPORT,
        ASSEMBLY,
        PREVIEW,
        WORKBOOK,
        *(f"{SCHEDULES}/{name}.csv" for name in ("panels", "beams", "nodes")),
        MODEL,
    )

    nothing_helps = (
        "No setting that was tried helps: the net itself has to change (a smoother one, or quads "
        "instead of triangles)"
    )

    def __init__(self, design: Design) -> None:
        self.design = design
        self.name = design.project.name
        self.pieces, self.families = design.gridshell.pieces, design.families
        self.output, self.verify = design.project.output, design.project.checks.verify
        self.seconds, self.sources = design.seconds, design.project.sources
        self.title = design.project.project.block(self.name, self.output.author)
        open_points = not_stated(order_rows(design.gridshell))
        agree = "Not stated in the project file, to be agreed before parts are ordered: "
        said = [f"{agree}{', '.join(open_points)}."] if open_points else []
        self.conventions = (*said, *CONVENTIONS)

    def material(self, family: Family) -> Material:
        """As the parts list names it, of densities and tolerances in the project."""
        name, role = self._material_names(family), family.role
        return replace(self._materials[role], name=name)

    @cached_property
    def _material_names(self) -> Callable[[Family], str]:
        return materials(self.design.project)

    @cached_property
    def _materials(self) -> dict[Role, Material]:
        """By role, without grade and treatment."""
        project = self.design.project
        limits = tolerances(project)
        steel, node, beam = "Steel", project.node, project.beam
        return {
            BEAM.role: Material("", beam.density, limits[BEAM.role], beam.material),
            NODE.role: Material("", node.density, limits[NODE.role], steel),
            BASE.role: Material("", node.density, limits[NODE.role], steel),
            PANEL.role: Material("", project.panel.density, limits[PANEL.role], "Glass"),
            FASTENER.role: Material("", steel_density(), category=steel),
        }

    def schedules(self, masses: Mapping[str, float]) -> dict[str, Table]:
        """See `fabrication.gridshell.schedules`."""
        return schedules(self.design.gridshell, self.families, masses)

    def format(self, name: str) -> Format:
        """The net for COMPAS, the page, and all that every product has."""
        if name == Compas.name:
            return Compas(self.design)
        if name == Html.name:
            return Html(self._subject())
        return super().format(name)

    def _subject(self) -> Subject:
        """What the page tells of the gridshell."""
        support = self.design.support
        return Subject(
            title=self.title.title or self.name,
            lead=self.design.summary(),
            facts=[
                ("net", self.design.source.file or "built in"),
                ("torsion", f"at most {support.torsion_deg_max:.2g} deg"),
                ("lean", f"at most {support.lean_deg_max:.2f} deg"),
            ],
            notes=self.notes,
            marks_of=self.marks_of,
            steps=_rings,
        )

    def clearances(self, meshes: Mapping[str, TriangleMesh]) -> dict[str, list[Check]]:
        """Gaps between neighbours that passed their limits; what is rejected clashes with none."""
        return gaps_kept(self.design, self._within_limits(), meshes)

    def marks_of(self, row: Mapping[str, Any]) -> Sequence[str]:
        """See `bolt_lists.marks_of`; of a part number, all its pieces."""
        return marks_of(row) or super().marks_of(row)

    @property
    def mates(self) -> Sequence[Mate]:
        """The holes of every bolt whose beam and node are put together, and of every anchor."""
        gridshell = self.design.gridshell
        return mates_of(gridshell.bolts, gridshell.anchors)

    def _within_limits(self) -> list[Family]:
        """Families of pieces that passed their limits: all pieces of a family pass, or none."""
        good = {piece.mark for piece in self.pieces if all(check.passed for check in piece.checks)}
        return [family for family in self.families if family.instances[0].mark in good]

    @property
    def origin(self) -> tuple[float, float, float]:
        """What was subtracted from coordinates far from their origin [mm]."""
        return self.design.source.origin

    def facts(self) -> dict[str, Any]:
        """Input, settings, net, support structure, and what [optimize] did."""
        design = self.design
        facts: dict[str, Any] = {
            "input": {
                "file": design.source.file,
                "sha256": design.source.sha256,
                "vertices": design.mesh.n_vertices,
                "faces": design.mesh.n_faces,
                "origin_mm": list(self.origin),
            },
            "settings": design.project.settings,
            "net": design.measures.to_dict(),
            "support": design.support.to_dict(),
        }
        if design.optimized is not None:
            facts["optimize"] = comparison(design.optimized)
        return facts

    @property
    def notes(self) -> list[str]:
        """Remarks of the reader and of the detailing."""
        return [*self.design.source.notes, *self.design.gridshell.problems]

    def remedies(self, problems: Sequence[FailedCheck]) -> list[tuple[str, str, Any]]:
        """See `fabrication.gridshell.remedies`."""
        return remedies(self.design, problems)

    def extra_files(self) -> list[str]:
        """The picture, where there is an [optimize]."""
        return [] if self.design.optimized is None else [CHANGE]

    def write_extra(self, folder: Path) -> list[str]:
        """A picture of what [optimize] did to the net."""
        moved = self.design.optimized
        if moved is None:
            return []
        try:
            write_change(folder / CHANGE, moved.change)
        except OutputError as error:
            return [f"no {CHANGE}: {error}"]
        return []


def _rings(whole: Whole) -> list[Step]:
    """The rings in which a gridshell goes up."""
    return [
        Step(f"ring {n}, {len(ring.marks)} pieces, {ring.mass:,.0f} kg", ring.marks, f"ring {n}")
        for n, ring in enumerate(rings_of(whole), 1)
    ]

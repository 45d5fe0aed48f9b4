"""A kit of a linkage as a product of the job."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any, Final

import numpy as np

from fabrication.formats.base import Format, Material, Standing
from fabrication.formats.glb import Glb, Movement
from fabrication.formats.html import REPORT, Html
from fabrication.formats.step.format import ASSEMBLY
from fabrication.formats.tables import SCHEDULES
from fabrication.formats.threemf import plate_file
from fabrication.formats.xlsx import WORKBOOK
from fabrication.job.product import Product
from fabrication.job.whole import PREVIEW
from fabrication.linkage.animation import Gif
from fabrication.linkage.kit import Kit
from fabrication.linkage.legends import CONVENTIONS
from fabrication.linkage.moving import MovingScene
from fabrication.linkage.poses import check_poses
from fabrication.linkage.printing import PRINTED_CHORD_MM
from fabrication.linkage.report import subject_of
from fabrication.linkage.scene import colors_of, lying_broad, moving_scene
from fabrication.linkage.schedules import is_printed, marks_of, material
from fabrication.motion.free_range import poses_to_confirm
from fabrication.specs import Check, Color, Family, TriangleMesh
from fabrication.standards.ordering import node_tolerances
from fabrication.table import Table

PRINTED: Final = "none stated; fits as tried with the coupon"
"""Tolerances of printed parts, which depend on the printer: bores have clearances to begin with."""


class KitProduct(Product):
    """A kit, to be made. Meshes are finer than elsewhere, as they are printed."""

    chord = PRINTED_CHORD_MM
    libraries = ("rectpack",)
    conventions = CONVENTIONS
    shown_first = (REPORT, plate_file(1), ASSEMBLY, PREVIEW, f"{SCHEDULES}/bom.csv", WORKBOOK)

    def __init__(self, kit: Kit) -> None:
        self.kit = kit
        self.name = kit.name
        self.pieces, self.families = kit.linkage.pieces, kit.families
        self.output, self.verify = kit.project.output, kit.project.checks.verify
        self.seconds, self.sources = kit.seconds, kit.project.sources
        self.title = kit.project.project.block(self.name, self.output.author)

    def material(self, family: Family) -> Material:
        """What the printer prints; metal pins are of steel rods."""
        name = material(self.kit.linkage, family.kind)
        printed = is_printed(family.kind, self.kit.linkage.settings)
        limits = PRINTED if printed else node_tolerances()
        category = name if printed else "Steel"
        return Material(name, self.kit.density(family.role), limits, category)

    def schedules(self, masses: Mapping[str, float]) -> dict[str, Table]:
        """See `fabrication.linkage.schedules` and `fabrication.linkage.lists`."""
        return self.kit.tables(masses)

    def marks_of(self, row: Mapping[str, Any]) -> list[str]:
        """All of a part number, a link, a part or a pin."""
        return marks_of(dict(row))

    @cached_property
    def placed(self) -> tuple[Family, ...]:
        """What moves, in the design pose."""
        return self.kit.placed()

    @cached_property
    def shown(self) -> tuple[Family, ...]:
        """The same, turned so that it lies broad."""
        return lying_broad(self.kit)

    @property
    def colors(self) -> dict[str, Color]:
        """Those of the links, as on the page and in the animation."""
        return colors_of(self.shown)

    @cached_property
    def plates(self) -> list[list[Standing]]:
        """Print plates of all that is printed."""
        numbers = [part.number for part in self.kit.printed]
        return [
            [(numbers[standing.part], standing.mark, standing.placement) for standing in plate]
            for plate in self.kit.plates
        ]

    @cached_property
    def _scene(self) -> MovingScene:
        return moving_scene(self.kit)

    @cached_property
    def _movement(self) -> Movement:
        scene = self._scene
        marks = [piece.mark for piece in scene.pieces]
        return Movement(scene.driver, {mark: scene.motions[:, k] for k, mark in enumerate(marks)})

    def format(self, name: str) -> Format:
        """A page, a model and an animation that move, and all that every product has."""
        if name == Html.name:
            return Html(subject_of(self.kit, self._scene))
        if name == Gif.name:
            return Gif(self._scene)
        if name == Glb.name:
            return Glb(self._movement)
        return super().format(name)

    def clearances(self, meshes: Mapping[str, TriangleMesh]) -> dict[str, list[Check]]:
        """The meshes in the poses that confirm the proof of the motion."""
        return check_poses(self.kit, meshes, poses_to_confirm(self.kit.motion, between=1))

    def checks(self) -> list[Check]:
        """That the linkage moves at all, and that its range is proven."""
        motion = self.kit.motion
        moved = float(np.degrees(motion.high - motion.low))
        return [
            Check("free range [deg]", moved > 0, moved, 0.0),
            Check("free range is proven", motion.proven, motion.certificate),
        ]

    def facts(self) -> dict[str, Any]:
        """Input, settings, mechanism and motion."""
        path = self.kit.project.source
        return {
            "input": {"file": None if path is None else str(path), "sha256": self.kit.digest},
            "settings": self.kit.project.settings,
            "net": self.kit.facts(),
        }

    @property
    def notes(self) -> Sequence[str]:
        """Remarks for who prints and assembles the kit."""
        return self.kit.notes

"""GLB (glTF 2.0 binary): metres, y up, one mesh a part number, one named node an instance."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Final

import numpy as np

from ddgfab.errors import InputError
from fabrication.formats.base import Contents, Format, Whole
from fabrication.formats.glb.movement import Movement
from fabrication.formats.glb.read import read_glb
from fabrication.formats.glb.write import glb_bytes, write_glb
from fabrication.formats.solids import SolidsReport, mesh_report
from fabrication.specs import Check

__all__ = ["FORMAT", "MODEL", "SINGLE_ROUNDING", "Glb", "Movement", "glb_bytes", "write_glb"]

MODEL: Final = "model.glb"
"""Name of the file of the whole."""


class Glb(Format):
    """GLB: the whole as colored meshes, pieces that failed in red.

    Parameters
    ----------
    movement : of what moves, an animation
    """

    name = "glb"
    suffixes = (".glb",)
    by_default = "always"

    def __init__(self, movement: Movement | None = None) -> None:
        self.movement = movement

    def whole_files(self, contents: Contents) -> list[str]:
        """model.glb."""
        return [MODEL]

    def write_whole(self, folder: Path, whole: Whole) -> list[str]:
        """model.glb; see `glb_bytes`."""
        meshes = {number: part.mesh for number, part in whole.parts.items()}
        masses = {number: part.mass for number, part in whole.parts.items()}
        about = whole.about
        data = glb_bytes(
            whole.shown,
            meshes,
            whole.failed,
            name=about.project,
            masses=masses,
            movement=self.movement,
            about={"origin_mm": list(about.origin)} if any(about.origin) else None,
        )
        (folder / MODEL).write_bytes(data)
        return []

    def check_whole(self, folder: Path, whole: Whole) -> list[Check]:
        """Read back: every piece once, under its mark, its bounds where it was placed."""
        try:
            content = read_glb(folder / MODEL)
        except InputError as error:
            return [Check("glb readable", False, str(error))]
        marks = [i.mark for family in whole.shown for i in family.instances]
        found = {piece.name: piece for piece in content.pieces}
        away = limit = 0.0
        for family in whole.shown:
            points = whole.parts[family.number].mesh.vertices
            for instance in family.instances:
                at = instance.placement
                exact = points @ at[:3, :3].T + at[:3, 3]
                if instance.mark in found:
                    back = found[instance.mark].vertices()
                    bounds = [
                        np.ptp([b.min(axis=0), e.min(axis=0)], axis=0).max()
                        for b, e in ((back, exact), (-back, -exact))
                    ]
                    away = max(away, *map(float, bounds))
                limit = max(limit, SINGLE_ROUNDING * float(np.abs(points).max()))
        return [
            Check("glb readable", True),
            Check(
                "glb pieces",
                sorted(p.name for p in content.pieces) == sorted(marks),
                float(len(content.pieces)),
                float(len(marks)),
            ),
            Check("glb positions_mm", away <= limit, away, limit),
        ]

    def inspect(self, path: Path) -> SolidsReport:
        """Its meshes, corners of equal coordinates welded, and what they share where they stand."""
        content = read_glb(path)
        place = {id(mesh): k for k, (_, mesh) in enumerate(content.meshes)}
        standing = [(place[id(p.mesh)], p.name, p.placement) for p in content.pieces]
        used = Counter(k for k, _, _ in standing)
        meshes = [(name, used[k], mesh) for k, (name, mesh) in enumerate(content.meshes)]
        return mesh_report(path, "GLB", "meter", meshes, standing)


FORMAT: Final = Glb()

SINGLE_ROUNDING: Final = 4 * 2.0**-23
"""How far a coordinate of a placed part may be rounded (single precision), relative to its size."""

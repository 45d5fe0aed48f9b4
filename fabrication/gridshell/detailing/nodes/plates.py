"""Nodes of two discs on a core, which go into slots of the beams' ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Final, Self

import numpy as np

from ddgfab.mesh import Floats
from fabrication.gridshell.detailing.arm_room import least_radii
from fabrication.gridshell.detailing.connections.base import Discs, Joined
from fabrication.gridshell.detailing.connections.slotted import arm_slopes, axis_levels
from fabrication.gridshell.detailing.nodes.base import MARK, SLACK, Joints, NodeSize, require_auto
from fabrication.parts.node import ReferenceMark
from fabrication.parts.spool import SPOOL, SpoolShape
from fabrication.specs import Kind

CORE: Final = 0.6
"""Radius of the core, in distances of the beams' cuts from the axis."""

LAND: Final = 0.8
"""Greatest radius of the core, in half widths of the discs: room for a weld."""

LEAST_CUT: Final = 25.0
"""The beams' cuts are so far [mm] from the axis, or farther."""


@dataclass(frozen=True)
class Plates(NodeSize):
    """Discs of one size for all nodes.

    discs : thickness, length from the beams' cuts, and holes
    """

    discs: Discs

    kind: ClassVar[Kind] = SPOOL
    only_with: ClassVar[str] = "slotted"
    summary: ClassVar[str] = (
        "two discs cut from plate, EN 10029, welded all round to a core turned from round bar"
    )
    welded: ClassVar[bool] = True

    @classmethod
    def fit(cls, joints: Joints) -> Self:
        """The least distance of the beams at which they do not meet.

        Raises
        ------
        DetailError
            A diameter that the project names.
        """
        arms, project = joints.arms, joints.project
        discs = joints.connection.discs(joints.profile)
        require_auto(project)
        assert discs is not None
        needs = least_radii(arms, joints.width, project.node.arm_clearance_mm)
        worst = int(needs.argmax())
        seat = max(float(np.sqrt(needs[worst] ** 2 - 0.25 * joints.width**2)), LEAST_CUT)
        cut = float(np.ceil(seat + project.beam.clearance_mm - SLACK))
        return cls(
            float(np.hypot(cut + discs.length, 0.5 * discs.width)), cut, cut, joints.width,
            float(needs[worst]), int(arms.node[worst]), discs,
        )  # fmt: skip

    def ends(self, joints: Joints, bottom: Floats, top: Floats) -> tuple[Floats, Floats]:
        """Discs lie in the bars, no farther apart than half of their depth."""
        used = np.diff(joints.arms.start) > 0
        level = axis_levels(joints, self.cut, self.discs.length)
        stretch = float(np.hypot(1.0, arm_slopes(joints)).max())
        reach = 0.25 * joints.profile.depth * stretch + 0.5 * self.discs.thickness
        return np.where(used, level - reach, bottom), np.where(used, level + reach, top)

    def shapes(
        self,
        joints: Joints,
        joined: Sequence[Joined],
        bottom: Floats,
        top: Floats,
        middle: Floats,
    ) -> list[SpoolShape]:
        """Two discs at the slots of the arms."""
        comb, levels = joined[0].comb, joined[0].levels
        assert comb is not None
        assert levels is not None
        arms, t = joints.arms, self.discs.thickness
        azimuths, starts = arms.azimuth.tolist(), arms.start.tolist()
        core, reach = min(CORE * self.cut, LAND * 0.5 * self.discs.width), 0.5 * (comb.spacing + t)
        mark = ReferenceMark(0.5 * core, min(MARK[0], 0.4 * core), min(MARK[1], 0.5 * t))
        steps = tuple(self.cut + step for step in self.discs.steps)
        return [
            SpoolShape(
                self.cut + self.discs.length,
                self.discs.width,
                t,
                core,
                float(levels[v]) - reach,
                float(levels[v]) + reach,
                tuple(azimuths[starts[v] : starts[v + 1]]),
                steps,
                self.discs.hole,
                mark,
            )
            for v in np.flatnonzero(np.diff(arms.start)).tolist()
        ]

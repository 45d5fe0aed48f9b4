"""Star nodes: plates in the planes of the beams, which are the tongues of their connections."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from ddgfab.mesh import Floats
from fabrication.gridshell.detailing.arm_room import least_radii
from fabrication.gridshell.detailing.connections.base import Joined, Tongue
from fabrication.gridshell.detailing.nodes.base import MARK, SLACK, Joints, NodeSize, require_auto
from fabrication.parts.node import ReferenceMark
from fabrication.parts.star import STAR, StarShape, TongueHole
from fabrication.specs import Kind


def farthest(joints: Joints, tongue: Tongue, beyond: float = 0.0) -> tuple[float, int]:
    """Distance [mm] of the beams' cuts from the axis at which neither they nor their nuts meet.

    Parameters
    ----------
    beyond : what they keep from in any case [mm]

    Returns
    -------
    It, in whole mm, and the vertex of the node that needs it.
    """
    arms, project = joints.arms, joints.project
    needs = least_radii(arms, joints.width, project.node.arm_clearance_mm)
    seats = np.sqrt(needs**2 - 0.25 * joints.width**2)
    # The nuts of neighbours, sideways from their beams, keep to their halves of the gap.
    ahead, sideways = tongue.nut
    half_gap = 0.5 * np.minimum(arms.gap, np.pi)
    nuts = ahead + sideways / np.tan(half_gap) - tongue.steps[0]
    both = np.maximum(seats, nuts)
    worst = int(both.argmax())
    cut = max(float(both[worst]), beyond) + project.beam.clearance_mm
    return float(np.ceil(cut - SLACK)), int(arms.node[worst])


@dataclass(frozen=True)
class Star(NodeSize):
    """Plates of one length for all nodes: up to the beams, and as far as their bolts need.

    tongue : the plates
    length : of the plates from the axis [mm]
    """

    tongue: Tongue
    length: float

    kind: ClassVar[Kind] = STAR
    only_with: ClassVar[str] = "bolted_tongue"
    summary: ClassVar[str] = (
        "plates, EN 10029, welded to each other at the axis with full penetration, or milled from "
        "one piece"
    )

    @classmethod
    def fit(cls, joints: Joints) -> Self:
        """The least distance of the beams at which neither they nor their nuts meet.

        Raises
        ------
        DetailError
            A diameter that the project names.
        """
        arms, project = joints.arms, joints.project
        tongue = joints.connection.tongue(joints.profile)
        require_auto(project)
        assert tongue is not None
        cut, worst = farthest(joints, tongue)
        needs = least_radii(arms, joints.width, project.node.arm_clearance_mm)
        length = cut + tongue.length
        return cls(
            float(np.hypot(length, 0.5 * tongue.thickness)),
            cut,
            cut,
            joints.width,
            float(needs.max()),
            worst,
            tongue,
            length,
        )

    def ends(self, joints: Joints, bottom: Floats, top: Floats) -> tuple[Floats, Floats]:
        """The plates stay between the tops and bottoms of all beams of their node.

        Beyond them they reach only where a hole would be too near to their edge.
        """
        arms, step = joints.arms, joints.project.node.height_step_mm
        slope, stretch, low, high = self._slopes(joints)
        reach = np.stack([slope * self.cut, slope * self.length])
        used = np.flatnonzero(np.diff(arms.start))
        first = arms.start[used]
        heights, edge = self._heights(joints), self.tongue.edge
        lowest = np.maximum.reduceat(reach.max(axis=0) + low * stretch, first)
        highest = np.minimum.reduceat(reach.min(axis=0) + high * stretch, first)
        under = np.minimum.reduceat(heights.min(axis=0), first) - edge
        over = np.maximum.reduceat(heights.max(axis=0), first) + edge
        bottom, top = bottom.copy(), top.copy()
        bottom[used] = np.minimum(
            step * np.ceil(lowest / step - SLACK), step * np.floor(under / step + SLACK)
        )
        top[used] = np.maximum(
            step * np.floor(highest / step + SLACK), step * np.ceil(over / step - SLACK)
        )
        return bottom, top

    def shapes(
        self,
        joints: Joints,
        joined: Sequence[Joined],
        bottom: Floats,
        top: Floats,
        middle: Floats,
    ) -> list[StarShape]:
        """A plate for each arm, with its holes on the middle line of the beam."""
        arms = joints.arms
        heights = self._heights(joints).T.tolist()
        low, high = bottom.tolist(), top.tolist()
        azimuths, starts = arms.azimuth.tolist(), arms.start.tolist()
        mark = self.mark()
        far = [self.cut + step for step in self.tongue.steps]
        return [
            self.made(
                thickness=self.tongue.thickness,
                length=self.length,
                z0=low[v],
                z1=high[v],
                azimuths=tuple(azimuths[starts[v] : starts[v + 1]]),
                diameter=self.tongue.hole,
                holes=tuple(
                    TongueHole(k - starts[v], rho, z)
                    for k in range(starts[v], starts[v + 1])
                    for rho, z in zip(far, heights[k], strict=True)
                ),
                mark=mark,
            )
            for v in np.flatnonzero(np.diff(arms.start)).tolist()
        ]

    def mark(self) -> ReferenceMark:
        """On the first plate, half way to the beam."""
        wide = min(MARK[0], 0.4 * self.tongue.thickness)
        return ReferenceMark(0.5 * self.cut, wide, MARK[1])

    def made(self, **sizes: Any) -> StarShape:
        """The shape of a node."""
        return StarShape(**sizes)

    def _slopes(self, joints: Joints) -> tuple[Floats, Floats, Floats, Floats]:
        """Slope (A,) of each arm away from its node, its stretch, and its beam's z range."""
        arms = joints.arms
        slope = joints.frames.slope[arms.edge, arms.end] * (1 - 2 * arms.end)
        low, high = joints.levels
        return slope, np.hypot(1.0, slope), low, high

    def _heights(self, joints: Joints) -> Floats:
        """(bolts, A) heights [mm] of the holes along the node axes."""
        slope, stretch, low, high = self._slopes(joints)
        rho = self.cut + np.array(self.tongue.steps)[:, None]
        return np.asarray(slope * rho + 0.5 * (low + high) * stretch)

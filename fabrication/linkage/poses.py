"""Parts as they are made, placed in several poses: nothing interpenetrates, clearances are kept."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations_with_replacement
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from fabrication.checks.assembly import Clash, examine_assembly
from fabrication.linkage.kit import Kit
from fabrication.linkage.printing import PRINTED_CHORD_MM
from fabrication.linkage.settings import LinkageSettings
from fabrication.motion.free_range import JOINT_CLEARANCE
from fabrication.specs import Check, Role, TriangleMesh

SLACK_MM: Final = 2 * PRINTED_CHORD_MM
"""How much [mm] a gap between two meshes may fall short, as both are within their chord."""

MOVING: Final[tuple[Role, ...]] = ("link", "pin", "cap", "spacer")
"""Roles of what moves; the coupon lies aside."""


def check_poses(
    kit: Kit, meshes: Mapping[str, TriangleMesh], angles: ArrayLike
) -> dict[str, list[Check]]:
    """The clearance checks of every piece that moves over several poses, by mark.

    A piece without faults has one Check "clearance" that passed; one with faults a failing Check
    "clearance to MARK" for each neighbour that comes too near: value is the least gap [mm],
    negative for the depth of a penetration, against the limit.

    The certificate of the motion is of the exact shapes between all poses; this is the independent
    look at the meshes that are written, at some.

    Parameters
    ----------
    meshes : by part number
    angles : driving angles [rad], such as `poses_to_confirm` gives
    """
    settings = kit.linkage.settings
    everywhere = dict.fromkeys(combinations_with_replacement(MOVING, 2), settings.axial_gap)
    on_pins = _on_pins(kit)
    worst: dict[tuple[str, str], Clash] = {}
    for angle in np.atleast_1d(np.asarray(angles, dtype=np.float64)):
        report = examine_assembly(kit.placed(float(angle)), meshes, everywhere, tolerance=SLACK_MM)
        for clash in report.clashes:
            limit = clash.limit
            if on_pins[clash.marks[0]] & on_pins[clash.marks[1]]:
                limit = limit_on_pin(settings, clash.marks)
            before = worst.get(clash.marks)
            if clash.gap < limit - SLACK_MM and (before is None or clash.gap < before.gap):
                worst[clash.marks] = Clash(clash.marks, clash.gap, limit)
    checks: dict[str, list[Check]] = {}
    for clash in worst.values():
        for here, there in (clash.marks, clash.marks[::-1]):
            checks.setdefault(here, []).append(
                Check(f"clearance to {there}", False, clash.gap, clash.limit)
            )
    return {mark: checks.get(mark, [Check("clearance", True)]) for mark in on_pins}


def limit_on_pin(settings: LinkageSettings, marks: tuple[str, str]) -> float:
    """Least gap [mm] of two pieces on one pin, by the letters of their marks.

    Caps are pressed on; bars keep their eyes' distance at the pin, and elsewhere what the
    certificate asks of links that share a hinge.
    """
    letters = {mark[0] for mark in marks}
    if "H" in letters:
        return 0.0 if "C" in letters else settings.clearance
    return min(JOINT_CLEARANCE, settings.axial_gap)


def _on_pins(kit: Kit) -> dict[str, frozenset[int]]:
    """By mark, the hinges on whose pins a piece is."""
    found: dict[str, set[int]] = {}
    for hinge, stack in enumerate(kit.linkage.stacks):
        for item in stack:
            found.setdefault(item.mark, set()).add(hinge)
    return {mark: frozenset(hinges) for mark, hinges in found.items()}

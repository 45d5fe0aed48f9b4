"""Parts as they are made, placed in several poses: none penetrates another, clearances are kept."""

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
from fabrication.parts.link import LINK
from fabrication.parts.pin import PIN
from fabrication.parts.ring import CAP, SPACER
from fabrication.specs import Check, Kind, Role, TriangleMesh

SLACK_MM: Final = 2 * PRINTED_CHORD_MM
"""How much [mm] a gap between two meshes may fall short, as both are within their chord."""

MOVING: Final[tuple[Role, ...]] = tuple(kind.role for kind in (LINK, PIN, CAP, SPACER))
"""Roles of what moves; the coupon lies aside."""


def check_poses(
    kit: Kit, meshes: Mapping[str, TriangleMesh], angles: ArrayLike
) -> dict[str, list[Check]]:
    """The clearance checks of every piece that moves over several poses, by mark.

    A piece without faults has one Check "clearance" that passed; one with faults a failing Check
    "clearance" for each neighbour that comes too near, which is its `other`: value is the least gap
    [mm], negative for the depth of a penetration, against the limit.

    The certificate of the motion is of the exact shapes between all poses; this measures the meshes
    that are written, independently, in some poses.

    Parameters
    ----------
    meshes : by part number
    angles : driving angles [rad], such as `fabrication.motion.free_range.poses_to_confirm` gives

    Raises
    ------
    KernelError
        A mesh is not a closed manifold; names its part number.
    """
    settings = kit.linkage.settings
    everywhere = dict.fromkeys(combinations_with_replacement(MOVING, 2), settings.axial_gap)
    hinges, kinds = _stacked(kit)
    worst: dict[tuple[str, str], Clash] = {}
    for angle in np.atleast_1d(np.asarray(angles, dtype=np.float64)):
        report = examine_assembly(kit.placed(float(angle)), meshes, everywhere, tolerance=SLACK_MM)
        for clash in report.clashes:
            first, second = clash.marks
            limit = clash.limit
            if hinges[first] & hinges[second]:
                limit = limit_on_pin(settings, kinds[first], kinds[second])
            before = worst.get(clash.marks)
            if clash.gap < limit - SLACK_MM and (before is None or clash.gap < before.gap):
                worst[clash.marks] = Clash(clash.marks, clash.gap, limit)
    checks: dict[str, list[Check]] = {}
    for clash in worst.values():
        for here, there in (clash.marks, clash.marks[::-1]):
            checks.setdefault(here, []).append(
                Check("clearance", False, clash.gap, clash.limit, there)
            )
    return {mark: checks.get(mark, [Check("clearance", True)]) for mark in hinges}


def limit_on_pin(settings: LinkageSettings, first: Kind, second: Kind) -> float:
    """Least gap [mm] of two pieces on one pin, by their kinds.

    Caps are pressed on; bars keep their eyes' distance at the pin, and elsewhere what the
    certificate requires of links that share a hinge.
    """
    kinds = {first, second}
    if PIN in kinds:
        return 0.0 if CAP in kinds else settings.clearance
    return min(JOINT_CLEARANCE, settings.axial_gap)


def _stacked(kit: Kit) -> tuple[dict[str, frozenset[int]], dict[str, Kind]]:
    """By mark, the hinges on whose pins a piece is, and its kind."""
    hinges: dict[str, set[int]] = {}
    kinds: dict[str, Kind] = {}
    for hinge, stack in enumerate(kit.linkage.stacks):
        for item in stack:
            hinges.setdefault(item.mark, set()).add(hinge)
            kinds[item.mark] = item.kind
    return {mark: frozenset(found) for mark, found in hinges.items()}, kinds

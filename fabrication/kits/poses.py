"""Parts as they are made, placed in several poses: nothing interpenetrates, clearances are kept."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from ddgfab.mesh import Floats
from fabrication.checks.assembly import Clearances, check_assembly
from fabrication.kits.kit import Kit
from fabrication.linkage.settings import LinkageSettings
from fabrication.records import CHORD_MM
from fabrication.specs import Check, TriangleMesh

CLEARANCE: Final = "clearance"
"""Name of the check of a piece that clears all others."""


def clearances_of(settings: LinkageSettings) -> Clearances:
    """Least gaps [mm] between roles; what is pressed onto a pin must not go into it, no more."""
    axial, radial = settings.axial_gap, settings.clearance
    return {
        ("link", "link"): axial,
        ("link", "cap"): axial,
        ("link", "spacer"): axial,
        ("spacer", "cap"): axial,
        ("link", "pin"): radial,
        ("spacer", "pin"): radial,
    }


def check_poses(
    kit: Kit, meshes: Mapping[str, TriangleMesh], angles: Floats | None = None
) -> dict[str, list[Check]]:
    """The clearance checks of every piece over several poses, by mark; see `check_assembly`.

    The certificate of the motion is of the exact shapes between all poses; this is the independent
    look at the meshes that are written, at some.

    Parameters
    ----------
    meshes : by part number
    angles : driving angles [rad]; by default both ends of the free range, and the design pose
    """
    if angles is None:
        angles = np.array([kit.motion.low, kit.mechanism.design, kit.motion.high])
    limits = clearances_of(kit.linkage.settings)
    found: dict[str, list[Check]] = {}
    for angle in angles:
        families = kit.placed(float(angle))
        here = check_assembly(families, meshes, limits, tolerance=2 * CHORD_MM)
        for mark, checks in here.items():
            found.setdefault(mark, []).extend(checks)
    return {mark: _worst(checks) for mark, checks in found.items()}


def _worst(checks: Sequence[Check]) -> list[Check]:
    """One check a name, the one with the least value; a clean pose is not told beside a clash."""
    worst: dict[str, Check] = {}
    for check in checks:
        before = worst.get(check.name)
        if before is None or _value(check) < _value(before):
            worst[check.name] = check
    if any(not check.passed for check in worst.values()):
        worst.pop(CLEARANCE, None)
    return list(worst.values())


def _value(check: Check) -> float:
    return float(check.value) if isinstance(check.value, int | float) else np.inf

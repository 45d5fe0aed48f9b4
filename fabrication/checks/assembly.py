"""Checks of the assembly: neighbours keep their clearances, nothing interpenetrates.

Three tiers. Bounding boxes give the pairs that could be near (`fabrication.checks.nearness`);
planes along their faces that separate them give lower bounds on their distance, which settles
almost all; manifold3d measures what is left.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

import numpy as np

from ddgfab.errors import KernelError
from ddgfab.mesh import Floats, Ints
from fabrication.checks.mesh import to_manifold
from fabrication.checks.nearness import Supports, near_pairs, separations
from fabrication.specs import Check, Family, Role, TriangleMesh

Clearances: TypeAlias = Mapping[tuple[Role, Role], float]

TOUCH: Final = 0.01
"""How much [mm] a gap may fall short of its limit, for rounding and for faces that touch."""


@dataclass(frozen=True)
class Clash:
    """Two pieces that are too near: gap [mm] (negative: depth of penetration) and the limit."""

    marks: tuple[str, str]
    gap: float
    limit: float


@dataclass(frozen=True, eq=False)
class AssemblyReport:
    """What was looked at and what was found.

    pairs : pairs whose bounding boxes come nearer than their clearance
    measured : how many of them needed manifold3d, the others being certified by planes
    least : by mark, the least gap [mm] known of its pairs (a lower bound where planes certified)
    """

    pairs: int
    measured: int
    clashes: tuple[Clash, ...]
    least: Mapping[str, tuple[float, float]]


def check_assembly(
    families: Sequence[Family],
    meshes: Mapping[str, TriangleMesh],
    clearances: Clearances,
    *,
    tolerance: float = TOUCH,
) -> dict[str, list[Check]]:
    """The clearance checks of every piece, by mark.

    A piece without faults has one Check "clearance" that passed; its value is the least of what its
    pairs have in hand over their limits [mm], or None without near neighbours. A piece with faults
    has one failing Check "clearance" for each neighbour that is too near, its `other`: value is the
    gap [mm], negative for the depth of a penetration, against the limit.

    Parameters
    ----------
    families : part numbers with their placed instances
    meshes : by part number, a closed outward mesh in the part's frame [mm]
    clearances : least gap [mm] by pair of roles, in either order; 0 where a pair is absent, which
        forbids penetration only
    tolerance : how much [mm] a gap may fall short; add the meshes' chord tolerance where curved
        faces meet

    Raises
    ------
    KernelError
        A mesh is no closed manifold.
    """
    report = examine_assembly(families, meshes, clearances, tolerance=tolerance)
    checks: dict[str, list[Check]] = {}
    for clash in report.clashes:
        for here, there in (clash.marks, clash.marks[::-1]):
            checks.setdefault(here, []).append(
                Check("clearance", False, clash.gap, clash.limit, there)
            )
    for family in families:
        for instance in family.instances:
            if instance.mark not in checks:
                gap, limit = report.least.get(instance.mark, (None, None))
                checks[instance.mark] = [Check("clearance", True, gap, limit)]
    return checks


def examine_assembly(
    families: Sequence[Family],
    meshes: Mapping[str, TriangleMesh],
    clearances: Clearances,
    *,
    tolerance: float = TOUCH,
) -> AssemblyReport:
    """Find every pair of pieces that is nearer than its clearance; see `check_assembly`."""
    pieces = [(i, instance) for i, f in enumerate(families) for instance in f.instances]
    if not pieces:
        return AssemblyReport(0, 0, (), {})
    owner = np.array([i for i, _ in pieces])
    placements = np.array([instance.placement for _, instance in pieces], dtype=np.float64)
    supports = Supports.build([meshes[family.number] for family in families])
    roles = list(dict.fromkeys(family.role for family in families))
    limits = _limits(clearances, roles)
    pairs = near_pairs(supports, owner, placements, float(limits.max()) + tolerance)
    role = np.array([roles.index(family.role) for family in families])[owner]
    needed = limits[role[pairs[:, 0]], role[pairs[:, 1]]]
    gaps = separations(supports, owner, placements, pairs, needed)
    rest = np.flatnonzero(gaps < needed - tolerance)
    bodies = Bodies([meshes[family.number] for family in families], [f.number for f in families])
    for pair in rest:
        a, b = pairs[pair]
        gaps[pair] = bodies.gap(
            owner[a], owner[b], placements[a], placements[b], needed[pair] + tolerance
        )
    short = np.flatnonzero(gaps < needed - tolerance)
    marks = [instance.mark for _, instance in pieces]
    clashes = tuple(
        Clash((marks[pairs[p, 0]], marks[pairs[p, 1]]), float(gaps[p]), float(needed[p]))
        for p in short
    )
    return AssemblyReport(len(pairs), len(rest), clashes, _least(marks, pairs, gaps, needed))


def _limits(clearances: Clearances, roles: Sequence[Role]) -> Floats:
    """(r, r) least gap [mm] between each two of some roles."""
    return np.array(
        [[clearances.get((a, b), clearances.get((b, a), 0.0)) for b in roles] for a in roles]
    )


def _least(
    marks: Sequence[str], pairs: Ints, gaps: Floats, needed: Floats
) -> dict[str, tuple[float, float]]:
    """By mark, gap and limit of the pair with the least in hand."""
    least: dict[str, tuple[float, float]] = {}
    for pair in np.argsort(-(gaps - needed), kind="stable"):
        for piece in pairs[pair]:
            least[marks[piece]] = (float(gaps[pair]), float(needed[pair]))
    return least


class Bodies:
    """manifold3d bodies of meshes, each made when first asked for; `names` are for messages."""

    def __init__(self, meshes: Sequence[TriangleMesh], names: Sequence[str]) -> None:
        self._meshes, self._names = meshes, names
        self._made: dict[int, Any] = {}

    def _body(self, number: int) -> Any:
        if number not in self._made:
            body = to_manifold(self._meshes[number])
            if body.status().name != "NoError":
                raise KernelError(
                    f"{self._names[number]}: its mesh is no closed manifold "
                    f"({body.status().name}), so its clearances cannot be checked"
                )
            self._made[number] = body
        return self._made[number]

    def pair(self, a: int, b: int, at_a: Floats, at_b: Floats) -> tuple[Any, Any]:
        """Two placed bodies, the second in the frame of the first, where numbers are small."""
        motion = np.linalg.inv(at_a) @ at_b
        return self._body(a), self._body(b).transform(motion[:3])

    def gap(self, a: int, b: int, at_a: Floats, at_b: Floats, search: float) -> float:
        """Distance [mm] up to `search`; below zero the depth of the penetration.

        The depth is that of a slab with the volume and surface of the intersection: 2 volume /
        surface, exact for a thin one and less than the true depth for a thick one.
        """
        first, second = self.pair(a, b, at_a, at_b)
        gap = float(first.min_gap(second, search))
        if gap > 0:
            return gap
        common = first ^ second
        area = float(common.surface_area())
        return -2.0 * float(common.volume()) / area if area > 0 else 0.0

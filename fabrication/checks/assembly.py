"""Checks of the assembly: neighbours keep their clearances, nothing interpenetrates.

Three tiers. Bounding boxes give the pairs that could be near (`fabrication.checks.nearness`);
planes along their faces that separate them give lower bounds on their distance, which settles
almost all; manifold3d measures what is left.

A gap may fall short of its clearance by a tolerance, but no two pieces may overlap: pairs as near
as their meshes are off are measured again on finer ones.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

import numpy as np

from ddgfab.errors import KernelError
from ddgfab.mesh import Floats, Ints
from fabrication.checks.mesh import to_manifold
from fabrication.checks.nearness import Supports, near_pairs, separations
from fabrication.checks.overlaps import ROUNDING_MM
from fabrication.specs import Check, Family, Role, TriangleMesh

Clearances: TypeAlias = Mapping[tuple[Role, Role], float]

TOUCH: Final = 0.01
"""How much [mm] a gap may fall short of its limit, for rounding and for faces that touch."""


MIDDLE_MM: Final = 5e-3
FINE_MM: Final = 2e-4
"""Chord tolerances [mm] of the meshes that show whether curved faces overlap: the finer ones where
the others cannot. Overlaps less deep than that of both parts are taken for touching."""

Finer: TypeAlias = Callable[[Family, float], TriangleMesh]
"""The mesh of a part number within a chord tolerance [mm]."""


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
    overlap: float = ROUNDING_MM,
    finer: Finer | None = None,
    mounted: Collection[frozenset[str]] = frozenset(),
) -> dict[str, list[Check]]:
    """The clearance checks of every piece, by mark.

    A piece without faults has one Check "clearance" that passed; its value is the least of what its
    pairs have more than their limits [mm], or None without near neighbours. A piece with faults
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
    overlap : depth [mm] up to which two meshes that overlap are taken to touch; by default that
        of rounding, as if the meshes were the parts themselves
    finer : where meshes stand for curved faces: gives finer ones, for pairs nearer than `tolerance`
    mounted : marks of two pieces each that belong into one another, as a bolt and its nut: left out

    Raises
    ------
    KernelError
        A mesh is not a closed manifold.
    """
    report = examine_assembly(
        families,
        meshes,
        clearances,
        tolerance=tolerance,
        overlap=overlap,
        finer=finer,
        mounted=mounted,
    )
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
    overlap: float = ROUNDING_MM,
    finer: Finer | None = None,
    mounted: Collection[frozenset[str]] = frozenset(),
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
    marks = [instance.mark for _, instance in pieces]
    if mounted:
        keep = [frozenset((marks[a], marks[b])) not in mounted for a, b in pairs.tolist()]
        pairs = pairs[np.array(keep, dtype=np.bool_)]
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
    near = np.flatnonzero((gaps >= needed - tolerance) & (gaps < (tolerance if finer else 0.0)))
    exact = _Exact(families, meshes, overlap, finer)
    over = np.zeros(len(pairs), dtype=np.bool_)
    for pair in near:
        a, b = pairs[pair]
        found = exact.gap(owner[a], owner[b], placements[a], placements[b])
        over[pair] = found < 0
        gaps[pair] = found if found < 0 else max(gaps[pair], 0.0)
    short = np.flatnonzero((gaps < needed - tolerance) | over)
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
    """By mark, gap and limit of the pair with the least margin."""
    least: dict[str, tuple[float, float]] = {}
    for pair in np.argsort(-(gaps - needed), kind="stable"):
        for piece in pairs[pair]:
            least[marks[piece]] = (float(gaps[pair]), float(needed[pair]))
    return least


class _Exact:
    """Whether pieces overlap, on meshes that are the parts to `FINE_MM`."""

    def __init__(
        self,
        families: Sequence[Family],
        meshes: Mapping[str, TriangleMesh],
        overlap: float,
        finer: Finer | None,
    ) -> None:
        self._families, self._meshes = families, meshes
        self._overlap, self._finer = overlap, finer
        self._made: dict[tuple[int, float], tuple[Bodies, float]] = {}

    def _body(self, number: int, chord: float) -> tuple[Bodies, float]:
        """A part alone, and how far its mesh is off: nothing where it has no curved faces."""
        key = number, chord
        if key not in self._made:
            family = self._families[number]
            mesh, off = self._meshes[family.number], 0.0
            if self._finer is not None:
                fine = self._finer(family, chord)
                off = 0.0 if np.array_equal(fine.vertices, mesh.vertices) else chord
                mesh = fine
            self._made[key] = Bodies([mesh], [family.number]), off
        return self._made[key]

    def gap(self, a: int, b: int, at_a: Floats, at_b: Floats) -> float:
        """Depth of an overlap [mm], negative; 0 where two pieces touch or are apart."""
        motion = np.linalg.inv(at_a) @ at_b
        for chord in (MIDDLE_MM, FINE_MM):
            (one, off_a), (two, off_b) = self._body(a, chord), self._body(b, chord)
            first, second = one.body(0), two.body(0).transform(motion[:3])
            common = first ^ second
            area, off = float(common.surface_area()), off_a + off_b
            depth = 2.0 * float(common.volume()) / area if area > 0 else 0.0
            if depth > self._overlap + off:
                return -depth
            if off == 0.0 or chord == FINE_MM or float(first.min_gap(second, 2 * off)) > off:
                break  # finer meshes would say the same, or there are none
        return 0.0


class Bodies:
    """manifold3d bodies of meshes, each made when first asked for; `names` are for messages."""

    def __init__(self, meshes: Sequence[TriangleMesh], names: Sequence[str]) -> None:
        self._meshes, self._names = meshes, names
        self._made: dict[int, Any] = {}

    def body(self, number: int) -> Any:
        """The body of a mesh.

        Raises
        ------
        KernelError
            The mesh is not a closed manifold.
        """
        if number not in self._made:
            body = to_manifold(self._meshes[number])
            if body.status().name != "NoError":
                raise KernelError(
                    f"{self._names[number]}: its mesh is not a closed manifold "
                    f"({body.status().name}), so its clearances cannot be checked"
                )
            self._made[number] = body
        return self._made[number]

    def pair(self, a: int, b: int, at_a: Floats, at_b: Floats) -> tuple[Any, Any]:
        """Two placed bodies, the second in the frame of the first, where numbers are small."""
        motion = np.linalg.inv(at_a) @ at_b
        return self.body(a), self.body(b).transform(motion[:3])

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

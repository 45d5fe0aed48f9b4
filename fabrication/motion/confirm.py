"""Confirm a motion on the exact meshes of the parts, at chosen poses, by manifold3d.

The range is proven on convex pieces that hold the parts (`fabrication.motion.free_range`); here the
meshes themselves, as they are written to files or read back from them, are placed and measured.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ddgfab.errors import DetailError
from ddgfab.linkages import Mechanism
from ddgfab.mesh import Floats, Ints
from fabrication.checks.assembly import Bodies
from fabrication.checks.nearness import Supports, near_pairs, separations
from fabrication.motion.capsules import Body
from fabrication.motion.free_range import JOINT_CLEARANCE, FreeMotion
from fabrication.specs import Placement, TriangleMesh

VOLUME: Final = 1e-3
"""Common volume [mm3] of two parts that still counts as touching."""

SLACK: Final = 0.01
"""How much [mm] a gap between meshes may fall short of its limit, for chords and rounding."""

FREE, JOINT, SAME_PIN = 0, 1, 2
"""Kinds of pairs: apart by the clearance; neighbouring links; a link and a fitting on one pin."""


@dataclass(frozen=True)
class MeshGap:
    """Two parts in one pose: driving angle [rad], gap and its limit [mm], common volume [mm3]."""

    marks: tuple[str, str]
    t: float
    gap: float
    limit: float
    volume: float


@dataclass(frozen=True)
class Confirmation:
    """What the meshes say.

    poses : driving angles [rad]
    pairs : near pairs looked at; measured : those that planes did not settle
    least : the nearest measured pair of parts that are to keep the clearance, if any was measured
    least_joint : the nearest measured pair of links that share a hinge
    faults : pairs below their limit, or with a common volume
    """

    poses: tuple[float, ...]
    pairs: int
    measured: int
    least: MeshGap | None
    least_joint: MeshGap | None
    faults: tuple[MeshGap, ...]

    @property
    def passed(self) -> bool:
        """Whether nothing is too near."""
        return not self.faults


def poses_to_confirm(motion: FreeMotion, between: int = 3) -> tuple[float, ...]:
    """The ends of the range, the design, the tightest poses and some evenly between [rad]."""
    even = np.linspace(motion.low, motion.high, between + 2)
    tight = [contact.t for contact in motion.tightest]
    return tuple(sorted({float(t) for t in (*even, motion.design, *tight)}))


def confirm(
    mechanism: Mechanism,
    bodies: Sequence[Body],
    meshes: Mapping[str, TriangleMesh],
    placements_at: Callable[[float], Mapping[str, Placement]],
    ts: Sequence[float],
    clearance: float,
    *,
    joint_clearance: float = JOINT_CLEARANCE,
    slack: float = SLACK,
    volume: float = VOLUME,
) -> Confirmation:
    """Measure gaps and common volumes of the placed meshes in poses.

    Parts of one pin keep their fit, not a gap: of a link and what is on its pin only the common
    volume counts; what is pressed together on one pin is not looked at.

    Parameters
    ----------
    mechanism, bodies : which part is on which bar or hinge
    meshes : by mark, in the part's own frame [mm]; equal parts may share one object
    placements_at : placements (4, 4) of the parts by mark at a driving angle
    ts : driving angles [rad]
    clearance, joint_clearance, slack : [mm]; add the meshes' chord tolerance to the slack
    volume : greatest common volume [mm3]

    Raises
    ------
    DetailError
        A body without mesh.
    KernelError
        A mesh that is no closed manifold.
    """
    missing = [body.mark for body in bodies if body.mark not in meshes]
    if missing:
        raise DetailError(f"{missing[0]} has no mesh ({len(missing)} parts lack one)")
    shop = _Shop([meshes[body.mark] for body in bodies], [body.mark for body in bodies])
    kinds = _Kinds(mechanism, bodies)
    limits = {FREE: clearance, JOINT: joint_clearance}
    faults: list[MeshGap] = []
    least: dict[int, MeshGap] = {}
    looked, measured = 0, 0
    for t in ts:
        placed = placements_at(t)
        places = np.stack([placed[body.mark] for body in bodies])
        pairs = near_pairs(shop.supports, shop.owner, places, max(clearance, joint_clearance))
        kind = kinds.of(pairs)
        pairs, kind = pairs[kind >= 0], kind[kind >= 0]
        needed = np.array([limits.get(int(k), 0.0) for k in kind])
        apart = separations(shop.supports, shop.owner, places, pairs, needed)
        looked += len(pairs)
        for p in np.flatnonzero(apart < needed - slack):
            measured += 1
            a, b = pairs[p]
            gap, common = shop.measure(a, b, places[a], places[b], float(needed[p]) + clearance)
            found = MeshGap(
                (bodies[a].mark, bodies[b].mark), float(t), gap, float(needed[p]), common
            )
            if common > volume or gap < needed[p] - slack:
                faults.append(found)
            k = int(kind[p])
            if k not in least or gap < least[k].gap:
                least[k] = found
    return Confirmation(
        tuple(map(float, ts)), looked, measured, least.get(FREE), least.get(JOINT), tuple(faults)
    )


class _Kinds:
    """Which rule a pair of bodies is under; -1 for none."""

    def __init__(self, mechanism: Mechanism, bodies: Sequence[Body]) -> None:
        self._bar = np.array([body.bar for body in bodies])
        self._hinge = np.array([body.hinge for body in bodies])
        # The hinges of a link; the one of a fitting, twice.
        ends = mechanism.bars[self._bar]
        self._ends = np.where(self._bar[:, None] >= 0, ends, self._hinge[:, None])

    def of(self, pairs: Ints) -> Ints:
        a, b = pairs.T
        link_a, link_b = self._bar[a] >= 0, self._bar[b] >= 0
        share = (self._ends[a][:, :, None] == self._ends[b][:, None, :]).any(axis=(1, 2))
        on_one = np.where(link_a & link_b, JOINT, np.where(link_a | link_b, SAME_PIN, -1))
        kind: NDArray[np.int64] = np.where(share, on_one, FREE)
        return kind


class _Shop:
    """Distinct meshes, their supports for planes and their manifold3d bodies."""

    def __init__(self, meshes: Sequence[TriangleMesh], marks: Sequence[str]) -> None:
        number: dict[int, int] = {}
        self.owner: Ints = np.array([number.setdefault(id(mesh), len(number)) for mesh in meshes])
        first = [int(np.argmax(self.owner == k)) for k in range(len(number))]
        distinct = [meshes[k] for k in first]
        self.supports = Supports.build(distinct)
        self._bodies = Bodies(distinct, [marks[k] for k in first])

    def measure(
        self, a: int, b: int, at_a: Floats, at_b: Floats, search: float
    ) -> tuple[float, float]:
        """Gap [mm], searched up to `search`, and common volume [mm3] of two placed parts."""
        own = int(self.owner[a]), int(self.owner[b])
        first, second = self._bodies.pair(*own, at_a, at_b)
        gap = float(first.min_gap(second, search))
        if gap > 0:
            return gap, 0.0
        return 0.0, float((first ^ second).volume())

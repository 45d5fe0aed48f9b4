"""How far a mechanism moves freely: the interval of its driving angle, proven without gaps.

Source: docs/parts.md, Linkages; the proof is in `fabrication.motion.contacts.margin`, the bounds
in `ddgfab.linkages.rates`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Final, Generic, TypeVar

import numpy as np

from ddgfab.errors import DetailError
from ddgfab.linkages import Mechanism
from fabrication.motion.contacts import gaps
from fabrication.motion.convex import Body, ConvexPieces
from fabrication.motion.pairs import Rules
from fabrication.motion.proof import March, Near, Search

JOINT_CLEARANCE: Final = 0.1
"""Least gap [mm] between links that share a hinge, elsewhere than at it."""

TIGHTEST: Final = 12
"""How many of the nearest pairs are reported."""

Option = TypeVar("Option")


@dataclass(frozen=True)
class Contact:
    """Two bodies that come near each other.

    marks : the bodies; t : driving angle [rad]; gap [mm], 0 where they overlap, against the limit;
    point : middle of the nearest points [mm], in the frame of bar 0; along : positions of the
    nearest points along the bars that the bodies move with [mm]
    """

    marks: tuple[str, str]
    t: float
    gap: float
    limit: float
    point: tuple[float, float, float]
    along: tuple[float, float]

    def text(self) -> str:
        """Which bodies meet, where and at what angle."""
        where = ", ".join(f"{value:.1f}" for value in self.point)
        return (
            f"{self.marks[0]} and {self.marks[1]} at {np.degrees(self.t):.2f} deg: "
            f"{self.gap:.2f} mm apart (limit {self.limit:g} mm), near ({where})"
        )

    def to_dict(self) -> dict[str, Any]:
        """The same as plain values."""
        return {
            "parts": list(self.marks),
            "angle_deg": round(float(np.degrees(self.t)), 6),
            "gap_mm": round(self.gap, 6),
            "limit_mm": self.limit,
            "point_mm": [round(value, 3) for value in self.point],
        }


@dataclass(frozen=True)
class FreeMotion:
    """The interval of the driving angle in which all clearances are proven.

    low, high : its ends [rad]; both the design angle when the design pose itself is not free
    design : driving angle of the design pose [rad]
    below, above : what ends the range there, worst first; empty at the mechanism's own limit
    tightest : the nearest pairs within the range, least gap over the limit first
    certificate : text: what was proven, by how much work, under which assumption
    examined : pairs of pieces times intervals
    """

    low: float
    high: float
    design: float
    below: tuple[Contact, ...]
    above: tuple[Contact, ...]
    tightest: tuple[Contact, ...]
    certificate: str
    examined: int

    @property
    def range(self) -> float:
        """Width of the interval [rad]."""
        return self.high - self.low

    @property
    def proven(self) -> bool:
        """Whether an interval is proven; False when the design pose itself is not free."""
        return self.examined > 0

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """What ends the range, below and above."""
        return self.below + self.above


def free_motion(
    mechanism: Mechanism,
    bodies: Sequence[Body],
    clearance: float,
    *,
    joint_clearance: float = JOINT_CLEARANCE,
    limits: tuple[float, float] | None = None,
    progress: Callable[[float], None] | None = None,
) -> FreeMotion:
    """The greatest interval around the design pose in which nothing meets.

    Non-adjacent parts keep `clearance`; links that share a hinge keep `joint_clearance` except at
    the hinge. What turns about a common axis, such as an eye and a bar on one pin, keeps its
    distance in the motion and is judged once (`standing`). Fits on one pin are not judged here.

    Parameters
    ----------
    mechanism : what moves
    bodies : its links (in frames of bars) and fittings (in frames of hinges)
    clearance, joint_clearance : [mm]
    limits : driving angles [rad] to stay between, by default the mechanism's own
    progress : called with the driving angle reached

    Raises
    ------
    DetailError
        A bar with two links.
    """
    search = _search(mechanism, bodies, clearance, joint_clearance)
    design = mechanism.design
    stuck = search.too_near(design) + search.standing()
    if stuck:
        here = tuple(_contact(search, bodies, near) for near in stuck)
        return FreeMotion(
            design,
            design,
            design,
            here,
            here,
            here[:TIGHTEST],
            "the design pose is not free",
            0,
        )
    low, high = mechanism.limits if limits is None else limits
    ways = [search.march(end, progress) for end in (low, high)]
    below, above = ([_contact(search, bodies, near) for near in way.stops] for way in ways)
    examined = sum(way.examined for way in ways)
    return FreeMotion(
        ways[0].reached,
        ways[1].reached,
        design,
        tuple(below),
        tuple(above),
        tuple(_contact(search, bodies, near) for near in _tightest(ways)),
        _certificate(examined, len(search.pieces)),
        examined,
    )


def poses_to_confirm(motion: FreeMotion, between: int = 3) -> tuple[float, ...]:
    """Driving angles [rad] at which meshes are measured to confirm a proven range.

    The ends of the range, the design, the tightest poses and `between` evenly spaced ones.
    """
    even = np.linspace(motion.low, motion.high, between + 2)
    tight = [contact.t for contact in motion.tightest]
    return tuple(sorted({float(t) for t in (*even, motion.design, *tight)}))


def standing(
    mechanism: Mechanism,
    bodies: Sequence[Body],
    *,
    joint_clearance: float = JOINT_CLEARANCE,
) -> tuple[Contact, ...]:
    """Parts whose distance never changes and is below `joint_clearance` [mm], worst first.

    Eyes and bars of neighbours on one pin, parts along one bar; not what is fitted on one pin. An
    empty answer means that the levels keep them apart in every pose.
    """
    search = _search(mechanism, bodies, joint_clearance, joint_clearance)
    return tuple(_contact(search, bodies, near) for near in search.standing())


def _search(
    mechanism: Mechanism, bodies: Sequence[Body], clearance: float, joint_clearance: float
) -> Search:
    seen: dict[int, str] = {}
    for body in bodies:
        if body.bar >= 0 and body.bar in seen:
            raise DetailError(f"bar {body.bar} has two links, {seen[body.bar]} and {body.mark}")
        seen[body.bar] = body.mark
    pieces = ConvexPieces.build(mechanism, bodies)
    return Search(mechanism, pieces, Rules.build(mechanism, bodies, clearance, joint_clearance))


def _tightest(ways: Sequence[March]) -> list[Near]:
    """The nearest pairs of both ways, one entry a pair of bodies."""
    best: dict[tuple[int, int], Near] = {}
    for way in ways:
        for key, near in way.nearest.items():
            if key not in best or near.gap - near.limit < best[key].gap - best[key].limit:
                best[key] = near
    return sorted(best.values(), key=lambda near: near.gap - near.limit)[:TIGHTEST]


def _contact(search: Search, bodies: Sequence[Body], near: Near) -> Contact:
    """A pair of pieces as a contact of its bodies."""
    a, b = np.array([near.a]), np.array([near.b])
    placed = search.placed(near.t, a, b)
    found = gaps(search.pieces, placed)
    along = [
        float(turn[0, :, 0] @ (point[0] - at[0]))
        for turn, at, point in (
            (placed.turn_a, placed.at_a, found.point_a),
            (placed.turn_b, placed.at_b, found.point_b),
        )
    ]
    middle = (found.point_a[0] + found.point_b[0]) / 2
    body = search.pieces.body
    return Contact(
        (bodies[body[near.a]].mark, bodies[body[near.b]].mark),
        near.t,
        near.gap,
        near.limit,
        (float(middle[0]), float(middle[1]), float(middle[2])),
        (along[0], along[1]),
    )


def _certificate(examined: int, pieces: int) -> str:
    return (
        f"{examined} pairs of {pieces} convex pieces times intervals, between samples by bounds on "
        "accelerations that are proven up to the rounding of float64"
    )


@dataclass(frozen=True)
class Widened(Generic[Option]):
    """What was tried to widen the range: the best option and every option's motion."""

    best: Option
    motion: FreeMotion
    tried: tuple[tuple[Option, FreeMotion], ...]


def maximize_range(
    options: Iterable[Option], evaluate: Callable[[Option], FreeMotion], *, enough: float = np.inf
) -> Widened[Option]:
    """The option of the greatest free range; the first of equals.

    Parameters
    ----------
    options : anything, such as settings with slimmer bars or other offsets along the hinges
    evaluate : the free motion with an option
    enough : stop at the first range of so much [rad]

    Raises
    ------
    DetailError
        No options.
    """
    tried: list[tuple[Option, FreeMotion]] = []
    for option in options:
        tried.append((option, evaluate(option)))
        if tried[-1][1].range >= enough:
            break
    if not tried:
        raise DetailError("no options were given that could widen the range")
    best = max(tried, key=lambda pair: pair[1].range)
    return Widened(best[0], best[1], tuple(tried))

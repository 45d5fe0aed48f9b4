"""The march along the driving angle: no angle and no pair is left out of what is proven."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from test_motion_free_range import CLEARANCE, kit, reference, the_cube

from ddgfab.linkages.cauchy import Numbers
from ddgfab.linkages.mechanism import Bounds, Drive
from ddgfab.mesh import Floats
from fabrication.motion.contacts import gaps
from fabrication.motion.convex import Body, ConvexPieces, capsule, cylinder
from fabrication.motion.free_range import _tightest, free_motion, standing
from fabrication.motion.pairs import Rules
from fabrication.motion.proof import March, Near, Search


@dataclass
class Recorded:
    """A drive that notes the intervals over which bounds were asked for."""

    drive: Drive
    asked: list[tuple[float, float]] = field(default_factory=list)

    def place(self, ts: Numbers) -> tuple[Numbers, Numbers]:
        return self.drive.place(ts)

    def bounds(self, ts: Floats, half: Floats) -> Bounds:
        self.asked += zip((ts - half).tolist(), (ts + half).tolist(), strict=True)
        return self.drive.bounds(ts, half)


def test_bounds_are_asked_for_every_angle_of_the_range() -> None:
    mechanism, bodies = reference()
    drive = Recorded(mechanism.drive)
    limits = (mechanism.design - 0.21, mechanism.design + 0.33)
    motion = free_motion(replace(mechanism, drive=drive), bodies, CLEARANCE, limits=limits)
    assert (motion.low, motion.high) == pytest.approx(limits)
    reached = motion.low
    for low, high in sorted(drive.asked):
        assert low <= reached + 1e-12
        reached = max(reached, high)
    assert reached >= motion.high - 1e-12


def test_no_pair_that_comes_near_is_missing_from_the_tasks() -> None:
    """All pairs at many angles of an interval against those chosen at its middle."""
    mechanism, bodies = the_cube()
    pieces = ConvexPieces.build(mechanism, bodies)
    rules = Rules.build(mechanism, bodies, 8.0, 4.0)
    search = Search(mechanism, pieces, rules)
    a, b = np.triu_indices(len(pieces), 1)
    moving = (pieces.body[a] != pieces.body[b]) & ~rules.rigid(pieces, a, b)
    a, b = a[moving], b[moving]
    needed = rules.needed(pieces, a, b)
    middle, half = np.array([mechanism.design - 0.3, mechanism.design + 0.4]), np.full(2, 0.12)
    frames, rates = mechanism.moving_frames(middle)
    pull = search._pull(mechanism.drive.bounds(middle, half))
    tasks = search._tasks(middle, half, frames, rates, pull)
    counts = []
    for cell in range(2):
        chosen = set(zip(tasks.a[tasks.cell == cell], tasks.b[tasks.cell == cell], strict=True))
        near = np.zeros(len(a), dtype=bool)
        for t in np.linspace(middle[cell] - half[cell], middle[cell] + half[cell], 3):
            near |= gaps(pieces, search.placed(float(t), a, b)).gap < needed
        counts.append((int(near.sum()), len(chosen), len(a)))
        assert set(zip(a[near], b[near], strict=True)) <= chosen
    assert all(near > 10 and chosen < 0.7 * every for near, chosen, every in counts)


@pytest.mark.parametrize("degrees", [97.0, 83.0])
def test_a_pair_that_grazes_its_limit_ends_the_range_and_is_named(degrees: float) -> None:
    """A needle that passes a ball with a picometre to spare: nowhere too near, yet not provable.

    Above and below the design, which is at 90 degrees.
    """
    loop, _ = reference()
    far, at = loop.lengths[2] - 20.0, float(np.radians(degrees))
    tip = (loop.bar_frames(loop.pose(at))[2] @ np.array([far, 0.0, 40.0, 1.0]))[:3]
    aside = np.array([0.0, 0.0, 6.0])
    thin = 0.05

    def pair(radius: float) -> list[Body]:
        needle = Body("needle", (capsule([far, 0, 39.8], [far, 0, 40.2], thin),), bar=2)
        ball = Body("ball", (capsule(tip + aside, tip + aside + 1e-3, radius),), bar=0)
        return [needle, ball]

    bodies = pair(thin)
    pieces = ConvexPieces.build(loop, bodies)
    search = Search(loop, pieces, Rules.build(loop, bodies, CLEARANCE, 0.1))
    one, two = np.array([0]), np.array([1])
    limit = float(search.rules.needed(pieces, one, two)[0])

    def gap(t: float) -> float:
        return float(gaps(pieces, search.placed(t, one, two)).gap[0])

    between = (at - 0.2, at + 0.2)
    found = minimize_scalar(gap, bounds=between, method="bounded", options={"xatol": 1e-9})
    room = thin + found.fun - limit
    limits = (min(loop.design, at - 0.1), max(loop.design, at + 0.1))
    motion = free_motion(loop, pair(room - 1e-9), CLEARANCE, limits=limits)
    (contact,) = motion.contacts
    assert set(contact.marks) == {"needle", "ball"}
    assert limit <= contact.gap < limit + 1e-3
    end = motion.high if at > loop.design else motion.low
    assert end == contact.t == pytest.approx(at, abs=1e-3)
    assert free_motion(loop, pair(room - 0.01), CLEARANCE, limits=limits).contacts == ()


@pytest.mark.parametrize("make", [reference, the_cube])
def test_pairs_count_as_rigid_if_their_distance_never_changes(make: Any) -> None:
    """By the rules, against the distances in a few poses."""
    mechanism, bodies = make()
    pieces = ConvexPieces.build(mechanism, bodies)
    rules = Rules.build(mechanism, bodies, CLEARANCE, 0.1)
    search = Search(mechanism, pieces, rules)
    a, b = np.triu_indices(len(pieces), 1)
    other = pieces.body[a] != pieces.body[b]
    a, b = a[other], b[other]
    low, high = mechanism.limits
    ts = mechanism.design + np.array([-0.37, 0.0, 0.41]) * min(1.0, (high - low) / 4)
    found = np.array([gaps(pieces, search.placed(float(t), a, b)).gap for t in ts])
    apart = (found > 1e-3).all(axis=0)  # where pieces overlap their gap says little
    still = np.ptp(found, axis=0) < 3e-4
    rigid = rules.rigid(pieces, a, b)
    assert np.array_equal(rigid, rules.rigid(pieces, b, a))
    assert still[apart & rigid].all()
    assert not still[apart & ~rigid].any()
    assert min((apart & rigid).sum(), (apart & ~rigid).sum()) > 5


def test_what_stands_too_near_on_one_pin() -> None:
    """Eyes of two links and what meets a bar are told; what is fitted on one pin is not."""
    loop, _ = reference()
    links = kit(loop, np.zeros(4))[:4]
    eyes = [replace(link, pieces=link.pieces[:2]) for link in links]
    found = {frozenset(contact.marks) for contact in standing(loop, eyes)}
    shared = {
        frozenset((f"L{i}", f"L{j}"))
        for i, j in combinations(range(4), 2)
        if set(loop.bars[i]) & set(loop.bars[j])
    }
    assert found == shared
    pin = Body("pin", (cylinder([0, 0, -9], [0, 0, 9], 1.5),), hinge=0)
    ring = Body("ring", (cylinder([0, 0, -1], [0, 0, 1], 3.0),), hinge=0)
    assert standing(loop, [pin, ring]) == ()
    bars = [replace(link, pieces=link.pieces[2:]) for link in links if 0 in loop.bars[link.bar]]
    wide = replace(ring, pieces=(cylinder([0, 0, -1], [0, 0, 1], 8.0),))
    found = {frozenset(contact.marks) for contact in standing(loop, [wide, *bars[:1]])}
    assert found == {frozenset(("ring", bars[0].mark))}


def test_the_nearest_of_both_ways_is_reported() -> None:
    """By the gap over its limit, not by the gap."""

    def near(gap: float, limit: float) -> Near:
        return Near(0, 1, 0.0, gap, limit)

    up = {(0, 1): near(0.5, 0.4), (0, 2): near(0.45, 0.1), (1, 2): near(0.9, 0.4)}
    down = {(0, 1): near(0.3, 0.1), (0, 2): near(0.6, 0.4), (2, 3): near(0.41, 0.4)}
    ways = [March(0.0, (), nearest, 1) for nearest in (up, down)]
    for order in (ways, ways[::-1]):
        found = _tightest(order)
        assert [n.gap for n in found] == [0.41, 0.5, 0.6, 0.9]


def test_capsules_fit_round_pieces_exactly() -> None:
    loop, _ = reference()
    rng = np.random.default_rng(5)
    for start, end in rng.uniform(-5, 5, (6, 2, 3)):
        bodies = [Body("c", (capsule(start, end, 0.7),), bar=0)]
        bodies += [Body("d", (cylinder(start, end, 9.0),), bar=0)]
        pieces = ConvexPieces.build(loop, bodies)
        assert pieces.radius == pytest.approx([0.7, 9.0])
        for segment in pieces.segment:
            forth = np.abs(segment - [start, end]).max()
            assert min(forth, np.abs(segment - [end, start]).max()) < 1e-9

"""Free motion: distances, proofs between samples, the ranges of kits; second routes throughout."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.errors import DetailError, InputError
from ddgfab.linkages import Mechanism, bennett, cube, knet_mechanism
from ddgfab.nets.knet import knet
from fabrication.motion.contacts import PairMotions, PlacedPairs, gaps, margin, segment_gaps
from fabrication.motion.convex import Body, ConvexPiece, ConvexPieces, capsule, cylinder, hull
from fabrication.motion.free_range import free_motion, maximize_range, standing
from fabrication.motion.pairs import Rules, near_pairs
from fabrication.motion.proof import RESOLUTION, Search

PITCH = 6.4
CLEARANCE = 0.4


def kit(mechanism: Mechanism, levels: np.ndarray, *, radius: float = 2.5) -> list[Body]:
    """Eyes of 10 x 6 mm at levels along the hinges, round straight bars, 3 mm pins."""
    bodies = []
    for e in range(mechanism.n_bars):
        twist, height = mechanism.twists[e], levels[e] * PITCH
        axes = np.array([[0, 0, 1.0], [0, -np.sin(twist), np.cos(twist)]])
        ends = np.array([[0, 0, 0.0], [mechanism.lengths[e], 0, 0]]) + height * axes
        eyes = [
            cylinder(end - 3 * axis, end + 3 * axis, 5.0, eye=int(hinge))
            for end, axis, hinge in zip(ends, axes, mechanism.bars[e], strict=True)
        ]
        # The bar starts outside the pin, inside the eye.
        inside = 4.2 * (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
        bar = capsule(ends[0] + inside, ends[1] - inside, radius)
        bodies.append(Body(f"L{e}", (*eyes, bar), bar=e))
    for v in range(mechanism.n_hinges):
        here = levels[(mechanism.bars == v).any(axis=1)] * PITCH
        pin = cylinder([0, 0, here.min() - 3.5], [0, 0, here.max() + 3.5], 1.5)
        bodies.append(Body(f"H{v}", (pin,), hinge=v))
    return bodies


def reference(driver: float = 90.0) -> tuple[Mechanism, list[Body]]:
    loop = bennett(100.0, np.radians(40), beta=np.radians(70), driver=np.radians(driver))
    return loop, kit(loop, np.array([0.5, 0.5, -0.5, -0.5]))


def the_cube(longest: float = 110.0) -> tuple[Mechanism, list[Body]]:
    twists = np.radians([58.0, 131.0, 50.0])
    lengths = longest * np.sin(twists) / np.sin(twists).max()
    corners = (np.radians(123.0), np.radians(45.0))
    mechanism = cube(lengths, twists, corners=corners, rates=(8.0, -5.0))
    return mechanism, kit(mechanism, np.array([-1, 1, 0])[mechanism.directions])


def a_net(m: int, n: int) -> tuple[Mechanism, list[Body]]:
    net = knet([np.full(m, 0.3), np.full(n, 0.3)], [np.zeros(m - 1), np.zeros(n - 1)], 1.5)
    mechanism = knet_mechanism(net, scale_mm=180.0)
    place = mechanism.bars[:, 0] // (n + 1) + mechanism.bars[:, 0] % (n + 1)
    return mechanism, kit(mechanism, 2 * (place % 2) + mechanism.directions)


# --- distances -------------------------------------------------------------------------------


def random_pieces(rng: np.random.Generator, count: int) -> list[ConvexPiece]:
    out: list[ConvexPiece] = []
    for k in range(count):
        a, b = rng.uniform(-5, 5, (2, 3))
        match k % 3:
            case 0:
                out.append(capsule(a, b, rng.uniform(0.2, 1)))
            case 1:
                out.append(cylinder(a, b, rng.uniform(0.5, 3)))
            case _:
                out.append(hull(a + rng.uniform(-2, 2, (8, 3))))
    return out


def placed(
    pieces: list[ConvexPiece], seed: int = 0
) -> tuple[ConvexPieces, PlacedPairs, np.ndarray]:
    """All pairs of pieces in random frames."""
    loop, _ = reference()
    made = ConvexPieces.build(
        loop, [Body(f"P{k}", (piece,), bar=0) for k, piece in enumerate(pieces)]
    )
    rng = np.random.default_rng(seed)
    frames = np.tile(np.eye(4), (len(pieces), 1, 1))
    frames[:, :3, :3] = np.linalg.qr(rng.normal(size=(len(pieces), 3, 3)))[0]
    frames[:, :3, :3] *= np.linalg.det(frames[:, :3, :3])[:, None, None]
    frames[:, :3, 3] = rng.uniform(-10, 10, (len(pieces), 3))
    a, b = np.triu_indices(len(pieces), 1)
    return made, PlacedPairs.build(made, a, b, frames[a], frames[b]), frames


def test_gaps_are_enclosed() -> None:
    """The bound is proven by a plane, the gap is reached by two points: they agree."""
    made, pairs, _ = placed(random_pieces(np.random.default_rng(1), 24))
    found = gaps(made, pairs)
    apart = found.gap > 0
    assert 100 < apart.sum() < len(apart)
    assert (found.bound <= found.gap + 1e-9).all()
    assert (found.gap - found.bound)[apart].max() < 2e-4
    balls = made.ball[pairs.a] + made.ball[pairs.b]
    reached = np.linalg.norm(found.point_b - found.point_a, axis=1) - balls
    assert reached[apart] == pytest.approx(found.gap[apart], abs=1e-9)
    # The capsule around a piece is never farther than the piece.
    outer, _ = segment_gaps(made, pairs)
    assert (outer <= found.gap + 1e-4)[apart].all()


def test_gaps_of_hulls_against_manifold() -> None:
    """Boxes: manifold3d's min_gap is another algorithm."""
    manifold3d = pytest.importorskip("manifold3d")
    rng = np.random.default_rng(4)
    pieces = [hull(rng.uniform(-3, 3, (10, 3))) for _ in range(8)]
    made, pairs, frames = placed(pieces, 2)
    solids = [
        manifold3d.Manifold.hull_points(piece.points).transform(frame[:3])
        for piece, frame in zip(pieces, frames, strict=True)
    ]
    found = gaps(made, pairs)
    for k, (a, b) in enumerate(zip(pairs.a, pairs.b, strict=True)):
        other = solids[a].min_gap(solids[b], 100.0)
        assert max(found.gap[k], 0.0) == pytest.approx(other, abs=3e-4)


def test_discs_face_to_face() -> None:
    """Coaxial eyes 0.4 apart: the direction is the axis, where rounding decides the disc's side."""
    for seed in range(20):
        rng = np.random.default_rng(seed)
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        at = rng.uniform(-100, 100, 3)
        pieces = [
            cylinder(at, at + 6 * axis, 5.0),
            cylinder(at + 6.4 * axis, at + 12.4 * axis, 5.0),
        ]
        loop, _ = reference()
        made = ConvexPieces.build(loop, [Body(str(k), (p,), bar=0) for k, p in enumerate(pieces)])
        still = np.eye(4)[None]
        pair = PlacedPairs.build(made, np.array([0]), np.array([1]), still, still)
        found = gaps(made, pair)
        assert found.gap[0] == pytest.approx(0.4, abs=1e-4)
        assert found.bound[0] == pytest.approx(0.4, abs=1e-3)


def test_near_pairs_miss_none() -> None:
    mechanism, bodies = a_net(3, 3)
    pieces = ConvexPieces.build(mechanism, bodies)
    frames = mechanism.bar_frames(mechanism.pose(mechanism.design))
    extra = np.random.default_rng(0).uniform(0, 3, len(pieces))
    a, b = near_pairs(pieces, frames, extra)
    got = set(zip(a.tolist(), b.tolist(), strict=True))
    every = np.array(np.triu_indices(len(pieces), 1))
    every = every[:, pieces.body[every[0]] != pieces.body[every[1]]]
    pairs = PlacedPairs.build(
        pieces, every[0], every[1], frames[pieces.bar[every[0]]], frames[pieces.bar[every[1]]]
    )
    outer, _ = segment_gaps(pieces, pairs)
    need = outer <= extra[every[0]] + extra[every[1]]
    assert {(int(i), int(j)) for i, j in every[:, need].T} <= got
    assert len(got) < 0.2 * every.shape[1]


# --- proofs ----------------------------------------------------------------------------------


def test_margins_hold_over_intervals() -> None:
    """Never above the least distance found by dense samples; above it by little when short."""
    mechanism, bodies = the_cube()
    pieces = ConvexPieces.build(mechanism, bodies)
    rules = Rules.build(mechanism, bodies, CLEARANCE, 0.1)
    search = Search(mechanism, pieces, rules)
    a, b = np.triu_indices(len(pieces), 1)
    keep = (pieces.body[a] != pieces.body[b]) & ~rules.rigid(pieces, a, b)
    a, b = a[keep], b[keep]
    t = mechanism.design - 0.2
    for half in (0.02, 0.004):
        bounds = mechanism.drive.bounds(np.array([t]), np.array([half]))
        pull = search._pull(bounds)
        pairs, moving = states(search, t, half, a, b, pull)
        lower = margin(pieces, pairs, moving, gaps(pieces, pairs).normal)
        least = np.full(len(a), np.inf)
        for s in np.linspace(-half, half, 9):
            least = np.minimum(least, gaps(pieces, search.placed(t + s, a, b)).gap)
        assert (lower <= least + 2e-4).all()
        assert np.median(least - lower) < 250 * half**2 + 2e-3


def states(
    search: Search, t: float, half: float, a: np.ndarray, b: np.ndarray, pull: np.ndarray
) -> tuple[PlacedPairs, PairMotions]:
    from fabrication.motion.proof import Tasks

    count = len(a)
    tasks = Tasks(np.full(count, t), np.full(count, half), np.zeros(count, dtype=int), a, b)
    return search._states(tasks, pull)


def clear(mechanism: Mechanism, bodies: list[Body], t: float, slack: float = 0.0) -> bool:
    """Whether all moving pairs keep their limits in one pose: every pair, no proof."""
    pieces = ConvexPieces.build(mechanism, bodies)
    rules = Rules.build(mechanism, bodies, CLEARANCE, 0.1)
    a, b = np.triu_indices(len(pieces), 1)
    keep = (pieces.body[a] != pieces.body[b]) & ~rules.rigid(pieces, a, b)
    a, b = a[keep], b[keep]
    found = gaps(pieces, Search(mechanism, pieces, rules).placed(t, a, b))
    return bool((found.gap >= rules.needed(pieces, a, b) - slack).all())


@pytest.mark.parametrize("make", [reference, the_cube, lambda: a_net(2, 2)])
def test_ranges_against_dense_samples(make: object) -> None:
    mechanism, bodies = make()  # type: ignore[operator]
    motion = free_motion(mechanism, bodies, CLEARANCE)
    assert motion.proven
    assert motion.low < mechanism.design < motion.high
    for t in np.linspace(motion.low, motion.high, 60):
        assert clear(mechanism, bodies, float(t), 2e-4)
    for t, contacts in (
        (motion.low - 8 * RESOLUTION, motion.below),
        (motion.high + 8 * RESOLUTION, motion.above),
    ):
        assert contacts
        assert not clear(mechanism, bodies, float(t))
    for contact in motion.tightest:
        assert motion.low - 1e-9 <= contact.t <= motion.high + 1e-9
        assert contact.gap >= contact.limit


def test_reference_case() -> None:
    """docs/parts.md: arcs 18-174 and 186-343 deg of the joint angle theta = 180 - phi, at 0.4 mm.

    With eyes of 10 mm and 3 mm pins the arcs are 18.9-174.0 and 186.0-341.1 deg here; for the bars
    alone they are 13.6-175.7 and 184.3-346.4 deg, so the two degrees of difference are the joints'
    (what sits on the pins, and levels symmetric about the hinge points).
    """
    arcs = []
    for driver in (270.0, 90.0):
        motion = free_motion(*reference(driver), CLEARANCE)
        ends = np.sort(np.remainder(180.0 - np.degrees([motion.low, motion.high]), 360.0))
        arcs.append(ends)
    assert arcs[1] == pytest.approx([18.0, 174.0], abs=2.0)
    assert arcs[0] == pytest.approx([186.0, 343.0], abs=2.0)


def test_default_kits_move_through_120_degrees() -> None:
    assert np.degrees(free_motion(*reference(), CLEARANCE).range) > 120
    motion = free_motion(*the_cube(), CLEARANCE)
    assert np.degrees(motion.range) > 120


def test_an_obstacle_between_samples_is_found() -> None:
    """A needle that meets a ball for half a degree, at every place within the first intervals."""
    loop, bodies = reference()
    far = loop.lengths[2] - 20.0
    found = []
    for at in np.radians([95.3, 96.1, 97.0, 97.9]):
        # A ball on bar 0's frame (the ground), where the needle's tip of bar 2 passes at `at`.
        tip = loop.bar_frames(loop.pose(float(at)))[2] @ np.array([far, 0.0, 40.0, 1.0])
        needle = Body("needle", (capsule([far, 0, 39.8], [far, 0, 40.2], 0.05),), bar=2)
        ball = Body("ball", (capsule(tip[:3], tip[:3] + 1e-3, 0.05),), bar=0)
        extra = [body for body in bodies if body.mark not in ("L0", "L2")]
        motion = free_motion(loop, [*extra, needle, ball], CLEARANCE)
        found.append(at - motion.high)
        assert {"needle", "ball"} in [set(contact.marks) for contact in motion.above]
        assert not clear(loop, [needle, ball], float(at))
        assert clear(loop, [needle, ball], float(at) + np.radians(0.5))
    assert (np.abs(np.degrees(found)) < 0.5).all()


def test_contacts_say_where() -> None:
    mechanism, bodies = the_cube()
    motion = free_motion(mechanism, bodies, CLEARANCE)
    contact = motion.above[0]
    assert contact.gap < contact.limit
    assert contact.t == pytest.approx(motion.high, abs=np.radians(0.05))
    bars = [int(mark[1:]) for mark in contact.marks if mark.startswith("L")]
    for bar, along in zip(bars, contact.along, strict=False):
        assert -6 < along < mechanism.lengths[bar] + 6
    frames = mechanism.bar_frames(mechanism.pose(contact.t))
    local = np.linalg.inv(frames[bars[0]]) @ np.array([*contact.point, 1.0])
    assert local[0] == pytest.approx(contact.along[contact.marks.index(f"L{bars[0]}")], abs=5.0)


def test_a_design_that_is_not_free() -> None:
    loop, _ = reference()
    bodies = kit(loop, np.zeros(4))
    motion = free_motion(loop, bodies, CLEARANCE)
    assert motion.low == motion.high == loop.design
    assert motion.range == 0
    assert not motion.proven
    assert motion.contacts
    # All eyes of a pin on one level: that never changes either.
    assert len(standing(loop, bodies)) >= 4
    assert standing(*reference()) == ()


def test_limits_end_a_range() -> None:
    loop, bodies = reference()
    motion = free_motion(loop, bodies, CLEARANCE, limits=(np.radians(60), np.radians(100)))
    assert np.degrees([motion.low, motion.high]) == pytest.approx([60, 100])
    assert motion.contacts == ()


def test_progress_and_widening() -> None:
    reached: list[float] = []
    loop, _ = reference()

    def evaluate(radius: float) -> object:
        bodies = kit(loop, np.array([0.5, 0.5, -0.5, -0.5]), radius=radius)
        return free_motion(loop, bodies, CLEARANCE, progress=reached.append)

    wider = maximize_range([2.9, 2.5, 1.5], evaluate)  # type: ignore[arg-type]
    assert wider.best == 1.5
    ranges = [motion.range for _, motion in wider.tried]
    assert ranges == sorted(ranges)
    assert wider.motion.range == ranges[-1]
    assert min(reached) < loop.design < max(reached)
    early = maximize_range([2.5, 1.5], evaluate, enough=np.radians(120))  # type: ignore[arg-type]
    assert early.best == 2.5
    assert len(early.tried) == 1
    with pytest.raises(DetailError, match="no options"):
        maximize_range([], evaluate)  # type: ignore[arg-type]


def test_bad_bodies() -> None:
    loop, bodies = reference()
    with pytest.raises(DetailError, match="two links"):
        free_motion(loop, [*bodies, Body("again", bodies[0].pieces, bar=0)], CLEARANCE)
    for body, words in (
        (Body("x", bodies[0].pieces), "frame of a bar"),
        (Body("x", bodies[0].pieces, bar=9), "bar 9"),
        (Body("x", (), bar=0), "without pieces"),
    ):
        with pytest.raises(InputError, match=words):
            ConvexPieces.build(loop, [body])
    with pytest.raises(InputError, match="no length"):
        cylinder([0, 0, 0], [0, 0, 0], 1.0)

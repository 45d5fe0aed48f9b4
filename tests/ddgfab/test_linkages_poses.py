"""Poses of linkages: bars keep lengths and twists, angles obey the closure, other routes agree."""

from __future__ import annotations

import re

import numpy as np
import pytest

from ddgfab.errors import InputError
from ddgfab.linkages import (
    Mechanism,
    Pose,
    bar_lengths,
    bennett,
    crab_mechanism,
    cube,
    flex,
    knet_mechanism,
    signed_twists,
)
from ddgfab.linkages.assemble import crossings, isogram_angles
from ddgfab.nets.knet.crab import crab_net
from ddgfab.nets.knet.dini_net import dini
from ddgfab.nets.knet.net import KNet, knet

EXACT = 1e-12


def a_net(m: int, n: int, seed: int = 0) -> KNet:
    rng = np.random.default_rng(seed)
    deltas = [rng.uniform(0.2, 0.5, size) for size in (m, n)]
    turns = [rng.uniform(-0.2, 0.2, size - 1) for size in (m, n)]
    return knet(deltas, turns, 1.3)


def a_cube(rates: tuple[float, float] = (1.0, -1.0)) -> Mechanism:
    twists = np.radians([30.0, 150.0, 90.0])
    return cube(100 * np.sin(twists), twists, corners=(1.0, -1.0), rates=rates)


MECHANISMS = {
    "bennett": lambda: bennett(100.0, np.radians(40), beta=np.radians(70)),
    "other hand": lambda: bennett(80.0, np.radians(30), beta=np.radians(150)),
    "cube": a_cube,
    "knet": lambda: knet_mechanism(a_net(4, 3), scale_mm=100.0),
    "knet fold": lambda: knet_mechanism(a_net(3, 5), scale_mm=100.0, path="fold"),
    "knet corner": lambda: knet_mechanism(a_net(3, 2), scale_mm=90.0, anchor=(0, 0)),
    "crab": lambda: crab_mechanism(crab_net(6, np.radians(30), np.radians(60), 5), scale_mm=90.0),
    "crab of three rings": lambda: crab_mechanism(crab_net(6, 0.5, 1.0, 3), scale_mm=90.0),
    "crab wide": lambda: crab_mechanism(crab_net(7, np.radians(110), np.radians(60), 4)),
}


@pytest.fixture(params=list(MECHANISMS), scope="module")
def mechanism(request: pytest.FixtureRequest) -> Mechanism:
    made: Mechanism = MECHANISMS[request.param]()
    return made


def inside(mechanism: Mechanism, count: int = 9) -> np.ndarray:
    low, high = mechanism.limits
    return np.linspace(low, high, count + 2)[1:-1]


def test_bars_are_rigid_in_every_pose(mechanism: Mechanism) -> None:
    poses = mechanism.poses(inside(mechanism))
    for k in range(len(poses.points)):
        size = mechanism.lengths.max()
        assert (
            np.abs(bar_lengths(poses[k], mechanism.bars) - mechanism.lengths).max() < EXACT * size
        )
        turn = signed_twists(poses[k], mechanism.bars) - mechanism.twists
        assert np.abs(turn).max() < EXACT
        for hinge in (0, 1):
            i, j = mechanism.bars.T
            edge = poses[k].points[j] - poses[k].points[i]
            axis = poses[k].axes[mechanism.bars[:, hinge]]
            assert np.abs(np.einsum("ei,ei->e", edge, axis)).max() < EXACT * size
    assert np.abs(np.linalg.norm(poses.axes, axis=-1) - 1).max() < EXACT
    assert (np.abs(mechanism.twists) <= np.pi / 2 + EXACT).all()


def test_the_first_bar_stays(mechanism: Mechanism) -> None:
    poses = mechanism.poses(inside(mechanism))
    frames = mechanism.bar_frames(poses)
    assert np.abs(frames[:, 0] - np.eye(4)).max() < EXACT
    turn = frames[..., :3, :3]
    assert np.abs(turn @ np.swapaxes(turn, -1, -2) - np.eye(3)).max() < EXACT
    assert np.abs(np.linalg.det(turn) - 1).max() < EXACT
    one = mechanism.pose(mechanism.design)
    stacked = mechanism.poses([mechanism.design])
    assert np.array_equal(one.points, stacked.points[0])


def test_second_hinge_in_the_frame_of_a_bar(mechanism: Mechanism) -> None:
    pose = mechanism.pose(mechanism.design)
    frames = mechanism.bar_frames(pose)
    end = frames[:, :3, 3] + mechanism.lengths[:, None] * frames[:, :3, 0]
    assert np.allclose(end, pose.points[mechanism.bars[:, 1]], atol=1e-10)
    s, c = np.sin(mechanism.twists)[:, None], np.cos(mechanism.twists)[:, None]
    axis = -s * frames[:, :3, 1] + c * frames[:, :3, 2]
    assert np.allclose(axis, pose.axes[mechanism.bars[:, 1]], atol=1e-10)


def test_motion_is_continuous_and_rates_are_exact(mechanism: Mechanism) -> None:
    t, h = mechanism.design, 1e-5
    _, rates = mechanism.moving_frames([t])
    ahead, _ = mechanism.moving_frames([t + h])
    behind, _ = mechanism.moving_frames([t - h])
    scale = mechanism.lengths.max()
    assert np.abs((ahead - behind) / (2 * h) - rates).max() < 1e-7 * scale


def test_every_isogram_is_a_bennett_loop(mechanism: Mechanism) -> None:
    """Opposite sides equal, one ratio, and a half-turn that exchanges opposite corners (3.6)."""
    for t in inside(mechanism, 4):
        pose = mechanism.pose(t)
        corners = pose.points[mechanism.cells]
        sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
        assert np.allclose(sides[:, :2], sides[:, 2:], rtol=1e-10)
        middles = (corners[:, :2] + corners[:, 2:]) / 2
        axis = middles[:, 1] - middles[:, 0]
        size = np.linalg.norm(axis, axis=1)
        good = size > 1e-6 * sides.max()
        axis = axis[good] / size[good, None]
        offset = corners[good] - middles[good, :1]
        along = np.einsum("fki,fi->fk", offset, axis)[:, :, None]
        turned = 2 * along * axis[:, None] - offset
        assert np.abs(turned - np.roll(offset, 2, axis=1)).max() < 1e-8 * sides.max()


def test_bennett_angles_close() -> None:
    """tan(phi/2) tan(psi/2) = sin((beta - alpha)/2) / sin((beta + alpha)/2), the whole circle."""
    alpha, beta = np.radians(40), np.radians(70)
    loop = bennett(100.0, alpha, beta=beta)
    assert loop.lengths == pytest.approx([100, 100, 146.1902200, 146.1902200], abs=1e-6)
    assert np.degrees(loop.twists) == pytest.approx([40, 40, 70, 70])
    ts = np.radians([10.0, 90.0, 170.0, 190.0, 300.0])
    poses = loop.poses(ts)
    phi = isogram_angles(poses.points, poses.axes, loop.cells)[:, 0]
    assert np.remainder(phi - ts + np.pi, 2 * np.pi) == pytest.approx(np.pi)
    # psi at hinge 2, from bar 0 (backwards) to bar 3.
    back = poses.points[:, 0] - poses.points[:, 2]
    on = poses.points[:, 3] - poses.points[:, 2]
    cosine = np.einsum("ti,ti->t", back, on) / (100 * loop.lengths[2])
    ratio = np.sin((beta - alpha) / 2) / np.sin((beta + alpha) / 2)
    assert np.abs(np.tan(ts / 2)) * np.tan(np.arccos(cosine) / 2) == pytest.approx(abs(ratio))
    assert [round(np.degrees(t)) for t, _ in loop.dead_points] == [0, 180]
    folded = loop.pose(np.pi)
    assert np.linalg.matrix_rank(folded.points - folded.points[0], tol=1e-9) == 1


def test_bennett_is_the_classical_loop() -> None:
    """Product of the four Denavit-Hartenberg steps is the identity, joint angles pi - phi, ..."""
    a, alpha, beta = 60.0, np.radians(25), np.radians(100)
    b = a * np.sin(beta) / np.sin(alpha)
    ratio = np.sin((beta + alpha) / 2) / np.sin((beta - alpha) / 2)

    def step(turn: float, length: float, twist: float) -> np.ndarray:
        c, s, ct, st = np.cos(turn), np.sin(turn), np.cos(twist), np.sin(twist)
        return np.array(
            [
                [c, -s * ct, s * st, length * c],
                [s, c * ct, -c * st, length * s],
                [0, st, ct, 0],
                [0, 0, 0, 1],
            ]
        )

    theta = 1.1
    eta = 2 * np.arctan(ratio / np.tan(theta / 2))
    product = (
        step(theta, a, alpha) @ step(eta, b, beta) @ step(-theta, a, alpha) @ step(-eta, b, beta)
    )
    # The joint angles are theta, eta, -theta, -eta up to whole turns of the axes.
    signs = [product]
    for s in ((1, 1), (1, -1)):
        signs.append(
            step(theta, a, alpha)
            @ step(eta, b, beta)
            @ step(s[0] * theta, a, alpha)
            @ step(s[1] * eta, b, beta)
        )
    assert min(np.abs(p - np.eye(4)).max() for p in signs) < 1e-10
    loop = bennett(a, alpha, beta=beta)
    diagonal = np.linalg.norm(np.diff(loop.pose(np.pi - theta).points[[1, 2]], axis=0))
    classical = np.sqrt(a * a + b * b + 2 * a * b * np.cos(theta))
    assert diagonal == pytest.approx(classical)


@pytest.mark.parametrize("anchor", [(0, 0), (1, 1), (3, 2), (2, 0)])
def test_knet_poses_are_the_flexed_net(anchor: tuple[int, int]) -> None:
    """Second route: the net rebuilt from Cauchy data at its own corner, by the other evolution."""
    net = a_net(4, 3)
    mechanism = knet_mechanism(net, scale_mm=100.0, anchor=anchor)
    assert congruent(mechanism.pose(mechanism.design), net.points.reshape(-1, 3) * 100.0)
    hinge, *bars = map(int, re.findall(r"\d+", mechanism.driver))
    assert hinge == anchor[0] * 4 + anchor[1]
    ends = [set(mechanism.bars[bar].tolist()) for bar in bars]
    assert ends == [{hinge, hinge + 4}, {hinge, hinge + 1}]  # one of either line
    if anchor == (0, 0):
        for step in (-0.5, 0.2, 1.0):
            other = flex(net, (0.0, 0.0), step)
            pose = mechanism.pose(mechanism.design + step)
            assert congruent(pose, other.points.reshape(-1, 3) * 100.0)


def congruent(pose: Pose, points: np.ndarray) -> bool:
    """Same distances between all points."""

    def distances(x: np.ndarray) -> np.ndarray:
        return np.linalg.norm(x[:, None] - x[None], axis=-1)

    return bool(np.abs(distances(pose.points) - distances(points)).max() < 1e-9)


def test_paths_of_whole_nets() -> None:
    net = a_net(3, 3)
    fold = knet_mechanism(net, scale_mm=100.0, path="fold", anchor=(0, 0))
    near = fold.pose(1e-9)
    line = near.points - near.points.mean(axis=0)
    spread = np.linalg.svd(line, compute_uv=False)
    assert spread[1] < 1e-6 * spread[0]  # the bundle
    # Its length: all edges in one line with the signs of the two directions.
    sums = sum(net.r * 100 * np.sin(delta).sum() for delta in net.deltas)
    assert np.ptp(line @ np.linalg.svd(line)[2][0]) == pytest.approx(sums, rel=1e-6)
    rates = (np.full(2, 0.1), np.zeros(2))
    own = knet_mechanism(net, path=(rates, 0.5))
    locked = knet_mechanism(net)
    t = own.design + 0.3
    assert not np.allclose(own.pose(t).points, locked.pose(t).points)
    with pytest.raises(InputError, match="shape"):
        knet_mechanism(net, path=((np.zeros(3), np.zeros(2)), 1.0))
    with pytest.raises(InputError, match="corner rate"):
        knet_mechanism(net, path=(rates, 0.0))


def test_a_dini_patch_moves() -> None:
    net = dini(np.full(3, 0.3), np.full(3, 0.25), 1.2)
    mechanism = knet_mechanism(net, scale_mm=100.0)
    assert congruent(mechanism.pose(mechanism.design), net.points.reshape(-1, 3) * 100.0)


def test_crab_poses_are_crab_nets() -> None:
    net = crab_net(6, np.radians(30), np.radians(60), 5)
    mechanism = crab_mechanism(net, scale_mm=100.0)
    for degrees in (40.0, 60.0, 75.0):
        other = crab_net(6, np.radians(30), np.radians(degrees), 5)
        pose = mechanism.pose(np.radians(degrees))
        assert congruent(pose, 100.0 * other.points.reshape(-1, 3))
    # 2 N (rings - 1) bars of two kinds.
    assert mechanism.n_bars == 48
    assert np.ptp(mechanism.lengths) < 1e-9
    assert sorted(set(np.round(np.degrees(mechanism.twists), 9))) == [-30.0, 30.0]


def test_cube_paths() -> None:
    locked = a_cube((1.0, 0.0))
    assert "bar 0 to bar 4" in locked.driver
    even = a_cube((1.0, -1.0))
    assert "bar 4 to bar 8" in even.driver
    pose = even.pose(even.design + 0.5)
    direction = pose.points[[4, 2, 1]] - pose.points[0]
    angles = np.arctan2(direction[:, 1], direction[:, 0])
    assert angles[1] == pytest.approx(-angles[2])  # opens evenly from bar 0


def test_dead_points_are_folded_isograms() -> None:
    """At each, the isograms it names are in one line, and no others; crossings are exact."""
    mechanism = knet_mechanism(a_net(3, 4), scale_mm=100.0)
    assert len(mechanism.dead_points) > 5
    for t, words in mechanism.dead_points[1:]:
        pose = mechanism.pose(t)
        corners = pose.points[mechanism.cells]
        spread = np.linalg.svd(corners - corners.mean(axis=1, keepdims=True), compute_uv=False)
        folded = np.flatnonzero(spread[:, 1] < 1e-7 * spread[:, 0])
        assert words.startswith(f"isogram {folded[0]} ") or words.startswith("isograms ")
        assert len(folded)
    roots = crossings(lambda ts: np.sin(ts[:, None] * np.array([1.0, 2.0])), (0.1, 6.0))
    assert [t for t, _ in roots] == pytest.approx(np.pi * np.array([0.5, 1.0, 1.5]), abs=1e-10)
    assert [columns for _, columns in roots] == [(1,), (0, 1), (1,)]


def test_outside_the_limits() -> None:
    loop = bennett(100.0, np.radians(40), beta=np.radians(70))
    with pytest.raises(InputError, match="361"):
        loop.pose(np.radians(361))


def test_printed_numbers() -> None:
    """mathematics.md 11: alpha = pi / 8 and 100 mm a unit give bars of 38.2683 mm, +-22.5 deg."""
    net = knet([np.full(2, np.pi / 8)] * 2, [np.zeros(1)] * 2, 1.2)
    mechanism = knet_mechanism(net, scale_mm=100.0)
    assert mechanism.lengths == pytest.approx(np.full(12, 38.2683), abs=5e-5)
    assert np.degrees(mechanism.twists) == pytest.approx(np.repeat([22.5, -22.5], 6))
    assert sorted(set(mechanism.strips.tolist())) == [0, 1, 2, 3]  # m + n

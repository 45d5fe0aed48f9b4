"""Mobility by rank, flexes, bad input of linkages."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.errors import DegenerateError, InputError
from ddgfab.linkages import Pose, bennett, crab_mechanism, cube, flex, knet_mechanism, mobility
from ddgfab.linkages.grid import Grid
from ddgfab.linkages.instant_mobility import _kernel, linkage_jacobian
from ddgfab.nets.knet.crab import crab_net
from ddgfab.nets.knet.net import KNet, knet


def a_net(*sizes: int, seed: int = 1) -> KNet:
    rng = np.random.default_rng(seed)
    deltas = [rng.uniform(0.3, 0.6, size) for size in sizes]
    turns = [rng.uniform(-0.3, 0.3, size - 1) for size in sizes]
    return knet(deltas, turns, rng.uniform(0.6, 2.2, len(sizes) - 1))


def of_net(net: KNet) -> int:
    pose = Pose(net.points.reshape(-1, 3), net.normals.reshape(-1, 3))
    return mobility(Grid.build(net.shape).bars, pose)


@pytest.mark.parametrize(
    ("sizes", "expected"),
    [
        ((1, 1), 1),
        ((2, 1), 2),
        ((2, 2), 3),
        ((3, 2), 4),
        ((3, 3), 5),
        ((4, 3), 6),
        ((1, 1, 1), 2),
        ((2, 1, 1), 3),
        ((1, 1, 1, 1), 3),
    ],
)
def test_table(sizes: tuple[int, ...], expected: int) -> None:
    """mathematics.md 4.3: m + n - 1; sum - 1 for boxes; the 12-bar cube 2, the 4-cube 3."""
    assert expected == sum(sizes) - 1
    assert of_net(a_net(*sizes)) == expected


@pytest.mark.parametrize("sizes", [(1, 1), (3, 2), (5, 4), (1, 1, 1), (2, 2, 1)])
def test_whole_jacobian_agrees(sizes: tuple[int, ...]) -> None:
    """Second route: the singular values of the whole Jacobian at once, with a gap over 1e6."""
    net = a_net(*sizes)
    pose = Pose(net.points.reshape(-1, 3), net.normals.reshape(-1, 3))
    jacobian = linkage_jacobian(Grid.build(net.shape).bars, pose)
    values = np.linalg.svd(jacobian, compute_uv=False)
    rank = int((values > 1e-9 * values[0]).sum())
    assert values[rank - 1] > 1e6 * values[rank:].max(initial=0.0)
    assert jacobian.shape[1] - rank - 6 == of_net(net)


def test_closed_nets_by_both_routes() -> None:
    mechanism = crab_mechanism(crab_net(6, np.radians(30), np.radians(60), 4))
    pose = mechanism.pose(mechanism.design)
    values = np.linalg.svd(linkage_jacobian(mechanism.bars, pose), compute_uv=False)
    assert mechanism.mobility == 6 * mechanism.n_hinges - int((values > 1e-9).sum()) - 6
    assert mechanism.mobility >= 1  # the symmetric opening, 4.5


def test_bad_linkages() -> None:
    net = a_net(1, 1)
    pose = Pose(net.points.reshape(-1, 3), net.normals.reshape(-1, 3))
    with pytest.raises(InputError, match="hinge 2"):
        mobility([[0, 1]], pose)
    with pytest.raises(InputError, match="bar 0 has no length"):
        mobility([[0, 0]], pose)
    with pytest.raises(InputError, match="one pose"):
        mobility([[0, 1]], Pose(pose.points[None], pose.axes[None]))


def test_ranks_without_a_gap_are_refused() -> None:
    assert _kernel(np.diag([1.0, 2e-9, 5e-13]), 3).shape == (3, 1)
    with pytest.raises(DegenerateError, match=r"singular values 2e-09 and 5e-10 at hinge 3"):
        _kernel(np.diag([1.0, 2e-9, 5e-10]), 3)


def test_mechanisms_report_it() -> None:
    assert bennett(100.0, np.radians(40), beta=np.radians(70)).mobility == 1
    twists = np.radians([30.0, 150.0, 90.0])
    assert cube(np.sin(twists) * 90, twists, corners=(1.0, -1.0)).mobility == 2
    assert knet_mechanism(a_net(3, 2)).mobility == 4


def test_a_rigid_quad_has_none() -> None:
    """Four bars whose ratios differ: a closed skew quad with normals that fit no mechanism."""
    net = a_net(1, 1)
    points, normals = net.points.reshape(-1, 3).copy(), net.normals.reshape(-1, 3)
    points[3] += [0.2, 0.1, 0.3]
    # Axes perpendicular to both bars at every hinge, so that the bars exist.
    loop = [0, 2, 3, 1]
    axes = normals.copy()
    for k, hinge in enumerate(loop):
        a, b = points[loop[k - 1]] - points[hinge], points[loop[(k + 1) % 4]] - points[hinge]
        axes[hinge] = np.cross(a, b) / np.linalg.norm(np.cross(a, b))
    assert mobility(Grid.build((2, 2)).bars, Pose(points, axes)) == 0


def test_jacobian_by_differences() -> None:
    """Second route: what a bar keeps, |e|, <e, n>, <e, n'>, <n, n'>, |n|, det(e, n, n')."""
    rng = np.random.default_rng(3)
    net = a_net(2, 1)
    bars = Grid.build(net.shape).bars
    points, axes = net.points.reshape(-1, 3), net.normals.reshape(-1, 3).copy()
    axes[bars[0, 1]] = axes[bars[0, 0]]  # one bar of twist 0
    size = np.linalg.norm(np.diff(points[bars], axis=1)[:, 0], axis=1).mean()

    def kept(flat: np.ndarray) -> np.ndarray:
        x, n = flat.reshape(2, -1, 3)
        i, j = bars.T
        e = x[j] - x[i]
        gram = [(e * e), (n[i] * n[j]), (e * n[i]), (e * n[j]), (n[i] * n[i]), (n[j] * n[j])]
        det = np.linalg.det(np.stack([e, n[i], n[j]], axis=1))
        return np.stack([*(g.sum(axis=1) for g in gram), det], axis=1).ravel()

    start = np.concatenate([points.ravel() / size, axes.ravel()])
    slope = np.empty((7 * len(bars), len(start)))
    for k in range(len(start)):
        step = np.zeros_like(start)
        step[k] = 1e-6
        slope[:, k] = (kept(start + step) - kept(start - step)) / 2e-6
    jacobian = linkage_jacobian(bars, Pose(points, axes))
    for bar in range(len(bars)):
        ours, theirs = jacobian[7 * bar : 7 * bar + 7], slope[7 * bar : 7 * bar + 7]
        values = np.linalg.svd(ours, compute_uv=False)
        assert values[5] > 0.99
        assert values[6] == 0
        # The same space of rows: nothing of one is left beside the other.
        assert np.abs(theirs - theirs @ np.linalg.pinv(ours) @ ours).max() < 1e-8
        assert np.linalg.matrix_rank(theirs, tol=1e-6) == 6
    # And a turn of everything about any axis is not a change.
    turn = rng.normal(size=3)
    moved = np.concatenate([np.cross(turn, points / size), np.cross(turn, axes)]).ravel()
    assert np.abs(jacobian @ moved).max() < 1e-14


Z = [0.0, 0.0, 1.0]
SQUARE = [[0.0, 0, 0], [2, 0.3, 0], [2.4, 1.9, 0], [-0.4, 1.4, 0]]
RING5 = [*SQUARE, [-0.9, 0.5, 0]]
TURNED = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]


def ring(count: int) -> list[list[int]]:
    return [[k, (k + 1) % count] for k in range(count)]


@pytest.mark.parametrize(
    ("points", "axes", "bars", "expected"),
    [
        (SQUARE, [Z] * 4, ring(4), 1),
        (SQUARE, [Z, [0, 0, -1.0], Z, [0, 0, -1.0]], ring(4), 1),  # twists pi
        (RING5, [Z] * 5, ring(5), 2),
        (SQUARE[:3], [Z] * 3, ring(3), 0),
        (SQUARE[:3], [Z] * 3, [[0, 1], [1, 2]], 1),
        (RING5, [Z] * 5, [[0, 1], [1, 2], [2, 3], [3, 4]], 3),
        (SQUARE, [Z] * 4, [*ring(4), [0, 2]], 0),  # braced
        # A planar four-bar whose hinge 0 carries another bar about an axis of its own kind: 1 + 1.
        ([*SQUARE, [0.0, -1.0, 0.5]], [*[Z] * 4, [1.0, 0, 0]], [*ring(4), [0, 4]], 2),
        # A spatial chain with parallel axes in its middle: one hinge less than bars each.
        (
            [[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1]],
            [[0, 1.0, 0], Z, Z, [1.0, 0, 0]],
            [[0, 1], [1, 2], [2, 3]],
            2,
        ),
        # An axis along its bar, as of a wrist.
        ([[0.0, 0, 0], [1, 0, 0], [1, 1, 0]], [Z, [1.0, 0, 0], Z], [[0, 1], [1, 2]], 1),
    ],
)
@pytest.mark.parametrize("scale", [1.0, 1e4])
def test_parallel_axes(
    points: list[list[float]],
    axes: list[list[float]],
    bars: list[list[int]],
    expected: int,
    scale: float,
) -> None:
    """Twists 0 and pi: by Gruebler's count for planar linkages, by hinges for open chains."""
    x, n = np.array(points) @ TURNED.T * scale, np.array(axes) @ TURNED.T
    assert mobility(bars, Pose(x, n)) == expected
    values = np.linalg.svd(linkage_jacobian(np.array(bars), Pose(x, n)), compute_uv=False)
    assert 6 * len(x) - int((values > 1e-9).sum()) - 6 == expected


def test_flex_keeps_bars() -> None:
    net = a_net(4, 3)
    rng = np.random.default_rng(0)
    other = flex(net, [rng.uniform(-0.3, 0.3, 3), rng.uniform(-0.3, 0.3, 2)], 0.4)
    residuals = other.residuals()
    assert max(residuals.values()) < 1e-11
    for k in range(2):
        assert np.array_equal(other.deltas[k], net.deltas[k])
        before, after = (np.linalg.norm(np.diff(x.points, axis=k), axis=-1) for x in (net, other))
        assert np.abs(before - after).max() < 1e-12
    assert not np.allclose(other.points, net.points)
    back = flex(
        other, [-np.asarray(a - b) for a, b in zip(turns(other), turns(net), strict=True)], -0.4
    )
    assert np.abs(back.points - net.points).max() < 1e-11


def turns(net: KNet) -> tuple[np.ndarray, ...]:
    return net.cauchy().turns


def test_flex_to_the_bundle() -> None:
    """4.4: turns and corner at zero fold every sheet into one line of length sum of the edges."""
    net = a_net(3, 2)
    data = net.cauchy()
    # A corner angle of exactly zero is the vacuum; the sheet is a line.
    flat = flex(net, [-t for t in data.turns], -data.corner_angles)
    line = flat.points.reshape(-1, 3) - flat.points.reshape(-1, 3).mean(axis=0)
    spread = np.linalg.svd(line, compute_uv=False)
    assert spread[1] < 1e-12 * spread[0]
    assert np.ptp(line @ np.linalg.svd(line)[2][0]) == pytest.approx(
        sum(np.sin(delta).sum() for delta in net.deltas)
    )


def test_flex_of_a_cube_and_bad_changes() -> None:
    box = a_net(1, 2, 1)
    moved = flex(box, [0.0, 0.1, 0.0], [0.2, -0.1])
    assert max(moved.residuals().values()) < 1e-11
    with pytest.raises(InputError, match="direction 1"):
        flex(box, [0.0, np.zeros(3), 0.0], 0.0)
    with pytest.raises(InputError, match="corner"):
        flex(box, [0.0, 0.0, 0.0], np.zeros(3))
    with pytest.raises(InputError, match="not finite"):
        flex(box, [0.0, np.nan, 0.0], 0.0)
    with pytest.raises(InputError, match="2 arrays"):
        flex(box, [0.0, 0.0], 0.0)


ALPHA, BETA = np.radians(40), np.radians(70)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"a": 100.0, "alpha": ALPHA, "b": 146.2, "beta": BETA}, "relative difference"),
        ({"a": 0.0, "alpha": ALPHA, "beta": BETA}, "a = 0 mm"),
        ({"a": 100.0, "alpha": ALPHA, "b": -1.0}, "b = -1 mm"),
        ({"a": 100.0, "alpha": 0.0, "beta": BETA}, "alpha = 0 deg"),
        ({"a": 100.0, "alpha": np.pi, "beta": BETA}, "planar"),
        ({"a": 100.0, "alpha": ALPHA, "beta": 0.0}, "beta = 0 deg"),
        ({"a": 100.0, "alpha": ALPHA, "beta": ALPHA}, "only folds"),
        ({"a": 100.0, "alpha": ALPHA, "b": 160.0}, "too long"),
        ({"a": 100.0, "alpha": ALPHA}, "needs b or beta"),
        ({"a": np.nan, "alpha": ALPHA, "beta": BETA}, "positive length"),
        ({"a": 100.0, "alpha": ALPHA, "beta": BETA, "driver": np.pi}, "180"),
        ({"a": 100.0, "alpha": ALPHA, "beta": BETA, "driver": 7.0}, "between 0 and 360"),
    ],
)
def test_bad_bennett(arguments: dict[str, float], words: str) -> None:
    with pytest.raises(InputError, match=words):
        bennett(**arguments)


@pytest.mark.parametrize(("alpha", "word"), [(90, "beta = 60 deg without b"), (40, "beta = 140")])
def test_the_twist_that_is_advised_moves(alpha: float, word: str) -> None:
    angle = np.radians(alpha)
    with pytest.raises(InputError, match=word) as caught:
        bennett(60.0, angle, b=60.0, beta=angle)
    beta = float(str(caught.value).partition("such as beta = ")[2].split()[0])
    assert bennett(60.0, angle, beta=np.radians(beta)).mobility == 1


def test_ratio_limit_and_its_advice() -> None:
    b = 100 * np.sin(BETA) / np.sin(ALPHA)
    bennett(100.0, ALPHA, b=b * (1 + 5e-10), beta=BETA)
    with pytest.raises(InputError, match=r"length of b is 146\.19022"):
        bennett(100.0, ALPHA, b=b * (1 + 5e-9), beta=BETA)


def test_b_alone_takes_the_acute_twist() -> None:
    b = 100 * np.sin(BETA) / np.sin(ALPHA)
    assert np.degrees(bennett(100.0, ALPHA, b=b).twists[2]) == pytest.approx(70)


def test_bad_cubes() -> None:
    twists = np.radians([30.0, 150.0, 90.0])
    lengths = 100 * np.sin(twists)
    with pytest.raises(InputError, match="twists 0 and 1"):
        cube(100 * np.sin([0.5, 0.5, 1.0]), [0.5, 0.5, 1.0], corners=(1.0, -1.0))
    with pytest.raises(InputError, match="relative difference"):
        cube([lengths[0], lengths[1], lengths[2] + 1], twists, corners=(1.0, -1.0))
    with pytest.raises(InputError, match="length 1"):
        cube([lengths[0], 0.0, lengths[2]], twists, corners=(1.0, -1.0))
    with pytest.raises(InputError, match="rates"):
        cube(lengths, twists, corners=(1.0, -1.0), rates=(0.0, 0.0))
    with pytest.raises(InputError, match="3 lengths"):
        cube(lengths[:2], twists[:2], corners=(1.0, -1.0))


def test_bad_nets() -> None:
    net = a_net(3, 2)
    with pytest.raises(InputError, match="anchor"):
        knet_mechanism(net, anchor=(3, 0))
    with pytest.raises(InputError, match="scale_mm"):
        knet_mechanism(net, scale_mm=0.0)
    with pytest.raises(InputError, match="3 directions"):
        knet_mechanism(a_net(1, 1, 1))
    with pytest.raises(InputError, match="'bent'"):
        knet_mechanism(net, path="bent")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="three rings"):
        crab_mechanism(crab_net(6, 0.5, 1.0, 2))
    line = knet([np.full(2, 0.3), np.full(2, 0.3)], [np.zeros(1), np.zeros(1)], 0.0)
    with pytest.raises(DegenerateError):
        knet_mechanism(line)

"""Distances of many pairs of moving convex pieces at once, with proofs of what stays apart.

Distances are found by the method of Gilbert, Johnson and Keerthi on all pairs together; a lower
bound is proven by the plane it finds. For a motion with bounded accelerations the same plane,
turned with the bodies, proves a lower bound over a whole interval (`margin`).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import Final

import numpy as np

from ddgfab.mesh import Floats, Ints
from ddgfab.quads import Bools
from fabrication.motion.convex import ConvexPieces

ROUNDS: Final = 40
"""Iterations of the distance search; smooth bodies need about ten."""

CLOSE: Final = 1e-4
"""Distances are found up to this [mm]."""

OVERLAP: Final = 1e-9
"""Cores nearer than this [mm] count as overlapping."""

_SUBSETS: Final = tuple(s for size in (1, 2, 3, 4) for s in combinations(range(4), size))


@dataclass(frozen=True, eq=False)
class PlacedPairs:
    """Pairs of pieces as placed: a = first, b = second; all arrays (p, ...).

    a, b : pieces; turn_a, turn_b (p, 3, 3) and at_a, at_b (p, 3): frames of their bars
    """

    a: Ints
    b: Ints
    turn_a: Floats
    turn_b: Floats
    at_a: Floats
    at_b: Floats

    @staticmethod
    def build(
        pieces: ConvexPieces, a: Ints, b: Ints, frames_a: Floats, frames_b: Floats
    ) -> PlacedPairs:
        """From (p, 4, 4) frames of the pieces' bars."""
        return PlacedPairs(
            a, b, frames_a[:, :3, :3], frames_b[:, :3, :3], frames_a[:, :3, 3], frames_b[:, :3, 3]
        )

    def take(self, index: Ints) -> PlacedPairs:
        """Some of the pairs."""
        return PlacedPairs(
            self.a[index],
            self.b[index],
            self.turn_a[index],
            self.turn_b[index],
            self.at_a[index],
            self.at_b[index],
        )


@dataclass(frozen=True, eq=False)
class Gaps:
    """What is known of the distance of pairs.

    gap : (p,) distance [mm] up to `CLOSE`; where cores overlap, minus the sum of the balls
    bound : (p,) proven lower bound of the distance [mm]
    normal : (p, 3) unit normal of the plane that proves it, from a to b
    point_a, point_b : (p, 3) nearest points
    """

    gap: Floats
    bound: Floats
    normal: Floats
    point_a: Floats
    point_b: Floats


def _support(pieces: ConvexPieces, which: Ints, turn: Floats, at: Floats, way: Floats) -> Floats:
    """(p, 3) farthest points of placed cores along (p, 3) directions."""
    local = np.einsum("pji,pj->pi", turn, way)
    return np.asarray(np.einsum("pij,pj->pi", turn, pieces.support(which, local)) + at)


def segment_gaps(pieces: ConvexPieces, pairs: PlacedPairs) -> tuple[Floats, Floats]:
    """(p,) distances of the capsules around pieces and (p, 3) unit directions from a to b."""
    ends = []
    for which, turn, at in (
        (pairs.a, pairs.turn_a, pairs.at_a),
        (pairs.b, pairs.turn_b, pairs.at_b),
    ):
        ends.append(np.einsum("pij,pkj->pki", turn, pieces.segment[which]) + at[:, None])
    apart = segment_difference(ends[0], ends[1])
    size = np.linalg.norm(apart, axis=1)
    way = apart / np.where(size > 0, size, 1.0)[:, None]
    return size - pieces.radius[pairs.a] - pieces.radius[pairs.b], way


def _dot(u: Floats, v: Floats) -> Floats:
    """(p,) scalar products."""
    return np.asarray(np.einsum("pi,pi->p", u, v))


def _safe(values: Floats) -> Floats:
    """Values to divide by: 1 where they are not positive."""
    return np.where(values > 0, values, 1.0)


def segment_difference(first: Floats, second: Floats) -> Floats:
    """(p, 3) shortest vector from segments (p, 2, 3) to segments (p, 2, 3)."""
    p, d = first[:, 0], first[:, 1] - first[:, 0]
    q, e = second[:, 0], second[:, 1] - second[:, 0]
    w = p - q
    a, c, b = _dot(d, d), _dot(e, e), _dot(d, e)
    dw, ew = _dot(d, w), _dot(e, w)
    best = np.full((len(p), 3), np.inf)
    least = np.full(len(p), np.inf)
    square = a * c - b * b
    inside = np.clip((b * ew - c * dw) / _safe(square), 0.0, 1.0)
    # The inner pair, and each end against the other segment: one of them is nearest.
    tries = [np.where(square > 0, inside, 0.0), np.zeros_like(a), np.ones_like(a)]
    options = [(s, np.clip((b * s + ew) / _safe(c), 0.0, 1.0)) for s in tries]
    for t in (np.zeros_like(a), np.ones_like(a)):
        options.append((np.clip((b * t - dw) / _safe(a), 0.0, 1.0), t))
    for s, t in options:
        vector = (q + t[:, None] * e) - (p + s[:, None] * d)
        size = _dot(vector, vector)
        better = size < least
        best[better], least[better] = vector[better], size[better]
    return best


def gaps(pieces: ConvexPieces, pairs: PlacedPairs) -> Gaps:
    """Distances of placed pairs, proven bounds and nearest points."""
    count = len(pairs.a)
    balls = pieces.ball[pairs.a] + pieces.ball[pairs.b]
    way = pairs.at_b - pairs.at_a
    way = np.where((np.abs(way).sum(axis=1) > 0)[:, None], way, [1.0, 0.0, 0.0])
    simplex = np.zeros((count, 4, 2, 3))
    used = np.zeros((count, 4), dtype=bool)
    v = way.copy()
    near_a, near_b = pairs.at_a.copy(), pairs.at_b.copy()
    bound, normal = np.full(count, -np.inf), np.zeros((count, 3))
    size = np.full(count, np.inf)
    live = np.arange(count)
    for step in range(ROUNDS):
        part = pairs.take(live)
        down = v[live]
        length = np.linalg.norm(down, axis=1)
        s_a = _support(pieces, part.a, part.turn_a, part.at_a, down)
        s_b = _support(pieces, part.b, part.turn_b, part.at_b, -down)
        proof = np.einsum("pi,pi->p", s_b - s_a, down) / length
        better = proof > bound[live]
        bound[live[better]] = proof[better]
        normal[live[better]] = down[better] / length[better, None]
        if step:
            keep = length - bound[live] > CLOSE
            live, s_a, s_b = live[keep], s_a[keep], s_b[keep]
            if not len(live):
                break
        free = (~used[live]).argmax(axis=1)
        simplex[live, free, 0], simplex[live, free, 1] = s_a, s_b
        used[live, free] = True
        weight, chosen, vector = _nearest(simplex[live], used[live])
        used[live] = chosen
        new = np.linalg.norm(vector, axis=1)
        near_a[live] = np.einsum("pk,pki->pi", weight, simplex[live, :, 0])
        near_b[live] = np.einsum("pk,pki->pi", weight, simplex[live, :, 1])
        stuck = (new < OVERLAP) | (new >= size[live] * (1 - 1e-12)) if step else new < OVERLAP
        v[live], size[live] = vector, new
        live = live[~stuck]
        if not len(live):
            break
    over = size < OVERLAP
    gap = np.where(over, 0.0, size) - balls
    bound = np.where(over, np.minimum(bound, 0.0), bound) - balls
    return Gaps(gap, bound, normal, near_a, near_b)


def _nearest(simplex: Floats, used: Bools) -> tuple[Floats, Bools, Floats]:
    """Nearest point to the origin of the hulls of b - a over the used corners.

    Returns
    -------
    weight : (p, 4) its weights; chosen : (p, 4) the corners it needs; vector : (p, 3)
    """
    points = simplex[:, :, 1] - simplex[:, :, 0]
    gram = np.einsum("pki,pli->pkl", points, points)
    count = len(points)
    best = np.full(count, np.inf)
    weight = np.zeros((count, 4))
    for subset in _SUBSETS:
        ok = used[:, list(subset)].all(axis=1)
        if not ok.any():
            continue
        rows = np.flatnonzero(ok)
        k = len(subset)
        corner = np.array(subset)
        inner = gram[rows[:, None, None], corner[:, None], corner]
        # Affine combination of least norm, from differences to the first corner.
        if k == 1:
            share = np.ones((len(rows), 1))
        else:
            edge = inner[:, 1:, 1:] - inner[:, 1:, :1] - inner[:, :1, 1:] + inner[:, :1, :1]
            right = inner[:, 0, 0, None] - inner[:, 1:, 0]
            scale = np.einsum("pii->p", edge)
            flat = np.linalg.det(edge) <= 1e-13 * (scale / (k - 1)) ** (k - 1)
            edge[flat] = np.eye(k - 1)
            rest = np.linalg.solve(edge, right[..., None])[..., 0]
            share = np.concatenate([1.0 - rest.sum(axis=1, keepdims=True), rest], axis=1)
            share[flat] = -1.0
        inside = (share >= 0).all(axis=1)
        rows, share = rows[inside], share[inside]
        vector = np.einsum("pk,pki->pi", share, points[rows][:, corner])
        size = np.einsum("pi,pi->p", vector, vector)
        better = size < best[rows]
        rows, share = rows[better], share[better]
        best[rows] = size[better]
        weight[rows] = 0.0
        weight[rows[:, None], corner] = share
    return weight, weight > 0, np.asarray(np.einsum("pk,pki->pi", weight, points))


@dataclass(frozen=True, eq=False)
class PairMotions:
    """Speeds of the bars of pairs, and bounds over an interval; arrays (p, ...).

    spin_a, spin_b : (p, 3) angular velocities; speed_a, speed_b : (p, 3) velocities of the frames'
    origins, all at the middle; pull_a, pull_b : (p,) bounds of the accelerations of all points of
    the pieces over the interval; half : (p,) its half width
    """

    spin_a: Floats
    spin_b: Floats
    speed_a: Floats
    speed_b: Floats
    pull_a: Floats
    pull_b: Floats
    half: Floats

    def take(self, index: Ints) -> PairMotions:
        """Some of the pairs."""
        fields = (self.spin_a, self.spin_b, self.speed_a, self.speed_b, self.pull_a, self.pull_b)
        return PairMotions(*(values[index] for values in (*fields, self.half)))


def margin(pieces: ConvexPieces, pairs: PlacedPairs, moving: PairMotions, normal: Floats) -> Floats:
    """(p,) lower bounds on the distances over |s| <= half, from planes with normals (p, 3).

    The plane's normal u turns with the mean angular velocity w of the pair. For points a, b of the
    bodies f(s) = u.(b - a) has f'' >= -K with K = |a''| + |b''| + 2|w||b' - a'| + w^2 |b - a|, and
    f + s f' at the middle is linear in a and in b, so its least value is reached by supports; it is
    concave in s, so the ends decide: distance >= min over s = +-half of the supports' value, less
    K half^2 / 2.
    """
    turn = 0.5 * (moving.spin_a + moving.spin_b)
    rate = np.cross(turn, normal)
    half = moving.half
    low = np.full(len(half), np.inf)
    for s in (-half, half):
        value = np.zeros(len(half))
        for sign, which, rot, at, spin, speed in (
            (-1.0, pairs.a, pairs.turn_a, pairs.at_a, moving.spin_a, moving.speed_a),
            (1.0, pairs.b, pairs.turn_b, pairs.at_b, moving.spin_b, moving.speed_b),
        ):
            # u.(p + s p') + s u'.p with p' = speed + spin x (p - at)
            way = normal + s[:, None] * (rate + np.cross(normal, spin))
            point = _support(pieces, which, rot, at, -sign * way)
            value += sign * np.einsum("pi,pi->p", way, point)
            value += sign * s * np.einsum("pi,pi->p", normal, speed - np.cross(spin, at))
            value -= pieces.ball[which] * np.linalg.norm(way, axis=1)
        low = np.minimum(low, value)
    return np.asarray(low - 0.5 * half**2 * _curving(pieces, pairs, moving, turn))


def _curving(pieces: ConvexPieces, pairs: PlacedPairs, moving: PairMotions, turn: Floats) -> Floats:
    """(p,) the bound K of `margin`."""
    middles, radii, speeds = [], [], []
    for which, rot, at, spin, speed in (
        (pairs.a, pairs.turn_a, pairs.at_a, moving.spin_a, moving.speed_a),
        (pairs.b, pairs.turn_b, pairs.at_b, moving.spin_b, moving.speed_b),
    ):
        arm = np.einsum("pij,pj->pi", rot, pieces.segment[which].mean(axis=1))
        ends = pieces.segment[which]
        radius = 0.5 * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) + pieces.radius[which]
        middles.append(at + arm)
        speeds.append((speed + np.cross(spin, arm), np.linalg.norm(spin, axis=1) * radius))
        radii.append(radius)
    pull = moving.pull_a + moving.pull_b
    w = np.linalg.norm(turn, axis=1)
    relative = np.linalg.norm(speeds[1][0] - speeds[0][0], axis=1) + speeds[0][1] + speeds[1][1]
    fastest = relative + moving.half * pull
    far = np.linalg.norm(middles[1] - middles[0], axis=1) + radii[0] + radii[1]
    far = far + moving.half * fastest
    return np.asarray(pull + w * (2.0 * fastest + w * far))

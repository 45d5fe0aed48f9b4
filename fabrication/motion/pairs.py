"""Which pieces of moving bodies may meet: rules for pairs, and the near ones without trying all."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from ddgfab.linkages import Mechanism
from ddgfab.mesh import Floats, Ints
from ddgfab.quads import Bools
from fabrication.motion.convex import Body, ConvexPieces


@dataclass(frozen=True, eq=False)
class Rules:
    """Which pairs of pieces keep their distance whatever moves, and how far others stay apart.

    bars : (E, 2) hinges of each bar
    bar_keys : sorted keys i * V + j, i < j, of the hinges that a bar joins
    is_link : (b,) whether each body is a link
    link_bar : (b,) its bar, or -1
    clearance, joint_clearance : [mm]
    """

    bars: Ints
    bar_keys: Ints
    is_link: Bools
    link_bar: Ints
    clearance: float
    joint_clearance: float

    @staticmethod
    def build(
        mechanism: Mechanism, bodies: Sequence[Body], clearance: float, joint_clearance: float
    ) -> Rules:
        """For the bodies of a mechanism."""
        bars = np.sort(mechanism.bars, axis=1)
        keys = np.unique(bars[:, 0] * mechanism.n_hinges + bars[:, 1])
        link_bar = np.array([body.bar for body in bodies])
        return Rules(
            mechanism.bars, keys, link_bar >= 0, link_bar, float(clearance), float(joint_clearance)
        )

    def rigid(self, pieces: ConvexPieces, a: Ints, b: Ints) -> Bools:
        """(p,) whether pairs keep their distance: both turn with a common bar, or about its hinges.

        A body of revolution about a hinge stays as it is in the frame of every bar on that hinge.
        """
        eye_a, eye_b = pieces.eye[a], pieces.eye[b]
        hinges_a, hinges_b = self.bars[pieces.bar[a]], self.bars[pieces.bar[b]]
        on_b = (hinges_b == eye_a[:, None]).any(axis=1)
        on_a = (hinges_a == eye_b[:, None]).any(axis=1)
        hinges = int(self.bars.max()) + 1
        key = np.minimum(eye_a, eye_b) * hinges + np.maximum(eye_a, eye_b)
        joined = (eye_a == eye_b) | np.isin(key, self.bar_keys)
        result: Bools = np.where(
            eye_a < 0,
            np.where(eye_b < 0, pieces.bar[a] == pieces.bar[b], on_a),
            np.where(eye_b < 0, on_b, joined),
        )
        return result

    def adjacent(self, first: Ints, second: Ints) -> Bools:
        """(p,) whether bodies are links that share a hinge."""
        one, two = self.bars[self.link_bar[first]], self.bars[self.link_bar[second]]
        share = (one[:, :, None] == two[:, None, :]).any(axis=(1, 2))
        return np.asarray(share & self.is_link[first] & self.is_link[second])

    def needed(self, pieces: ConvexPieces, a: Ints, b: Ints) -> Floats:
        """(p,) least gaps [mm] of pairs of pieces."""
        near = self.adjacent(pieces.body[a], pieces.body[b])
        return np.where(near, self.joint_clearance, self.clearance)


def near_pairs(pieces: ConvexPieces, frames: Floats, extra: Floats) -> tuple[Ints, Ints]:
    """Pairs a < b of pieces of different bodies whose capsules, grown by `extra`, could meet.

    Segments are cut into parts no longer than the typical one and their middles sought in a k-d
    tree, so the work grows with the number of near pairs.

    Parameters
    ----------
    frames : (E, 4, 4) of the bars
    extra : (n,) growth of each capsule's radius [mm]
    """
    turn, at = frames[pieces.bar, :3, :3], frames[pieces.bar, :3, 3]
    ends = np.einsum("nij,nkj->nki", turn, pieces.segment) + at[:, None]
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    radius = pieces.radius + extra
    size = max(2.0 * float(np.median(radius)), float(np.median(length)), float(radius.max()) / 2)
    counts = np.maximum(1, np.ceil(length / size).astype(np.int64))
    owner = np.repeat(np.arange(len(counts)), counts)
    place = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    share = ((place + 0.5) / counts[owner])[:, None]
    middles = (1 - share) * ends[owner, 0] + share * ends[owner, 1]
    reach = radius[owner] + 0.5 * (length / counts)[owner]
    found = cKDTree(middles).query_pairs(2.0 * float(reach.max()), output_type="ndarray")
    i, j = found.T
    apart = np.linalg.norm(middles[i] - middles[j], axis=1)
    touch = apart <= reach[i] + reach[j]
    a, b = owner[i[touch]], owner[j[touch]]
    low, high = np.minimum(a, b), np.maximum(a, b)
    key = np.unique(low * len(counts) + high)
    low, high = key // len(counts), key % len(counts)
    other = pieces.body[low] != pieces.body[high]
    return low[other], high[other]

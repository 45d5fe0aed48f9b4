"""March along the driving angle and prove pairs of pieces apart, interval by interval.

Conservative advancement: on an interval a pair is proven apart by one turned plane and bounds of
the accelerations (`margin`); where that fails the interval is halved for that pair. A pair found
too near at a middle stops the march on the safe side of it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np

from ddgfab.linkages import Mechanism
from ddgfab.linkages.frames import angular_velocity
from ddgfab.linkages.mechanism import END_SLACK, Bounds
from ddgfab.mesh import Floats, Ints
from ddgfab.quads import Bools
from fabrication.motion.contacts import PairMotions, PlacedPairs, gaps, margin, segment_gaps
from fabrication.motion.convex import ConvexPieces
from fabrication.motion.pairs import Rules, near_pairs

STEP: Final = float(np.radians(2.0))
"""Width [rad] of the intervals that are tried first."""

RESOLUTION: Final = float(np.radians(0.005))
"""The ends of the range are found up to this [rad]; they lie on the safe side."""

BATCH: Final = 8
"""Intervals examined together."""

CHUNK: Final = 20_000
"""Pairs in one array."""


@dataclass(frozen=True, eq=False)
class Tasks:
    """Pairs to prove apart: interval (middle t, half), the first interval it lies in, pieces."""

    t: Floats
    half: Floats
    cell: Ints
    a: Ints
    b: Ints

    def take(self, index: Ints) -> Tasks:
        """Some of the tasks."""
        return Tasks(
            self.t[index], self.half[index], self.cell[index], self.a[index], self.b[index]
        )

    def halves(self) -> Tasks:
        """Every interval as two."""
        half = self.half / 2
        return Tasks(
            np.concatenate([self.t - half, self.t + half]),
            np.tile(half, 2),
            np.tile(self.cell, 2),
            np.tile(self.a, 2),
            np.tile(self.b, 2),
        )

    @staticmethod
    def joined(parts: Sequence[Tasks]) -> Tasks:
        """All tasks of some lists."""
        return Tasks(
            np.concatenate([part.t for part in parts]),
            np.concatenate([part.half for part in parts]),
            np.concatenate([part.cell for part in parts]),
            np.concatenate([part.a for part in parts]),
            np.concatenate([part.b for part in parts]),
        )


Seen: TypeAlias = tuple[Tasks, Floats, Floats]
"""Tasks whose distances were found, the distances and their limits [mm]."""


@dataclass(frozen=True, eq=False)
class Near:
    """A pair of pieces at an angle: pieces, driving angle, gap and limit [mm]."""

    a: int
    b: int
    t: float
    gap: float
    limit: float


@dataclass(frozen=True, eq=False)
class March:
    """One way from the design pose.

    reached : driving angle up to which everything is proven
    stops : the pairs that end it, nearest first; none where the limit was reached
    nearest : by pair of bodies, where their gap came nearest to its limit
    examined : pairs times intervals
    """

    reached: float
    stops: tuple[Near, ...]
    nearest: dict[tuple[int, int], Near]
    examined: int


@dataclass(frozen=True, eq=False)
class Search:
    """A mechanism with its pieces and rules."""

    mechanism: Mechanism
    pieces: ConvexPieces
    rules: Rules

    def placed(self, t: float, a: Ints, b: Ints) -> PlacedPairs:
        """Pairs of pieces at one driving angle, in the frame of bar 0."""
        frames = self.mechanism.bar_frames(self.mechanism.pose(t))
        return PlacedPairs.build(
            self.pieces, a, b, frames[self.pieces.bar[a]], frames[self.pieces.bar[b]]
        )

    def too_near(self, t: float) -> tuple[Near, ...]:
        """The moving pairs nearer than their limits at one angle, worst first."""
        frames = self.mechanism.bar_frames(self.mechanism.pose(t))
        extra = np.full(len(self.pieces), max(self.rules.clearance, self.rules.joint_clearance))
        a, b = near_pairs(self.pieces, frames, extra)
        moves = ~self.rules.rigid(self.pieces, a, b)
        a, b = a[moves], b[moves]
        return self._short(t, a, b, self.rules.needed(self.pieces, a, b))

    def standing(self) -> tuple[Near, ...]:
        """Pieces that keep a distance below the limit in every pose, worst first.

        Eyes and bars about one hinge, parts along one bar. What is on one pin belongs together: of
        its eyes, rings and pin only the eyes are to keep apart.
        """
        pieces, t = self.pieces, self.mechanism.design
        frames = self.mechanism.bar_frames(self.mechanism.pose(t))
        extra = np.full(len(pieces), self.rules.joint_clearance)
        a, b = near_pairs(pieces, frames, extra)
        one_pin = (pieces.eye[a] >= 0) & (pieces.eye[a] == pieces.eye[b])
        links = self.rules.is_link[pieces.body[a]] & self.rules.is_link[pieces.body[b]]
        still = self.rules.rigid(pieces, a, b) & (links | ~one_pin)
        a, b = a[still], b[still]
        return self._short(t, a, b, np.full(len(a), self.rules.joint_clearance))

    def _short(self, t: float, a: Ints, b: Ints, needed: Floats) -> tuple[Near, ...]:
        """Those of pairs that are nearer than needed, worst first."""
        found = gaps(self.pieces, self.placed(t, a, b)).gap
        worst = np.argsort(found - needed, kind="stable")
        return tuple(
            Near(int(a[k]), int(b[k]), t, max(float(found[k]), 0.0), float(needed[k]))
            for k in worst
            if found[k] < needed[k]
        )

    def march(self, end: float, progress: Callable[[float], None] | None = None) -> March:
        """From the design angle towards `end`.

        Where accelerations have no bound on an interval it is taken shorter; where they have none
        on the shortest the march ends, as at the ends of what the bars allow.
        """
        at, step = self.mechanism.design, STEP
        way = 1.0 if end > at else -1.0
        nearest: dict[tuple[int, int], Near] = {}
        examined = 0
        while way * (end - at) > END_SLACK:
            count = int(min(BATCH, np.ceil((abs(end - at) - END_SLACK) / step)))
            edges: Floats = np.asarray(at + way * step * np.arange(count + 1), dtype=np.float64)
            if way * (end - edges[-1]) <= END_SLACK:
                edges[-1] = end
            middle, half = (edges[1:] + edges[:-1]) / 2, np.abs(np.diff(edges)) / 2
            pull = self._pull(self.mechanism.drive.bounds(middle, half))
            known = np.isfinite(pull).all(axis=1)
            good = count if known.all() else int(np.argmin(known))
            if not good:
                step /= 2
                if step < RESOLUTION:
                    break
                continue
            stop, stops, work = self._batch(edges[: good + 1], pull[:good], way, nearest)
            at, examined = stop, examined + work
            if progress is not None:
                progress(at)
            if stops:
                return March(at, stops, nearest, examined)
            if good == count:
                step = min(2 * step, STEP)
        return March(float(at), (), nearest, examined)

    def _batch(
        self, edges: Floats, pull: Floats, way: float, nearest: dict[tuple[int, int], Near]
    ) -> tuple[float, tuple[Near, ...], int]:
        """Intervals between edges, all pairs: how far, what stops there, the work.

        A pair found too near at a middle ends the range there, and its intervals before that stay
        among the tasks until they are proven or end the range earlier.
        """
        middle, half = (edges[1:] + edges[:-1]) / 2, np.abs(np.diff(edges)) / 2
        frames, rates = self.mechanism.moving_frames(middle)
        tasks = self._tasks(middle, half, frames, rates, pull)
        stop, stopped, work = float(edges[-1]), None, 0
        seen: list[Seen] = []
        while len(tasks.t):
            ahead = []
            for begin in range(0, len(tasks.t), CHUNK):
                part = tasks.take(np.arange(begin, min(begin + CHUNK, len(tasks.t))))
                sure, short = self._examine(part, pull, seen)
                work += len(part.t)
                for k in np.flatnonzero(short):
                    if way * part.t[k] < way * stop:
                        stop, stopped = float(part.t[k]), part.take(np.array([k]))
                ahead.append(part.take(np.flatnonzero(~sure)))
            left = Tasks.joined(ahead)
            # What cannot be settled any finer counts as too near.
            fine = 2 * left.half <= RESOLUTION
            for k in np.flatnonzero(fine):
                near_end = float(left.t[k] - way * left.half[k])
                if way * near_end < way * stop:
                    stop, stopped = near_end, left.take(np.array([k]))
            tasks = left.take(np.flatnonzero(~fine)).halves()
            tasks = tasks.take(np.flatnonzero(way * (tasks.t - way * tasks.half) < way * stop))
        for part, gap, needed in seen:
            within = np.flatnonzero((way * part.t <= way * stop) & (gap >= needed))
            self._remember(part.take(within), gap[within], needed[within], nearest)
        if stopped is None:
            return stop, (), work
        where = min(way * (stop + way * 4 * RESOLUTION), way * self._end(way)) * way
        stops = self.too_near(where) or self._nearby(stop, stopped)
        return stop, stops, work

    def _end(self, way: float) -> float:
        return self.mechanism.limits[1] if way > 0 else self.mechanism.limits[0]

    def _nearby(self, t: float, stopped: Tasks) -> tuple[Near, ...]:
        """The pair that could not be proven apart, though it keeps its limit by a hair."""
        gap = float(gaps(self.pieces, self.placed(t, stopped.a, stopped.b)).gap[0])
        limit = float(self.rules.needed(self.pieces, stopped.a, stopped.b)[0])
        return (Near(int(stopped.a[0]), int(stopped.b[0]), t, gap, limit),)

    # --- one round ---------------------------------------------------------------------------
    def _pull(self, bounds: Bounds) -> Floats:
        """(T, n) bounds of the accelerations of all points of every piece."""
        bar, reach = self.pieces.bar, self.pieces.reach
        turn = bounds.spin_rate[:, bar] + bounds.spin[:, bar] ** 2
        hinges = self.mechanism.bars[bar]
        options = [bounds.acceleration[:, hinges[:, k]] + turn * reach[:, k] for k in (0, 1)]
        return np.asarray(np.minimum(*options))

    def _tasks(
        self, middle: Floats, half: Floats, frames: Floats, rates: Floats, pull: Floats
    ) -> Tasks:
        """The pairs that could come near in each interval."""
        limit = max(self.rules.clearance, self.rules.joint_clearance) / 2
        bar = self.pieces.bar
        size = self.pieces.reach[:, 0]
        out = []
        for k in range(len(middle)):
            spin = np.linalg.norm(angular_velocity(frames[k], rates[k]), axis=1)[bar]
            speed = np.linalg.norm(rates[k, bar, :3, 3], axis=1) + spin * size
            moved = half[k] * speed + 0.5 * half[k] ** 2 * pull[k]
            a, b = near_pairs(self.pieces, frames[k], moved + limit)
            moves = ~self.rules.rigid(self.pieces, a, b)
            a, b = a[moves], b[moves]
            count = len(a)
            cell = np.full(count, k)
            out.append(Tasks(np.full(count, middle[k]), np.full(count, half[k]), cell, a, b))
        return Tasks.joined(out)

    def _examine(self, tasks: Tasks, pull: Floats, seen: list[Seen]) -> tuple[Bools, Bools]:
        """Which tasks are proven, and which pairs are too near at the middles.

        Distances that had to be found are added to `seen`.
        """
        pairs, moving = self._states(tasks, pull)
        needed = self.rules.needed(self.pieces, tasks.a, tasks.b)
        _, way = segment_gaps(self.pieces, pairs)
        sure = margin(self.pieces, pairs, moving, way) >= needed
        short: Bools = np.zeros(len(needed), dtype=np.bool_)
        rest = np.flatnonzero(~sure)
        if len(rest):
            part = pairs.take(rest)
            found = gaps(self.pieces, part)
            rest_tasks = tasks.take(rest)
            fine = margin(self.pieces, part, moving.take(rest), found.normal)
            sure[rest] = fine >= needed[rest]
            short[rest] = found.gap < needed[rest]
            seen.append((rest_tasks, found.gap, needed[rest]))
        return sure, short

    def _states(self, tasks: Tasks, pull: Floats) -> tuple[PlacedPairs, PairMotions]:
        """Frames, speeds and bounds of the pairs of tasks."""
        ts, at = np.unique(tasks.t, return_inverse=True)
        frames, rates = self.mechanism.moving_frames(ts)
        spins = angular_velocity(frames, rates)
        bar_a, bar_b = self.pieces.bar[tasks.a], self.pieces.bar[tasks.b]
        pairs = PlacedPairs.build(
            self.pieces, tasks.a, tasks.b, frames[at, bar_a], frames[at, bar_b]
        )
        moving = PairMotions(
            spins[at, bar_a],
            spins[at, bar_b],
            rates[at, bar_a, :3, 3],
            rates[at, bar_b, :3, 3],
            pull[tasks.cell, tasks.a],
            pull[tasks.cell, tasks.b],
            tasks.half,
        )
        return pairs, moving

    def _remember(
        self, tasks: Tasks, gap: Floats, needed: Floats, nearest: dict[tuple[int, int], Near]
    ) -> None:
        """Keep where each pair of bodies came nearest to its limit."""
        body = self.pieces.body
        slack = gap - needed
        for k in np.argsort(slack, kind="stable"):
            key = (int(body[tasks.a[k]]), int(body[tasks.b[k]]))
            have = nearest.get(key)
            if have is None or slack[k] < have.gap - have.limit:
                nearest[key] = Near(
                    int(tasks.a[k]),
                    int(tasks.b[k]),
                    float(tasks.t[k]),
                    float(gap[k]),
                    float(needed[k]),
                )

"""Proven bounds on the speeds and accelerations of a lattice of isograms over intervals.

Angles between bars spread from the anchor: at a hinge all of them add up, across an isogram each is
the closing function of the next; both for `TaylorModel`s, so nothing is sampled. Bars turn about
hinges of bars that are known: |omega'| of the next bar <= |omega'| + |angle''| + |angle'| |omega|.
Source: mathematics.md 3.7; the chain of angular velocities of rigid bodies.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol

import numpy as np

from ddgfab.linkages.cauchy import Numbers, points_of
from ddgfab.linkages.frames import angular_velocity, frames_and_rates
from ddgfab.linkages.grid import Grid
from ddgfab.linkages.mechanism import Bounds
from ddgfab.linkages.taylor_models import TINY, TaylorModel, closing
from ddgfab.mesh import Floats
from ddgfab.nets.knet.oriented import oriented_angle

Vertex = tuple[int, ...]
Arm = tuple[int, int]
"""Direction and sense (+1, -1) of a bar that leaves a vertex."""


class MovingNet(Protocol):
    """What the bounds read of a K-net on a box; see `ddgfab.linkages.lattice.Lattice`."""

    @property
    def deltas(self) -> tuple[Floats, ...]:
        """Per direction, angles of consecutive normals [rad]."""

    @property
    def r(self) -> float:
        """Scale [mm]."""

    @property
    def anchor(self) -> tuple[int, ...]:
        """Index of the vertex that does not move."""

    @property
    def turn_rates(self) -> tuple[Floats, ...]:
        """Per direction, derivatives of the turns by the driving angle."""

    @property
    def corner_rates(self) -> Floats:
        """Derivatives of the corner angles by the driving angle."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of vertices in each direction."""

    def lelieuvre(self, ts: Numbers) -> Numbers:
        """(n1, ..., nd, T, 3) unit field m, analytic in t."""

    def place(self, ts: Numbers) -> tuple[Numbers, Numbers]:
        """Points and axes, (T, V, 3) each."""


def lattice_bounds(lattice: MovingNet, ts: Floats, half: Floats) -> Bounds:
    """Bounds over |t - ts| <= half in the lattice's own frame; proven up to rounding."""
    spread = _Spread(lattice, ts, half)
    return spread.bounds()


class _Spread:
    """Models of all angles between neighbouring bars, hinge by hinge away from the anchor."""

    def __init__(self, lattice: MovingNet, ts: Floats, half: Floats) -> None:
        self.lattice, self.half, self.count = lattice, half, len(ts)
        self.shape, self.anchor = lattice.shape, lattice.anchor
        self.d = len(self.shape)
        self.ts = ts
        m = lattice.lelieuvre(ts)
        self.m, self.x = m, points_of(m, lattice.r, self.anchor)
        self.quads: dict[tuple[Vertex, int, int], tuple[TaylorModel, TaylorModel]] = {}
        index = np.indices(self.shape).reshape(self.d, -1).T
        far = np.abs(index - np.array(self.anchor)).sum(axis=1)
        self.order = [tuple(map(int, index[i])) for i in np.argsort(far, kind="stable")]
        self.arms: dict[Vertex, dict[Arm, TaylorModel]] = {}
        for vertex in self.order:
            self.arms[vertex] = self._join(vertex)
            self._cross(vertex)

    # --- angles ------------------------------------------------------------------------------
    def _step(self, vertex: Vertex, arm: Arm) -> Vertex | None:
        """The hinge at the other end of an arm, or None outside the box."""
        k, sense = arm
        place = vertex[k] + sense
        if not 0 <= place < self.shape[k]:
            return None
        return (*vertex[:k], place, *vertex[k + 1 :])

    def _arms(self, vertex: Vertex) -> list[Arm]:
        every = [(k, sense) for k in range(self.d) for sense in (1, -1)]
        return [arm for arm in every if self._step(vertex, arm) is not None]

    def _corners(self, vertex: Vertex) -> Iterator[tuple[tuple[Vertex, int, int], int, Arm, Arm]]:
        """Isograms at a hinge: key, which corner of it the hinge is, its two arms."""
        for first in self._arms(vertex):
            for second in self._arms(vertex):
                (k, a), (other, b) = first, second
                if k < other:
                    base = list(vertex)
                    base[k] -= a < 0
                    base[other] -= b < 0
                    corner = {(1, 1): 0, (-1, 1): 1, (-1, -1): 2, (1, -1): 3}[a, b]
                    yield (tuple(base), k, other), corner, first, second

    def _join(self, vertex: Vertex) -> dict[Arm, TaylorModel]:
        """How every bar at a hinge turns about its axis m, relative to the first of them."""
        links: list[tuple[Arm, Arm, TaylorModel]] = []
        for key, corner, first, second in self._corners(vertex):
            if key in self.quads:
                phi, psi = self.quads[key]
                links.append((first, second, (phi, psi, phi.scaled(-1), psi.scaled(-1))[corner]))
        on_line = [
            k
            for k in range(self.d)
            if all(vertex[a] == self.anchor[a] for a in range(self.d) if a != k)
        ]
        # Turns are about the normals (-1)^u_0 m.
        sign = -1.0 if (vertex[0] - self.anchor[0]) % 2 else 1.0
        for k in on_line:
            if 0 < vertex[k] < self.shape[k] - 1:
                rate = sign * float(self.lattice.turn_rates[k][vertex[k] - 1])
                links.append(((k, -1), (k, 1), TaylorModel.linear(rate, self.count)))
        if vertex == self.anchor:
            for k in range(1, self.d):
                rate = float(self.lattice.corner_rates[k - 1])
                links.append(((0, 1), (k, 1), TaylorModel.linear(rate, self.count)))
        return _spanning(self._arms(vertex), links, self.count)

    def _cross(self, vertex: Vertex) -> None:
        """Carry angles at a hinge across the isograms at it that are not known yet."""
        arms = self.arms[vertex]
        for key, corner, first, second in self._corners(vertex):
            if key in self.quads:
                continue
            sign = 1.0 if corner < 2 else -1.0
            here = sign * self._angle(vertex, first, second)
            known = (arms[second] - arms[first]).scaled(sign)
            base, *pair = key
            one, two = (self._m_delta(k, base[k]) for k in pair)
            ratio = np.sin((one - two) / 2) / np.sin((one + two) / 2)
            next_one = closing(float(ratio), here, known, self.half)
            self.quads[key] = (known, next_one) if corner % 2 == 0 else (next_one, known)

    def _m_delta(self, k: int, place: int) -> float:
        """Angle of m along a bar: the deltas are those of (-1)^u_0 m."""
        delta = float(self.lattice.deltas[k][place])
        return np.pi - delta if k == 0 else delta

    def _angle(self, vertex: Vertex, first: Arm, second: Arm) -> Floats:
        """(T,) angle at a hinge about m from one arm to another."""
        here = self.x[vertex]
        a, b = (self.x[self._end(vertex, arm)] - here for arm in (first, second))
        return oriented_angle(self.m[vertex], a, b)

    def _end(self, vertex: Vertex, arm: Arm) -> Vertex:
        k, sense = arm
        return (*vertex[:k], vertex[k] + sense, *vertex[k + 1 :])

    # --- bodies ------------------------------------------------------------------------------
    def bounds(self) -> Bounds:
        """Spins and accelerations, bar by bar away from the anchor."""
        grid = Grid.build(self.shape)
        ids = np.arange(int(np.prod(self.shape))).reshape(self.shape)
        bar_of = {(int(i), int(j)): e for e, (i, j) in enumerate(grid.bars)}
        frames, rates = frames_and_rates(self.lattice, self.ts, grid.bars)
        now = np.linalg.norm(angular_velocity(frames, rates), axis=-1)
        spin_rate = np.full((self.count, len(grid.bars)), np.inf)
        spin = np.full_like(spin_rate, np.inf)
        acceleration = np.full((self.count, ids.size), np.inf)
        lengths = np.linalg.norm(
            frames[0, :, :3, 3] - self.x.reshape(-1, self.count, 3)[grid.bars[:, 1], 0], axis=-1
        )
        done = np.zeros(len(grid.bars), dtype=bool)

        def bar(vertex: Vertex, arm: Arm) -> int:
            start, end = int(ids[vertex]), int(ids[self._end(vertex, arm)])
            return bar_of[(start, end) if arm[1] > 0 else (end, start)]

        fixed = bar(self.anchor, (0, 1))
        spin_rate[:, fixed] = spin[:, fixed] = 0.0
        done[fixed] = True
        acceleration[:, ids[self.anchor]] = 0.0
        for vertex in self.order:
            at = {arm: bar(vertex, arm) for arm in self._arms(vertex)}
            known = [arm for arm in at if done[at[arm]]]
            for arm, e in at.items():
                if done[e]:
                    continue
                for parent in known:
                    p = at[parent]
                    model = self.arms[vertex][arm] - self.arms[vertex][parent]
                    first, second = model.speeds(self.half)
                    step = spin_rate[:, p] + second + first * np.maximum(spin[:, p], TINY)
                    spin_rate[:, e] = np.minimum(spin_rate[:, e], step)
                spin[:, e] = now[:, e] + self.half * spin_rate[:, e]
            for arm, e in at.items():
                done[e] = True
                end = ids[self._end(vertex, arm)]
                pull = lengths[e] * (spin_rate[:, e] + spin[:, e] ** 2)
                reached = acceleration[:, ids[vertex]] + pull
                acceleration[:, end] = np.minimum(acceleration[:, end], reached)
        return Bounds(acceleration, spin_rate, spin)


def _spanning(
    arms: list[Arm], links: list[tuple[Arm, Arm, TaylorModel]], count: int
) -> dict[Arm, TaylorModel]:
    """Models of all arms relative to the first, along the fewest links."""
    out = {arms[0]: TaylorModel.linear(0.0, count)}
    front = [arms[0]]
    while front:
        ahead: list[Arm] = []
        for arm in front:
            for a, b, model in links:
                if a == arm and b not in out:
                    out[b] = out[a] + model
                    ahead.append(b)
                elif b == arm and a not in out:
                    out[a] = out[b] - model
                    ahead.append(a)
        front = ahead
    return out

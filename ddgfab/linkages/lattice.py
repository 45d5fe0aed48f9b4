"""Linkages whose hinges are the vertices of a K-net on a box: bars, isograms, and their motion.

The motion turns the Cauchy data along the lines through one vertex, the anchor, linearly in the
driving angle; the net follows by half-turns. Source: mathematics.md 3.5, 4.3, 4.4.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ddgfab.linkages.cauchy import Numbers, evolve, line, points_of
from ddgfab.linkages.mechanism import Bounds
from ddgfab.linkages.rates import lattice_bounds
from ddgfab.mesh import Floats


@dataclass(frozen=True, eq=False)
class Lattice:
    """A K-net on a box of Z^d, d = 2 or 3, and how its Cauchy data turn.

    Attributes
    ----------
    deltas : per direction, (n_k - 1,) angles of consecutive normals [rad]
    turns : per direction, (n_k - 2,) deviations of consecutive edges of the line through the
        anchor, at the design [rad]
    corners : (d - 1,) angles at the anchor from the edge of direction 0 to that of direction k, in
        radians
    r : scale [mm]: bars have lengths r sin(delta)
    anchor : index of the vertex the lines go through; not the last in any direction
    design : driving angle t of these data [rad]
    turn_rates, corner_rates : derivatives of turns and corners by t
    """

    deltas: tuple[Floats, ...]
    turns: tuple[Floats, ...]
    corners: Floats
    r: float
    anchor: tuple[int, ...]
    design: float
    turn_rates: tuple[Floats, ...]
    corner_rates: Floats

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of vertices in each direction."""
        return tuple(len(delta) + 1 for delta in self.deltas)

    def lelieuvre(self, ts: Numbers) -> Numbers:
        """(n1, ..., nd, T, 3) unit field m, analytic in t."""
        step = np.asarray(ts) - self.design
        n = np.zeros((len(step), 3), dtype=step.dtype)
        n[:, 2] = 1.0
        lines = []
        for k, delta in enumerate(self.deltas):
            angle = np.zeros_like(step)
            if k:
                angle = self.corners[k - 1] + self.corner_rates[k - 1] * step
            edge = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
            turns = self.turns[k][:, None] + self.turn_rates[k][:, None] * step
            sign = 1.0 if k == 0 else -1.0
            lines.append(line(n, edge, delta, turns, self.anchor[k], sign))
        odd = (-1.0) ** (np.arange(len(lines[0])) - self.anchor[0])
        lines[0] = lines[0] * odd[:, None, None]
        return evolve(lines, self.anchor)

    def place(self, ts: Numbers) -> tuple[Numbers, Numbers]:
        """Points and axes, (T, V, 3); the anchor at the origin, its axis z, its first edge x."""
        m = self.lelieuvre(ts)
        d = len(self.deltas)
        x = points_of(m, self.r, self.anchor)
        n = m
        for k, signs in enumerate(self._signs()):
            n = n * signs.reshape(-1, *(1,) * (d + 1 - k))
        count = len(ts)
        return (
            np.moveaxis(x.reshape(-1, count, 3), 1, 0),
            np.moveaxis(n.reshape(-1, count, 3), 1, 0),
        )

    def _signs(self) -> list[Floats]:
        """Per direction, (n_k,) signs from m to axes that twist by a right angle at most.

        A hinge axis is a line; its sense is ours to choose. So chosen, a bar lies on one side of
        the hinges at both ends. They are 1 at the anchor. A bar of m twists by -(pi - delta) in
        direction 0 and by -delta in the others.
        """
        out = []
        for k, delta in enumerate(self.deltas):
            keeps = (delta > np.pi / 2) if k == 0 else (delta <= np.pi / 2)
            signs = np.concatenate([[1.0], np.cumprod(np.where(keeps, 1.0, -1.0))])
            out.append(signs * signs[self.anchor[k]])
        return out

    def bounds(self, ts: Floats, half: Floats) -> Bounds:
        """See `ddgfab.linkages.rates.lattice_bounds`."""
        return lattice_bounds(self, ts, half)

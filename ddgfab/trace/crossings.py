"""Where lines of two families cross: all pairs of steps at once, on their cubic interpolants."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.spatial import cKDTree

from ddgfab.mesh import Floats, Ints
from ddgfab.trace.lines import Line

_REACH: Final = 0.6
"""How far beyond their ends straight steps are followed for a first guess, in steps."""
_NEWTON: Final = 10
_GAP: Final = 1e-9
"""Greatest gap at a crossing, in steps."""
_PAST: Final = 1e-9
"""How far beyond the end of a step a crossing still counts."""


@dataclass(frozen=True, eq=False)
class Crossings:
    """Crossings: lines of both families (k,), arc lengths on both (k,), parameters (k, 2)."""

    first: Ints
    second: Ints
    s_first: Floats
    s_second: Floats
    uv: Floats


@dataclass(frozen=True, eq=False)
class _Steps:
    """Steps of many lines: line, arc length at the start, length, ends and speeds, middles."""

    line: Ints
    s: Floats
    h: Floats
    a: Floats
    b: Floats
    da: Floats
    db: Floats
    middle: Floats
    half: Floats

    @staticmethod
    def of(lines: list[Line]) -> _Steps:
        return _Steps(
            np.repeat(np.arange(len(lines)), [len(line.s) - 1 for line in lines]),
            np.concatenate([line.s[:-1] for line in lines]),
            np.concatenate([np.diff(line.s) for line in lines]),
            np.concatenate([line.uv[:-1] for line in lines]),
            np.concatenate([line.uv[1:] for line in lines]),
            np.concatenate([line.speed[:-1] for line in lines]),
            np.concatenate([line.speed[1:] for line in lines]),
            np.concatenate([0.5 * (line.x[1:] + line.x[:-1]) for line in lines]),
            np.concatenate(
                [0.5 * np.linalg.norm(np.diff(line.x, axis=0), axis=1) for line in lines]
            ),
        )

    def value(self, which: Ints, t: Floats) -> tuple[Floats, Floats]:
        """(k, 2) values and derivatives by t of the cubics of some steps."""
        t, h = t[:, None], self.h[which][:, None]
        a, b, da, db = (
            part[which] * factor
            for part, factor in ((self.a, 1), (self.b, 1), (self.da, h), (self.db, h))
        )
        value = (
            (1 + 2 * t) * (1 - t) ** 2 * a
            + t * (1 - t) ** 2 * da
            + t**2 * (3 - 2 * t) * b
            - t**2 * (1 - t) * db
        )
        rate = 6 * t * (1 - t) * (b - a) + (1 - t) * (1 - 3 * t) * da - t * (2 - 3 * t) * db
        return value, rate


def crossings(first: list[Line], second: list[Line]) -> Crossings:
    """All crossings of lines of one family with those of the other; one at a joint comes twice."""
    one, two = _Steps.of(first), _Steps.of(second)
    reach = 1.3 * float(one.half.max() + two.half.max())
    near = cKDTree(one.middle).query_ball_tree(cKDTree(two.middle), reach)
    i = np.repeat(np.arange(len(near)), [len(row) for row in near])
    j = np.array([k for row in near for k in row], dtype=np.int64)
    way, other = one.b[i] - one.a[i], two.b[j] - two.a[j]
    gap = two.a[j] - one.a[i]
    turn = way[:, 0] * other[:, 1] - way[:, 1] * other[:, 0]
    size = np.linalg.norm(way, axis=1) * np.linalg.norm(other, axis=1)
    steep = np.abs(turn) > 1e-3 * size
    safe = np.where(steep, turn, 1.0)
    t = (gap[:, 0] * other[:, 1] - gap[:, 1] * other[:, 0]) / safe
    w = (gap[:, 0] * way[:, 1] - gap[:, 1] * way[:, 0]) / safe
    low, high = -_REACH, 1 + _REACH
    keep = steep & (t > low) & (t < high) & (w > low) & (w < high)
    i, j, t, w = i[keep], j[keep], t[keep], w[keep]
    for _ in range(_NEWTON):
        p, dp = one.value(i, t)
        q, dq = two.value(j, w)
        gap = q - p
        turn = dp[:, 0] * dq[:, 1] - dp[:, 1] * dq[:, 0]
        safe = np.where(np.abs(turn) > 0, turn, np.inf)
        t = np.clip(t + (gap[:, 0] * dq[:, 1] - gap[:, 1] * dq[:, 0]) / safe, -1, 2)
        w = np.clip(w + (gap[:, 0] * dp[:, 1] - gap[:, 1] * dp[:, 0]) / safe, -1, 2)
    p, dp = one.value(i, t)
    q, _ = two.value(j, w)
    met = np.linalg.norm(p - q, axis=1) < _GAP * np.linalg.norm(dp, axis=1)
    on = (np.minimum(t, w) >= -_PAST) & (np.maximum(t, w) <= 1 + _PAST)
    keep = met & on
    i, j, t, w, p = i[keep], j[keep], t[keep], w[keep], p[keep]
    return Crossings(one.line[i], two.line[j], one.s[i] + t * one.h[i], two.s[j] + w * two.h[j], p)

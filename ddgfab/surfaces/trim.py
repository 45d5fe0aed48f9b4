"""Trimming loops of a surface: polygons in its parameter plane, one outside, others round holes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ddgfab.errors import InputError
from ddgfab.mesh import Floats, Ints

_OUTSIDE: Final = 1e-9
"""How far a loop may leave the rectangle of parameters, relative to its sides."""
_PARALLEL: Final = 1e-14
"""Sine below which a chord and a segment of a loop do not cross."""


@dataclass(frozen=True, eq=False)
class Trim:
    """Closed polygons: the first counterclockwise, all others clockwise, the surface on the left.

    Attributes
    ----------
    loops : (m, 2) corners each, the first not repeated
    """

    loops: tuple[Floats, ...]

    @staticmethod
    def of(
        loops: Sequence[ArrayLike] | None,
        domain: tuple[float, float, float, float],
        name: str = "surface",
    ) -> Trim:
        """Loops checked and oriented; the sides of the domain where there are none.

        Raises
        ------
        InputError
            Fewer than three corners, corners outside the domain, a loop that crosses itself or
            another, a hole outside of the first loop; names loop and place.
        """
        u0, u1, v0, v1 = domain
        if loops is None:
            return Trim((np.array([[u0, v0], [u1, v0], [u1, v1], [u0, v1]]),))
        size = np.array([u1 - u0, v1 - v0])
        out: list[Floats] = []
        for number, given in enumerate(loops):
            loop = np.asarray(given, dtype=np.float64)
            if loop.ndim != 2 or loop.shape[1] != 2:
                raise InputError(f"{name}: trim {number} has shape {loop.shape}; expected (m, 2)")
            apart = (np.abs(loop - np.roll(loop, 1, axis=0)) > 1e-12 * size).any(axis=1)
            loop = loop[apart]
            if len(loop) < 3:
                raise InputError(f"{name}: trim {number} has {len(loop)} corners; 3 are needed")
            low, high = np.array([u0, v0]), np.array([u1, v1])
            beyond = ((loop < low - _OUTSIDE * size) | (loop > high + _OUTSIDE * size)).any(axis=1)
            if beyond.any():
                u, v = loop[beyond][0]
                raise InputError(
                    f"{name}: trim {number} leaves the surface at u = {u:.6g}, v = {v:.6g}"
                )
            loop = np.clip(loop, low, high)
            area = polygon_area(loop)
            outer = not out
            out.append(loop if (area > 0) == outer else loop[::-1].copy())
        trim = Trim(tuple(out))
        trim._check_simple(name)
        whole = Trim((out[0],))
        for number, hole in enumerate(out[1:], 1):
            outside = ~whole.inside(0.5 * (hole + np.roll(hole, 1, axis=0)))
            if outside.all():
                u, v = hole[0]
                raise InputError(
                    f"{name}: trim {number} is not a hole: it lies outside of trim 0, at "
                    f"u = {u:.6g}, v = {v:.6g}"
                )
        return trim

    @cached_property
    def starts(self) -> Floats:
        """(s, 2) first points of all segments, loop after loop."""
        return np.concatenate(self.loops)

    @cached_property
    def ends(self) -> Floats:
        """(s, 2) last points of all segments."""
        return np.concatenate([np.roll(loop, -1, axis=0) for loop in self.loops])

    @cached_property
    def loop_start(self) -> Ints:
        """(number of loops + 1,) first segment of each loop."""
        return np.concatenate([[0], np.cumsum([len(loop) for loop in self.loops])])

    @property
    def area(self) -> float:
        """Area in the parameter plane."""
        return sum(polygon_area(loop) for loop in self.loops)

    @property
    def box(self) -> tuple[float, float, float, float]:
        """Least u, greatest u, least v, greatest v."""
        (u0, v0), (u1, v1) = self.loops[0].min(axis=0), self.loops[0].max(axis=0)
        return float(u0), float(u1), float(v0), float(v1)

    def inside(self, uv: Floats) -> NDArray[np.bool_]:
        """(n,) whether points (n, 2) lie inside: an odd number of crossings to one side."""
        a, b = self.starts, self.ends
        u, v = uv[:, :1], uv[:, 1:]
        spans = (a[:, 1] > v) != (b[:, 1] > v)
        rise = np.where(a[:, 1] == b[:, 1], 1.0, b[:, 1] - a[:, 1])
        at = a[:, 0] + (v - a[:, 1]) / rise * (b[:, 0] - a[:, 0])
        odd: NDArray[np.bool_] = ((spans & (u < at)).sum(axis=1) % 2).astype(bool)
        return odd

    def crossing(self, start: Floats, end: Floats) -> tuple[Floats, Ints]:
        """(n,) part of chords (n, 2) at which they first meet a loop, (n,) its segment; or inf, -1.

        Only where a chord goes from inside to outside.
        """
        a, b = self.starts, self.ends
        way, side = (end - start)[:, None], (b - a)[None]
        turn = way[..., 0] * side[..., 1] - way[..., 1] * side[..., 0]
        size = np.linalg.norm(way, axis=-1) * np.linalg.norm(side, axis=-1)
        leaves = turn > _PARALLEL * size  # the surface is left of each side
        gap = a[None] - start[:, None]
        safe = np.where(leaves, turn, 1.0)
        t = (gap[..., 0] * side[..., 1] - gap[..., 1] * side[..., 0]) / safe
        w = (gap[..., 0] * way[..., 1] - gap[..., 1] * way[..., 0]) / safe
        hit = leaves & (t >= -1e-12) & (t <= 1 + 1e-12) & (w >= -1e-12) & (w <= 1 + 1e-12)
        part = np.where(hit, t, np.inf)
        which = part.argmin(axis=1)
        first = part[np.arange(len(part)), which]
        return first, np.where(np.isfinite(first), which, -1)

    def _check_simple(self, name: str) -> None:
        """Raise where two segments cross that are not neighbors."""
        a, b = self.starts, self.ends
        way = b - a
        turn = way[:, None, 0] * way[None, :, 1] - way[:, None, 1] * way[None, :, 0]
        gap = a[None] - a[:, None]
        safe = np.where(np.abs(turn) > 0, turn, 1.0)
        t = (gap[..., 0] * way[None, :, 1] - gap[..., 1] * way[None, :, 0]) / safe
        w = (gap[..., 0] * way[:, None, 1] - gap[..., 1] * way[:, None, 0]) / safe
        near = 1e-9
        hit = (np.abs(turn) > 0) & (t > near) & (t < 1 - near) & (w > near) & (w < 1 - near)
        bad = np.argwhere(hit)
        if len(bad):
            i = bad[0, 0]
            u, v = a[i] + t[tuple(bad[0])] * way[i]
            raise InputError(f"{name}: trimming curves cross at u = {u:.6g}, v = {v:.6g}")


def polygon_area(loop: Floats) -> float:
    """Signed area of a closed polygon (m, 2), positive counterclockwise."""
    points = loop - loop[0]
    after = np.roll(points, -1, axis=0)
    return 0.5 * float(np.sum(points[:, 0] * after[:, 1] - points[:, 1] * after[:, 0]))

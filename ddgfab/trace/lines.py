"""Lines of a field on a surface: all seeds at once, Runge-Kutta steps in the parameter plane.

A line ends at the trimming curves, at an umbilic, or where it began. Source:
Alliez, Cohen-Steiner, Devillers, Lévy, Desbrun 2003, Anisotropic polygonal remeshing.
"""

from __future__ import annotations

from dataclasses import dataclass
from dataclasses import field as dataclass_field
from typing import Final, Literal, TypeAlias

import numpy as np

from ddgfab.mesh import Floats, Ints
from ddgfab.surfaces.principal import lifted
from ddgfab.surfaces.spline import SplineSurface
from ddgfab.surfaces.trim import Trim
from ddgfab.trace.field import Field

End: TypeAlias = Literal["boundary", "umbilic", "closed", "long"]

_NEAR_PART, _LEAST_PART = 0.25, 1 / 50
"""Near an umbilic a step is this part of the distance, at least this part of a whole one."""
_STOP: Final = 0.08
"""A line ends at an umbilic within this part of a step (0.02 of the spacing)."""
_SNAP: Final = 0.3
"""A line is closed when it passes its seed within this part of a step."""
_CHORDS: Final = 8
"""Chords of a step in which the first meeting with a trimming curve is looked for."""
_NEWTON: Final = 8


@dataclass(frozen=True, eq=False)
class Line:
    """A traced line.

    Attributes
    ----------
    uv : (n, 2) parameters; speed : (n, 2) their derivatives by arc length; s : (n,) arc length;
        x : (n, 3) points
    ends : how it ends at its first and last point
    rim : segment of the trim at the first and the last point, -1 where it does not end there
    """

    uv: Floats
    speed: Floats
    s: Floats
    x: Floats
    ends: tuple[End, End]
    rim: tuple[int, int]

    @property
    def length(self) -> float:
        """Its arc length."""
        return float(self.s[-1])

    @property
    def closed(self) -> bool:
        """Whether it ends where it begins."""
        return self.ends[0] == "closed"

    def at(self, s: Floats) -> Floats:
        """(k, 2) parameters at arc lengths."""
        return hermite(self.uv, self.speed, self.s, s)


def hermite(uv: Floats, speed: Floats, s: Floats, at: Floats) -> Floats:
    """Cubic Hermite interpolation of (n, 2) values with derivatives `speed` at arc lengths s."""
    i = np.clip(np.searchsorted(s, at, side="right") - 1, 0, len(s) - 2)
    h = s[i + 1] - s[i]
    t = ((at - s[i]) / h)[:, None]
    h = h[:, None]
    return np.asarray(
        (1 + 2 * t) * (1 - t) ** 2 * uv[i]
        + t * (1 - t) ** 2 * h * speed[i]
        + t**2 * (3 - 2 * t) * uv[i + 1]
        - t**2 * (1 - t) * h * speed[i + 1]
    )


@dataclass(eq=False)
class _Record:
    """Points of half-lines as they are made: one array a step."""

    ids: list[Ints] = dataclass_field(default_factory=list)
    uv: list[Floats] = dataclass_field(default_factory=list)
    speed: list[Floats] = dataclass_field(default_factory=list)
    x: list[Floats] = dataclass_field(default_factory=list)
    step: list[Floats] = dataclass_field(default_factory=list)

    def add(self, ids: Ints, uv: Floats, speed: Floats, x: Floats, step: Floats) -> None:
        """Keep a point for each of some half-lines; arrays are not copied."""
        for rows, values in zip(
            (self.ids, self.uv, self.speed, self.x, self.step),
            (ids, uv, speed, x, step),
            strict=True,
        ):
            rows.append(values)  # type: ignore[attr-defined]


class Tracer:
    """Traces lines of one family of a field.

    Parameters
    ----------
    step : arc length of a step, about a quarter of the spacing
    longest : arc length at which a line is given up (a spiral)
    poles : (k, 3) umbilics
    """

    def __init__(
        self, field: Field, family: int, step: float, longest: float, poles: Floats
    ) -> None:
        self.field, self.family, self.step = field, family, step
        self.longest, self.poles = longest, poles.reshape(-1, 3)
        self.surface: SplineSurface = field.surface
        self.trim: Trim = field.surface.trim

    def _velocity(self, uv: Floats, along: Floats) -> Floats:
        """(n, 2) unit speed at parameters, to the side of vectors (n, 3)."""
        return self._state(uv, along)[0]

    def _state(self, uv: Floats, along: Floats) -> tuple[Floats, Floats, Floats]:
        """Unit speed (n, 2), tangent (n, 3) and point (n, 3), to the side of vectors (n, 3)."""
        jets = self.surface.jets(uv)
        speed = self.field.directions(jets, self.family)
        tangent = lifted(jets, speed)
        sign = np.where(np.einsum("nx,nx->n", tangent, along) < 0, -1.0, 1.0)[:, None]
        return sign * speed, sign * tangent, jets.x

    def stepped(self, uv: Floats, speed: Floats, along: Floats, h: Floats) -> Floats:
        """(n, 2) parameters after a Runge-Kutta step of order 4."""
        h = h[:, None]
        two = self._velocity(uv + 0.5 * h * speed, along)
        three = self._velocity(uv + 0.5 * h * two, along)
        four = self._velocity(uv + h * three, along)
        return np.asarray(uv + h / 6 * (speed + 2 * two + 2 * three + four))

    def lines(self, seeds: Floats) -> list[Line]:
        """The lines through (k, 2) parameters inside the trim, in the order of the seeds."""
        count = len(seeds)
        if not count:
            return []
        record, ends, rim, leaving = self._walk(seeds)
        self._finish(record, rim, leaving)
        ids = np.concatenate(record.ids)
        order = np.argsort(ids, kind="stable")
        bounds = np.searchsorted(ids[order], np.arange(2 * count + 1))
        parts = [np.concatenate(rows)[order] for rows in (record.uv, record.speed, record.x)]
        steps = np.concatenate(record.step)[order]
        out = []
        for i in range(count):
            ahead = slice(bounds[i], bounds[i + 1])
            back = slice(bounds[count + i] + 1, bounds[count + i + 1])
            uv, speed, x = (part[ahead] for part in parts)
            s = np.cumsum(steps[ahead])
            if ends[i] == "closed":
                out.append(Line(uv, speed, s, x, ("closed", "closed"), (-1, -1)))
                continue
            s_back = np.cumsum(steps[back])
            total = float(s_back[-1]) if len(s_back) else 0.0
            out.append(
                Line(
                    np.concatenate([parts[0][back][::-1], uv]),
                    np.concatenate([-parts[1][back][::-1], speed]),
                    np.concatenate([total - s_back[::-1], total + s]),
                    np.concatenate([parts[2][back][::-1], x]),
                    (ends[count + i], ends[i]),
                    (int(rim[count + i]), int(rim[i])),
                )
            )
        return [line for line in out if len(line.s) > 1]

    def _walk(
        self, seeds: Floats
    ) -> tuple[_Record, list[End], Ints, list[tuple[Ints, Floats, Floats, Floats, Floats]]]:
        """Whole steps of all half-lines: forwards first, then backwards."""
        count = len(seeds)
        uv = np.concatenate([seeds, seeds])
        jets = self.surface.jets(uv)
        speed = self.field.directions(jets, self.family)
        speed[count:] *= -1
        along, x = lifted(jets, speed), jets.x
        origin, heading = x.copy(), along.copy()
        ends: list[End] = ["long"] * (2 * count)
        rim = np.full(2 * count, -1)
        record, leaving = _Record(), []
        alive = np.arange(2 * count)
        record.add(alive, uv.copy(), speed.copy(), x.copy(), np.zeros(len(alive)))
        done = np.zeros(2 * count)
        number = 0
        while len(alive):
            number += 1
            h = np.full(len(alive), self.step)
            if len(self.poles):
                far = np.linalg.norm(x[:, None] - self.poles, axis=2).min(axis=1)
                h = np.clip(_NEAR_PART * far, _LEAST_PART * self.step, self.step)
            new = self.stepped(uv, speed, along, h)
            new_speed, new_along, new_x = self._state(new, along)
            out = ~self.trim.inside(new)
            if out.any():
                leaving.append((alive[out], uv[out], speed[out], along[out], h[out]))
                for i in alive[out]:
                    ends[i] = "boundary"
            stop = out.copy()
            if number > 3:
                stop |= self._closing(
                    record, alive, x, new_x, new_along, h, seeds, origin, heading, ends, stop
                )
            keep = ~stop
            record.add(alive[keep], new[keep], new_speed[keep], new_x[keep], h[keep])
            done[alive] += h
            if len(self.poles):
                far = np.linalg.norm(new_x[:, None] - self.poles, axis=2).min(axis=1)
                at_pole = keep & (far < _STOP * self.step)
                for i in alive[at_pole]:
                    ends[i] = "umbilic"
                keep &= ~at_pole
            keep &= done[alive] < self.longest
            alive, uv, speed = alive[keep], new[keep], new_speed[keep]
            along, x = new_along[keep], new_x[keep]
        return record, ends, rim, leaving

    def _closing(
        self,
        record: _Record,
        alive: Ints,
        x: Floats,
        new_x: Floats,
        new_along: Floats,
        h: Floats,
        seeds: Floats,
        origin: Floats,
        heading: Floats,
        ends: list[End],
        stopped: np.ndarray,
    ) -> np.ndarray:
        """Which half-lines pass their seed on this step the way they left it; they end there."""
        chord = new_x - x
        gap = origin[alive] - x
        square = np.maximum(np.einsum("nx,nx->n", chord, chord), np.finfo(float).tiny)
        part = np.clip(np.einsum("nx,nx->n", gap, chord) / square, 0.0, 1.0)
        far = np.linalg.norm(gap - part[:, None] * chord, axis=1)
        same = np.einsum("nx,nx->n", new_along, heading[alive]) > 0.5
        found = ~stopped & (far < _SNAP * h) & same
        if found.any():
            ids = alive[found]
            seed = seeds[ids % len(seeds)]
            jets = self.surface.jets(seed)
            speed = self.field.directions(jets, self.family)
            tangent = lifted(jets, speed)
            speed[np.einsum("nx,nx->n", tangent, heading[ids]) < 0] *= -1
            length = np.linalg.norm(gap[found], axis=1)
            record.add(ids, seed, speed, jets.x, np.maximum(length, 1e-9 * h[found]))
            for i in ids:
                ends[i] = "closed"
        return np.asarray(found)

    def _finish(
        self,
        record: _Record,
        rim: Ints,
        leaving: list[tuple[Ints, Floats, Floats, Floats, Floats]],
    ) -> None:
        """Last steps of all half-lines that leave the surface: exactly to the trimming curves."""
        if not leaving:
            return
        ids, uv, speed, along, h = (np.concatenate(rows) for rows in zip(*leaving, strict=True))
        new = self.stepped(uv, speed, along, h)
        new_speed, _, _ = self._state(new, along)
        length, side = self._first_crossing(uv, speed, new, new_speed, h)
        a, b = self.trim.starts[side], self.trim.ends[side]
        across = np.stack([b[:, 1] - a[:, 1], a[:, 0] - b[:, 0]], axis=1)
        across /= np.linalg.norm(across, axis=1, keepdims=True)
        for _ in range(_NEWTON):
            new = self.stepped(uv, speed, along, length)
            new_speed, _, _ = self._state(new, along)
            off = np.einsum("nx,nx->n", new - a, across)
            rate = np.einsum("nx,nx->n", new_speed, across)
            pace = np.linalg.norm(new_speed, axis=1)
            rate = np.where(np.abs(rate) > 1e-3 * pace, rate, np.inf)
            length = np.clip(length - off / rate, 1e-9 * h, 1.5 * h)
        new = self.stepped(uv, speed, along, length)
        new -= np.einsum("nx,nx->n", new - a, across)[:, None] * across
        way = b - a
        part = np.einsum("nx,nx->n", new - a, way) / np.einsum("nx,nx->n", way, way)
        new = a + np.clip(part, 0.0, 1.0)[:, None] * way
        new_speed, _, x = self._state(new, along)
        record.add(ids, new, new_speed, x, length)
        rim[ids] = side

    def _first_crossing(
        self, uv: Floats, speed: Floats, new: Floats, new_speed: Floats, h: Floats
    ) -> tuple[Floats, Ints]:
        """(n,) arc length at which a step first meets a trimming curve, (n,) the segment."""
        parts = np.linspace(0, 1, _CHORDS + 1)
        t = parts[:, None, None]
        w = h[None, :, None]
        path = (
            (1 + 2 * t) * (1 - t) ** 2 * uv
            + t * (1 - t) ** 2 * w * speed
            + t**2 * (3 - 2 * t) * new
            - t**2 * (1 - t) * w * new_speed
        )
        length, side = np.full(len(uv), np.inf), np.full(len(uv), -1)
        for k in range(_CHORDS):
            part, segment = self.trim.crossing(path[k], path[k + 1])
            first = (side < 0) & (segment >= 0)
            length[first] = ((k + part[first]) / _CHORDS) * h[first]
            side[first] = segment[first]
        lost = np.flatnonzero(side < 0)  # along a curve, or through a corner: the nearest segment
        if len(lost):
            length[lost] = h[lost]
            side[lost] = self._nearest_segment(new[lost])
        return length, side

    def _nearest_segment(self, uv: Floats) -> Ints:
        a, way = self.trim.starts, self.trim.ends - self.trim.starts
        gap = uv[:, None] - a
        part = np.einsum("nsx,sx->ns", gap, way) / np.einsum("sx,sx->s", way, way)
        far = np.linalg.norm(gap - np.clip(part, 0, 1)[..., None] * way, axis=2)
        return np.asarray(far.argmin(axis=1))

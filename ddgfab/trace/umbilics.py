"""Umbilics of a surface with their index, by the winding of the deviator of the shape operator.

Source: Berry, Hannay 1977, Umbilic points on Gaussian random surfaces.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from ddgfab.errors import DegenerateError
from ddgfab.mesh import Floats
from ddgfab.surfaces.principal import principal
from ddgfab.surfaces.spline import SplineSurface
from ddgfab.trace.samples import SIDE, Samples

_JOIN: Final = 1.6
"""Zeros nearer than this [cells] are one: a rotational apex splits into two of index 1/2."""
_ROUND: Final = 1e-3
"""Anisotropy below which a sample counts as umbilic."""
_FLAT: Final = 1e-6
"""Curvature times size below which a surface is plane."""
_ROUND_SHARE: Final = 0.2
"""With a greater share of such samples every orthogonal net is principal."""
_MANY: Final = 3
"""So many zeros, or more, may lie on a line of umbilics."""
_LOW: Final = 0.05
"""Curvatures that differ by less than this part of their median difference from one zero to the
next make a line."""
_STEPS: Final = 30


@dataclass(frozen=True)
class Umbilic:
    """A point where both principal curvatures are equal.

    Attributes
    ----------
    uv, x : place; index : half a whole number, +1/2 (lemon, monstar), -1/2 (star), ...
    """

    uv: tuple[float, float]
    x: tuple[float, float, float]
    index: float

    @property
    def corners(self) -> float:
        """Corners 4 (1 - index) of the cell round it."""
        return 4 * (1 - self.index)


def check_anisotropy(samples: Samples) -> None:
    """Raise where principal directions are not determined on much of the surface.

    Raises
    ------
    DegenerateError
        A sphere, a plane, or much of one.
    """
    found = samples.principal
    bend = np.maximum(np.abs(found.larger), np.abs(found.smaller))[samples.inside]
    flat = bend * samples.diameter < _FLAT
    check_curved(samples)
    part = float(((found.anisotropy[samples.inside] < _ROUND) | flat).mean())
    if part > _ROUND_SHARE:
        raise DegenerateError(
            f"{samples.surface.name}: {100 * part:.0f} % of it is spherical or plane: every "
            "orthogonal net is principal there\ngive directions: --along X,Y,Z (plane sections)"
        )


def check_curved(samples: Samples) -> None:
    """Raise where a surface is plane: every net on it has planar faces, none is better.

    Raises
    ------
    DegenerateError
        A plane.
    """
    found = samples.principal
    bend = np.maximum(np.abs(found.larger), np.abs(found.smaller))[samples.inside]
    if float(bend.max()) * samples.diameter < _FLAT:
        raise DegenerateError(
            f"{samples.surface.name}: is plane (curvature times size below {_FLAT:g}): no "
            "directions are better than others\nany net drawn on it has planar faces"
        )


def umbilics(samples: Samples) -> tuple[Umbilic, ...]:
    """The umbilics inside the trim, in order of u.

    Raises
    ------
    DegenerateError
        A line of umbilics.
    """
    deviator = samples.principal.deviator.reshape(SIDE, SIDE, 2)
    angle = np.arctan2(deviator[..., 1], deviator[..., 0])
    ring = np.stack([angle[:-1, :-1], angle[1:, :-1], angle[1:, 1:], angle[:-1, 1:]])
    turn = np.roll(ring, -1, axis=0) - ring
    turn -= 2 * np.pi * np.round(turn / (2 * np.pi))
    winding = np.round(turn.sum(axis=0) / (2 * np.pi)).astype(int)
    cells = np.argwhere(winding != 0)
    if not len(cells):
        return ()
    zeros = _newton(
        samples.surface, samples.uv[cells[:, 0], cells[:, 1]] + samples.cell / 2, samples.cell
    )
    inside = samples.surface.trim.inside(zeros)
    groups = [group for group in _clusters(zeros / samples.cell) if inside[group].any()]
    if len(groups) >= _MANY:
        u, v = zeros[groups[0][0]]
        if _on_line(samples, np.array([zeros[group].mean(axis=0) for group in groups])):
            raise DegenerateError(
                f"{samples.surface.name}: {len(groups)} umbilics: a line of umbilics (near "
                f"u = {u:.4g}, v = {v:.4g})\ngive directions: --along X,Y,Z (plane sections), "
                "or change the surface there"
            )
    found = []
    for group in groups:
        uv = zeros[group].mean(axis=0)
        total = int(winding[tuple(cells[group].T)].sum())
        if total and samples.surface.trim.inside(uv[None])[0]:
            if len(group) > 1:
                uv = _newton(samples.surface, uv[None], samples.cell)[0]
            x = samples.surface.points(uv[None])[0]
            place = (float(x[0]), float(x[1]), float(x[2]))
            found.append(Umbilic((float(uv[0]), float(uv[1])), place, total / 2))
    return tuple(sorted(found, key=lambda umbilic: umbilic.uv))


def _on_line(samples: Samples, zeros: Floats) -> bool:
    """Whether zeros (n, 2) lie on lines of umbilics."""
    apart = np.linalg.norm((zeros[:, None] - zeros[None]) / samples.cell, axis=2)
    np.fill_diagonal(apart, np.inf)
    next_ = zeros[apart.argmin(axis=1)]
    way = next_ - zeros
    across = np.stack([-way[:, 1], way[:, 0]], axis=1)  # lines bend between two zeros
    along = np.linspace(0, 1, 7)[:, None, None, None]
    beside = np.linspace(-0.25, 0.25, 25)[:, None, None]
    near = (zeros + along * way + beside * across).reshape(-1, 2)
    size = np.hypot(*principal(samples.surface.jets(near)).deviator.T).reshape(7, 25, -1)
    median = float(np.median(np.hypot(*samples.principal.deviator[samples.inside].T)))
    on_line = size.min(axis=1).max(axis=0) < _LOW * median
    return bool(on_line.sum() > len(zeros) / 2)


def _newton(surface: SplineSurface, start: Floats, cell: Floats) -> Floats:
    """Zeros of the deviator near (n, 2) parameters; the start where none is within 1.5 cells."""

    def value(uv: Floats) -> Floats:
        return principal(surface.jets(uv)).deviator

    uv, h = start.copy(), 1e-4 * cell
    for _ in range(_STEPS):
        columns = []
        for axis in (0, 1):
            step = np.zeros(2)
            step[axis] = h[axis]
            columns.append((value(uv + step) - value(uv - step)) / (2 * h[axis]))
        (a, c), (b, d) = columns[0].T, columns[1].T
        f = value(uv)
        det = a * d - b * c
        size = np.maximum(np.abs(a * d) + np.abs(b * c), np.finfo(float).tiny)
        safe = np.where(np.abs(det) > 1e-9 * size, det, np.inf)
        move = -np.stack(
            [(d * f[:, 0] - b * f[:, 1]) / safe, (a * f[:, 1] - c * f[:, 0]) / safe], 1
        )
        move = np.clip(move, -0.5 * cell, 0.5 * cell)
        uv = uv + move
        if np.abs(move / cell).max() < 1e-13:
            break
    far = np.asarray((np.abs(uv - start) > 1.5 * cell).any(axis=1))
    return np.where(far[:, None], start, uv)


def _clusters(points: Floats) -> list[list[int]]:
    """Groups of points (n, 2) that are chained by distances below `_JOIN`."""
    apart = np.linalg.norm(points[:, None] - points[None], axis=2)
    waiting, groups = set(range(len(points))), []
    while waiting:
        group, todo = [], [min(waiting)]
        waiting.discard(todo[0])
        while todo:
            i = todo.pop()
            group.append(i)
            near = [j for j in sorted(waiting) if apart[i, j] < _JOIN]
            waiting.difference_update(near)
            todo += near
        groups.append(sorted(group))
    return groups

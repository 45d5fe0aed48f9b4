"""From a lattice that moves to a `Mechanism`: lengths, twists, mobility, dead points."""

from __future__ import annotations

import numpy as np

from ddgfab.linkages.lattice import Grid, Lattice
from ddgfab.linkages.mechanism import Mechanism, Pose, bar_lengths, signed_twists
from ddgfab.linkages.mobility import mobility
from ddgfab.mesh import Floats, Ints

FOLD_SAMPLES = 721
"""Driving angles at which folded isograms are looked for."""

BISECTIONS = 50
"""Halvings that place a dead point."""


def isogram_angles(points: Floats, axes: Floats, cells: Ints) -> Floats:
    """(..., F) oriented angle at the first hinge of every isogram [rad], in (-pi, pi]."""
    corner, ahead, behind = (points[..., cells[:, k], :] for k in (0, 1, 3))
    a, b = ahead - corner, behind - corner
    sine = np.einsum("...i,...i->...", axes[..., cells[:, 0], :], np.cross(a, b))
    return np.arctan2(sine, np.einsum("...i,...i->...", a, b))


def dead_points(
    lattice: Lattice, cells: Ints, limits: tuple[float, float]
) -> tuple[tuple[float, str], ...]:
    """Driving angles inside or at the limits at which isograms are collinear, and their names.

    Sign changes of the sine of the angle at the first hinge, by samples and bisection.
    """
    ts = np.linspace(*limits, FOLD_SAMPLES)

    def sines(angles: Floats) -> Floats:
        points, axes = lattice.place(angles)
        return np.sin(isogram_angles(points, axes, cells))

    values = sines(ts)
    at, which = np.nonzero(values[:-1] * values[1:] <= 0)
    low, high, sign = ts[at], ts[at + 1], np.sign(values[at, which])
    pick = np.arange(len(at))
    for _ in range(BISECTIONS if len(at) else 0):
        middle = (low + high) / 2
        same = sines(middle)[pick, which] * sign > 0
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    found: dict[float, list[int]] = {}
    for t, cell in sorted(zip((low + high) / 2, which, strict=True)):
        near = [key for key in found if abs(key - t) < 1e-6]
        cells_here = found.setdefault(near[0] if near else float(t), [])
        if int(cell) not in cells_here:
            cells_here.append(int(cell))
    return tuple((t, _fold_name(ids, len(cells))) for t, ids in found.items())


def _fold_name(ids: list[int], total: int) -> str:
    if len(ids) == total:
        return "all bars in one line" if total > 1 else "the four bars in one line"
    words = ", ".join(map(str, sorted(ids)[:4])) + (", ..." if len(ids) > 4 else "")
    return f"isogram{'s' if len(ids) > 1 else ''} {words} folded"


def assemble(
    kind: str,
    lattice: Lattice,
    grid: Grid,
    *,
    limits: tuple[float, float],
    driver: str,
    path: str,
) -> Mechanism:
    """The mechanism of a lattice: what is derived of its design pose is derived here."""
    points, axes = lattice.place(np.array([lattice.design]))
    pose = Pose(points[0], axes[0])
    return Mechanism(
        kind,
        grid.bars,
        bar_lengths(pose, grid.bars),
        signed_twists(pose, grid.bars),
        grid.strips,
        grid.directions,
        grid.cells,
        mobility(grid.bars, pose),
        driver,
        limits,
        lattice.design,
        dead_points(lattice, grid.cells, limits),
        path,
        lattice,
    )

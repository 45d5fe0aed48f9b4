"""From a drive to a `Mechanism`: lengths, twists, mobility and dead points of what moves."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ddgfab.linkages.grid import Grid
from ddgfab.linkages.instant_mobility import mobility
from ddgfab.linkages.mechanism import Drive, Mechanism, Pose, bar_lengths, signed_twists
from ddgfab.mesh import Floats, Ints
from ddgfab.nets.knet.oriented import oriented_angle

FOLD_SAMPLES = 361
"""Driving angles at which folded isograms are looked for."""

SECANTS = 10
"""Steps that place a dead point between two samples."""

SAME_ANGLE = 1e-6
"""Dead points closer than this [rad] are one."""


def isogram_angles(points: Floats, axes: Floats, cells: Ints) -> Floats:
    """(..., F) oriented angle at the first hinge of every isogram [rad], in (-pi, pi]."""
    corner, ahead, behind = (points[..., cells[:, k], :] for k in (0, 1, 3))
    return oriented_angle(axes[..., cells[:, 0], :], ahead - corner, behind - corner)


def crossings(
    values: Callable[[Floats], Floats], limits: tuple[float, float]
) -> tuple[tuple[float, tuple[int, ...]], ...]:
    """Where columns of `values`, (T, F) of (T,) angles, change sign: the angle, which columns.

    By samples and secants: two crossings between samples are missed.
    """
    ts = np.linspace(*limits, FOLD_SAMPLES)
    sampled = values(ts)
    at, which = np.nonzero(sampled[:-1] * sampled[1:] <= 0)
    low, high = ts[at], ts[at + 1]
    f_low, f_high = sampled[at, which], sampled[at + 1, which]
    pick, moved, root = np.arange(len(at)), np.zeros(len(at)), low
    for _ in range(SECANTS if len(at) else 0):
        gap = np.where(f_high == f_low, 1.0, f_high - f_low)
        root = np.where(f_high == f_low, low, low - f_low * (high - low) / gap)
        f_root = values(root)[pick, which]
        keeps = f_root * f_low > 0
        # The Illinois rule: an end that stays twice counts half, so that both close in.
        f_high = np.where(keeps, np.where(moved > 0, f_high / 2, f_high), f_root)
        f_low = np.where(keeps, f_root, np.where(moved < 0, f_low / 2, f_low))
        low, high, moved = (
            np.where(keeps, root, low),
            np.where(keeps, high, root),
            np.where(keeps, 1, -1),
        )
    found: list[tuple[float, set[int]]] = []
    for t, column in sorted(zip(root, which, strict=True)):
        if not found or t - found[-1][0] > SAME_ANGLE:
            found.append((float(t), set()))
        found[-1][1].add(int(column))
    return tuple((t, tuple(sorted(columns))) for t, columns in found)


def dead_points(
    drive: Drive, cells: Ints, limits: tuple[float, float]
) -> tuple[tuple[float, str], ...]:
    """Driving angles at which isograms are folded (their bars in one line), and which."""

    def sines(ts: Floats) -> Floats:
        points, axes = drive.place(ts)
        return np.sin(isogram_angles(points, axes, cells))

    return tuple((t, _fold_words(ids, len(cells))) for t, ids in crossings(sines, limits))


def _fold_words(ids: tuple[int, ...], total: int) -> str:
    if len(ids) == total:
        return "all bars in one line" if total > 1 else "the four bars in one line"
    words = ", ".join(map(str, ids[:4])) + (", ..." if len(ids) > 4 else "")
    return f"isogram{'s' if len(ids) > 1 else ''} {words} folded"


def assemble(
    kind: str,
    drive: Drive,
    grid: Grid,
    *,
    design: float,
    limits: tuple[float, float],
    driver: str,
    path: str,
    extra: tuple[tuple[float, str], ...] = (),
) -> Mechanism:
    """The mechanism of a drive: what follows from its design pose is derived here.

    `extra` are dead points beside the folded isograms.
    """
    points, axes = drive.place(np.array([design]))
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
        design,
        tuple(sorted((*dead_points(drive, grid.cells, limits), *extra))),
        path,
        drive,
    )

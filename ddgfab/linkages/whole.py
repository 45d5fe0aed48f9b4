"""Whole K-nets as mechanisms: m x n Bennett isograms, m + n - 1 degrees of freedom, one path.

Source: mathematics.md 3.5, 4.3, 4.4, 11.
"""

from __future__ import annotations

from typing import Literal, TypeAlias

import numpy as np

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError
from ddgfab.linkages.assemble import assemble
from ddgfab.linkages.grid import Grid
from ddgfab.linkages.lattice import Lattice
from ddgfab.linkages.mechanism import Mechanism
from ddgfab.mesh import Floats
from ddgfab.nets.knet.net import KNet
from ddgfab.nets.knet.oriented import oriented_angle

Path: TypeAlias = Literal["locked", "fold"] | tuple[tuple[Floats, Floats], float]
"""How the Cauchy data follow: by name, or ((turn rates 0, turn rates 1), corner rate)."""


@checked
def knet_mechanism(
    knet: KNet,
    *,
    scale_mm: float = 1.0,
    anchor: tuple[int, int] | None = None,
    path: Path = "locked",
) -> Mechanism:
    """Linkage of a K-net with m x n cells: hinge (i, j) has id i (n + 1) + j.

    Bars of direction 0 come first. The driving angle is the angle at the anchor hinge from its bar
    of direction 0 to its bar of direction 1; the other m + n - 2 degrees of freedom are the turns
    of the two lines of bars through the anchor.

    Parameters
    ----------
    knet : a K-net in two directions
    scale_mm : mm per unit of its points
    anchor : the hinge (i, j) of the driving angle, i < m, j < n; by default the one in the middle,
        from which errors and ranges spread least
    path : "locked" keeps all turns; "fold" shrinks turns and driving angle in proportion, towards
        the bundle in which all bars lie in one line; or rates of the turns of both lines and of the
        corner

    Raises
    ------
    InputError
        A net of other than two directions, a scale that is not positive, an anchor outside, rates
        of the wrong sizes or with a corner rate of zero.
    DegenerateError
        A folded isogram in the design pose: mobility is singular there.

    Source: mathematics.md 4.3, 4.4.
    """
    if knet.d != 2:
        raise InputError(f"{knet!r} has {knet.d} directions; a linkage of a net needs two")
    if not 0 < scale_mm < np.inf:
        raise InputError(f"scale_mm = {scale_mm:g}: millimetres per unit are positive")
    m, n = (count - 1 for count in knet.shape)
    where = ((m - 1) // 2, (n - 1) // 2) if anchor is None else (int(anchor[0]), int(anchor[1]))
    if not (0 <= where[0] < m and 0 <= where[1] < n):
        raise InputError(
            f"anchor {where}: the driving angle is that of a cell; indices are below {m}, {n}"
        )
    turns, corner = line_angles(knet, where)
    turn_rates, corner_rate, words = _rates(path, turns, corner)
    lattice = Lattice(
        tuple(np.asarray(delta) for delta in knet.deltas),
        turns,
        np.array([corner]),
        knet.r * scale_mm,
        where,
        corner,
        turn_rates,
        np.array([corner_rate]),
    )
    if not abs(np.sin(corner)) > 0:
        raise DegenerateError(f"isogram {where} is folded in the design pose", cell=where)
    grid = Grid.build(knet.shape)
    hinge = where[0] * (n + 1) + where[1]
    bar = [
        int(np.flatnonzero((grid.bars[:, 0] == hinge) & (grid.directions == k))[0]) for k in (0, 1)
    ]
    limits = (0.0, np.pi) if corner > 0 else (-np.pi, 0.0)
    return assemble(
        "knet",
        lattice,
        grid,
        design=lattice.design,
        limits=limits,
        driver=f"angle at hinge {hinge} from bar {bar[0]} to bar {bar[1]}",
        path=words,
    )


def line_angles(knet: KNet, anchor: tuple[int, int]) -> tuple[tuple[Floats, Floats], float]:
    """Turns of the lines through a vertex (arrays (m - 1,), (n - 1,)) and the angle there [rad]."""
    i, j = anchor
    turns = []
    for points, normals in (
        (knet.points[:, j], knet.normals[:, j]),
        (knet.points[i], knet.normals[i]),
    ):
        edges = np.diff(points, axis=0)
        turns.append(oriented_angle(normals[1:-1], edges[:-1], edges[1:]))
    x = knet.points
    corner = oriented_angle(knet.normals[i, j], x[i + 1, j] - x[i, j], x[i, j + 1] - x[i, j])
    return (turns[0], turns[1]), float(corner)


def _rates(
    path: Path, turns: tuple[Floats, Floats], corner: float
) -> tuple[tuple[Floats, Floats], float, str]:
    """Rates of turns and corner by the driving angle, and a description of them."""
    if path == "locked":
        held = (np.zeros(len(turns[0])), np.zeros(len(turns[1])))
        return held, 1.0, "the bars of either line through the anchor are locked to each other"
    if path == "fold":
        fold = (turns[0] / corner, turns[1] / corner)
        return fold, 1.0, "all turns along the lines through the anchor shrink with the driver"
    if isinstance(path, str):
        raise InputError(f"path {path!r}: there are 'locked' and 'fold', and rates as arrays")
    (first, second), rate = path
    given = (np.asarray(first, dtype=np.float64), np.asarray(second, dtype=np.float64))
    for k, (have, want) in enumerate(zip(given, turns, strict=True)):
        if have.shape != want.shape:
            raise InputError(f"turn rates of line {k} have shape {have.shape}, not {want.shape}")
    if not (np.isfinite(rate) and rate != 0):
        raise InputError(f"corner rate {rate}: the driving angle must move")
    return (given[0] / rate, given[1] / rate), 1.0, "turns follow the driver at the given rates"

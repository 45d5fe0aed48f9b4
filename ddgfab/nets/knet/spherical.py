"""Spherical T-nets: unit normals of K-nets by half-turns, along wavefronts, in any dimension.

m_ij = m - 2 <m, d> / <d, d> d with d = m_j - m_i is the Moutard equation for unit vectors. It is
a reflection of m, so norms do not drift; the textbook form -n + lambda (n_1 + n_2) multiplies
errors of the norm by 5.6 at every step and is not used. Source: mathematics.md 3.4, 3.5, 11b.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.mesh import Floats
from ddgfab.quads import Place, columns, cross, dot, finite, norm
from ddgfab.tolerances import RELATIVE_DEGENERATE, UNIT_NORMAL


@checked
def spherical_fourth(m: ArrayLike, m_i: ArrayLike, m_j: ArrayLike) -> Floats:
    """(..., 3) unit vector m_ij that closes a quad of a spherical T-net.

    The vectors are the normals of a K-net in the gauge of all directions alike, Delta_k x =
    r m_k x m. With n = m, n_1 = -m_i, n_2 = m_j (and n_12 = -m_ij) it is the half-turn of n about
    n_1 + n_2.

    Parameters
    ----------
    m, m_i, m_j : (..., 3) unit vectors

    Raises
    ------
    InputError
        A vector that is not of unit length; names it, its index and length.
    DegenerateError
        m_i = m_j, that is n_1 = -n_2 (no unique answer), or m_i = +-m (an edge of no length);
        names the index of the quad.

    Source: mathematics.md 3.4.
    """
    base, *ends = columns(m, m_i, m_j)
    if len(base) != 3:
        raise InputError(f"unit vectors (..., 3) are needed; these have {len(base)} coordinates")
    for name, corner in zip(("m", "m_i", "m_j"), (base, *ends), strict=True):
        refuse_not_unit(np.moveaxis(corner, 0, -1), name)
    place = Place()
    for name, end in zip(("m_i", "m_j"), ends, strict=True):
        sine = norm(cross(base, end))
        place.refuse(
            sine <= RELATIVE_DEGENERATE,
            f"m and {name} are parallel, the edge has no length: sine of their angle, "
            f"limit {RELATIVE_DEGENERATE:g}",
            sine,
        )
    return np.moveaxis(reflect_rule(base, ends[0], ends[1], place), 0, -1)


def refuse_not_unit(vectors: Floats, what: str) -> None:
    """Raise `InputError` at the first vector (..., 3) whose length is not one."""
    length = np.sqrt(np.einsum("...i,...i->...", vectors, vectors))
    bad = np.argwhere(~(np.abs(length - 1.0) <= UNIT_NORMAL))
    if len(bad):
        at = tuple(bad[0].tolist())
        raise InputError(
            f"{what} {at} has length {length[at]:.12g}; unit vectors are needed "
            f"(limit {UNIT_NORMAL:g})"
        )


def reflect_rule(m: Floats, m_i: Floats, m_j: Floats, place: Place) -> Floats:
    """`spherical_fourth` with components first and without checks of the input."""
    d = m_j - m_i
    square = dot(d, d)
    flat = square <= RELATIVE_DEGENERATE**2
    if flat.any():
        place.refuse(
            flat,
            f"m_1 = m_2, that is n_1 = -n_2: the quad does not determine its fourth normal; "
            f"|n_1 + n_2|, limit {RELATIVE_DEGENERATE:g}",
            np.sqrt(square),
        )
    return np.asarray(m - (2.0 * dot(m, d) / square) * d)


@checked
def evolve_spherical(axes: Sequence[ArrayLike], *, name: str = "cell") -> Floats:
    """(n1, ..., nd, 3) spherical T-net from unit vectors along its d > 1 axes.

    Points with two nonzero indices are made along wavefronts of their coordinate surface, those
    with more from the surfaces of their first two nonzero directions, all layers of the others at
    once. 3D consistency says that any other pair would give the same.

    Parameters
    ----------
    axes : d arrays (n_k, 3) of unit vectors with a common first one
    name : what errors call a cell

    Raises
    ------
    InputError
        Fewer than two axes, wrong shapes, vectors that are not of unit length, axes that do not
        start with one vector; names the axis and index.
    DegenerateError
        m_i = m_j somewhere (n_1 = -n_2); names the cell.

    Source: mathematics.md 3.4, 3.5; Bobenko, Suris, Discrete Differential Geometry, 4.1, 4.2.
    """
    lines = _axes(axes)
    d = len(lines)
    sizes = [len(line) for line in lines]
    m = np.empty((*sizes, 3))
    for k, line in enumerate(lines):
        m[tuple(slice(None) if axis == k else 0 for axis in range(d))] = line
    for size in range(2, d + 1):
        for subset in combinations(range(d), size):
            if min(sizes[k] for k in subset) > 1:
                _fill(m, subset, name)
    return m


def _axes(axes: Sequence[ArrayLike]) -> list[Floats]:
    lines = [np.asarray(axis, dtype=np.float64) for axis in axes]
    if len(lines) < 2:
        raise InputError(f"{len(lines)} axes: a net needs two directions at least")
    for k, line in enumerate(lines):
        if line.ndim != 2 or line.shape[1] != 3 or not len(line):
            raise InputError(f"axis {k} has shape {line.shape}; (n, 3) is needed")
        finite(line, f"axis {k}")
        refuse_not_unit(line, f"axis {k}, vector")
        gap = float(np.abs(line[0] - lines[0][0]).max())
        if gap > UNIT_NORMAL:
            raise InputError(f"axes 0 and {k} start {gap:g} apart; they must share their first one")
    return lines


def _fill(m: Floats, subset: tuple[int, ...], name: str) -> None:
    """Points whose nonzero directions are those of a subset of two or more."""
    d = m.ndim - 1
    first, second = subset[:2]
    others = tuple(slice(1, None) if k in subset else slice(0, 1) for k in range(d))
    part = m[tuple(slice(None) if k in (first, second) else others[k] for k in range(d))]
    rest = [k for k in range(d) if k not in (first, second)]
    rows, cols = m.shape[first], m.shape[second]
    order = [d, first, second, *rest]
    # Components first, the two directions flattened so that an anti-diagonal is a plain slice, the
    # layers of the other directions last.
    moved = part.transpose(order)
    batch = moved.shape[3:]
    grid = np.ascontiguousarray(moved).reshape(3, rows * cols, -1)
    step = cols - 1
    for s in range(2, rows + cols - 1):
        low = max(1, s - cols + 1)
        count = min(rows - 1, s - 1) - low + 1

        def diagonal(back: int, start: int = low * step + s, count: int = count) -> slice:
            return slice(start - back, start - back + (count - 1) * step + 1, step or 1)

        def cell(index: tuple[int, ...], low: int = low, s: int = s) -> tuple[int, ...]:
            at = dict(zip(rest, np.unravel_index(index[1], batch), strict=True)) if batch else {}
            full = {k: int(v) + (k in subset) for k, v in at.items()}
            full[first], full[second] = low - 1 + index[0], s - low - 1 - index[0]
            return tuple(full[k] for k in range(d))

        m_0, m_i, m_j = (grid[:, diagonal(back)] for back in (cols + 1, 1, cols))
        # One step back in the second direction is u - e_j = m_i, and in the first m_j.
        grid[:, diagonal(0)] = reflect_rule(m_0, m_i, m_j, Place(cell, name))
    moved[...] = grid.reshape(moved.shape)

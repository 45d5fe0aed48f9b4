"""K-nets for many values of a parameter at once, from an anchor inside them; analytic in it.

The same half-turn evolution as `ddgfab.nets.knet.spherical`, with a leading axis over poses, Cauchy
data on the two (or three) coordinate lines through any vertex, and no operation that is not
analytic: complex parameters give exact derivatives (complex step). Source: mathematics.md 3.4, 3.5.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ddgfab.errors import DegenerateError
from ddgfab.tolerances import RELATIVE_DEGENERATE

Numbers: TypeAlias = NDArray[Any]
"""Real or complex arrays."""


def dots(a: Numbers, b: Numbers) -> Numbers:
    """(..., 1) bilinear products over the last axis, also of complex vectors."""
    return np.asarray(np.einsum("...i,...i->...", a, b)[..., None])


def walk(n: Numbers, edge: Numbers, deltas: Numbers, turns: Numbers, sign: float) -> Numbers:
    """(k + 1, T, 3) normals along a line from its first normal and edge direction.

    Parameters
    ----------
    n, edge : (T, 3) orthonormal
    deltas : (k,) angles of consecutive normals [rad]
    turns : (k - 1, T) deviations of consecutive edges about the normal between them [rad]
    sign : +1 for edges along n x n' (direction 0), -1 for the opposite (the others)
    """
    out = [n]
    tangent = sign * np.cross(edge, n)
    for i, delta in enumerate(deltas):
        c, s = np.cos(delta), np.sin(delta)
        n, tangent = c * n + s * tangent, c * tangent - s * n
        out.append(n)
        if i < len(turns):
            c, s = np.cos(turns[i])[:, None], np.sin(turns[i])[:, None]
            tangent = c * tangent + s * np.cross(n, tangent)
    return np.stack(out)


def line(
    n: Numbers, edge: Numbers, deltas: Numbers, turns: Numbers, anchor: int, sign: float
) -> Numbers:
    """(k + 1, T, 3) normals of a whole line from one of them and the edge that leaves it there.

    The normal given is that at vertex `anchor`, which is not the last one.
    """
    ahead = walk(n, edge, deltas[anchor:], turns[anchor:], sign)
    if not anchor:
        return ahead
    c, s = np.cos(turns[anchor - 1])[:, None], np.sin(turns[anchor - 1])[:, None]
    back = -c * edge + s * np.cross(n, edge)
    behind = walk(n, back, deltas[:anchor][::-1], -turns[: anchor - 1][::-1], sign)
    return np.concatenate([behind[:0:-1], ahead])


def evolve(lines: Sequence[Numbers], anchor: Sequence[int]) -> Numbers:
    """(n1, ..., nd, T, 3) Lelieuvre field m from its lines (n_k, T, 3) through the anchor.

    Quads are filled by m_ij - m parallel to m_j - m_i, which is the same rule in all quadrants.

    Raises
    ------
    DegenerateError
        m_i = m_j (n_1 = -n_2): the quad does not determine its fourth normal; names the cell.
    """
    d = len(lines)
    sizes = [len(values) for values in lines]
    m = np.empty((*sizes, *lines[0].shape[1:]), dtype=np.result_type(*lines))
    for k, values in enumerate(lines):
        m[tuple(slice(None) if a == k else anchor[a] for a in range(d))] = values
    for ways in product((1, -1), repeat=d):
        quadrant = tuple(
            slice(a, None) if way > 0 else slice(a, None, -1)
            for a, way in zip(anchor, ways, strict=True)
        )
        _fill(m[quadrant], d, anchor, ways)
    return m


def _fill(m: Numbers, d: int, anchor: Sequence[int], ways: tuple[int, ...]) -> None:
    """Points of one quadrant with two or more nonzero indices, along wavefronts."""
    index = np.indices(m.shape[:d]).reshape(d, -1)
    total, inner = index.sum(axis=0), (index > 0).sum(axis=0) > 1
    for s in range(2, int(total.max()) + 1):
        front = index[:, (total == s) & inner]
        if not front.size:
            continue
        # The first two nonzero directions of each point.
        first = (front > 0).argmax(axis=0)
        rest = front > 0
        rest[first, np.arange(front.shape[1])] = False
        i, j = (
            np.eye(d, dtype=np.int64)[:, first],
            np.eye(d, dtype=np.int64)[:, rest.argmax(axis=0)],
        )
        low, m_i, m_j = (m[tuple(front - back)] for back in (i + j, j, i))
        across = m_j - m_i
        square = dots(across, across)
        flat = np.abs(square) <= RELATIVE_DEGENERATE**2
        if flat.any():
            at = front[:, np.argwhere(flat)[0, 0]] - 1
            cell = tuple(int(a + w * v) for a, w, v in zip(anchor, ways, at, strict=True))
            raise DegenerateError(
                f"isogram {cell}: n_1 = -n_2, so its bars do not determine the fourth hinge",
                cell=cell,
            )
        m[tuple(front)] = low - (2.0 * dots(low, across) / square) * across


def points_of(m: Numbers, r: float, anchor: Sequence[int]) -> Numbers:
    """(n1, ..., nd, T, 3) points with Delta_k x = r m_k x m, the anchor at the origin."""
    d = len(anchor)
    x = np.zeros_like(m)
    for k in range(d):
        layer = tuple(slice(None) if a <= k else slice(anchor[a], anchor[a] + 1) for a in range(d))
        part = np.moveaxis(m[layer], k, 0)
        edges = r * np.cross(part[1:], part[:-1])
        sums = np.concatenate([np.zeros_like(part[:1]), np.cumsum(edges, axis=0)])
        sums = sums - sums[anchor[k]]
        start = tuple(slice(None) if a < k else slice(anchor[a], anchor[a] + 1) for a in range(d))
        x[layer] = np.moveaxis(sums, 0, k) + x[start]
    return x

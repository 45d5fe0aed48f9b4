"""T-nets (Moutard nets): m_kl - m = a_kl (m_l - m_k), with a_lk = -a_kl; in any dimension.

Coefficients of the three quads of a cube at one corner give those at the opposite corner by the
star-triangle map; so T-nets evolve from their coordinate surfaces, consistently in 3D and 4D.
Source: Bobenko, Suris, Discrete Differential Geometry, 2.3; mathematics.md 3.2, 3.3.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked, together
from ddgfab.errors import InputError
from ddgfab.mesh import Floats, Ints
from ddgfab.quads import (
    Place,
    columns,
    dot,
    finite,
    measure,
    net_points,
    norm,
    refuse_growth,
    sweep,
)
from ddgfab.tolerances import NET_INPUT, RELATIVE_DEGENERATE


# --- quads ---------------------------------------------------------------------------------------
@checked
def moutard_coefficients(field: ArrayLike, axes: tuple[int, int] = (0, 1)) -> tuple[Floats, Floats]:
    """Coefficients a_kl of the quads of two directions, and how much they miss the equation.

    Parameters
    ----------
    field : (n1, ..., nd, dim)
    axes : directions k, l

    Returns
    -------
    a : a_kl by least squares, shaped as the base points of the quads
    gap : |m_kl - m - a (m_l - m_k)| / (|m_kl - m| + |m_l - m_k|); 0 on T-nets

    Raises
    ------
    DegenerateError
        m_k = m_l: the quad has no coefficient; names it.
    """
    both = measure(field, axes, _coefficient)
    return both[..., 0], both[..., 1]


def _coefficient(m: Floats, m_k: Floats, m_l: Floats, m_kl: Floats, place: Place) -> Floats:
    """a and the relative gap, stacked first."""
    long, short = m_kl - m, m_l - m_k
    square = dot(short, short)
    size = dot(m, m) + dot(m_kl, m_kl)
    place.refuse(
        square <= RELATIVE_DEGENERATE**2 * size,
        f"m_k = m_l, there is no coefficient: their relative distance, limit "
        f"{RELATIVE_DEGENERATE:g}",
        np.sqrt(square / np.where(size > 0, size, 1.0)),
    )
    a = dot(long, short) / square
    return np.stack([a, norm(long - a * short) / (norm(long) + np.sqrt(square))])


@checked
def evolve_moutard(first: ArrayLike, second: ArrayLike, coefficients: ArrayLike) -> Floats:
    """(M + 1, N + 1, dim) T-net from two polylines and the coefficients a_12 of its quads.

    Parameters
    ----------
    first, second : (M + 1, dim), (N + 1, dim) in directions 0 and 1 from one point
    coefficients : (M, N) a_12, or a number

    Raises
    ------
    InputError
        Shapes that do not fit, first points that differ, entries that are not finite.

    Source: mathematics.md 3.2.
    """

    def rule(m: Floats, m_k: Floats, m_l: Floats, a: Floats, place: Place) -> Floats:
        return np.asarray(m + a * (m_l - m_k))

    return sweep(first, second, (coefficients,), rule)


# --- cubes ---------------------------------------------------------------------------------------
@checked
def star_triangle(a12: ArrayLike, a23: ArrayLike, a31: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """Coefficients (tau_3 a_12, tau_1 a_23, tau_2 a_31) of the quads opposite to three at a corner.

    tau_i a_jk = -a_jk / (a_12 a_23 + a_23 a_31 + a_31 a_12); an involution. Arrays are
    broadcast.

    Raises
    ------
    DegenerateError
        The denominator is zero; names the index of the cube.

    Source: mathematics.md 3.3.
    """
    given = together(a12=a12, a23=a23, a31=a31)
    for a in given:
        finite(a, "coefficients")
    p, q, s = given
    return _star_triangle(p, q, s, Place(name="cube"))


def _star_triangle(p: Floats, q: Floats, s: Floats, place: Place) -> tuple[Floats, Floats, Floats]:
    below = p * q + q * s + s * p
    size = np.abs(p * q) + np.abs(q * s) + np.abs(s * p)
    place.refuse(
        np.abs(below) <= RELATIVE_DEGENERATE * size,
        f"a_12 a_23 + a_23 a_31 + a_31 a_12 is zero, relative to its terms (limit "
        f"{RELATIVE_DEGENERATE:g})",
        below,
    )
    return -p / below, -q / below, -s / below


@checked
def moutard_cube(
    m: ArrayLike, m1: ArrayLike, m2: ArrayLike, m3: ArrayLike, m12: ArrayLike, m13: ArrayLike,
    m23: ArrayLike,
) -> Floats:  # fmt: skip
    """(..., dim) eighth vertex m_123 of a cube of a T-net; (..., dim) seven others.

    Raises
    ------
    DegenerateError
        A quad that misses the Moutard equation, m_k = m_l, or no star-triangle map; names the
        cube.

    Source: mathematics.md 3.3.
    """
    return np.moveaxis(_cube(columns(m, m1, m2, m3, m12, m13, m23), Place(name="cube")), 0, -1)


def _cube(corners: tuple[Floats, ...], place: Place) -> Floats:
    """`moutard_cube` with components first."""
    m, m1, m2, m3, m12, m13, m23 = corners
    a = []
    for name, k, other, both in (("12", m1, m2, m12), ("23", m2, m3, m23), ("31", m3, m1, m13)):
        value, gap = _coefficient(m, k, other, both, place)
        place.refuse(
            gap > NET_INPUT,
            f"quad {name} misses the Moutard equation, relative (limit {NET_INPUT:g})",
            gap,
        )
        a.append(value)
    shifted = _star_triangle(a[0], a[1], a[2], place)
    return np.asarray(m1 + shifted[1] * (m13 - m12))


@checked
def evolve_tnet(surfaces: Mapping[tuple[int, int], ArrayLike], *, verify: bool = False) -> Floats:
    """(n1, ..., nd, dim) T-net from its d (d - 1) / 2 coordinate surfaces, d > 2.

    Points are made from the cube of their first three nonzero directions: no other cube would
    give another point (4D consistency).

    Parameters
    ----------
    surfaces : by pairs (k, l), k < l < d: (n_k, n_l, dim) T-nets with common axes
    verify : whether to compare every point with those from the further two faces of its cube and,
        beyond three directions, from the cube of its last three

    Raises
    ------
    InputError
        A missing surface, shapes that do not fit, surfaces with different axes.
    DegenerateError
        A surface that is not a T-net, m_k = m_l, no star-triangle map; with `verify` a second point
        elsewhere. Names the cell.

    Source: mathematics.md 3.3; Bobenko, Suris, Discrete Differential Geometry, 2.3.
    """
    net = _with_surfaces(surfaces)
    d = net.ndim - 1
    strides = [int(np.prod(net.shape[k + 1 : -1])) for k in range(d)]
    flat = net.reshape(-1, net.shape[-1])
    for size in range(3, d + 1):
        for subset in combinations(range(d), size):
            for at in _fronts(net.shape[:-1], subset):

                def cell(index: tuple[int, ...], at: Ints = at) -> tuple[int, ...]:
                    where = np.unravel_index(int(at[index[0]]), net.shape[:-1])
                    return tuple(int(i) for i in where)

                place = Place(cell, "cube below point")
                with np.errstate(over="ignore", invalid="ignore"):
                    new = _cube(_corners(flat, at, [strides[k] for k in subset[:3]]), place)
                refuse_growth(new, place)
                flat[at] = new.T
                if verify:
                    _verify(flat, at, [strides[k] for k in subset], place)
    return net


def _fronts(sizes: tuple[int, ...], subset: tuple[int, ...]) -> Iterator[Ints]:
    """Flat indices of the points whose nonzero indices are those of a subset, front by front."""
    if min(sizes[k] for k in subset) < 2:
        return
    index = np.indices([sizes[k] - 1 for k in subset]).reshape(len(subset), -1) + 1
    full = np.zeros((len(sizes), index.shape[1]), dtype=np.int64)
    full[list(subset)] = index
    flat = np.asarray(np.ravel_multi_index(tuple(full), sizes))
    level = index.sum(axis=0)
    order = np.argsort(level, kind="stable")
    yield from np.split(flat[order], np.flatnonzero(np.diff(level[order])) + 1)


def _corners(flat: Floats, at: Ints, strides: list[int]) -> tuple[Floats, ...]:
    """m, m1, m2, m3, m12, m13, m23 of the cubes below points, components first."""
    p, q, s = strides
    back = (p + q + s, q + s, p + s, p + q, s, q, p)
    return tuple(flat[at - b].T for b in back)


def _verify(flat: Floats, at: Ints, strides: list[int], place: Place) -> None:
    """Every point again, from the cube of its last three directions and its three faces."""
    m, m1, m2, m3, m12, m13, m23 = _corners(flat, at, strides[-3:])
    new = flat[at].T
    for turned in (
        (m, m1, m2, m3, m12, m13, m23),
        (m, m2, m3, m1, m23, m12, m13),
        (m, m3, m1, m2, m13, m23, m12),
    ):
        other = _cube(turned, place)
        gap = norm(other - new) / (norm(new) + norm(other))
        place.refuse(
            gap > NET_INPUT,
            f"another cube or face gives another point, relative distance (limit {NET_INPUT:g})",
            gap,
        )


def _with_surfaces(surfaces: Mapping[tuple[int, int], ArrayLike]) -> Floats:
    """Checked net with its coordinate surfaces filled, the rest not yet."""
    d = 1 + max((max(pair) for pair in surfaces), default=0)
    wanted = list(combinations(range(d), 2))
    if d < 3 or sorted(surfaces) != wanted:
        raise InputError(f"surfaces {sorted(surfaces)} do not make a net: {wanted} are needed")
    given = {pair: net_points(surfaces[pair]) for pair in wanted}
    sizes = [given[0, k].shape[1] if k else given[0, 1].shape[0] for k in range(d)]
    dim = given[0, 1].shape[-1]
    net = np.full((*sizes, dim), np.nan)
    for (k, m), surface in given.items():
        if surface.shape != (sizes[k], sizes[m], dim):
            raise InputError(
                f"surface {(k, m)} has shape {surface.shape}; {(sizes[k], sizes[m], dim)} is needed"
            )
        if min(sizes[k], sizes[m]) > 1:
            gap = moutard_coefficients(surface)[1]
            Place(name=f"surface {(k, m)}, quad").refuse(
                gap > NET_INPUT, f"it misses the Moutard equation (limit {NET_INPUT:g})", gap
            )
        box = tuple(slice(None) if axis in (k, m) else 0 for axis in range(d))
        before = net[box]
        apart = np.abs(np.where(np.isnan(before), surface, before) - surface).max()
        if apart > RELATIVE_DEGENERATE * np.abs(surface).max():
            raise InputError(
                f"surface {(k, m)} and one before it differ on a common axis: {apart:g}"
            )
        net[box] = surface
    return net

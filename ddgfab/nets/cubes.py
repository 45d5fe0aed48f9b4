"""Cubes of conjugate nets: the eighth vertex, the map of coefficients, evolution in d directions.

Coefficients of a cube are matrices C with C[l, k] = c^lk (0-based): the second index is the
direction that is multiplied, the diagonal is not used. With M_kl = c^lk / (1 + c^kl) and
xi = (I - M)^-1 (1, 1, 1) the eighth vertex is x_123 = x + sum xi_k Delta_k x, in any dimension.
Source: Bobenko, Suris, Discrete Differential Geometry, 2.1, Lemma 2.4, Theorem 2.5; mathematics.md
1.6-1.8.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats, Ints, extent
from ddgfab.nets.conjugate import coeffs_kernel, conj_residual, planarity
from ddgfab.quads import Place, columns, finite, net_points, norm, refuse_growth
from ddgfab.tolerances import CONDITION_LIMIT, NET_INPUT, RELATIVE_DEGENERATE

_SIDES = ((0, 1), (0, 2), (1, 2))
_IDENTITY = np.eye(3)


# --- coefficients --------------------------------------------------------------------------------
@checked
def cube_xi(coefficients: ArrayLike) -> Floats:
    """(..., 3) xi of cubes: x_123 = x + sum xi_k (x_k - x).

    Parameters
    ----------
    coefficients : (..., 3, 3), C[l, k] = c^lk of the three quads at x

    Raises
    ------
    DegenerateError
        1 + c^kl = 0 (an edge of a quad is parallel to one at x), planes nearly parallel (condition
        of I - M); names the index of the cube.

    Source: mathematics.md 1.6.
    """
    return _xi(_matrices(coefficients), Place(name="cube"))


def _matrices(coefficients: ArrayLike) -> Floats:
    c = np.asarray(coefficients, dtype=np.float64)
    if c.ndim < 2 or c.shape[-2:] != (3, 3):
        raise InputError(f"coefficients of cubes have shape (..., 3, 3); these {c.shape}")
    c = np.where(_IDENTITY > 0, 0.0, c)
    finite(c, "coefficients")
    return c


def _xi(c: Floats, place: Place) -> Floats:
    below = 1.0 + c  # below[k, l] = 1 + c^kl
    small = np.abs(below) <= RELATIVE_DEGENERATE * np.maximum(1.0, np.abs(c))
    place.refuse(
        np.asarray(small.any(axis=(-2, -1))),
        "1 + c = 0: an edge is parallel to one of the opposite direction",
    )
    system = _IDENTITY - np.swapaxes(c, -1, -2) / below  # M[k, l] = c^lk / (1 + c^kl)
    condition = np.linalg.cond(system)
    place.refuse(
        ~(condition <= CONDITION_LIMIT),
        f"the planes of the three further faces are nearly parallel: condition of I - M, limit "
        f"{CONDITION_LIMIT:g}",
        condition,
    )
    return np.asarray(np.linalg.solve(system, np.ones((*c.shape[:-1], 1)))[..., 0])


@checked
def phi(coefficients: ArrayLike) -> Floats:
    """Coefficients of the three quads of a cube opposite to those at x (Lemma 2.4).

    c_i^lk = xi_k / (1 + c^ik) - 1 for the quad of directions k, l at x_i. Birational; inverse
    `phi_inverse`.

    Parameters
    ----------
    coefficients : (..., 3, 3), C[l, k] = c^lk at x

    Returns
    -------
    (..., 3, 3) with [l, k] = c_i^lk at x_i, i the third direction; diagonal zero

    Raises
    ------
    DegenerateError
        As `cube_xi`.

    Source: mathematics.md 1.7.
    """
    c = _matrices(coefficients)
    xi = _xi(c, Place(name="cube"))
    out = np.zeros_like(c)
    for side in (0, 1, 2), (1, 2, 0), (2, 0, 1), (1, 0, 2), (2, 1, 0), (0, 2, 1):
        i, k, m = side
        out[..., m, k] = xi[..., k] / (1.0 + c[..., i, k]) - 1.0
    return out


@checked
def phi_inverse(coefficients: ArrayLike) -> Floats:
    """The inverse of `phi`: the same map seen from the opposite corner of the cube (1.7)."""
    return seen_from_opposite(phi(seen_from_opposite(coefficients)))


@checked
def seen_from_opposite(coefficients: ArrayLike) -> Floats:
    """Coefficients of each quad as seen from its opposite corner; an involution (1.7).

    (a_k, a_l) -> (a_l, a_k) / (a_k + a_l - 1) with a_k = 1 + c^lk, a_l = 1 + c^kl.

    Raises
    ------
    DegenerateError
        a_k + a_l = 1 (the corners x_k, x_l, x_kl on a line); names the index of the cube.
    """
    c = _matrices(coefficients)
    other = np.swapaxes(c, -1, -2)
    below = 1.0 + c + other
    small = np.abs(below) <= RELATIVE_DEGENERATE * (1.0 + np.abs(c) + np.abs(other))
    Place(name="cube").refuse(
        np.asarray(small.any(axis=(-2, -1))), "three corners of a quad lie on a line"
    )
    out = (1.0 + other) / below - 1.0
    return np.where(_IDENTITY > 0, 0.0, out)


# --- one cube ------------------------------------------------------------------------------------
@checked
def cube_point(
    x: ArrayLike,
    x1: ArrayLike,
    x2: ArrayLike,
    x3: ArrayLike,
    x12: ArrayLike,
    x13: ArrayLike,
    x23: ArrayLike,
    tolerance: float = NET_INPUT,
) -> Floats:
    """(..., dim) eighth vertex: the common point of the planes of the three further faces.

    Parameters
    ----------
    x, x1, x2, x3, x12, x13, x23 : (..., dim), dim > 1, with planar quads at x
    tolerance : on the planarity of these, relative

    Raises
    ------
    DegenerateError
        A quad at x that is not planar, parallel edges at x, planes nearly parallel; names the
        index of the cube.

    Source: mathematics.md 1.6.
    """
    points = columns(x, x1, x2, x3, x12, x13, x23)
    place = Place(name="cube")
    for (k, m), corner in zip(_SIDES, points[4:], strict=True):
        sides = (np.moveaxis(p, 0, -1) for p in (points[0], points[1 + k], points[1 + m], corner))
        off = conj_residual(*sides)
        place.refuse(off > tolerance, f"quad ({k}, {m}) is not planar, limit {tolerance:g}", off)
    return np.moveaxis(_cube(points[0], points[1:4], points[4:], place), 0, -1)


def _cube(x: Floats, ends: tuple[Floats, ...], quads: tuple[Floats, ...], place: Place) -> Floats:
    """`cube_point` with components first; quads in the order 01, 02, 12."""
    c = np.zeros((*x.shape[1:], 3, 3))
    for (k, m), corner in zip(_SIDES, quads, strict=True):
        c[..., m, k], c[..., k, m] = coeffs_kernel(x, ends[k], ends[m], corner, place)
    xi = _xi(c, place)
    new = x.copy()
    for k in range(3):
        new += xi[..., k] * (ends[k] - x)
    return new


# --- evolution -----------------------------------------------------------------------------------
@checked
def coordinate_surfaces(points: ArrayLike) -> dict[tuple[int, int], Floats]:
    """The 2-nets of a d-net through its first point, by their pair of directions."""
    x = np.asarray(points, dtype=np.float64)
    d = x.ndim - 1
    out = {}
    for k, m in combinations(range(d), 2):
        out[k, m] = x[tuple(slice(None) if axis in (k, m) else 0 for axis in range(d))]
    return out


@checked
def evolve_3d(
    x12: ArrayLike, x13: ArrayLike, x23: ArrayLike, *, tolerance: float = NET_INPUT
) -> Floats:
    """(n1, n2, n3, dim) conjugate net from its three coordinate surfaces; see `evolve_nd`.

    Parameters
    ----------
    x12, x13, x23 : (n1, n2, dim), (n1, n3, dim), (n2, n3, dim) conjugate nets with common axes

    Source: Bobenko, Suris, Theorem 2.2; mathematics.md 1.6.
    """
    return evolve_nd({(0, 1): x12, (0, 2): x13, (1, 2): x23}, tolerance=tolerance)


@checked
def evolve_nd(
    surfaces: Mapping[tuple[int, int], ArrayLike],
    *,
    verify: bool = False,
    tolerance: float = NET_INPUT,
) -> Floats:
    """(n1, ..., nd, dim) conjugate net from its d (d - 1) / 2 coordinate surfaces, d > 2.

    Points are made in order of the number of their nonzero indices, by wavefronts, each from the
    cube of its first three nonzero directions: no other cube would give another point (4D
    consistency).

    Parameters
    ----------
    surfaces : by pairs (k, l), k < l < d: (n_k, n_l, dim) conjugate nets with common axes
    verify : whether to make every point a second time: from the cube of its last three nonzero
        directions, or where there are only three, by the planarity of all quads of the cube
    tolerance : relative, on the planarity of the surfaces and on second points; nets from files
        with few digits need more than the default

    Raises
    ------
    InputError
        A missing surface, shapes that do not fit, surfaces with different axes.
    DegenerateError
        A surface whose quads are not planar, parallel edges, planes nearly parallel; with `verify`
        a second point elsewhere. Names the cell or point.

    Source: Bobenko, Suris, Theorem 2.5; mathematics.md 1.8.
    """
    net = _with_surfaces(surfaces, tolerance)
    d = net.ndim - 1
    for size in range(3, d + 1):
        for subset in combinations(range(d), size):
            _fill(net, subset, verify, tolerance)
    return net


def _with_surfaces(surfaces: Mapping[tuple[int, int], ArrayLike], tolerance: float) -> Floats:
    """Checked net with its coordinate surfaces filled, the rest not yet."""
    d = 1 + max((max(pair) for pair in surfaces), default=0)
    wanted = list(combinations(range(d), 2))
    if d < 3 or sorted(surfaces) != wanted:
        raise InputError(f"surfaces {sorted(surfaces)} do not make a net: {wanted} are needed")
    given = {pair: net_points(surfaces[pair]) for pair in wanted}
    sizes = [given[0, k].shape[1] if k else given[0, 1].shape[0] for k in range(d)]
    dim = given[0, 1].shape[-1]
    for (k, m), surface in given.items():
        if surface.shape != (sizes[k], sizes[m], dim):
            raise InputError(
                f"surface {(k, m)} has shape {surface.shape}; {(sizes[k], sizes[m], dim)} is needed"
            )
        flat = np.abs(planarity(surface)) if min(sizes[k], sizes[m]) > 1 else np.zeros((1, 1))
        Place(name=f"surface {(k, m)}, quad").refuse(
            flat > tolerance, f"it is not planar, limit {tolerance:g}", flat
        )
    net = np.empty((*sizes, dim))
    scale = max(extent(s) for s in given.values())
    for step, ((k, m), surface) in enumerate(given.items()):
        box = tuple(slice(None) if axis in (k, m) else 0 for axis in range(d))
        for axis, line in ((k, surface[:, 0]), (m, surface[0])):
            before = any(axis in pair for pair in wanted[:step])
            at = tuple(slice(None) if other == axis else 0 for other in range(d))
            gap = float(np.linalg.norm(net[at] - line, axis=-1).max()) if before else 0.0
            if gap > RELATIVE_DEGENERATE * scale:
                raise InputError(
                    f"surface {(k, m)} and one before it differ on axis {axis}: {gap:g}"
                )
        net[box] = surface
    return net


def _fill(net: Floats, subset: tuple[int, ...], verify: bool, tolerance: float) -> None:
    """Points whose nonzero indices are those of a subset, along wavefronts."""
    sizes, dim = net.shape[:-1], net.shape[-1]
    if min(sizes[k] for k in subset) < 2:
        return
    index = np.indices([sizes[k] - 1 for k in subset]).reshape(len(subset), -1) + 1
    strides = np.array([int(np.prod(sizes[k + 1 :])) for k in range(len(sizes))])
    level = index.sum(axis=0)
    order = np.argsort(level, kind="stable")
    ends = np.append(np.flatnonzero(np.diff(level[order])) + 1, len(order))
    flat, start = net.reshape(-1, dim), 0
    for end in ends:
        front = order[start:end]
        start = int(end)
        places = index[:, front]
        at = strides[list(subset)] @ places

        def cell(which: tuple[int, ...], places: Ints = places) -> tuple[int, ...]:
            full = np.zeros(len(sizes), dtype=np.int64)
            full[list(subset)] = places[:, which[0]]
            return tuple(full.tolist())

        place = Place(cell, "cube below point")
        new = _from_cube(flat, at, strides[list(subset[:3])], place)
        refuse_growth(new, place)
        flat[at] = new.T
        if verify:
            _verify(flat, at, strides[list(subset)], place, tolerance)


def _corners(
    flat: Floats, at: Ints, strides: Ints
) -> tuple[Floats, tuple[Floats, ...], tuple[Floats, ...]]:
    """The corner x, the ends x_k and x_kl of the cube of three directions below points."""
    base = at - strides.sum()
    ends = tuple(flat[base + s].T for s in strides)
    quads = tuple(flat[base + strides[k] + strides[m]].T for k, m in _SIDES)
    return flat[base].T, ends, quads


def _from_cube(flat: Floats, at: Ints, strides: Ints, place: Place) -> Floats:
    with np.errstate(over="ignore", invalid="ignore"):
        return _cube(*_corners(flat, at, strides), place)


def _verify(flat: Floats, at: Ints, strides: Ints, place: Place, tolerance: float) -> None:
    """Every point a second time; refuses it where it is elsewhere."""
    x, ends, quads = _corners(flat, at, strides[-3:])
    new = flat[at].T
    scale = norm(new - x) + sum(norm(end - x) for end in ends)
    if len(strides) > 3:
        again = norm(_cube(x, ends, quads, place) - new) / scale
        place.refuse(
            again > tolerance, "another cube gives another point, relative distance", again
        )
        return
    for i in range(3):
        sides = [quad for quad, pair in zip(quads, _SIDES, strict=True) if i in pair]
        four = (np.moveaxis(p, 0, -1) for p in (ends[i], *sides, new))
        try:
            off = conj_residual(*four)
        except DegenerateError as error:
            which = (error.cell or (0,))[0]
            raise DegenerateError(
                f"{place.name} {place.cell((which,))}: a face has parallel edges",
                cell=place.cell((which,)),
            ) from error
        place.refuse(off > tolerance, "a further face is not planar", off)

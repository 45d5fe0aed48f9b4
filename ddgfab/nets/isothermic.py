"""Isothermic nets: circular nets whose cross-ratios factorise, q = alpha_i / alpha_j.

The label alpha_k of an edge depends on its place along its own direction only. Source: Bobenko,
Pinkall 1996; Bobenko, Suris, Discrete Differential Geometry, 4.3; mathematics.md 6.1.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked, together
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats, extent
from ddgfab.nets.circular import circular_residuals
from ddgfab.nets.crossratio import cross_ratios
from ddgfab.quads import Place, columns, dot, finite, net_points, norm, pairs, sweep
from ddgfab.tolerances import NET_INPUT, RELATIVE_DEGENERATE

PROBE: Final = 1e-13
"""Part of the net's size by which `evolve_isothermic` disturbs its boundary to measure growth."""

GROWTH_LIMIT: Final = 1e5
"""Factor by which `evolve_isothermic` may carry errors of its boundary into the net: 1e-9 of its
size, a careful drawing, then still leaves 1e-4."""

LABELS: Final = "labels of the directions are equal: alpha_j - alpha_i"


# --- what it is ----------------------------------------------------------------------------------
@checked
def cross_ratio_labels(points: ArrayLike) -> tuple[tuple[Floats, ...], float]:
    """Labels of the edges by direction, and how far cross-ratios are from their quotients.

    q(x, x_i, x_ij, x_j) = alpha_i / alpha_j in all quads of all pairs of directions: an isothermic
    net. Labels are determined up to one factor: here the geometric mean of |alpha| over direction
    0 is 1, and most labels of direction 0 (of as many of both signs, the first) are positive, so
    that a net of conformal squares has labels 1 and -1. Signs may change along a direction, as in
    sequences of Darboux transforms.

    Parameters
    ----------
    points : (n1, ..., nd, 2 or 3), d > 1

    Returns
    -------
    labels : d arrays (n_k - 1,)
    defect : greatest |q - alpha_i / alpha_j| / |alpha_i / alpha_j|

    Raises
    ------
    InputError
        A net without quads.
    DegenerateError
        Neighbouring corners of a quad coincide, or a cross-ratio is zero; names the quad.

    Examples
    --------
    >>> import numpy as np
    >>> squares = np.stack(np.meshgrid([0.0, 1, 2], [0.0, 1, 2], indexing="ij"), axis=-1)
    >>> labels, defect = cross_ratio_labels(squares)
    >>> labels
    (array([1., 1.]), array([-1., -1.]))

    Source: mathematics.md 6.1.
    """
    x = net_points(points)
    if min(x.shape[:-1]) < 2:
        raise InputError(f"a net of shape {x.shape} has no quads in some direction, so no labels")
    ratios = {pair: cross_ratios(x, pair)[0] for pair in pairs(x)}
    for pair, q in ratios.items():
        Place(name=f"quad of directions {pair} at").refuse(q == 0, "its cross-ratio is zero")
    labels: list[Floats] = [np.empty(0)] * (x.ndim - 1)
    for axis in range(1, x.ndim - 1):
        # log |q| = log |alpha_0| - log |alpha_axis|: least squares over a grid are its means.
        q = np.moveaxis(ratios[0, axis], (0, axis), (0, 1))
        logs = np.log(np.abs(q)).reshape(*q.shape[:2], -1).mean(axis=2)
        first = logs.mean(axis=1) - logs.mean()
        if axis == 1:
            labels[0] = np.exp(first)
        labels[axis] = np.exp(-logs.mean(axis=0))
    for label, sign in zip(labels, _label_signs(ratios, x.ndim - 1), strict=True):
        label *= sign
    worst = 0.0
    for (i, j), q in ratios.items():
        wanted = np.expand_dims(labels[i], [k for k in range(x.ndim - 1) if k != i]) / (
            np.expand_dims(labels[j], [k for k in range(x.ndim - 1) if k != j])
        )
        worst = max(worst, float((np.abs(q - wanted) / np.abs(wanted)).max(initial=0.0)))
    return tuple(labels), worst


def _label_signs(ratios: dict[tuple[int, int], Floats], d: int) -> list[Floats]:
    """Signs of the labels by direction: sign q = s_0 s_axis, the nearest matrix of rank one."""
    votes = []
    for axis in range(1, d):
        q = np.moveaxis(ratios[0, axis], (0, axis), (0, 1))
        votes.append(np.sign(q).reshape(*q.shape[:2], -1).mean(axis=2))
    rows, _, columns = np.linalg.svd(np.concatenate(votes, axis=1), full_matrices=False)
    first, others = (np.where(v < 0, -1.0, 1.0) for v in (rows[:, 0], columns[0]))
    if (first.sum() or first[0]) < 0:
        first, others = -first, -others
    ends = np.cumsum([vote.shape[1] for vote in votes])[:-1]
    return [first, *np.split(others, ends)]


@checked
def isothermic_residuals(points: ArrayLike) -> dict[str, float]:
    """Greatest planarity, circularity and defect of the cross-ratios' factorisation.

    All zero: the net is isothermic. Source: mathematics.md 6.1.
    """
    labels = cross_ratio_labels(points)[1]
    return {**circular_residuals(points), "cross-ratio labels": labels}


# --- how it evolves ------------------------------------------------------------------------------
@checked
def isothermic_point(
    x: ArrayLike, x1: ArrayLike, x2: ArrayLike, alpha1: ArrayLike, alpha2: ArrayLike
) -> Floats:
    """(..., dim) fourth point x_12 of a quad with cross-ratio q(x, x1, x12, x2) = alpha1 / alpha2.

    x_12 = x + inv((alpha2 inv(x2 - x) - alpha1 inv(x1 - x)) / (alpha2 - alpha1)) with
    inv(v) = v / <v, v>, in any dimension.

    Parameters
    ----------
    x, x1, x2 : (..., dim)
    alpha1, alpha2 : (...) labels of the edges x x1 and x x2

    Raises
    ------
    InputError
        Shapes that do not go together, entries that are not finite.
    DegenerateError
        Equal labels, an edge of no length, or a fourth point at infinity; names the index.

    Examples
    --------
    The cross-ratio of a square is -1.

    >>> isothermic_point([0.0, 0], [1.0, 0], [0.0, 1], 1.0, -1.0)
    array([1., 1.])

    Source: mathematics.md 6.1.
    """
    start, first, second = columns(x, x1, x2)
    _, a, b = together(points=start[0], alpha1=alpha1, alpha2=alpha2)
    for name, label in (("alpha1", a), ("alpha2", b)):
        finite(label, name)
    more = (None,) * (a.ndim - start[0].ndim)  # many labels for one corner make many quads
    start, first, second = (
        np.broadcast_to(p[(slice(None), *more)], (len(p), *a.shape)) for p in (start, first, second)
    )
    return np.moveaxis(point_rule(start, first, second, a, b, Place()), 0, -1)


def point_rule(x: Floats, x1: Floats, x2: Floats, a: Floats, b: Floats, place: Place) -> Floats:
    """`isothermic_point` with components first."""
    p, q = x1 - x, x2 - x
    pp, qq = dot(p, p), dot(q, q)
    place.refuse((pp == 0) | (qq == 0), "an edge has no length")
    difference = np.asarray(b - a)
    equal = np.abs(difference) <= RELATIVE_DEGENERATE * np.maximum(np.abs(a), np.abs(b))
    place.refuse(np.broadcast_to(equal, pp.shape), LABELS, difference)
    far = (b * (q / qq) - a * (p / pp)) / difference
    square = dot(far, far)
    # |far| is measured by the terms that cancelled in it.
    size = (np.abs(b) / np.sqrt(qq) + np.abs(a) / np.sqrt(pp)) / np.abs(difference)
    place.refuse(
        square <= (RELATIVE_DEGENERATE * size) ** 2, "the fourth point is at infinity", norm(far)
    )
    return np.asarray(x + far / square)


@checked
def evolve_isothermic(
    first: ArrayLike,
    second: ArrayLike,
    alpha1: ArrayLike,
    alpha2: ArrayLike,
    *,
    growth_limit: float = GROWTH_LIMIT,
) -> Floats:
    """(M + 1, N + 1, dim) isothermic net from two polylines and the labels of their edges.

    The Cauchy problem is elliptic, hence ill-posed: a disturbance of the polylines grows about
    tenfold every two cells at first. The growth is measured by evolving a disturbed copy, and a
    net beyond the limit is refused. Larger nets come from closed forms, from Darboux transforms or
    from optimisation.

    Parameters
    ----------
    first, second : (M + 1, dim), (N + 1, dim) polylines from one point
    alpha1, alpha2 : (M,), (N,) labels, or one number each
    growth_limit : of the net's error by the polylines' error; `inf` accepts all

    Raises
    ------
    DegenerateError
        Equal labels or a point at infinity (names the cell); growth beyond the limit.
    InputError
        Shapes that do not fit.

    Source: mathematics.md 6.1, 11b.
    """
    if not growth_limit > 0:
        raise InputError(f"growth_limit is {growth_limit:g}; a positive number is needed")
    a, b = np.atleast_2d(*(np.asarray(p, dtype=np.float64) for p in (first, second)))
    if not (len(a) and len(b)):
        raise InputError(f"polylines have shapes {a.shape}, {b.shape}; two points at least each")
    labels = _cell_labels(alpha1, alpha2, (len(a) - 1, len(b) - 1))
    net = sweep(a, b, labels, point_rule)
    if growth_limit == np.inf:
        return net
    size = extent(net)
    rng = np.random.default_rng(0)
    nudge = PROBE * size
    other_a, other_b = (p + nudge * rng.standard_normal(p.shape) for p in (a, b))
    other_b[0] = other_a[0]
    try:
        moved = sweep(other_a, other_b, labels, point_rule)
        growth = float(np.linalg.norm(moved - net, axis=-1).max()) / nudge
    except DegenerateError:
        growth = np.inf
    if growth > growth_limit:
        raise DegenerateError(
            f"an isothermic net of {len(a) - 1} x {len(b) - 1} cells from two polylines: errors "
            f"in them grow by a factor of {growth:.1e} (limit {growth_limit:g})\nthe problem is "
            "ill-posed: take fewer cells (about ten), a closed form, a Darboux transform or "
            "optimisation"
        )
    return net


def _cell_labels(
    alpha1: ArrayLike, alpha2: ArrayLike, cells: tuple[int, int]
) -> tuple[Floats, Floats]:
    made = []
    for name, labels, count in (("alpha1", alpha1, cells[0]), ("alpha2", alpha2, cells[1])):
        made.append(edge_labels(labels, count, name))
    one, two = np.meshgrid(*made, indexing="ij")
    return one, two


def edge_labels(labels: ArrayLike, count: int, name: str) -> Floats:
    """(count,) labels of a direction's edges from as many or one; refuses others and zeros."""
    array = np.asarray(labels, dtype=np.float64)
    if array.ndim > 1 or (array.ndim == 1 and array.shape != (count,)):
        raise InputError(f"{name} has shape {array.shape}; ({count},) or one number is needed")
    finite(np.atleast_1d(array), name)
    full = np.array(np.broadcast_to(array, (count,)))
    zero = np.flatnonzero(full == 0)
    if len(zero):
        raise DegenerateError(f"{name}[{zero[0]}] is zero: that quad has a cross-ratio of zero")
    return full


def net_labels(
    points: Floats, labels: Sequence[ArrayLike] | None, tolerance: float = NET_INPUT
) -> tuple[Floats, ...]:
    """Labels of a net by direction: those given, checked for shape, or the net's own.

    Raises
    ------
    InputError
        None given and the net is not isothermic, with the defect; wrong shapes.
    """
    if labels is None:
        own, defect = cross_ratio_labels(points)
        if not defect <= tolerance:
            raise InputError(
                f"the net is not isothermic: its cross-ratios are {defect:.2g} (relative) from "
                f"quotients of labels (limit {tolerance:g})"
            )
        return own
    if len(labels) != points.ndim - 1:
        raise InputError(f"{len(labels)} lists of labels for {points.ndim - 1} directions")
    return tuple(
        edge_labels(given, points.shape[axis] - 1, f"labels of direction {axis}")
        for axis, given in enumerate(labels)
    )

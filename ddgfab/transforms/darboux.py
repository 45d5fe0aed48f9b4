"""Darboux transforms of isothermic nets: a further direction with a label of its own.

Source: Hertrich-Jeromin, Hoffmann, Pinkall 1999; Bobenko, Suris, 4.3; mathematics.md 6.3.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats, extent
from ddgfab.nets.cells import Place, finite, net_points
from ddgfab.nets.isothermic import isothermic_point, net_labels, point_rule
from ddgfab.tolerances import NET_INPUT, RELATIVE_DEGENERATE


def darboux(
    points: ArrayLike,
    mu: float,
    start: ArrayLike,
    labels: Sequence[ArrayLike] | None = None,
) -> Floats:
    """Darboux transform x^(1) of an isothermic net: q(x, x_k, x_k^(1), x^(1)) = alpha_k / mu.

    Isothermic with the same labels; net and transform are two layers of an isothermic net of one
    direction more. For each mu the transforms are as many as start points.

    Parameters
    ----------
    points : (n1, ..., nd, 2 or 3)
    mu : label of the new direction, another than all labels of the net, not zero
    start : (2 or 3,) first point of the transform
    labels : of the net by direction; by default its own (`cross_ratio_labels`)

    Raises
    ------
    InputError
        A net that is not isothermic; a start point of the wrong shape or that is the net's.
    DegenerateError
        mu is a label; points that coincide or go to infinity (names direction and place); a net
        that is not isothermic with the labels given, so that the transform does not close.

    Source: mathematics.md 6.3.
    """
    x = net_points(points)
    alpha = net_labels(x, labels)
    first = np.asarray(start, dtype=np.float64)
    if first.shape != x.shape[-1:]:
        raise InputError(f"the start point has shape {first.shape}; ({x.shape[-1]},) is needed")
    finite(first, "start point")
    if mu == 0 or not np.isfinite(mu):
        raise DegenerateError(f"mu = {mu:g}: a label other than zero is needed")
    for axis, own in enumerate(alpha):
        same = np.flatnonzero(np.abs(own - mu) <= RELATIVE_DEGENERATE * np.abs(own))
        if len(same):
            raise DegenerateError(
                f"mu = {mu:g} is the label of edge {same[0]} of direction {axis}; take another"
            )
    d = x.ndim - 1
    out = np.empty_like(x)
    out[(0,) * d] = first
    for axis in range(d):
        # All lines of this direction that start on what is known, step by step.
        lines: tuple[slice | int, ...] = (*(slice(None),) * (axis + 1), *(0,) * (d - axis - 1))
        known, made = np.moveaxis(x[lines], axis, 0), np.moveaxis(out[lines], axis, 0)
        for step in range(len(known) - 1):
            place = Place(
                lambda index, step=step: (*index, step),  # type: ignore[misc]
                f"Darboux transform, direction {axis} at",
            )
            here, there, above = (
                np.moveaxis(p, -1, 0) for p in (known[step], known[step + 1], made[step])
            )
            label = np.asarray(alpha[axis][step])
            new = point_rule(here, there, above, label, np.asarray(mu), place)
            made[step + 1] = np.moveaxis(new, 0, -1)
    _check_closing(x, out, alpha, mu)
    return out


def _check_closing(x: Floats, out: Floats, alpha: tuple[Floats, ...], mu: float) -> None:
    """Every edge of the net carries the transform, also those it was not made along."""
    d = x.ndim - 1
    size = extent(out)
    for axis in range(d):
        n = x.shape[axis]
        low, high = (r for r in (range(n - 1), range(1, n)))
        label = np.expand_dims(alpha[axis], [k for k in range(d) if k != axis])
        again = isothermic_point(
            x.take(low, axis=axis), x.take(high, axis=axis), out.take(low, axis=axis), label, mu
        )
        gap = np.linalg.norm(again - out.take(high, axis=axis), axis=-1)
        bad = ~(gap <= NET_INPUT * size)
        if bad.any():
            cell = tuple(int(k) for k in np.argwhere(bad)[0])
            raise DegenerateError(
                f"edge of direction {axis} at {cell}: the transform does not close, gap "
                f"{gap[cell]:.2g} of {size:.3g} (limit {NET_INPUT:g} of it); is the net "
                "isothermic with these labels?",
                cell=cell,
            )


def darboux_common(
    points: ArrayLike, first: ArrayLike, second: ArrayLike, mu1: float, mu2: float
) -> Floats:
    """The common Darboux transform x^(12) of two transforms of one net (permutability).

    q(x, x^(1), x^(12), x^(2)) = mu1 / mu2: it is the transform of `first` with mu2 and of `second`
    with mu1. For `ddgfab.nets.lattice`.

    Raises
    ------
    InputError
        Nets of different shapes, entries that are not finite.
    DegenerateError
        mu1 = mu2, or points that coincide; names the place.

    Source: mathematics.md 6.1, 6.3.
    """
    x, a, b = (np.asarray(net, dtype=np.float64) for net in (points, first, second))
    if not x.shape == a.shape == b.shape:
        raise InputError(f"nets of shapes {x.shape}, {a.shape}, {b.shape}; equal ones are needed")
    return isothermic_point(x, a, b, mu1, mu2)


def darboux_dual(points: ArrayLike, transform: ArrayLike, dual: ArrayLike, mu: float) -> Floats:
    """Dual of a Darboux transform from the dual x* of the net: x* + mu inv(x^(1) - x).

    The duals of a Darboux pair are a Darboux pair. Up to one translation this is
    `christoffel_dual` of the transform.

    Raises
    ------
    InputError
        Nets of different shapes, entries that are not finite.
    DegenerateError
        A point that coincides with its transform; names it.

    Source: mathematics.md 6.3.
    """
    x, a, star = (net_points(net) for net in (points, transform, dual))
    if not x.shape == a.shape == star.shape:
        raise InputError(f"nets of shapes {x.shape}, {a.shape}, {star.shape}; equal ones needed")
    if not np.isfinite(mu):
        raise InputError(f"mu = {mu:g}: a finite label is needed")
    step = a - x
    square = np.einsum("...i,...i->...", step, step)
    Place(name="point").refuse(square == 0, "it coincides with its transform")
    return np.asarray(star + mu * step / square[..., None])

"""Darboux transforms of isothermic nets: a further direction with a label of its own.

Source: Hertrich-Jeromin, Hoffmann, Pinkall 1999; Bobenko, Suris, 4.3; mathematics.md 6.3.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.mesh import Floats
from ddgfab.nets.isothermic import isothermic_point, net_labels
from ddgfab.nets.isothermic_layers import darboux_layer
from ddgfab.quads import Place, finite, net_points
from ddgfab.tolerances import NET_INPUT


@checked
def darboux(
    points: ArrayLike,
    mu: float,
    start: ArrayLike,
    labels: Sequence[ArrayLike] | None = None,
    tolerance: float = NET_INPUT,
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
    tolerance : relative, on cross-ratios against quotients of labels, and on the closing in parts
        of the transform's size; nets from files with few digits need more than the default

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
    alpha = net_labels(x, labels, tolerance)
    first = np.asarray(start, dtype=np.float64)
    if first.shape != x.shape[-1:]:
        raise InputError(f"the start point has shape {first.shape}; ({x.shape[-1]},) is needed")
    finite(first, "start point")
    return darboux_layer(x, alpha, mu, first, tolerance)


@checked
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


@checked
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

"""Discrete Kuen surfaces: two Baecklund transforms of a line, both with the angle pi / 2.

Bianchi's formula has no value for one transform taken twice, but it has a limit when two angles
become one: the reflection in the derivative of the transform's normal. Source: mathematics.md 3.9,
3.11, 3.12 with tau -> 0.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.nets.knet.dini_net import of_normals, segment, vacuum
from ddgfab.nets.knet.net import KNet
from ddgfab.surfaces.k_surfaces import double_transform


@checked
def kuen(
    alphas: ArrayLike, betas: ArrayLike, *, t0: float = 1.0, shift: float = 0.0, r: float = 1.0
) -> KNet:
    """Discrete Kuen surface, a K-net in closed form: the limit of `breather` for tau -> 0.

    With n' the normal of the transform of the vacuum and d = dn' / dsigma at sigma = pi / 2, where
    tan(psi / 2) is the product 3.9 times exp(shift (sigma - pi / 2)), n'' = n - 2 <n, d> / <d, d> d
    and x'' = x - 2 r <n, d> / <d, d> d x n'. There d ln tan(psi / 2) / dsigma = shift - sum tan
    (alpha) - sum tan(beta), and <d, d> >= 1: nothing degenerates.

    Parameters
    ----------
    alphas, betas : (M,), (N,) normal angles in directions 0 and 1 [rad], in (0, pi) without pi / 2
    t0 : tan(psi / 2) at the first point, not zero: moves the net along the axis
    shift : value of d ln tan(psi / 2) / dsigma at the first point; where it is 0, the surface folds
        along the axis
    r : scale, positive

    Raises
    ------
    InputError
        An angle outside (0, pi) or equal to pi / 2, t0 zero or not finite; names index and value.
    """
    if not (np.isfinite(t0) and t0 != 0 and np.isfinite(shift)):
        raise InputError(f"t0 = {t0:g}, shift = {shift:g}: finite numbers, t0 not zero, are needed")
    line = vacuum(alphas, betas)
    a, b = line.deltas
    sine, cosine = segment(a, b, 0.5 * np.pi, t0)
    first, second = (np.concatenate([[0.0], np.cumsum(np.tan(angle))]) for angle in (a, b))
    growth = shift - first[:, None] - second
    points, normals = double_transform(line.points, line.normals, sine, cosine, growth)
    return of_normals(r * points, normals, r, line.deltas)

"""Discrete Amsler surfaces: K-nets through two straight lines.

Source: mathematics.md 3.14; Bobenko, Pinkall 1996; Hoffmann 1999.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.nets.knet.net import KNet, knet
from ddgfab.tolerances import RELATIVE_DEGENERATE


@checked
def amsler(alphas: ArrayLike, betas: ArrayLike, angle: float, *, r: float = 1.0) -> KNet:
    """K-net whose axes i = 0 and j = 0 are straight lines: Cauchy data without turns.

    For equal normal angles delta the angle of the quads depends, in the limit, on u v only:
    phi(u, v) = f(u v) with s f'' + f' = sin f, f(0) = angle (Painleve III).

    Parameters
    ----------
    alphas, betas : (M,), (N,) normal angles in directions 0 and 1 [rad], in (0, pi)
    angle : between the two lines, from direction 0 to direction 1 about the normal [rad]
    r : scale, positive

    Raises
    ------
    InputError
        An angle outside (0, pi) (name, index and value), lines that coincide (angle a multiple of
        pi: `vacuum`).
    """
    if not np.isfinite(angle):
        raise InputError(f"angle = {angle}: a finite angle is needed")
    a, b = np.array(alphas, dtype=np.float64), np.array(betas, dtype=np.float64)
    if abs(np.sin(angle)) <= RELATIVE_DEGENERATE:
        raise InputError(f"angle = {angle:g}: the lines coincide; for a straight net take vacuum")
    return knet((a, b), [np.zeros(max(v.size - 1, 0)) for v in (a, b)], angle, r=r)

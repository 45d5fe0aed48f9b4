"""Discrete breathers: Bianchi's common transform of two conjugate complex transforms of a line.

Source: mathematics.md 3.12.
"""

from __future__ import annotations

import cmath

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.nets.knet.dini_net import of_normals, segment, transform_of_vacuum, vacuum
from ddgfab.nets.knet.net import KNet
from ddgfab.quads import Place
from ddgfab.tolerances import RELATIVE_DEGENERATE

MOST_TAU = 10.0
"""Greatest |tau|: normals of the complex transforms grow as exp |tau| and cancel in the result,
whose defect is 1e-10 of its edges there, 1e-6 at 20."""


@checked
def breather(
    alphas: ArrayLike, betas: ArrayLike, tau: float, *, t0: complex = 1.0, r: float = 1.0
) -> KNet:
    """Discrete breather: the transforms of the vacuum with sigma = pi / 2 +- i tau, both together.

    With n' = p + i q the complex transform of the vacuum (3.9), <p, p> - <q, q> = 1 and
    <p, q> = 0, Bianchi's formula (3.11) for n' and its conjugate is real: n is reflected in q,
    n - 2 <n, q> / <q, q> q, and x moves by 2 r <n, q> / <q, q> p x q. So the result is real
    without rounding, and norms are kept.

    Parameters
    ----------
    alphas, betas : (M,), (N,) normal angles in directions 0 and 1 [rad], in (0, pi)
    tau : imaginary part of sigma, not zero, below `MOST_TAU`
    t0 : complex tan(psi / 2) at the first point, not zero: its modulus and argument move the net
        along the surface
    r : scale, positive

    Raises
    ------
    InputError
        tau or t0 zero or not finite, or tau too large; as `vacuum`.
    DegenerateError
        q = 0 at a point: the two transforms coincide; names it.

    Source: mathematics.md 3.12.
    """
    if not (abs(tau) <= MOST_TAU and tau != 0):
        raise InputError(
            f"tau = {tau}: a number other than zero, of size {MOST_TAU:g} at most, is needed"
        )
    if not (cmath.isfinite(t0) and t0 != 0):
        raise InputError(f"t0 = {t0}: a number other than zero is needed")
    line = vacuum(alphas, betas, r=r)
    sigma = np.pi / 2 + 1j * tau
    sine, cosine = segment(line.deltas[0], line.deltas[1], sigma, complex(t0))
    n = line.normals
    theta = np.arctan2(n[..., 1], n[..., 0])
    _, complex_n = transform_of_vacuum(theta, np.zeros_like(theta), sigma, sine, cosine)
    p, q = complex_n.real, complex_n.imag
    square = np.einsum("...i,...i->...", q, q)
    size = np.einsum("...i,...i->...", p, p)
    Place(name="vertex").refuse(
        square <= RELATIVE_DEGENERATE**2 * size,
        "the two conjugate transforms coincide; imaginary part of their normals",
        np.sqrt(square),
    )
    # <n, q> = Im cos(sigma) everywhere; near poles of n' its sum of large products would be noise.
    a = (2.0 * np.cos(sigma).imag / square)[..., None]
    points = line.points + r * a * np.cross(p, q)
    return of_normals(points, n - a * q, r, line.deltas)

"""Closed forms: the straight line as a K-net, discrete Dini surfaces, the discrete pseudosphere.

The vacuum is a K-net on a line: normals turn about it in both directions. Its Baecklund transforms
are the discrete Dini surfaces, among them the pseudosphere (sigma = pi / 2), a rotational net.
Source: mathematics.md 3.9; Wunderlich 1951; Bobenko, Pinkall 1996.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.mesh import Floats
from ddgfab.nets.knet.net import KNet
from ddgfab.nets.knet.oriented import refuse_angles
from ddgfab.quads import finite, whole
from ddgfab.tolerances import RELATIVE_DEGENERATE


@checked
def vacuum(alphas: ArrayLike, betas: ArrayLike, *, r: float = 1.0) -> KNet:
    """K-net on the z-axis: n = (cos theta, sin theta, 0), theta the sum of the normal angles.

    x = (0, 0, sum sin(alpha) - sum sin(beta)). Every quad is folded into the line, so it has no
    tangent planes of its own; it is the seed of Baecklund transforms.

    Parameters
    ----------
    alphas, betas : (M,), (N,) normal angles in directions 0 and 1 [rad], in (0, pi)
    r : scale, positive

    Raises
    ------
    InputError
        An angle outside (0, pi), no angles, a scale that is not positive.
    """
    a, b = _angles(alphas, betas, r)
    theta, height = _vacuum(a, b)
    zero = np.zeros_like(theta)
    n = np.stack([np.cos(theta), np.sin(theta), zero], axis=-1)
    return of_normals(r * np.stack([zero, zero, height], axis=-1), n, r, (a, b))


@checked
def dini(
    alphas: ArrayLike, betas: ArrayLike, sigma: float, *, t0: float = 1.0, r: float = 1.0
) -> KNet:
    """Discrete Dini surface, closed form of the Baecklund transform of the vacuum.

    tan(psi / 2) = t0 prod A prod B, A = cos((sigma + alpha) / 2) / cos((sigma - alpha) / 2),
    B = sin((sigma + beta) / 2) / sin((sigma - beta) / 2); the points lie at distance
    r sin(sigma) sin(psi) from the z-axis.

    Parameters
    ----------
    alphas, betas : (M,), (N,) normal angles in directions 0 and 1 [rad], in (0, pi)
    sigma : angle of the transform [rad], in (0, pi); pi / 2 gives a rotational net when all angles
        are equal
    t0 : tan(psi / 2) at the first point, not zero; moves the net along the surface
    r : scale, positive

    Raises
    ------
    InputError
        An angle outside (0, pi), t0 zero or not finite, sigma = pi - alpha or sigma = beta (the
        transform falls back onto the line); names the index and value.
    """
    a, b = _angles(alphas, betas, r)
    refuse_angles(np.array([sigma]), "sigma of transform {}")
    if not (np.isfinite(t0) and t0 != 0):
        raise InputError(f"t0 = {t0}: a number other than zero is needed")
    sine, cosine = segment(a, b, sigma, t0)
    theta, height = _vacuum(a, b)
    x, n = transform_of_vacuum(theta, height, sigma, sine, cosine)
    return of_normals(r * x, n, r, (a, b))


@checked
def pseudosphere(
    cells: tuple[int, int], alpha: float, *, offset: float = 0.0, r: float = 1.0
) -> KNet:
    """Discrete pseudosphere: a rotational K-net with all normal angles equal.

    Point (i, j) is on ring p = offset + j - i, of radius r sech(p L) and height
    r (tanh(p L) - (j - i) sin(alpha)), L = ln tan(pi / 4 + alpha / 2), at azimuth (i + j) alpha +
    pi / 2. Ring p = 0 is the rim; the net goes on beyond it on the mirrored half. For alpha =
    pi / N it closes: point (i + N, j + N) is point (i, j).

    Parameters
    ----------
    cells : (M, N) numbers of cells in directions 0 and 1
    alpha : normal angle of both directions [rad], in (0, pi / 2)
    offset : ring of the first point
    r : scale, positive

    Raises
    ------
    InputError
        alpha outside (0, pi / 2), no cells, an offset that is not finite.

    Examples
    --------
    >>> import numpy as np
    >>> net = pseudosphere((4, 6), np.pi / 8)
    >>> max(net.residuals().values()) < 1e-12
    True
    """
    cells = (whole(cells[0], 1, "cells of direction 0"), whole(cells[1], 1, "cells of direction 1"))
    if not 0 < alpha < np.pi / 2:
        raise InputError(f"alpha = {alpha:g}: an angle between 0 and pi / 2 is needed")
    if not np.isfinite(offset):
        raise InputError(f"offset {offset}: a finite number is needed")
    a, b = _angles(np.full(cells[0], alpha), np.full(cells[1], alpha), r)
    step = np.log(np.tan(np.pi / 4 + alpha / 2))
    ring = offset + np.arange(cells[1] + 1.0) - np.arange(cells[0] + 1.0)[:, None]
    theta, height = _vacuum(a, b)
    x, n = transform_of_vacuum(theta, height, np.pi / 2, *sech_tanh(ring * step))
    return of_normals(r * x, n, r, (a, b))


def of_normals(points: Floats, normals: Floats, r: float, deltas: tuple[Floats, ...]) -> KNet:
    """K-net record of points and normals in the gauge of `KNet.normals`."""
    signs = (-1.0) ** np.arange(len(normals))
    return KNet(points, normals * signs.reshape(-1, *(1,) * (normals.ndim - 1)), float(r), deltas)


def _angles(alphas: ArrayLike, betas: ArrayLike, r: float) -> tuple[Floats, Floats]:
    out = []
    for name, values in (("alpha", alphas), ("beta", betas)):
        a = np.array(values, dtype=np.float64)
        if a.ndim != 1 or not len(a):
            raise InputError(f"{name}s have shape {a.shape}; a list of angles is needed")
        finite(a, f"{name}s")
        refuse_angles(a, f"{name} {{}}")
        out.append(a)
    if not 0 < r < np.inf:
        raise InputError(f"r = {r}: the scale of a K-net is a positive number")
    return out[0], out[1]


def _vacuum(a: Floats, b: Floats) -> tuple[Floats, Floats]:
    """Angles theta (M + 1, N + 1) of the normals and heights on the z-axis."""

    def sums(values: Floats) -> Floats:
        return np.concatenate([[0.0], np.cumsum(values)])

    theta = sums(a)[:, None] + sums(b)
    return theta, sums(np.sin(a))[:, None] - sums(np.sin(b))


def segment(a: Floats, b: Floats, sigma: complex, t0: complex) -> tuple[NDArray[Any], NDArray[Any]]:
    """Sine and cosine of psi, tan(psi / 2) = t0 prod A prod B, (M + 1, N + 1); complex for complex.

    By logarithms, so that long nets do not overflow.

    Raises
    ------
    InputError
        sigma = pi - alpha or sigma = beta; names index and value.
    """
    above_a, below_a = np.cos((sigma + a) / 2), np.cos((sigma - a) / 2)
    above_b, below_b = np.sin((sigma + b) / 2), np.sin((sigma - b) / 2)
    for name, angles, what, value in (
        ("alpha", a, "sigma + alpha = pi", above_a),
        ("beta", b, "sigma = beta", below_b),
    ):
        bad = np.abs(value) <= RELATIVE_DEGENERATE
        if bad.any():
            at = int(np.argmax(bad))
            raise InputError(
                f"{name} {at} is {angles[at]:g}: {what}, where the transform falls back onto the "
                "line; change sigma"
            )
    # The other two vanish nowhere for real angles in (0, pi).
    logs_a = np.log((above_a / below_a).astype(complex))
    logs_b = np.log((above_b / below_b).astype(complex))
    way = np.concatenate([[0.0], np.cumsum(logs_a)])[:, None]
    total = np.log(complex(t0)) + way + np.concatenate([[0.0], np.cumsum(logs_b)])
    sine, cosine = sech_tanh(total)
    return (sine, cosine) if np.iscomplexobj(np.array([sigma, t0])) else (sine.real, cosine.real)


def sech_tanh(w: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Sine and cosine of psi with tan(psi / 2) = exp(w): sech(w) and -tanh(w), without overflow."""
    sign = np.where(w.real > 0, 1.0, -1.0)
    small = np.exp(-sign * w)
    return 2.0 * small / (1.0 + small * small), -sign * (1.0 - small**2) / (1.0 + small**2)


def transform_of_vacuum(
    theta: Floats, height: Floats, sigma: complex, sine: NDArray[Any], cosine: NDArray[Any]
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Points and normals of the Baecklund transform of the vacuum of r = 1; mathematics.md 3.9."""
    c, s = np.cos(theta), np.sin(theta)
    cs, ss = np.cos(sigma), np.sin(sigma)
    x = np.stack([-ss * sine * s, ss * sine * c, height - ss * cosine], axis=-1)
    n = np.stack([cs * c - ss * cosine * s, cs * s + ss * cosine * c, ss * sine], axis=-1)
    return x, n

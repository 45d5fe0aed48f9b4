"""Smooth minimal surfaces by Weierstrass' formula: what discrete minimal surfaces approach.

x = Re integral of (f (1 - g^2), i f (1 + g^2), 2 f g) / 2 dz with g meromorphic, the Gauss map by
stereographic projection from the north pole, and f such that f and f g^2 are holomorphic. The
parameter lines of z = u + i v are curvature lines where f g' is real (f g' = 1: isothermic), and
asymptotic lines where it is imaginary. Source: mathematics.md 5.3; Weierstrass 1866.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats

Complexes = NDArray[np.complex128]
Function = Callable[[Complexes], Complexes]

NODES = 24
"""Gauss points on each part of a straight way of integration."""

MOST_PARTS = 64
"""Parts into which a way is divided at most."""

SETTLED = 1e-12
"""An integral has settled when twice the parts change it by less than this part of its way's
length."""

LENGTH_SETTLED = 1e-3
"""The length of a way has settled when twice the parts change it by less than this part of it."""


@dataclass(frozen=True)
class Weierstrass:
    """A minimal surface by its data f, g, and the derivative of g.

    Attributes
    ----------
    f, g, slope : functions of complex arrays; slope is g'
    """

    f: Function
    g: Function
    slope: Function

    def points(self, z: ArrayLike, start: complex = 0.0) -> Floats:
        """(..., 3) points at parameters z, the integral from `start` along straight ways.

        Gauss's rule on ever more parts of the way, until the points stay.

        Raises
        ------
        DegenerateError
            The points do not settle: a pole or branch point on a way or at its end, or a way too
            long; names the parameter.
        """
        ends = np.asarray(z, dtype=np.complex128)
        before, length_before = np.full((*ends.shape, 3), np.inf), np.full(ends.shape, np.inf)
        parts = 1
        while parts <= MOST_PARTS:
            with np.errstate(all="ignore"):  # poles are reported below
                points, length = self._integral(ends, start, parts)
                settled = np.linalg.norm(points - before, axis=-1) <= SETTLED * length
                # The two sides of a pole may cancel; lengths of ways through it grow for ever.
                settled &= np.abs(length - length_before) <= LENGTH_SETTLED * length
            if settled.all():
                return points
            before, length_before, parts = points, length, 2 * parts
        raise DegenerateError(
            f"the integral from {start} to {ends[~settled].flat[0]} does not settle: a pole or "
            "branch point on the way or at its end, or a way too long\n"
            "integrate in shorter steps round it"
        )

    def _integral(self, ends: Complexes, start: complex, parts: int) -> tuple[Floats, Floats]:
        """Points, and lengths of the complex ways that they are real parts of."""
        node, weight = np.polynomial.legendre.leggauss(NODES)
        weights = np.tile(weight, parts)
        place = ((np.arange(parts)[:, None] + 0.5 * (node + 1.0)) / parts).ravel()
        forms = self._forms(start + place * (ends - start)[..., None])
        step = (ends - start) * (0.5 / parts)
        points = (np.einsum("...nx,n->...x", forms, weights) * step[..., None]).real
        lengths = np.linalg.norm(forms, axis=-1) @ weights * np.abs(step)
        return np.asarray(points), np.asarray(lengths)

    def net(self, u: ArrayLike, v: ArrayLike, start: complex = 0.0) -> Floats:
        """(M, N, 3) points at u + i v for all pairs of u (M,) and v (N,)."""
        a, b = np.asarray(u, dtype=np.float64), np.asarray(v, dtype=np.float64)
        if a.ndim != 1 or b.ndim != 1:
            raise InputError(f"u {a.shape} and v {b.shape} must be lists of numbers")
        return self.points(a[:, None] + 1j * b[None, :], start)

    def _forms(self, z: Complexes) -> Complexes:
        f, g = self.f(z), self.g(z)
        forms = [0.5 * f * (1.0 - g * g), 0.5j * f * (1.0 + g * g), f * g]
        return np.stack([np.broadcast_to(form, z.shape) for form in forms], axis=-1)

    def normals(self, z: ArrayLike) -> Floats:
        """(..., 3) unit normals (2 Re g, 2 Im g, |g|^2 - 1) / (1 + |g|^2)."""
        g = np.asarray(self.g(np.asarray(z, dtype=np.complex128)))
        square = np.abs(g) ** 2
        flat = np.stack([2.0 * g.real, 2.0 * g.imag, square - 1.0], axis=-1)
        return np.asarray(flat / (1.0 + square)[..., None])

    def stretch(self, z: ArrayLike) -> Floats:
        """(...) |dx| / |dz| = |f| (1 + |g|^2) / 2."""
        at = np.asarray(z, dtype=np.complex128)
        return np.asarray(0.5 * np.abs(self.f(at)) * (1.0 + np.abs(self.g(at)) ** 2))

    def curvatures(self, z: ArrayLike) -> Floats:
        """(...) K = -16 |g'|^2 / (|f|^2 (1 + |g|^2)^4)."""
        at = np.asarray(z, dtype=np.complex128)
        square = np.abs(self.g(at)) ** 2
        return np.asarray(
            -16.0 * np.abs(self.slope(at)) ** 2 / (np.abs(self.f(at)) ** 2 * (1.0 + square) ** 4)
        )

    def line_defect(self, z: ArrayLike) -> Floats:
        """(...) Im(f g') / |f g'|: 0 along curvature lines, 1 or -1 along asymptotic lines."""
        at = np.asarray(z, dtype=np.complex128)
        product = np.asarray(self.f(at) * self.slope(at))
        return np.asarray(product.imag / np.abs(product))

    def conjugate(self, angle: float = 0.5 * np.pi) -> Weierstrass:
        """The member at an angle [rad] of the associated family: f times e^(i angle).

        Tangents turn about the normal: dx becomes cos(angle) dx + sin(angle) n x dx, as edges of
        `ddgfab.nets.MinimalNet.associated` do.
        """
        turn, f = np.exp(1j * angle), self.f
        return Weierstrass(lambda z: turn * f(z), self.g, self.slope)


@checked
def smooth_enneper() -> Weierstrass:
    """Enneper's surface, f = 1, g = z: (u - u^3/3 + u v^2, -v + v^3/3 - u^2 v, u^2 - v^2) / 2."""
    return Weierstrass(np.ones_like, lambda z: z, np.ones_like)


@checked
def smooth_catenoid() -> Weierstrass:
    """The catenoid, f = e^-z, g = e^z: (1, 0, 0) - (cosh u cos v, cosh u sin v, -u), waist 1."""
    return Weierstrass(lambda z: np.exp(-z), np.exp, np.exp)


@checked
def smooth_scherk_tower() -> Weierstrass:
    """Scherk's tower, f = 4 i / (1 - z^4), g = z; z runs in the unit disc.

    Four wings run to infinity at z = 1, i, -1, -i. Height -arg((1 + z^2) / (1 - z^2)): the four
    arcs |z| = 1 lie in planes at pi / 2 and -pi / 2 by turns. Its conjugate is Scherk's doubly
    periodic surface, cos x e^z = cos y.
    """
    return Weierstrass(lambda z: 4j / (1.0 - z**4), lambda z: z, np.ones_like)


@checked
def smooth_schwarz_p() -> Weierstrass:
    """Schwarz' P surface, f = 1 / sqrt(1 + 14 z^4 + z^8), g = z, near z = 0.

    The branch points, z^4 = 4 sqrt(3) - 7, are the normals to the corners of a cube; the piece over
    a side of the cube has |z| below 0.52. Its conjugate is Schwarz' D surface.
    """

    def f(z: Complexes) -> Complexes:
        return np.asarray(1.0 / np.sqrt(1.0 + 14.0 * z**4 + z**8), dtype=np.complex128)

    return Weierstrass(f, lambda z: z, np.ones_like)

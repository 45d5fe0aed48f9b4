"""Surfaces of curvature -1 in unit-speed asymptotic parameters: oracles for K-nets.

E = G = 1, L = N = 0, and the normal turns at unit speed along both families: x_u = n x n_u,
x_v = -n x n_v. Pseudosphere and Dini are Baecklund transforms of a straight line, breather and
Kuen double ones; Amsler and others are integrated from their angle. Source: mathematics.md 3.14,
3.15, 5.5; Bobenko, Pinkall, Discrete surfaces with constant negative Gaussian curvature, 1996.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ddgfab.arguments import checked, finite_together
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats
from ddgfab.surfaces.sine_gordon import Solution, increasing, integrated

Complex: TypeAlias = NDArray[np.complex128]

SERIES: Final = 1e-3
"""Where the power series of Amsler's angle hands over to the integrator; its terms of fifth order
and beyond are below rounding there."""


FARTHEST: Final = 1e6
"""Greatest |r| to which Amsler's angle is integrated; steps grow as sqrt(r), about 1,000 there."""


@dataclass(frozen=True, eq=False)
class KSurface:
    """points and unit normals (..., 3) of a surface of curvature -1 at asymptotic parameters."""

    points: Floats
    normals: Floats


@checked
def dini(u: ArrayLike, v: ArrayLike, sigma: float = 0.5 * np.pi, start: float = 1.0) -> KSurface:
    """Dini's surface: the transform of the straight line with angle sigma.

    sigma = pi / 2 gives the pseudosphere (then u + v is its azimuth and v - u runs along it, with
    the cuspidal edge at u = v).

    Parameters
    ----------
    u, v : arrays that broadcast to one shape
    sigma : angle [rad] of the transform, between 0 and pi
    start : tan(psi / 2) at u = v = 0, where psi is the direction of the transform

    Raises
    ------
    InputError
        sigma out of range; parameters that are not finite, do not go together, or so large that
        the points are not.

    Source: mathematics.md 3.15, 3.9.
    """
    if not 0.0 < sigma < np.pi:
        raise InputError(f"sigma = {sigma:g} rad; it must lie between 0 and pi")
    grid = _grid(u, v)
    _refuse_start(start)
    with np.errstate(over="ignore", invalid="ignore"):
        points, normals = _transform(grid, complex(sigma), complex(start))
    return _surface(points.real, normals.real)


@checked
def pseudosphere(u: ArrayLike, v: ArrayLike) -> KSurface:
    """The pseudosphere: azimuth u + v + pi / 2, its meridian the tractrix in v - u."""
    return dini(u, v)


@checked
def breather(u: ArrayLike, v: ArrayLike, tau: float, start: complex = 1.0) -> KSurface:
    """The breather: two transforms of the straight line with angles pi / 2 +- i tau.

    It decays along u - v at the rate 1 / cosh(tau) and pulses along u + v at the rate tanh(tau).

    Parameters
    ----------
    u, v : arrays that broadcast to one shape
    tau : not 0
    start : tan(psi / 2) of one of the two transforms at u = v = 0; the other has its conjugate

    Raises
    ------
    InputError
        tau = 0 (the limit is `kuen`); parameters as in `dini`.

    Source: mathematics.md 3.12, 3.15.
    """
    if tau == 0.0 or not np.isfinite(tau):
        raise InputError(f"tau = {tau:g}; a number other than 0 is needed (kuen is the limit)")
    grid, sigma = _grid(u, v), 0.5 * np.pi + 1j * tau
    _refuse_start(start)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        points, normals = (part.real for part in _line(grid))
        _, transform = _transform(grid, sigma, complex(start))
        p, q = transform.real, transform.imag
        # Bianchi's formula for n' = p + i q and its conjugate is real; <n, q> = Im cos(sigma).
        a = 2.0 * np.cos(sigma).imag / np.einsum("...i,...i->...", q, q)[..., None]
        return _surface(points + a * np.cross(p, q), normals - a * q)


@checked
def kuen(u: ArrayLike, v: ArrayLike, shift: float = 0.0) -> KSurface:
    """Kuen's surface: the breather's limit tau -> 0, two transforms of one angle pi / 2.

    Parameters
    ----------
    u, v : arrays that broadcast to one shape
    shift : moves the double pole along u + v

    Raises
    ------
    InputError
        Parameters as in `dini`, or a shift that is not finite.

    Source: mathematics.md 3.12 in the limit: with d the derivative of the transform's normal by
    sigma, n12 = n - 2 <n, d> / <d, d> d and x12 = x - 2 <n, d> / <d, d> d x n1.
    """
    grid = _grid(u, v)
    finite_together(shift=shift)
    with np.errstate(over="ignore", invalid="ignore"):
        points, normals = _line(grid)
        theta, along = (grid[0] + grid[1]).real, (grid[1] - grid[0]).real
        sine, cosine = 1.0 / np.cosh(along), -np.tanh(along)
        x, n = double_transform(points.real, normals.real, sine, cosine, shift - theta)
    return _surface(x, n)


def double_transform(
    points: Floats, normals: Floats, sine: Floats, cosine: Floats, growth: Floats
) -> tuple[Floats, Floats]:
    """Points and normals of the line's double transform of one angle pi / 2, smooth or discrete.

    Parameters
    ----------
    points, normals : (..., 3) of the line, which is the z axis
    sine, cosine : (...) of psi, the direction of the simple transform
    growth : (...) derivative of ln tan(psi / 2) by sigma at pi / 2
    """
    up = np.zeros_like(normals)
    up[..., 2] = 1.0
    t = np.cross(up, normals)
    cos, sin = cosine[..., None], sine[..., None]
    first = cos * t + sin * up
    d = -normals + (sin * growth[..., None]) * (cos * up - sin * t)
    factor = 2.0 / np.einsum("...i,...i->...", d, d)[..., None]  # <n, d> = -1
    return points + factor * np.cross(d, first), normals + factor * d


@checked
def surface_of(solution: Solution, u: ArrayLike, v: ArrayLike) -> KSurface:
    """(M, N, 3) points and normals of the surface of a solution of phi_uv = sin phi.

    The moving frame (x_u, n) is integrated along u at v[0], then along v from all u at once:
    x_uu = -phi_u n x x_u, n_u = x_u x n, x_uv = sin phi n, n_v = -x_v x n. At the first point
    x = 0, x_u points along the x axis, n along z.

    Parameters
    ----------
    solution : gives phi, phi_u, phi_v at arrays u, v
    u, v : (M,), (N,) increasing

    Raises
    ------
    InputError
        u or v that do not increase; names the step.
    DegenerateError
        The integration does not reach the end of the grid; says how far it came.

    Source: Gauss and Weingarten equations with E = G = 1, F = cos phi, M = sin phi; mathematics.md
    5.5.
    """
    points, _, normals = frames_of(solution, u, v)
    return KSurface(points, normals)


def frames_of(solution: Solution, u: ArrayLike, v: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """Points, tangents x_u and normals (M, N, 3) of `surface_of`."""
    p, q = increasing(u, "u"), increasing(v, "v")

    def along_u(s: float, y: Floats) -> Floats:
        _, e, n = y.reshape(3, 3)
        _, phi_u, _ = solution(np.array([s]), q[:1])
        b = np.cross(n, e)
        return np.concatenate([e, -phi_u * b, -b])

    def along_v(s: float, y: Floats) -> Floats:
        _, e, n = y.reshape(3, len(p), 3)
        phi, _, _ = solution(p, np.full(len(p), s))
        cos, sin = np.cos(phi)[:, None], np.sin(phi)[:, None]
        b = np.cross(n, e)
        return np.concatenate([cos * e + sin * b, sin * n, cos * b - sin * e]).ravel()

    first = integrated(along_u, np.array([0.0, 0, 0, 1, 0, 0, 0, 0, 1]), p)
    across = integrated(along_v, first.reshape(-1, 3, 3).transpose(1, 0, 2).ravel(), q)
    found = across.reshape(len(q), 3, len(p), 3).transpose(1, 2, 0, 3)
    points, tangents, normals = (np.ascontiguousarray(part) for part in found)
    return points, tangents, normals


@checked
def amsler_angle(r: ArrayLike, start: float) -> tuple[Floats, Floats]:
    """f and f' of Amsler's angle phi(u, v) = f(u v): r f'' + f' = sin f, f(0) = start.

    Parameters
    ----------
    r : any shape, of any sign
    start : the angle [rad] between the two straight lines

    Raises
    ------
    InputError
        A number that is not finite.
    DegenerateError
        An r so far from 0 that the integration does not reach it; says the limit, or how far it
        came.

    Source: mathematics.md 3.14; a third Painleve equation. Near 0, f = start + sin(start) r + ...
    """
    given, _ = finite_together(r=r, start=start)
    if np.abs(given).max(initial=0.0) > FARTHEST:
        raise DegenerateError(
            f"r = {given.flat[np.abs(given).argmax()]:g} lies too far from 0 for the integration "
            f"of Amsler's angle (limit {FARTHEST:g})"
        )
    values, back = np.unique(given, return_inverse=True)
    f, slope = np.empty_like(values), np.empty_like(values)
    near = np.abs(values) <= SERIES
    f[near], slope[near] = _amsler_series(values[near], start)

    def field(s: float, y: Floats) -> Floats:
        return np.array([y[1] / s, np.sin(y[0])])  # y = f, r f'

    for side in (1.0, -1.0):
        own = np.flatnonzero(~near & (side * values > 0))
        if not len(own):
            continue
        order = own[np.argsort(side * values[own])]
        first = np.array([side * SERIES])
        begin = np.concatenate(_amsler_series(first, start))
        at = np.concatenate([first, values[order]])
        found = integrated(field, begin * [1.0, first[0]], at)[1:]
        f[order], slope[order] = found[:, 0], found[:, 1] / values[order]
    return f[back].reshape(given.shape), slope[back].reshape(given.shape)


@checked
def amsler(u: ArrayLike, v: ArrayLike, start: float) -> KSurface:
    """(M, N, 3) Amsler's surface, which holds two straight lines that cross at an angle.

    Parameters
    ----------
    u, v : (M,), (N,) increasing; u = 0 and v = 0 are the straight lines
    start : angle [rad] between them, between 0 and pi

    Raises
    ------
    InputError
        An angle out of range, or parameters that do not increase.

    Source: mathematics.md 3.14.
    """
    if not 0.0 < start < np.pi:
        raise InputError(f"the lines cross at {start:g} rad; between 0 and pi is needed")

    def solution(p: Floats, q: Floats) -> tuple[Floats, Floats, Floats]:
        f, slope = amsler_angle(p * q, start)
        return f, q * slope, p * slope

    return surface_of(solution, u, v)


def _amsler_series(r: Floats, start: float) -> tuple[Floats, Floats]:
    """f and f' by sum c_k r^k with k^2 c_k = the coefficient of r^(k-1) in sin f."""
    s, c = np.sin(start), np.cos(start)
    c1 = s
    c2 = c * c1 / 4.0
    c3 = (c * c2 - 0.5 * s * c1**2) / 9.0
    c4 = (c * c3 - s * c1 * c2 - c * c1**3 / 6.0) / 16.0
    f = start + r * (c1 + r * (c2 + r * (c3 + r * c4)))
    return f, c1 + r * (2.0 * c2 + r * (3.0 * c3 + r * 4.0 * c4))


def _grid(u: ArrayLike, v: ArrayLike) -> tuple[Complex, Complex]:
    p, q = finite_together(u=u, v=v)
    return p.astype(np.complex128), q.astype(np.complex128)


def _refuse_start(start: complex) -> None:
    if not np.isfinite(start):
        raise InputError(f"start = {start:g}; a finite number is needed")


def _surface(points: Floats, normals: Floats) -> KSurface:
    """The surface, or `InputError` where parameters were so large that points are not finite."""
    bad = ~(np.isfinite(points) & np.isfinite(normals)).all(axis=-1)
    if bad.any():
        at = tuple(np.argwhere(bad)[0].tolist())
        raise InputError(f"point {at} is not finite in floating point: u or v is too large there")
    return KSurface(points, normals)


def _line(grid: tuple[Complex, Complex]) -> tuple[Complex, Complex]:
    """The straight line as degenerate surface: x = (0, 0, u - v), n turning by u + v."""
    theta = grid[0] + grid[1]
    zero = 0.0 * theta
    points = np.stack([zero, zero, grid[0] - grid[1]], axis=-1)
    return points, np.stack([np.cos(theta), np.sin(theta), zero], axis=-1)


def _transform(
    grid: tuple[Complex, Complex], sigma: complex, start: complex
) -> tuple[Complex, Complex]:
    """Transform of the line: tan(psi / 2) = start exp(v cot(sigma / 2) - u tan(sigma / 2))."""
    u, v = grid
    half = np.tan(0.5 * sigma)
    psi = 2.0 * np.arctan(start * np.exp(v / half - u * half))
    theta = u + v
    zero = 0.0 * theta
    t = np.stack([-np.sin(theta), np.cos(theta), zero], axis=-1)
    up = np.stack([zero, zero, zero + 1.0], axis=-1)
    points, normals = _line(grid)
    cos, sin = np.cos(psi)[..., None], np.sin(psi)[..., None]
    n = np.cos(sigma) * normals + np.sin(sigma) * (cos * t + sin * up)
    return points + np.cross(n, normals), n

"""Sequences of transforms of smooth surfaces: semidiscrete surfaces, sampled sheet by sheet.

Between the nets, all of whose directions are discrete, and the smooth surfaces lie smooth surfaces
with discrete sequences of transforms. Source: Bobenko, Suris, Discrete Differential Geometry, 1.1,
1.2, 1.7; mathematics.md 1.9, 5.2, 5.4, 5.5, 6.3.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats, extent
from ddgfab.surfaces.isothermic import STEP, Surface, smooth_frame
from ddgfab.surfaces.k_surfaces import KSurface, frames_of
from ddgfab.surfaces.sine_gordon import Solution, increasing, integrated
from ddgfab.tolerances import RELATIVE_DEGENERATE


@dataclass(frozen=True, eq=False)
class KSequence:
    """A smooth K-surface and its successive Baecklund transforms, sampled at u x v.

    Attributes
    ----------
    sheets : k + 1 surfaces with points and normals (M, N, 3); each is a transform of the one before
    angles : (k + 1, M, N) of their asymptotic lines [rad], solutions of phi_uv = sin phi
    sigmas : (k,) angles between the normals of successive sheets [rad]
    """

    sheets: tuple[KSurface, ...]
    angles: Floats
    sigmas: tuple[float, ...]

    @property
    def points(self) -> Floats:
        """(M, N, k + 1, 3) points, the sequence as last direction (as `stack_transforms`)."""
        return np.stack([sheet.points for sheet in self.sheets], axis=-2)


@checked
def baecklund_sequence(
    solution: Solution,
    u: ArrayLike,
    v: ArrayLike,
    sigmas: Sequence[float],
    starts: Sequence[float],
) -> KSequence:
    """Baecklund transforms, one after the other, of the K-surface of a solution, in space.

    The angles of all sheets are integrated at once by phi'_u = phi_u + 2 a sin((phi + phi') / 2),
    phi'_v = -phi_v + 2 / a sin((phi' - phi) / 2) with a = tan(sigma / 2). Then
    x' = x + sin(sigma) d, n' = cos(sigma) n + sin(sigma) n x d, where d is tangent to both sheets
    and makes the angle (phi + phi') / 2 with x_u about n, and with x'_u about n'.

    Parameters
    ----------
    solution : gives phi, phi_u, phi_v at arrays u, v
    u, v : (M,), (N,) increasing
    sigmas : (k,) angles between the normals of successive sheets [rad], between 0 and pi
    starts : (k,) angle phi of each transform at (u[0], v[0]) [rad]

    Raises
    ------
    InputError
        Numbers of angles that differ, sigma out of range, parameters that do not increase.
    DegenerateError
        The integration does not reach the end of the grid.

    Source: Bianchi; mathematics.md 5.2, 5.5.
    """
    if len(sigmas) != len(starts) or not len(sigmas):
        raise InputError(f"{len(sigmas)} sigmas and {len(starts)} starts: as many are needed")
    for k, sigma in enumerate(sigmas):
        if not 0.0 < sigma < np.pi:
            raise InputError(f"sigma {k} is {sigma:g} rad; it must lie between 0 and pi")
    p, q = increasing(u, "u"), increasing(v, "v")
    a = np.tan(0.5 * np.asarray(sigmas, dtype=np.float64))

    def along_u(s: float, y: Floats) -> Floats:
        before, slope = (part[0] for part in solution(np.array([s]), q[:1])[:2])
        out = np.empty_like(y)
        for k, phi in enumerate(y):
            slope = slope + 2.0 * a[k] * np.sin(0.5 * (phi + before))
            out[k], before = slope, phi
        return out

    def along_v(s: float, y: Floats) -> Floats:
        before, _, slope = solution(p, np.full(len(p), s))
        out = np.empty((len(a), len(p)))
        for k, phi in enumerate(y.reshape(len(a), len(p))):
            slope = -slope + 2.0 / a[k] * np.sin(0.5 * (phi - before))
            out[k], before = slope, phi
        return out.ravel()

    first = integrated(along_u, np.asarray(starts, dtype=np.float64), p)
    found = integrated(along_v, first.T.ravel(), q).reshape(len(q), len(a), len(p))
    own = np.broadcast_to(solution(p[:, None], q[None])[0], (len(p), len(q)))
    angles = np.concatenate([own[None], found.transpose(1, 2, 0)])
    x, e, n = frames_of(solution, p, q)
    sheets = [KSurface(x, n)]
    for k, sigma in enumerate(sigmas):
        theta = 0.5 * (angles[k] + angles[k + 1])[..., None]
        d = np.cos(theta) * e + np.sin(theta) * np.cross(n, e)
        x = x + np.sin(sigma) * d
        n = np.cos(sigma) * n + np.sin(sigma) * np.cross(n, d)
        e = np.cos(theta) * d - np.sin(theta) * np.cross(n, d)
        sheets.append(KSurface(x, n))
    return KSequence(tuple(sheets), angles, tuple(float(s) for s in sigmas))


@checked
def smooth_darboux(
    surface: Surface,
    u: ArrayLike,
    v: ArrayLike,
    mu: float,
    start: ArrayLike,
    *,
    step: float = STEP,
) -> Floats:
    """(M, N, 3) Darboux transform of a smooth isothermic surface, by integration.

    With y = x' - x and the dual form dx* = x_u / s^2 du - x_v / s^2 dv it solves Riccati's equation
    dx' = mu (|y|^2 dx* - 2 <y, dx*> y): along u at v[0], then along v from all u at once. A net of
    steps eps on the surface with labels 1 and -1 has it as limit of `darboux` with parameter
    -1 / (mu eps^2), with second order.

    Parameters
    ----------
    surface : vectorised isothermic parametrisation
    u, v : (M,), (N,) increasing
    mu : parameter of the transform, not 0
    start : (3,) first point of the transform
    step : of the differences, in the parameters' unit

    Raises
    ------
    InputError
        mu = 0, a start that is not three finite numbers, parameters that do not increase.
    DegenerateError
        The start on the surface; a transform that runs into it or away; as
        `smooth_isothermic_residuals`.

    Source: Darboux 1899; Hertrich-Jeromin, Introduction to Moebius differential geometry, 5.4;
    mathematics.md 6.3.
    """
    p, q = increasing(u, "u"), increasing(v, "v")
    first = np.asarray(start, dtype=np.float64)
    if first.shape != (3,) or not np.isfinite(first).all() or mu == 0 or not np.isfinite(mu):
        raise InputError(f"mu = {mu:g} and a start of shape {first.shape}: mu other than 0, (3,)")

    def slope(points: Floats, a: Floats, b: Floats, direction: int) -> Floats:
        x, *both = smooth_frame(surface, a, b, step)
        speed = np.linalg.norm(both[0], axis=-1) * np.linalg.norm(both[1], axis=-1)
        form = both[direction] * ((1 - 2 * direction) / speed)[..., None]
        y = points - x
        along = np.einsum("...i,...i->...", y, form)[..., None]
        return np.asarray(
            mu * (np.einsum("...i,...i->...", y, y)[..., None] * form - 2 * along * y)
        )

    x0 = smooth_frame(surface, p[:1], q[:1], step)[0][0]
    if np.linalg.norm(first - x0) <= RELATIVE_DEGENERATE * extent(np.stack([first, x0, 0 * x0])):
        raise DegenerateError("the start lies on the surface: the transform has no direction there")
    line = integrated(lambda s, y: slope(y[None], np.array([s]), q[:1], 0)[0], first, p)

    def across(s: float, y: Floats) -> Floats:
        return slope(y.reshape(-1, 3), p, np.full(len(p), s), 1).ravel()

    found = integrated(across, line.ravel(), q)
    return np.ascontiguousarray(found.reshape(len(q), len(p), 3).transpose(1, 0, 2))

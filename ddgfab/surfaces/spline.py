"""Tensor spline surfaces, rational (NURBS) or not: points and derivatives of whole batches.

Every surface that a net is traced on is one of these: NURBS patches as they are, analytic surfaces
interpolated (`interpolated`), triangle meshes fitted (`fit_mesh`). Source: Piegl, Tiller, The NURBS
Book, 4.5 (derivatives of rational surfaces).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import NdBSpline

from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats
from ddgfab.surfaces.trim import Trim
from ddgfab.tolerances import RELATIVE_DEGENERATE

_CHECKS: Final = 17
"""Parameters a side at which a surface is asked whether it is regular."""
_ORDERS: Final = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))


class Jets(NamedTuple):
    """Points and derivatives of a surface at n parameters, (n, 3) each."""

    x: Floats
    u: Floats
    v: Floats
    uu: Floats
    uv: Floats
    vv: Floats


class SplineSurface:
    """A tensor spline surface over a rectangle of parameters, trimmed.

    Parameters
    ----------
    control : (p, q, 3) control points
    knots : of u (p + degree + 1,) and of v (q + degree + 1,); clamped, in ascending order
    degrees : of u and of v, 2 or more; continuous curvature needs 3 and simple knots
    weights : (p, q) positive; None for a polynomial surface
    trim : closed loops (m, 2) in the parameter plane, the outer one counterclockwise, holes
        clockwise; None for the whole rectangle
    name : of the patch, for messages

    Raises
    ------
    InputError
        Shapes that do not fit, a weight that is not positive, knots that are not sorted or not
        clamped, degree 1, a loop that leaves the rectangle or crosses itself.
    DegenerateError
        The derivatives along u and v are parallel somewhere (a collapsed edge); names (u, v).
    """

    def __init__(
        self,
        control: ArrayLike,
        knots: Sequence[ArrayLike],
        degrees: tuple[int, int],
        weights: ArrayLike | None = None,
        trim: Sequence[ArrayLike] | None = None,
        *,
        name: str = "surface",
    ) -> None:
        points = np.asarray(control, dtype=np.float64)
        if points.ndim != 3 or points.shape[2] != 3:
            raise InputError(
                f"{name}: control points have shape {points.shape}; expected (p, q, 3)"
            )
        if not np.isfinite(points).all():
            raise InputError(f"{name}: a control point is not finite")
        self.name, self.degrees = name, degrees
        self.knots = tuple(
            _checked_knots(np.asarray(given, dtype=np.float64), count, degree, axis, name)
            for given, count, degree, axis in zip(
                knots, points.shape[:2], degrees, "uv", strict=True
            )
        )
        self.control, self.weights = points, None
        coefficients = points
        if weights is not None:
            w = np.asarray(weights, dtype=np.float64)
            _check_weights(w, points.shape[:2], name)
            self.weights = w
            coefficients = np.concatenate([points * w[..., None], w[..., None]], axis=2)
        self._spline: Any = NdBSpline(self.knots, coefficients, degrees)
        (u0, u1), (v0, v1) = ((k[0], k[-1]) for k in self.knots)
        self.domain = float(u0), float(u1), float(v0), float(v1)
        self._check_regular()
        self.trim = Trim.of(trim, self.domain, name)

    def __repr__(self) -> str:
        p, q = self.control.shape[:2]
        kind = "polynomial" if self.weights is None else "rational"
        return (
            f"SplineSurface({self.name}: {kind}, {p} x {q} control points, degrees {self.degrees})"
        )

    def trimmed(self, loops: Sequence[ArrayLike] | None) -> SplineSurface:
        """The same surface with other trimming loops."""
        return SplineSurface(
            self.control, self.knots, self.degrees, self.weights, loops, name=self.name
        )

    def moved(self, by: ArrayLike) -> SplineSurface:
        """The same surface moved by a vector (3,)."""
        control = self.control + np.asarray(by, dtype=np.float64)
        return SplineSurface(
            control, self.knots, self.degrees, self.weights, self.trim.loops, name=self.name
        )

    def clipped(self, uv: Floats) -> Floats:
        """(n, 2) parameters moved into the rectangle."""
        u0, u1, v0, v1 = self.domain
        return np.clip(uv, (u0, v0), (u1, v1))

    def points(self, uv: ArrayLike) -> Floats:
        """(n, 3) points at parameters (n, 2)."""
        where = self.clipped(np.asarray(uv, dtype=np.float64))
        value = self._spline(where)
        return np.asarray(value if self.weights is None else value[:, :3] / value[:, 3:])

    def jets(self, uv: ArrayLike) -> Jets:
        """Points and derivatives at parameters (n, 2); those outside are moved to the rectangle."""
        where = self.clipped(np.asarray(uv, dtype=np.float64))
        parts = [self._spline(where, nu=order) for order in _ORDERS]
        if self.weights is None:
            return Jets(*parts)
        a, w = [part[:, :3] for part in parts], [part[:, 3:] for part in parts]
        x = a[0] / w[0]
        xu, xv = ((a[i] - w[i] * x) / w[0] for i in (1, 2))
        return Jets(
            x,
            xu,
            xv,
            (a[3] - 2 * w[1] * xu - w[3] * x) / w[0],
            (a[4] - w[1] * xv - w[2] * xu - w[4] * x) / w[0],
            (a[5] - 2 * w[2] * xv - w[5] * x) / w[0],
        )

    def _check_regular(self) -> None:
        u0, u1, v0, v1 = self.domain
        u, v = np.linspace(u0, u1, _CHECKS), np.linspace(v0, v1, _CHECKS)
        uv = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)
        jets = self.jets(uv)
        area = np.linalg.norm(np.cross(jets.u, jets.v), axis=1)
        sides = np.linalg.norm(jets.u, axis=1) * np.linalg.norm(jets.v, axis=1)
        bad = np.flatnonzero(~(area > RELATIVE_DEGENERATE * sides))
        if len(bad):
            u_bad, v_bad = uv[bad[0]]
            raise DegenerateError(
                f"{self.name}: has no normal at u = {u_bad:.6g}, v = {v_bad:.6g} (a side that is "
                "collapsed to a point, or a fold)\ncut the patch back from there, or rebuild it "
                "with four sides"
            )


def _checked_knots(knots: Floats, count: int, degree: int, axis: str, name: str) -> Floats:
    if degree < 2:
        raise InputError(
            f"{name}: degree {degree} along {axis}: curvature needs 2 or more; rebuild it as a "
            "cubic surface"
        )
    if knots.shape != (count + degree + 1,):
        raise InputError(
            f"{name}: {len(knots)} knots along {axis} for {count} control points of degree "
            f"{degree}; {count + degree + 1} are needed"
        )
    step = np.diff(knots)
    if not (np.isfinite(knots).all() and (step >= 0).all() and knots[-1] > knots[0]):
        raise InputError(f"{name}: knots along {axis} are not in ascending order")
    if np.ptp(knots[: degree + 1]) > 0 or np.ptp(knots[-degree - 1 :]) > 0:
        raise InputError(
            f"{name}: knots along {axis} are not clamped: the first and last {degree + 1} must be "
            "equal (cut a periodic surface open)"
        )
    return knots


def _check_weights(weights: Floats, shape: tuple[int, ...], name: str) -> None:
    if weights.shape != shape:
        raise InputError(f"{name}: weights have shape {weights.shape}; expected {shape}")
    bad = np.argwhere(~(weights > 0))
    if len(bad):
        i, j = bad[0]
        raise InputError(
            f"{name}: weight {weights[i, j]:g} of control point ({i}, {j}) is not positive"
        )

"""Ribaucour transforms of smooth surfaces in lines of curvature, one after the other.

With p a Combescure transform of x (p_u = a x_u, p_v = b x_v) and phi its potential
(d phi = <p, dx>), x' = x - 2 phi p / |p|^2 is a Ribaucour transform of x: x and x' envelop spheres
and their lines of curvature correspond. All are such. Source: Bianchi; Eisenhart, Transformations
of surfaces, ch. 5; Bobenko, Suris, Discrete Differential Geometry, 1.5; mathematics.md 1.9.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats, extent
from ddgfab.surfaces.isothermic import Surface
from ddgfab.surfaces.sine_gordon import increasing
from ddgfab.tolerances import RELATIVE_DEGENERATE

_NODES: Final = 24
"""Chebyshev nodes a side."""
_RESOLVED: Final = 1e-7
"""A surface is resolved when its last two rows of coefficients are below this part of its size."""
_CURVATURE: Final = 1e-5
"""Cosine of the parameter lines, and part of x_uv across them, that pass for zero."""

Rate = float | Callable[[Floats], ArrayLike]
"""p_u / x_u along the first line u, or p_v / x_v along the first line v: a number or a function."""


@dataclass(frozen=True, eq=False)
class ChebyshevSurface:
    """A surface as polynomial over a rectangle of parameters; call it with arrays u, v.

    Attributes
    ----------
    domain : (u0, u1, v0, v1)
    coefficients : (n, n, 3) of Chebyshev polynomials in u and v
    """

    domain: tuple[float, float, float, float]
    coefficients: Floats

    def __call__(self, u: ArrayLike, v: ArrayLike) -> Floats:
        """(..., 3) points at parameters u, v of one shape."""
        u0, u1, v0, v1 = self.domain
        s = (2 * np.asarray(u, dtype=np.float64) - u0 - u1) / (u1 - u0)
        t = (2 * np.asarray(v, dtype=np.float64) - v0 - v1) / (v1 - v0)
        value: Floats = np.asarray(chebyshev.chebval2d(s, t, self.coefficients), dtype=np.float64)
        return np.moveaxis(value, 0, -1)

    @staticmethod
    def of(
        surface: Surface, domain: tuple[float, float, float, float], nodes: int = _NODES
    ) -> ChebyshevSurface:
        """The polynomial through a surface at Chebyshev nodes.

        Raises
        ------
        DegenerateError
            Points that are not finite; a surface that so many nodes do not resolve.
        """
        grid = _Grid(domain, nodes)
        x = np.asarray(surface(*grid.at), dtype=np.float64)
        if x.shape != (nodes, nodes, 3) or not np.isfinite(x).all():
            raise DegenerateError(f"the surface is not finite points (..., 3) on {domain}")
        c = grid.coefficients(x)
        tail = max(np.abs(c[-2:]).max(), np.abs(c[:, -2:]).max())
        if tail > _RESOLVED * extent(x.reshape(-1, 3)):
            raise DegenerateError(
                f"{nodes} x {nodes} polynomials do not resolve the surface over {domain} (rest "
                f"{tail:.1e})\ntake a smaller part of it"
            )
        return ChebyshevSurface(domain, c)


@dataclass(frozen=True, eq=False)
class _Grid:
    """Chebyshev nodes over a rectangle, the first row and column at its low sides."""

    domain: tuple[float, float, float, float]
    count: int

    @cached_property
    def nodes(self) -> Floats:
        return np.asarray(-np.cos(np.pi * np.arange(self.count) / (self.count - 1)))

    @cached_property
    def lines(self) -> tuple[Floats, Floats]:
        u0, u1, v0, v1 = self.domain
        part = 0.5 * (1 + self.nodes)
        return u0 + part * (u1 - u0), v0 + part * (v1 - v0)

    @cached_property
    def at(self) -> tuple[Floats, Floats]:
        u, v = np.meshgrid(*self.lines, indexing="ij")
        return u, v

    @cached_property
    def _inverse(self) -> Floats:
        rows = np.asarray(chebyshev.chebvander(self.nodes, self.count - 1), dtype=np.float64)
        return np.asarray(np.linalg.inv(rows), dtype=np.float64)

    @cached_property
    def slopes(self) -> tuple[Floats, Floats]:
        """(n, n) values to values of the derivative along u, along v."""
        rows = [chebyshev.chebval(self.nodes, chebyshev.chebder(c)) for c in np.eye(self.count)]
        d = np.stack(rows, axis=1) @ self._inverse
        u0, u1, v0, v1 = self.domain
        return 2 / (u1 - u0) * d, 2 / (v1 - v0) * d

    @cached_property
    def sums(self) -> tuple[Floats, Floats]:
        """(n, n) values to values of the integral from the low side, along u, along v."""
        rows = [
            chebyshev.chebval(self.nodes, chebyshev.chebint(c, lbnd=-1)) for c in np.eye(self.count)
        ]
        j = np.stack(rows, axis=1) @ self._inverse
        u0, u1, v0, v1 = self.domain
        return 0.5 * (u1 - u0) * j, 0.5 * (v1 - v0) * j

    def coefficients(self, values: Floats) -> Floats:
        return np.asarray(np.einsum("ai,bj,ij...->ab...", self._inverse, self._inverse, values))

    def derivatives(self, values: Floats) -> tuple[Floats, Floats]:
        one, two = self.slopes
        return np.einsum("ai,ij...->aj...", one, values), np.einsum("bj,ij...->ib...", two, values)

    def potential(self, along_u: Floats, along_v: Floats, start: ArrayLike) -> Floats:
        """Values with these derivatives: along u on the first line, then along v."""
        one, two = self.sums
        first = np.einsum("ai,i...->a...", one, along_u[:, 0])
        return np.asarray(start + first[:, None] + np.einsum("bj,ij...->ib...", two, along_v))


@checked
def smooth_ribaucour(
    surface: Surface,
    u: ArrayLike,
    v: ArrayLike,
    start: ArrayLike,
    rates: tuple[Rate, Rate],
) -> ChebyshevSurface:
    """A Ribaucour transform of a smooth surface, a surface again: transforms may follow each other.

    Parameters
    ----------
    surface : vectorised parametrisation by lines of curvature
    u, v : increasing; the transform is made over u[0] to u[-1], v[0] to v[-1]
    start : (3,) transform of the point at (u[0], v[0])
    rates : a along u at v[0] and b along v at u[0], numbers or functions, [1 / length]; a = b = 0
        is a reflection, equal constants are an inversion and a reflection

    Raises
    ------
    InputError
        A start that is not three finite numbers; parameter lines that are no lines of curvature.
    DegenerateError
        A start on the surface; a surface or a transform that polynomials do not resolve (a point
        of it runs away); names the place.

    Source: Bobenko, Suris, 1.5; Eisenhart, Transformations of surfaces, ch. 5.
    """
    p, q = increasing(u, "u"), increasing(v, "v")
    first = np.asarray(start, dtype=np.float64)
    if first.shape != (3,) or not np.isfinite(first).all():
        raise InputError(f"start has shape {first.shape}: three finite numbers are needed")
    domain = (float(p[0]), float(p[-1]), float(q[0]), float(q[-1]))
    grid = _Grid(domain, _NODES)
    x = np.asarray(ChebyshevSurface.of(surface, domain)(*grid.at))
    x_u, x_v = grid.derivatives(x)
    a, b = _combescure(grid, x_u, x_v, rates)
    away = x[0, 0] - first
    length = float(np.linalg.norm(away))
    if length <= RELATIVE_DEGENERATE * extent(np.stack([first, x[0, 0], 0 * first])):
        raise DegenerateError("the start lies on the surface: the transform has no direction there")
    axis = grid.potential(a[..., None] * x_u, b[..., None] * x_v, away / length)
    slopes = [np.einsum("...i,...i->...", axis, way) for way in (x_u, x_v)]
    phi = grid.potential(slopes[0], slopes[1], 0.5 * length)
    square = np.einsum("...i,...i->...", axis, axis)
    worst = np.unravel_index(square.argmin(), square.shape)
    if square[worst] < RELATIVE_DEGENERATE * square.max():
        i, j = worst
        raise DegenerateError(
            f"the transform runs away at u = {grid.at[0][i, j]:.4g}, v = {grid.at[1][i, j]:.4g}"
        )
    made = x - (2 * phi / square)[..., None] * axis
    return ChebyshevSurface.of(lambda *at: made, domain)


def _combescure(
    grid: _Grid, x_u: Floats, x_v: Floats, rates: Sequence[Rate]
) -> tuple[Floats, Floats]:
    """a, b at the nodes: a_v = (b - a) (log |x_u|)_v, b_u = (a - b) (log |x_v|)_u."""
    n, (along_u, along_v) = grid.count, grid.slopes
    lengths = [np.linalg.norm(way, axis=-1) for way in (x_u, x_v)]
    size = max(length.max() for length in lengths)
    for length in lengths:
        if not (length > RELATIVE_DEGENERATE * size).all():
            i, j = np.argwhere(~(length > RELATIVE_DEGENERATE * size))[0]
            raise DegenerateError(
                f"a parameter line stands still at u = {grid.at[0][i, j]:.4g}, "
                f"v = {grid.at[1][i, j]:.4g}"
            )
    normal = np.cross(x_u, x_v)
    mixed = grid.derivatives(x_u)[1]
    twist = np.abs(np.einsum("...i,...i->...", mixed, normal)) / (lengths[0] * lengths[1] * size)
    cosine = np.abs(np.einsum("...i,...i->...", x_u, x_v)) / (lengths[0] * lengths[1])
    bad = np.maximum(twist, cosine)
    if bad.max() > _CURVATURE:
        i, j = np.unravel_index(bad.argmax(), bad.shape)
        raise InputError(
            f"parameter lines are no lines of curvature at u = {grid.at[0][i, j]:.4g}, "
            f"v = {grid.at[1][i, j]:.4g}: cosine of their angle {cosine[i, j]:.2g}, twist "
            f"{twist[i, j]:.2g} (limit {_CURVATURE:g})"
        )
    turn_a = grid.derivatives(np.log(lengths[0]))[1].ravel()
    turn_b = grid.derivatives(np.log(lengths[1]))[0].ravel()
    one = np.eye(n)
    in_v, in_u = np.kron(one, along_v), np.kron(along_u, one)
    system = np.block(
        [
            [in_v + np.diag(turn_a), -np.diag(turn_a)],
            [-np.diag(turn_b), in_u + np.diag(turn_b)],
        ]
    )
    right = np.zeros(2 * n * n)
    edge_u, edge_v = np.arange(n) * n, n * n + np.arange(n)  # nodes at v[0], and at u[0]
    for rows, rate, at in zip((edge_u, edge_v), rates, grid.lines, strict=True):
        system[rows] = np.eye(2 * n * n)[rows]
        right[rows] = rate(at) if callable(rate) else rate
    if not np.isfinite(right).all():
        raise InputError("a rate is not finite on the first lines")
    a, b = np.linalg.solve(system, right).reshape(2, n, n)
    return a, b

"""Moebius transformations: inversions, which keep circles, spheres and so circular nets."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked, finite_together, of_shape
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats
from ddgfab.tolerances import COORDINATE_LIMIT, RELATIVE_DEGENERATE, UNIT_NORMAL

SAME_CENTER: Final = 8.0 * float(np.finfo(np.float64).eps)
"""Centers of two inversions are one point when they differ by less than this part of their
coordinates: by rounding alone."""

NEAR_CENTER: Final = 1e-2
"""Inversions whose centers are nearer than this part of the greater radius are applied one after
the other: as one map x -> A J(x - p) + b they would lose the digits of radius / distance."""


@checked
def invert(points: ArrayLike, center: ArrayLike, radius: float) -> Floats:
    """(..., 3) images of points in the inversion x -> c + R^2 (x - c) / |x - c|^2.

    Orientation is reversed. Lengths at x are multiplied by R^2 / |x - c|^2.

    Raises
    ------
    InputError
        Other than three coordinates, or a radius that is not finite.
    DegenerateError
        A point in the center; names its index.

    Examples
    --------
    >>> invert([2.0, 0.0, 0.0], [0.0, 0.0, 0.0], 1.0)
    array([0.5, 0. , 0. ])
    """
    x, c = _in_space(points, "points"), of_shape(center, (3,), "center")
    if not abs(radius) < COORDINATE_LIMIT:
        raise InputError(f"radius is {radius:g}; a finite number is needed")
    away = x - c
    square = np.sum(away * away, axis=-1, keepdims=True)
    _refuse_center(square[..., 0], radius)
    return np.asarray(c + radius**2 * away / square)


def _in_space(points: ArrayLike, name: str) -> Floats:
    x = np.asarray(points, dtype=np.float64)
    if not x.ndim or x.shape[-1] != 3:
        raise InputError(f"{name} have shape {x.shape}; (..., 3) is needed")
    return x


def _refuse_center(square: Floats, radius: float) -> None:
    """Refuse squared distances from the center of an inversion that are none."""
    at = np.argwhere(square <= (RELATIVE_DEGENERATE * radius) ** 2)
    if len(at):
        index = tuple(at[0].tolist())
        raise DegenerateError(
            f"point {index} lies in the center of the inversion: distance "
            f"{float(np.sqrt(square[index])):.3g}, limit {RELATIVE_DEGENERATE * radius:.3g}"
        )


@checked
def invert_normals(points: ArrayLike, normals: ArrayLike, center: ArrayLike) -> Floats:
    """(..., 3) unit normals at the images of points: reflected in the plane across x - c.

    Contact elements go to contact elements, so normals by reflection (`circular.vertex_normals`)
    stay such. The side is kept: a normal away from the center becomes one towards it.
    """
    away = _in_space(points, "points") - of_shape(center, (3,), "center")
    _refuse_center(np.sum(away * away, axis=-1), 0.0)
    n = finite_together(points=away, normals=normals)[1]
    along = np.sum(n * away, axis=-1, keepdims=True) / np.sum(away * away, axis=-1, keepdims=True)
    return np.asarray(n - 2.0 * along * away)


@dataclass(frozen=True, eq=False, repr=False)
class Moebius:
    """A Moebius transformation of space: x -> A x + b, or x -> A J(x - p) + b, J(y) = y / |y|^2.

    Make one with `similarity`, `inversion` or `reflection`, and compose with `@`: (f @ g)(x) is
    f(g(x)). Circles and spheres (lines and planes among them) go to such, angles are kept, real
    parts of cross-ratios too, and so circular nets go to circular nets; planar faces in general
    are not kept. Points are measured from the pole, so that images are as exact as their
    distances from it, at every scale.

    Attributes
    ----------
    matrix : (3, 3) A, an orthogonal matrix times a positive factor
    shift : (3,) b
    pole : (3,) p, the point that goes to infinity, or None where that stays
    before : the map that is applied first where the two as one would lose digits (`NEAR_CENTER`),
        else None; matrix, shift and pole belong to the map after it

    Source: Bobenko, Suris, Discrete Differential Geometry, 3.1 and appendix; Liouville 1850.
    """

    matrix: Floats
    shift: Floats
    pole: Floats | None = None
    before: Moebius | None = None

    @staticmethod
    @checked
    def similarity(
        rotation: ArrayLike | None = None, scale: float = 1.0, shift: ArrayLike = (0.0, 0.0, 0.0)
    ) -> Moebius:
        """x -> scale R x + shift, with R orthogonal (the identity by default).

        Raises
        ------
        InputError
            A matrix that is not orthogonal, or a scale that is not positive.
        """
        turn = np.eye(3) if rotation is None else np.array(rotation, dtype=np.float64)
        off = np.inf if turn.shape != (3, 3) else float(np.abs(turn @ turn.T - np.eye(3)).max())
        if not off <= UNIT_NORMAL:
            raise InputError(f"the rotation is off an orthogonal 3 x 3 matrix by {off:.1e}")
        if not 0 < scale < np.inf:
            raise InputError(f"scale {scale}: a positive number is needed")
        return Moebius(scale * turn, np.array(shift, dtype=np.float64))

    @staticmethod
    @checked
    def inversion(center: ArrayLike, radius: float) -> Moebius:
        """Inversion in a sphere (see `invert`).

        Raises
        ------
        InputError
            A radius that is not positive.
        """
        if not 0 < radius < np.inf:
            raise InputError(f"radius {radius}: a positive number is needed")
        c = np.array(center, dtype=np.float64)
        return Moebius(radius**2 * np.eye(3), c, c)

    @staticmethod
    @checked
    def reflection(point: ArrayLike, normal: ArrayLike) -> Moebius:
        """Reflection in the plane through a point across a normal of any length.

        Raises
        ------
        InputError
            A normal of length zero.
        """
        n = np.array(normal, dtype=np.float64)
        square = float(n @ n)
        if not 0 < square < np.inf:
            raise InputError("the normal of a plane needs a length")
        mirror = np.eye(3) - 2.0 * np.outer(n, n) / square
        height = float(n @ np.asarray(point, dtype=np.float64))
        return Moebius(mirror, 2.0 * height / square * n)

    @property
    def square(self) -> float:
        """The squared factor a^2 of A = a R."""
        return float(np.sum(self.matrix**2)) / 3.0

    @property
    def _radius(self) -> float:
        """Radius of the sphere of an inversion, sqrt(a)."""
        return float(self.square**0.25)

    @checked
    def __call__(self, points: ArrayLike) -> Floats:
        """(..., 3) images of points.

        Raises
        ------
        DegenerateError
            A point in the pole (nearer than `RELATIVE_DEGENERATE` radii); names its index.
        """
        x = np.asarray(points, dtype=np.float64)
        if self.before is not None:
            x = self.before(x)
        if self.pole is not None:
            x = x - self.pole
            square = np.sum(x * x, axis=-1, keepdims=True)
            _refuse_center(square[..., 0], self._radius)
            x = x / square
        return np.asarray(x @ self.matrix.T + self.shift)

    @checked
    def normals(self, points: ArrayLike, normals: ArrayLike) -> Floats:
        """(..., 3) unit normals at the images of points, carried along with the surface."""
        n = np.asarray(normals, dtype=np.float64)
        if self.before is not None:
            n, points = self.before.normals(points, n), self.before(points)
        if self.pole is not None:
            n = invert_normals(points, n, self.pole)
        return np.asarray(n @ self.matrix.T / np.sqrt(self.square))

    def inverse(self) -> Moebius:
        """The transformation back."""
        if self.before is not None:
            return self.before.inverse() @ replace(self, before=None).inverse()
        if self.pole is None:
            back = self.matrix.T / self.square
            return Moebius(back, -back @ self.shift)
        return Moebius(self.matrix.T, self.pole, self.shift)

    def __matmul__(self, first: Moebius) -> Moebius:
        """The composition x -> self(first(x))."""
        if self.before is not None:
            return replace(self, before=None) @ (self.before @ first)
        one = self._after(first)
        if one is None:
            return replace(self, before=first)
        return one if first.before is None else one @ first.before

    def _after(self, first: Moebius) -> Moebius | None:
        """The composition of two single maps as one, or None where that would lose digits."""
        if self.pole is None:
            shift = self.matrix @ first.shift + self.shift
            return Moebius(self.matrix @ first.matrix, shift, first.pole)
        away = first.shift - self.pole
        if first.pole is None:
            # J(A x + e) = A / a^2 J(x + A^-1 e), as J(A y) = A / a^2 J(y).
            pole = -first.matrix.T @ away / first.square
            return Moebius(self.matrix @ first.matrix / first.square, self.shift, pole)
        distance = float(np.linalg.norm(away))
        if distance <= SAME_CENTER * float(np.linalg.norm(self.pole)):
            # The pole of one is where infinity went: J(A J(y)) = A y / a^2.
            matrix = self.matrix @ first.matrix / first.square
            return Moebius(matrix, self.shift - matrix @ first.pole)
        if distance <= NEAR_CENTER * max(self._radius, first._radius):
            return None
        # J(J(w) + e) = J(e) + H J(w + J(e)) / |e|^2 with H the reflection across e.
        over = away / distance**2
        mirror = np.eye(3) - 2.0 * np.outer(away, over)
        return Moebius(
            self.matrix @ mirror @ first.matrix / distance**2,
            self.matrix @ over + self.shift,
            first.pole - first.matrix.T @ over,
        )

    def __repr__(self) -> str:
        factor = np.sqrt(self.square)
        own = (
            f"similarity, scale {factor:.6g}"
            if self.pole is None
            else f"pole {self.pole.tolist()}, power {factor:.6g}"
        )
        return f"Moebius({own})" + ("" if self.before is None else f" @ {self.before!r}")

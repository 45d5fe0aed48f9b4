"""One quad of a K-net: the skew parallelogram, its half-turn, twists and scale.

Source: Wunderlich 1951; Bobenko, Suris, Discrete Differential Geometry, 4.2; mathematics.md 3.6.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats
from ddgfab.quads import finite
from ddgfab.tolerances import NET_INPUT, RELATIVE_DEGENERATE


@dataclass(frozen=True, eq=False, repr=False)
class SkewParallelogram:
    """A quad (x, x_1, x_12, x_2) with equal opposite sides. Make one with `skew_parallelogram`.

    Attributes
    ----------
    corners : (4, 3) x, x_1, x_12, x_2 in cyclic order
    center, axis : (3,) a point and the unit direction of the axis of its half-turn
    planar : whether it is a parallelogram in a plane
    """

    corners: Floats
    center: Floats
    axis: Floats
    planar: bool

    @property
    def sides(self) -> tuple[float, float]:
        """Lengths of x x_1 and of x x_2."""
        x, x1, _, x2 = self.corners
        return float(np.linalg.norm(x1 - x)), float(np.linalg.norm(x2 - x))

    def half_turn(self, points: ArrayLike) -> Floats:
        """(..., 3) points after the half-turn, which exchanges x with x_12 and x_1 with x_2."""
        p = np.asarray(points, dtype=np.float64) - self.center
        return np.asarray(self.center + 2.0 * (p @ self.axis)[..., None] * self.axis - p)

    def normals(self) -> Floats:
        """(4, 3) unit normals of the planes of the two sides at each corner, in order.

        The half-turn exchanges them up to sign; the signs are those of the cyclic order, so that
        for a convex planar quad they agree.
        """
        ahead = np.roll(self.corners, -1, axis=0) - self.corners
        back = np.roll(self.corners, 1, axis=0) - self.corners
        n = np.cross(ahead, back)
        length = np.linalg.norm(n, axis=1)
        flat = length <= RELATIVE_DEGENERATE * self.sides[0] * self.sides[1]
        if flat.any():
            corner = int(np.argmax(flat))
            raise DegenerateError(
                f"the sides at corner {corner} (of x, x_1, x_12, x_2) lie on a line: no normal",
                cell=(corner,),
            )
        return np.asarray(n / length[:, None])

    def twists(self) -> Floats:
        """(4,) signed twists of the normals about the sides x x_1, x_1 x_12, x_12 x_2, x_2 x [rad].

        Opposite ones are equal, neighbours of opposite sign; zero for a planar quad.
        """
        n = self.normals()
        e = np.roll(self.corners, -1, axis=0) - self.corners
        e = e / np.linalg.norm(e, axis=1)[:, None]
        after = np.roll(n, -1, axis=0)
        sine = np.einsum("ij,ij->i", np.cross(n, after), e)
        return np.asarray(np.arctan2(sine, np.einsum("ij,ij->i", n, after)))

    def scale(self) -> float:
        """r = side / sin(twist), the same for both sides.

        Raises
        ------
        DegenerateError
            A planar quad (r is infinite), sides on a line.
        """
        if self.planar:
            raise DegenerateError("a planar parallelogram has no twist, so no scale r")
        return float(self.sides[0] / np.abs(np.sin(self.twists()[0])))


@checked
def skew_parallelogram(
    x: ArrayLike, x1: ArrayLike, x2: ArrayLike, x12: ArrayLike, *, tolerance: float = NET_INPUT
) -> SkewParallelogram:
    """The half-turn of a quad with equal opposite sides.

    Its axis joins the middles of the diagonals; that of a planar parallelogram, whose diagonals
    halve each other, is normal to its plane.

    Parameters
    ----------
    x, x1, x2, x12 : (3,)
    tolerance : on the difference of opposite sides, relative, and on what counts as planar; six
        digits in a file need about 1e-5

    Raises
    ------
    InputError
        Opposite sides that differ; names them and their lengths.
    DegenerateError
        A side of no length, all corners on a line, or an antiparallelogram in a plane: two of its
        sides cross, and it belongs to no K-net.

    Source: mathematics.md 3.6 (Lemma 3.1).
    """
    given = [np.asarray(p, dtype=np.float64) for p in (x, x1, x12, x2)]
    shapes = ", ".join(str(p.shape) for p in given)
    if {p.shape for p in given} != {(3,)}:
        raise InputError(f"four points (3,) are needed; x, x_1, x_12, x_2 have shapes {shapes}")
    corners = np.array(given)
    finite(corners, "corner")
    sides = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1)
    names = ("x x_1", "x_1 x_12", "x_12 x_2", "x_2 x")
    if sides.min() <= RELATIVE_DEGENERATE * sides.max():
        raise DegenerateError(f"side {names[int(sides.argmin())]} has no length: {sides.min():.3g}")
    for k in (0, 1):
        if abs(sides[k] - sides[k + 2]) > tolerance * sides[k]:
            raise InputError(
                f"no skew parallelogram: sides {names[k]} and {names[k + 2]} are {sides[k]:.9g} "
                f"and {sides[k + 2]:.9g} long (limit {tolerance:g} of the length)"
            )
    first, second = 0.5 * (corners[0] + corners[2]), 0.5 * (corners[1] + corners[3])
    diagonals = corners[2] - corners[0], corners[3] - corners[1]
    size = float(sides.max())
    volume = abs(float(np.linalg.det(np.stack([*diagonals, corners[1] - corners[0]]))))
    planar = volume <= tolerance * size**3
    axis = second - first
    if planar:
        if float(np.linalg.norm(axis)) > tolerance * size:
            raise DegenerateError(
                "the quad is a planar antiparallelogram (two of its sides cross) and belongs to no "
                f"K-net: volume of its diagonals {volume:.3g}, limit {tolerance * size**3:.3g}"
            )
        axis = np.cross(*diagonals)
        if not float(np.linalg.norm(axis)) > tolerance * size**2:
            raise DegenerateError("all four corners of the quad lie on a line: no half-turn axis")
    return SkewParallelogram(
        corners, 0.5 * (first + second), axis / np.linalg.norm(axis), bool(planar)
    )

"""K-nets: A-nets whose edges depend on one index only; discrete surfaces of constant curvature.

Kept is the unit Lelieuvre field m, a spherical T-net: Delta_k x = r m_k x m in every direction
alike. Normals are derived from it: n = (-1)^u_0 m, for which Delta_0 x = r n x n_0,
Delta_k x = -r n x n_k. Source: Bobenko, Suris, Discrete Differential Geometry, 4.2; Wunderlich
1951; Bobenko, Pinkall 1996; mathematics.md 3.4, 3.5.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats
from ddgfab.nets.asymptotic import integrate, lelieuvre_edges
from ddgfab.nets.knet.oriented import modulo, oriented_angle, refuse_angles
from ddgfab.nets.knet.spherical import evolve_spherical
from ddgfab.quads import finite
from ddgfab.tolerances import RELATIVE_DEGENERATE

if TYPE_CHECKING:
    from ddgfab.net import Net


@dataclass(frozen=True, eq=False, repr=False)
class CauchyData:
    """What determines a K-net: normal angles, turns, corner angles, scale and place.

    Attributes
    ----------
    deltas : per direction k, (n_k - 1,) angles of consecutive normals [rad], in (0, pi)
    turns : per direction k, (n_k - 2,) deviation angles of consecutive edges about the normal
        between them [rad]
    corner_angles : (d - 1,) angles at the first point from the edge of direction 0 to those of
        directions 1, ..., d - 1, about the normal [rad]
    r : scale; edges of normal angle delta have length r sin(delta)
    origin, normal, edge : (3,) first point, its normal, and a direction whose part perpendicular
        to the normal is that of the first edge of direction 0
    """

    deltas: tuple[Floats, ...]
    turns: tuple[Floats, ...]
    corner_angles: Floats
    r: float
    origin: Floats
    normal: Floats
    edge: Floats

    def build(self) -> KNet:
        """The K-net of the data; see `knet`."""
        return knet(
            self.deltas,
            self.turns,
            self.corner_angles,
            r=self.r,
            origin=self.origin,
            normal=self.normal,
            edge=self.edge,
        )


@dataclass(frozen=True, eq=False, repr=False)
class KNet:
    """A K-net in d > 1 directions. Make one with `knet` or a function that returns one.

    Attributes
    ----------
    points : (n1, ..., nd, 3)
    m : (n1, ..., nd, 3) unit Lelieuvre field: points differ by r m_k x m
    r : scale: |Delta_k x| = r sin(delta_k)
    deltas : per direction, (n_k - 1,) angles between consecutive `normals` [rad]; depend on u_k
        only
    """

    points: Floats
    m: Floats
    r: float
    deltas: tuple[Floats, ...]

    @property
    def d(self) -> int:
        """Number of directions."""
        return self.m.ndim - 1

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of points in each direction."""
        return self.m.shape[:-1]

    @property
    def normals(self) -> Floats:
        """(n1, ..., nd, 3) unit normals n = (-1)^u_0 m, for which <n, n_k> = cos(delta_k).

        In every quad of direction 0 and another, n_0k is n after a half-turn about n_0 + n_k: such
        quads are uncrossed when the deltas are small. No gauge does so for three directions at
        once: in quads of two directions k, l > 0, n_kl is n reflected in the bisector of n_k, n_l
        (small deltas give crossed quads; a third direction with deltas about pi / 2, as Baecklund
        transforms have, looks alike from either gauge).
        """
        signs = (-1.0) ** np.arange(self.m.shape[0])
        return np.asarray(self.m * signs.reshape(-1, *(1,) * self.d))

    def __repr__(self) -> str:
        size = " x ".join(map(str, self.shape))
        return f"KNet({size} points, r = {self.r:g})"

    def to_net(self) -> Net:
        """The points as a `Net`, all directions open."""
        # ddgfab.net makes meshes by ddgfab.grid, and so imports this package first.
        from ddgfab.net import Net

        return Net.build(self.points)

    def cauchy(self) -> CauchyData:
        """The data on the axes, from which `CauchyData.build` makes the same net again.

        Turns and angles are measured in the points and normals of the axes.
        """
        n, d = self.normals, self.d
        lines = [tuple(slice(None) if a == k else 0 for a in range(d)) for k in range(d)]
        origin = (0,) * d
        edges = [np.diff(self.points[line], axis=0) for line in lines]
        if min(map(len, edges)) < 1:
            raise InputError(f"{self!r}: a direction without edges has no Cauchy data")
        turns = tuple(
            oriented_angle(n[line][1:-1], e[:-1], e[1:])
            for line, e in zip(lines, edges, strict=True)
        )
        first = [e[0] for e in edges]
        corners = [float(oriented_angle(n[origin], first[0], e)) for e in first[1:]]
        return CauchyData(
            self.deltas, turns, np.array(corners), self.r, self.points[origin], n[origin], first[0]
        )

    def residuals(self) -> dict[str, float]:
        """Greatest violation of every defining condition, relative to local edges.

        Source: mathematics.md 3.5.

        Returns
        -------
        unit : ||m| - 1|
        lelieuvre : |Delta_k x - r m_k x m| / |Delta_k x|, so every face closes
        moutard : the part of m_ij - m across m_j - m_i, over |m_ij - m| + |m_j - m_i|
        length : |Delta_k x| / (r sin(delta_k)) - 1
        angle : |<n, n_k> - cos(delta_k)|
        tangent : |<n, e>| of unit edges e at both ends
        twist : twist of normals about the edge from +delta (direction 0), -delta (others) [rad]
        """
        n = self.normals
        length = np.sqrt(np.einsum("...i,...i->...", self.m, self.m))
        out = dict.fromkeys(
            ("unit", "lelieuvre", "moutard", "length", "angle", "tangent", "twist"), 0.0
        )

        def worst(name: str, values: Floats) -> None:
            out[name] = max(out[name], float(np.abs(values).max(initial=0.0)))

        worst("unit", length - 1.0)
        for k in range(self.d):
            wide = self.deltas[k].reshape(-1, *(1,) * (self.d - k - 1))
            before = (slice(None),) * k
            start, end = n[(*before, slice(None, -1))], n[(*before, slice(1, None))]
            edges = np.diff(self.points, axis=k)
            size = np.sqrt(np.einsum("...i,...i->...", edges, edges))
            gap = edges - self.r * lelieuvre_edges(self.m, k)
            worst("lelieuvre", np.sqrt(np.einsum("...i,...i->...", gap, gap)) / size)
            worst("length", size / (abs(self.r) * np.sin(wide)) - 1.0)
            cosine = np.einsum("...i,...i->...", start, end)
            worst("angle", cosine - np.cos(wide))
            for normal in (start, end):
                worst("tangent", np.einsum("...i,...i->...", normal, edges) / size)
            sine = np.einsum("...i,...i->...", np.cross(start, end), edges) / size
            twist = np.arctan2(sine, cosine) - (wide if k == 0 else -wide)
            worst("twist", modulo(twist))
            for other in range(k + 1, self.d):
                worst("moutard", _moutard_gap(self.m, k, other))
        return out


def _moutard_gap(m: Floats, i: int, j: int) -> Floats:
    """Part of m_ij - m across m_j - m_i, relative to both."""
    y = np.moveaxis(m, (i, j), (0, 1))
    long, short = y[1:, 1:] - y[:-1, :-1], y[:-1, 1:] - y[1:, :-1]
    across = np.cross(long, short)
    size = np.sqrt(np.einsum("...i,...i->...", short, short))
    total = size + np.sqrt(np.einsum("...i,...i->...", long, long))
    return np.asarray(np.sqrt(np.einsum("...i,...i->...", across, across)) / (size * total))


@checked
def knet(
    deltas: Sequence[ArrayLike],
    turns: Sequence[ArrayLike],
    corner_angles: ArrayLike,
    *,
    r: float = 1.0,
    origin: ArrayLike = (0.0, 0.0, 0.0),
    normal: ArrayLike = (0.0, 0.0, 1.0),
    edge: ArrayLike = (1.0, 0.0, 0.0),
) -> KNet:
    """K-net from Cauchy data along its d > 1 axes, all of which may be chosen freely.

    Parameters
    ----------
    deltas : d arrays (n_k - 1,), angles between consecutive normals [rad], in (0, pi); the edge
        has length r sin(delta)
    turns : d arrays (n_k - 2,), angle from each edge of an axis to the next about the normal
        between them [rad]; 0 goes straight on
    corner_angles : (d - 1,) or a number for d = 2: angle at the first point from the edge of
        direction 0 to the edge of direction k about the normal [rad]
    r : scale, positive
    origin, normal, edge : (3,) first point, its normal, and the direction of the first edge of
        direction 0, of which the part perpendicular to the normal counts

    Raises
    ------
    InputError
        Numbers of arrays or entries that do not fit, a delta outside (0, pi) (an edge of no
        length), entries that are not finite, a scale that is not positive; names direction, index
        and value.
    DegenerateError
        n_1 = -n_2 in a quad; names the cell.

    Source: mathematics.md 3.5 (Theorem 3.2), by the half-turns of 3.4.
    """
    angles, bends, corners = _checked(deltas, turns, corner_angles)
    if not 0 < r < np.inf:
        raise InputError(f"r = {r}: the scale of a K-net is a positive number")
    start, n, e = _frame(origin, normal, edge)
    across = np.cross(n, e)
    axes = []
    for k, (delta, turn) in enumerate(zip(angles, bends, strict=True)):
        way = 0.0 if k == 0 else float(corners[k - 1])
        direction = np.cos(way) * e + np.sin(way) * across
        # Edges are n x t in direction 0 and -n x t in the others, for the normals' tangent t.
        tangent = np.cross(direction, n) * (1.0 if k == 0 else -1.0)
        axis = _walk(n, tangent, delta, turn)
        if k == 0:
            axis[1::2] *= -1.0
        axes.append(axis)
    m = evolve_spherical(axes)
    return KNet(integrate(m, r, start), m, float(r), angles)


def _checked(
    deltas: Sequence[ArrayLike], turns: Sequence[ArrayLike], corner_angles: ArrayLike
) -> tuple[tuple[Floats, ...], tuple[Floats, ...], Floats]:
    """Cauchy data as arrays of fitting sizes and ranges."""
    angles = tuple(np.array(a, dtype=np.float64) for a in deltas)
    bends = tuple(np.array(a, dtype=np.float64) for a in turns)
    corners = np.atleast_1d(np.array(corner_angles, dtype=np.float64))
    d = len(angles)
    if d < 2 or len(bends) != d:
        raise InputError(
            f"deltas of {d} directions and turns of {len(bends)}: two or more of each are needed"
        )
    if corners.shape != (d - 1,):
        raise InputError(f"{d} directions need {d - 1} corner angles; these have {corners.shape}")
    finite(corners, "corner angles")
    for k, (delta, turn) in enumerate(zip(angles, bends, strict=True)):
        if delta.ndim != 1 or not len(delta) or turn.shape != (len(delta) - 1,):
            raise InputError(
                f"direction {k}: deltas of shape {delta.shape} and turns of shape {turn.shape}; "
                "n > 0 deltas need n - 1 turns"
            )
        finite(delta, f"deltas of direction {k}")
        finite(turn, f"turns of direction {k}")
        refuse_angles(delta, f"delta {{}} of direction {k}")
    return angles, bends, corners


def _frame(origin: ArrayLike, normal: ArrayLike, edge: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """First point, unit normal, unit edge direction perpendicular to it."""
    given = []
    for name, vector in (("origin", origin), ("normal", normal), ("edge", edge)):
        v = np.array(vector, dtype=np.float64)
        if v.shape != (3,):
            raise InputError(f"{name} has shape {v.shape}; (3,) is needed")
        finite(v, name)
        given.append(v)
    start, n, e = given
    length = float(np.linalg.norm(n))
    if length == 0:
        raise InputError("the normal has no length")
    n = n / length
    size = float(np.linalg.norm(e))
    e = e - (e @ n) * n
    across = float(np.linalg.norm(e))
    if not across > RELATIVE_DEGENERATE * size:
        raise DegenerateError("the first edge is parallel to the normal")
    e = e / across
    e = e - (e @ n) * n
    return start, n, e / np.linalg.norm(e)


def _walk(n: Floats, tangent: Floats, deltas: Floats, turns: Floats) -> Floats:
    """(len(deltas) + 1, 3) unit normals along an axis; mathematics.md 3.5."""
    out = np.empty((len(deltas) + 1, 3))
    out[0] = n
    t, b = tangent, np.cross(n, tangent)
    for i, (c, s) in enumerate(zip(np.cos(deltas), np.sin(deltas), strict=True)):
        n, t = c * n + s * t, c * t - s * n
        # Rounding makes the frame grow at random; the direction of n is what counts.
        n /= np.sqrt(n @ n)
        out[i + 1] = n
        if i < len(turns):
            c, s = np.cos(turns[i]), np.sin(turns[i])
            t, b = c * t + s * b, c * b - s * t
    return out

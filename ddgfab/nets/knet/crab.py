"""Rotational K-nets: crab nets, with N points on every ring, and their equilibrium as string nets.

Ring k has its points and normals at the azimuths (2 s + k) pi / N; points of neighbouring rings
half a step apart are joined, by edges that all have one length and, up to hand, one twist.
Source: mathematics.md 3.13; Wunderlich 1951.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.nets.knet.dini_net import of_normals
from ddgfab.nets.knet.net import KNet
from ddgfab.nets.knet.oriented import refuse_angles
from ddgfab.quads import finite, whole
from ddgfab.tolerances import RELATIVE_DEGENERATE


@dataclass(frozen=True, eq=False, repr=False)
class CrabNet:
    """A closed rotational K-net with N points on each of K rings. Make one with `crab_net`.

    Attributes
    ----------
    n_fold : N
    delta : normal angle of all edges [rad]; their length is r sin(delta)
    r : scale
    thetas : (K,) angles of the normals with the z-axis [rad]; not folded into (0, pi)
    radii : (K,) signed radii; a negative one puts the points on the other side of the axis
    heights : (K,) z, the first 0
    points, normals : (K, N, 3)
    """

    n_fold: int
    delta: float
    r: float
    thetas: Floats
    radii: Floats
    heights: Floats
    points: Floats
    normals: Floats

    @property
    def rings(self) -> int:
        """Number of rings."""
        return len(self.thetas)

    @property
    def edge_length(self) -> float:
        """Length of every edge."""
        return float(self.r * np.sin(self.delta))

    @property
    def cone_rings(self) -> Ints:
        """Rings at which the net comes to or has passed through a cone point.

        The radius is zero there, or has another sign than on the ring before.
        """
        small = np.abs(self.radii) <= RELATIVE_DEGENERATE * self.r
        passed = np.sign(self.radii[1:]) * np.sign(self.radii[:-1]) < 0
        return np.flatnonzero(small | np.concatenate([[False], passed]))

    def __repr__(self) -> str:
        cone = f", cone points at rings {self.cone_rings.tolist()}" if len(self.cone_rings) else ""
        return f"CrabNet({self.rings} rings of {self.n_fold} points, r = {self.r:g}{cone})"

    def edges(self) -> tuple[Ints, Ints]:
        """Point ids (k N + s) of the edges up and forward, and up and backward: (K - 1, N, 2) each.

        The twist of the normals along them is of opposite hand.
        """
        ids = np.arange(self.rings * self.n_fold).reshape(self.rings, self.n_fold)
        return (
            np.stack([ids[:-1], ids[1:]], axis=-1),
            np.stack([ids[:-1], np.roll(ids[1:], 1, axis=1)], axis=-1),
        )

    def faces(self) -> Ints:
        """((K - 2) N, 4) point ids of the quads, each of three rings."""
        ids = np.arange(self.rings * self.n_fold).reshape(self.rings, self.n_fold)
        low, middle, top = ids[:-2], ids[1:-1], np.roll(ids[2:], 1, axis=1)
        return np.stack([low, middle, top, np.roll(middle, 1, axis=1)], axis=-1).reshape(-1, 4)

    def mesh(self) -> Mesh:
        """Mesh of the quads, with the points k N + s.

        Raises
        ------
        InputError
            Fewer than three rings have no quads; a cone point of radius zero cannot be a vertex of
            a manifold.
        """
        if self.rings < 3:
            raise InputError(f"{self!r} has no quads; three rings are needed")
        small = np.flatnonzero(np.abs(self.radii) <= RELATIVE_DEGENERATE * self.r)
        if len(small):
            raise InputError(
                f"ring {small[0]} has radius {self.radii[small[0]]:g}: its points are one, a cone "
                "point; take fewer rings or another theta0"
            )
        return Mesh.build(self.points.reshape(-1, 3), self.faces())

    def patch(self, cells: tuple[int, int], ring: int = 0, place: int = 0) -> KNet:
        """The (M + 1) x (N + 1) points from one point upwards, as a K-net.

        Direction 0 is up and forward, direction 1 up and backward. A long patch wraps around the
        axis.

        Raises
        ------
        InputError
            More cells than there are rings above the first point.
        """
        if min(cells) < 1 or ring < 0 or ring + sum(cells) >= self.rings:
            raise InputError(
                f"a patch of {tuple(cells)} cells from ring {ring} needs ring {ring + sum(cells)}; "
                f"there are {self.rings}"
            )
        i, j = np.meshgrid(np.arange(cells[0] + 1), np.arange(cells[1] + 1), indexing="ij")
        k = ring + i + j
        at = (place - j) % self.n_fold
        deltas = tuple(np.full(n, self.delta) for n in cells)
        return of_normals(self.points[k, at], self.normals[k, at], self.r, deltas)


@checked
def crab_net(n_fold: int, delta: float, theta0: float, rings: int, *, r: float = 1.0) -> CrabNet:
    """Rotational K-net from the normal angle of its edges and the normals of its first ring.

    Parameters
    ----------
    n_fold : N > 2, points on a ring; neighbouring rings are turned by pi / N
    delta : normal angle of all edges [rad], in (0, pi)
    theta0 : angle of the normals of ring 0 with the z-axis [rad]
    rings : K > 1
    r : scale, positive: edges have length r sin(delta)

    Raises
    ------
    InputError
        A number outside these limits.
    DegenerateError
        No angle of the second ring: the normals of ring 0 are too near to each other for a turn by
        pi / N to be reached within delta; gives the value and the limit.

    Source: mathematics.md 3.13.
    """
    n_fold, rings = whole(n_fold, 3, "n_fold"), whole(rings, 2, "rings")
    refuse_angles(np.array([delta]), "delta {}")
    if not np.isfinite(theta0):
        raise InputError(f"theta0 = {theta0}: a finite angle is needed")
    if not 0 < r < np.inf:
        raise InputError(f"r = {r}: the scale of a K-net is a positive number")
    gamma = np.pi / n_fold
    thetas = np.empty(rings)
    thetas[0], thetas[1] = theta0, _second(theta0, delta, gamma)
    for k in range(1, rings - 1):
        turn = np.arctan2(np.cos(gamma) * np.sin(thetas[k]), np.cos(thetas[k]))
        thetas[k + 1] = 2.0 * turn - thetas[k - 1]
    s, c = np.sin(thetas), np.cos(thetas)
    radii = r * (c[:-1] * s[1:] - np.cos(gamma) * s[:-1] * c[1:]) / np.sin(gamma)
    # The radius of the last ring, from the ring before: the formula read downwards.
    last = r * (np.cos(gamma) * c[-2] * s[-1] - s[-2] * c[-1]) / np.sin(gamma)
    radii = np.append(radii, last)
    heights = np.concatenate([[0.0], np.cumsum(r * s[:-1] * s[1:] * np.sin(gamma))])
    azimuth = gamma * (2 * np.arange(n_fold) + np.arange(rings)[:, None])
    around = np.stack([np.cos(azimuth), np.sin(azimuth)], axis=-1)
    points = np.empty((rings, n_fold, 3))
    normals = np.empty((rings, n_fold, 3))
    points[..., :2], points[..., 2] = radii[:, None, None] * around, heights[:, None]
    normals[..., :2], normals[..., 2] = s[:, None, None] * around, c[:, None]
    return CrabNet(n_fold, float(delta), float(r), thetas, radii, heights, points, normals)


def _second(theta0: float, delta: float, gamma: float) -> float:
    """theta_1: cos(delta) = cos(theta_0) cos(theta_1) + sin(theta_0) sin(theta_1) cos(gamma)."""
    size = np.hypot(np.cos(theta0), np.sin(theta0) * np.cos(gamma))
    if not abs(np.cos(delta)) <= size:
        least = np.arccos(size)
        raise DegenerateError(
            f"no crab net: with theta0 = {np.degrees(theta0):g} deg and {np.pi / gamma:.0f} points "
            f"a ring, normals of neighbouring rings are {np.degrees(least):.4g} to "
            f"{180 - np.degrees(least):.4g} deg apart; delta = {np.degrees(delta):g} deg is not. "
            "Take more points, another theta0 or delta"
        )
    middle = np.arctan2(np.sin(theta0) * np.cos(gamma), np.cos(theta0))
    return float(middle + np.arccos(np.cos(delta) / size))


@checked
def string_tensions(net: CrabNet) -> Floats:
    """(K - 1,) tensions of the edges between rings under which the net hangs; 1 in the first level.

    t_k (z_k+1 - z_k) is the same for all levels, so that the load is carried from ring to ring.

    Raises
    ------
    DegenerateError
        Two rings at one height: no tension carries a load; names the level.

    Source: mathematics.md 3.13.
    """
    rise = np.diff(net.heights)
    flat = np.abs(rise) <= RELATIVE_DEGENERATE * net.edge_length
    if flat.any():
        level = int(np.argmax(flat))
        raise DegenerateError(
            f"rings {level} and {level + 1} are at one height ({rise[level]:.3g} apart): a string "
            "net cannot hang there",
            cell=(level,),
        )
    return np.asarray(rise[0] / rise)


@checked
def string_forces(net: CrabNet, tensions: ArrayLike | None = None) -> Floats:
    """(K, N, 3) sums of the forces that the edges exert on every point, weightless strings.

    On the first and last ring they are fixed by the supports; on the others they vanish when the
    tensions are those of `string_tensions`: every rotational K-net is in equilibrium.

    Parameters
    ----------
    net : crab net
    tensions : (K - 1,) tension of all edges of each level; by default `string_tensions`

    Raises
    ------
    InputError
        Another number of tensions, or one that is not finite.

    Source: mathematics.md 3.13.
    """
    t = string_tensions(net) if tensions is None else np.asarray(tensions, dtype=np.float64)
    if t.shape != (net.rings - 1,):
        raise InputError(f"tensions of shape {t.shape}; {(net.rings - 1,)} is needed")
    finite(t, "tensions")
    flat = net.points.reshape(-1, 3)
    forces = np.zeros_like(flat)
    for ids in net.edges():
        start, end = ids.reshape(-1, 2).T
        pull = (flat[end] - flat[start]) * np.repeat(t / net.edge_length, net.n_fold)[:, None]
        np.add.at(forces, start, pull)
        np.add.at(forces, end, -pull)
    return forces.reshape(net.points.shape)

"""Baecklund transforms of K-nets, Bianchi's permutability, and lattices of transforms.

A transform is a further direction of the net: its unit field m' fulfils the same half-turn rule,
its points are x' = x + r m' x m, at the constant distance r sin(sigma), with the normal angle
sigma. Source: Bobenko, Suris, Discrete Differential Geometry, 4.2; mathematics.md 3.10, 3.11.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.mesh import Floats, Ints
from ddgfab.nets.knet.net import KNet
from ddgfab.nets.knet.oriented import refuse_angles
from ddgfab.nets.knet.spherical import refuse_not_unit
from ddgfab.nets.layers import stack_transforms
from ddgfab.quads import Place, cross, finite
from ddgfab.tolerances import NET_INPUT, RELATIVE_DEGENERATE

GROWTH_LIMIT = 1e8
"""Transforms whose rounding errors (1e-16) may have grown by more are refused."""


@checked
def baecklund(net: KNet, sigma: float, psi: float) -> KNet:
    """Baecklund transform of a K-net, of angle sigma and with a given first segment.

    The transform has the normal angles and scale of the net; |x' - x| = r sin(sigma), the segment
    is tangent to both nets, and their normals make the angle sigma.

    Parameters
    ----------
    net : K-net, in any number of directions
    sigma : angle between the normals of the net and the transform [rad], in (0, pi)
    psi : the first segment makes the angle psi + pi with the first edge of direction 0 about the
        normal [rad]: n' = cos(sigma) n + sin(sigma) (cos(psi) e x n + sin(psi) e), e that edge's
        direction

    Raises
    ------
    InputError
        sigma outside (0, pi), psi not finite, a net without edges in direction 0.
    DegenerateError
        m' = m_k, that is n' = -n_0 or n' = n_k, before a vertex on all paths to it; rounding
        errors that grow too much: names the vertex.

    Source: mathematics.md 3.10, psi as in 3.9.
    """
    refuse_angles(np.array([sigma]), "sigma of transform {}")
    if not np.isfinite(psi):
        raise InputError(f"psi = {psi}: a finite angle is needed")
    origin = (0,) * net.d
    if net.shape[0] < 2:
        raise InputError(f"{net!r} has no edge in direction 0, from which psi is measured")
    n = net.m[origin]
    e = net.points[(1, *origin[1:])] - net.points[origin]
    e = e / np.linalg.norm(e)
    across = np.cross(e, n)
    start = np.cos(sigma) * n + np.sin(sigma) * (np.cos(psi) * across + np.sin(psi) * e)
    return baecklund_from(net, start / np.linalg.norm(start))


@checked
def baecklund_from(net: KNet, normal: ArrayLike) -> KNet:
    """Baecklund transform with a given normal at its first point; sigma is that to the net's.

    Parameters
    ----------
    net : K-net
    normal : (3,) unit normal n' at the first point of the transform

    Raises
    ------
    InputError
        A normal that is not of unit length, or is plus or minus that of the net (the transform
        would be the net: sigma is 0 or pi).
    DegenerateError
        As `baecklund`.
    """
    start = np.array(normal, dtype=np.float64)
    if start.shape != (3,):
        raise InputError(f"normal has shape {start.shape}; (3,) is needed")
    finite(start, "normal")
    refuse_not_unit(start, "first normal of the transform")
    origin = (0,) * net.d
    sine = float(np.linalg.norm(np.cross(net.m[origin], start)))
    if sine <= RELATIVE_DEGENERATE:
        raise InputError(
            f"the first normal of the transform is parallel to that of the net: sine {sine:.3g}; "
            "sigma must be between 0 and pi"
        )
    m = _transported(net, start)
    return KNet(_aside(net, m), m, net.r, net.deltas)


def _transported(net: KNet, start: Floats) -> Floats:
    """Field m' of the transform, each point from the neighbour before that loses least.

    All paths from the first point lead to the same m', but not with the same rounding: along one
    edge m' goes to m + a (m' - m_k), an inversion of m', so that errors are multiplied by |a|.
    Away from its soliton a transform tends to one that does not depend on the start: |a| < 1, and
    what is left of the start is soon below rounding. A path that comes back from there has |a| > 1
    and brings up noise; on 1000 x 1000 coarse cells, by way of the axes, all digits are lost. So
    the growth of errors is followed front by front, and every point takes the direction in which it
    is least.
    """
    d, sizes = net.d, net.shape
    index = np.indices(sizes).reshape(d, -1)
    strides = [int(np.prod(sizes[k + 1 :])) for k in range(d)]
    old = net.m.reshape(-1, 3)
    new, growth = np.empty_like(old), np.full(len(old), np.inf)
    new[0], growth[0] = start, 1.0
    level = index.sum(axis=0)
    order = np.argsort(level, kind="stable")
    for front in np.split(order, np.flatnonzero(np.diff(level[order])) + 1)[1:]:
        for k in range(d):
            here = front[index[k, front] > 0]
            last = here - strides[k]
            e = new[last] - old[here]
            square = np.einsum("ij,ij->i", e, e)
            usable = square > RELATIVE_DEGENERATE**2
            square = np.where(usable, square, 1.0)
            a = -2.0 * np.einsum("ij,ij->i", old[last], e) / square
            grown = np.where(usable, np.maximum(1.0, np.abs(a) * growth[last]), np.inf)
            better = grown < growth[here]
            at = here[better]
            new[at] = (old[last] + a[:, None] * e)[better]
            growth[at] = grown[better]

        def cell(which: tuple[int, ...], front: Ints = front) -> tuple[int, ...]:
            return tuple(int(i) for i in index[:, front[which[0]]])

        place = Place(cell, "transform, vertex")
        place.refuse(
            np.isinf(growth[front]),
            "the normal of the transform before it is that of the net, or opposite (m' = m_k, that "
            "is n' = -n_0 or n' = n_k): no quad determines it",
        )
        place.refuse(
            growth[front] > GROWTH_LIMIT,
            f"rounding errors have grown by more than {GROWTH_LIMIT:g}; begin with a segment "
            "nearer to the soliton, or transform a smaller net; growth",
            growth[front],
        )
    return new.reshape(net.m.shape)


def _aside(net: KNet, m: Floats) -> Floats:
    """x' = x + r m' x m."""
    step = cross(np.moveaxis(m, -1, 0), np.moveaxis(net.m, -1, 0))
    return np.asarray(net.points + net.r * np.moveaxis(step, 0, -1))


@checked
def bianchi(net: KNet, first: KNet, second: KNet) -> KNet:
    """The K-net that is a Baecklund transform of two transforms of one net, with their angles.

    It is found without integration, at each point from three normals, and does not depend on
    which of the two transforms is taken first.

    Parameters
    ----------
    net : K-net
    first, second : two Baecklund transforms of it

    Raises
    ------
    InputError
        Shapes or scales that differ, or nets that are not transforms; names the point.
    DegenerateError
        The transforms coincide at a point; names it.

    Source: mathematics.md 3.11: m_12 = m + a (m_2 - m_1), x_12 = x + r a m_2 x m_1, in its
    half-turn form a = -2 <m, d> / <d, d>, d = m_2 - m_1.
    """
    for name, other in (("first", first), ("second", second)):
        if other.m.shape != net.m.shape or abs(other.r - net.r) > NET_INPUT * net.r:
            raise InputError(f"{name} transform is {other!r}, the net {net!r}; they must agree")
        gap = np.linalg.norm(other.points - _aside(net, other.m), axis=-1)
        if not gap.max() <= NET_INPUT * net.r:
            at = tuple(int(i) for i in np.unravel_index(int(gap.argmax()), gap.shape))
            raise InputError(
                f"{name} transform is none of the net: point {at} is {gap[at]:.3g} from "
                f"x + r m' x m (limit {NET_INPUT * net.r:g})"
            )
    m, m_1, m_2 = (np.moveaxis(part.m, -1, 0) for part in (net, first, second))
    d = m_2 - m_1
    square = np.einsum("i...,i...->...", d, d)
    Place(name="vertex").refuse(
        square <= NET_INPUT**2,
        f"the two transforms coincide; distance of their normals, limit {NET_INPUT:g} (their "
        "rounding is divided by it)",
        np.sqrt(square),
    )
    a = -2.0 * np.einsum("i...,i...->...", m, d) / square
    points = net.points + net.r * np.moveaxis(a * cross(m_2, m_1), 0, -1)
    return KNet(points, np.moveaxis(m + a * d, 0, -1), net.r, net.deltas)


@checked
def baecklund_lattice(net: KNet, sigmas: Sequence[float], psis: Sequence[float]) -> KNet:
    """K-net of a net's directions and one more, two points long, for each Baecklund transform.

    Layer (0, ..., 0) of the new directions is the net, (1, 0, ...) its first transform, (1, 1,
    0, ...) the common transform of the first two by Bianchi, and so on. Two transforms of a 2-net
    make the 4D net of the permutability theorem.

    Parameters
    ----------
    net : K-net
    sigmas, psis : angle and first segment of each transform; see `baecklund`

    Raises
    ------
    InputError
        As many sigmas as psis missing, or none; a sigma outside (0, pi).
    DegenerateError
        Two transforms that coincide at a point; names it.

    Source: mathematics.md 1.9, 3.10, 3.11.
    """
    angles = np.array(sigmas, dtype=np.float64)
    if angles.ndim != 1 or angles.shape != np.shape(psis) or not len(angles):
        raise InputError(
            f"sigmas of shape {angles.shape} and psis of shape {np.shape(psis)}: one of each per "
            "transform"
        )
    refuse_angles(angles, "sigma of transform {}")
    count = len(sigmas)
    sheets: dict[tuple[int, ...], KNet] = {(): net}
    for k, (sigma, psi) in enumerate(zip(sigmas, psis, strict=True)):
        sheets[k,] = baecklund(net, sigma, psi)
    for size in range(2, count + 1):
        for chosen in combinations(range(count), size):
            base, last, other = chosen[:-2], (*chosen[:-2], chosen[-2]), (*chosen[:-2], chosen[-1])
            sheets[chosen] = bianchi(sheets[base], sheets[last], sheets[other])
    points = _stacked({key: sheet.points for key, sheet in sheets.items()}, count)
    m = _stacked({key: sheet.m for key, sheet in sheets.items()}, count)
    deltas = (*net.deltas, *(np.array([sigma]) for sigma in sigmas))
    return KNet(points, m, net.r, deltas)


def _stacked(sheets: dict[tuple[int, ...], Floats], k: int, later: tuple[int, ...] = ()) -> Floats:
    """Sheets, by the transforms they take, as layers of k further directions; later ones fixed."""
    if k == 0:
        return sheets[tuple(i for i, taken in enumerate(later) if taken)]
    return stack_transforms([_stacked(sheets, k - 1, (taken, *later)) for taken in (0, 1)])

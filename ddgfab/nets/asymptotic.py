"""A-nets, whose vertex stars are planar: tangent normals and Lelieuvre fields, both ways.

Nets of asymptotic lines. A field L with Delta_k x = L_k x L for every direction k is normal to the
net and fulfils the Moutard equation L_12 - L = a (L_2 - L_1); the net and its field, up to the
factor s on even and 1 / s on odd vertices, determine each other. Source: Bobenko, Suris, Discrete
Differential Geometry, 2.4; mathematics.md 3.1, 3.2.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.mesh import Floats, extent
from ddgfab.nets.moutard import moutard_coefficients
from ddgfab.quads import Place, finite, layer, net_points, pairs, summed
from ddgfab.tolerances import NET_INPUT, RELATIVE_DEGENERATE

PARALLEL_STAR = 1e-10
"""Unit edges of a star that are all within this sine of a line have no tangent plane."""


@checked
def star_edges(points: ArrayLike, periodic: Sequence[bool] | None = None) -> Floats:
    """(n1, ..., nd, 2 d, 3) unit edges from every vertex, forward then backward for each direction.

    Edges that do not exist at the boundary are zero.

    Parameters
    ----------
    points : (n1, ..., nd, 3)
    periodic : d flags; by default all directions are open

    Raises
    ------
    DegenerateError
        An edge of no length; names direction and vertex.
    """
    x = net_points(points, 3)
    d = x.ndim - 1
    closed = (False,) * d if periodic is None else tuple(map(bool, periodic))
    if len(closed) != d:
        raise InputError(f"{len(closed)} flags for the {d} directions of the net")
    out = np.zeros((*x.shape[:-1], 2 * d, 3))
    for k in range(d):
        edges = np.roll(x, -1, axis=k) - x
        length = np.sqrt(np.einsum("...i,...i->...", edges, edges))
        lengths, rows = np.moveaxis(length, k, 0), np.moveaxis(edges, k, 0)
        if not closed[k]:
            lengths, rows = lengths[:-1], rows[:-1]
        scale = extent(x)

        def cell(index: tuple[int, ...], k: int = k) -> tuple[int, ...]:
            return (*index[1 : k + 1], index[0], *index[k + 1 :])

        Place(cell, f"edge of direction {k} at vertex").refuse(
            lengths <= RELATIVE_DEGENERATE * scale,
            f"it has no length, limit {RELATIVE_DEGENERATE * scale:g}",
            lengths,
        )
        unit = rows / lengths[..., None]
        target = np.moveaxis(out, k, 0)
        count = len(unit)
        target[:count, ..., 2 * k, :] = unit
        ends = (np.arange(count) + 1) % x.shape[k]
        target[ends, ..., 2 * k + 1, :] = -unit
    return out


@checked
def star_flatness(points: ArrayLike, periodic: Sequence[bool] | None = None) -> Floats:
    """(n1, ..., nd) smallest singular value of the unit edges at every vertex; 0: planar star.

    About the sine by which edges leave the best tangent plane. All zero: an A-net.

    Raises
    ------
    DegenerateError
        An edge of no length; names direction and vertex.

    Source: mathematics.md 3.1.
    """
    return np.asarray(np.linalg.svd(star_edges(points, periodic), compute_uv=False)[..., 2])


@checked
def tangent_normals(points: ArrayLike, periodic: Sequence[bool] | None = None) -> Floats:
    """(n1, ..., nd, 3) unit normals of the best tangent planes of vertex stars.

    On the side of Delta_0 x times Delta_1 x, summed over the quads at the vertex. Where a net
    folds over this jumps; `lelieuvre` and `recover_knet` choose signs along edges instead.

    Raises
    ------
    DegenerateError
        A vertex whose edges are parallel to each other, an edge of no length; names it.

    Source: mathematics.md 3.1.
    """
    stars = star_edges(points, periodic)
    _, values, rows = np.linalg.svd(stars)
    second = values[..., 1]
    Place(name="vertex").refuse(
        second <= PARALLEL_STAR,
        f"all edges are parallel, there is no tangent plane: second singular value, limit "
        f"{PARALLEL_STAR:g}",
        second,
    )
    normals = rows[..., 2, :]
    forward, back = stars[..., 0, :] - stars[..., 1, :], stars[..., 2, :] - stars[..., 3, :]
    side = np.einsum("...i,...i->...", normals, np.cross(forward, back))
    return np.asarray(np.where(side[..., None] < 0, -normals, normals))


@checked
def lelieuvre(points: ArrayLike, scale: float = 1.0, *, tolerance: float = NET_INPUT) -> Floats:
    """(n1, ..., nd, 3) Lelieuvre field L of an A-net: Delta_k x = L_k x L.

    Parameters
    ----------
    points : (n1, ..., nd, 3) A-net, at least one quad
    scale : length of L at the first vertex, along `tangent_normals`; it multiplies L at even and
        divides it at odd vertices
    tolerance : greatest `star_flatness` that counts as an A-net

    Raises
    ------
    InputError
        No A-net: names the vertex and its flatness. A scale that is zero or not finite.
    DegenerateError
        An edge of no length, edges all parallel at a vertex, normals parallel along an edge.

    Source: mathematics.md 3.2.
    """
    x = net_points(points, 3)
    if not (np.isfinite(scale) and scale != 0):
        raise InputError(f"scale {scale}: a number other than zero is needed")
    flatness = star_flatness(x)
    if not flatness.max() <= tolerance:
        at = tuple(int(i) for i in np.unravel_index(int(flatness.argmax()), flatness.shape))
        raise InputError(
            f"no A-net: the edges at vertex {at} leave their plane by {flatness[at]:.3g} "
            f"(smallest singular value of the unit edges, limit {tolerance:g})"
        )
    nu = tangent_normals(x)
    d = x.ndim - 1
    out = np.empty_like(x)
    out[(0,) * d] = scale * nu[(0,) * d]
    for k in range(d):
        # From the layer of the directions before k into direction k, a layer at a time.
        tail = (0,) * (d - k - 1)
        for i in range(1, x.shape[k]):
            here, last = layer(d, k, i), layer(d, k, i - 1)
            c = np.cross(nu[here], out[last])
            square = np.einsum("...i,...i->...", c, c)
            known = np.einsum("...i,...i->...", out[last], out[last])

            def cell(
                index: tuple[int, ...], i: int = i, tail: tuple[int, ...] = tail
            ) -> tuple[int, ...]:
                return (*index, i - 1, *tail)

            Place(cell, f"edge of direction {k} at vertex").refuse(
                square <= RELATIVE_DEGENERATE**2 * known,
                f"its normals are parallel: sine, limit {RELATIVE_DEGENERATE:g}",
                np.sqrt(square / known),
            )
            e = x[here] - x[last]
            factor = np.einsum("...i,...i->...", e, c) / square
            out[here] = factor[..., None] * nu[here]
    return out


@checked
def anet_from_moutard(
    field: ArrayLike, origin: ArrayLike = (0.0, 0.0, 0.0), *, tolerance: float = NET_INPUT
) -> Floats:
    """(n1, ..., nd, 3) A-net with a Lelieuvre field: Delta_k x = L_k x L.

    Parameters
    ----------
    field : (n1, ..., nd, 3) T-net (`evolve_moutard`, `evolve_tnet`, `evolve_spherical`)
    origin : (3,) first point
    tolerance : greatest relative violation of the Moutard equation

    Raises
    ------
    InputError
        No T-net, so quads do not close: names the quad and how much it misses.

    Source: mathematics.md 3.2.
    """
    L = net_points(field, 3)
    start = np.array(origin, dtype=np.float64)
    if start.shape != (3,):
        raise InputError(f"origin has shape {start.shape}; (3,) is needed")
    finite(start, "origin")
    for axes in pairs(L):
        if min(L.shape[axes[0]], L.shape[axes[1]]) < 2:
            continue
        gap = moutard_coefficients(L, axes)[1]
        if gap.max() > tolerance:
            at = tuple(int(i) for i in np.unravel_index(int(gap.argmax()), gap.shape))
            raise InputError(
                f"no T-net: quad {at} of directions {axes} misses the Moutard equation by "
                f"{gap[at]:.3g} (relative, limit {tolerance:g})"
            )
    return integrate(L, 1.0, start)


def integrate(m: Floats, r: float, origin: Floats) -> Floats:
    """(n1, ..., nd, 3) points of the A-net with Delta_k x = r m_k x m, from its first point.

    Closing is the Moutard equation of m (not checked here: see `KNet.residuals`,
    `anet_from_moutard`).
    """
    d = m.ndim - 1

    def steps(k: int) -> Floats:
        edges = lelieuvre_edges(m[layer(d, k, slice(None))], k)
        edges *= r
        return edges

    return summed(steps, m.shape, origin)


def lelieuvre_edges(m: Floats, axis: int) -> Floats:
    """m_k x m along a direction, one shorter in it."""
    before = (slice(None),) * axis
    a, b = m[(*before, slice(1, None))], m[(*before, slice(None, -1))]
    out = np.empty(a.shape)
    for c, (p, q) in enumerate(((1, 2), (2, 0), (0, 1))):
        np.multiply(a[..., p], b[..., q], out=out[..., c])
        out[..., c] -= a[..., q] * b[..., p]
    return out

"""The Christoffel dual of isothermic nets.

Source: Bobenko, Pinkall 1996; Bobenko, Suris, 4.3; mathematics.md 6.2.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats
from ddgfab.nets.isothermic import net_labels
from ddgfab.quads import Place, finite, layer, net_points, summed
from ddgfab.tolerances import NET_INPUT


@checked
def christoffel_dual(
    points: ArrayLike,
    labels: Sequence[ArrayLike] | None = None,
    tolerance: float = NET_INPUT,
) -> Floats:
    """Dual net x* with Delta_k x* = alpha_k Delta_k x / |Delta_k x|^2, of the same shape.

    Isothermic with the same cross-ratios; diagonals of a quad and its dual are antiparallel; the
    dual of the dual is the net up to translation. Its first point is the origin. Another gauge of
    the labels (one factor) scales the dual.

    Parameters
    ----------
    points : (n1, ..., nd, 2 or 3)
    labels : d arrays (n_k - 1,) or numbers; by default the net's own (`cross_ratio_labels`)
    tolerance : relative, on cross-ratios against quotients of labels and on the closing of the
        dual's quads; nets from files with few digits need more than the default

    Raises
    ------
    InputError
        A net that is not isothermic, or labels of the wrong shape.
    DegenerateError
        An edge of no length, or a quad whose dual does not close (labels of another net); names it.

    Source: mathematics.md 6.2, equation (18).
    """
    x = net_points(points)
    alpha = net_labels(x, labels, tolerance)
    d = x.ndim - 1
    edges = []
    for axis in range(d):
        step = np.diff(x, axis=axis)
        square = np.einsum("...i,...i->...", step, step)
        Place(name=f"edge of direction {axis} at").refuse(square == 0, "it has no length")
        label = np.expand_dims(alpha[axis], [k for k in range(d) if k != axis])
        edges.append((label / square)[..., None] * step)
    return integrate(edges, tolerance)


def integrate(edges: Sequence[Floats], tolerance: float = NET_INPUT) -> Floats:
    """Net from its edges, one array a direction (shorter by one in it), from the origin.

    Raises
    ------
    InputError
        Shapes that belong to no net, entries that are not finite.
    DegenerateError
        A quad whose four edges do not close within `tolerance` of its longest; names it.
    """
    d = len(edges)
    if d < 2 or edges[0].ndim != d + 1:
        raise InputError(f"edges of {d} directions with shape {np.shape(edges[0]) if d else ()}")
    shape = tuple(edges[0].shape[k] + (k == 0) for k in range(d))
    for axis, edge in enumerate(edges):
        finite(edge, f"edges of direction {axis}")
        wanted = (*(n - (k == axis) for k, n in enumerate(shape)), edges[0].shape[-1])
        if edge.shape != wanted:
            raise InputError(f"edges of direction {axis} have shape {edge.shape}, not {wanted}")
    net_shape = (*shape, edges[0].shape[-1])
    for i, j in combinations(range(d), 2):
        gap = np.linalg.norm(np.diff(edges[i], axis=j) - np.diff(edges[j], axis=i), axis=-1)
        along = np.linalg.norm(edges[i], axis=-1), np.linalg.norm(edges[j], axis=-1)
        low = along[0].take(range(shape[j] - 1), axis=j), along[1].take(range(shape[i] - 1), axis=i)
        high = along[0].take(range(1, shape[j]), axis=j), along[1].take(range(1, shape[i]), axis=i)
        longest = np.maximum.reduce([*low, *high])
        bad = ~(gap <= tolerance * longest)
        if bad.any():
            cell = tuple(int(k) for k in np.argwhere(bad)[0])
            raise DegenerateError(
                f"quad of directions ({i}, {j}) at {cell}: its edges do not close; gap "
                f"{gap[cell] / longest[cell]:.2g} of the longest (limit {tolerance:g})",
                cell=cell,
            )
    return summed(lambda k: edges[k][layer(d, k, slice(None))], net_shape, 0.0)

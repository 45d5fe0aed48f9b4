"""Ribaucour transforms of circular nets: both nets are layers of a larger circular net.

Source: Bobenko, Suris, Discrete Differential Geometry, 3.1; mathematics.md 1.9, 2.3, 2.4.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.mesh import Floats
from ddgfab.nets.circular import fourth_by_t
from ddgfab.nets.cubes import coordinate_surfaces
from ddgfab.nets.layers import stack_transforms
from ddgfab.nets.miquel import evolve_circular
from ddgfab.quads import finite
from ddgfab.tolerances import NET_INPUT


@checked
def ribaucour(
    net: ArrayLike,
    start: ArrayLike,
    ratios: Sequence[ArrayLike],
    *,
    tolerance: float = NET_INPUT,
) -> Floats:
    """(n1, ..., nd, dim) Ribaucour transform of a circular net of d > 1 directions.

    Every edge of the net and the edge across from it have four concircular ends. All Ribaucour
    transforms are such: one point and a number for each edge of the axes are free, the rest follows
    by Miquel's theorem.

    Parameters
    ----------
    net : (n1, ..., nd, dim) circular
    start : (dim,) first point of the transform, not on a circle or line with an edge at the first
        point of the net
    ratios : d arrays (n_k - 1,), or a number for each direction: for the quads (x, x_k, x_k', x')
        along axis k the number t of `fourth_by_t`, whose cross-ratio is -(1 - t) / t; t between 0
        and 1 gives convex quads
    tolerance : on the circularity of the given net, relative

    Raises
    ------
    InputError
        Shapes that do not fit, entries that are not finite.
    DegenerateError
        Quads of the net that are not circular, corners on a line, t = 0 or 1; names the place.

    Source: Bobenko, Suris, 3.1; mathematics.md 2.3, 2.4.
    """
    x = np.asarray(net, dtype=np.float64)
    first = np.asarray(start, dtype=np.float64)
    d = x.ndim - 1
    if d < 2 or first.shape != x.shape[-1:] or len(ratios) != d:
        raise InputError(
            f"a net {x.shape} with a start {first.shape} and {len(ratios)} directions of ratios: "
            "(n1, ..., nd, dim) with d > 1, (dim,) and d are needed"
        )
    finite(first, "start")
    layers = stack_transforms([x, x])
    for k, given in enumerate(ratios):
        axis = tuple(slice(None) if j == k else 0 for j in range(d))
        count = x.shape[k] - 1
        data = np.asarray(given, dtype=np.float64)
        if data.shape not in ((), (count,)):
            raise InputError(f"ratios of direction {k} have shape {data.shape}; ({count},) needed")
        way = np.empty((count + 1, x.shape[-1]))
        way[0] = first
        for i, t in enumerate(np.broadcast_to(data, (count,))):
            way[i + 1] = fourth_by_t(x[axis][i], x[axis][i + 1], way[i], t)
        layers[(*axis, 1)] = way
    made = evolve_circular(coordinate_surfaces(layers), tolerance=tolerance)
    return np.asarray(made[..., 1, :])

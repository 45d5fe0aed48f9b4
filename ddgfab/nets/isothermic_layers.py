"""Isothermic nets in three and more directions: every further layer is a Darboux transform.

Source: Bobenko, Suris, Discrete Differential Geometry, 4.3; mathematics.md 6.1, 6.3.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats, extent
from ddgfab.nets.isothermic import (
    GROWTH_LIMIT,
    edge_labels,
    evolve_isothermic,
    isothermic_point,
    point_rule,
)
from ddgfab.quads import Place
from ddgfab.tolerances import NET_INPUT, RELATIVE_DEGENERATE


@checked
def evolve_isothermic_nd(
    lines: Sequence[ArrayLike],
    labels: Sequence[ArrayLike],
    *,
    growth_limit: float = GROWTH_LIMIT,
    tolerance: float = NET_INPUT,
) -> Floats:
    """(n1, ..., nd, dim) isothermic net from d > 1 polylines and the labels of their edges.

    The first two make a 2-net (`evolve_isothermic`, ill-posed beyond some ten cells); each further
    direction adds layers, Darboux transforms of the one before, whose parameter is the label. The
    order of the directions does not matter (3D consistency).

    Parameters
    ----------
    lines : d polylines (n_k, dim) from one point
    labels : d arrays (n_k - 1,) or numbers, other than zero; no two of different directions equal
    growth_limit : see `evolve_isothermic`
    tolerance : relative, on the closing of the layers

    Raises
    ------
    InputError
        Shapes that do not fit, polylines with different first points.
    DegenerateError
        Equal labels, points that coincide or go to infinity, growth beyond the limit; names the
        place.

    Source: mathematics.md 6.1.
    """
    if len(lines) < 2 or len(labels) != len(lines):
        raise InputError(
            f"{len(lines)} polylines and {len(labels)} lists of labels: two or more, and as many"
        )
    paths = [np.asarray(line, dtype=np.float64) for line in lines]
    net = evolve_isothermic(paths[0], paths[1], labels[0], labels[1], growth_limit=growth_limit)
    known = [edge_labels(labels[k], len(paths[k]) - 1, f"labels of direction {k}") for k in (0, 1)]
    for k in range(2, len(paths)):
        path = paths[k]
        if path.ndim != 2 or path.shape[1] != net.shape[-1] or len(path) < 2:
            raise InputError(
                f"polyline {k} has shape {path.shape}; (2 or more, {net.shape[-1]}) is needed"
            )
        gap = float(np.linalg.norm(path[0] - paths[0][0]))
        if not gap <= RELATIVE_DEGENERATE * extent(path):
            raise InputError(f"polyline {k} starts {gap:g} from the first; all share one point")
        own = edge_labels(labels[k], len(path) - 1, f"labels of direction {k}")
        sheets = [net]
        for mu, start in zip(own.tolist(), path[1:], strict=True):
            sheets.append(darboux_layer(sheets[-1], tuple(known), mu, start, tolerance))
        net = np.stack(sheets, axis=-2)
        known.append(own)
    return net


def darboux_layer(
    x: Floats, alpha: tuple[Floats, ...], mu: float, first: Floats, tolerance: float
) -> Floats:
    """The next layer of a net, from its first point and the label of the edges that lead to it.

    Raises
    ------
    DegenerateError
        See `ddgfab.transforms.darboux`.
    """
    if mu == 0 or not np.isfinite(mu):
        raise DegenerateError(f"mu = {mu:g}: a label other than zero is needed")
    for axis, own in enumerate(alpha):
        same = np.flatnonzero(np.abs(own - mu) <= RELATIVE_DEGENERATE * np.abs(own))
        if len(same):
            raise DegenerateError(
                f"mu = {mu:g} is the label of edge {same[0]} of direction {axis}; take another"
            )
    d = x.ndim - 1
    out = np.empty_like(x)
    out[(0,) * d] = first
    for axis in range(d):
        # All lines of this direction that start on what is known, step by step.
        lines: tuple[slice | int, ...] = (*(slice(None),) * (axis + 1), *(0,) * (d - axis - 1))
        known, made = np.moveaxis(x[lines], axis, 0), np.moveaxis(out[lines], axis, 0)
        for step in range(len(known) - 1):
            place = Place(
                lambda index, step=step: (*index, step),  # type: ignore[misc]
                f"Darboux transform, direction {axis} at",
            )
            here, there, above = (
                np.moveaxis(p, -1, 0) for p in (known[step], known[step + 1], made[step])
            )
            label = np.asarray(alpha[axis][step])
            new = point_rule(here, there, above, label, np.asarray(mu), place)
            made[step + 1] = np.moveaxis(new, 0, -1)
    _check_closing(x, out, alpha, mu, tolerance)
    return out


def _check_closing(
    x: Floats, out: Floats, alpha: tuple[Floats, ...], mu: float, tolerance: float
) -> None:
    """Every edge of the net carries the transform, also those it was not made along."""
    d = x.ndim - 1
    size = extent(out)
    for axis in range(d):
        n = x.shape[axis]
        low, high = (r for r in (range(n - 1), range(1, n)))
        label = np.expand_dims(alpha[axis], [k for k in range(d) if k != axis])
        again = isothermic_point(
            x.take(low, axis=axis), x.take(high, axis=axis), out.take(low, axis=axis), label, mu
        )
        gap = np.linalg.norm(again - out.take(high, axis=axis), axis=-1)
        bad = ~(gap <= tolerance * size)
        if bad.any():
            cell = tuple(int(k) for k in np.argwhere(bad)[0])
            raise DegenerateError(
                f"edge of direction {axis} at {cell}: the transform does not close, gap "
                f"{gap[cell]:.2g} of {size:.3g} (limit {tolerance:g} of it); is the net "
                "isothermic with these labels?",
                cell=cell,
            )

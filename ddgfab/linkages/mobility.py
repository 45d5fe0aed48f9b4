"""Mobility of linkages by the rank of their Jacobian.

Source: maths.md 4.2, 4.3.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.errors import DegenerateError, InputError
from ddgfab.linkages.mechanism import Pose
from ddgfab.mesh import Floats, Ints

RANK_GAP = 1e6
"""Singular values on either side of the rank differ by this factor at least."""

RANK_CUT = 1e-9
"""Singular values below this part of the greatest may count as zero."""


def linkage_jacobian(bars: Ints, pose: Pose) -> Floats:
    """(4E + V, 6V) derivative of the conditions of a linkage in points and axes.

    Rows: per bar |e|^2 / 2, <n, n'>, <e, n>, <e, n'>, per hinge |n|^2 / 2; columns: points, then
    axes. Lengths are scaled by the mean bar, so that singular values compare.

    Source: maths.md 4.2.
    """
    i, j = bars.T
    count, v = len(bars), len(pose.points)
    edge = pose.points[j] - pose.points[i]
    edge = edge / np.linalg.norm(edge, axis=1).mean()
    n_i, n_j = pose.axes[i], pose.axes[j]
    rows = np.zeros((4 * count + v, 2, v, 3))
    r = np.arange(count)
    rows[r, 0, i], rows[r, 0, j] = -edge, edge
    rows[count + r, 1, i], rows[count + r, 1, j] = n_j, n_i
    for block, (axis, hinge) in enumerate(((n_i, i), (n_j, j)), start=2):
        at = block * count + r
        rows[at, 0, i], rows[at, 0, j] = -axis, axis
        rows[at, 1, hinge] = edge
    hinges = np.arange(v)
    rows[4 * count + hinges, 1, hinges] = pose.axes
    return rows.reshape(len(rows), -1)


def mobility(bars: ArrayLike, pose: Pose) -> int:
    """Degrees of freedom of rigid bars on hinges, without the six of rigid motion.

    Parameters
    ----------
    bars : (E, 2) hinge ids
    pose : one pose; a generic one, for folded states have more infinitesimal freedoms

    Raises
    ------
    InputError
        A pose that is a stack, or a bar of no length.
    DegenerateError
        The singular values show no gap, so the rank is not determined.

    Source: maths.md 4.2, 4.3: 6V - rank - 6.
    """
    ids = np.asarray(bars, dtype=np.int64)
    if pose.points.ndim != 2:
        raise InputError(f"mobility needs one pose; this stack has shape {pose.points.shape}")
    size = np.linalg.norm(pose.points[ids[:, 1]] - pose.points[ids[:, 0]], axis=1)
    if not (size > 0).all():
        raise InputError(f"bar {int(np.argmin(size))} has no length")
    jacobian = linkage_jacobian(ids, pose)
    values = np.linalg.svd(jacobian, compute_uv=False)
    unknowns = jacobian.shape[1]
    rank = int((values > RANK_CUT * values[0]).sum())
    if rank < len(values) and values[rank] * RANK_GAP > values[rank - 1]:
        raise DegenerateError(
            f"mobility is not determined: singular values {values[rank - 1]:.3g} and "
            f"{values[rank]:.3g} around rank {rank} (a factor of {RANK_GAP:g} is needed); "
            "take a pose away from folded states"
        )
    return int(unknowns - rank - 6)

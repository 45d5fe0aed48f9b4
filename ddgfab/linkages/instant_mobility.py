"""Mobility of linkages by the rank of their Jacobian.

Source: mathematics.md 4.2, 4.3.
"""

from __future__ import annotations

from collections import deque

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError
from ddgfab.linkages.mechanism import Pose
from ddgfab.mesh import Floats, Ints
from ddgfab.quads import finite

RANK_GAP = 1e3
"""Singular values on either side of a rank differ by this factor at least."""

RANK_CUT = 1e-9
"""Singular values below this part of the greatest may count as zero."""


COLLINEAR = 1e-9
"""A bar whose axes are along it to this sine is a line: turning about it moves nothing."""


def linkage_jacobian(bars: Ints, pose: Pose) -> Floats:
    """(7E, 6V) conditions of rigid bars on the velocities of points and axes, linearised.

    A bar's vector e and its axes n, n' may turn together, (de, dn, dn') = (w x e, w x n, w x n'),
    and in no other way: the rows of a bar are an orthonormal basis of what is orthogonal to these.
    Unlike the derivatives of |e|^2, <e, n>, <e, n'>, <n, n'> and |n|^2 they stay independent where
    n and n' are parallel, or along the bar. Columns: points, in units of the mean bar, then axes.

    Source: mathematics.md 4.2, corrected for twists 0 and pi.
    """
    i, j = bars.T
    v = len(pose.points)
    rows = np.zeros((len(bars), 7, 2, v, 3))
    blocks = _bar_rows(bars, pose)
    bar = np.arange(len(bars))
    rows[bar, :, :, i], rows[bar, :, :, j] = blocks[:, :, 0], blocks[:, :, 1]
    return rows.reshape(7 * len(bars), -1)


def _bar_rows(bars: Ints, pose: Pose) -> Floats:
    """(E, 7, 2, 2, 3) rows of each bar: condition, hinge i or j, point or axis.

    Six conditions; the seventh is zero unless the bar is a line.
    """
    i, j = bars.T
    edge = pose.points[j] - pose.points[i]
    edge = edge / np.linalg.norm(edge, axis=1).mean()
    turning = np.stack([edge, pose.axes[i], pose.axes[j]], axis=1)  # (E, 3 vectors, 3)
    turning = np.cross(np.eye(3), turning[:, :, None]).reshape(-1, 3, 3, 3)  # vector, w, component
    span = np.moveaxis(turning, 2, -1).reshape(len(bars), 9, 3)
    basis, values, _ = np.linalg.svd(span)
    conditions = np.swapaxes(basis, 1, 2)[:, [3, 4, 5, 6, 7, 8, 2]].reshape(-1, 7, 3, 3)
    conditions[values[:, 2] > COLLINEAR * values[:, 0], 6] = 0.0
    rows = np.zeros((len(bars), 7, 2, 2, 3))
    rows[:, :, 0, 0], rows[:, :, 1, 0] = -conditions[:, :, 0], conditions[:, :, 0]
    rows[:, :, 0, 1], rows[:, :, 1, 1] = conditions[:, :, 1], conditions[:, :, 2]
    return rows


@checked
def mobility(bars: ArrayLike, pose: Pose) -> int:
    """Degrees of freedom of rigid bars on hinges, without the six of rigid motion.

    6V - rank - 6 of `linkage_jacobian`, whose kernel is built hinge by hinge: of the motions of the
    part so far and of the next hinge, those remain that its bars allow. An orthonormal basis is
    kept, so the singular values of each small step decide. Twists may be anything: planar linkages
    have parallel axes.

    Parameters
    ----------
    bars : (E, 2) hinge ids of a connected linkage
    pose : one pose; a generic one, for folded states have more infinitesimal freedoms

    Raises
    ------
    InputError
        A pose that is a stack or not finite, bars that are not pairs of its hinges, a bar of no
        length, or hinges that no bars connect.
    DegenerateError
        The singular values of a step show no gap, so the rank is not determined; names the hinge.

    Examples
    --------
    >>> import numpy as np
    >>> from ddgfab.linkages.isogram import bennett
    >>> linkage = bennett(60.0, np.radians(30), beta=np.radians(90))
    >>> mobility(linkage.bars, linkage.pose(1.0))
    1

    Source: mathematics.md 4.2, 4.3.
    """
    ids = _checked(np.asarray(bars), pose)
    size = np.linalg.norm(pose.points[ids[:, 1]] - pose.points[ids[:, 0]], axis=1)
    if not (size > 0).all():
        raise InputError(f"bar {int(np.argmin(size))} has no length")
    order, at_hinge = _walk(ids, len(pose.points))
    rows = _bar_rows(ids, pose).reshape(-1, 7, 2, 6)
    waiting = np.array([len(here) for here in at_hinge])
    moves: dict[int, Floats] = {}
    count = 0
    for hinge in order:
        own = np.concatenate([np.zeros(3), pose.axes[hinge]])[None]
        parts = [np.concatenate([np.zeros((1, count)), own], axis=1)]
        for bar, side in at_hinge[hinge]:
            other = int(ids[bar, 1 - side])
            if other in moves:
                known = rows[bar, :, 1 - side] @ moves[other]
                parts.append(np.concatenate([known, rows[bar, :, side]], axis=1))
                waiting[[hinge, other]] -= 1
        kernel = _kernel(np.concatenate(parts), hinge)
        moves = {k: values @ kernel[:count] for k, values in moves.items() if waiting[k]}
        moves[hinge] = kernel[count:]
        count = kernel.shape[1]
    return count - 6


def _checked(bars: Ints, pose: Pose) -> Ints:
    """Bars as pairs of ids of the hinges of one finite pose."""
    shape = np.shape(pose.points)
    if len(shape) != 2 or shape[1] != 3 or np.shape(pose.axes) != shape:
        raise InputError(
            f"mobility needs one pose, points and axes (V, 3); these have shapes {shape} and "
            f"{np.shape(pose.axes)}"
        )
    finite(pose.points, "points of the pose")
    finite(pose.axes, "axes of the pose")
    if bars.ndim != 2 or bars.shape[1] != 2 or not len(bars) or bars.dtype.kind not in "iu":
        raise InputError(
            f"bars of type {bars.dtype} and shape {bars.shape}: pairs (E, 2) of hinge ids are "
            "needed"
        )
    out = np.flatnonzero(((bars < 0) | (bars >= shape[0])).any(axis=1))
    if len(out):
        raise InputError(f"bar {out[0]} joins hinges {bars[out[0]].tolist()} of {shape[0]}")
    return bars.astype(np.int64)


def _walk(bars: Ints, hinges: int) -> tuple[list[int], list[list[tuple[int, int]]]]:
    """Hinges in breadth-first order, and at each its bars with the end at which it is."""
    at_hinge: list[list[tuple[int, int]]] = [[] for _ in range(hinges)]
    for bar, ends in enumerate(bars.tolist()):
        for side, hinge in enumerate(ends):
            at_hinge[hinge].append((bar, side))
    order, seen, front = [], {0}, deque([0])
    while front:
        hinge = front.popleft()
        order.append(hinge)
        for bar, side in at_hinge[hinge]:
            other = int(bars[bar, 1 - side])
            if other not in seen:
                seen.add(other)
                front.append(other)
    if len(order) < hinges:
        missing = min(set(range(hinges)) - seen)
        raise InputError(f"no bars connect hinge {missing} to hinge 0")
    return order, at_hinge


def _kernel(matrix: Floats, hinge: int) -> Floats:
    """Orthonormal basis (columns) of the kernel of the conditions at a hinge."""
    _, values, basis = np.linalg.svd(matrix)
    rank = int((values > RANK_CUT * values[0]).sum())
    if rank < len(values) and values[rank] * RANK_GAP > values[rank - 1]:
        raise DegenerateError(
            f"mobility is not determined: singular values {values[rank - 1]:.3g} and "
            f"{values[rank]:.3g} at hinge {hinge} (a factor of {RANK_GAP:g} is needed); "
            "take a pose away from folded states"
        )
    return np.asarray(basis[rank:].T)

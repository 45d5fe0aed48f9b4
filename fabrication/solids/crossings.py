"""Curves where cylinders cross, in meshes: both faces are sampled at the same points of them."""

from __future__ import annotations

import math
from bisect import bisect_left, insort
from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray

from ddgfab.errors import DegenerateError
from ddgfab.mesh import Floats, Ints
from fabrication.boundary import Boundary, cross_rows
from fabrication.crossing_curves import circle_angles

SAME_ANGLE: Final = 1e-9
"""Angles [rad] on a cylinder face nearer than this are one generator line."""

SAMPLES: Final = 17
"""Places on a curve where its second derivative is looked at."""

ROUNDS: Final = 8
"""So often angles are handed from face to face until all have them."""


class OnCylinders(Protocol):
    """Arcs of cylinder faces: edge, row of the arc, face, (n, 2) angles of ends, second."""

    edge: Ints
    row: Ints
    face: Ints
    angles: Floats
    second: NDArray[np.bool_]


def rise(boundary: Boundary, rows: Ints) -> Floats:
    """(n,) greatest second derivative [mm/rad2] of curves along the axis of their circle."""
    first, last = boundary.arc_range[rows].T[:, :, None]
    s = np.linspace(0.0, 1.0, SAMPLES)
    _, rates = boundary.arc_motion(rows, first + s * (last - first))
    axis = cross_rows(boundary.arc_a[rows], boundary.arc_b[rows])
    axis /= np.linalg.norm(axis, axis=1)[:, None]
    slopes = np.einsum("nmi,ni->nm", rates, axis)
    steps = (last - first) / (SAMPLES - 1)
    return np.asarray(np.abs(np.diff(slopes, axis=1) / steps).max(axis=1))


def share_angles(boundary: Boundary, on: OnCylinders, grids: dict[int, list[float]]) -> None:
    """Put the angles of both faces of every curve into the grids [rad] of the two.

    Raises
    ------
    DegenerateError
        The grids do not come to an end.
    """
    b = boundary
    two = np.flatnonzero(on.second)
    place = {edge: k for k, edge in enumerate(on.edge.tolist()) if not on.second[k]}
    one = np.array([place[edge] for edge in on.edge[two].tolist()])
    rows = on.row[two]
    for _ in range(ROUNDS):
        added = 0
        # angles of the circle, then points of the curve, then angles of the other cylinder
        which, angles = _inside(grids, on, one)
        start = b.arc_range[rows[which], 0]
        t = start + np.abs(angles - on.angles[one[which], 0])
        at = b.arc_points(rows[which], t[:, None])[:, 0]
        faces = on.face[two[which]]
        away = at - b.face_origin[faces]
        ydir = cross_rows(b.face_axis[faces], b.face_xdir[faces])
        seen = np.arctan2(
            np.einsum("ni,ni->n", away, ydir), np.einsum("ni,ni->n", away, b.face_xdir[faces])
        )
        added += _put(grids, faces, seen % (2.0 * math.pi))
        # and back
        which, angles = _inside(grids, on, two)
        faces, row = on.face[two[which]], rows[which]
        xdir, axis = b.face_xdir[faces], b.face_axis[faces]
        around = np.cos(angles)[:, None] * xdir + np.sin(angles)[:, None] * cross_rows(axis, xdir)
        foot = b.face_origin[faces] + b.face_radius[faces, None] * around
        both, _ = circle_angles(b.arc_center[row], b.arc_a[row], b.arc_b[row], foot, axis)
        middle = b.arc_range[row].mean(axis=1)[:, None]
        both = middle + (both - middle + math.pi) % (2.0 * math.pi) - math.pi
        t = both[np.arange(len(both)), np.abs(both - middle).argmin(axis=1)]
        ends = on.angles[one[which]]
        turn = np.where(ends[:, 1] > ends[:, 0], 1.0, -1.0)
        added += _put(grids, on.face[one[which]], ends[:, 0] + turn * (t - b.arc_range[row, 0]))
        if not added:
            return
    raise DegenerateError("curves where cylinders cross have no common points for a mesh")


def _inside(grids: dict[int, list[float]], on: OnCylinders, arcs: Ints) -> tuple[Ints, Floats]:
    """The angles of grids between the ends of some arcs: which of these, and the angles."""
    which: list[int] = []
    found: list[float] = []
    for k, (face, ends) in enumerate(
        zip(on.face[arcs].tolist(), np.sort(on.angles[arcs], axis=1).tolist(), strict=True)
    ):
        grid = grids[face]
        inner = grid[
            bisect_left(grid, ends[0] + SAME_ANGLE) : bisect_left(grid, ends[1] - SAME_ANGLE)
        ]
        which += [k] * len(inner)
        found += inner
    return np.array(which, dtype=np.int64), np.array(found)


def _put(grids: dict[int, list[float]], faces: Ints, angles: Floats) -> int:
    """Insert angles that grids do not have; how many these were."""
    added = 0
    for face, angle in zip(faces.tolist(), angles.tolist(), strict=True):
        grid = grids[face]
        at = bisect_left(grid, angle)
        near = grid[max(at - 1, 0) : at + 1]
        if all(abs(angle - other) > SAME_ANGLE for other in near):
            insort(grid, angle)
            added += 1
    return added

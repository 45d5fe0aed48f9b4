"""Measures on faces: planarity as a length and in percent, circularity, opposite sides."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from ddgfab.arguments import checked
from ddgfab.mesh import Floats, Ints, Mesh, unit
from ddgfab.tolerances import RELATIVE_DEGENERATE

_QUAD = 4

SPANS: Final = 100
"""Diagonals over so many numbers of sides make the mean of a polygon with very many corners."""


def _by_size(mesh: Mesh) -> Iterator[tuple[Ints, Floats]]:
    """Faces of each size above three: their ids (n,) and corner points (n, size, 3)."""
    for size in np.unique(mesh.face_sizes[mesh.face_sizes > 3]).tolist():
        ids = np.flatnonzero(mesh.face_sizes == size)
        yield ids, mesh.vertices[mesh.corners[mesh.face_start[ids, None] + np.arange(size)]]


def _heights(points: Floats) -> Floats:
    """(n, k) signed distances of (n, k, 3) points from the plane of least squares of each set."""
    centered = points - points.mean(axis=1, keepdims=True)
    normal = np.linalg.svd(centered, full_matrices=False)[2][:, -1]
    heights: Floats = np.einsum("nkj,nj->nk", centered, normal)
    return heights


@checked
def planarity(mesh: Mesh) -> Floats:
    """Greatest distance of a corner from the face's plane of least squares; 0 for triangles.

    Returns
    -------
    (F,) in the unit of the vertices

    Source: docs/parts.md, Panel; the plane through the centroid along the last right singular
    vector.
    """
    result = np.zeros(mesh.n_faces)
    for ids, points in _by_size(mesh):
        result[ids] = np.abs(_heights(points)).max(axis=1)
    return result


@checked
def planarity_percent(mesh: Mesh) -> Floats:
    """Planarity relative to size [%]; 0 for triangles.

    Quads: distance between the diagonals (as lines) over their mean length. Parallel diagonals lie
    in one plane, so they give 0. Faces with more corners: how far the corners spread across the
    plane of least squares (greatest minus least signed distance) over the mean length of all
    diagonals (of a sample, above 200 corners); for a parallelogram-like quad both values agree.

    Returns
    -------
    (F,) [%]

    Examples
    --------
    A unit square with one corner lifted by 0.1: its diagonals pass each other at half the height.

    >>> from ddgfab.mesh import Mesh
    >>> quad = Mesh.build([[0, 0, 0], [1, 0, 0], [1, 1, 0.1], [0, 1, 0]], [[0, 1, 2, 3]])
    >>> planarity_percent(quad).round(2)
    array([3.52])

    Source: Liu, Pottmann, Wallner, Yang, Wang 2006, section 3; mathematics.md 1.3.
    """
    result = np.zeros(mesh.n_faces)
    for ids, points in _by_size(mesh):
        size = points.shape[1]
        if size == _QUAD:
            first, second = points[:, 2] - points[:, 0], points[:, 3] - points[:, 1]
            normal = np.cross(first, second)
            sine = np.linalg.norm(normal, axis=1)
            gap = np.abs(np.einsum("ij,ij->i", points[:, 1] - points[:, 0], unit(normal)))
            long = np.linalg.norm(first, axis=1) * np.linalg.norm(second, axis=1)
            gap[sine <= RELATIVE_DEGENERATE * long] = 0.0
        else:
            gap = np.ptp(_heights(points), axis=1)
        result[ids] = 100.0 * gap / _mean_diagonal(points)
    return result


def _mean_diagonal(points: Floats) -> Floats:
    """(n,) mean length of the diagonals of (n, k, 3) polygons; k of 4 or more.

    Of polygons with more than 2 `SPANS` corners only some diagonals count: those over so many
    numbers of sides, evenly spread, from every corner.
    """
    size = points.shape[1]
    spans = np.arange(2, size // 2 + 1)
    if len(spans) > SPANS:
        spans = np.unique(np.linspace(2, size // 2, SPANS).astype(np.int64))
    total, weight = np.zeros(len(points)), 0.0
    for span in spans.tolist():
        share = 0.5 if 2 * span == size else 1.0  # each of these is met from both its ends
        ways = np.roll(points, -span, axis=1) - points
        total += share * np.linalg.norm(ways, axis=2).sum(axis=1)
        weight += share * size
    mean: Floats = total / weight
    return mean


@checked
def circular_defect(mesh: Mesh) -> Floats:
    """How far each face is from having its corners on a circle, as an angle; 0 for triangles.

    A convex quad is circular if its opposite angles have equal sums; the defect is half the
    difference of the sums, |a0 + a2 - pi| when it is planar. For more corners: the greatest
    defect of the quads that four corners in a row make, all zero just when all corners are
    concyclic. Angles say nothing about planarity: a circular net has to be planar as well.

    Returns
    -------
    (F,) [rad]

    Source: theorem of inscribed angles; Bobenko, Suris, Discrete Differential Geometry, 3.1.
    """
    rows = [np.arange(len(mesh.corners))]
    for _ in range(3):
        rows.append(mesh.corner_next[rows[-1]])
    quad = mesh.vertices[mesh.corners[np.stack(rows)]]  # (4, C, 3)
    normal = mesh.face_normals[mesh.corner_face]
    ahead = np.roll(quad, -1, axis=0) - quad
    back = np.roll(quad, 1, axis=0) - quad
    sine = np.einsum("kci,ci->kc", np.cross(ahead, back), normal)
    # Measured inside the face, so that a reflex corner counts above pi.
    cosine = np.einsum("kci,kci->kc", ahead, back)
    skew = np.linalg.norm(np.cross(ahead, back), axis=2)
    angle = np.arctan2(np.copysign(skew, sine), cosine) % (2 * np.pi)
    defect = 0.5 * np.abs(angle[0] + angle[2] - angle[1] - angle[3])
    defect[mesh.face_sizes[mesh.corner_face] < _QUAD] = 0.0
    greatest: Floats = np.maximum.reduceat(defect, mesh.face_start[:-1])
    return greatest


@checked
def chebyshev_defect(mesh: Mesh) -> Floats:
    """Greatest difference of opposite sides of each quad over its mean side [%].

    Zero for all faces: a Chebyshev net, elementary quads are (skew) parallelograms. Defined for
    quads; other faces count 0, so look at `Mesh.face_sizes` first.

    Returns
    -------
    (F,) [%]

    Source: mathematics.md 3.6 and 3.10; Wunderlich 1951.
    """
    result = np.zeros(mesh.n_faces)
    for ids, points in _by_size(mesh):
        if points.shape[1] == _QUAD:
            sides = np.linalg.norm(np.roll(points, -1, axis=1) - points, axis=2)
            difference = np.abs(sides[:, :2] - sides[:, 2:]).max(axis=1)
            result[ids] = 100.0 * difference / sides.mean(axis=1)
    return result


@checked
def interior_angles(mesh: Mesh) -> Floats:
    """(C,) interior angles of the faces [rad], 0..2 pi: above pi at reflex corners."""
    here = mesh.vertices[mesh.corners]
    ahead = mesh.vertices[mesh.corners[mesh.corner_next]] - here
    back = mesh.vertices[mesh.corners[mesh.corner_previous]] - here
    side = np.einsum("cx,cx->c", np.cross(ahead, back), mesh.face_normals[mesh.corner_face])
    return np.where(side < 0, 2 * np.pi - mesh.corner_angles, mesh.corner_angles)


@checked
def translation_defect(mesh: Mesh) -> Floats:
    """How far quads are from parallelograms: |x_12 - x_1 - x_2 + x| in percent of the mean side.

    All zero: a translation net, x_ij = p_i + q_j. 0 for faces that are not quads.

    Returns
    -------
    (F,) [%]

    Source: mathematics.md 8.1.
    """
    result = np.zeros(mesh.n_faces)
    ids = np.flatnonzero(mesh.face_sizes == _QUAD)
    if len(ids):
        p = mesh.vertices[mesh.corners[mesh.face_start[ids, None] + np.arange(_QUAD)]]
        gap = np.linalg.norm(p[:, 0] - p[:, 1] + p[:, 2] - p[:, 3], axis=1)
        side = np.linalg.norm(np.roll(p, -1, axis=1) - p, axis=-1).mean(axis=1)
        result[ids] = 100.0 * gap / np.where(side > 0, side, 1.0)
    return result

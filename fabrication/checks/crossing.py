"""Where a triangle mesh crosses itself; arrays only."""

from __future__ import annotations

from typing import Final

import numpy as np

from ddgfab.mesh import Floats, Ints
from fabrication.checks.boxes import box_pairs
from fabrication.specs import TriangleMesh

INSIDE_MM: Final = 1e-6
"""How far [mm] an edge must reach through a triangle, or pass inside its border, to cross it."""

_CHUNK: Final = 500_000  # pairs of triangles looked at together


def crossings(mesh: TriangleMesh) -> Ints:
    """(c, 2) triangles where an edge of the second goes properly through the first, sorted.

    A closed mesh without them bounds a body unless shells lie wholly inside one another or sheets
    cover each other in one plane: `fabrication.checks.shells` finds those. The work grows with the
    number of triangles and of those whose bounding boxes meet.
    """
    corners = mesh.vertices[mesh.triangles]
    normals = crossed(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.sqrt(np.einsum("ij,ij->i", normals, normals))
    normals /= np.where(length > 0, length, np.inf)[:, None]
    pairs = triangle_pairs(mesh)
    found = [np.zeros((0, 2), dtype=np.int64)]
    for begin in range(0, len(pairs), _CHUNK):
        one, two = pairs[begin : begin + _CHUNK].T
        i, j = np.concatenate([one, two]), np.concatenate([two, one])
        through = _through(corners, normals, i, j)
        found.append(np.stack([i[through], j[through]], axis=1))
    every = np.concatenate(found)
    return every[np.lexsort((every[:, 1], every[:, 0]))]


def triangle_pairs(mesh: TriangleMesh) -> Ints:
    """(p, 2) triangles i < j whose bounding boxes meet."""
    corners = mesh.vertices[mesh.triangles]
    return box_pairs(corners.min(axis=1), corners.max(axis=1))


def crossed(a: Floats, b: Floats) -> Floats:
    """(..., 3) cross products; numpy's own takes longer on short lists than what it is for."""
    result = np.empty(np.broadcast_shapes(a.shape, b.shape))
    for k in range(3):
        m, n = (k + 1) % 3, (k + 2) % 3
        result[..., k] = a[..., m] * b[..., n] - a[..., n] * b[..., m]
    return result


def _through(corners: Floats, normals: Floats, i: Ints, j: Ints) -> Ints:
    """Which pairs have an edge of triangle j through the inside of triangle i."""
    normal = normals[i]
    base = np.einsum("pc,pc->p", normal, corners[i, 0])
    heights = np.matmul(corners[j], normal[:, :, None])[:, :, 0] - base[:, None]
    rows = np.flatnonzero((heights.max(axis=1) > INSIDE_MM) & (heights.min(axis=1) < -INSIDE_MM))
    if not len(rows):
        return rows
    j, normal, heights = j[rows], normal[rows], heights[rows]
    triangle = corners[i[rows]]
    sides = triangle[:, [1, 2, 0]] - triangle
    inward = crossed(normal[:, None], sides)
    inward /= np.maximum(np.sqrt(np.einsum("pkc,pkc->pk", inward, inward)), INSIDE_MM)[:, :, None]
    other = corners[j]
    ahead, above = other[:, [1, 2, 0]], heights[:, [1, 2, 0]]
    passes = np.minimum(heights, above) < -INSIDE_MM
    passes &= np.maximum(heights, above) > INSIDE_MM
    along = np.divide(heights, heights - above, out=np.zeros_like(heights), where=passes)
    points = other + along[:, :, None] * (ahead - other)  # (p, 3 edges, 3)
    away = points[:, :, None] - triangle[:, None]
    margin = np.einsum("pkc,pekc->pek", inward, away)
    hit = (passes & (margin > INSIDE_MM).all(axis=2)).any(axis=1)
    return np.asarray(rows[hit])

"""Where a triangle mesh crosses itself; arrays only."""

from __future__ import annotations

from typing import Final

import numpy as np

from ddgfab.mesh import Floats, Ints
from fabrication.specs import TriangleMesh

INSIDE_MM: Final = 1e-6
"""How far [mm] an edge must reach through a triangle, or pass inside its border, to cross it."""

_CHUNK: Final = 4_000_000  # numbers in a temporary array


def crossings(mesh: TriangleMesh) -> Ints:
    """(c, 2) triangles where an edge of the second goes properly through the first.

    A closed mesh without them bounds a body unless shells lie wholly inside one another or sheets
    cover each other in one plane: counting components and comparing volumes finds those.
    """
    corners = mesh.vertices[mesh.triangles]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.sqrt(np.einsum("ij,ij->i", cross, cross))
    real = np.flatnonzero(length > 0)
    normals = cross[real] / length[real, None]
    offsets = np.einsum("ij,ij->i", normals, corners[real, 0])
    low, high = corners.min(axis=1), corners.max(axis=1)
    found = []
    step = max(1, _CHUNK // max(3 * len(corners), 1))
    for begin in range(0, len(real), step):
        part = slice(begin, begin + step)
        heights = normals[part] @ mesh.vertices.T - offsets[part, None]
        above = (heights > INSIDE_MM)[:, mesh.triangles].any(axis=2)
        below = (heights < -INSIDE_MM)[:, mesh.triangles].any(axis=2)
        i, j = np.nonzero(above & below)
        plane = real[part][i]
        near = ((low[plane] <= high[j]) & (low[j] <= high[plane])).all(axis=1)
        i, j, plane = i[near], j[near], plane[near]
        through = _through(mesh, corners[plane], normals[part][i], heights, i, j)
        found.append(np.stack([plane[through], j[through]], axis=1))
    return np.concatenate(found) if found else np.zeros((0, 2), dtype=np.int64)


def _through(
    mesh: TriangleMesh, triangle: Floats, normal: Floats, heights: Floats, i: Ints, j: Ints
) -> Ints:
    """Which of the pairs have an edge of triangle j through the inside of the given triangles."""
    hit = np.zeros(len(j), dtype=bool)
    sides = np.roll(triangle, -1, axis=1) - triangle
    inward = np.cross(normal[:, None], sides)
    inward /= np.maximum(np.linalg.norm(inward, axis=2, keepdims=True), INSIDE_MM)
    for k in range(3):
        a, b = mesh.triangles[j, k], mesh.triangles[j, (k + 1) % 3]
        at_a, at_b = heights[i, a], heights[i, b]
        passes = np.minimum(at_a, at_b) < -INSIDE_MM
        passes &= np.maximum(at_a, at_b) > INSIDE_MM
        along = np.divide(at_a, at_a - at_b, out=np.zeros_like(at_a), where=passes)
        point = mesh.vertices[a] + along[:, None] * (mesh.vertices[b] - mesh.vertices[a])
        margin = np.einsum("pkc,pkc->pk", inward, point[:, None] - triangle)
        hit |= passes & (margin > INSIDE_MM).all(axis=1)
    return np.flatnonzero(hit)

"""Normals of meshes: flat faces stay flat, curved ones are smooth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from ddgfab.mesh import Floats, Ints
from fabrication.boundary import cross_rows
from fabrication.specs import TriangleMesh

CREASE: Final = np.cos(np.radians(40.0))
"""Triangles that meet at a corner are of one curved face where the cosine of the angle between
their normals is above this. Chords of small holes turn by up to 37 degrees."""

_STEPS: Final = 500
"""Normals of a corner are one where they agree to 1 / _STEPS."""


@dataclass(frozen=True, eq=False)
class Shaded:
    """A corner of a mesh is here once for every normal that it has.

    points (n, 3), their unit normals (n, 3), and triangles (m, 3)
    """

    points: Floats
    normals: Floats
    triangles: Ints


def shaded(meshes: Sequence[TriangleMesh]) -> list[Shaded]:
    """Meshes with normals, weighted by the areas of the triangles at a corner; all at once."""
    if not meshes:
        return []
    sizes = np.array([len(mesh.vertices) for mesh in meshes])
    first = np.concatenate([[0], np.cumsum(sizes)])
    points = np.concatenate([mesh.vertices for mesh in meshes])
    triangles = np.concatenate(
        [mesh.triangles + at for mesh, at in zip(meshes, first, strict=False)]
    )
    corner = triangles.ravel()
    normals = _corner_normals(points, triangles)
    cells = np.rint(normals * _STEPS).astype(np.int64) + 512
    keys = ((corner * 1024 + cells[:, 0]) * 1024 + cells[:, 1]) * 1024 + cells[:, 2]
    _, at, same = np.unique(keys, return_index=True, return_inverse=True)
    owner = corner[at]  # ascending, as the corner leads the key
    begin = np.searchsorted(owner, first)
    counts = [len(mesh.triangles) for mesh in meshes]
    rows = np.split(same.reshape(-1, 3), np.cumsum(counts)[:-1])
    return [
        Shaded(points[owner[a:b]], normals[at[a:b]], own - a)
        for a, b, own in zip(begin[:-1], begin[1:], rows, strict=True)
    ]


def _corner_normals(points: Floats, triangles: Ints) -> Floats:
    """(3 m, 3) unit normals at the corners of all triangles, in their order."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    doubled = cross_rows(b - a, c - a)  # normals, as long as twice the area
    length = np.sqrt(np.einsum("ti,ti->t", doubled, doubled))
    unit = doubled / np.where(length > 0.0, length, 1.0)[:, None]
    corner = triangles.ravel()
    order = np.argsort(corner, kind="stable")
    triangle = order // 3
    count = np.bincount(corner, minlength=len(points))
    mates = count[corner[order]]  # how many corners each one shares its point with
    start = (np.cumsum(count) - count)[corner[order]]
    one = np.repeat(np.arange(len(order)), mates)
    other = np.arange(len(one)) - np.repeat(np.cumsum(mates) - mates, mates) + start[one]
    near = np.einsum("pi,pi->p", unit[triangle[one]], unit[triangle[other]]) >= CREASE
    one, other = one[near], other[near]
    total = np.stack(
        [np.bincount(one, doubled[triangle[other], k], minlength=len(order)) for k in range(3)],
        axis=1,
    )
    size = np.sqrt(np.einsum("ci,ci->c", total, total))
    total[size == 0.0] = (0.0, 0.0, 1.0)  # a triangle without area, which nobody sees
    out: Floats = np.empty(total.shape)
    out[order] = total / np.where(size > 0.0, size, 1.0)[:, None]
    return out

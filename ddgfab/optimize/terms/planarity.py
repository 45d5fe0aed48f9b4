"""Planarity of polygons of any size, without auxiliary unknowns.

With the vector area A of a polygon, corners h_i above the plane through the centroid across A
cannot be any numbers: their sum vanishes, and so does sum h_i (x_(i+1) - x_(i-1)), since A has no
part in its own plane. What is left has k - 3 dimensions for k corners. With a basis B of it the
residuals are r = <A, sum_i B_i x_i> / |A|; they vanish just when the face is planar. For a quad
B = (1, -1, 1, -1) / 2 and r is the signed distance of the diagonals.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ddgfab.arguments import checked
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.terms.base import LocalTerm

_QUAD = 4


def polygon_corners(mesh: Mesh, size: int) -> tuple[Ints, Ints]:
    """Faces with `size` corners: ids (n,) and vertex ids (n, size)."""
    ids = np.flatnonzero(mesh.face_sizes == size)
    return ids, mesh.corners[mesh.face_start[ids, None] + np.arange(size)]


def mean_diagonals(mesh: Mesh, corners: Ints) -> Floats:
    """(n,) mean length of the diagonals of polygons of one size, 4 or more."""
    size = corners.shape[1]
    a, b = np.triu_indices(size, 2)
    a, b = a[(a > 0) | (b < size - 1)], b[(a > 0) | (b < size - 1)]  # 0 and last share a side
    points = mesh.vertices[corners]
    lengths: Floats = np.linalg.norm(points[:, a] - points[:, b], axis=2).mean(axis=1)
    return lengths


def vector_areas(points: Floats) -> Floats:
    """(n, 3) vector areas of (n, k, 3) polygons."""
    if points.shape[1] == _QUAD:
        return 0.5 * crossed(points[:, 2] - points[:, 0], points[:, 3] - points[:, 1])
    ways = points[:, 1:] - points[:, :1]
    return 0.5 * sum(
        (crossed(ways[:, k], ways[:, k + 1]) for k in range(1, ways.shape[1] - 1)),
        crossed(ways[:, 0], ways[:, 1]),
    )


def crossed(one: Floats, two: Floats) -> Floats:
    """(..., 3) cross products; a quarter of the time of `numpy.cross`."""
    out = np.empty(np.broadcast_shapes(one.shape, two.shape))
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        out[..., k] = one[..., i] * two[..., j] - one[..., j] * two[..., i]
    return out


def _modes(size: int) -> Floats:
    """(k - 3, k) orthonormal heights of a regular polygon that no tilt makes: waves 2 to k - 2."""
    turn = 2 * np.pi * np.arange(size) / size
    rows = [f(k * turn) for k in range(2, (size + 1) // 2) for f in (np.cos, np.sin)]
    if size % 2 == 0:
        rows.append((-1.0) ** np.arange(size))
    modes = np.array(rows)
    return np.asarray(modes / np.linalg.norm(modes, axis=1, keepdims=True))


def _impossible(points: Floats) -> Floats:
    """(n, 3, k) orthonormal heights that the corners of (n, k, 3) polygons cannot have."""
    count, size = points.shape[:2]
    across = np.roll(points, -1, axis=1) - np.roll(points, 1, axis=1)
    area = vector_areas(points)
    normal = area / np.linalg.norm(area, axis=1, keepdims=True)
    across -= np.einsum("nkx,nx->nk", across, normal)[..., None] * normal[:, None]
    reach = np.linalg.norm(across, axis=(1, 2))[:, None, None]
    ones = np.full((count, 1, size), size**-0.5)
    rows = np.concatenate([ones, across.transpose(0, 2, 1) / reach], axis=1)
    return np.asarray(np.linalg.svd(rows, full_matrices=False)[2][:, :3])


def possible_heights(points: Floats) -> Floats:
    """(n, k - 3, k) orthonormal bases of the heights that corners of (n, k, 3) polygons can have.

    For polygons of any shape, also such that wind round more than once.
    """
    never = _impossible(points)
    return np.asarray(np.linalg.svd(never, full_matrices=True)[2][:, 3:])


def _bases(points: Floats) -> Floats:
    """(n, k - 3, k) bases of the possible heights of the corners of faces (n, k, 3).

    Those of a regular polygon, projected: unlike singular vectors they are the same everywhere.
    """
    count, size = points.shape[:2]
    modes = np.broadcast_to(_modes(size), (count, size - 3, size))
    if size == _QUAD:
        return modes
    never = _impossible(points)
    return np.asarray(modes - modes @ never.transpose(0, 2, 1) @ never)


def flatness(points: Floats, basis: Floats) -> Floats:
    """(m,) residuals <A, sum_i B_i x_i> / |A| of (m, k, 3) polygons."""
    area = vector_areas(points)
    offset = np.einsum("mk,mkx->mx", basis, points)
    length = np.linalg.norm(area, axis=1)
    return np.asarray(np.einsum("mx,mx->m", area, offset) / length)


def flatness_slope(points: Floats, basis: Floats) -> Floats:
    """(m, k, 3) derivatives B_i n + (x_(i+1) - x_(i-1)) x w' / 2|A|, w' the tangential offset."""
    area = vector_areas(points)
    length = np.linalg.norm(area, axis=1)[:, None]
    normal = area / length
    offset = np.einsum("mk,mkx->mx", basis, points)
    offset -= np.einsum("mx,mx->m", offset, normal)[:, None] * normal
    across = np.roll(points, -1, axis=1) - np.roll(points, 1, axis=1)
    slope = basis[..., None] * normal[:, None]
    slope += np.cross(across, (offset / (2 * length))[:, None])
    return np.asarray(slope)


@dataclass(frozen=True, eq=False, kw_only=True)
class Planarity(LocalTerm):
    """<A, sum_i B_i x_i> / |A| for polygons of one size; make with `planarity_terms`.

    Attributes
    ----------
    basis : (m, k) the rows B
    """

    basis: Floats

    def values(self, local: Floats) -> Floats:
        """(m,) residuals."""
        return flatness(local.reshape(len(local), -1, 3), self.basis)

    def gradients(self, local: Floats) -> Floats:
        """(m, 3k) derivatives."""
        slope = flatness_slope(local.reshape(len(local), -1, 3), self.basis)
        return slope.reshape(len(local), -1)


@checked
def planarity_terms(
    mesh: Mesh,
    faces: Sequence[int] | Ints | None = None,
    *,
    weight: float = 1.0,
    hard: bool = True,
) -> tuple[Planarity, ...]:
    """Planarity of all faces with more than three corners, or of some: a term for each size.

    Residuals are parts of the face's mean diagonal; for quads: distance of the diagonals.

    Source: Liu, Pottmann, Wallner, Yang, Wang 2006, section 3; mathematics.md 1.3, 8.5.
    """
    chosen = np.zeros(mesh.n_faces, dtype=bool)
    chosen[slice(None) if faces is None else np.asarray(faces, dtype=np.int64)] = True
    terms = []
    for size in np.unique(mesh.face_sizes[chosen & (mesh.face_sizes > 3)]).tolist():
        ids, corners = polygon_corners(mesh, size)
        ids, corners = ids[chosen[ids]], corners[chosen[ids]]
        basis = _bases(mesh.vertices[corners]).reshape(-1, size)
        index = np.repeat(3 * corners[..., None] + np.arange(3), size - 3, axis=0)
        terms.append(
            Planarity(
                name="planarity" if size == _QUAD else f"planarity of {size}-gons",
                index=index.reshape(len(basis), -1),
                factor=np.repeat(1.0 / mean_diagonals(mesh, corners), size - 3),
                weight=weight,
                hard=hard,
                basis=basis,
                of="face",
                elements=np.repeat(ids, size - 3),
            )
        )
    return tuple(terms)

"""Parallel meshes (Combescure transforms): the space of them, the nearest one, one by factors."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats, Mesh
from ddgfab.support.parallel import edge_conditions, parallel_field
from ddgfab.tolerances import RELATIVE_DEGENERATE

DENSE_LIMIT: Final = 2000
"""Vertices up to which the space of parallel meshes is computed (dense, time ~ V^3)."""

NULL_RELATIVE: Final = 1e-9
"""Singular values below this part of the greatest count as zero, where there is a gap."""


@checked
def parallel_space(mesh: Mesh) -> Floats:
    """(K, V, 3) orthonormal basis of all v' for which every edge of (v', faces) is parallel.

    The null space of the sparse operator `ddgfab.support.parallel.edge_conditions`. K counts
    translations (3) and the mesh itself: m + n + 3 for an m x n net with planar faces, the number
    of faces for a simple polyhedron (three at every vertex), 4 for triangle meshes.

    Raises
    ------
    InputError
        More vertices than `DENSE_LIMIT`; `nearest_parallel` has no such limit.

    Source: Pottmann, Liu, Wallner, Bobenko, Wang 2007, section 2; mathematics.md 10.4.
    """
    if mesh.n_vertices > DENSE_LIMIT:
        raise InputError(
            f"the space of parallel meshes of {mesh.n_vertices} vertices is too large to list "
            f"(limit {DENSE_LIMIT}); use nearest_parallel"
        )
    matrix = edge_conditions(mesh)
    # Singular values of A and eigenvalues of A^T A would lose half the digits: take A itself.
    values, rows = np.linalg.svd(matrix.toarray())[1:]
    rank = int((values > NULL_RELATIVE * values[0]).sum())
    return np.asarray(rows[rank:].reshape(-1, mesh.n_vertices, 3))


@checked
def parallel_dimension(mesh: Mesh) -> int:
    """Dimension of the space of parallel meshes, translations included (see `parallel_space`)."""
    return len(parallel_space(mesh))


@checked
def nearest_parallel(mesh: Mesh, target: ArrayLike, weights: ArrayLike | None = None) -> Mesh:
    """The parallel mesh whose vertices are nearest to (V, 3) targets, by least squares.

    Parameters
    ----------
    target : (V, 3)
    weights : (V,) positive; 1 by default

    Raises
    ------
    InputError
        Targets of the wrong shape or not finite.

    Source: mathematics.md 10.4; see `ddgfab.support.parallel.parallel_field`.
    """
    wanted = np.asarray(target, dtype=np.float64)
    if wanted.shape != mesh.vertices.shape or not np.isfinite(wanted).all():
        raise InputError(f"target: {mesh.vertices.shape} finite numbers are needed")
    weight = None if weights is None else np.asarray(weights, dtype=np.float64)
    return mesh.with_vertices(parallel_field(mesh, wanted, weight))


@checked
def combescure(
    points: ArrayLike, along: ArrayLike, across: ArrayLike, origin: ArrayLike | None = None
) -> Floats:
    """(M + 1, N + 1, 3) parallel net whose edges on two boundary lines are given multiples.

    Every parallel net is one of these: M + N factors and 3 coordinates are the m + n + 3
    dimensions of the space. All factors equal: a scaled copy.

    Parameters
    ----------
    points : (M + 1, N + 1, 3) net with planar quads
    along : (M,) factors of the edges from (i, 0) to (i + 1, 0); zero and negative ones are allowed
    across : (N,) factors of the edges from (0, j) to (0, j + 1)
    origin : (3,) of the new net's first point; by default that of the net

    Raises
    ------
    InputError
        Shapes that do not match.
    DegenerateError
        Parallel edges at the far corner of a quad; names it and the sine.

    Source: Combescure transform; two directions across a planar quad, mathematics.md 10.4, 1.10.
    """
    x = np.asarray(points, dtype=np.float64)
    a, b = np.asarray(along, dtype=np.float64), np.asarray(across, dtype=np.float64)
    if x.ndim != 3 or x.shape[2] != 3 or a.shape != (len(x) - 1,) or b.shape != (x.shape[1] - 1,):
        raise InputError(
            f"a net {x.shape} with factors {a.shape} and {b.shape}: "
            "(M + 1, N + 1, 3), (M,) and (N,) are needed"
        )
    first, second = np.diff(x, axis=0), np.diff(x, axis=1)
    p, q = first[:, :-1], second[:-1]  # edges that start at x
    s, r = first[:, 1:], second[1:]  # edges that end at x12
    normal = np.cross(s, r)
    square = np.einsum("ijk,ijk->ij", normal, normal)
    sides = np.einsum("ijk,ijk->ij", s, s) * np.einsum("ijk,ijk->ij", r, r)
    flat = np.argwhere(square <= RELATIVE_DEGENERATE**2 * sides)
    if len(flat):
        cell = int(flat[0, 0]), int(flat[0, 1])
        sine = np.sqrt(square[cell] / sides[cell]) if sides[cell] > 0 else 0.0
        raise DegenerateError(
            f"quad {cell}: its edges at the far corner are parallel (sine {sine:.1e}, limit "
            f"{RELATIVE_DEGENERATE:g})",
            cell=cell,
        )

    def part(u: Floats, v: Floats) -> Floats:
        """<u x v, s x r> / |s x r|^2 for every quad."""
        return np.asarray(np.einsum("ijk,ijk->ij", np.cross(u, v), normal) / square)

    # a p - b q = f s - g r, where f and g are the factors of the far edges.
    to_far = np.stack([part(p, r), -part(q, r)]), np.stack([part(p, s), -part(q, s)])
    along_all, across_all = np.empty(first.shape[:2]), np.empty(second.shape[:2])
    along_all[:, 0], across_all[0] = a, b
    m, n = p.shape[:2]
    for diagonal in range(m + n - 1):
        i = np.arange(max(0, diagonal - n + 1), min(m, diagonal + 1))
        j = diagonal - i
        near = along_all[i, j], across_all[i, j]
        along_all[i, j + 1] = near[0] * to_far[0][0, i, j] + near[1] * to_far[0][1, i, j]
        across_all[i + 1, j] = near[0] * to_far[1][0, i, j] + near[1] * to_far[1][1, i, j]
    out = np.empty_like(x)
    out[0, 0] = x[0, 0] if origin is None else np.asarray(origin, dtype=np.float64)
    out[1:, 0] = out[0, 0] + np.cumsum(along_all[:, :1] * first[:, 0], axis=0)
    out[:, 1:] = out[:, :1] + np.cumsum(across_all[..., None] * second, axis=1)
    return out

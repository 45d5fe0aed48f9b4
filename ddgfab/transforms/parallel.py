"""Parallel meshes (Combescure transforms): the space of them, the nearest one, one by factors."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.support.parallel import edge_conditions, parallel_field
from ddgfab.tolerances import RELATIVE_DEGENERATE
from ddgfab.trees import tree_sums

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

    Where the directions target - v are torsion-free node axes along which a parallel mesh has its
    vertices (`parallel_along`), it is that mesh, at the distance nearest to the targets: axes that
    are exact stay as they are.

    Parameters
    ----------
    target : (V, 3)
    weights : (V,) positive; 1 by default

    Raises
    ------
    InputError
        Targets or weights of the wrong shape or not finite, weights that are not positive.

    Source: mathematics.md 10.4; see `ddgfab.support.parallel.parallel_field`.
    """
    wanted = np.asarray(target, dtype=np.float64)
    if wanted.shape != mesh.vertices.shape or not np.isfinite(wanted).all():
        raise InputError(f"target: {mesh.vertices.shape} finite numbers are needed")
    weight = np.ones(mesh.n_vertices) if weights is None else np.asarray(weights, dtype=np.float64)
    if weight.shape != (mesh.n_vertices,) or not (np.isfinite(weight) & (weight > 0)).all():
        raise InputError(f"weights: ({mesh.n_vertices},) positive numbers are needed")
    away = wanted - mesh.vertices
    used = mesh.valences > 0
    if (np.linalg.norm(away[used], axis=1) > 0).all():
        try:
            along = _moves_along(mesh, away, NULL_RELATIVE)
        except DegenerateError:
            pass
        else:
            square = np.einsum("v,vx,vx->", weight, along, along)
            factor = np.einsum("v,vx,vx->", weight, along, away) / square
            return mesh.with_vertices(mesh.vertices + factor * along)
    return mesh.with_vertices(parallel_field(mesh, wanted, weight))


@checked
def parallel_along(
    mesh: Mesh, axes: ArrayLike, distance: float = 1.0, tolerance: float = NULL_RELATIVE
) -> Mesh:
    """The parallel mesh with vertices v + h_v a_v on given node axes, unique up to its distance.

    Walking along an edge, h_i (a_i x e) = h_j (a_j x e) fixes the next height; torsion-free axes
    whose heights also fit round every face have such a mesh.

    Parameters
    ----------
    axes : (V, 3) directions of any length; at vertices without faces they are not looked at
    distance : mean |h| over the vertices
    tolerance : on the sine between edges of the two meshes, as the greatest turn over one edge

    Raises
    ------
    InputError
        Axes of the wrong shape, not finite or of no length; names the vertex.
    DegenerateError
        An axis along an edge; heights that do not fit, as on axes with torsion. Names the edge.

    Source: mathematics.md 10.2, 10.4.
    """
    return mesh.with_vertices(mesh.vertices + distance * _moves_along(mesh, axes, tolerance))


def _moves_along(mesh: Mesh, axes: ArrayLike, tolerance: float) -> Floats:
    """(V, 3) moves of `parallel_along` at distance 1."""
    a = np.asarray(axes, dtype=np.float64)
    if a.shape != mesh.vertices.shape or not np.isfinite(a).all():
        raise InputError(f"axes: {mesh.vertices.shape} finite numbers are needed")
    used = mesh.valences > 0
    length = np.linalg.norm(a, axis=1)
    if not (length[used] > 0).all():
        raise InputError(f"the axis of vertex {np.argmax(used & (length == 0))} has no length")
    a = unit(a)
    start, end = mesh.edges.T
    e = unit(mesh.edge_vectors)
    here, there = np.cross(a[start], e), np.cross(a[end], e)
    sines = np.stack([np.linalg.norm(part, axis=1) for part in (here, there)], axis=1)
    lying = np.argwhere(sines <= RELATIVE_DEGENERATE)
    if len(lying):
        edge = int(lying[0, 0])
        raise DegenerateError(
            f"the axis of vertex {mesh.edges[tuple(lying[0])]} runs along edge {edge}"
        )
    logs = np.log(sines)
    heights = np.zeros(mesh.n_vertices)
    flips = (np.einsum("ex,ex->e", here, there) < 0).astype(np.float64)
    for part in range(int(mesh.components.max()) + 1):
        root = int(mesh.corners[np.argmax(mesh.components[mesh.corner_face] == part)])
        steps = np.stack([logs[:, 0] - logs[:, 1], flips], axis=1)
        found, reached = tree_sums(mesh.n_vertices, start, end, steps, root)
        size = np.exp(found[:, 0] - found[reached, 0].max())
        sign = 1.0 - 2.0 * (np.rint(found[:, 1]) % 2)
        heights[reached] = (sign * size / size[reached].mean())[reached]
    moved = heights[:, None] * a
    turned = np.linalg.norm(np.cross(moved[end] - moved[start], e), axis=1)
    worst = int(turned.argmax())
    if not turned[worst] <= tolerance * np.abs(heights[mesh.edges[worst]]).max():
        raise DegenerateError(
            f"no parallel mesh has its vertices on these axes: at distance 1 edge {worst} "
            f"({start[worst]}-{end[worst]}) is off by {turned[worst]:.2g} (limit {tolerance:g})"
        )
    return moved


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

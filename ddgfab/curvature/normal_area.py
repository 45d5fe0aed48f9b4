"""Least area by moves along normals: for meshes whose area shrinks on while triangles collapse.

Over all moves of its vertices the area of most triangle meshes has no minimum: vertices slide in
the surface until triangles vanish. Along normals it has one near the smooth minimal surface, and
Newton's method finds it.
Source: Brakke 1992, The Surface Evolver (hessian_normal); mathematics.md 8.4.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import splu

from ddgfab.curvature.cotangent import area_gradient, cotangent_laplacian, triangles_of
from ddgfab.curvature.least_area import GRADIENT_RELATIVE, LeastArea, dirichlet_step, held_vertices
from ddgfab.errors import DegenerateError
from ddgfab.mesh import Floats, Ints, Mesh

MOST_STEPS: Final = 60
"""Newton steps; 5 to 20 are usual."""

ROUNDING: Final = 1e-12
"""Areas that differ by less than this part count as equal; then the gradient decides."""

SMOOTHING: Final = 3
"""Steps of Pinkall and Polthier before Newton's: they take bumps away, after which normals are
those of the surface that is sought."""

SOFTER: Final = 0.2
"""Factor on the damping after a step that is taken."""

STIFFER: Final = 5.0
"""Factor on the damping after a step that is not."""

STIFFEST: Final = 1e8
"""Damping, as a factor on the cotangent Laplacian, beyond which no step is left to try."""


def area_hessian(mesh: Mesh) -> csc_array:
    """(3 V, 3 V) second derivatives of the area by the coordinates (x_0, y_0, z_0, x_1, ...).

    Of a triangle with unit normal n and sides e_i opposite to its corners: between corners i and j
    <e_i, e_j> / (4 A) n n^T, and between i and the next one -1/2 [n]x, its transpose backwards.
    """
    ids = triangles_of(mesh)
    p, n = mesh.vertices[ids], mesh.face_normals
    e = np.roll(p, -2, axis=1) - np.roll(p, -1, axis=1)
    weight = np.einsum("fax,fbx->fab", e, e) / (4.0 * mesh.face_areas)[:, None, None]
    blocks = np.einsum("fab,fi,fj->faibj", weight, n, n)
    turn = -0.5 * np.cross(n[:, None, :], np.eye(3)).swapaxes(1, 2)  # -1/2 [n]x
    for a in range(3):
        blocks[:, a, :, (a + 1) % 3] += turn
        blocks[:, a, :, (a + 2) % 3] -= turn
    at = 3 * ids[..., None] + np.arange(3)
    rows = np.broadcast_to(at[:, :, :, None, None], blocks.shape).ravel()
    columns = np.broadcast_to(at[:, None, None, :, :], blocks.shape).ravel()
    size = (3 * mesh.n_vertices, 3 * mesh.n_vertices)
    return csc_array(coo_array((blocks.ravel(), (rows, columns)), shape=size))


def minimise_area_along_normals(
    mesh: Mesh,
    fixed: ArrayLike | None = None,
    *,
    tolerance: float = GRADIENT_RELATIVE,
    max_steps: int = MOST_STEPS,
    throw: bool = True,
) -> LeastArea:
    """The area made stationary by moves of the vertices along their normals.

    Newton's method, damped by the cotangent Laplacian until the area falls. Triangles keep their
    shape but for the bending; `minimise_area` lets vertices slide as well, which exact discrete
    minimal surfaces and `associated_family` need, and which ends on few meshes only.

    Parameters
    ----------
    mesh : triangles
    fixed : (V,) flags of vertices that stay; by default the boundary's
    tolerance : on the normal part of the area's gradient, as part of the longest edge
    max_steps : steps at most
    throw : raise when it does not converge; else the status says so

    Returns
    -------
    LeastArea, whose gradients are the normal parts

    Raises
    ------
    MeshError
        As `minimise_area`.
    DegenerateError
        A triangle that collapses, or no convergence; names the triangle, or the vertex and the
        gradient left there.

    Source: Brakke 1992; mathematics.md 8.4.
    """
    triangles_of(mesh)
    held = held_vertices(mesh, fixed)
    free = np.flatnonzero(~held & (mesh.valences > 0))
    if not len(free):
        return LeastArea(mesh, "converged", (_area(mesh),), (0.0,))
    limit = tolerance * float(mesh.edge_lengths.max())
    current, damping = mesh, 1.0
    areas, gradients = [_area(mesh)], [_greatest(mesh, free)]
    while gradients[-1] > limit and len(areas) <= max_steps:
        if len(areas) <= SMOOTHING:
            current = dirichlet_step(current, free, held)
        else:
            found, damping = _newton_step(current, free, damping)
            if found is None:
                break
            current = found
        # Where only rounding is left the area may grow by some of it.
        areas.append(min(_area(current), areas[-1]))
        gradients.append(_greatest(current, free))
    status = "converged" if gradients[-1] <= limit else "stopped"
    if status != "converged" and throw:
        worst = int(free[np.abs(_normal_part(current, free)).argmax()])
        raise DegenerateError(
            f"the area is not stationary along normals after {len(areas) - 1} steps: gradient "
            f"{gradients[-1]:.2g} at vertex {worst} (limit {limit:.2g})"
        )
    return LeastArea(current, status, tuple(areas), tuple(gradients))


def _newton_step(mesh: Mesh, free: Ints, damping: float) -> tuple[Mesh | None, float]:
    """The mesh after a step that lowers its area, or None, and the damping to go on with."""
    slope, area, greatest = _normal_part(mesh, free), _area(mesh), _greatest(mesh, free)
    bend, stiff = _along_normals(mesh, free)
    while damping <= STIFFEST:
        step = _solved(csc_array(bend + damping * stiff), -slope)
        if step is not None and slope @ step < 0:
            vertices = mesh.vertices.copy()
            vertices[free] += step[:, None] * mesh.vertex_normals[free]
            tried = mesh.with_vertices(vertices)
            lower = _area(tried) < area * (1.0 - ROUNDING)
            even = _area(tried) <= area * (1.0 + ROUNDING)
            if lower or (even and _greatest(tried, free) < greatest):
                return tried, damping * SOFTER
        damping *= STIFFER
    return None, damping


def _solved(matrix: csc_array, right: Floats) -> Floats | None:
    try:
        found = np.asarray(splu(matrix).solve(right))
    except RuntimeError:  # exactly singular
        return None
    return found if np.isfinite(found).all() else None


def _area(mesh: Mesh) -> float:
    return float(mesh.face_areas.sum())


def _greatest(mesh: Mesh, free: Ints) -> float:
    return float(np.abs(_normal_part(mesh, free)).max())


def _normal_part(mesh: Mesh, free: Ints) -> Floats:
    """Gradient of the area along the normals of the free vertices."""
    return np.asarray(np.einsum("vx,vx->v", area_gradient(mesh)[free], mesh.vertex_normals[free]))


def _along_normals(mesh: Mesh, free: Ints) -> tuple[csc_array, csc_array]:
    """Hessian of the area and cotangent Laplacian, for moves of free vertices along normals."""
    n = mesh.vertex_normals[free]
    rows = (3 * free[:, None] + np.arange(3)).ravel()
    columns = np.repeat(np.arange(len(free)), 3)
    size = (3 * mesh.n_vertices, len(free))
    along = csc_array(coo_array((n.ravel(), (rows, columns)), shape=size))
    laplacian = coo_array(cotangent_laplacian(mesh))
    i, j = laplacian.coords
    index = np.full(mesh.n_vertices, -1)
    index[free] = np.arange(len(free))
    both = (index[i] >= 0) & (index[j] >= 0)
    p, q = index[i[both]], index[j[both]]
    cosine = np.einsum("vx,vx->v", n[p], n[q])
    stiff = coo_array((laplacian.data[both] * cosine, (p, q)), shape=(len(free),) * 2)
    return csc_array(along.T @ area_hessian(mesh) @ along), csc_array(stiff)

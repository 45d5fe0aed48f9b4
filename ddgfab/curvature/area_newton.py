"""Newton's method for the area of triangle meshes: its second derivatives, steps, collapse.

Source: Brakke 1992, The Surface Evolver (hessian, hessian_normal); mathematics.md 8.4.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import splu

from ddgfab.arguments import checked
from ddgfab.curvature.cotangent import area_gradient, cotangent_laplacian, triangles_of
from ddgfab.errors import DegenerateError
from ddgfab.mesh import Floats, Ints, Mesh

ROUNDING: Final = 1e-12
"""Areas that differ by less than this part count as equal; then the gradient decides."""

SOFTER: Final = 0.2
"""Factor on the damping after a step that is taken."""

STIFFER: Final = 5.0
"""Factor on the damping after a step that is not."""

STIFFEST: Final = 1e8
"""Damping, as a factor on the cotangent Laplacian, beyond which no step is left to try."""

NEAR: Final = 1e-6
"""Below this gradient, in parts of the longest edge, undamped steps that halve it are taken."""

COLLAPSED: Final = 1e-4
"""A triangle whose height over its longest side falls to this part of what it was is collapsing."""


@checked
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


def triangle_shapes(mesh: Mesh) -> Floats:
    """(F,) height of each triangle over its longest side; 0.87 where it is equilateral."""
    longest = mesh.edge_lengths[mesh.corner_edge].reshape(-1, 3).max(axis=1)
    return np.asarray(2.0 * mesh.face_areas / longest**2)


def refuse_collapse(mesh: Mesh, shapes: Floats, step: int) -> None:
    """Raise where a triangle is flat against what it was.

    Raises
    ------
    DegenerateError
        Names the triangle, its vertices and both shapes.
    """
    now = triangle_shapes(mesh)
    worst = int((now / shapes).argmin())
    if not now[worst] > COLLAPSED * shapes[worst]:
        a, b, c = mesh.corners.reshape(-1, 3)[worst]
        raise DegenerateError(
            f"triangle {worst} ({a}, {b}, {c}) collapses: after {step} steps its height over its "
            f"longest side is {now[worst]:.2g}, at the start {shapes[worst]:.2g} (limit "
            f"{COLLAPSED:g} of that); the boundary spans no minimal mesh of these triangles\n"
            "cut the quads by the other diagonals (triangulate with alternate), or hold vertices "
            "to their normals (minimize_area_along_normals)"
        )


def greatest_gradient(mesh: Mesh, free: Ints, *, normal: bool) -> float:
    """Greatest length at the free vertices of the area's gradient, or of its normal part."""
    gradient = area_gradient(mesh)[free]
    if normal:
        return float(np.abs(np.einsum("vx,vx->v", gradient, mesh.vertex_normals[free])).max())
    return float(np.linalg.norm(gradient, axis=1).max())


def area_of(mesh: Mesh) -> float:
    """Sum of the areas of the faces."""
    return float(mesh.face_areas.sum())


def newton_step(
    mesh: Mesh, free: Ints, damping: float, *, normal: bool
) -> tuple[Mesh | None, float]:
    """The mesh after a step that lowers its area, or None, and the damping to go on with.

    The Hessian is damped by the cotangent Laplacian until the area falls; near a stationary mesh,
    which may be a saddle of the area, undamped steps are taken while they halve the gradient.

    Parameters
    ----------
    free : ids of the vertices that move
    normal : whether they move along their normals only
    """
    ways = _directions(mesh, free, normal=normal)
    slope = ways.T @ area_gradient(mesh).ravel()
    bend = csc_array(ways.T @ area_hessian(mesh) @ ways)
    stiff = _stiffness(mesh, free, normal=normal)
    area, greatest = area_of(mesh), greatest_gradient(mesh, free, normal=normal)

    def tried(step: Floats) -> tuple[Mesh, float, float]:
        moved = mesh.with_vertices(mesh.vertices + (ways @ step).reshape(-1, 3))
        try:
            return moved, area_of(moved), greatest_gradient(moved, free, normal=normal)
        except DegenerateError:  # a triangle without area
            return moved, np.inf, np.inf

    if greatest <= NEAR * float(mesh.edge_lengths.max()):
        step = _solved(bend, -slope)
        if step is not None:
            moved, _, left = tried(step)
            if left <= 0.5 * greatest:
                return moved, damping
    while damping <= STIFFEST:
        step = _solved(csc_array(bend + damping * stiff), -slope)
        if step is not None and slope @ step < 0:
            moved, now, left = tried(step)
            lower = now < area * (1.0 - ROUNDING)
            even = now <= area * (1.0 + ROUNDING)
            if lower or (even and left < greatest):
                return moved, damping * SOFTER
        damping *= STIFFER
    return None, damping


def _solved(matrix: csc_array, right: Floats) -> Floats | None:
    """A solution, if there is one; with pivots, as second derivatives may be indefinite."""
    try:
        found = np.asarray(splu(matrix).solve(right))
    except RuntimeError:  # exactly singular
        return None
    return found if np.isfinite(found).all() else None


def _directions(mesh: Mesh, free: Ints, *, normal: bool) -> csc_array:
    """(3 V, n) moves of the free vertices: along their normals, or along the three axes."""
    rows = (3 * free[:, None] + np.arange(3)).ravel()
    columns = np.repeat(np.arange(len(free)), 3) if normal else np.arange(3 * len(free))
    values = mesh.vertex_normals[free].ravel() if normal else np.ones(3 * len(free))
    size = (3 * mesh.n_vertices, len(free) if normal else 3 * len(free))
    return csc_array(coo_array((values, (rows, columns)), shape=size))


def _stiffness(mesh: Mesh, free: Ints, *, normal: bool) -> csc_array:
    """Cotangent Laplacian for the same moves."""
    laplacian = coo_array(cotangent_laplacian(mesh))
    i, j = laplacian.coords
    index = np.full(mesh.n_vertices, -1)
    index[free] = np.arange(len(free))
    both: NDArray[np.bool_] = (index[i] >= 0) & (index[j] >= 0)
    p, q, data = index[i[both]], index[j[both]], laplacian.data[both]
    if normal:
        n = mesh.vertex_normals[free]
        data = data * np.einsum("vx,vx->v", n[p], n[q])
        return csc_array(coo_array((data, (p, q)), shape=(len(free),) * 2))
    rows, columns = ((3 * k[:, None] + np.arange(3)).ravel() for k in (p, q))
    return csc_array(coo_array((np.repeat(data, 3), (rows, columns)), shape=(3 * len(free),) * 2))

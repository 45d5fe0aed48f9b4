"""Triangle meshes of least area with a fixed boundary, by Newton's method.

Over all moves of its vertices the area of many triangle meshes has no minimum: vertices slide in
the surface until triangles vanish. Along normals it has one near the smooth minimal surface.
Source: Pinkall, Polthier 1993, Computing discrete minimal surfaces and their conjugates; Brakke
1992, The Surface Evolver; mathematics.md 8.4.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ddgfab.arguments import checked
from ddgfab.curvature.area_newton import (
    area_of,
    greatest_gradient,
    newton_step,
    refuse_collapse,
    triangle_shapes,
)
from ddgfab.curvature.cotangent import area_gradient, cotangent_laplacian, triangles_of
from ddgfab.errors import DegenerateError, MeshError
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.symmetric import factored

GRADIENT_RELATIVE: Final = 1e-10
"""The iteration ends when the area's gradient at free vertices falls below this part of the
greatest edge."""

MOST_STEPS: Final = 100
"""Newton steps; 5 to 30 are usual."""

SMOOTHING: Final = 3
"""Steps of Pinkall and Polthier before Newton's: they take bumps away, after which normals are
those of the surface that is sought."""

SOFT_START: Final = 1e-3
"""Damping of the first step in all directions after the steps along normals, which end near."""


@dataclass(frozen=True, eq=False)
class LeastArea:
    """A mesh whose area is stationary, in general the least near by.

    Attributes
    ----------
    mesh : the result
    status : "converged": the gradient of the area is zero, in all directions; "normal": its part
        along the normals is, the rest is not; "stopped": neither
    areas : area before each step and after the last
    gradients : greatest length of the area's gradient at a free vertex, likewise
    normal_gradients : greatest part of it along the normals, likewise
    """

    mesh: Mesh
    status: str
    areas: tuple[float, ...]
    gradients: tuple[float, ...]
    normal_gradients: tuple[float, ...]


@checked
def minimize_area(
    mesh: Mesh,
    fixed: ArrayLike | None = None,
    *,
    tolerance: float = GRADIENT_RELATIVE,
    max_steps: int = MOST_STEPS,
    throw: bool = True,
) -> LeastArea:
    """The area made stationary in all directions: its gradient at free vertices becomes zero.

    Newton's method, damped by the cotangent Laplacian until the area falls; first along normals,
    then in all directions, and where triangles collapse that way, in all directions from the start.
    Some meshes have no stationary position near by: vertices slide in the surface until triangles
    collapse (see `minimize_area_along_normals`).

    Parameters
    ----------
    mesh : triangles
    fixed : (V,) flags of vertices that stay; by default the boundary's
    tolerance : on the gradient, as part of the longest edge
    max_steps : steps at most, of each of the iterations
    throw : raise when it does not converge; else the status says so

    Raises
    ------
    MeshError
        A face that is not a triangle, flags of the wrong shape, a component without a fixed vertex.
    DegenerateError
        A triangle that collapses (the boundary spans no such mesh; a neck pinches off), or no
        convergence; names the triangle, or the vertex and the gradient left there.

    Source: Brakke 1992; mathematics.md 8.4.
    """
    held, free, limit = _begin(mesh, fixed, tolerance)
    if not len(free):
        return LeastArea(mesh, "converged", (area_of(mesh),), (0.0,), (0.0,))
    shapes = triangle_shapes(mesh)
    try:
        found = _iterate(mesh, held, free, limit, max_steps, shapes, normal=True)
        found = _iterate(
            found.mesh, held, free, limit, max_steps, shapes, normal=False, before=found
        )
        if found.status == "converged":
            return found
    except DegenerateError:
        pass  # the way from the start decides, and says which triangle collapses there
    found = _iterate(mesh, held, free, limit, max_steps, shapes, normal=False)
    if found.status != "converged" and throw:
        gradient = np.linalg.norm(area_gradient(found.mesh)[free], axis=1)
        raise DegenerateError(
            f"the area is not stationary after {len(found.areas) - 1} steps: gradient "
            f"{found.gradients[-1]:.2g} at vertex {free[gradient.argmax()]} (limit {limit:.2g})\n"
            "vertices of many meshes slide on for ever: hold them to their normals "
            "(minimize_area_along_normals)"
        )
    return found


@checked
def minimize_area_along_normals(
    mesh: Mesh,
    fixed: ArrayLike | None = None,
    *,
    tolerance: float = GRADIENT_RELATIVE,
    max_steps: int = MOST_STEPS,
    throw: bool = True,
) -> LeastArea:
    """The area made stationary by moves of the vertices along their normals.

    Newton's method, damped by the cotangent Laplacian until the area falls. Triangles keep their
    shape but for the bending. What is left of the gradient lies in the surface, and the status says
    so ("normal"): `minimize_area` lets vertices slide as well, which exact discrete minimal
    surfaces and `associated_family` need.

    Parameters
    ----------
    mesh : triangles
    fixed : (V,) flags of vertices that stay; by default the boundary's
    tolerance : on the normal part of the area's gradient, as part of the longest edge
    max_steps : steps at most
    throw : raise when not even the normal part vanishes; else the status says so

    Returns
    -------
    LeastArea, with status "normal", or "converged" where the whole gradient vanishes

    Raises
    ------
    MeshError
        As `minimize_area`.
    DegenerateError
        A triangle that collapses, or no convergence; names the triangle, or the vertex and the
        gradient left there.

    Source: Brakke 1992; mathematics.md 8.4.
    """
    held, free, limit = _begin(mesh, fixed, tolerance)
    if not len(free):
        return LeastArea(mesh, "converged", (area_of(mesh),), (0.0,), (0.0,))
    found = _iterate(mesh, held, free, limit, max_steps, triangle_shapes(mesh), normal=True)
    if found.status == "stopped" and throw:
        n = found.mesh.vertex_normals[free]
        part = np.abs(np.einsum("vx,vx->v", area_gradient(found.mesh)[free], n))
        raise DegenerateError(
            f"the area is not stationary along normals after {len(found.areas) - 1} steps: "
            f"gradient {found.normal_gradients[-1]:.2g} at vertex {free[part.argmax()]} (limit "
            f"{limit:.2g})"
        )
    return found


def _begin(
    mesh: Mesh, fixed: ArrayLike | None, tolerance: float
) -> tuple[NDArray[np.bool_], Ints, float]:
    """Flags of the vertices that stay, ids of the free ones, the limit on the gradient."""
    triangles_of(mesh)
    held = held_vertices(mesh, fixed)
    free = np.flatnonzero(~held & (mesh.valences > 0))
    return held, free, tolerance * float(mesh.edge_lengths.max())


def _iterate(
    mesh: Mesh, held: NDArray[np.bool_], free: Ints, limit: float, max_steps: int, shapes: Floats,
    *, normal: bool, before: LeastArea | None = None,
) -> LeastArea:  # fmt: skip
    """Steps until the gradient, or its normal part, falls to the limit; `before` goes first."""
    current, damping = mesh, 1.0 if before is None else SOFT_START
    areas, whole, across = [area_of(mesh)], [], []

    def note() -> float:
        whole.append(greatest_gradient(current, free, normal=False))
        across.append(greatest_gradient(current, free, normal=True))
        return across[-1] if normal else whole[-1]

    left = note()
    while left > limit and len(areas) <= max_steps:
        if before is None and len(areas) <= SMOOTHING:
            current = dirichlet_step(current, free, held)
        else:
            found, damping = newton_step(current, free, damping, normal=normal)
            if found is None:
                break
            current = found
        refuse_collapse(current, shapes, len(areas))
        areas.append(area_of(current))
        left = note()
    status = "converged" if whole[-1] <= limit else "normal" if across[-1] <= limit else "stopped"
    if before is not None:
        areas = [*before.areas, *areas[1:]]
        whole = [*before.gradients, *whole[1:]]
        across = [*before.normal_gradients, *across[1:]]
    return LeastArea(current, status, tuple(areas), tuple(whole), tuple(across))


def held_vertices(mesh: Mesh, fixed: ArrayLike | None) -> NDArray[np.bool_]:
    """(V,) flags of the vertices that stay, by default the boundary's; some in each component.

    Raises
    ------
    MeshError
        Flags of the wrong shape, or a component without a fixed vertex; names a face of it.
    """
    held = mesh.boundary_vertex if fixed is None else np.asarray(fixed)
    if held.shape != (mesh.n_vertices,) or held.dtype != np.bool_:
        raise MeshError(f"fixed: ({mesh.n_vertices},) flags are needed, not {held.shape}")
    touched = np.maximum.reduceat(held[mesh.corners], mesh.face_start[:-1])
    holding = np.bincount(mesh.components, touched)
    loose = np.flatnonzero(holding == 0)
    if len(loose):
        face = int(np.argmax(mesh.components == loose[0]))
        raise MeshError(
            f"no vertex is fixed in the component of face {face}: it would shrink to a point"
        )
    return held


def dirichlet_step(mesh: Mesh, free: Ints, held: NDArray[np.bool_]) -> Mesh:
    """The mesh of least Dirichlet energy over this one, with the held vertices where they are.

    Source: Pinkall, Polthier 1993.
    """
    laplacian = cotangent_laplacian(mesh)[free]
    ends = np.flatnonzero(held)
    right = -laplacian[:, ends] @ mesh.vertices[ends]
    vertices = mesh.vertices.copy()
    vertices[free] = factored(laplacian[:, free]).solve(right)
    return mesh.with_vertices(vertices)

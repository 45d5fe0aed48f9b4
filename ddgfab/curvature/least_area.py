"""Triangle meshes of least area with a fixed boundary, and their associated families.

Source: Pinkall, Polthier 1993; Polthier 2002, Computational aspects of discrete minimal surfaces;
mathematics.md 8.4.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import splu

from ddgfab.curvature.cotangent import area_gradient, cotangent_laplacian, triangles_of
from ddgfab.errors import DegenerateError, MeshError
from ddgfab.mesh import Floats, Ints, Mesh, extent
from ddgfab.tolerances import NET_INPUT

GRADIENT_RELATIVE: Final = 1e-10
"""The iteration ends when the area's gradient at free vertices falls below this part of the
greatest edge."""

MOST_STEPS: Final = 300
"""Steps after which the iteration counts as not converging."""

MEMORY: Final = 6
"""Steps that Anderson's acceleration remembers: the plain iteration is linear, at 0.97 a step and
more near the widest catenoid."""


_ADVICE = (
    "vertices of most meshes slide on for ever: hold them to their normals "
    "(minimise_area_along_normals)"
)


@dataclass(frozen=True, eq=False)
class LeastArea:
    """A mesh of (locally) least area.

    Attributes
    ----------
    mesh : the result
    status : "converged" or "stopped"
    areas : area before each step and after the last
    gradients : greatest length of the area's gradient at a free vertex, likewise
    """

    mesh: Mesh
    status: str
    areas: tuple[float, ...]
    gradients: tuple[float, ...]


def minimise_area(
    mesh: Mesh,
    fixed: ArrayLike | None = None,
    *,
    tolerance: float = GRADIENT_RELATIVE,
    max_steps: int = MOST_STEPS,
    throw: bool = True,
) -> LeastArea:
    """Pinkall and Polthier's iteration: solve the cotangent Laplacian of the mesh, again and again.

    Each step minimises the Dirichlet energy of maps from the present mesh, which never lets the
    area grow. Anderson's acceleration is taken wherever it lowers the area further. It ends at
    meshes that are minimal in all directions, as symmetric or small ones can be; on most others
    vertices slide in the surface without end: see `minimise_area_along_normals`.

    Parameters
    ----------
    mesh : triangles
    fixed : (V,) flags of vertices that stay; by default the boundary's
    tolerance : on the gradient, as part of the longest edge
    max_steps : steps at most
    throw : raise when it does not converge; else the status says so

    Raises
    ------
    MeshError
        A face that is no triangle, flags of the wrong shape, a component without a fixed vertex.
    DegenerateError
        A triangle that collapses (the boundary spans no such surface; a neck pinches off), or no
        convergence; names the triangle, or the vertex and the gradient left there.

    Source: mathematics.md 8.4.
    """
    triangles_of(mesh)
    held = held_vertices(mesh, fixed)
    free = np.flatnonzero(~held & (mesh.valences > 0))
    if not len(free):
        return LeastArea(mesh, "converged", (float(mesh.face_areas.sum()),), (0.0,))
    limit = tolerance * float(mesh.edge_lengths.max())
    areas, gradients = [], []
    current = mesh
    past: list[tuple[Floats, Floats]] = []
    status = "stopped"
    for step in range(max_steps + 1):
        try:
            length = np.linalg.norm(area_gradient(current)[free], axis=1)
        except DegenerateError as error:
            raise DegenerateError(
                f"after {step} steps {error}; the surface pinches off, or vertices slide together"
                f"\n{_ADVICE}"
            ) from error
        areas.append(float(current.face_areas.sum()))
        gradients.append(float(length.max()))
        if gradients[-1] <= limit:
            status = "converged"
            break
        if step < max_steps:
            plain = dirichlet_step(current, free, held)
            past = [*past[-MEMORY:], (current.vertices[free].ravel(), plain.vertices[free].ravel())]
            current = _accelerated(plain, free, past)
    if status != "converged" and throw:
        worst = int(free[np.argmax(length)])
        raise DegenerateError(
            f"the area is not stationary after {max_steps} steps: gradient {gradients[-1]:.2g} at "
            f"vertex {worst} (limit {limit:.2g})\n{_ADVICE}"
        )
    return LeastArea(current, status, tuple(areas), tuple(gradients))


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
    """The mesh of least Dirichlet energy over this one, with the held vertices where they are."""
    laplacian = cotangent_laplacian(mesh)[free]
    ends = np.flatnonzero(held)
    right = -laplacian[:, ends] @ mesh.vertices[ends]
    vertices = mesh.vertices.copy()
    vertices[free] = splu(csc_array(laplacian[:, free])).solve(right)
    return mesh.with_vertices(vertices)


def _accelerated(plain: Mesh, free: Ints, past: list[tuple[Floats, Floats]]) -> Mesh:
    """Anderson's mixture of the last steps where its area is less than the plain step's."""
    if len(past) < 2:
        return plain
    before, after = (np.array(part) for part in zip(*past, strict=True))
    change = after - before
    weights = np.linalg.lstsq(np.diff(change, axis=0).T, change[-1], rcond=None)[0]
    vertices = plain.vertices.copy()
    vertices[free] = (after[-1] - weights @ np.diff(after, axis=0)).reshape(-1, 3)
    mixed = plain.with_vertices(vertices)
    return mixed if mixed.face_areas.sum() < plain.face_areas.sum() else plain


@dataclass(frozen=True, eq=False)
class AssociatedFamily:
    """The associated family of a minimal triangle mesh, on the midpoints of its edges.

    points : (E, 3) midpoints of the mesh's edges; conjugate : (E, 3) those of the conjugate
        surface, the first at the origin; triangles : (F, 3) their ids, congruent for all angles
    closing : greatest gap between two triangles that share a midpoint, over the surface's size
    """

    points: Floats
    conjugate: Floats
    triangles: Ints
    closing: float

    def at(self, angle: float) -> Floats:
        """(E, 3) points cos(angle) x + sin(angle) x*; pi / 2 is the conjugate surface."""
        return np.asarray(np.cos(angle) * self.points + np.sin(angle) * self.conjugate)


def associated_family(mesh: Mesh) -> AssociatedFamily:
    """Conjugate and associated surfaces: triangles of edge midpoints turned in their planes.

    Turned by a right angle, the triangles of midpoints fit together round every interior vertex
    exactly when the area is stationary there. The surfaces are nonconforming: triangles share
    midpoints of edges, not edges.

    Raises
    ------
    MeshError
        A face that is no triangle, several components, or a surface that is not simply connected
        (its conjugate has periods: cut it open).
    DegenerateError
        The mesh is not minimal, so the conjugate does not close; gives the gap.

    Source: Pinkall, Polthier 1993, section 4; Polthier 2002.
    """
    ids = triangles_of(mesh)
    if mesh.components.max() > 0:
        raise MeshError("the mesh has several components: take one at a time")
    euler = int((mesh.valences > 0).sum()) - mesh.n_edges + mesh.n_faces
    if euler != 1:
        raise MeshError(
            f"the mesh has Euler characteristic {euler}, a disc has 1: its conjugate surface has "
            "periods; cut it open"
        )
    sides = mesh.corner_edge.reshape(-1, 3)
    middles = mesh.vertices[mesh.edges].mean(axis=1)
    steps = np.roll(middles[sides], -1, axis=1) - middles[sides]
    turned = np.cross(mesh.face_normals[:, None], steps)
    conjugate = _integrate(mesh.n_edges, sides, turned)
    gap = np.roll(conjugate[sides], -1, axis=1) - conjugate[sides] - turned
    size = extent(conjugate)
    closing = float(np.linalg.norm(gap, axis=-1).max()) / size
    if not closing <= NET_INPUT:
        inner = np.where(mesh.boundary_vertex, 0.0, np.linalg.norm(area_gradient(mesh), axis=1))
        worst = int(inner.argmax())
        raise DegenerateError(
            f"the conjugate surface does not close: gap {closing:.2g} of its size (limit "
            f"{NET_INPUT:g}); the area is not stationary, gradient {inner[worst]:.2g} at vertex "
            f"{worst} of the {len(ids)} triangles: minimise_area first"
        )
    return AssociatedFamily(middles, conjugate, sides, closing)


def _integrate(count: int, sides: Ints, steps: Floats) -> Floats:
    """Points whose differences along the triangles' sides are nearest to the steps."""
    start, end = sides.ravel(), np.roll(sides, -1, axis=1).ravel()
    rows = np.arange(len(start))
    ones = np.ones(len(start))
    values = np.concatenate([ones, -ones])
    places = (np.concatenate([rows, rows]), np.concatenate([end, start]))
    difference = csc_array(coo_array((values, places), shape=(len(start), count)))
    rest = difference[:, 1:]  # the first point is the origin
    out = np.zeros((count, 3))
    out[1:] = splu(csc_array(rest.T @ rest)).solve(rest.T @ steps.reshape(-1, 3))
    return out

"""Koebe polyhedra: every edge touches the unit sphere; one for each combinatorial polyhedron."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ddgfab.arguments import checked
from ddgfab.circles import Circles, Spheres, circles_on_sphere
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.nets.koebe.centering import centring
from ddgfab.nets.koebe.checks import check_polyhedron
from ddgfab.nets.koebe.pattern import CirclePattern, planar_circles
from ddgfab.nets.sisothermic import SIsothermic
from ddgfab.nets.sisothermic_labels import piece
from ddgfab.quads import finite
from ddgfab.tolerances import UNIT_NORMAL

SMALLEST: Final = 1e-9
"""Circles smaller than this on the unit sphere are refused: too few digits are left for edges."""


@dataclass(frozen=True, eq=False, repr=False)
class KoebePolyhedron:
    """A convex polyhedron whose edges touch the unit sphere, with its two circle packings.

    The face planes cut the sphere in the circles of one packing; the cones that touch the sphere
    from the vertices, in those of the other. Circles meet at the contact points of the edges.

    Attributes
    ----------
    mesh : the polyhedron; vertex and face ids are those given
    vertex_vectors : (V, 4) circles of the vertices in Lorentz space, <a, x> = b as (a, b)
    face_vectors : (F, 4) circles of the faces
    history : greatest missing angle [rad] after each step of Newton's method
    """

    mesh: Mesh
    vertex_vectors: Floats
    face_vectors: Floats
    history: tuple[float, ...]

    @cached_property
    def contacts(self) -> Floats:
        """(E, 3) points where the edges touch the sphere."""
        return _points(_light(self.mesh, self.vertex_vectors))

    @cached_property
    def radii(self) -> Floats:
        """(V,) distance from each vertex to the contact points of its edges, sqrt(|v|^2 - 1)."""
        return np.asarray(1.0 / self.vertex_vectors[:, 3])

    @cached_property
    def vertex_circles(self) -> Circles:
        """Circle in which the cone from each vertex touches the sphere."""
        return circles_on_sphere(self.vertex_vectors)

    @cached_property
    def face_circles(self) -> Circles:
        """Incircle of each face, in which its plane cuts the sphere."""
        return circles_on_sphere(self.face_vectors)

    @cached_property
    def vertex_spheres(self) -> Spheres:
        """Sphere about each vertex through its contact points, orthogonal to the unit sphere."""
        return Spheres(self.mesh.vertices, self.radii)

    def net(self, faces: Ints | NDArray[np.bool_] | None = None) -> SIsothermic:
        """The polyhedron, or the piece of some faces (ids or a mask), as an s-isothermic net.

        Raises
        ------
        MeshError
            A piece without faces, or whose faces meet in a vertex only.
        """
        if faces is None:
            return SIsothermic(self.mesh, self.radii)
        part = piece(self.mesh, faces)
        return SIsothermic(part.mesh, self.radii[part.vertices])

    def residuals(self) -> dict[str, float]:
        """Greatest defect of each defining condition, as lengths on a sphere of radius 1.

        tangency : distance of the edges' lines from the center, less 1
        planarity : of the corners from the planes of their faces
        packing : distance of circles of neighbouring faces at their contact point
        interior : how far a contact point is beyond the ends of its edge; negative: none is
        centring : length of the mean of the contact points
        """
        mesh = self.mesh
        start = mesh.vertices[mesh.edges[:, 0]]
        along = mesh.edge_vectors / mesh.edge_lengths[:, None]
        across = start - np.einsum("ij,ij->i", start, along)[:, None] * along
        planes = self.face_vectors / np.linalg.norm(self.face_vectors[:, :3], axis=1)[:, None]
        at = planes[mesh.corner_face]
        height = np.einsum("cx,cx->c", at[:, :3], mesh.vertices[mesh.corners]) - at[:, 3]
        left, right = planes[mesh.edge_faces[:, 0]], planes[mesh.edge_faces[:, 1]]
        off = [np.einsum("ex,ex->e", p[:, :3], self.contacts) - p[:, 3] for p in (left, right)]
        way = -np.einsum("ij,ij->i", start, along)
        return {
            "tangency": float(np.abs(np.linalg.norm(across, axis=1) - 1.0).max()),
            "planarity": float(np.abs(height).max()),
            "packing": float(np.abs(np.concatenate(off)).max()),
            "interior": float(np.maximum(-way, way - mesh.edge_lengths).max()),
            "centring": float(np.linalg.norm(self.contacts.mean(axis=0))),
        }

    def turned(self, rotation: ArrayLike) -> KoebePolyhedron:
        """The polyhedron under a rotation (3, 3).

        Raises
        ------
        InputError
            The matrix is not a rotation.
        """
        matrix = np.asarray(rotation, dtype=np.float64)
        if matrix.shape != (3, 3):
            raise InputError(f"a rotation is an orthogonal (3, 3) matrix; given {matrix.shape}")
        finite(matrix, "rotation")
        off = float(np.abs(matrix @ matrix.T - np.eye(3)).max())
        if off > UNIT_NORMAL or np.linalg.det(matrix) < 0:
            raise InputError(
                f"a rotation is an orthogonal matrix: this one is off by {off:.2g} (limit "
                f"{UNIT_NORMAL:g}), with determinant {np.linalg.det(matrix):.3g}; 1 is needed"
            )
        vectors = [v.copy() for v in (self.vertex_vectors, self.face_vectors)]
        for v in vectors:
            v[:, :3] = v[:, :3] @ matrix.T
        return replace(
            self,
            mesh=self.mesh.with_vertices(self.mesh.vertices @ matrix.T),
            vertex_vectors=vectors[0],
            face_vectors=vectors[1],
        )

    def aligned(self, vertices: ArrayLike) -> KoebePolyhedron:
        """The polyhedron turned so that its vertices are nearest to given ones (V, 3).

        Source: orthogonal Procrustes problem (Kabsch 1976).
        """
        wanted = np.asarray(vertices, dtype=np.float64)
        if wanted.shape != self.mesh.vertices.shape:
            raise InputError(
                f"vertices have shape {wanted.shape}; expected {self.mesh.vertices.shape}"
            )
        finite(wanted, "vertices")
        u, _, vt = np.linalg.svd(wanted.T @ self.mesh.vertices)
        flip = np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ vt))])
        return self.turned(u @ flip @ vt)

    def __repr__(self) -> str:
        return (
            f"KoebePolyhedron({self.mesh.n_vertices} vertices, {self.mesh.n_edges} edges, "
            f"{self.mesh.n_faces} faces, missing angle {self.history[-1]:.1e} rad)"
        )


@checked
def koebe(
    faces: Mesh | Sequence[Sequence[int]] | Sequence[Ints], *, infinity: int | None = None
) -> KoebePolyhedron:
    """The Koebe polyhedron of a combinatorial polyhedron, centered on its contact points.

    It exists for every 3-connected planar graph and is unique up to rotations and reflections
    when the contact points have mean zero (the mean of its vertices is another point in general).

    Parameters
    ----------
    faces : polygons of vertex ids, counterclockwise seen from outside; of a mesh only the faces
        are used (see `KoebePolyhedron.aligned` to turn the result towards its vertices)
    infinity : edge whose contact point is sent to infinity for the computation; it changes the
        conditioning and the rotation of the result only. Default: an edge with large faces and
        vertices of high degree.

    Raises
    ------
    MeshError
        Not the faces of a polyhedron (see `koebe_checks.check_polyhedron`): boundary, several
        components, handles, a cut vertex or a cut pair, which are named.
    InputError
        No such edge `infinity`.
    DegenerateError
        A polyhedron so long and thin that circles at its ends vanish (names one), or a numerical
        method that did not arrive (never seen on a polyhedron that passed the checks).

    Source: Koebe 1936; Springborn 2005; Bobenko, Springborn 2004; mathematics.md 7.1.

    >>> tetrahedron = koebe([[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]])
    >>> round(float(tetrahedron.radii[0]) ** 2, 9)
    2.0
    """
    mesh = faces if isinstance(faces, Mesh) else _plain(faces)
    check_polyhedron(mesh)
    if infinity is not None and infinity not in range(mesh.n_edges):
        raise InputError(f"edge {infinity} at infinity: the polyhedron has {mesh.n_edges} edges")
    pattern = CirclePattern(mesh, _large_edge(mesh) if infinity is None else int(infinity))
    radii, history = pattern.radii()
    largest = float(radii[np.isfinite(radii)].max())
    _refuse_small(mesh, np.sqrt(radii / largest))  # a circle on the sphere is no larger than that
    vectors = planar_circles(pattern, radii)
    n = mesh.n_vertices
    move = centring(_light(mesh, vectors[:n]))[0]
    vectors = vectors @ move.T
    _refuse_small(mesh, 1.0 / np.linalg.norm(vectors[:, :3], axis=1))
    at_vertices, at_faces = vectors[:n], vectors[n:]
    solid = mesh.with_vertices(at_vertices[:, :3] / at_vertices[:, 3:])
    return KoebePolyhedron(solid, at_vertices, at_faces, history)


def _refuse_small(mesh: Mesh, radii: Floats) -> None:
    """Raise where a circle is so small that coordinates on the sphere do not resolve it."""
    least = int(radii.argmin())
    if radii[least] < SMALLEST:
        n = mesh.n_vertices
        what = f"vertex {least}" if least < n else f"face {least - n}"
        raise DegenerateError(
            f"the circle of {what} is smaller than {SMALLEST:g} of the sphere, too small for "
            "double precision\nthe polyhedron is too long and thin: take fewer cells along it, or "
            "more around it"
        )


def _plain(faces: Sequence[Sequence[int]] | Sequence[Ints]) -> Mesh:
    """Faces without places for their vertices as a mesh."""
    most = max((int(np.max(face)) for face in faces if len(face)), default=-1)
    return Mesh.build(np.zeros((most + 1, 3)), faces)


def _large_edge(mesh: Mesh) -> int:
    """The first edge of those with the most neighbours in all."""
    degree = mesh.valences[mesh.edges].sum(axis=1) + mesh.face_sizes[mesh.edge_faces].sum(axis=1)
    return int(degree.argmax())


def _light(mesh: Mesh, vectors: Floats) -> Floats:
    """(E, 4) contact points on the light cone: the sum of two touching circles."""
    return np.asarray(vectors[mesh.edges[:, 0]] + vectors[mesh.edges[:, 1]])


def _points(light: Floats) -> Floats:
    return np.asarray(light[:, :3] / light[:, 3:])

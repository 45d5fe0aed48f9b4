"""Mesh: vertices and polygonal faces of an oriented manifold surface, with its edges and stars.

Faces are kept as polygons in one flat list of *corners* (half-edges): corner ``c`` belongs to face
``corner_face[c]``, starts at vertex ``corners[c]`` and runs to the next corner of its face.
All ids count from 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ddgfab.arguments import checked, is_numeric
from ddgfab.errors import MeshError
from ddgfab.mesh_tables import edge_tables, frozen, loops_of, require_manifold, star_tables

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def unit(vectors: Floats) -> Floats:
    """Vectors divided by their lengths along the last axis; a zero vector stays zero."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    out = np.zeros_like(vectors)
    np.divide(vectors, length, out=out, where=length > 0)
    return out


def extent(points: Floats) -> float:
    """Twice the greatest distance of (..., dim) points from their mean.

    The size of a set of points for tolerances: no motion, reflection or numbering changes it, as
    they would change the diagonal of an axis-parallel box. At least the greatest distance of two
    points, at most twice that.
    """
    rows = points.reshape(-1, points.shape[-1])
    if not len(rows):
        return 0.0
    return 2.0 * float(np.linalg.norm(rows - rows.mean(axis=0), axis=1).max())


@dataclass(frozen=True, eq=False, repr=False)
class Mesh:
    """An oriented manifold polygon mesh.

    Make one with `Mesh.build` (from lists of faces); the constructor trusts its arrays.

    Attributes
    ----------
    vertices : (V, 3) float, in the caller's unit (millimetres in the main job)
    corners : (C,) int, vertex of each corner, face after face
    face_start : (F + 1,) int, first corner of each face
    """

    vertices: Floats
    corners: Ints
    face_start: Ints

    @staticmethod
    def build(vertices: ArrayLike, faces: Sequence[Sequence[int]] | Sequence[Ints] | Ints) -> Mesh:
        """Mesh of (V, 3) vertices and polygons of vertex ids; checks shape, range and manifoldness.

        Raises
        ------
        MeshError
            No faces, fewer than three corners, ids out of range, coordinates that are not finite,
            an edge with three faces or with two that run the same way, a vertex where sheets meet.
        """
        if not is_numeric(vertices):
            raise MeshError(
                f"vertices of type {type(vertices).__name__}; (V, 3) numbers are needed"
            )
        points = np.array(vertices, dtype=np.float64)
        if points.ndim != 2 or points.shape[1] != 3:
            raise MeshError(f"vertices have shape {points.shape}; expected (V, 3)")
        try:
            sizes = np.array([len(face) for face in faces], dtype=np.int64)
        except TypeError:
            raise MeshError("faces: a list of lists of vertex ids is needed") from None
        if len(sizes) == 0:
            raise MeshError("the mesh has no faces")
        if sizes.min() < 3:
            raise MeshError(f"face {int(sizes.argmin())} has {int(sizes.min())} corners; 3 needed")
        flat = np.concatenate([np.asarray(face) for face in faces])
        if flat.dtype.kind not in "iu":
            raise MeshError(f"faces hold {flat.dtype} values; whole numbers are needed")
        corners = flat.astype(np.int64)
        mesh = Mesh(
            frozen(points), frozen(corners), frozen(np.concatenate([[0], np.cumsum(sizes)]))
        )
        mesh.validate()
        return mesh

    def validate(self) -> None:
        """Raise `MeshError` where this is not an oriented manifold with finite coordinates."""
        require_manifold(self)

    # --- sizes -------------------------------------------------------------------------------
    @property
    def n_vertices(self) -> int:
        """Number of vertices."""
        return len(self.vertices)

    @property
    def n_faces(self) -> int:
        """Number of faces."""
        return len(self.face_start) - 1

    @property
    def n_edges(self) -> int:
        """Number of edges."""
        return len(self.edges)

    def __repr__(self) -> str:
        kinds = {3: "triangles", 4: "quads"}
        sizes, counts = np.unique(self.face_sizes, return_counts=True)
        faces = ", ".join(
            f"{c} {kinds.get(int(s), f'{s}-gons')}" for s, c in zip(sizes, counts, strict=True)
        )
        return (
            f"Mesh({self.n_vertices} vertices, {self.n_edges} edges, {faces}, "
            f"{len(self.boundary_loops)} boundary loops)"
        )

    # --- faces and corners -------------------------------------------------------------------
    @cached_property
    def face_sizes(self) -> Ints:
        """(F,) number of corners of each face."""
        return np.diff(self.face_start)

    @cached_property
    def corner_face(self) -> Ints:
        """(C,) face of each corner."""
        return np.repeat(np.arange(self.n_faces), self.face_sizes)

    @cached_property
    def corner_next(self) -> Ints:
        """(C,) the next corner in the same face."""
        following = np.arange(1, len(self.corners) + 1)
        following[self.face_start[1:] - 1] = self.face_start[:-1]
        return following

    @cached_property
    def corner_previous(self) -> Ints:
        """(C,) the previous corner in the same face."""
        previous = np.empty_like(self.corner_next)
        previous[self.corner_next] = np.arange(len(previous))
        return previous

    def face(self, index: int) -> Ints:
        """Vertex ids of one face, counterclockwise seen from outside."""
        return self.corners[self.face_start[index] : self.face_start[index + 1]]

    @cached_property
    def faces(self) -> tuple[Ints, ...]:
        """The faces as arrays of vertex ids."""
        return tuple(np.split(self.corners, self.face_start[1:-1]))

    def face_edges(self, index: int) -> Ints:
        """Edge ids of one face; the k-th runs from corner k to corner k + 1."""
        return self.corner_edge[self.face_start[index] : self.face_start[index + 1]]

    # --- edges -------------------------------------------------------------------------------
    @cached_property
    def _edge_tables(self) -> tuple[Ints, Ints, Ints, Ints]:
        """Edges, edge of each corner, left and right face of each edge, twin of each corner."""
        return edge_tables(self.n_vertices, self.corners, self.corner_next, self.corner_face)

    @property
    def edges(self) -> Ints:
        """(E, 2) vertex ids; an edge runs as in its left face; order of first appearance."""
        return self._edge_tables[0]

    @property
    def corner_edge(self) -> Ints:
        """(C,) edge that starts at each corner."""
        return self._edge_tables[1]

    @property
    def edge_faces(self) -> Ints:
        """(E, 2) left and right face of each edge; -1 on the right of a boundary edge."""
        return self._edge_tables[2]

    @property
    def corner_twin(self) -> Ints:
        """(C,) the opposite corner (half-edge) across the edge, or -1."""
        return self._edge_tables[3]

    @cached_property
    def boundary_edge(self) -> NDArray[np.bool_]:
        """(E,) whether an edge has one face only."""
        return self.edge_faces[:, 1] < 0

    @cached_property
    def boundary_vertex(self) -> NDArray[np.bool_]:
        """(V,) whether a vertex lies on the boundary."""
        on = np.zeros(self.n_vertices, dtype=bool)
        on[self.edges[self.boundary_edge].ravel()] = True
        return on

    @cached_property
    def boundary_loops(self) -> tuple[Ints, ...]:
        """Closed boundary loops of vertex ids, with the surface on the left."""
        return loops_of(self.edges[self.boundary_edge])

    # --- stars -------------------------------------------------------------------------------
    @cached_property
    def _stars(self) -> tuple[Ints, Ints, Ints]:
        """Start of each vertex' star; its edges counterclockwise; the face after each edge."""
        return star_tables(self)

    @property
    def star_start(self) -> Ints:
        """(V + 1,) where each vertex' edges begin in `star_edges`."""
        return self._stars[0]

    @property
    def star_edges(self) -> Ints:
        """Edges of the vertices counterclockwise; at the boundary from rim to rim."""
        return self._stars[1]

    @property
    def star_faces(self) -> Ints:
        """The face between each edge of a star and the next; -1 outside the boundary."""
        return self._stars[2]

    def star(self, vertex: int) -> tuple[Ints, Ints]:
        """Edges of a vertex counterclockwise, and the face that follows each (-1: none)."""
        part = slice(self.star_start[vertex], self.star_start[vertex + 1])
        return self.star_edges[part], self.star_faces[part]

    @cached_property
    def split_vertices(self) -> Ints:
        """Vertices where several fans of faces meet: none in a manifold mesh."""
        fans = np.bincount(self.corners, minlength=self.n_vertices) - np.diff(self.star_start)
        fans += np.bincount(self.corners[self.corner_twin < 0], minlength=self.n_vertices)
        return np.flatnonzero(fans)

    @cached_property
    def valences(self) -> Ints:
        """(V,) number of edges at each vertex; 0 for a vertex without faces."""
        return np.bincount(self.edges.ravel(), minlength=self.n_vertices)

    @cached_property
    def components(self) -> Ints:
        """(F,) number of the connected component of each face."""
        graph = coo_array(
            (np.ones(self.n_edges), (self.edges[:, 0], self.edges[:, 1])),
            shape=(self.n_vertices, self.n_vertices),
        )
        labels = connected_components(graph, directed=False)[1][self.corners[self.face_start[:-1]]]
        return np.unique(labels, return_inverse=True)[1]

    # --- geometry ----------------------------------------------------------------------------
    @cached_property
    def edge_vectors(self) -> Floats:
        """(E, 3) from the first to the second vertex of each edge."""
        return self.vertices[self.edges[:, 1]] - self.vertices[self.edges[:, 0]]

    @cached_property
    def edge_lengths(self) -> Floats:
        """(E,) lengths."""
        lengths: Floats = np.linalg.norm(self.edge_vectors, axis=1)
        return lengths

    @cached_property
    def vector_areas(self) -> Floats:
        """(F, 3) vector areas (Newell): normal times area, of the projection for skew faces."""
        return self._face_sum(
            0.5
            * np.cross(
                self.vertices[self.corners] - self._face_origin[self.corner_face],
                self.vertices[self.corners[self.corner_next]] - self._face_origin[self.corner_face],
            )
        )

    @cached_property
    def _face_origin(self) -> Floats:
        return self.vertices[self.corners[self.face_start[:-1]]]

    def _face_sum(self, values: Floats) -> Floats:
        return np.add.reduceat(values, self.face_start[:-1], axis=0)

    @cached_property
    def face_areas(self) -> Floats:
        """(F,) lengths of the vector areas."""
        areas: Floats = np.linalg.norm(self.vector_areas, axis=1)
        return areas

    @cached_property
    def face_normals(self) -> Floats:
        """(F, 3) unit normals."""
        return unit(self.vector_areas)

    @cached_property
    def face_centers(self) -> Floats:
        """(F, 3) means of the corners."""
        return self._face_sum(self.vertices[self.corners]) / self.face_sizes[:, None]

    @cached_property
    def corner_angles(self) -> Floats:
        """(C,) interior angles [rad] of the faces at their corners, 0..pi."""
        here = self.vertices[self.corners]
        ahead = self.vertices[self.corners[self.corner_next]] - here
        back = self.vertices[self.corners[self.corner_previous]] - here
        angles: Floats = np.arctan2(
            np.linalg.norm(np.cross(ahead, back), axis=1), np.einsum("ij,ij->i", ahead, back)
        )
        return angles

    @cached_property
    def vertex_normals(self) -> Floats:
        """(V, 3) unit sums of the vector areas of the faces at each vertex (Gouraud 1971).

        Weighting by area, of the usual weights, is the one that gives the torsion of the vertex
        normals of the published meshes (9.6, 6.5 and 8.3 deg). Zero where no face is.
        """
        total = np.zeros_like(self.vertices)
        np.add.at(total, self.corners, self.vector_areas[self.corner_face])
        return unit(total)

    @cached_property
    def diameter(self) -> float:
        """Size of the mesh: `extent` of the vertices that faces use."""
        return extent(self.vertices[self.valences > 0])

    # --- new meshes --------------------------------------------------------------------------
    @checked
    def with_vertices(self, vertices: ArrayLike) -> Mesh:
        """The same faces on other (V, 3) vertices."""
        points = np.array(vertices, dtype=np.float64)
        if points.shape != self.vertices.shape:
            raise MeshError(f"vertices have shape {points.shape}; expected {self.vertices.shape}")
        return Mesh(frozen(points), self.corners, self.face_start)

    @checked
    def scaled(self, factor: float) -> Mesh:
        """The mesh with all coordinates times a factor."""
        return self.with_vertices(self.vertices * factor)

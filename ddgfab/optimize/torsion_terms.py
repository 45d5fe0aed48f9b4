"""Terms for node axes on moving vertices: torsion of edges, lean from the moving vertex normals."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, eye_array, kron

from ddgfab.mesh import Floats, Ints, Mesh, unit
from ddgfab.optimize.problem import VERTICES, Layout, Term
from ddgfab.optimize.terms.base import LocalTerm, widened
from ddgfab.optimize.terms.planarity import polygon_corners, vector_areas

AXES = "axes"
"""Name of the block of node axes in a layout."""


@dataclass(frozen=True, eq=False, kw_only=True)
class AxisTorsion(LocalTerm):
    """det(e, a_i, a_j) with unit e for every edge; make with `axis_torsion`.

    Local unknowns: the two ends of the edge, then their axes, 12 numbers.
    """

    def values(self, local: Floats) -> Floats:
        """(m,) residuals."""
        start, end, first, second = local.reshape(-1, 4, 3).transpose(1, 0, 2)
        return np.asarray(np.einsum("mx,mx->m", unit(end - start), np.cross(first, second)))

    def gradients(self, local: Floats) -> Floats:
        """(m, 12)."""
        start, end, first, second = local.reshape(-1, 4, 3).transpose(1, 0, 2)
        edge = end - start
        length = np.linalg.norm(edge, axis=1, keepdims=True)
        along, crossed = edge / length, np.cross(first, second)
        inner = np.einsum("mx,mx->m", along, crossed)[:, None]
        at_end = (crossed - inner * along) / length
        return np.concatenate(
            [-at_end, at_end, np.cross(second, along), np.cross(along, first)], axis=1
        )


def axis_torsion(
    mesh: Mesh, layout: Layout, *, weight: float = 1.0, hard: bool = True
) -> AxisTorsion:
    """Torsion-free edges, det(e, a_i, a_j) = 0, between vertices and the block `AXES`.

    With axes of length one the residual is the sine of the torsion times the sines of the angles
    between edge and axes.

    Source: Pottmann, Liu, Wallner, Bobenko, Wang 2007, Def. 5.1; mathematics.md 10.2.
    """
    ends = layout.index(VERTICES, mesh.edges).reshape(mesh.n_edges, 6)
    axes = layout.index(AXES, mesh.edges).reshape(mesh.n_edges, 6)
    return AxisTorsion(
        name="axis torsion",
        index=np.concatenate([ends, axes], axis=1),
        weight=weight,
        hard=hard,
        of="edge",
        elements=np.arange(mesh.n_edges),
    )


def block_matrix(values: Floats, rows: Ints, columns: Ints, shape: tuple[int, int]) -> csr_array:
    """Matrix of (m, a, b) blocks at block rows and columns (m,); those on one place add up."""
    high, wide = values.shape[1:]
    r = (high * rows[:, None] + np.arange(high))[:, :, None]
    c = (wide * columns[:, None] + np.arange(wide))[:, None, :]
    r, c = np.broadcast_arrays(r, c)
    entries = values.ravel(), (r.ravel(), c.ravel())
    return csr_array(entries, shape=(high * shape[0], wide * shape[1]))


def vertex_normals(mesh: Mesh, vertices: Floats) -> tuple[Floats, csr_array]:
    """(V, 3) unit normals of a mesh on (V, 3) other vertices, and their (3V, 3V) derivative.

    The normals of `Mesh.vertex_normals`: N_v = sum of the vector areas A_f of its faces, made
    unit. From dA_f = 1/2 sum_i (x_(i-1) - x_(i+1)) x dx_i.
    """
    count, ids = mesh.n_vertices, np.arange(mesh.n_vertices)
    areas = mesh.with_vertices(vertices).vector_areas
    around = csr_array(
        (np.ones(len(mesh.corners)), (mesh.corners, mesh.corner_face)), shape=(count, mesh.n_faces)
    )
    total = around @ areas
    length = np.where(mesh.valences > 0, np.linalg.norm(total, axis=1), 1.0)
    normals = total / length[:, None]
    across = vertices[mesh.corners[mesh.corner_previous]] - vertices[mesh.corners[mesh.corner_next]]
    area = block_matrix(
        0.5 * cross_matrices(across), mesh.corner_face, mesh.corners, (mesh.n_faces, count)
    )
    flat = (np.eye(3) - normals[:, :, None] * normals[:, None, :]) / length[:, None, None]
    summed = kron(around, eye_array(3), format="csr") @ area
    return normals, csr_array(block_matrix(flat, ids, ids, (count, count)) @ summed)


def cross_matrices(vectors: Floats) -> Floats:
    """(n, 3, 3) matrices of w -> v x w."""
    out = np.zeros((len(vectors), 3, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        out[:, k, j], out[:, j, k] = vectors[:, i], -vectors[:, i]
    return out


@dataclass(frozen=True, eq=False, kw_only=True)
class AxisLean:
    """a_v - n_v for every vertex, n_v the unit normal of the moving mesh: (3V,) residuals.

    Its length is 2 sin(lean / 2) for unit axes; axes that may change their length settle at
    cos(lean), where it is sin(lean).
    """

    mesh: Mesh
    layout: Layout
    name: str = "axis lean"
    weight: float = 1.0
    hard: bool = False

    def residual(self, x: Floats) -> Floats:
        """(3V,) residuals."""
        moved = self.mesh.with_vertices(self.layout.values(x, VERTICES))
        return np.asarray((self.layout.values(x, AXES) - moved.vertex_normals).ravel())

    def jacobian(self, x: Floats) -> csr_array:
        """(3V, n)."""
        _, slope = vertex_normals(self.mesh, self.layout.values(x, VERTICES))
        count = 3 * self.mesh.n_vertices
        rows = np.arange(count)
        axes = self.layout.block(AXES)
        ones = csr_array((np.ones(count), (rows, axes.start + rows)), shape=(count, len(x)))
        return csr_array(ones - widened(slope, len(x)))


@dataclass(frozen=True, eq=False, kw_only=True)
class CornerAngle(LocalTerm):
    """How far face angles are from those of a regular face; make with `corner_angles`.

    Local unknowns: the corners of the face, the one with the angle first. The angle is signed
    about the normal of the face, -pi/2..3/2 pi: a reflex corner is above pi, one that is turned
    over negative.

    Attributes
    ----------
    regular : angle [rad] of the regular face
    """

    regular: float

    def values(self, local: Floats) -> Floats:
        """(m,) residuals."""
        sine, cosine = self._parts(local)[:2]
        angle = np.arctan2(sine, cosine)
        return np.where(angle < -np.pi / 2, angle + 2 * np.pi, angle) - self.regular

    def _parts(self, local: Floats) -> tuple[Floats, ...]:
        points = local.reshape(len(local), -1, 3)
        ahead, back = points[:, 1] - points[:, 0], points[:, -1] - points[:, 0]
        area = vector_areas(points)
        length = np.linalg.norm(area, axis=1, keepdims=True)
        turned = np.cross(ahead, back)
        sine = np.einsum("mx,mx->m", area / length, turned)
        return sine, np.einsum("mx,mx->m", ahead, back), ahead, back, area / length, length

    def gradients(self, local: Floats) -> Floats:
        """(m, 3k): of atan2(<N, a x b>, <a, b>), N the unit normal, which turns too."""
        points = local.reshape(len(local), -1, 3)
        sine, cosine, ahead, back, normal, length = self._parts(local)
        size = np.maximum(sine**2 + cosine**2, np.finfo(float).tiny)
        by_sine, by_cosine = (cosine / size)[:, None], (-sine / size)[:, None]
        at_ahead = by_sine * np.cross(back, normal) + by_cosine * back
        at_back = by_sine * np.cross(normal, ahead) + by_cosine * ahead
        turned = np.cross(ahead, back)
        turned -= np.einsum("mx,mx->m", turned, normal)[:, None] * normal
        around = np.roll(points, -1, axis=1) - np.roll(points, 1, axis=1)
        slope = np.cross(around, (by_sine * turned / (2 * length))[:, None])
        slope[:, 1] += at_ahead
        slope[:, -1] += at_back
        slope[:, 0] -= at_ahead + at_back
        return np.asarray(slope.reshape(len(local), -1))


def corner_angles(mesh: Mesh, *, weight: float = 1.0) -> tuple[CornerAngle, ...]:
    """Face angles near those of regular faces [rad]: a term for each number of corners."""
    terms = []
    for size in np.unique(mesh.face_sizes).tolist():
        corners = polygon_corners(mesh, size)[1]
        turns = (np.arange(size)[:, None] + np.arange(size)) % size
        turned = corners[:, turns].reshape(-1, size)
        index = (3 * turned[..., None] + np.arange(3)).reshape(len(turned), -1)
        terms.append(
            CornerAngle(
                name=f"corner angles of {size}-gons",
                index=index,
                weight=weight,
                regular=np.pi * (1 - 2 / size),
            )
        )
    return tuple(terms)


@dataclass(frozen=True, eq=False, kw_only=True)
class EdgeStretch(LocalTerm):
    """log(|e| / |e0|) for every edge; make with `edge_stretch`."""

    original: Floats

    def values(self, local: Floats) -> Floats:
        """(m,) residuals."""
        edge = local[:, 3:] - local[:, :3]
        return np.asarray(np.log(np.linalg.norm(edge, axis=1) / self.original))

    def gradients(self, local: Floats) -> Floats:
        """(m, 6)."""
        edge = local[:, 3:] - local[:, :3]
        at_end = edge / np.sum(edge * edge, axis=1, keepdims=True)
        return np.concatenate([-at_end, at_end], axis=1)


def edge_stretch(mesh: Mesh, *, weight: float = 1.0) -> EdgeStretch:
    """Edges as long as they are, in proportion: a wish that no edge collapses."""
    index = (3 * mesh.edges[..., None] + np.arange(3)).reshape(-1, 6)
    return EdgeStretch(name="edge stretch", index=index, weight=weight, original=mesh.edge_lengths)


@dataclass(frozen=True, eq=False, kw_only=True)
class Power:
    """A soft limit: (|r| / limit)^power for the vectors r of another term, `width` numbers each.

    Far below the limit it costs nothing, above it much, and in between it is smooth: Newton's
    method goes on where a hard bound would make it change its mind at every step. With a high
    power the greatest |r| counts almost alone.
    """

    term: Term
    limit: float
    width: int = 1
    power: int = 4
    weight: float = 1.0
    hard: bool = False

    @property
    def name(self) -> str:
        """The name of the term."""
        return self.term.name

    def _lengths(self, vectors: Floats) -> Floats:
        return np.asarray(np.linalg.norm(vectors, axis=1) / self.limit)

    def residual(self, x: Floats) -> Floats:
        """(m,) residuals."""
        return self._lengths(self.term.residual(x).reshape(-1, self.width)) ** self.power

    def jacobian(self, x: Floats) -> csr_array:
        """(m, n)."""
        vectors = self.term.residual(x).reshape(-1, self.width)
        part = self.power * self._lengths(vectors) ** (self.power - 2) / self.limit**2
        ids = np.arange(len(vectors))
        rows = block_matrix((part[:, None] * vectors)[:, None], ids, ids, (len(ids), len(ids)))
        return csr_array(rows @ self.term.jacobian(x))

    def hessian(self, x: Floats) -> csr_array:
        """(n, n) of half the squared residuals, but for the curvature of r itself: semidefinite."""
        vectors = self.term.residual(x).reshape(-1, self.width)
        lengths, p = self._lengths(vectors), self.power
        flat = p * lengths ** (2 * p - 2) / self.limit**2
        steep = 2 * p * (p - 1) * lengths ** (2 * p - 4) / self.limit**4
        block = flat[:, None, None] * np.eye(self.width)
        block += steep[:, None, None] * vectors[:, :, None] * vectors[:, None, :]
        ids = np.arange(len(vectors))
        slope = self.term.jacobian(x)
        return csr_array(slope.T @ block_matrix(block, ids, ids, (len(ids), len(ids))) @ slope)

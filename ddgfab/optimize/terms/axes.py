"""Node axes on moving vertices: torsion of edges, axes of length one, lean from the normals.

Axes are a block of unknowns, three numbers a vertex. Torsion and lean use their directions alone,
so that no axis can shrink its way out of an equation; `unit_axes` holds the lengths.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.sparse import csr_array, eye_array, kron

from ddgfab.mesh import Floats, Ints, Mesh, unit
from ddgfab.optimize.problem import VERTICES, Layout
from ddgfab.optimize.terms.base import LocalTerm, widened

AXES: Final = "axes"
"""Name of the block of node axes in a layout."""


@dataclass(frozen=True, eq=False, kw_only=True)
class AxisTorsion(LocalTerm):
    """det(e, a_i, a_j) of unit vectors for every edge; make with `axis_torsion`.

    Local unknowns: the two ends of the edge, then their axes, 12 numbers.
    """

    def values(self, local: Floats) -> Floats:
        """(m,) residuals."""
        start, end, first, second = local.reshape(-1, 4, 3).transpose(1, 0, 2)
        crossed = np.cross(unit(first), unit(second))
        return np.asarray(np.einsum("mx,mx->m", unit(end - start), crossed))

    def gradients(self, local: Floats) -> Floats:
        """(m, 12)."""
        start, end, first, second = local.reshape(-1, 4, 3).transpose(1, 0, 2)
        edge = end - start
        along, one, two = unit(edge), unit(first), unit(second)
        parts = [
            _of_unit(np.cross(one, two), along, edge),
            _of_unit(np.cross(two, along), one, first),
            _of_unit(np.cross(along, one), two, second),
        ]
        return np.concatenate([-parts[0], *parts], axis=1)


def _of_unit(slope: Floats, direction: Floats, vector: Floats) -> Floats:
    """(m, 3) derivative by vectors from that by their directions."""
    inner = np.einsum("mx,mx->m", slope, direction)[:, None]
    return np.asarray((slope - inner * direction) / np.linalg.norm(vector, axis=1, keepdims=True))


def axis_torsion(
    mesh: Mesh, layout: Layout, *, weight: float = 1.0, hard: bool = True
) -> AxisTorsion:
    """Torsion-free edges, det(e, a_i, a_j) = 0, between vertices and the block `AXES`.

    The residual is the sine of the torsion times the sines of the angles between edge and axes.

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


@dataclass(frozen=True, eq=False, kw_only=True)
class UnitLengths(LocalTerm):
    """(|a|^2 - 1) / 2; make with `unit_axes`."""

    def values(self, local: Floats) -> Floats:
        """(m,) residuals."""
        return np.asarray(0.5 * (np.einsum("mx,mx->m", local, local) - 1.0))

    def gradients(self, local: Floats) -> Floats:
        """(m, 3)."""
        return local


def unit_axes(mesh: Mesh, layout: Layout) -> UnitLengths:
    """Axes of length one at vertices that faces use."""
    used = np.flatnonzero(mesh.valences > 0)
    return UnitLengths(
        name="length of axes",
        index=layout.index(AXES, used),
        hard=True,
        of="vertex",
        elements=used,
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class AxisLean:
    """a_v - n_v for every vertex, both of length one, n_v the normal of the moving mesh.

    (3V,) residuals; the length of each is 2 sin(lean / 2).
    """

    mesh: Mesh
    layout: Layout
    name: str = "axis lean"
    weight: float = 1.0
    hard: bool = False

    def residual(self, x: Floats) -> Floats:
        """(3V,) residuals."""
        moved = self.mesh.with_vertices(self.layout.values(x, VERTICES))
        return np.asarray((unit(self.layout.values(x, AXES)) - moved.vertex_normals).ravel())

    def jacobian(self, x: Floats) -> csr_array:
        """(3V, n)."""
        _, normals = vertex_normals(self.mesh, self.layout.values(x, VERTICES))
        axes = self.layout.values(x, AXES)
        length = np.linalg.norm(axes, axis=1)
        length = np.where(length > 0, length, 1.0)[:, None, None]
        ways, ids = unit(axes), np.arange(len(axes))
        flat = (np.eye(3) - ways[:, :, None] * ways[:, None, :]) / length
        turn = block_matrix(flat, ids, ids, (len(ids), len(ids)))
        first = self.layout.block(AXES).start
        turned = csr_array(
            (turn.data, turn.indices + first, turn.indptr), shape=(turn.shape[0], len(x))
        )
        return csr_array(turned - widened(normals, len(x)))


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
        0.5 * _cross_matrices(across), mesh.corner_face, mesh.corners, (mesh.n_faces, count)
    )
    flat = (np.eye(3) - normals[:, :, None] * normals[:, None, :]) / length[:, None, None]
    summed = kron(around, eye_array(3), format="csr") @ area
    return normals, csr_array(block_matrix(flat, ids, ids, (count, count)) @ summed)


def _cross_matrices(vectors: Floats) -> Floats:
    """(n, 3, 3) matrices of w -> v x w."""
    out = np.zeros((len(vectors), 3, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        out[:, k, j], out[:, j, k] = vectors[:, i], -vectors[:, i]
    return out

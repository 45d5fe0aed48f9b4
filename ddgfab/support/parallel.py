"""Support structures from parallel meshes: axes a(v) along v' - v of a mesh with parallel edges.

The differences d_v = v' - v solve the linear problem (d_i - d_j) parallel to e_ij for every edge
(Pottmann, Liu, Wallner, Bobenko, Wang 2007, section 2; mathematics.md 10.4). A planar m x n net
has a space of m + n + 3 of them.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array, diags_array

from ddgfab.arguments import checked, of_shape
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.support.nearest_axes import tangent_frames
from ddgfab.symmetric import factored

PENALTY = 1e7
"""Weight of the edge conditions against the distance to the target, both without unit."""

MULTIPLIER_STEPS = 6
"""Steps of the method of multipliers; each gains the digits that the penalty gives."""

PASSES = 2
"""The second projects what the first left over, which removes the rounding of the first."""


def edge_conditions(mesh: Mesh) -> csr_array:
    """(2E, 3V) matrix of (d_i - d_j) x e = 0: two unit directions across each edge."""
    across = tangent_frames(unit(mesh.edge_vectors)).reshape(-1, 3)  # (2E, 3)
    row = np.arange(2 * mesh.n_edges)
    start, end = (3 * np.repeat(mesh.edges[:, k], 2)[:, None] + np.arange(3) for k in (0, 1))
    return csr_array(
        (
            np.concatenate([across.ravel(), -across.ravel()]),
            (np.tile(np.repeat(row, 3), 2), np.concatenate([start.ravel(), end.ravel()])),
        ),
        shape=(2 * mesh.n_edges, 3 * mesh.n_vertices),
    )


@checked
def parallel_field(mesh: Mesh, target: Floats, weights: Floats | None = None) -> Floats:
    """(V, 3) differences d to the parallel mesh nearest to a target field, by least squares.

    Minimises sum w_v |d_v - target_v|^2 under the edge conditions, with the method of
    multipliers. Exact to rounding where faces are planar; where they are only nearly so the
    conditions contradict each other and a compromise comes back (measure its torsion).

    Parameters
    ----------
    target : (V, 3)
    weights : (V,) positive; 1 by default
    """
    shape = mesh.vertices.shape
    target = of_shape(target, shape, "target")
    own = np.ones(shape[0]) if weights is None else of_shape(weights, shape[:1], "weights")
    weight = np.repeat(own, 3)
    matrix = edge_conditions(mesh)
    factor = factored(diags_array(weight) + PENALTY * (matrix.T @ matrix))
    field = np.zeros(matrix.shape[1])
    for _ in range(PASSES):
        force = np.zeros(matrix.shape[0])
        pull = weight * (target.ravel() - field)
        step = factor.solve(pull)
        for _ in range(MULTIPLIER_STEPS):
            force += PENALTY * (matrix @ step)
            step = factor.solve(pull - matrix.T @ force)
        field += step
    return field.reshape(-1, 3)


@checked
def parallel_axes(mesh: Mesh) -> Floats:
    """(V, 3) unit axes of the parallel mesh nearest to the vertex normals (see `parallel_field`).

    They may point to the wrong side where no parallel mesh is near: look at the lean.
    """
    return unit(parallel_field(mesh, mesh.vertex_normals))

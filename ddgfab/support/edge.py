"""Axes of meshes parallel to a Koebe net: offsets at a constant distance of edges, equal beams."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ddgfab.arguments import checked, of_shape
from ddgfab.errors import DegenerateError
from ddgfab.measures.edge_offset import EDGE_RELATIVE, koebe_field
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.tolerances import RELATIVE_DEGENERATE
from ddgfab.trees import tree_sums


@checked
def edge_axes(mesh: Mesh, tolerance: float = EDGE_RELATIVE) -> Floats:
    """(V, 3) unit axes along the vertices of the parallel Koebe net: beams of one height.

    Raises
    ------
    DegenerateError
        The mesh is not parallel to a Koebe net; see `koebe_field`.

    Source: Pottmann, Liu, Wallner, Bobenko, Wang 2007, section 3.3; mathematics.md 10.6.
    """
    return unit(koebe_field(mesh, tolerance))


@checked
def beam_heights(mesh: Mesh, axes: Floats) -> Floats:
    """(E, 2) heights at both ends of beams whose lower edges meet on the node axes.

    The lower edges form a parallel mesh v + l_v a_v; walking along edges fixes the lengths l_v up
    to one factor in each component, which makes the mean height 1. All are 1 on an edge offset;
    the two ends of a beam differ where the axes belong to no parallel mesh.

    Parameters
    ----------
    axes : (V, 3) unit axes

    Raises
    ------
    DegenerateError
        An axis along an edge of its vertex: a beam without height; names both.

    Source: mathematics.md 10.4, 11a (beam cutting).
    """
    axes = of_shape(axes, mesh.vertices.shape, "axes")
    start, end = mesh.edges.T
    along = unit(mesh.edge_vectors)
    heights = np.stack(
        [np.linalg.norm(np.cross(axes[v], along), axis=1) for v in (start, end)], axis=1
    )
    flat = np.argwhere(heights <= RELATIVE_DEGENERATE)
    if len(flat):
        edge, end_of = flat[0].tolist()
        raise DegenerateError(
            f"the axis of vertex {mesh.edges[edge, end_of]} runs along edge {edge}: no beam there"
        )
    logs = np.log(heights)
    steps = logs[:, 0] - logs[:, 1]
    graph = coo_array((np.ones(mesh.n_edges), (start, end)), shape=(mesh.n_vertices,) * 2)
    component = connected_components(graph, directed=False)[1]
    for part in np.unique(component[mesh.corners]).tolist():
        edges = np.flatnonzero(component[start] == part)
        root = int((component == part).argmax())
        i, j = start[edges], end[edges]
        lengths = tree_sums(mesh.n_vertices, i, j, steps[edges], root)[0]
        own = logs[edges] + np.stack([lengths[i], lengths[j]], axis=1)
        own -= own.mean()
        logs[edges] = own - np.log(np.exp(own).mean())
    return np.asarray(np.exp(logs))

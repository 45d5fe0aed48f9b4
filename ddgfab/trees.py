"""Spanning trees: sums along them, and signs that alternate round the faces of a mesh."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

from ddgfab.mesh import Ints, Mesh

Value = TypeVar("Value", np.float64, np.complex128)


def tree_sums(
    count: int, start: Ints, end: Ints, steps: NDArray[Value], root: int = 0
) -> tuple[NDArray[Value], NDArray[np.bool_]]:
    """Values with value[end] - value[start] = step along a breadth-first spanning tree.

    No loop over nodes: parents are doubled (the parent of the parent, ...), which takes
    log2(depth) rounds. Steps off the tree are not looked at; the caller measures them.

    Parameters
    ----------
    count : number of nodes
    start, end : (E,) nodes of each edge
    steps : (E, ...) difference across each edge
    root : node with value zero

    Returns
    -------
    values : (count, ...); zero where the root does not reach
    reached : (count,)
    """
    tails, heads = np.concatenate([start, end]), np.concatenate([end, start])
    graph = csr_array((np.ones(len(tails), dtype=np.int8), (tails, heads)), shape=(count, count))
    order, before = breadth_first_order(graph, root, directed=True)
    order = order.astype(np.int64)
    parent = np.arange(count)
    parent[order[1:]] = before[order[1:]]
    keys = tails.astype(np.int64) * count + heads
    sorting = np.argsort(keys, kind="stable")
    nodes = order[1:]
    found = sorting[np.searchsorted(keys[sorting], parent[nodes] * count + nodes)]
    backwards = found >= len(start)
    signs = np.where(backwards, -1.0, 1.0).reshape(-1, *[1] * (steps.ndim - 1))
    values = np.zeros((count, *steps.shape[1:]), dtype=steps.dtype)
    values[nodes] = steps[found - len(start) * backwards] * signs
    while (parent != parent[parent]).any():
        values = values + values[parent]
        parent = parent[parent]
    reached = np.zeros(count, dtype=bool)
    reached[order] = True
    return values, reached


def corner_graph(mesh: Mesh) -> csr_array:
    """(E, E) which edges follow each other in a face."""
    first, second = mesh.corner_edge, mesh.corner_edge[mesh.corner_next]
    ones = np.ones(len(first), dtype=np.int8)
    return coo_array((ones, (first, second)), shape=(mesh.n_edges, mesh.n_edges)).tocsr()


def alternating_signs(mesh: Mesh) -> tuple[Ints, Ints]:
    """Signs of the edges that alternate round every face, and the corners where they cannot.

    Returns
    -------
    signs : (E,) +1 and -1; +1 at the first edge of each component
    failing : corners whose edge and next edge have the same sign; empty where signs exist
    """
    first, second = mesh.corner_edge, mesh.corner_edge[mesh.corner_next]
    component = connected_components(corner_graph(mesh), directed=False)[1]
    parity = np.zeros(mesh.n_edges, dtype=np.int64)
    for root in np.unique(component, return_index=True)[1].tolist():
        depth, reached = tree_sums(mesh.n_edges, first, second, np.ones(len(first)), root)
        parity[reached] = np.rint(depth[reached]).astype(np.int64) % 2
    return 1 - 2 * parity, np.flatnonzero(parity[first] == parity[second])

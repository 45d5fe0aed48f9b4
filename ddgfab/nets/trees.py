"""Sums along spanning trees: a quantity known by its differences across edges, at every node."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import breadth_first_order

from ddgfab.mesh import Ints

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

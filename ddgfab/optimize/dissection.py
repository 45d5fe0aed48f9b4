"""Nested dissection: an order of elimination for systems whose unknowns have places in space.

The nodes are cut in two by their places, again and again; between the halves lies a separator, the
nodes of one half that are coupled to the other. Halves come first, separators last, so that what is
eliminated in one half never touches the other. On surface meshes separators are curves: n nodes
have factors of about n log n numbers.

Source: George, Nested Dissection of a Regular Finite Element Mesh, 1973; Liu, The Multifrontal
Method for Sparse Matrix Solution, 1992.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ddgfab.mesh import Floats, Ints

_LEAF: Final = 40
"""Parts of up to this number of nodes are not cut."""
_DEPTH: Final = 40
"""Cuts in a row at most: nodes at the same place cannot be cut."""


@dataclass(frozen=True, eq=False)
class Front:
    """Nodes that are eliminated together, and those that they are coupled to then.

    Attributes
    ----------
    pivots, border : ids of nodes, in the order of elimination
    children : numbers of the fronts whose borders it takes over
    """

    pivots: Ints
    border: Ints
    children: tuple[int, ...]


def dissect(graph: csr_array, places: Floats) -> tuple[Front, ...]:
    """Fronts in the order of elimination, children before parents.

    Parameters
    ----------
    graph : (n, n) which nodes are coupled, symmetric
    places : (n, 3) where nodes are
    """
    cutter = _Cutter(graph, places)
    cutter.cut(np.arange(graph.shape[0]), 0)
    pieces, children = cutter.pieces, cutter.children
    order: Ints = np.concatenate(pieces)
    turn = np.empty_like(order)
    turn[order] = np.arange(len(order))
    borders: list[Ints] = []
    last = -1
    for pivots, below in zip(pieces, children, strict=True):
        last += len(pivots)
        near = turn[neighbors(graph, pivots)[0]]
        turns = np.unique(np.concatenate([near, *(turn[borders[c]] for c in below)]))
        borders.append(order[turns[turns > last]])
    return tuple(map(Front, pieces, borders, children))


def neighbors(graph: csr_array, rows: Ints) -> tuple[Ints, Ints]:
    """Columns of the entries of some rows, one row after the other, and the number in each row."""
    counts = graph.indptr[rows + 1] - graph.indptr[rows]
    shift = graph.indptr[rows] - np.cumsum(counts) + counts
    return graph.indices[np.repeat(shift, counts) + np.arange(counts.sum())], counts


class _Cutter:
    """Cuts nodes into pieces, those of separators after those of the halves they separate."""

    def __init__(self, graph: csr_array, places: Floats) -> None:
        self._graph, self._places = graph, places
        self._side = np.zeros(graph.shape[0], dtype=np.int8)
        self.pieces: list[Ints] = []
        self.children: list[tuple[int, ...]] = []

    def cut(self, nodes: Ints, depth: int) -> tuple[int, ...]:
        """Cut nodes; the numbers of the pieces that are not children of another one."""
        parts = self._halves(nodes) if len(nodes) > _LEAF and depth < _DEPTH else None
        if parts is None:
            below: tuple[int, ...] = ()
        else:
            low, high, nodes = parts
            below = (*self.cut(low, depth + 1), *self.cut(high, depth + 1))
            if not len(nodes):
                return below
        self.pieces.append(nodes)
        self.children.append(below)
        return (len(self.pieces) - 1,)

    def _halves(self, nodes: Ints) -> tuple[Ints, Ints, Ints] | None:
        """Two halves and the nodes that separate them; None where a half would be empty."""
        order = np.argsort(self._longest(nodes), kind="stable")
        low, high = nodes[order[: len(order) // 2]], nodes[order[len(order) // 2 :]]
        self._side[low], self._side[high] = 1, 2
        left, right = self._touches(low, 2), self._touches(high, 1)
        self._side[nodes] = 0
        if left.sum() <= right.sum():
            low, separator = low[~left], low[left]
        else:
            high, separator = high[~right], high[right]
        # along the separator: what a part below touches of it then lies in a row
        if len(separator):
            separator = separator[np.argsort(self._longest(separator), kind="stable")]
        return (low, high, separator) if len(low) and len(high) else None

    def _longest(self, nodes: Ints) -> Floats:
        """(n,) the coordinate of nodes in which they differ most."""
        places = self._places[nodes]
        return np.asarray(places[:, np.ptp(places, axis=0).argmax()])

    def _touches(self, nodes: Ints, side: int) -> NDArray[np.bool_]:
        """(n,) whether nodes have a neighbor on a side."""
        columns, counts = neighbors(self._graph, nodes)
        row = np.repeat(np.arange(len(nodes)), counts)
        return np.bincount(row[self._side[columns] == side], minlength=len(nodes)) > 0

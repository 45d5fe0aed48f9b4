"""Sparse Cholesky factors by dense blocks, for systems whose unknowns have places in space.

Unknowns come in nodes (the coordinates of a vertex); `dissection` orders them and says which are
eliminated together. Each such front is one dense matrix, so nearly all the work is done by BLAS.
The analysis is kept: patterns that fit into one seen before use it again, others widen it.

Source: Duff, Reid, The Multifrontal Solution of Indefinite Sparse Symmetric Linear Equations, 1983.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.blas import dgemv, dsyrk, dtrsm, dtrsv
from scipy.linalg.lapack import dpotrf
from scipy.sparse import coo_array, csr_array

from ddgfab.errors import DegenerateError
from ddgfab.mesh import Floats, Ints
from ddgfab.optimize.dissection import dissect
from ddgfab.optimize.pattern import Pattern


@dataclass(frozen=True, eq=False)
class _Block:
    """A front in terms of unknowns.

    Attributes
    ----------
    pivots, border : unknowns
    entries : slice of the entries of the matrix, in the order of `_Analysis`, that belong here
    inside : (e,) which of them lie between pivots
    into : (i,) where those go in the (p, p) block, by columns
    outside : (o,) where the others go in the (b, p) block, by columns
    children : (number of a front, where its border is in pivots and border: runs in a row, as
        (first of the border, first of here, length))
    """

    pivots: Ints
    border: Ints
    entries: slice
    inside: NDArray[np.bool_]
    into: Ints
    outside: Ints
    children: tuple[tuple[int, list[list[int]]], ...]


class _Analysis:
    """Fronts of a pattern, and where its entries go."""

    def __init__(self, pattern: Pattern, node: Ints, places: Floats) -> None:
        size, count = len(node), int(node[-1]) + 1
        rows, columns = np.repeat(np.arange(size), np.diff(pattern.starts)), pattern.columns
        coupled = coo_array(
            (np.ones(len(rows), dtype=np.int8), (node[rows], node[columns])),
            shape=(count, count),
        )
        graph = csr_array(coupled)
        graph.sort_indices()
        first = np.searchsorted(node, np.arange(count))
        starts = np.append(first, size)
        fronts = dissect(graph, places[first])

        def unknowns(nodes: Ints) -> Ints:
            counts = starts[nodes + 1] - starts[nodes]
            shift = starts[nodes] - np.cumsum(counts) + counts
            return np.asarray(np.repeat(shift, counts) + np.arange(counts.sum()))

        sets = [(unknowns(f.pivots), unknowns(f.border)) for f in fronts]
        turn = np.empty(size, dtype=np.int64)
        turn[np.concatenate([p for p, _ in sets])] = np.arange(size)
        lower = turn[rows] >= turn[columns]
        owner = np.empty(size, dtype=np.int64)
        for at, (pivots, _) in enumerate(sets):
            owner[pivots] = at
        kept = np.flatnonzero(lower)
        kept = kept[np.argsort(owner[columns[kept]], kind="stable")]
        self.kept: Ints = kept
        ends = np.searchsorted(owner[columns[kept]], np.arange(len(fronts) + 1))
        local = np.empty(size, dtype=np.int64)
        self.blocks: list[_Block] = []
        for at, (pivots, border) in enumerate(sets):
            local[pivots] = np.arange(len(pivots))
            local[border] = len(pivots) + np.arange(len(border))
            entries = slice(int(ends[at]), int(ends[at + 1]))
            mine = kept[entries]
            row, column = local[rows[mine]], local[columns[mine]]
            inside = row < len(pivots)
            into = (row + len(pivots) * column)[inside]
            outside = (row - len(pivots) + len(border) * column)[~inside]
            below = tuple((c, _runs(local[sets[c][1]], len(pivots))) for c in fronts[at].children)
            self.blocks.append(_Block(pivots, border, entries, inside, into, outside, below))


def _runs(where: Ints, pivots: int) -> list[list[int]]:
    """Runs of consecutive numbers, none across the end of the pivots: (at, first, length)."""
    cut = (np.diff(where, prepend=-2) != 1) | (where == pivots)
    at = np.flatnonzero(cut)
    lengths = np.diff(np.append(at, len(where)))
    found: list[list[int]] = np.stack([at, where[at], lengths], axis=1).tolist()
    return found


class Multifrontal:
    """Factors positive definite matrices whose unknowns have places."""

    def __init__(self, node: Ints, places: Floats) -> None:
        """Unknowns with the same number of `node`, in a row, are eliminated together.

        Parameters
        ----------
        node : (n,) 0, 0, 0, 1, 1, 1, ...
        places : (n, 3) where unknowns are
        """
        self._node, self._places = node, places
        self._pattern = Pattern()
        self._analysis: _Analysis | None = None

    def factor(self, matrix: csr_array) -> Factor:
        """The Cholesky factor of a symmetric matrix.

        Raises
        ------
        DegenerateError
            The matrix is not positive definite.
        """
        values, grew = self._pattern.values(matrix)
        if grew or self._analysis is None:
            self._analysis = _Analysis(self._pattern, self._node, self._places)
        return Factor(self._analysis, values[self._analysis.kept])


class Factor:
    """A Cholesky factor; called, it solves."""

    def __init__(self, analysis: _Analysis, values: Floats) -> None:
        self._blocks = analysis.blocks
        self._parts: list[tuple[Floats, Floats]] = []
        updates: dict[int, Floats] = {}
        for at, block in enumerate(analysis.blocks):
            first, second, update = _eliminated(block, values[block.entries], updates)
            self._parts.append((first, second))
            if update is not None:
                updates[at] = update

    @property
    def size(self) -> int:
        """How many numbers it consists of."""
        return sum(first.size + second.size for first, second in self._parts)

    def __call__(self, right: Floats) -> Floats:
        """Solve for a (n,) right-hand side."""
        x = np.array(right, dtype=np.float64)
        for block, (first, second) in zip(self._blocks, self._parts, strict=True):
            x[block.pivots] = part = dtrsv(first, x[block.pivots], lower=1)
            if len(block.border):
                x[block.border] -= dgemv(1.0, second, part)
        for block, (first, second) in zip(self._blocks[::-1], self._parts[::-1], strict=True):
            part = x[block.pivots]
            if len(block.border):
                part -= dgemv(1.0, second, x[block.border], trans=1)
            x[block.pivots] = dtrsv(first, part, lower=1, trans=1)
        return x


def _eliminated(
    block: _Block, values: Floats, updates: dict[int, Floats]
) -> tuple[Floats, Floats, Floats | None]:
    """Columns of the factor of a front, and what is left for the front above."""
    size, rest = len(block.pivots), len(block.border)
    first, second = np.zeros(size * size), np.zeros(rest * size)
    first[block.into] = values[block.inside]
    second[block.outside] = values[~block.inside]
    first = first.reshape((size, size), order="F")
    second = second.reshape((rest, size), order="F")
    below = np.zeros((rest, rest), order="F")
    for child, runs in block.children:
        update = updates.pop(child)
        for k, (there, here, width) in enumerate(runs):
            source = update[:, there : there + width]
            upper, lower = first[:, here : here + width], second[:, here : here + width]
            if here >= size:
                lower = below[:, here - size : here - size + width]
            for at, row, height in runs[k:]:  # the lower triangle alone
                if row < size:
                    upper[row : row + height] += source[at : at + height]
                else:
                    lower[row - size : row - size + height] += source[at : at + height]
    first, info = dpotrf(first, lower=1, clean=0, overwrite_a=1)
    if info != 0:
        raise DegenerateError("the matrix of a linear system is not positive definite")
    if not rest:
        return first, second, None
    second = dtrsm(1.0, first, second, side=1, lower=1, trans_a=1, overwrite_b=1)
    return first, second, dsyrk(-1.0, second, beta=1.0, c=below, lower=1, overwrite_c=1)
